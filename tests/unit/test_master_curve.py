"""Scales of von Mises peaks: lengths of a contact, collapse of made numbers, a tiny run, the kept page."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from asperity.config.study import read_study
from asperity.paper.claims.documents import with_sections
from asperity.paper.master_curve.analysis import (
    DEPTH_SCALES,
    HEIGHT_SCALES,
    exponents,
    held_out,
    hertz_peak,
    of_poisson,
    scatter,
    table,
)
from asperity.paper.master_curve.figure import draw
from asperity.paper.master_curve.page import best_height, best_length, sections, verdict
from asperity.paper.master_curve.samples import collect, contact_lengths

ROOT = Path(__file__).parents[2]


def test_lengths_of_a_wave():
    """Full contact with one wave: the pressure halves where J0 = 1/2; moments are those of the wave."""
    points, waves = 256, 4
    x = np.arange(points) / points
    height = np.cos(2 * np.pi * waves * x)[None, :] + np.cos(2 * np.pi * waves * x)[:, None]
    coordinates = {"y": x, "x": x}
    contact = xr.Dataset({"pressure": (("y", "x"), height + 3)}, coords=coordinates)
    contact["pressure"][0, 0] = 0.0  # one node out of contact gives the boundary four edges
    found = contact_lengths(height, contact)
    wavenumber = 2 * np.pi * waves
    # Each profile moment over the next is 1/q² for two waves at right angles, of the slope along one of them.
    assert found["seed_height_length"] == pytest.approx(np.sqrt(2) / wavenumber, rel=1e-3)
    assert found["seed_hydraulic_radius"] == pytest.approx(8 / np.pi * points / 4, rel=1e-3)
    assert found["seed_curvature_length"] == pytest.approx(np.sqrt(4 / 3) / wavenumber, rel=1e-3)
    # The mean over directions of cos(q r cos φ) is J0(q r), which is one half at 1.5211.
    assert found["seed_pressure_length"] == pytest.approx(1.5211 / wavenumber, rel=0.02)


def test_hertz_peaks():
    """Johnson, Contact Mechanics (1985), section 3.4: at ν = 0.3 the largest τ is 0.31 p0 at 0.48 a."""
    height, depth = hertz_peak(0.3)
    assert height == pytest.approx(2 * 0.31 * 1.5, rel=2e-3)
    assert depth == pytest.approx(0.48, abs=5e-3)


def made_rows(noise: float) -> pd.DataFrame:
    """Numbers that collapse with ℓ_p and E*ḡ_r, up to noise, and fall with the area otherwise."""
    rng = np.random.default_rng(3)
    factor = {0.0: 0.75, 0.33: 1.0, 0.5: 1.1}
    rows = []
    for number in range(8):
        hurst_factor = (1.0, 1.5)[number % 2]
        shift = np.exp(noise * rng.standard_normal())
        for area in (0.02, 0.05, 0.2):
            for poisson, of_nu in factor.items():
                row = {
                    "surface": f"s{number}",
                    "hurst": (0.2, 0.8)[number % 2],
                    "ratio": 8.0 * 2 ** (number % 3),
                }
                row |= {"skewed": number == 7, "area": area, "poisson": poisson, "seeds": 3}
                length = 0.3 * area**0.2 * hurst_factor
                row |= dict.fromkeys((*HEIGHT_SCALES, *DEPTH_SCALES), of_nu * shift * area ** (-0.2))
                row["height_gradient_contact"] = of_nu * shift
                row["depth_wavelength"] = of_nu * shift * length**0.6
                row["depth_pressure_length"] = row["depth_wavelength"] / length
                rows.append(row | {f"{key}_error": 0.01 for key in (*HEIGHT_SCALES, *DEPTH_SCALES)})
    return pd.DataFrame(rows)


def test_collapse_of_made_numbers():
    """The scales that made the numbers leave no scatter, and their exponents are found."""
    rows = made_rows(0.0)
    assert scatter(rows, "height_gradient_contact").value < 1e-12
    spread = np.log([0.02, 0.05, 0.2]).std() * 0.2
    assert scatter(rows, "height_contact_pressure").value == pytest.approx(spread)
    assert exponents(rows, "height_contact_pressure", ["ln A"])["ln A"].value == pytest.approx(-0.2)
    assert of_poisson(rows, "height_gradient_contact")[0.0].value == pytest.approx(0.75)
    term = "ln depth_pressure_length"
    assert exponents(rows, "depth_wavelength", [term])[term].value == pytest.approx(0.6)
    assert held_out(rows, "depth_wavelength", [term]) < 1e-12
    rows = made_rows(0.02)
    found = scatter(rows, "height_gradient_contact")
    assert found.value == pytest.approx(0.02, abs=3 * found.error)
    assert held_out(rows, "height_gradient_contact", []) > found.value
    assert best_height(rows) == "height_gradient_contact"
    assert best_length(rows) == "depth_pressure_length"
    assert verdict(rows).startswith("**Height and depth lie on one curve each")
    assert verdict(made_rows(0.2)).startswith("**Neither height nor depth")
    with pytest.raises(ValueError, match="2 surfaces: 3 or more are needed"):
        scatter(rows[rows["surface"].isin(["s0", "s1"])], "depth_wavelength")


def test_tiny_run(tmp_path):
    """Three small surfaces from contact to page; a second run reads the files of the first."""
    config = read_study([ROOT / "config/master_curve.yaml"])
    config["results"], config["seeds"] = str(tmp_path), [1, 2]
    surface = config["surfaces"]["hurst_08_ratio_8"] | {
        "points": 64,
        "wavelength_long": 0.5,
        "wavelength_short": 0.125,
    }
    config["surfaces"] = {f"s{hurst}": surface | {"hurst": hurst} for hurst in (0.2, 0.5, 0.8)}
    config["contact"] = config["contact"] | {"path_area_fractions": [0.3]}
    config["stress"] = config["stress"] | {"poisson": [0.0, 0.33]}
    rows = table(collect(config))
    files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    assert len(files) == 3
    assert table(collect(config)).equals(rows)
    assert files == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    assert len(rows) == 3 * 2 * 2
    assert np.isfinite(rows.select_dtypes("number")).all(axis=None)
    assert (rows.loc[rows["poisson"] == 0, "height_gradient_contact"] > 1).all()
    assert len(draw(rows).axes) == 4


def test_kept_page():
    """The sections of docs/master_curve.md are those of the table that is kept beside it."""
    rows = pd.read_csv(ROOT / "docs/master_curve.csv")
    text = (ROOT / "docs/master_curve.md").read_text(encoding="utf-8")
    assert with_sections(text, sections(rows)) == text
