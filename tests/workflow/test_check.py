"""The drift check: passes on the quick study, and fails when a kernel is changed by one percent."""

import shutil

import pytest
from project import ROOT, copy_project, run, script

from asperity.results import dataset

REFERENCE = "tests/reference/quick.json"
ONE = ("check.py", "--results", "results/quick", "--no-run")
KERNEL = "elasticity/kernels.py", "(1.0 + d) * a, (1.0 - d) * a", "(1.0 + d) * a, (1.0 - d) * 1.01 * a"
"""The kernel of the lateral stress below the surface of a half-space."""


@pytest.fixture
def folder(tmp_path):
    """What the check reads besides results."""
    for name in ("config", "tests/reference"):
        shutil.copytree(ROOT / name, tmp_path / name)
    return tmp_path


def test_the_quick_study_has_the_numbers_of_the_reference(quick_study):
    said, error = script(quick_study.folder, *ONE)
    assert "numbers as in tests/reference/quick.json" in said, error


def test_one_percent_in_a_kernel_is_caught(tmp_path):
    folder = copy_project(tmp_path)
    module, was, now = KERNEL
    source = folder / "src/asperity" / module
    assert was in source.read_text()
    source.write_text(source.read_text().replace(was, now))
    found = run(folder, "python", "workflow/check.py", "--surfaces", "cutoff_64")
    assert found.returncode == 1
    assert "numbers drifted" in found.stderr


def test_a_number_that_moved_or_is_missing_or_new_is_drift_and_an_update_takes_it(quick_study, folder):
    results = quick_study.folder / "results/quick/statistics"
    shutil.copytree(results, folder / "results/quick/statistics")
    place = folder / "results/quick/statistics/hurst_08.nc"
    statistics = dataset.read(place)
    statistics["seed_mean_pressure"] *= 1.01
    ratios = statistics["poisson"].values
    statistics = statistics.assign_coords(poisson=[*ratios[:-1], 0.49])
    dataset.write(statistics, place, title="tampered", settings=dataset.settings_of(statistics))
    _, error = script(folder, *ONE, "--surfaces", "hurst_08")
    moved = {line.split()[0]: line.split()[1:3] for line in error.splitlines() if "/seed1/" in line}
    changed = [name for name, values in moved.items() if "-" not in values]
    assert changed == ["hurst_08/seed1/contact.mean_pressure"]
    assert moved["hurst_08/seed1/xx.p99@0.5"][1] == moved["hurst_08/seed1/xx.p99@0.49"][0] == "-"
    assert script(folder, *ONE, "--update")[1] == ""
    assert script(folder, *ONE)[1] == ""
    assert "@0.49" in (folder / REFERENCE).read_text()
    assert "@0.49" not in (ROOT / REFERENCE).read_text()


def test_missing_statistics_are_named(folder):
    assert script(folder, *ONE)[1] == "results/quick: no statistics; run without --no-run"
