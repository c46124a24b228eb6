"""The drift check: quiet on the quick study, loud when the physics is changed by one percent."""

import json

import pytest
from project import copy_project, run

CHECK = ("python", "workflow/check.py")
ONE = ("--results", "results/quick", "--no-run")


@pytest.fixture(scope="module")
def quick(quick_study, tmp_path_factory):
    """The summaries and the reference, to be tampered with."""
    return quick_study.folder


def test_the_quick_study_has_the_numbers_of_the_reference(quick):
    found = run(quick, *CHECK, *ONE)
    assert found.returncode == 0, found.stderr
    assert "numbers as in tests/reference/quick.json" in found.stdout


def test_one_percent_in_a_kernel_is_caught(tmp_path):
    folder = copy_project(tmp_path)
    kernels = folder / "src/asperity/elasticity/kernels.py"
    was, now = "(1.0 + d) * a, (1.0 - d) * a, d * a,", "(1.0 + d) * a, 1.01 * (1.0 - d) * a, d * a,"
    assert was in kernels.read_text()
    kernels.write_text(kernels.read_text().replace(was, now))
    found = run(folder, *CHECK, "--surfaces", "cutoff_64")
    assert found.returncode == 1
    lines = found.stderr.splitlines()
    assert lines[0].endswith("numbers drifted:")
    assert lines[1].split()[:4] == ["name", "was", "is", "tolerance"]
    moved = {line.split()[0] for line in lines[2 : lines.index("")]}
    assert "cutoff_64/seed1/xx.p99@0.33" in moved  # the lateral stress, whose kernel it is
    assert "cutoff_64/seed1/profile.largest@0.33" in moved  # the von Mises stress, of which it is a part
    assert "cutoff_64/seed1/xz.p99@0.33" not in moved  # on which it has no bearing
    assert "cutoff_64/seed1/contact.mean_pressure" not in moved


def test_a_number_that_moved_went_or_came_is_drift_and_an_update_takes_it(quick, tmp_path):
    folder = copy_project(tmp_path)
    summary = folder / "results/quick/summary/hurst_08/seed1.json"
    summary.parent.mkdir(parents=True)
    tree = json.loads((quick / summary.relative_to(folder)).read_text())
    tree["values"]["contact.mean_pressure"] *= 1.01
    tree["values"]["new"] = 1.0
    del tree["values"]["surface.kurtosis"]
    summary.write_text(json.dumps(tree))
    found = run(folder, *CHECK, *ONE, "--surfaces", "hurst_08")
    assert found.returncode == 1
    assert found.stderr.startswith("3 of ")
    for name in ("contact.mean_pressure", "new", "surface.kurtosis"):
        assert f"hurst_08/seed1/{name}" in found.stderr
    assert run(folder, *CHECK, *ONE, "--update").returncode == 0
    assert run(folder, *CHECK, *ONE).returncode == 0


def test_no_summaries_is_said_so(tmp_path):
    folder = copy_project(tmp_path)
    found = run(folder, *CHECK, *ONE)
    assert found.returncode == 1
    assert "no summaries" in found.stderr
