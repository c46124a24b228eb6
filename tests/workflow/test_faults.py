"""Killed at any moment, the study goes on with the same command; `make test-faults` kills it fifty times."""

import random

import pytest
from faults import STUDY, differences, finished, kill_and_run_again
from project import copy_project, run


@pytest.fixture(scope="module")
def kills(tiny_study, tmp_path_factory):
    """Two kills, the first after 64 % of the time it takes, after which the study has been let finish."""
    folder = copy_project(tmp_path_factory.mktemp("killed") / "project")
    return folder, list(
        kill_and_run_again(folder, tiny_study.folder, 2, random.Random(38), tiny_study.seconds)
    )


def test_a_killed_study_finishes_and_its_results_are_those_of_an_undisturbed_one(kills, tiny_study):
    folder, killed = kills
    assert len(killed) == 2
    assert not any(kill.differing for kill in killed)
    assert finished(folder).keys() == finished(tiny_study.folder).keys()


def test_no_finished_job_was_repeated_and_nothing_is_left_to_do(kills):
    folder, killed = kills
    assert any(kill.finished for kill in killed)
    assert not any(kill.repeated for kill in killed)
    again = run(folder, STUDY[0], "--dry-run", *STUDY[1:])
    assert "Nothing to be done" in again.stdout + again.stderr


def test_a_partial_file_would_be_seen(kills, tiny_study):
    folder, _ = kills
    path = folder / "results/tiny/stress/hurst_08/.seed1.nc.99999999.unfinished"
    path.write_bytes(b"half")
    assert differences(folder, tiny_study.folder) == ("stress/hurst_08/.seed1.nc.99999999.unfinished",)
    path.unlink()
