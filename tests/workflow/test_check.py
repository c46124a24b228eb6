"""The drift check: passes on the quick study, and fails when a kernel is changed by one percent."""

import shutil

import numpy as np
import pytest
from project import ROOT, script

from asperity.elasticity.solid import COMPONENTS
from asperity.results import dataset
from asperity.settings.study import read_study
from asperity.stress.analysis import SOUGHT
from asperity.stress.planes import periodic
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.study.stages.stress import stress_of_seed

REFERENCE = "tests/reference/quick.json"
ONE = ("check.py", "--no-run", "--results")
FOUND = "results/quick"


@pytest.fixture
def folder(tmp_path):
    """Files that the check reads besides results."""
    for name in ("config", "tests/reference"):
        shutil.copytree(ROOT / name, tmp_path / name)
    return tmp_path


def test_quick_study_has_the_reference_numbers(quick_study):
    said, error = script(quick_study.folder, *ONE, str(quick_study.results))
    assert "numbers as in tests/reference/quick.json" in said, error


def test_one_percent_in_a_kernel_is_caught(quick_study, folder, monkeypatch):
    """That of the lateral stress, in all stages after the contact."""
    genuine = periodic._fill_spectra

    def one_percent(fields, *others):
        components, factors = fields
        lateral = np.isin(components, [COMPONENTS.index(name) for name in ("xx", "yy", "xy")])
        genuine((components, factors * np.where(lateral, 1.01, 1)[:, None].astype(factors.dtype)), *others)

    monkeypatch.chdir(folder)
    monkeypatch.setattr(periodic, "_fill_spectra", one_percent)
    config, results = read_study(["config/quick.yaml"]), quick_study.results
    surface, contact = (
        dataset.read(results / stage / "cutoff_64/seed1.nc") for stage in ("surface", "contact")
    )
    settings = config["stress"] | {"poisson": [config["layer"]["poisson"]]}
    stress = stress_of_seed(contact, config["layer"], settings, ["free"], [*SOUGHT, "xy"])
    statistics = surface_statistics([SeedResults(1, surface, contact, stress)], **config["statistics"])
    dataset.write(statistics, folder / FOUND / "statistics/cutoff_64.nc", "Statistics", {})
    _, error = script(folder, *ONE, FOUND, "--surfaces", "cutoff_64")
    assert "numbers drifted" in error
    drifted = {line.split(".")[0] for line in error.splitlines() if line.startswith("cutoff_64/seed1/")}
    assert "cutoff_64/seed1/xx" in drifted
    assert "cutoff_64/seed1/contact" not in drifted


def test_changed_missing_and_new_numbers_are_drift(quick_study, folder):
    results = quick_study.results / "statistics"
    shutil.copytree(results, folder / FOUND / "statistics")
    place = folder / FOUND / "statistics/hurst_08.nc"
    statistics = dataset.read(place)
    statistics["seed_mean_pressure"] *= 1.01
    ratios = statistics["poisson"].values
    statistics = statistics.assign_coords(poisson=[*ratios[:-1], 0.49])
    dataset.write(statistics, place, title="tampered", settings=dataset.settings_of(statistics))
    _, error = script(folder, *ONE, FOUND, "--surfaces", "hurst_08")
    moved = {line.split()[0]: line.split()[1:3] for line in error.splitlines() if "/seed1/" in line}
    changed = [name for name, values in moved.items() if "-" not in values]
    assert changed == ["hurst_08/seed1/contact.mean_pressure"]
    assert moved["hurst_08/seed1/xx.p99@0.5"][1] == moved["hurst_08/seed1/xx.p99@0.49"][0] == "-"
    assert script(folder, *ONE, FOUND, "--update")[1] == ""
    assert script(folder, *ONE, FOUND)[1] == ""
    assert "@0.49" in (folder / REFERENCE).read_text()
    assert "@0.49" not in (ROOT / REFERENCE).read_text()


def test_missing_statistics_are_named(folder):
    assert script(folder, *ONE, FOUND)[1] == "results/quick: no statistics; run without --no-run"
