"""Contact area against Nayak's parameter: moments, boundary, limits, regression, a tiny sweep, the page."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from asperity import Grid, Layer, solve
from asperity.paper.claims.documents import with_sections
from asperity.paper.nayak.analysis import STRIP, limit, means, order_of, regress, table, with_logarithms
from asperity.paper.nayak.collection import collect, seeds_on
from asperity.paper.nayak.figure import draw
from asperity.paper.nayak.page import effect, regressions, sections
from asperity.paper.nayak.samples import boundary_integral, nayak_parameter

ROOT = Path(__file__).parents[2]


def test_nayak_parameter_of_waves():
    """A single wave has 3/2, the smallest value; for two waves the moments are sums."""
    grid = Grid((64, 64))
    y, x = (2 * np.pi * axis for axis in grid.coordinates())
    one = np.cos(3 * x)[None, :] + 0 * y[:, None]
    assert nayak_parameter(one, grid) == pytest.approx(1.5, rel=1e-12)
    two = 2 * np.cos(3 * x)[None, :] + np.sin(8 * y)[:, None]
    squares, wavenumbers = np.array([4.0, 1.0]), 2 * np.pi * np.array([3.0, 8.0])
    moments = [(squares * wavenumbers**order).sum() for order in (0, 2, 4)]
    expected = 1.5 * moments[0] * moments[2] / moments[1] ** 2
    assert nayak_parameter(two, grid) == pytest.approx(expected, rel=1e-12)


def test_boundary_of_a_rectangle_across_the_edge():
    """The length is the perimeter, and the integral of x² along it has the mean of both sides of an edge."""
    grid = Grid((16, 32), (1.0, 2.0))
    touching = np.zeros(grid.shape, bool)
    touching[4:8, 28:] = touching[4:8, :2] = True  # 4 × 6 nodes of 1/16 by 1/16, across the period
    assert boundary_integral(touching, np.ones(grid.shape), grid) == pytest.approx(20 / 16)
    rows = np.arange(16.0)[:, None] * np.ones(32)
    # Rows 3 and 4, 7 and 8 meet along 6 edges each; the sides of rows 4 to 7 are two edges each.
    expected = (6 * (3.5 + 7.5) + 2 * (4 + 5 + 6 + 7)) / 16
    assert boundary_integral(touching, rows, grid) == pytest.approx(expected)


def test_corrected_area_of_a_sphere():
    """The area without its strip is nearer to that of Hertz, in the mean over radii of 5 to 9 nodes."""
    points, radius = 64, 10.0
    grid = Grid((points, points))
    y, x = grid.coordinates()
    height = ((y[:, None] - 0.5) ** 2 + (x[None, :] - 0.5) ** 2) / (2 * radius)
    raw, corrected = [], []
    for nodes in np.linspace(5.0, 9.0, 17):
        circle = nodes / points
        pressure = 4 * circle**3 / (3 * radius)
        found = solve(height, Layer(young=1.0, poisson=0.0), mean_pressure=pressure, boundary="free")
        touching = found.pressure > 0
        strip = STRIP / points * boundary_integral(touching, np.ones(grid.shape), grid)
        exact = np.pi * circle**2
        raw.append(touching.mean() / exact - 1)
        corrected.append((touching.mean() - strip) / exact - 1)
    assert np.mean(raw) > 0.02
    assert abs(np.mean(corrected)) < np.mean(raw) / 3


def test_limit_from_nested_seeds():
    """Numbers with an error of known order have their limit exactly; their scatter is that of all seeds."""
    rng = np.random.default_rng(1)
    seeds = 2.0 + 0.01 * rng.standard_normal(200)
    levels = [seeds[:n] + 0.3 / nodes**1.5 for n, nodes in ((200, 8), (50, 16), (5, 32))]
    assert order_of([means(levels)]) == pytest.approx(1.5)
    assert order_of([np.array([1.0, 2.0, 4.0])]) == 1
    assert order_of([np.array([1.0, 2.0])]) == 1
    found = limit(levels, 1.5)
    assert found.value == pytest.approx(seeds.mean(), rel=1e-10)
    assert found.scatter == pytest.approx(seeds.std(ddof=1) / np.sqrt(200), rel=1e-6)


def made_rows(noise: float, seed: int = 0) -> pd.DataFrame:
    """Twelve surfaces under three loads, κ falling with ln α, κ_r constant, noise for each surface."""
    rng = np.random.default_rng(seed)
    rows = []
    for number in range(12):
        nayak, hurst, ratio = 2 * 1.3**number, (0.2, 0.5, 0.8)[number % 3], 4.0 * 2 ** (number // 3)
        shift = noise * rng.standard_normal(2)
        for load, area in enumerate((0.02, 0.05, 0.1)):
            kappa = 2.4 - 0.15 * np.log(nayak) - 0.05 * np.log(area) + shift[0]
            numbers = {"kappa": kappa, "kappa_r": 1.8 + shift[1]}
            rows.append(
                {"surface": f"s{number}", "hurst": hurst, "ratio": ratio, "load": load + 1, "nayak": nayak}
                | {"pressure": area / 2, "area": area, "cell": 4.0, "seeds": "2/2"}
                | numbers
                | {f"{key}_{kind}": 0.004 for key in numbers for kind in ("error", "scatter")}
                | {f"{key}{kind}_order": 1.0 for key in numbers for kind in ("", "_uncorrected")}
                | {f"{key}{kind}_coarsest": v for key, v in numbers.items() for kind in ("", "_uncorrected")}
            )
    return with_logarithms(pd.DataFrame(rows))


def _of_noise(seed):
    return regress(made_rows(0.01, seed), "kappa", ["ln_nayak", "ln_area"])


def test_regression_on_made_numbers():
    """Slopes are found and held by their intervals as often as these say; without effect they hold zero."""
    exact = regress(made_rows(0.0), "kappa", ["ln_nayak", "ln_area"])
    np.testing.assert_allclose(exact.slopes, [-0.15, -0.05], rtol=1e-9)
    assert exact.explained == pytest.approx(1)
    held = [abs(found.slopes[0] + 0.15) < found.errors[0] for found in map(_of_noise, range(40))]
    assert 0.85 <= np.mean(held) <= 1
    rows = made_rows(0.01)
    assert regress(rows, "kappa", ["ln_nayak", "ln_area"]).residual == pytest.approx(0.01, rel=0.5)
    still = regress(rows, "kappa_r", ["ln_nayak", "ln_area"])
    assert not effect(rows, still, "kappa_r", "ln_nayak").clear
    assert "Both statements hold" in sections(rows)["verdict"]
    with pytest.raises(ValueError, match="3 groups: 4 or more are needed for 2 slopes"):
        regress(rows[rows["surface"].isin(["s0", "s1", "s2"])], "kappa", ["ln_nayak", "ln_area"])


def test_tiny_sweep(tmp_path):
    """Six surfaces on small grids, from samples to figure; a second run reads the files of the first."""
    surfaces = {
        f"s{number}": {
            "label": "",
            "hurst": hurst,
            "wavelength_long": 0.5,
            "wavelength_short": 0.5 / ratio,
            "rms_height": 1e-3,
        }
        for number, (hurst, ratio) in enumerate((h, r) for h in (0.2, 0.5, 0.8) for r in (2, 4))
    }
    settings = {"loads": [0.02, 0.06], "nodes": [4, 8], "grid_nodes": 3 * 64**2, "most_seeds": 4}
    config = {"results": str(tmp_path), "surfaces": surfaces, "nayak": settings}
    assert seeds_on(0.125, [4, 8], settings["grid_nodes"], 40) == [40, 3]
    rows = table(config, collect(config))
    files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    assert len(files) == 12
    assert table(config, collect(config)).equals(rows)
    assert files == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    assert len(rows) == 12
    assert rows["kappa"].between(1.5, 3).all()
    assert (rows["kappa_r"] < rows["kappa"]).all()  # contacts are at summits, which are less steep
    assert (rows["nayak"] > 1.5).all()
    assert set(regressions(rows)) == {
        (number, terms)
        for number in ("kappa", "kappa_r")
        for terms in (
            ("ln_nayak", "ln_area"),
            ("hurst", "ln_area"),
            ("ln_ratio", "ln_area"),
            ("hurst", "ln_ratio", "ln_area"),
        )
    }
    assert len(draw(rows).axes) == 2


def test_kept_page():
    """The sections of docs/nayak.md are those of the table that is kept beside it."""
    rows = with_logarithms(pd.read_csv(ROOT / "docs/nayak.csv"))
    text = (ROOT / "docs/nayak.md").read_text(encoding="utf-8")
    assert with_sections(text, sections(rows)) == text
    assert rows["surface"].nunique() >= 12
