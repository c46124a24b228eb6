"""Ctrl-C and SIGTERM end a study with its jobs. `make soak` interrupts it at random moments."""

import signal
import subprocess
import time

import psutil
import pytest
from faults import RESULTS, results, study
from project import copy_project, environment

LONGEST_END = 60.0
"""Seconds after which a study that was told to end is called stuck, on a machine busy with other tests."""


def interrupted(folder, number, path):
    """The study, sent a signal as soon as a file is there: its exit status, and the lines that it printed."""
    process = subprocess.Popen(
        study(),
        cwd=folder,
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    while not (folder / path).exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    began = time.monotonic()
    lines = process.communicate()[0].splitlines()
    assert time.monotonic() - began < LONGEST_END
    return process.returncode, lines


def working_in(folder):
    """Processes that work in a folder."""
    found = []
    for process in psutil.process_iter():
        try:
            found += [process] if process.cwd() == str(folder) else []
        except (psutil.AccessDenied, psutil.NoSuchProcess):
            continue
    return found


@pytest.mark.xdist_group("tiny_study")
def test_a_signal_ends_the_study_and_its_jobs_with_one_line(tmp_path):
    folder = copy_project(tmp_path / "project")
    moments = {
        signal.SIGINT: f"{RESULTS}/.running",  # before the first job
        signal.SIGTERM: f"{RESULTS}/log/contact/hurst_08/seed1.log",  # the surface is finished
    }
    for number, path in moments.items():
        status, lines = interrupted(folder, number, path)
        assert status == 128 + number
        assert lines[-1].startswith("study: interrupted; finished results are kept, run the same command")
        assert not any(line.startswith(("study: results", "Traceback")) for line in lines)
        assert working_in(folder) == []
        assert not any(path.suffix == ".unfinished" for path in results(folder))
    log = folder / RESULTS / "log/surface/hurst_08/seed1.log"
    assert "fingerprint" in log.read_text()
