"""Errors and times of the settings of accuracy, before and after the grid is corrected (`make tradeoff`).

    python benchmarks/tradeoff.py            # measures, in less than ten minutes, and writes all that follows
    python benchmarks/tradeoff.py --pages    # writes the tables and the figure again

Random surfaces with H = 0.2 and 0.8 and eight seeds (λ_l = L/8, λ_s = L/32, ν = 0.33) are pressed with the
loads that make 2 and 10 % contact. Grids are compared with the estimate of `asperity.continuum_limit` on 32
nodes on λ_s. Every other parameter is varied alone from a converged reference on 8 nodes. The error of an
output is the largest of all surfaces under that load. Times hold for a surface with λ_s = L/256, as in the
paper.

Written are ``src/asperity/study/cost/errors.csv``, which `asperity plan` uses, the tables of
``paper/supplement/tradeoff.md`` and ``config/README.md``, and ``paper/supplement/tradeoff.png``.
"""

import re
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from continuum import LAYER, height_of
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter
from measuring import parser_of
from tqdm import tqdm

import asperity as asp
from asperity.core.markup import markdown
from asperity.elasticity.solid import simplest_solid
from asperity.settings.accuracy import KEYS, PRESETS
from asperity.study.cost.plan import spacing_of
from asperity.views.style import panels, save, style

ERRORS = Path("src/asperity/study/cost/errors.csv")
PAGES = {"grids": Path("paper/supplement/tradeoff.md"), "presets": Path("config/README.md")}
FIGURE = Path("paper/supplement/tradeoff.png")

AREAS, EXPONENTS, SEEDS = (0.02, 0.1), (0.2, 0.8), range(1, 9)
GRIDS, FINEST, PAPER = (4, 6, 8, 12, 16), 32, 8
CONVERGED = {"contact_tolerance": 1e-9, "depth_tolerance": 1e-7, "depth_spacing": 0.125}
VARIED = {
    "contact_tolerance": (1e-3, 1e-4, 1e-6),
    "depth_tolerance": (1e-1, 1e-2, 1e-4),
    "depth_spacing": (4.0, 2.0, 1.0, 0.5, 0.25),
    "precision": ("float32",),
}
HEIGHTS = (0.5, 1.0)
"""Heights, in cell lengths, of the layers that are replaced by a half-space."""

SHOWN = {
    "contact_area_fraction": "area at given load",
    "proportionality": "κ_r",
    "pressure_p99": "p99 of pressure",
    "von_mises_p99": "p99 of von Mises",
    "peak_depth": "depth of peaks",
    "decay_length_plane": "decay in the plane",
}


LABELS = {
    "points_per_wavelength": "nodes on λ_s",
    "seeds": "`seeds`",
    **{parameter: f"`{key}`" for key, parameter in KEYS.items()},
}


def surface_of(hurst: float, seed: int, wavelengths: int = 4) -> dict[str, float]:
    """Settings of a surface, as `continuum.height_of` takes them; `wavelengths` is λ_l/λ_s."""
    return {"hurst": hurst, "wavelengths": wavelengths, "cells": 8, "seed": seed, "delta": 0.0}


def pressed(
    surface: dict[str, float],
    nodes: float,
    load: dict[str, float],
    *,
    layer: asp.Solid = LAYER,
    deepest: float = 1.0,
    contact_tolerance: float = 1e-6,
    depth_tolerance: float = 1e-4,
    depth_spacing: float = 0.5,
    precision: str = "float64",
) -> tuple[asp.Contact, pd.DataFrame]:
    """Contact of a surface, and its outputs with the seconds: columns ``on_grid`` and ``estimate``."""
    height = height_of(surface, nodes)
    times = [time.process_time()]
    contact = asp.solve_contact(height, layer, **load, rtol=contact_tolerance, dtype=precision)
    depths = asp.stress.depth_grid(contact.grid, deepest, depth_spacing, depth_spacing / 4)
    stress = asp.analyse_stress(
        contact, depths, quantities=("pressure", "von_mises"), tolerance=depth_tolerance, covariances=True
    )
    times.append(time.process_time())
    found = asp.continuum_limit(contact, stress).squeeze("poisson")
    times.append(time.process_time())
    von_mises = found.sel(quantity="von_mises")
    outputs = {
        **{
            name: found[name] for name in ("contact_area_fraction", "gradient_rms_contact", "proportionality")
        },
        **{
            f"{kind}_{name}": found[name].sel(quantity=kind)
            for kind in ("pressure", "von_mises")
            for name in ("p90", "p99")
        },
        "maximum_von_mises": von_mises["maximum"],
        "peak_depth": von_mises["mean_depth"],
        "peak_depth_highest": von_mises["mean_depth_highest"],
        **{name: found[name] for name in ("decay_length_depth", "decay_length_plane")},
    }
    kinds = ["on_grid", "estimate"]
    table = pd.DataFrame({name: values.sel(kind=kinds).values for name, values in outputs.items()}, kinds).T
    table.loc["seconds"] = times[1] - times[0], times[2] - times[0]
    return contact, table


def runs(hurst: float, area: float) -> Iterator[tuple[str, str, pd.DataFrame]]:
    """Parameter, setting, and errors of every run of one kind of surface under one load."""
    load: dict[str, float] = {"contact_area_fraction": area}
    estimates = []
    for seed in tqdm(SEEDS, f"H = {hurst}, area {area:.0%}"):
        surface = surface_of(hurst, seed)
        contact, finest = pressed(surface, FINEST, load)
        load = {"mean_pressure": contact.mean_pressure}  # of the first surface
        for nodes in GRIDS:
            found = pressed(surface, nodes, load, depth_spacing=spacing_of(nodes))[1]
            yield "points_per_wavelength", str(nodes), _relative(found, finest["estimate"])
            if nodes == PAPER:
                estimates.append(found["estimate"])
        yield from varied(surface, load)
    mean = sum(estimates) / len(estimates)
    for estimate in estimates:
        yield "seeds", "1", _relative(estimate.to_frame("estimate"), mean)


def varied(surface: dict[str, float], load: dict[str, float]) -> Iterator[tuple[str, str, pd.DataFrame]]:
    """The same for every parameter except the grid; errors belong to the values on the grid."""
    converged = pressed(surface, PAPER, load, **CONVERGED)[1]["on_grid"]
    for parameter, settings in VARIED.items():
        for setting in settings:
            changes = CONVERGED | {parameter: setting}
            if parameter == "precision":
                changes["contact_tolerance"] = 1e-6  # the smallest that single precision accepts
            found = pressed(surface, PAPER, load, **changes)[1]["on_grid"]
            yield parameter, str(setting), _relative(found.to_frame("estimate"), converged)
    for height in HEIGHTS:
        layer = asp.Solid(LAYER.young, LAYER.poisson, height)
        bound = simplest_solid(layer, 2 * np.pi, 0.0).difference
        found, expected = (
            pressed(surface, PAPER, load, layer=solid, deepest=height, **CONVERGED)[1]["on_grid"]
            for solid in (LAYER, layer)
        )
        yield "half_space_tolerance", f"{bound:.3g}", _relative(found.to_frame("estimate"), expected)


def _relative(found: pd.DataFrame, expected: pd.Series) -> pd.DataFrame:
    """Relative errors of all outputs."""
    return (found.div(expected, axis="index") - 1).abs().drop("seconds")


def timed() -> Iterator[pd.DataFrame]:
    """Rows of the seconds on each grid and with each preset, on the grid and with the correction."""
    kinds: list[tuple[str, str, float, dict[str, Any]]] = [
        ("points_per_wavelength", str(nodes), nodes, {"depth_spacing": spacing_of(nodes)}) for nodes in GRIDS
    ]
    for name, preset in PRESETS.items():
        changes = {parameter: getattr(preset, parameter) for parameter in VARIED}
        kinds.append(("accuracy", name, preset.points_per_wavelength, changes))
    for parameter, setting, nodes, changes in tqdm(kinds, "times"):
        found = pressed(surface_of(0.8, 1, 32), nodes, {"contact_area_fraction": max(AREAS)}, **changes)[1]
        row = found.loc[["seconds"]].rename_axis("output").reset_index()
        yield row.assign(contact_area_fraction=max(AREAS), parameter=parameter, setting=setting)


def measure() -> pd.DataFrame:
    """The table `ERRORS`."""
    rows = []
    for area in AREAS:
        for hurst in EXPONENTS:
            for parameter, setting, errors in runs(hurst, area):
                table = errors.rename_axis("output").reset_index()
                rows.append(table.assign(contact_area_fraction=area, parameter=parameter, setting=setting))
    rows += timed()  # after all functions have been compiled
    every = pd.concat(rows, ignore_index=True).rename(columns={"estimate": "error"})
    keys = ["contact_area_fraction", "parameter", "setting", "output"]
    largest = every.groupby(keys, sort=False)[["on_grid", "error"]].max()
    of_seeds = every[every["parameter"] == "seeds"].groupby(keys, sort=False)["error"]
    freedom = len(EXPONENTS) * (len(SEEDS) - 1)
    deviation = np.sqrt(of_seeds.agg(lambda error: np.sum(error**2)) / freedom)
    largest.loc[deviation.index, "error"] = deviation
    return largest.reset_index()


def percent(value: float) -> str:
    """A relative error as a percentage with two digits."""
    return "0" if value < 5e-7 else f"{float(f'{100 * value:.2g}'):g} %"


def tables(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Tables of the pages by their mark."""
    at = table[table["contact_area_fraction"] == max(AREAS)].set_index(["parameter", "setting", "output"])
    at = at.sort_index()
    grids = []
    for nodes in GRIDS:
        row = at.loc["points_per_wavelength", str(nodes)]
        before, after = row.loc["seconds", ["on_grid", "error"]]
        cells = {
            text: f"{percent(row.loc[name, 'on_grid'])} → {percent(row.loc[name, 'error'])}"
            for name, text in SHOWN.items()
        }
        grids.append({"nodes on λ_s": nodes, **cells, "seconds": f"{before:.2g} → {after:.2g}"})
    names = [LABELS[name] for name in asdict(PRESETS["paper"])]
    errors = [f"error of {text}" for text in SHOWN.values()]
    presets = {"": [*names, "processor time of one surface (s)", *errors]}
    for name, preset in PRESETS.items():
        row = at.loc["points_per_wavelength", f"{preset.points_per_wavelength:g}"]
        values = [value if isinstance(value, str) else f"{value:g}" for value in asdict(preset).values()]
        errors = [percent(row.loc[output, "error"]) for output in SHOWN]
        seconds = at.loc[("accuracy", name, "seconds"), "error"]
        presets[f"`{name}`"] = [*values, f"{seconds:.2g}", *errors]
    found = {"grids": grids, "presets": presets}
    return {mark: pd.DataFrame(rows) for mark, rows in found.items()}


def write_pages(table: pd.DataFrame) -> None:
    """Write the tables into the pages, each below its mark, and the figure."""
    for mark, shown in tables(table).items():
        page = PAGES[mark]
        below = re.compile(rf"(<!-- {mark}: make tradeoff -->\n)(\|.*\n)*")
        text = below.sub(rf"\g<1>{markdown(shown)}\n", page.read_text(encoding="utf-8"))
        page.write_text(text, encoding="utf-8")
    with style():
        save(draw(table), FIGURE)


def draw(table: pd.DataFrame) -> Any:
    """Errors of three outputs against the processor time, on the grid and corrected."""
    figure, axes = panels(columns=3, height=60)
    at = table[
        (table["contact_area_fraction"] == max(AREAS)) & (table["parameter"] == "points_per_wavelength")
    ]
    by_grid = at.pivot(index="setting", columns="output", values=["on_grid", "error"])
    by_grid = by_grid.loc[[str(nodes) for nodes in GRIDS]]
    for axis, name in zip(axes, ("contact_area_fraction", "von_mises_p99", "peak_depth"), strict=True):
        for kind, text, marker in (("on_grid", "on the grid", "o"), ("error", "corrected", "s")):
            seconds, errors = by_grid[kind, "seconds"], 100 * by_grid[kind, name]
            axis.loglog(seconds, errors, marker=marker, label=text)
            for nodes, x, y in zip(GRIDS, seconds, errors, strict=True):
                axis.annotate(str(nodes), (x, y), (3, 3), textcoords="offset points", fontsize=6)
        axis.set(xlabel="processor time of one surface (s)", ylabel=f"{SHOWN[name]}: error (%)")
        for direction in (axis.xaxis, axis.yaxis):
            direction.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            direction.set_major_formatter(FormatStrFormatter("%g"))
            direction.set_minor_formatter(NullFormatter())
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def main() -> None:
    """Measure unless the table is to be kept, and write the pages."""
    parser = parser_of(__doc__)
    parser.add_argument("--pages", action="store_true", help="measure nothing, write tables and figure")
    if not parser.parse_args().pages:
        measure().to_csv(ERRORS, index=False, float_format="%.3g")
    write_pages(pd.read_csv(ERRORS, dtype={"setting": str}))


if __name__ == "__main__":
    main()
