"""Memory and processes on Linux, and on macOS and Windows as simulated through what these systems tell."""

import os
import subprocess
import sys
from types import SimpleNamespace

import psutil
import pytest

from asperity import system


@pytest.fixture
def without_proc(monkeypatch, tmp_path):
    """A system without the files of Linux."""
    for name in ("_STATUS", "_RESET"):
        monkeypatch.setattr(system, name, tmp_path / "none")
    monkeypatch.setattr(system, "_GROUP_LIMITS", (str(tmp_path / "none"),))


def usage(own, programs):
    """Module `resource` of a system that tells these peaks of this process and of its programs."""
    told = {"own": SimpleNamespace(ru_maxrss=own), "programs": SimpleNamespace(ru_maxrss=programs)}
    return SimpleNamespace(RUSAGE_SELF="own", RUSAGE_CHILDREN="programs", getrusage=told.get)


@pytest.mark.parametrize(("platform", "unit"), [("linux", 1024), ("darwin", 1)])
def test_a_unix_tells_peaks_in_kilobytes_and_macos_in_bytes(monkeypatch, without_proc, platform, unit):
    monkeypatch.setattr(system, "resource", usage(5_000_000, 6_000_000))
    monkeypatch.setattr(sys, "platform", platform)
    assert system.peak_memory() == 5 * unit
    assert system.peak_memory_with_programs() == 11 * unit


def test_windows_tells_the_peak_of_this_process_only(monkeypatch, without_proc):
    monkeypatch.setattr(system, "resource", None)
    told = SimpleNamespace(memory_info=lambda: SimpleNamespace(peak_wset=7_000_000))
    monkeypatch.setattr(psutil, "Process", lambda: told)
    system.reset_peak_memory()
    assert system.peak_memory() == system.peak_memory_with_programs() == 7


def test_the_package_is_imported_where_unix_modules_are_missing():
    code = (
        "import sys; sys.modules |= dict.fromkeys(('fcntl', 'resource', 'grp', 'pwd', 'termios'));"
        "import asperity.system, asperity.runtime.preflight, asperity.accuracy.evaluation;"
        "assert asperity.system.resource is None"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_peak_of_this_process_is_between_what_it_holds_and_what_the_machine_has():
    system.reset_peak_memory()
    before = psutil.Process().memory_info().rss / 1e6
    held = bytearray(os.urandom(1024) * 50_000)
    assert before + 0.9 * len(held) / 1e6 < system.peak_memory() < system.available_memory()


def test_a_process_runs_until_it_ends():
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        assert system.is_running(other.pid)
        assert system.is_running(os.getpid())
    assert not system.is_running(other.pid)
