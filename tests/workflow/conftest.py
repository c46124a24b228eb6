"""The quick study, which all tests of the workflow look at, killed once and continued."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import pytest
from project import STUDY, copy_project, environment, snakemake


def place_in_order(item):
    """Rank of a test by its folder: the workflow takes longest, tests of single functions fill the gaps."""
    folder = item.path.parent.name
    return folder != "workflow", folder == "physics" or "unit" in item.path.parts


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Let one process run all tests of the study, and begin with the longest."""
    items.sort(key=place_in_order)
    for item in items:
        if "killed_study" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.xdist_group("study"))


class Study(NamedTuple):
    """A copy of the project in which the quick study has run, its results, and what the run printed."""

    folder: Path
    results: Path
    output: str


@pytest.fixture(scope="session")
def killed_study(tmp_path_factory):
    """The quick study, killed while the stress of a seed is computed, of which half is written.

    The folders of the project and of the results, the unfinished result, the finished ones with their times.
    The project holds its Python, in a folder with a space, and the results are outside of it.
    """
    folder = copy_project(tmp_path_factory.mktemp("quick") / "my project")
    (folder / ".venv").symlink_to(sys.prefix, target_is_directory=True)
    results = folder.parent / "own results"
    command = ["snakemake", "--cores", "2", *STUDY]
    with subprocess.Popen(command, cwd=folder, env=environment(folder), start_new_session=True) as study:
        while not (logs := [*results.glob("log/stress/*/seed1.log")]):
            assert study.poll() is None
            time.sleep(0.05)
        os.killpg(study.pid, signal.SIGKILL)
    surface = logs[0].parent.name
    stress = results / f"stress/{surface}/seed1.nc"
    assert not stress.exists()
    stress.parent.mkdir(parents=True, exist_ok=True)
    stress.write_bytes(b"half of a result")
    files = [results / stage / surface / "seed1.nc" for stage in ("surface", "contact")]
    return folder, results, stress, {path: path.stat().st_mtime_ns for path in files}


@pytest.fixture(scope="session")
def quick_study(killed_study):
    """The study and its page, continued by the same command after it was killed, as from a notebook."""
    folder, results, *_ = killed_study
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MPLBACKEND", "module://backend_of_a_notebook")
        found = snakemake(folder, "study", "report_page", "../own results/statistics/fault.nc", *STUDY)
    assert found.returncode == 0, found.stdout + found.stderr
    return Study(folder, results, found.stdout + found.stderr)
