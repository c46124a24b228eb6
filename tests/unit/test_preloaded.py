"""Jobs in copies of a preloaded process end as their scripts end, and the process ends with the study."""

import ast
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from asperity.runtime import preloaded

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere jobs run their scripts themselves")

HEAD = """
import os, sys
from asperity.runtime.preloaded import run_in_copy
run_in_copy()
"""
TELL = "print(os.getpid(), 'json.tool' in sys.modules, flush=True)\n"
LONGEST = 30.0


@pytest.fixture
def process(monkeypatch):
    """A preloaded process of this one, which has imported a module that Python itself does not."""
    monkeypatch.setattr(preloaded.atexit, "register", lambda _: None)
    monkeypatch.setenv(preloaded.ADDRESS, "")
    process = preloaded.start(["json.tool", "no_such_module"])
    yield process
    process.communicate(timeout=LONGEST)


def job(folder, body, **options):
    """A job that runs a script."""
    script = folder / "script.py"
    script.write_text(HEAD + body)
    return subprocess.Popen(
        [sys.executable, script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


def told(folder, body, **options):
    """Process numbers of a job and of what ran its script, if that was preloaded, and the exit status."""
    started = job(folder, TELL + body, **options)
    out, _ = started.communicate(timeout=LONGEST)
    number, loaded = out.split()[:2]
    return started.pid, int(number), loaded == "True", started.returncode


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ("", 0),
        ("sys.exit(3)", 3),
        ("sys.exit('a reason')", 1),
        ("1 / 0", 1),
        ("os.kill(os.getpid(), 9)", 137),
    ],
)
def test_a_job_ends_as_its_script_ends(process, tmp_path, body, status):
    own, number, loaded, found = told(tmp_path, body)
    assert (loaded, found) == (True, status)
    assert number not in (own, process.pid)


def test_a_script_has_the_folder_environment_and_streams_of_its_job(process, tmp_path):
    body = "print(os.getcwd(), os.environ['HERE'], sys.argv)\nprint('wrong', file=sys.stderr)\n1 / 0"
    found = job(tmp_path, body, cwd=tmp_path, env={**os.environ, "HERE": "yes"})
    out, error = found.communicate(timeout=LONGEST)
    assert out == f"{tmp_path} yes ['{tmp_path / 'script.py'}']\n"
    assert error.startswith("wrong\n")
    assert error.endswith("ZeroDivisionError: division by zero\n")


def test_one_script_leaves_nothing_for_the_next(process, tmp_path):
    told(tmp_path, "sys.modules['json'].left = 1")
    assert told(tmp_path, "sys.exit(hasattr(sys.modules['json'], 'left'))")[-1] == 0


def test_a_job_that_is_ended_ends_its_copy(process, tmp_path):
    started = job(tmp_path, "import time\n" + TELL + "time.sleep(600)")
    copy = psutil.Process(int(started.stdout.readline().split()[0]))
    started.send_signal(signal.SIGKILL)
    started.communicate(timeout=LONGEST)
    copy.wait(timeout=LONGEST)
    assert not copy.is_running()


def test_without_a_preloaded_process_a_job_runs_its_script(process, tmp_path, monkeypatch):
    process.communicate(timeout=LONGEST)
    own, number, loaded, status = told(tmp_path, "sys.exit(3)")
    assert (own, loaded, status) == (number, False, 3)
    monkeypatch.delenv(preloaded.ADDRESS)
    own, number, loaded, status = told(tmp_path, "sys.exit(3)")
    assert (own, loaded, status) == (number, False, 3)


def test_jobs_of_another_user_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(preloaded.atexit, "register", lambda _: None)
    monkeypatch.setenv(preloaded.ADDRESS, "")
    other = tmp_path / "sitecustomize.py"  # read by the preloaded process alone
    other.write_text("import os\nos.getuid = lambda: 4242\n")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    process = preloaded.start(["json.tool"])
    own, number, loaded, status = told(tmp_path, "sys.exit(3)")
    assert (own, loaded, status) == (number, False, 3)
    process.communicate(timeout=LONGEST)


def test_every_script_of_the_study_begins_by_going_into_a_copy():
    scripts = list((Path(__file__).parents[2] / "workflow/scripts").glob("*.py"))
    assert len(scripts) > 15
    for script in scripts:
        _, first, second, *_ = ast.parse(script.read_text(encoding="utf-8")).body
        assert ast.unparse(first) == "from asperity.runtime.preloaded import run_in_copy", script.name
        assert ast.unparse(second) == "run_in_copy()", script.name


def test_the_process_ends_with_the_one_that_started_it():
    body = (
        "import os, signal\nfrom asperity.runtime import preloaded\n"
        "print(preloaded.start([]).pid, flush=True)\nos.kill(os.getpid(), signal.SIGKILL)"
    )
    found = subprocess.run([sys.executable, "-c", body], capture_output=True, text=True)
    until = time.monotonic() + LONGEST
    while psutil.pid_exists(int(found.stdout)) and time.monotonic() < until:
        time.sleep(0.01)
    assert not psutil.pid_exists(int(found.stdout))
