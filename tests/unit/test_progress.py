"""Progress and logs, seen from outside the process."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import pytest

JOB = """
import sys, warnings, logging, numpy as np
from asperity.runtime.progress import Progress, record
with record({log!r}), Progress("contact") as progress:
    print("printed")
    warnings.warn("warned")
    import os; os.system("echo from a child")
    progress(1, 4)
    if {fail}:
        raise ValueError("poisson = 0.6: too much")
"""


@pytest.mark.parametrize("fail", [False, True])
def test_the_log_holds_all_that_a_job_says(tmp_path, fail):
    log = tmp_path / "logs" / "job.log"
    run = subprocess.run(
        [sys.executable, "-c", JOB.format(log=str(log), fail=fail)], capture_output=True, text=True
    )
    text = log.read_text()
    for words in ("contact: begun", "printed", "warned", "from a child"):
        assert words in text
    assert re.search(r" took \d+\.\d s of processor time, [1-9]\d+ MB of memory\n$", text)
    assert run.stdout == ""
    assert run.returncode == fail
    if fail:
        assert "Traceback" in text
        assert run.stderr.strip() == f"ValueError: poisson = 0.6: too much (whole story in {log})"
    else:
        assert "contact: done" in text
        assert run.stderr == ""


def test_a_terminal_shows_a_bar_with_the_remaining_time(tmp_path):
    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 25, 80, 0, 0))
    code = JOB.format(log=str(tmp_path / "job.log"), fail=False)
    subprocess.run([sys.executable, "-c", code], stderr=follower, check=True)
    os.close(follower)
    shown = b""
    try:
        while chunk := os.read(leader, 4096):
            shown += chunk
    except OSError:
        pass
    os.close(leader)
    assert "contact:  25% |" in shown.decode()


def test_a_program_that_a_job_runs_counts_with_it(tmp_path):
    log = tmp_path / "job.log"
    program = "import time; held = bytearray(300_000_000); " + "\nwhile time.process_time() < 1: pass"
    code = (
        "import subprocess, sys\nfrom asperity.runtime.progress import record\n"
        f"with record({str(log)!r}):\n    subprocess.run([sys.executable, '-c', {program!r}], check=True)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    seconds, memory = map(float, re.search(r"took (\S+) s of .*, (\d+) MB", log.read_text()).groups())
    assert 1 <= seconds < 10
    assert 310 < memory < 450
