"""Packages, memory, disk and processes: what is missing is named, and Linux is not needed."""

import os
import re
import subprocess
import sys
import time

import numpy as np
import psutil
import pytest

import asperity as asp
from asperity.core import packages, system
from asperity.core.errors import PreflightError
from asperity.study import preflight_and_manifest
from asperity.study.preflight_and_manifest import require_memory, require_space


@pytest.mark.parametrize(
    ("hidden", "message"),
    [
        (("yaml",), "not installed: pyyaml; install with: pip install asperity"),
        (("matplotlib",), 'not installed: matplotlib; install with: pip install "asperity[plot]"'),
        (
            ("h5py", "matplotlib"),
            'not installed: matplotlib, h5py; install with: pip install "asperity[maps]"',
        ),
        (("skfem", "yaml"), 'not installed: pyyaml, scikit-fem; install with: pip install "asperity[study]"'),
    ],
)
def test_missing_packages_are_named_with_their_extra(monkeypatch, hidden, message):
    packages.require()
    monkeypatch.setattr(packages, "find_spec", lambda name: None if name in hidden else name)
    with pytest.raises(packages.MissingPackageError, match=f"^{re.escape(message)}$"):
        packages.require()


def test_job_larger_than_the_memory_is_refused(monkeypatch):
    require_memory({})
    monkeypatch.setattr(preflight_and_manifest, "available_memory", lambda: 2000.0)
    with pytest.raises(PreflightError, match="needs about 4 GB of memory, this machine has 2 GB; choose"):
        require_memory({"c.nc": 4000})


def test_a_control_group_limits_the_memory(monkeypatch, tmp_path):
    machine = system.available_memory()
    assert 0 < machine <= psutil.virtual_memory().total / 1e6
    path = tmp_path / "memory.max"
    monkeypatch.setattr(system, "GROUP_LIMITS", (str(path),))
    path.write_text("max\n")
    assert system.available_memory() >= machine
    path.write_text(f"{2**20}\n")
    assert system.available_memory() == 2**20 / 1e6


def test_space_is_that_of_the_disk(tmp_path):
    require_space(tmp_path, 0)
    with pytest.raises(PreflightError, match=r"about 1e\+15 MB will be written, \S+ MB are free; free some"):
        require_space(tmp_path, 1e15)


def test_package_imports_without_unix_modules():
    code = (
        "import sys; sys.modules |= dict.fromkeys(('fcntl', 'resource', 'grp', 'pwd', 'termios'));"
        "import asperity.core.system, asperity.study.preflight_and_manifest"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


SOLVE = (
    "import asperity as asp; height = asp.self_affine((16, 16), 0.8, 0.5, 0.25, rms_height=1e-3, seed=1);"
    "print(asp.solve_contact(height, asp.Solid(1.0, 0.3), contact_area_fraction=0.1, threads=2))"
)


TRANSFORM = (
    "import numpy as np; from asperity.fourier.engine import current_engine;"
    "current_engine().forward(np.ones((8, 8)), np.empty((8, 5), complex), threads=2)"
)


@pytest.mark.parametrize("threads", ["4,2", "", "abc", "-1"])
def test_numbers_of_threads_that_openmp_ignores(threads):
    """OpenMP allows a number for each level, and ignores what is none; ducc0 fails at both."""
    given = {**os.environ, "OMP_NUM_THREADS": threads}
    given.pop("DUCC0_NUM_THREADS", None)
    subprocess.run([sys.executable, "-c", TRANSFORM], check=True, env=given)


def test_loops_without_machine_code_are_refused():
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    found = subprocess.run([sys.executable, "-c", SOLVE], capture_output=True, text=True, env=environment)
    assert found.stderr.splitlines()[-1].startswith("ImportError: NUMBA_DISABLE_JIT is set: ")


@pytest.mark.parametrize("count", ["0", "-3"])
def test_a_wrong_number_of_threads_names_its_variable(count):
    given = {**os.environ, "NUMBA_NUM_THREADS": count}
    found = subprocess.run([sys.executable, "-c", SOLVE], capture_output=True, text=True, env=given)
    line = f"ImportError: NUMBA_NUM_THREADS = '{count}': a whole number > 0 is needed"
    assert found.stderr.splitlines()[-1] == line


NO_CACHE = """
from numba.core import caching
caching.CacheImpl._locator_classes = []  # as where no folder is writable
import numpy
from asperity.contact.contact_nodes import dot
print(dot(numpy.ones(4), numpy.ones(4)))
"""


def test_loops_are_compiled_where_no_folder_is_writable():
    found = subprocess.run([sys.executable, "-c", NO_CACHE], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["4.0"]
    (line,) = found.stderr.splitlines()
    assert "NUMBA_CACHE_DIR" in line


def test_a_locked_result_is_named(tmp_path):
    """By a process that has opened it to write, as another program does."""
    path = tmp_path / "contact.nc"
    contact = asp.solve_contact(np.eye(8), asp.Solid(1.0, 0.3), mean_pressure=1e-3)
    asp.write_result(contact.to_dataset(), path, "contact")
    fcntl = pytest.importorskip("fcntl")
    with open(path, "rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(asp.results.dataset.DatasetError, match="locked by another program"):
            asp.read_result(path)
    assert asp.read_result(path).sizes["y"] == 8


def test_error_state_of_the_caller_does_not_matter():
    height, solid = asp.self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1), asp.Solid(1.0, 0.3)
    with np.errstate(all="raise"):
        contact = asp.solve_contact(height, solid, mean_pressure=1e-4)
        asp.analyse_stress(contact)
        assert len([*asp.stress_planes(contact, [0.0, 0.1, 3.0])]) == 3
        assert np.geterr()["under"] == "raise"
        with pytest.raises(FloatingPointError):
            np.float64(1e-300) * np.float64(1e-300)


NAME = "from asperity.core.system import process_name; print(process_name(), flush=True); input()"


def test_a_process_runs_until_it_ends():
    """Also if another process has its number now; nothing is known of those on other hosts."""
    own = system.process_name()
    with subprocess.Popen(
        [sys.executable, "-c", NAME], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        name = other.stdout.readline().decode().strip()
        assert not system.has_ended(name)
        assert not system.has_ended(own)
        other.kill()
        while not system.has_ended(name):  # also before its parent has asked how it ended
            time.sleep(0.01)
    assert system.has_ended(name)
    host, process, start = own.rsplit(".", 2)
    assert system.has_ended(f"{host}.{process}.{int(start) - 100}")
    assert not system.has_ended(f"other-{name}")


def test_edited_modules_are_newer_than_the_machine_code(tmp_path, monkeypatch):
    package, cache = tmp_path / "package", tmp_path / "cache"
    monkeypatch.setattr(system, "__file__", str(package / "core/system.py"))
    module, code, other = package / "a.py", package / "__pycache__/a.nbi", cache / "a.nbi"
    for time_, path in enumerate((module, code, other), 1):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
        os.utime(path, (time_, time_))
    assert system.is_compiled()
    os.utime(module, (2.5, 2.5))
    assert not system.is_compiled()
    assert system.is_compiled(cache)
