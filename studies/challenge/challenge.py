"""Contact of the surface of the contact-mechanics challenge, without adhesion: writes README.md beside it.

    python studies/challenge/challenge.py studies/challenge/config.yaml

solves the contacts that are missing in the folder of results and computes the stress under one load, then
writes the table challenge*.csv, the figures and the page. ``map: FILE`` in the configuration takes the
heights of a map, peaks upward, in place of the random surface; its grid is interpolated to the finer ones.
Without a configuration, figures and page are written from the tables that are kept. Run it in the project's
folder.

M. H. Müser et al., Meeting the contact-mechanics challenge, Tribol. Lett. 65 (2017) 118, doi
10.1007/s11249-017-0900-2.
"""

import resource
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
import yaml
from matplotlib.figure import Figure

from asperity import Grid, LoadedSolid, Solid, analyse_stress, read_map, solve_contact, solve_load_path
from asperity.core.markup import markdown, with_error
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, mean_square, resample
from asperity.stress.statistics.extrapolation import (
    BOUNDARY_SHARE,
    PERCENTILES,
    OnGrid,
    extrapolated_numbers,
    numbers_on,
)
from asperity.study.small_studies import computed_once, rendered
from asperity.views.style import panels, save, style

BINS = np.linspace(0, 2.5, 101)
"""Edges of the bins of the pressure over E*ḡ."""

FILES = [
    Path(f"studies/challenge/challenge{name}.csv") for name in ("", "_pressures", "_stress", "_profiles")
]
"""Tables that are kept: contacts, distributions of the pressure, percentiles and profiles of the stress."""

TOLERANCE = 1e-4
"""Tolerance of the stress in planes on coarser grids, which are in single precision."""

SECOND_ORDER = ("mean_gap", "maximum_pressure")
"""Numbers whose error falls with the square of the spacing."""


def spectrum(config: Mapping[str, Any], wavenumber: Array) -> Array:
    """Power spectral density: flat to the roll-off, then falling as q^-(2 + 2H) to the cut-off."""
    lowest, highest = (2 * np.pi / config[name] for name in ("rolloff", "cutoff"))
    falling = np.maximum(wavenumber / lowest, 1.0) ** (-2 - 2 * config["hurst"])
    return np.where((wavenumber > 0) & (wavenumber <= highest), falling, 0.0)


def height_of(config: Mapping[str, Any]) -> tuple[Array, Grid]:
    """Heights of the map, or Gaussian ones with this spectrum and rms gradient, on the coarsest grid."""
    if "map" in config:
        read = read_map(config["map"])
        return read.as_indenter(), Grid(read.height.shape, config["length"])
    grid = Grid((config["points"][0],) * 2, config["length"])
    noise = np.random.default_rng(config["seed"]).standard_normal(grid.shape)
    modes = Fourier(grid).forward(noise) * np.sqrt(spectrum(config, grid.wavenumber()))
    modes *= config["rms_gradient"] / np.sqrt(mean_square(modes, grid, grid.wavenumber() ** 2))
    return Fourier(grid).inverse(modes), grid


def on_grid(height: Array, grid: Grid, points: int) -> tuple[Array, Grid]:
    """The same surface on a finer grid: its Fourier interpolant."""
    finer = Grid((points, points), grid.length)
    if finer.shape == grid.shape:
        return height, grid
    modes = resample(Fourier(grid).forward(height), grid, finer)
    return Fourier(finer).inverse(modes, overwrite=True), finer


def contacts(config: Mapping[str, Any], surface: tuple[Array, Grid], points: int, unit: float) -> xr.Dataset:
    """Area, boundary, mean gap over the rms height, and pressures over E*ḡ, the unit, under each load."""
    (height, grid), loads = on_grid(*surface, points), config["loads"]
    rms_height, rows, densities = float(height.std()), [], []
    solid = Solid(young=config["effective_modulus"], poisson=0.0)
    path = solve_load_path(height, solid, grid.length, mean_pressures=[load * unit for load in loads])
    start = time.process_time()
    for contact in path:
        touching = contact.pressure > 0
        edges = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
        rows.append(
            {
                "contact_area_fraction": contact.contact_area_fraction,
                "boundary": edges / touching.size,
                "mean_gap": float(contact.gap.mean()) / rms_height,
                "maximum_pressure": contact.maximum_pressure / unit,
                "error": contact.certificate.worst,
                "seconds": time.process_time() - start,
            }
        )
        counts, _ = np.histogram(contact.pressure[touching] / unit, BINS)
        densities.append(counts / (touching.size * np.diff(BINS)))
        del contact, touching  # on the largest grid the next solution needs the memory of these fields
        start = time.process_time()
    table = pd.DataFrame(rows, index=pd.Index(loads, name="load")).to_xarray()
    table["density"] = ("load", "bin"), np.array(densities)
    return table.assign_attrs(memory_GB=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9)


def collect(config: Mapping[str, Any]) -> xr.Dataset:
    """Contacts on all grids, read from their files or computed."""
    height, grid = surface = height_of(config)
    modes = Fourier(grid).forward(height)
    unit = config["effective_modulus"] * float(np.sqrt(mean_square(modes, grid, grid.wavenumber() ** 2)))
    folder = Path(config["results"])
    found = [
        computed_once(folder / f"{points}.nc", dict(config), contacts, config, surface, points, unit)
        for points in config["points"]
    ]
    memory = ("points", [one.attrs["memory_GB"] for one in found])
    return xr.concat(found, xr.Variable("points", config["points"])).assign(memory_GB=memory)


def stress_on(
    config: Mapping[str, Any], surface: tuple[Array, Grid], points: int, other: xr.Dataset | None
) -> xr.Dataset:
    """Peaks and depth profiles of the von Mises stress over E*ḡ, and cost, under one load on one grid.

    With the numbers of the grid before, `other`, also the estimates at zero spacing and their errors.
    """
    height, grid = on_grid(*surface, points)
    unit = config["effective_modulus"] * config["rms_gradient"]
    solid, load = Solid(young=config["effective_modulus"], poisson=0.0), config["stress_load"] * unit
    pressure = solve_contact(height, solid, grid.length, mean_pressure=load).pressure
    del height, surface
    start = time.process_time()
    loaded = LoadedSolid(pressure, grid, solid)
    stress = analyse_stress(loaded, poisson=config["poisson"], tolerance=TOLERANCE)
    seconds = time.process_time() - start
    for name in ("peak_value", "maximum_von_mises", "mean_von_mises"):
        stress[name] = stress[name] / unit
    results = OnGrid(pressure, load, np.nan, grid, stress)
    numbers = numbers_on(results)
    if other is not None:
        _, best, error = extrapolated_numbers(results, other, 0.0)
        for name in PERCENTILES:
            numbers[f"{name}_limit"], numbers[f"{name}_error"] = best[name], error[name]
    numbers = numbers.sel(quantity="von_mises").merge(
        stress[["maximum_von_mises", "mean_von_mises"]].rename(
            maximum_von_mises="profile_largest", mean_von_mises="profile_mean"
        )
    )
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    return numbers.assign(points=points, seconds=seconds, memory_GB=memory)


def spawned(function: Callable[..., xr.Dataset], *arguments: Any) -> xr.Dataset:
    """A call in a process of its own."""
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        return process.submit(function, *arguments).result()


def stresses(config: Mapping[str, Any]) -> list[xr.Dataset]:
    """Stress on all grids, read from files or computed, each in a process of its own for its memory."""
    surface, found = height_of(config), list[xr.Dataset]()
    for points in config["points"]:
        path, other = Path(config["results"], f"{points}_stress.nc"), found[0] if len(found) == 1 else None
        found.append(computed_once(path, dict(config), spawned, stress_on, config, surface, points, other))
    return found


def stress_tables(found: list[xr.Dataset]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Percentiles of the peaks by grid and Poisson's ratio, with estimates as grid 0, and the profiles."""
    rows, profiles = [], []
    for data in found:
        for ratio in data["poisson"].values:
            of_ratio = data.sel(poisson=ratio)
            deepest = int(of_ratio["profile_largest"].argmax("plane"))
            row = {name: float(of_ratio[name]) for name in ("points", "poisson", *PERCENTILES)}
            row["depth"] = float(data["plane_depth"][deepest])
            rows.append(row | {name: float(data[name]) for name in ("seconds", "memory_GB")})
            if "maximum_limit" in data:
                limit = {name: float(of_ratio[f"{name}_limit"]) for name in PERCENTILES}
                errors = {f"{name}_error": float(of_ratio[f"{name}_error"]) for name in PERCENTILES}
                rows.append({"points": 0, "poisson": ratio, **limit, **errors})
        profile = data[["profile_largest", "profile_mean", "plane_depth"]].to_dataframe().reset_index()
        profiles.append(profile.assign(points=int(data["points"])).drop(columns="plane"))
    return pd.DataFrame(rows).sort_values(["points", "poisson"]), pd.concat(profiles)


def draw_stress(profiles: pd.DataFrame) -> Figure:
    """Largest and mean von Mises stress by depth."""
    figure, (axis, *_) = panels(1, 1, height=75.0)
    finest = profiles[(profiles["points"] == profiles["points"].max()) & (profiles["plane_depth"] > 0)]
    for number, (ratio, profile) in enumerate(finest.groupby("poisson")):
        axis.plot(profile["plane_depth"], profile["profile_largest"], color=f"C{number}", label=f"{ratio:g}")
        axis.plot(profile["plane_depth"], profile["profile_mean"], ls="--", color=f"C{number}")
    axis.set_title("", loc="left")
    axis.set(xscale="log", ylim=(0, None), xlabel="depth, µm", ylabel=r"$\sigma_{\mathrm{vM}} / E^*\bar{g}$")
    axis.legend(title="ν")
    return figure


def limits(data: xr.Dataset) -> pd.DataFrame:
    """Numbers of each grid, and their limits at zero spacing from the first two grids, a row each.

    From the area the strip along its boundary on the finer grid is subtracted (`asperity.continuum_limit`);
    the other numbers are extrapolated with second order.
    """
    data = data.drop_vars("density")
    coarse, fine = (data.isel(points=number) for number in (0, 1))
    limit = fine.copy()
    limit["contact_area_fraction"] = fine["contact_area_fraction"] - BOUNDARY_SHARE * fine["boundary"]
    for name in SECOND_ORDER:
        limit[name] = fine[name] + (fine[name] - coarse[name]) / 3
    for name in ("seconds", "memory_GB", "error"):
        limit[name] = np.nan
    rows = xr.concat([data, limit.assign_coords(points=0)], "points").to_dataframe().reset_index()
    return rows.sort_values(["points", "load"])


def stiffness(rows: pd.DataFrame) -> tuple[Array, Array]:
    """Mean pressures between neighbouring loads, and dp̄/dδ there, in units of E*ḡ over the rms height.

    The surface and the displacement have mean zero, so that the mean gap falls as the approach grows.
    """
    load, gap = rows["load"].to_numpy(), rows["mean_gap"].to_numpy()
    return np.sqrt(load[1:] * load[:-1]), -np.diff(load) / np.diff(gap)


def persson(pressure: Array, load: float) -> Array:
    """Density of the pressure after Persson, in units of E*ḡ, where its variance in full contact is 1/4.

    B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840, doi 10.1063/1.1388626.
    """
    scale = np.sqrt(2 / np.pi)
    return scale * (np.exp(-2 * (pressure - load) ** 2) - np.exp(-2 * (pressure + load) ** 2))


def draw(rows: pd.DataFrame, densities: pd.DataFrame) -> Figure:
    """Area, gap and stiffness by load, and the distribution of the pressure."""
    figure, axes = panels(2, 2, height=75.0)
    area, gap, stiff, pressures = np.ravel(axes)
    names = {0: "limit"} | {points: f"{points}²" for points in sorted(set(rows["points"])) if points}
    markers = ("", "o", "s", "^")
    for number, (points, name) in enumerate(names.items()):
        some = rows[rows["points"] == points]
        look = {"color": f"C{number - 1}", "ls": "", "marker": markers[number], "ms": 3}
        marks = look if points else {"color": "k", "lw": 1.2}
        area.plot(some["load"], some["contact_area_fraction"] / some["load"], label=name, **marks)
        gap.plot(some["mean_gap"], some["load"], label=name, **marks)
        stiff.plot(*stiffness(some), label=name, **marks)
    area.set(xscale="log", xlabel=r"$\bar{p} / E^*\bar{g}$", ylabel=r"$a_r\, E^*\bar{g} / \bar{p}$")
    gap.set(yscale="log", xlabel=r"mean gap / rms height", ylabel=r"$\bar{p} / E^*\bar{g}$")
    stiff.set(xscale="log", yscale="log", xlabel=r"$\bar{p} / E^*\bar{g}$")
    stiff.set_ylabel(r"stiffness $\times\, h_{\mathrm{rms}} / E^*\bar{g}$")
    finest = densities[densities["points"] == densities["points"].max()]
    for number, (load, of_load) in enumerate(finest.groupby("load")):
        pressure, colour = of_load["pressure"], f"C{number}"
        pressures.plot(pressure, of_load["density"], color=colour, label=f"{load:g}")
        pressures.plot(pressure, persson(pressure, load), color=colour, lw=0.8, ls="--")
    pressures.set(yscale="log", ylim=(1e-5, None), xlabel=r"$p / E^*\bar{g}$", ylabel="probability density")
    pressures.legend(title=r"$\bar{p} / E^*\bar{g}$")
    area.legend()
    return figure


def page(rows: pd.DataFrame, stress: pd.DataFrame) -> str:
    """The page README.md beside this file, from its template."""
    grids = sorted(points for points in set(rows["points"]) if points)
    tables = {points: of_grid.set_index("load") for points, of_grid in rows.groupby("points")}
    limit, middle, finest = tables[0], tables[grids[1]], tables[grids[-1]]
    better = finest["contact_area_fraction"] - BOUNDARY_SHARE * finest["boundary"]
    shown = pd.DataFrame(
        {
            "mean pressure / E*ḡ": limit.index,
            "area, %": 100 * limit["contact_area_fraction"],
            f"area on {grids[-1]}², %": 100 * finest["contact_area_fraction"],
            "mean gap / rms height": limit["mean_gap"],
            "maximum pressure / E*ḡ": limit["maximum_pressure"],
        }
    )
    best, fine = (stress[stress["points"] == points].set_index("poisson") for points in (0, grids[-1]))
    peaks = pd.DataFrame({"ν": best.index})
    for name, text in zip(PERCENTILES, ("90 %", "99 %", "largest"), strict=True):
        three = zip(best[name], best[f"{name}_error"], fine[name], strict=True)
        peaks[text] = [
            f"{with_error(value, value * error)} ({on_grid:.4g})" for value, error, on_grid in three
        ]
    of_grids = rows[rows["points"] > 0].groupby("points")
    of_stress = stress[stress["points"] > 0].groupby("points")[["seconds", "memory_GB"]].first()
    cost = pd.DataFrame(
        {
            "grid": [f"{points}²" for points in grids],
            "all loads, s": of_grids["seconds"].sum().values,
            "memory, GB": of_grids["memory_GB"].max().values,
            "stress, s": of_stress["seconds"].values,
            "memory with its contact, GB": of_stress["memory_GB"].values,
        }
    )
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        loads=len(limit),
        grids=grids,
        area=float((limit["contact_area_fraction"] / better - 1).abs().max()),
        uncorrected=float((middle["contact_area_fraction"] / better - 1).abs().max()),
        gap=float((limit["mean_gap"] / finest["mean_gap"] - 1).abs().max()),
        contacts=markdown(shown.iloc[:: max(1, len(shown) // 4)]),
        peaks=markdown(peaks),
        cost=markdown(cost),
    )


def main() -> None:
    """Write tables, figure and page."""
    if sys.argv[1:]:
        config = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))
        data = collect(config)
        loads = np.array(config["loads"])[[len(config["loads"]) // 2, -1]]
        density = data["density"].sel(load=loads).assign_coords(bin=(BINS[1:] + BINS[:-1]) / 2)
        frame = density.rename(bin="pressure").to_dataframe().reset_index()
        tables = (limits(data), frame, *stress_tables(stresses(config)))
        for path, table, digits in zip(FILES, tables, (6, 5, 5, 5), strict=True):
            table.to_csv(path, index=False, float_format=f"%.{digits}g")
    rows, densities, stress, profiles = map(pd.read_csv, FILES)
    with style():
        save(draw(rows, densities), FILES[0].with_suffix(".png"))
        save(draw_stress(profiles), FILES[2].with_suffix(".png"))
    FILES[0].with_name("README.md").write_text(page(rows, stress), encoding="utf-8")


if __name__ == "__main__":
    main()
