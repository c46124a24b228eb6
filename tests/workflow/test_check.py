"""The drift check: passes on the quick study, and fails when a kernel is changed by one percent."""

import shutil

import pytest
from project import ROOT, copy_project, run

from asperity.results import dataset

CHECK = ("python", "workflow/check.py")
REFERENCE = "tests/reference/quick.json"
ONE = ("--results", "results/quick", "--no-run")


@pytest.fixture(scope="module")
def quick(quick_study, tmp_path_factory):
    """The folder of the quick study."""
    return quick_study.folder


def test_the_quick_study_has_the_numbers_of_the_reference(quick):
    found = run(quick, *CHECK, *ONE)
    assert found.returncode == 0, found.stderr
    assert "numbers as in tests/reference/quick.json" in found.stdout


KERNEL = "elasticity/kernels.py", "(one + d) * a, (one - d) * a", "(one + d) * a, (one - d) * 1.01 * a"
"""The kernel of the lateral stress below the surface of a half-space."""

TERM = "stress/planes/periodic.py", "-(a * own * own * along", "-(a * 1.01 * own * own * along"
"""The term of the lateral stress under a periodic pressure."""


@pytest.mark.parametrize(
    ("change", "caught", "unmoved"),
    [
        # The highest peaks of the lateral stress lie in the surface, lower ones of a free solid below it.
        # The von Mises stress has the lateral stress as a part, the shear stress xz has not.
        (
            KERNEL,
            {"free/xx.p50@0.33", "free/xx.mean@0.33", "free/xx.depth@0.33", "profile.largest@0.33"},
            {"xz.p99@0.33"},
        ),
        (TERM, {"xx.p99@0.33"}, {"xz.p99@0.33", "zz.p99@0.33"}),
    ],
)
def test_one_percent_in_a_kernel_is_caught(tmp_path, change, caught, unmoved):
    folder = copy_project(tmp_path)
    module, was, now = change
    source = folder / "src/asperity" / module
    assert was in source.read_text()
    source.write_text(source.read_text().replace(was, now))
    found = run(folder, *CHECK, "--surfaces", "cutoff_64")
    assert found.returncode == 1
    lines = found.stderr.splitlines()
    assert lines[0].endswith("numbers drifted:")
    assert lines[1].split()[:4] == ["name", "was", "is", "tolerance"]
    moved = {line.split()[0] for line in lines[2 : lines.index("")]}
    assert {f"cutoff_64/seed1/{name}" for name in caught} <= moved
    assert moved.isdisjoint(f"cutoff_64/seed1/{name}" for name in {*unmoved, "contact.mean_pressure"})


def test_a_number_that_moved_or_is_missing_or_new_is_drift_and_an_update_takes_it(quick, tmp_path):
    folder = copy_project(tmp_path)
    place = "results/quick/statistics/hurst_08.nc"
    statistics = dataset.read(quick / place)
    statistics["seed_mean_pressure"] *= 1.01
    ratios = statistics["poisson"].values
    statistics = statistics.assign_coords(poisson=[*ratios[:-1], 0.49])
    dataset.write(statistics, folder / place, title="tampered", settings=dataset.settings_of(statistics))
    found = run(folder, *CHECK, *ONE, "--surfaces", "hurst_08")
    assert found.returncode == 1
    moved = {line.split()[0]: line.split()[1:3] for line in found.stderr.splitlines() if "/seed1/" in line}
    assert {name for name, values in moved.items() if "-" not in values} == {
        "hurst_08/seed1/contact.mean_pressure"
    }
    assert moved["hurst_08/seed1/xx.p99@0.5"][1] == moved["hurst_08/seed1/xx.p99@0.49"][0] == "-"
    others = [path for path in (quick / "results/quick/statistics").iterdir() if path.name != "hurst_08.nc"]
    for path in others:
        shutil.copy(path, folder / "results/quick/statistics")
    assert run(folder, *CHECK, *ONE, "--update").returncode == 0
    assert run(folder, *CHECK, *ONE).returncode == 0
    assert "@0.49" in (folder / REFERENCE).read_text()
    assert "@0.49" not in (ROOT / REFERENCE).read_text()


def test_missing_statistics_are_named(tmp_path):
    folder = copy_project(tmp_path)
    found = run(folder, *CHECK, *ONE)
    assert found.returncode == 1
    assert "no statistics" in found.stderr
