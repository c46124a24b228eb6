"""The studies beside the paper: moments, boundaries and lengths, regressions, and a tiny run of each."""

import challenge
import height_distribution
import master_curve
import nayak
import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from project import ROOT
from scipy.special import erf

from asperity import Grid
from asperity.settings.study import read_study


def test_nayak_parameter_of_waves():
    """A single wave has 3/2, the smallest value; for two waves the moments are sums."""
    grid = Grid((64, 64))
    y, x = (2 * np.pi * axis for axis in grid.coordinates())
    one = np.cos(3 * x)[None, :] + 0 * y[:, None]
    assert nayak.nayak_parameter(one, grid) == pytest.approx(1.5, rel=1e-12)
    two = 2 * np.cos(3 * x)[None, :] + np.sin(8 * y)[:, None]
    squares, wavenumbers = np.array([4.0, 1.0]), 2 * np.pi * np.array([3.0, 8.0])
    moments = [(squares * wavenumbers**order).sum() for order in (0, 2, 4)]
    expected = 1.5 * moments[0] * moments[2] / moments[1] ** 2
    assert nayak.nayak_parameter(two, grid) == pytest.approx(expected, rel=1e-12)


def test_boundary_of_a_rectangle_across_the_edge():
    """The length is the perimeter; the integral of a field has the mean of both sides of an edge."""
    grid = Grid((16, 32), (1.0, 2.0))
    touching = np.zeros(grid.shape, bool)
    touching[4:8, 28:] = touching[4:8, :2] = True  # 4 × 6 nodes of 1/16 by 1/16, across the period
    assert nayak.boundary_integral(touching, np.ones(grid.shape), grid) == pytest.approx(20 / 16)
    rows = np.arange(16.0)[:, None] * np.ones(32)
    # Rows 3 and 4, 7 and 8 meet along 6 edges each; the sides of rows 4 to 7 are two edges each.
    expected = (6 * (3.5 + 7.5) + 2 * (4 + 5 + 6 + 7)) / 16
    assert nayak.boundary_integral(touching, rows, grid) == pytest.approx(expected)


def test_tiny_nayak_study(tmp_path):
    """Six surfaces on small grids, from contacts to page; a second run reads the files of the first."""
    config = {"results": tmp_path, "hurst": [0.2, 0.5, 0.8], "bands": {2: 0.5, 4: 0.5}, "loads": [0.02, 0.06]}
    config |= {"nodes": [4, 8], "grid_nodes": 3 * 64**2, "most_seeds": 4}
    samples = nayak.collect(config)
    rows = nayak.table(config, samples)
    files = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert nayak.table(config, nayak.collect(config)).equals(rows)
    assert files == {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(rows) == 12
    assert rows["kappa"].between(1.5, 3).all()
    assert (rows["kappa_r"] < rows["kappa"]).all()  # contacts are at summits, which are less steep
    assert "over the same range" in nayak.page(rows)


def test_lengths_of_a_wave():
    """Full contact with one wave: the pressure halves where J0 = 1/2; moments of the wave."""
    points, waves = 256, 4
    x = np.arange(points) / points
    height = np.cos(2 * np.pi * waves * x)[None, :] + np.cos(2 * np.pi * waves * x)[:, None]
    contact = xr.Dataset({"pressure": (("y", "x"), height + 3)}, coords={"y": x, "x": x})
    contact["pressure"][0, 0] = 0.0  # one node out of contact gives the boundary four edges
    found = master_curve.contact_lengths(height, contact)
    wavenumber = 2 * np.pi * waves
    # Each profile moment over the next is 1/q² for two waves at right angles, of the slope along one of them.
    assert found["height_length"] == pytest.approx(np.sqrt(2) / wavenumber, rel=1e-3)
    assert found["hydraulic_radius"] == pytest.approx(8 / np.pi * points / 4, rel=1e-3)
    assert found["curvature_length"] == pytest.approx(np.sqrt(4 / 3) / wavenumber, rel=1e-3)
    # The mean over directions of cos(q r cos φ) is J0(q r), which is one half at 1.5211.
    assert found["pressure_length"] == pytest.approx(1.5211 / wavenumber, rel=0.02)


def test_hertz_peak_of_johnson():
    """Johnson, Contact Mechanics (1985), section 3.4: at ν = 0.3 the largest τ is 0.31 p0 at 0.48 a."""
    height, depth = master_curve.hertz_peak(0.3)
    assert height == pytest.approx(2 * 0.31 * 1.5, rel=2e-3)
    assert depth == pytest.approx(0.48, abs=5e-3)


def test_tiny_master_curve_study(tmp_path):
    """Two small surfaces from contact to page; a second run reads the files of the first."""
    config = read_study([ROOT / "studies/master_curve/config.yaml"])
    config["results"], config["seeds"] = str(tmp_path), [1, 2]
    surface = config["surfaces"]["hurst_08_ratio_8"] | {"points": 64}
    surface |= {"wavelength_long": 0.5, "wavelength_short": 0.125}
    config["surfaces"] = {f"s{hurst}": surface | {"hurst": hurst} for hurst in (0.2, 0.8)}
    config["contact"] |= {"path_contact_area_fractions": [0.3]}
    config["stress"] |= {"poisson": [0.0, 0.33]}
    rows = master_curve.table(config, master_curve.collect(config))
    files = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert master_curve.table(config, master_curve.collect(config)).equals(rows)
    assert files == {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(rows) == 2 * 2 * 2
    assert (rows.loc[rows["poisson"] == 0, "height_gradient_contact"] > 1).all()
    assert "as on the axis of a Hertzian contact" in master_curve.page(rows)


def test_tiny_height_distribution(tmp_path, monkeypatch):
    """Two seeds and three cases on small grids: pairs share their seed, so that Gaussian changes vanish."""
    config = yaml.safe_load((ROOT / "studies/height_distribution/config.yaml").read_text(encoding="utf-8"))
    config |= {"results": str(tmp_path), "seeds": [1, 2], "points": 128}
    config["spectrum"] |= {"wavelength_short": 1 / 16}
    kinds = ("gaussian", "skewness_plus_10", "johnson_plus")
    config["cases"] = {name: config["cases"][name] for name in kinds}
    rows = height_distribution.table(config)
    assert height_distribution.table(config).equals(rows)
    assert height_distribution.change(rows, "p99", "gaussian")[0] == 0
    of_case = rows.groupby("case").mean()
    assert of_case["gradient"]["skewness_plus_10"] == pytest.approx(1, rel=1e-9)
    assert of_case["gradient"]["johnson_plus"] != pytest.approx(1, rel=1e-3)
    # Blunt hills have a smaller gradient in contact, and peaks that are smaller by as much.
    blunt, error = height_distribution.change(rows, "gradient_contact", "skewness_plus_10")
    assert blunt < -3 * error
    assert height_distribution.change(rows, "p99", "skewness_plus_10")[0] == pytest.approx(blunt, abs=0.2)


@pytest.mark.parametrize(
    ("study", "tables"),
    [(nayak, [""]), (master_curve, [""]), (height_distribution, [""]), (challenge, ["", "_stress"])],
    ids=lambda each: getattr(each, "__name__", ""),
)
def test_pages_follow_from_kept_tables(study, tables):
    folder = ROOT / "studies" / study.__name__
    kept = [pd.read_csv(folder / f"{study.__name__}{table}.csv") for table in tables]
    assert study.page(*kept) == (folder / "README.md").read_text("utf-8")


def test_persson_area_is_an_error_function():
    """Integral of the density over all pressures: erf(√2 p̄/E*ḡ), B. N. J. Persson (2001)."""
    pressure = np.linspace(0, 6, 6001)
    for load in (0.01, 0.3):
        area = np.trapezoid(challenge.persson(pressure, load), pressure)
        assert area == pytest.approx(erf(np.sqrt(2) * load), rel=1e-5)


def test_tiny_challenge(tmp_path):
    """Three grids of 4, 8 and 16 nodes on the shortest wave; a second run reads the files of the first."""
    path = ROOT / "studies/challenge/config.yaml"
    config = yaml.safe_load(path.read_text(encoding="utf-8")) | {"results": tmp_path, "cutoff": 3.2}
    config |= {"points": [128, 256, 512], "loads": [0.01, 0.03, 0.08]}
    config["results"] = str(tmp_path)
    data = challenge.collect(config)
    rows = challenge.limits(data)
    limit, coarse, fine = (rows[rows["points"] == points] for points in (0, 256, 512))
    assert np.abs(limit["mean_gap"].values / fine["mean_gap"].values - 1).max() < 1e-3
    # The limit of the area has a tenth of the excess of the finer of its two grids.
    excess = coarse["contact_area_fraction"].values - limit["contact_area_fraction"].values
    assert (fine["contact_area_fraction"].values > limit["contact_area_fraction"].values).all()
    assert (excess > 0.04 * limit["contact_area_fraction"].values).all()
    assert challenge.collect(config).equals(data)
    surface = challenge.height_of(config)
    found: list = []
    for points in config["points"]:
        found.append(challenge.stress_on(config, surface, points, found[0] if len(found) == 1 else None))
    stress, profiles = challenge.stress_tables(found)
    assert set(stress["points"]) == {0, 128, 256, 512}
    # The estimate of the 99th percentile from the first two grids is nearer to the finest grid than theirs.
    of_half = stress[stress["poisson"] == 0.5].set_index("points")["p99"]
    assert abs(of_half[0] / of_half[512] - 1) < abs(of_half[256] / of_half[512] - 1)
    assert challenge.draw_stress(profiles).axes
    assert "| 0.03 |" in challenge.page(rows, stress)
