"""Real contact area against Nayak's parameter of the surface: writes docs/nayak.md with its figure and table.

    python studies/nayak/nayak.py studies/nayak/config.yaml

computes the contacts that are missing in the folder of results, then the table docs/nayak.csv. Without a
configuration the page is written from the table that is kept. Run it in the project's folder.

κ = a_r E* ḡ / p̄ and κ_r = a_r E* ḡ_r / p̄, with the area fraction a_r, the rms gradient ḡ of the whole surface
and that of the real contact, ḡ_r, where the rough surface has the slope of the deformed one.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import stdtrit

from asperity import Grid, Solid, self_affine, solve_load_path
from asperity.core.markup import with_error
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, gradient, mean_square
from asperity.study.small_studies import computed_once, rendered
from asperity.views.style import panels, save, style

HALF_SPACE = Solid(young=1.0, poisson=0.0)
"""A solid with E* = 1; area over load does not depend on Poisson's ratio."""

STRIP = (math.pi - 1 + math.log(2)) / 24
"""Share of grid spacing times boundary length by which the nodes of contact overestimate its area.

Yastrebov, Anciaux and Molinari, Tribol. Int. 114 (2017) 161, doi 10.1016/j.triboint.2017.04.023.
"""

FEWEST_SEEDS = 2
"""Seeds of a surface on its finest grid, from which its scatter is known."""

COARSEST = 4
"""Nodes of all seeds of the coarsest grid, which gives most of the scatter, over those of any other."""

ORDERS = (0.5, 2.0)
"""Smallest and largest order of convergence with which a limit is extrapolated."""

NUMBERS = {"kappa": "κ", "kappa_r": "κ_r"}
TERMS = {"ln_nayak": "ln α", "hurst": "H", "ln_ratio": "ln λ_l/λ_s", "ln_area": "ln a_r"}
STRUCTURE = ("ln_nayak", "hurst", "ln_ratio")
"""Terms that describe the surface, each tried beside the area."""

MARKERS = ("o", "s", "^")


def nayak_parameter(height: Array, grid: Grid) -> float:
    """Nayak's parameter α = m₀ m₄ / m₂² of an isotropic surface, 3/2 or more.

    The moments are those of a profile: ⟨h²⟩ = m₀, ⟨|∇h|²⟩ = 2 m₂ and ⟨(∇²h)²⟩ = 8 m₄ / 3 (P. R. Nayak, J.
    Lubr. Technol. 93 (1971) 398, doi 10.1115/1.3451608).
    """
    coefficients = Fourier(grid).forward(height - height.mean())
    squared = grid.wavenumber() ** 2
    heights, slopes, curvatures = (mean_square(coefficients, grid, squared**n) for n in (0, 1, 2))
    return 1.5 * heights * curvatures / slopes**2


def boundary_integral(touching: Array, values: Array, grid: Grid) -> float:
    """Integral of a field along the boundary of contact, which follows the edges of the grid's squares.

    The value on an edge is the mean of those of the two nodes beside it.
    """
    total = 0.0
    for axis, along in ((0, grid.spacing[1]), (1, grid.spacing[0])):
        edge = touching != np.roll(touching, 1, axis)
        total += along * float((values + np.roll(values, 1, axis))[edge].sum()) / 2
    return total


def contacts(surface: Mapping[str, float], points: int, seeds: int, loads: Sequence[float]) -> xr.Dataset:
    """Area, boundary and gradients of the contact of some seeds of a surface on one grid, under all loads."""
    grid = Grid((points, points))
    found = []
    for seed in range(1, seeds + 1):
        height = self_affine(grid.shape, seed=seed, **surface)
        slope_y, slope_x = gradient(Fourier(grid).forward(height), Fourier(grid))
        squared = slope_y**2 + slope_x**2
        rms_gradient = float(np.sqrt(squared.mean()))
        numbers: dict[str, list[float]] = {}
        for contact in solve_load_path(
            height, HALF_SPACE, mean_pressures=[one * rms_gradient for one in loads]
        ):
            touching = contact.pressure > 0
            of_load = {
                "mean_pressure": contact.mean_pressure,
                "area_fraction": contact.area_fraction,
                "boundary_length": boundary_integral(touching, np.ones_like(squared), grid),
                "squared_gradient_contact": float(squared[touching].sum()) / squared.size,
                "squared_gradient_boundary": boundary_integral(touching, squared, grid),
            }
            for name, value in of_load.items():
                numbers.setdefault(name, []).append(value)
        of_surface = {"nayak": nayak_parameter(height, grid), "rms_gradient": rms_gradient}
        found.append(xr.Dataset({name: ("load", values) for name, values in numbers.items()} | of_surface))
    return xr.concat(found, "seed")


def surfaces(config: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Name → arguments of `asperity.self_affine` of all surfaces."""
    return {
        f"hurst_{10 * hurst:02.0f}_ratio_{ratio:g}": {
            "hurst": hurst,
            "wavelength_long": long,
            "wavelength_short": long / ratio,
            "rms_height": 1e-3,
        }
        for hurst in config["hurst"]
        for ratio, long in config["bands"].items()
    }


def seeds_on(points: Sequence[int], grid_nodes: int, most_seeds: int) -> list[int]:
    """Number of seeds of a surface on each grid, coarse to fine."""
    shares = [grid_nodes * (COARSEST if number == 0 else 1) for number in range(len(points))]
    return [max(FEWEST_SEEDS, min(most_seeds, s // n**2)) for s, n in zip(shares, points, strict=True)]


def collect(config: Mapping[str, Any]) -> dict[str, dict[float, xr.Dataset]]:
    """Surface → nodes on λ_s → contacts, read from their files or computed."""
    found: dict[str, dict[float, xr.Dataset]] = {}
    for name, surface in surfaces(config).items():
        points = [round(nodes / surface["wavelength_short"]) for nodes in config["nodes"]]
        seeds = seeds_on(points, config["grid_nodes"], config["most_seeds"])
        for nodes, edge, count in zip(config["nodes"], points, seeds, strict=True):
            path = Path(config["results"], f"{name}_{nodes:g}.nc")
            settings = [surface, edge, count, config["loads"]]
            compute = partial(contacts, *settings)
            found.setdefault(name, {})[nodes] = computed_once(path, settings, compute)
    return found


def proportionality(data: xr.Dataset, spacing: float, corrected: bool) -> dict[str, xr.DataArray]:
    """Area fraction, κ and κ_r of each seed and load; `corrected`: without the strip along the boundary."""
    strip = STRIP * spacing * corrected
    area = data["area_fraction"] - strip * data["boundary_length"]
    squared = data["squared_gradient_contact"] - strip * data["squared_gradient_boundary"]
    per_load = area / data["mean_pressure"]
    return {
        "area": area,
        "kappa": per_load * data["rms_gradient"],
        "kappa_r": per_load * np.sqrt(squared / area),
    }


def means(levels: Sequence[Array]) -> Array:
    """Mean over seeds on nested grids, coarse to fine, where finer grids have the first of the seeds.

    The mean on a grid is that on the next coarser one plus the mean difference of the seeds that both have.
    """
    differences = [(fine - coarse[: fine.size]).mean() for coarse, fine in pairwise(levels)]
    return np.cumsum([levels[0].mean(), *differences])


def order_of(found: Sequence[Array]) -> float:
    """Order of convergence that the means of several numbers on the same grids show together.

    It is that of the sum of their relative changes over the last three grids, limited to `ORDERS`; it is one
    with two grids, or where the changes do not shrink.
    """
    relative = np.sum([np.diff(one) / one[-1] for one in found], axis=0)
    if relative.size < 2 or not relative[-2] or not 0 < relative[-1] / relative[-2] < 1:
        return 1.0
    return float(np.clip(-np.log2(relative[-1] / relative[-2]), *ORDERS))


def limit(levels: Sequence[Array], order: float) -> tuple[float, float]:
    """Mean over seeds at vanishing grid spacing by Richardson's extrapolation, and its standard error."""
    gain = 1 / (2**order - 1)
    found = means(levels)
    parts = [levels[0], *(fine - coarse[: fine.size] for coarse, fine in pairwise(levels))]
    weights = [1.0] * (len(parts) - 1) + [1 + gain]
    variances = [w**2 * v.var(ddof=1) / v.size for w, v in zip(weights, parts, strict=True)]
    return float(found[-1] + gain * (found[-1] - found[-2])), math.sqrt(sum(variances))


def table(config: Mapping[str, Any], samples: Mapping[str, Mapping[float, xr.Dataset]]) -> pd.DataFrame:
    """Limits of the area, κ and κ_r of all surfaces under all loads, a row each.

    With and without the strip along the boundary the numbers converge in different ways to one limit. Each of
    the two has one order of convergence for all rows. The error of the grid is the difference of the two
    limits; column ``…_error`` holds that of the grid and of the seeds together.
    """
    rows: list[dict[str, Any]] = []
    levels: dict[tuple[str, str], list[list[Array]]] = {}
    for name, surface in surfaces(config).items():
        grids = samples[name]
        short, nayak = surface["wavelength_short"], grids[config["nodes"][0]]["nayak"].values
        for index, pressure in enumerate(config["loads"]):
            rows.append(
                {
                    "surface": name,
                    "hurst": surface["hurst"],
                    "ratio": surface["wavelength_long"] / short,
                    "cell": 1 / surface["wavelength_long"],
                    "load": index + 1,
                    "pressure": pressure,
                    "nayak": nayak.mean(),
                    "nayak_error": nayak.std(ddof=1) / math.sqrt(nayak.size),
                    "seeds": "/".join(str(data.sizes["seed"]) for data in grids.values()),
                }
            )
            for kind in ("", "_uncorrected"):
                numbers = [proportionality(data, short / n, corrected=not kind) for n, data in grids.items()]
                for key in numbers[0]:
                    values = [grid[key].values[:, index] for grid in numbers]
                    levels.setdefault((key, kind), []).append(values)
    for (key, kind), of_rows in levels.items():
        order = order_of([means(one) for one in of_rows])
        for row, one in zip(rows, of_rows, strict=True):
            row[f"{key}{kind}"], scatter = limit(one, order)
            row[f"{key}{kind}_order"] = order
            row[f"{key}{kind}_coarsest"] = means(one)[0]
            row.setdefault(f"{key}_scatter", scatter)
    found = pd.DataFrame(rows)
    for key in ("area", *NUMBERS):
        found[f"{key}_error"] = np.hypot(found[f"{key}_scatter"], found[key] - found[f"{key}_uncorrected"])
    return found


def with_logarithms(rows: pd.DataFrame) -> pd.DataFrame:
    """The table with the columns that only regressions use."""
    return rows.assign(**{f"ln_{name}": np.log(rows[name]) for name in ("nayak", "ratio", "area")})


class Regression(NamedTuple):
    """Least squares of a number on some terms and a constant.

    `slopes` and `errors`, half widths of 95 % intervals, are by term, as are `changes`: relative changes of
    the number over the range of a term, with the half widths of their intervals. `residual` is the root of
    the mean squared residual per degree of freedom over the mean, `explained` the weighted R².
    """

    slopes: dict[str, float]
    errors: dict[str, float]
    changes: dict[str, tuple[float, float]]
    residual: float
    explained: float


def regress(rows: pd.DataFrame, number: str, terms: Sequence[str]) -> Regression:
    """Regression of a number on terms and a constant, weighted by its error.

    Rows of one surface share their seeds and are not independent: the errors of the slopes are those of the
    leave-one-surface-out jackknife (Student's t), which also holds what the terms do not explain.
    """
    names = rows["surface"].unique()
    whole, residual, explained = _fit(rows, number, terms)
    left_out = np.array([_fit(rows[rows["surface"] != name], number, terms)[0] for name in names])
    variance = (names.size - 1) / names.size * ((left_out - left_out.mean(axis=0)) ** 2).sum(axis=0)
    errors = float(stdtrit(names.size - len(terms) - 1, 0.975)) * np.sqrt(variance)
    mean = float(rows[number].mean())
    widths = [float(rows[term].max() - rows[term].min()) / mean for term in terms]
    changes = [(s * w, e * w) for s, e, w in zip(whole[1:], errors[1:], widths, strict=True)]
    slopes, halves = (dict(zip(terms, values[1:], strict=True)) for values in (whole, errors))
    return Regression(slopes, halves, dict(zip(terms, changes, strict=True)), residual / mean, explained)


def _fit(rows: pd.DataFrame, number: str, terms: Sequence[str]) -> tuple[Array, float, float]:
    """Constant and slopes, root mean squared residual, share of the variance explained."""
    weight = 1 / np.maximum(rows[f"{number}_error"].to_numpy(), 1e-3 * rows[number].abs().to_numpy())
    matrix = np.column_stack([np.ones(len(rows)), *(rows[term] for term in terms)])
    value = rows[number].to_numpy()
    found = np.linalg.lstsq(matrix * weight[:, None], value * weight, rcond=None)[0]
    left = value - matrix @ found
    mean = np.average(value, weights=weight**2)
    explained = 1 - np.sum((weight * left) ** 2) / np.sum((weight * (value - mean)) ** 2)
    residual = math.sqrt(np.average(left**2, weights=weight**2) * len(rows) / (len(rows) - matrix.shape[1]))
    return found, residual, float(explained)


def draw(rows: pd.DataFrame) -> Figure:
    """κ and κ_r against α with their standard errors, a marker for each H and a colour for each load."""
    symbols = {"kappa": r"\kappa = a_r E^* \bar{g}", "kappa_r": r"\kappa_r = a_r E^* \bar{g}_r"}
    figure, axes = panels(2, 1, height=75.0)
    limits = (rows[[*symbols]].min(axis=None) - 0.05, rows[[*symbols]].max(axis=None) + 0.05)
    for axis, (key, symbol) in zip(axes, symbols.items(), strict=True):
        _draw_panel(axis, rows, key)
        axis.set(xscale="log", ylim=limits, xlabel=r"Nayak's parameter $\alpha$")
        axis.set_ylabel(rf"${symbol} / \bar{{p}}$")
        axis.set_xticks([2, 3, 5, 10, 20, 30], labels=["2", "3", "5", "10", "20", "30"])
        axis.set_xticks([], minor=True)
    axes[1].legend(loc="upper right", ncols=2)
    return figure


def _draw_panel(axis: Axes, rows: pd.DataFrame, key: str) -> None:
    """Points with their errors, and the line of least squares of each load."""
    for colour, (_, of_load) in enumerate(rows.groupby("load")):
        slope, constant = np.polyfit(of_load["ln_nayak"], of_load[key], 1)
        ends = of_load["nayak"].agg(["min", "max"]).to_numpy()
        name = f"$a_r$ = {of_load['area'].mean():.2g}"
        axis.plot(ends, slope * np.log(ends) + constant, color=f"C{colour}", lw=0.8, label=name)
        for marker, (_, of_hurst) in zip(MARKERS, of_load.groupby("hurst"), strict=False):
            x, y, error = (of_hurst[column] for column in ("nayak", key, f"{key}_error"))
            axis.errorbar(x, y, error, fmt=marker, ms=3.5, color=f"C{colour}")
    for marker, hurst in zip(MARKERS, sorted(rows["hurst"].unique()), strict=False):
        axis.plot([], [], marker, color="0.4", ms=3.5, ls="none", label=f"$H$ = {hurst:g}")


def page(rows: pd.DataFrame) -> str:
    """The page docs/nayak.md, from its template."""
    kinds = [(term, "ln_area") for term in STRUCTURE] + [("hurst", "ln_ratio", "ln_area")]
    found = {number: {terms: regress(rows, number, terms) for terms in kinds} for number in NUMBERS}
    changes = {
        number: {term: found[number][term, "ln_area"].changes[term] for term in STRUCTURE}
        for number in NUMBERS
    }
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        rows=rows,
        numbers=NUMBERS,
        terms=TERMS,
        regressions=found,
        changes=changes,
        falls=changes["kappa"]["ln_nayak"][0] < -changes["kappa"]["ln_nayak"][1],
        clear=[TERMS[term] for term, (change, error) in changes["kappa_r"].items() if abs(change) > error],
        with_error=with_error,
    )


def main() -> None:
    """Write table, figure and page."""
    table_file = Path("docs/nayak.csv")
    if sys.argv[1:]:
        config = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))
        table(config, collect(config)).to_csv(table_file, index=False, float_format="%.6g")
    rows = with_logarithms(pd.read_csv(table_file))
    with style():
        save(draw(rows), table_file.with_suffix(".png"))
    table_file.with_suffix(".md").write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
