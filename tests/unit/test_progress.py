"""Progress bars and log files of jobs."""

import io
import logging
import re
import subprocess
import sys

import pytest

from asperity.runtime import progress
from asperity.runtime.logs import error_of
from asperity.runtime.progress import ProgressBar

JOB = """
import os, warnings
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
with log_to({log!r}), ProgressBar("contact") as progress:
    print("printed")
    warnings.warn("warned")
    os.system("echo from a program")
    progress(1, 4)
    if {fail}:
        raise ValueError("poisson = 0.6: too much")
print("after")
"""


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("fail", [False, True])
def test_the_log_holds_everything_that_a_job_prints(tmp_path, fail):
    log = tmp_path / "logs" / "job.log"
    run = subprocess.run(
        [sys.executable, "-c", JOB.format(log=str(log), fail=fail)], capture_output=True, text=True
    )
    text = log.read_text()
    for words in ("contact: begun", "printed", "warned", "from a program"):
        assert words in text
    assert re.search(r" took \d+\.\d s of processor time, \S+ MB of memory\n$", text)
    assert run.stderr == ""
    assert run.returncode == fail
    assert run.stdout == ("" if fail else "after\n")
    assert ("Traceback" in text) == fail
    assert ("contact: done" in text) == (not fail)
    if fail:
        said = f"results/a.nc: poisson = 0.6: too much (ValueError) [{log}]"
        assert error_of([log], "results/a.nc") == said


def test_errors_of_the_package_name_the_output_unless_they_name_another_file(tmp_path):
    log = tmp_path / "job.log"
    log.write_text("asperity.errors.ConvergenceError: stopped: residual 1\ntook 1 s\n")
    assert error_of([log], "a.nc") == f"a.nc: stopped: residual 1 [{log}]"
    log.write_text("asperity.errors.DatasetError: b.nc: damaged\n")
    assert error_of([log], "a.nc") == f"b.nc: damaged [{log}]"


@pytest.mark.parametrize("label", ["contact", "{", "{0} {x!r}", "100 %s %", "a: "])
def test_a_terminal_shows_a_bar_with_any_label(monkeypatch, label):
    monkeypatch.setattr("sys.stderr", Terminal())
    with ProgressBar(label) as report:
        report(1, 4)
    assert f"{label}" in sys.stderr.getvalue()
    assert " 25% |" in sys.stderr.getvalue()


def test_without_a_terminal_the_remaining_time_is_logged(monkeypatch, caplog):
    monkeypatch.setattr(progress, "SECONDS_BETWEEN_LINES", 0.0)
    with caplog.at_level(logging.INFO, "asperity"), ProgressBar("100 %s {x}") as report:
        report(1, 4)
        report(0, 0)
    texts = [record.getMessage() for record in caplog.records]
    assert texts[0] == "100 %s {x}: begun"
    assert texts[1].startswith("100 %s {x}:  25 %, about ")
    assert texts[2].startswith("100 %s {x}: 100 %, about 0 s")


def test_a_program_that_a_job_runs_counts_with_the_job(tmp_path):
    log = tmp_path / "job.log"
    program = "import time; held = bytearray(300_000_000)\nwhile time.process_time() < 0.5: pass"
    code = (
        "import subprocess, sys\nfrom asperity.runtime.logs import log_to\n"
        f"with log_to({str(log)!r}):\n    subprocess.run([sys.executable, '-c', {program!r}], check=True)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    seconds, memory = map(float, re.search(r"took (\S+) s of .*, (\d+) MB", log.read_text()).groups())
    assert seconds >= 0.5
    assert 310 < memory < 450
