"""Memory and processes, and packages without what Linux alone has."""

import os
import subprocess
import sys

from asperity.core import system


def test_package_imports_without_unix_modules():
    code = (
        "import sys; sys.modules |= dict.fromkeys(('fcntl', 'resource', 'grp', 'pwd', 'termios'));"
        "import asperity.core.system, asperity.study.run"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


SOLVE = (
    "import asperity as asp; height = asp.self_affine((16, 16), 0.8, 0.5, 0.25, rms_height=1e-3, seed=1);"
    "print(asp.solve(height, asp.Layer(1.0, 0.3), area_fraction=0.1, threads=2))"
)


def test_nested_numbers_of_threads_are_accepted():
    """OpenMP allows a number for each level, of which ducc0 takes none."""
    subprocess.run([sys.executable, "-c", SOLVE], check=True, env={**os.environ, "OMP_NUM_THREADS": "4,2"})


def test_loops_without_machine_code_are_refused():
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    found = subprocess.run([sys.executable, "-c", SOLVE], capture_output=True, text=True, env=environment)
    assert found.stderr.splitlines()[-1].startswith("ImportError: NUMBA_DISABLE_JIT is set: ")


def test_a_process_runs_until_it_ends():
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        assert system.is_running(other.pid)
        assert system.is_running(os.getpid())
    assert not system.is_running(other.pid)
