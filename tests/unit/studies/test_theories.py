"""The study of theories: closed forms against numerical solutions, and a tiny run of every part."""

import closed_forms
import contacts
import numpy as np
import pytest
import theories
import yaml
from project import ROOT

CONFIG = yaml.safe_load((ROOT / "studies/theories/config.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("load", "hardness"), [(0.1, 0.5), (0.2, 1.0), (0.05, 2.0), (0.02, 0.25)])
def test_elastoplastic_areas_are_those_of_a_diffusion(load, hardness):
    """A chain of 1000 cells between two absorbing ends; its error comes from the second difference, 1e-5."""
    cells = 1000
    step = hardness / cells
    n = np.arange(1, cells)
    # Eigenvectors of the second difference with zeros at both ends, and its own eigenvalues, not (n π/H)².
    vectors = np.sqrt(2 / cells) * np.sin(np.pi * np.outer(n, n) / cells)
    rates = (1 - np.cos(np.pi * n / cells)) / step**2
    start = np.zeros(cells - 1)
    start[round(load / step) - 1] = 1.0
    weights = vectors @ start
    left = vectors @ (np.exp(-rates * closed_forms.VARIANCE) * weights)
    # What has left through the last cell: the integral of its rate 1/(2 step²) over the variance.
    stayed = vectors[-1] @ ((1 - np.exp(-rates * closed_forms.VARIANCE)) / rates * weights)
    elastic, plastic = closed_forms.elastoplastic_areas(load, hardness)
    assert elastic == pytest.approx(left.sum(), rel=1e-3, abs=1e-5)
    assert plastic == pytest.approx(stayed / (2 * step**2), rel=1e-3, abs=1e-5)
    assert left @ (n * step) + hardness * plastic == pytest.approx(load, rel=1e-4)  # both carry the load


@pytest.mark.parametrize("gamma", [0.45, 1.0])
def test_work_against_gap_is_energy_of_contact(gamma):
    """∫ p (−dū/dp) dp over all loads is Σ E* q |h|²/4; the gap is the integral of its own slope."""
    wavenumber = 2 * np.pi * np.arange(4.0, 33)
    power = 1e-6 * wavenumber**-1.6
    loads = np.geomspace(1e-6, 10, 800)
    gap, slope = np.array([closed_forms.mean_gap(load, wavenumber, power, gamma) for load in loads]).T
    assert np.trapezoid(slope, loads) == pytest.approx((power * wavenumber).sum() / 4, rel=1e-3)
    assert np.trapezoid(slope, np.log(loads)) == pytest.approx(gap[0], rel=1e-3)


@pytest.fixture(scope="module")
def tiny():
    """Every part on cells of 128² nodes with two seeds."""
    band = {"wavelength_long": 0.25, "wavelength_short": 1 / 16, "points": 128}
    config = CONFIG | {"seeds": [1, 2], "loads": [0.0003, 0.001, 0.003, 0.01, 0.1, 0.2, 0.4, 1.0]}
    config["surfaces"] = {n: surface | band for n, surface in CONFIG["surfaces"].items() if n != "hurst_05"}
    config["percolation"] = CONFIG["percolation"] | {"steps": 2, "surfaces": ["hurst_08"]}
    config["profile"] = CONFIG["profile"] | {"loads": [0.1], "depths": [0.02, 0.2, 1.0]}
    config["plastic"] = CONFIG["plastic"] | {"hardness": [0.5, 2.0], "loads": [0.1]}
    parts = {part: config.get(part, config)["surfaces"] for part in contacts.PARTS}
    made: dict = {}

    def once(part, name):  # surfaces of one H are alike here
        key = part, config["surfaces"][name]["hurst"]
        if key not in made:
            made[key] = contacts.part_of(config, part, name)
        return made[key]

    return config, {part: {name: once(part, name) for name in names} for part, names in parts.items()}


def test_variances_against_depth_are_those_of_computed_planes(tiny):
    """The mean square of the von Mises stress is exact, but for waves at Nyquist, whose shear is left out."""
    data = tiny[1]["profile"]["hurst_08"].sel(number="rms")
    assert data["gaussian"].values == pytest.approx(data["computed"].values, rel=2e-4)
    below = data.sel(depth=slice(0.1, None))  # where waves at Nyquist have decayed
    assert below["gaussian"].values == pytest.approx(below["computed"].values, rel=1e-6)


def test_plastic_areas_of_two_grids_agree(tiny):
    """The elastic area is a ring, and misses a third of itself on half of the nodes without the strips."""
    data = tiny[1]["plastic"]["hurst_08"].sel(hardness=0.5, load=0.1)
    assert data["elastic_area"].values == pytest.approx(data["elastic_area_half"].values, rel=0.12)


def test_page_and_figures_of_tiny_results(tiny):
    config, results = tiny
    text = theories.page(results, config)
    assert "q^−(1+H)" in text
    assert set(theories.draw(results, config)) == {"area", "spectrum", "stiffness", "gap", "profile"}
    rows = theories.plastic_rows(results).set_index(["surface", "hardness", "load"])
    soft = rows.loc["hurst_08", 0.5, 0.1]
    assert soft["elastic_area"] > 5 * soft["persson_elastic_area"]
