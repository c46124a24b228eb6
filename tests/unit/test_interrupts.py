"""Ctrl-C and SIGTERM: every command ends with one line, its exit status, and no file half written."""

import os
import shlex
import signal
import subprocess
import sys
from importlib import import_module

import numpy as np
import psutil
import pytest
from bad_input import make_chain

from asperity.cli.main import main
from asperity.config import __main__ as checking
from asperity.runtime.interrupts import COMMAND_LINE

MAP = "{map} --unit um --physical-size 16um 16um --orientation 'peaks up'"
SPECTRUM = "--hurst 0.8 --wavelength-long 0.5 --wavelength-short 0.125 --rms-height 0.001 --points 32"
COMMANDS = {
    "run": f"{MAP} --young 1GPa --poisson 0.3 --area-fraction 0.1 --out {{out}}/x",
    "surface": f"{SPECTRUM} --out {{out}}/x.nc",
    "solve": "{surface} --out {out}/x.nc",
    "stress": "{contact} --out {out}/x.nc",
    "peaks": "{stress} --contact {contact} --resamples 10 --out {out}/x.nc",
    "info": MAP.replace("16um", "16"),
    "view": "{contact} pressure --out {out}/x.png",
    "export": "{contact} {stress} --peaks {out}/x.csv",
    "plan": "'{{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}}'",
    "plot": "9 {statistics} --out {out}/x.png",
}
WITHOUT_FILES = ("info", "plan")
"""Commands that only print."""


def signalling(number, genuine):
    """A function that sends this process a signal before it does what it did."""

    def function(*arguments, **options):
        signal.raise_signal(number)
        return genuine(*arguments, **options)

    return function


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Results of one small surface, and a height map."""
    folder = tmp_path_factory.mktemp("chain")
    height = np.random.default_rng(1).normal(size=(16, 16))
    np.savetxt(folder / "map.txt", height)
    return {**make_chain(folder), "map": folder / "map.txt"}


def require_interrupted(command, files, out, number, capfd):
    """The command ends with the line and the status of the signal, and leaves no file."""
    words = [word.format(**files, out=out) for word in shlex.split(COMMANDS[command])]
    capfd.readouterr()
    assert main([command, *words]) == 128 + number
    assert capfd.readouterr().err.splitlines()[-1] == f"asperity: {COMMAND_LINE}"
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("command", COMMANDS)
def test_a_signal_ends_a_command(command, files, tmp_path, capfd, monkeypatch):
    """Ctrl-C at its begin, and SIGTERM when everything is computed, before a file gets its name."""
    module = import_module(f"asperity.cli.commands.{command}")
    with monkeypatch.context() as patch:
        patch.setattr(module, "run", signalling(signal.SIGINT, module.run))
        require_interrupted(command, files, tmp_path, signal.SIGINT, capfd)
    if command in WITHOUT_FILES:
        monkeypatch.setattr(module, "print", signalling(signal.SIGTERM, print), raising=False)
    for name in ("rename", "replace"):
        monkeypatch.setattr(os, name, signalling(signal.SIGTERM, getattr(os, name)))
    require_interrupted(command, files, tmp_path, signal.SIGTERM, capfd)


WHILE_IMPORTING = """
import signal, sys
import asperity_command

class Finder:
    def find_spec(name, path=None, target=None):
        if name.startswith("asperity"):
            signal.raise_signal(int(sys.argv[1]))

sys.meta_path.insert(0, Finder)
asperity_command.main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_the_package_is_imported_ends_with_the_line(number):
    found = subprocess.run(
        [sys.executable, "-c", WHILE_IMPORTING, str(int(number))], capture_output=True, text=True, timeout=60
    )
    assert (found.returncode, found.stderr) == (128 + number, f"asperity: {COMMAND_LINE}\n")


def test_a_signal_ends_the_check_of_a_configuration(monkeypatch, capfd):
    monkeypatch.setattr(checking, "_check", lambda _: signal.raise_signal(signal.SIGTERM))
    assert checking.main(["check", "mine.yaml"]) == 143
    assert capfd.readouterr().err == "config: interrupted; run the same command again\n"


IGNORING = """
import signal, sys, time
from asperity.results.atomic import atomic_write
from asperity.runtime import interrupts
interrupts.GRACE = interrupts.AGAIN = 0.1
with interrupts.interruptible("ended"), atomic_write(sys.argv[1]) as unfinished:
    unfinished.write_text("half")
    while True:
        try:
            signal.raise_signal(signal.SIGTERM) if sys.argv[2] == "once" else None
            sys.argv[2] = "never"
            time.sleep(60)
        except BaseException:
            pass
"""


def test_a_command_whose_library_ignores_the_signal_ends_too(tmp_path):
    path = tmp_path / "result.nc"
    found = subprocess.run(
        [sys.executable, "-c", IGNORING, path, "once"], capture_output=True, text=True, timeout=60
    )
    assert (found.returncode, found.stderr) == (143, "ended\n")
    assert list(tmp_path.iterdir()) == []


TERMINATED = """
import signal, sys
from asperity.results.atomic import atomic_write
from asperity.runtime.logs import log_to
with log_to(sys.argv[1]), atomic_write(sys.argv[2]) as unfinished:
    unfinished.write_text("half")
    signal.raise_signal(signal.SIGTERM)
"""


def test_a_terminated_job_deletes_what_it_has_not_finished(tmp_path):
    log = tmp_path / "job.log"
    found = subprocess.run(
        [sys.executable, "-c", TERMINATED, log, tmp_path / "result.nc"], capture_output=True, timeout=60
    )
    assert (found.returncode, found.stderr) == (143, b"")
    assert list(tmp_path.iterdir()) == [log]
    assert "MB of memory" in log.read_text()


ORPHAN = """
import subprocess, sys, time
from asperity.runtime.interrupts import end_study_with_jobs

end_study_with_jobs()
subprocess.run(["sh", "-c", "sleep 600 & echo $!"], stdout=sys.stdout)
print("begun", flush=True)
time.sleep(600)
"""
"""A study that has started a program whose own parent has ended."""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems give such programs to their first process")
def test_a_study_ends_programs_whose_parents_have_ended():
    with subprocess.Popen([sys.executable, "-c", ORPHAN], stdout=subprocess.PIPE, text=True) as study:
        number = int(study.stdout.readline())
        assert study.stdout.readline() == "begun\n"
        program = psutil.Process(number)
        study.send_signal(signal.SIGTERM)
        assert study.wait(timeout=30) == 128 + signal.SIGTERM
        assert not program.is_running() or program.status() == "zombie"
