"""Studies that several tests of the workflow look at, each run once."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import pytest
from project import OWN, QUICK, copy_project, environment, snakemake

STUDIES = ("quick_study", "own_study")


def place_in_order(item):
    """Rank of a test by its folder: the workflow takes longest, tests of single functions fill the gaps."""
    folder = item.path.parent.name
    return folder != "workflow", folder in ("physics", "unit")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Let one process run all tests of a study, and begin with the longest."""
    items.sort(key=place_in_order)
    for item in items:
        for study in STUDIES:
            if study in getattr(item, "fixturenames", ()):
                item.add_marker(pytest.mark.xdist_group(study))


class Study(NamedTuple):
    """A copy of the project in which a study has run, its results, and what the run printed."""

    folder: Path
    results: Path
    output: str


def studied(folder, results, *arguments):
    """Run a study and make its page, in a copy of the project."""
    found = snakemake(folder, "study", "report_page", *arguments)
    assert found.returncode == 0, found.stdout + found.stderr
    return Study(folder, results, found.stdout + found.stderr)


@pytest.fixture(scope="session")
def quick_study(tmp_path_factory):
    """The quick study on two cores, as from a notebook, in a folder with a space that holds Python too."""
    folder = copy_project(tmp_path_factory.mktemp("quick") / "my project")
    (folder / ".venv").symlink_to(sys.prefix, target_is_directory=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MPLBACKEND", "module://backend_of_a_notebook")
        return studied(folder, folder / "results/quick", *QUICK)


def own(results):
    """Options of a user's own study of a surface and a map, its results outside the project."""
    return *OWN, "--config", f"results={results}"


@pytest.fixture(scope="session")
def killed_study(tmp_path_factory):
    """The own study, killed while the stress of the first seed is computed, of which half is written.

    The folders of the project and of the results, and the finished results with their times.
    """
    folder = copy_project(tmp_path_factory.mktemp("own") / "project")
    results = folder.parent / "own results"
    stress = results / "stress/fine/seed1.nc"
    command = ["snakemake", "--cores", "2", *own(results), "--", str(stress)]
    with subprocess.Popen(command, cwd=folder, env=environment(folder), start_new_session=True) as study:
        while not (results / "log/stress/fine/seed1.log").exists():
            assert study.poll() is None
            time.sleep(0.05)
        os.killpg(study.pid, signal.SIGKILL)
    assert not stress.exists()
    stress.parent.mkdir(parents=True, exist_ok=True)
    stress.write_bytes(b"half of a result")
    files = [results / stage / "fine/seed1.nc" for stage in ("surface", "contact")]
    return folder, results, {path: path.stat().st_mtime_ns for path in files}


@pytest.fixture(scope="session")
def own_study(killed_study):
    """The own study, continued by the same command after it was killed."""
    folder, results, _ = killed_study
    return studied(folder, results, *own(results))
