"""A killed study goes on with the same command. `make test-faults` kills it fifty times at random moments."""

import os
import shutil

import pytest
from faults import RESULTS, differences, finished, kill_and_run_again, mark_unfinished, run_study, study
from project import copy_project, run

from asperity.errors import PreflightError
from asperity.runtime.preflight import claim


def locked_and_made(folder, path):
    """Condition that holds as soon as a result is there; until then the folder is reserved by the study."""

    def holds(_):
        if not (folder / path).exists():
            return False
        with pytest.raises(PreflightError, match="another study is running here"):
            claim(folder / RESULTS)
        return True

    return holds


@pytest.fixture(scope="module")
def kills(tiny_study, tmp_path_factory):
    """Two kills, after the surface and after the contact, and then a run to the end."""
    folder = copy_project(tmp_path_factory.mktemp("killed") / "project")
    made = (f"{RESULTS}/{stage}/hurst_08/seed1.nc" for stage in ("surface", "contact"))
    conditions = [locked_and_made(folder, path) for path in made]
    return folder, list(kill_and_run_again(folder, tiny_study.folder, conditions))


def test_a_killed_study_ends_with_the_results_of_an_undisturbed_one(kills, tiny_study):
    folder, killed = kills
    assert len(killed) == 2
    assert not any(kill.differing for kill in killed)
    assert finished(folder).keys() == finished(tiny_study.folder).keys()


def test_no_finished_job_is_repeated_and_nothing_is_left_to_do(kills):
    folder, killed = kills
    assert all(kill.finished for kill in killed)
    assert not any(kill.repeated for kill in killed)
    again = run(folder, *study("--dry-run"))
    assert "Nothing to be done" in again.stdout + again.stderr


def test_a_partial_file_would_be_noticed(kills, tiny_study):
    folder, _ = kills
    path = folder / f"{RESULTS}/stress/hurst_08/.seed1.nc.99999999.unfinished"
    path.write_bytes(b"half")
    assert differences(folder, tiny_study.folder) == ("stress/hurst_08/.seed1.nc.99999999.unfinished",)
    path.unlink()


def test_a_kill_between_the_end_of_the_compiler_and_its_record_leaves_no_job_out(tiny_study, tmp_path):
    folder = shutil.copytree(tiny_study.folder, tmp_path / "project")
    for path in (folder / RESULTS).iterdir():
        if path.is_dir() and path.name != "machine_code":
            shutil.rmtree(path)
    for path in (folder / RESULTS / "machine_code").iterdir():
        mark_unfinished(folder, str(path.relative_to(folder)))
    plan = run(folder, *study("--dry-run"))
    jobs = {line.split()[0] for line in (plan.stdout + plan.stderr).splitlines() if len(line.split()) == 2}
    assert {"machine_code", "surface", "contact", "stress", "statistics", "figure", "verification"} <= jobs


def test_one_core_gives_the_same_results_and_compiles_nothing_anew(tiny_study, tmp_path):
    folder = shutil.copytree(tiny_study.folder, tmp_path / "project")
    for name in ("results", ".snakemake"):
        shutil.rmtree(folder / name)

    def caches():
        return {path: os.stat(path).st_mtime_ns for path in (folder / "src").rglob("*.nb[ic]")}

    before = caches()
    assert before
    run_study(folder, cores=1)
    assert differences(folder, tiny_study.folder) == ()
    assert caches() == before
