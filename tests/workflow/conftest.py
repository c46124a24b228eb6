"""The quick study, run from clean for all tests of the workflow."""

import resource
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from faults import run_study
from project import QUICK, copy_project, snakemake

IMPORTS = "import matplotlib.figure, numba, scipy.ndimage, xarray"


class Study(NamedTuple):
    """A copy of the project in which a study has run, the time it took, and that of its imports then."""

    folder: Path
    seconds: float
    imports: float = 0.0


def import_seconds():
    """Processor time of importing what most jobs import: how fast the machine is for them at this moment."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    for _ in range(3):
        subprocess.run([sys.executable, "-c", IMPORTS], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / 3


def run_quick(folder, cores):
    """The quick study in a folder."""
    imports = import_seconds()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = snakemake(folder, *QUICK, cores=cores)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert found.returncode == 0, found.stdout + found.stderr
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Study(folder, seconds, 0.5 * (imports + import_seconds()))


@pytest.fixture(scope="session")
def quick_study(tmp_path_factory):
    """On two cores, with nothing compiled before."""
    return run_quick(copy_project(tmp_path_factory.mktemp("project"), compiled=False), cores=2)


@pytest.fixture(scope="session")
def second_study(quick_study, tmp_path_factory):
    """On one core, with all compiled that the first has compiled."""
    folder = copy_project(tmp_path_factory.mktemp("second"), compiled=False)
    shutil.copytree(quick_study.folder / "src", folder / "src", dirs_exist_ok=True)
    return run_quick(folder, cores=1)


@pytest.fixture(scope="session")
def tiny_study(tmp_path_factory):
    """The stages of one small surface, and the time they took on the clock."""
    folder = copy_project(tmp_path_factory.mktemp("tiny") / "project")
    return Study(folder, run_study(folder).seconds)
