"""Real contact area against Nayak's parameter of the surface: writes README.md, its figure and table.

    python studies/nayak/nayak.py studies/nayak/config.yaml

computes the contacts that are missing in the folder of results, then the table nayak.csv. Without a
configuration the page is written from the table that is kept. Run it in the project's folder.

κ = a_r E* ḡ / p̄ and κ_r = a_r E* ḡ_r / p̄, with the area fraction a_r, the rms gradients ḡ of the whole
surface and ḡ_r of the real contact, where the rough surface has the slope of the deformed one.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import stdtrit

from asperity import Grid, Solid, self_affine, solve_load_path
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, gradient, mean_square
from asperity.study.small_studies import computed_once, rendered, write_study
from asperity.views.style import panels

HALF_SPACE = Solid(young=1.0, poisson=0.0)
"""A solid with E* = 1; area over load does not depend on Poisson's ratio."""

STRIP = (math.pi - 1 + math.log(2)) / 24
"""Share of grid spacing times boundary length by which the nodes of contact overestimate its area.

Yastrebov, Anciaux and Molinari, Tribol. Int. 114 (2017) 161, doi 10.1016/j.triboint.2017.04.023.
"""

FEWEST_SEEDS = 2
"""Seeds of a surface on its finest grid, from which its scatter is known."""

COARSEST = 4
"""Nodes of all seeds of the coarsest grid, which gives most of the scatter, over the nodes of any other."""

ORDERS = (0.5, 2.0)
"""Smallest and largest order of convergence with which a limit is extrapolated."""

NUMBERS = {"kappa": "κ", "kappa_r": "κ_r"}
STRUCTURE = {"ln_nayak": "ln α", "hurst": "H", "ln_ratio": "ln λ_l/λ_s"}
"""Terms that describe the surface, each tried beside the area."""

MARKERS = ("o", "s", "^")


def nayak_parameter(height: Array, grid: Grid) -> float:
    """Nayak's parameter α = m₀ m₄ / m₂² of an isotropic surface, 3/2 or more.

    The moments describe a profile: ⟨h²⟩ = m₀, ⟨|∇h|²⟩ = 2 m₂ and ⟨(∇²h)²⟩ = 8 m₄ / 3 (P. R. Nayak, J. Lubr.
    Technol. 93 (1971) 398, doi 10.1115/1.3451608).
    """
    coefficients = Fourier(grid).forward(height - height.mean())
    squared = grid.wavenumber() ** 2
    heights, slopes, curvatures = (mean_square(coefficients, grid, squared**n) for n in (0, 1, 2))
    return 1.5 * heights * curvatures / slopes**2


def boundary_integral(touching: Array, values: Array, grid: Grid) -> float:
    """Integral of a field along the boundary of contact, which follows the edges of the grid's squares.

    The value on an edge is the mean of the values of the two nodes beside it.
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
                "contact_area_fraction": contact.contact_area_fraction,
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
            found.setdefault(name, {})[nodes] = computed_once(path, settings, contacts, *settings)
    return found


def proportionality(data: xr.Dataset, spacing: float, corrected: bool) -> dict[str, xr.DataArray]:
    """Area fraction, κ and κ_r of each seed and load; `corrected`: without the strip along the boundary."""
    strip = STRIP * spacing * corrected
    area = data["contact_area_fraction"] - strip * data["boundary_length"]
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

    It is the order of the sum of their relative changes over the last three grids, limited to `ORDERS`; it is
    one with two grids, or where the changes do not shrink.
    """
    relative = np.sum([np.diff(one) / one[-1] for one in found], axis=0)
    if relative.size < 2 or not relative[-2] or not 0 < relative[-1] / relative[-2] < 1:
        return 1.0
    return float(np.clip(-np.log2(relative[-1] / relative[-2]), *ORDERS))


def limit(levels: Sequence[Array], order: float) -> tuple[float, float]:
    """Mean over seeds at zero grid spacing by Richardson's extrapolation, and its standard error."""
    gain = 1 / (2**order - 1)
    found = means(levels)
    parts = [levels[0], *(fine - coarse[: fine.size] for coarse, fine in pairwise(levels))]
    weights = [1.0] * (len(parts) - 1) + [1 + gain]
    variances = [w**2 * v.var(ddof=1) / v.size for w, v in zip(weights, parts, strict=True)]
    return float(found[-1] + gain * (found[-1] - found[-2])), math.sqrt(sum(variances))


def table(config: Mapping[str, Any], samples: Mapping[str, Mapping[float, xr.Dataset]]) -> pd.DataFrame:
    """Limits of the area, κ and κ_r of all surfaces under all loads, a row each.

    With and without the strip along the boundary the numbers converge in different ways to one limit. Each of
    the two has one order of convergence for all rows. The discretisation error is the difference of the two
    limits; column ``…_error`` holds the errors of the grid and of the seeds together.
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


def regress(rows: pd.DataFrame, number: str, term: str) -> tuple[float, float, float]:
    """Change of a number over the range of a term, and share of the variance explained.

    Least squares on the term, ln a_r and a constant, weighted by the errors. The change is relative. The half
    width of its 95 % interval (Student's t) is from the leave-one-surface-out jackknife, because rows of
    one surface share their seeds.
    """
    slope, explained = _fit(rows, number, term)
    left_out = [_fit(rows[rows["surface"] != name], number, term)[0] for name in rows["surface"].unique()]
    count = len(left_out)
    error = float(stdtrit(count - 3, 0.975)) * math.sqrt(count - 1) * float(np.std(left_out))
    width = float(np.ptp(rows[term])) / float(rows[number].mean())
    return slope * width, error * width, explained


def _fit(rows: pd.DataFrame, number: str, term: str) -> tuple[float, float]:
    """Slope with a term, and share of the variance explained."""
    weight = 1 / np.maximum(rows[f"{number}_error"].to_numpy(), 1e-3 * rows[number].abs().to_numpy())
    matrix = np.column_stack([np.ones(len(rows)), rows[term], rows["ln_area"]])
    value = rows[number].to_numpy()
    found = np.linalg.lstsq(matrix * weight[:, None], value * weight, rcond=None)[0]
    spread = value - np.average(value, weights=weight**2)
    explained = 1 - np.sum((weight * (value - matrix @ found)) ** 2) / np.sum((weight * spread) ** 2)
    return float(found[1]), float(explained)


def draw(rows: pd.DataFrame) -> Figure:
    """κ and κ_r against α with their standard errors, a marker for each H and a colour for each load."""
    rows = with_logarithms(rows)
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
    """The page README.md beside this file, from its template."""
    rows = with_logarithms(rows)
    found = {number: {term: regress(rows, number, term) for term in STRUCTURE} for number in NUMBERS}
    change, error, _ = found["kappa"]["ln_nayak"]
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        rows=rows,
        numbers=NUMBERS,
        changes=found,
        explained={term: share for term, (*_, share) in found["kappa"].items()},
        falls=change < -error,
        clear=[
            STRUCTURE[term] for term, (change, error, _) in found["kappa_r"].items() if abs(change) > error
        ],
    )


if __name__ == "__main__":
    write_study("nayak", lambda config: table(config, collect(config)), draw, page)
