"""Progress bars, and the log of a job."""

import logging
import subprocess
import sys

import pytest

from asperity.study import progress_and_log as runtime
from asperity.study.progress_and_log import ProgressBar

JOB = """
import os, warnings
from types import SimpleNamespace
from asperity.study.progress_and_log import job
given = SimpleNamespace(rule="contact", wildcards=["a", "1"], log=[{log!r}], params={{"fft_engine": "ducc0"}})
with job(given) as progress:
    print("printed", flush=True)
    warnings.warn("warned")
    os.system("echo from a program")
    if {fail}:
        raise ValueError("poisson = 0.6: too much")
"""


@pytest.mark.parametrize("fail", [False, True])
def test_log_holds_everything_a_job_prints(tmp_path, fail):
    log = tmp_path / "logs/job.log"
    command = [sys.executable, "-c", JOB.format(log=str(log), fail=fail)]
    run = subprocess.run(command, capture_output=True, text=True)
    text = log.read_text()
    for words in ("contact a 1: begun", "printed", "warned", "from a program"):
        assert words in text
    assert (run.stdout, run.stderr, run.returncode) == ("", "", int(fail))
    assert text.strip().endswith("ValueError: poisson = 0.6: too much") == fail
    assert ("contact a 1: done" in text) == (not fail)


def test_progress_is_logged_without_a_terminal(monkeypatch, caplog):
    monkeypatch.setattr(runtime, "SECONDS_BETWEEN_LINES", 0.0)
    with caplog.at_level(logging.INFO, "asperity"), ProgressBar("100 %s {x}") as report:
        report(1, 4)
        report(0, 0)
    texts = [record.getMessage() for record in caplog.records]
    assert texts[0] == "100 %s {x}: begun"
    assert texts[1].startswith("100 %s {x}:  25 % after 0 s")
    assert texts[2].startswith("100 %s {x}: 100 % after")
