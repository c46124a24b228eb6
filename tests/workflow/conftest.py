"""The quick study, run once from clean for all tests of the workflow."""

import resource
from pathlib import Path
from typing import NamedTuple

import pytest
from faults import run_study
from project import QUICK, copy_project, snakemake


class Study(NamedTuple):
    """A copy of the project in which the quick study has run, and the processor time it took."""

    folder: Path
    seconds: float


@pytest.fixture(scope="session")
def quick_study(tmp_path_factory):
    folder = copy_project(tmp_path_factory.mktemp("project"))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = snakemake(folder, *QUICK)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert found.returncode == 0, found.stdout + found.stderr
    return Study(folder, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


@pytest.fixture(scope="session")
def tiny_study(tmp_path_factory):
    """The stages of one small surface, and the time they took on the clock."""
    folder = copy_project(tmp_path_factory.mktemp("tiny") / "project")
    return Study(folder, run_study(folder).seconds)
