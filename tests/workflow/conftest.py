"""Studies that several tests of the workflow look at, each run once."""

from pathlib import Path
from typing import NamedTuple

import pytest
from project import OWN, QUICK, copy_project, snakemake

STUDIES = ("quick_study", "own_study")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Let one process run all tests of a study, so that no other has to run the study again."""
    for item in items:
        for study in STUDIES:
            if study in getattr(item, "fixturenames", ()):
                item.add_marker(pytest.mark.xdist_group(study))


class Study(NamedTuple):
    """A copy of the project in which a study has run, and what the run printed."""

    folder: Path
    output: str


def studied(folder, *arguments):
    """Run a study in a copy of the project."""
    found = snakemake(copy_project(folder), *arguments)
    assert found.returncode == 0, found.stdout + found.stderr
    return Study(folder, found.stdout + found.stderr)


@pytest.fixture(scope="session")
def quick_study(tmp_path_factory):
    """The quick study on two cores."""
    return studied(tmp_path_factory.mktemp("quick") / "project", *QUICK)


@pytest.fixture(scope="session")
def own_study(tmp_path_factory):
    """A user's own study of a surface and a map, its results outside the project."""
    folder = tmp_path_factory.mktemp("own")
    return studied(folder / "project", *OWN, "--config", f"results={folder / 'own results'}")
