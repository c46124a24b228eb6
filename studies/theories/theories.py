"""Theories of rough contact against certified contacts: writes README.md beside it and its figures.

    make theories

runs studies/theories/Snakefile: a job for each part and surface (``theories.py part PART SURFACE FILE``),
then the page (``theories.py page``). Intervals are 95 % intervals of the mean over seeds by Student's t;
errors of the grid are beside them.
"""

import sys
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import closed_forms
import contacts
import numpy as np
import pandas as pd
import xarray as xr
import yaml
from matplotlib.figure import Figure
from scipy.stats import t as student

from asperity.study.small_studies import rendered
from asperity.views.style import panels, save, style

HERE = Path(__file__).parent
PERCOLATION = 0.415
"""Area at which the gap ceases to percolate, by the abstract of Wang and Müser (2020)."""

POHRT = (0.51, 0.77)
"""Exponents of the stiffness for fractal dimensions 2 and 3, by the abstract of Pohrt and Popov (2012)."""

LOW = (0.0003, 0.003)
"""Loads between which the exponent of the stiffness is taken, over E*ḡ."""

Results = dict[str, dict[str, xr.Dataset]]


def interval(values: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Mean over seeds and half of its 95 % interval."""
    count = values.sizes["seed"]
    half = student.ppf(0.975, count - 1) * values.std("seed", ddof=1) / np.sqrt(count)
    return values.mean("seed"), half


def octaves(data: xr.Dataset, name: str, longest: float) -> pd.DataFrame:
    """Exponent of a spectrum in every octave of q from the longest wave on: mean and interval, by load.

    The exponent follows from the mean densities in the lower and the upper half of the octave; rings are
    weighted by their number of waves.
    """
    q = data["wavenumber"] * longest / (2 * np.pi)
    rows = []
    for number in range(int(np.log2(float(q.max()))) + 1):
        edges = 2.0 ** np.array([number, number + 0.5, number + 1])
        halves = [(q >= low) & (q < high) for low, high in pairwise(edges)]
        if min(int(half.sum()) for half in halves) < 1:
            continue
        density = [
            data[name].where(half, drop=True).weighted(q.where(half, drop=True)).mean("wavenumber")
            for half in halves
        ]
        places = [
            float(np.log(q.where(half, drop=True)).weighted(q.where(half, drop=True)).mean())
            for half in halves
        ]
        mean, half = interval(np.log(density[1] / density[0]) / (places[1] - places[0]))
        for load in mean["load"].values if "load" in mean.dims else [np.nan]:
            pick = {"load": load} if "load" in mean.dims else {}
            rows.append((2.0**number, load, float(mean.sel(pick)), float(half.sel(pick))))
    return pd.DataFrame(rows, columns=["q", "load", "exponent", "interval"])


def span(values: pd.Series, digits: int = 2) -> str:
    """Smallest and largest of some numbers by their magnitude, as text."""
    ends = sorted((values.min(), values.max()), key=abs)
    return " to ".join(f"{value:.{digits}f}" for value in ends)


def percent(value: float, digits: int = 0, sign: str = "") -> str:
    """A share in per cent, as text."""
    return f"{100 * value:{sign}.{digits}f} %"


def elastic_rows(results: Results) -> pd.DataFrame:
    """Area, gap and stiffness of every surface and load, with intervals, errors of the grid and theories."""
    rows = []
    for name, data in results["elastic"].items():
        for load in data["load"].values:
            one = data.sel(load=load)
            row: dict[str, Any] = {"surface": name, "load": load}
            for key in ("area", "gap", "stiffness"):
                row[key], row[f"{key}_interval"] = map(float, interval(one[key]))
                error = one["area_error"] if key == "area" else abs(one[f"{key}_half"] / one[key] - 1)
                row[f"{key}_grid"] = float(error.mean())
            row["persson_area"] = float(closed_forms.elastic_area(load))
            for gamma in data["gamma"].values:
                for key in ("gap", "stiffness"):
                    row[f"persson_{key}_{gamma:g}"] = float(one[f"persson_{key}"].sel(gamma=gamma).mean())
            rows.append(row)
    return pd.DataFrame(rows)


def plastic_rows(results: Results) -> pd.DataFrame:
    """Elastic and plastic areas with intervals, the change from half of the nodes, and theories."""
    rows = []
    for name, data in results["plastic"].items():
        for hardness in data["hardness"].values:
            for load in data["load"].values:
                one = data.sel(hardness=hardness, load=load)
                if np.isnan(one["elastic_area"]).any():
                    continue
                row: dict[str, Any] = {"surface": name, "hardness": hardness, "load": load}
                theory = closed_forms.elastoplastic_areas(load, hardness)
                for key, value in zip(("elastic_area", "plastic_area"), theory, strict=True):
                    row[key], row[f"{key}_interval"] = map(float, interval(one[key]))
                    row[f"{key}_grid"] = float(abs(one[key] - one[f"{key}_half"]).mean())
                    row[f"persson_{key}"] = float(value)
                row["cavity_area"] = float(load / closed_forms.cavity_pressure(hardness))
                row["bearing_area"] = load / hardness
                rows.append(row)
    return pd.DataFrame(rows)


def stiffness_exponents(results: Results, config: Mapping[str, Any]) -> pd.DataFrame:
    """Exponent of the stiffness at low loads, and its largest change with the grid, of every surface."""
    rows = []
    for name, data in results["elastic"].items():
        if not set(LOW) <= set(data["load"].values):
            continue
        ends = [data.sel(load=load) for load in LOW]
        span = np.log(LOW[1] / LOW[0])
        found = {}
        for key in ("stiffness", "stiffness_half"):
            # Stiffness over the load is kept.
            found[key] = 1 + np.log(ends[1][key] / ends[0][key]) / span
        mean, half = map(float, interval(found["stiffness"]))
        surface = config["surfaces"][name]
        row = {"surface": name, "hurst": surface["hurst"], "longest": surface["wavelength_long"]}
        row |= {"exponent": mean, "interval": half}
        rows.append(row | {"grid": float(abs(found["stiffness"] - found["stiffness_half"]).mean())})
    return pd.DataFrame(rows)


def percolation_rows(results: Results) -> pd.DataFrame:
    """Critical area of every surface: mean of both axes and interval over seeds, and that on the grid."""
    rows = []
    for name, data in results["percolation"].items():
        both = data.mean("axis")
        rows.append((name, *map(float, interval(both["critical_area"])), float(both["critical_grid"].mean())))
    return pd.DataFrame(rows, columns=["surface", "critical", "interval", "on_grid"])


def profile_rows(results: Results, number: str) -> pd.DataFrame:
    """Largest percentile over all depths, and the errors of the closed forms of it."""
    rows = []
    for name, data in results["profile"].items():
        for load in data["load"].values:
            one = data.sel(load=load, number=number).mean("seed")
            row: dict[str, Any] = {"surface": name, "load": load, "area": float(one["area"])}
            row["largest"] = float(one["computed"].max())
            for kind in ("gaussian", "sparse", "spectrum"):
                row[kind] = float(one[kind].max()) / row["largest"] - 1
            rows.append(row)
    return pd.DataFrame(rows)


def draw(results: Results, config: Mapping[str, Any]) -> dict[str, Figure]:
    """A figure of every theory, by name."""
    return {
        "area": _draw_area(elastic_rows(results), plastic_rows(results)),
        "spectrum": _draw_spectrum(results, config),
        "stiffness": _draw_stiffness(_of_many_loads(elastic_rows(results))),
        "gap": _draw_gap(_of_many_loads(elastic_rows(results))),
        "profile": _draw_profile(results),
    }


def _of_many_loads(rows: pd.DataFrame) -> pd.DataFrame:
    """Rows of the surfaces that are pressed under more than a few loads."""
    return rows[rows.groupby("surface")["load"].transform("size") > 3]


def _errorbar(axis: Any, x: pd.Series, y: pd.Series, error: Any, number: int, **look: Any) -> None:
    axis.errorbar(x, y, error, ms=3, lw=0.8, color=f"C{number}", **look)


def _points(axis: Any, rows: pd.DataFrame, key: str, number: int, label: str) -> None:
    error = np.hypot(rows[f"{key}_interval"], rows[f"{key}_grid"] * rows[key])
    _errorbar(axis, rows["load"], rows[key], error, number, fmt="os^DvPX"[number], label=label)


def _labelled(axis: Any, y: str, **scales: str) -> None:
    axis.set(xlabel=r"$\bar{p} / E^*\bar{g}$", ylabel=y, **({"xscale": "log"} | scales))
    for one, limits in ((axis.xaxis, axis.get_xlim()), (axis.yaxis, axis.get_ylim())):
        if one.get_scale() == "log" and limits[1] < 30 * limits[0]:  # too few decades for labels
            every = [n * 10.0**k for k in range(-4, 3) for n in (1, 2, 5)]
            shown = [value for value in every if limits[0] <= value <= limits[1]]
            one.set_ticks(shown, [f"{value:g}" for value in shown])
            one.set_ticks([], minor=True)


def _draw_area(elastic: pd.DataFrame, plastic: pd.DataFrame) -> Figure:
    figure, (ratio, elastic_axis, plastic_axis, total) = panels(2, 2, height=70.0)
    for number, (name, rows) in enumerate(elastic.groupby("surface")):
        scaled = rows.assign(
            area=rows["area"] / rows["load"], area_interval=rows["area_interval"] / rows["load"]
        )
        _points(ratio, scaled, "area", number, name)
    loads = np.geomspace(elastic["load"].min(), elastic["load"].max(), 200)
    ratio.plot(loads, closed_forms.elastic_area(loads) / loads, "k", lw=1, label="Persson")
    ratio.legend(fontsize="xx-small", ncols=2)
    ratio.set_ylim(0, None)
    _labelled(ratio, r"$a_r\,E^*\bar{g} / \bar{p}$")
    for axis, key in ((elastic_axis, "elastic_area"), (plastic_axis, "plastic_area")):
        for number, (hardness, rows) in enumerate(plastic.groupby("hardness")):
            for name, some in rows.groupby("surface"):
                face = {} if name == "hurst_08" else {"mfc": "none"}
                error = np.hypot(some[f"{key}_interval"], some[f"{key}_grid"])
                _errorbar(axis, some["load"], some[key], error, number, fmt="os^D"[number], **face)
            own = loads[(loads > 0.012) & (loads < min(0.9 * hardness, 0.25))]
            theory = closed_forms.elastoplastic_areas(own, hardness)[key == "plastic_area"]
            label = rf"$p_H = {hardness:g}\,E^*\bar{{g}}$"
            axis.plot(own, np.maximum(theory, 1e-12), color=f"C{number}", lw=1, label=label)
        axis.set_ylim(1e-4, 1)
        _labelled(axis, key.replace("_", " "), yscale="log")
    elastic_axis.legend(fontsize="xx-small")
    for number, (_, rows) in enumerate(plastic[plastic["surface"] == "hurst_08"].groupby("hardness")):
        whole = rows["elastic_area"] + rows["plastic_area"]
        theory = rows["persson_elastic_area"] + rows["persson_plastic_area"]
        for values, marker in ((theory, "o"), (rows["cavity_area"], "x"), (rows["bearing_area"], "_")):
            total.plot(rows["load"], values / whole, marker, ms=4, color=f"C{number}", mfc="none")
    for marker, name in (("o", "Persson"), ("x", "cavity"), ("_", "load over hardness")):
        total.plot([], [], marker, color="0.4", mfc="none", label=name)
    total.axhline(1, color="0.6", lw=0.6)
    total.legend(fontsize="xx-small")
    _labelled(total, "total area, theory over ours", yscale="log")
    return figure


def _draw_spectrum(results: Results, config: Mapping[str, Any]) -> Figure:
    figure, axes = panels(2, 2, height=70.0)
    for row, name in enumerate(("wide_08", "wide_03")):
        surface, data = config["surfaces"][name], results["elastic"][name]
        hurst, longest = surface["hurst"], surface["wavelength_long"]
        density, local = axes[2 * row : 2 * row + 2]
        slopes = octaves(data, "pressure_spectrum", longest)
        for number, load in enumerate((0.01, 0.1, 1.0)):
            mean = data["pressure_spectrum"].sel(load=load).mean("seed")
            q = mean["wavenumber"] * longest / (2 * np.pi)
            density.plot(q[q >= 1], mean[q >= 1], lw=0.8, color=f"C{number}", label=f"{load:g}")
            some = slopes[slopes["load"] == load]
            _errorbar(local, some["q"] * 2**0.5, -some["exponent"], some["interval"], number, fmt="o-")
        for value, look, label in ((1 + hurst, "--", "1 + H"), (2 * hurst, ":", "2 H, full contact")):
            local.axhline(value, color="k", ls=look, lw=0.8, label=label)
        for axis in (density, local):
            axis.axvline(longest / surface["wavelength_short"], color="0.7", lw=0.6)
            axis.set(xscale="log", xlabel=r"$q\,\lambda_l / 2\pi$")
        density.set(yscale="log", ylabel=rf"pressure spectrum, $H$ = {hurst:g}")
        local.set(ylim=(0, 5), ylabel="− exponent in an octave")
        density.legend(title=r"$\bar{p} / E^*\bar{g}$", fontsize="x-small")
        local.legend(fontsize="x-small")
    return figure


def _draw_stiffness(rows: pd.DataFrame) -> Figure:
    figure, (scaled, theory) = panels(2, 1, height=75.0)
    for number, (name, some) in enumerate(rows.groupby("surface")):
        _points(scaled, some, "stiffness", number, name)
        ratio = some.assign(stiffness=some["stiffness"] / some["persson_stiffness_0.45"])
        ratio["stiffness_interval"] /= some["persson_stiffness_0.45"]
        _points(theory, ratio, "stiffness", number, name)
    scaled.legend(fontsize="xx-small")
    scaled.set_ylim(1, 100)
    _labelled(scaled, r"$K h_{\mathrm{rms}} / \bar{p}$", yscale="log")
    theory.axhline(1, color="0.6", lw=0.6)
    _labelled(theory, "stiffness over Persson's, γ = 0.45", yscale="log")
    return figure


def _draw_gap(rows: pd.DataFrame) -> Figure:
    figure, (gap, ratio) = panels(2, 1, height=75.0)
    for number, (name, some) in enumerate(rows.groupby("surface")):
        _points(gap, some, "gap", number, name)
        gap.plot(some["load"], some["persson_gap_0.45"], color=f"C{number}", lw=0.8)
        for gamma, look in (("0.45", "-"), ("1", ":")):
            ratio.plot(
                some["load"], some[f"persson_gap_{gamma}"] / some["gap"], look, color=f"C{number}", lw=1
            )
    for look, label in (("-", "γ = 0.45"), (":", "γ = 1")):
        ratio.plot([], [], look, color="0.4", label=label)
    gap.legend(fontsize="xx-small")
    ratio.legend(fontsize="x-small")
    _labelled(gap, r"mean gap / $h_{\mathrm{rms}}$", yscale="log")
    ratio.axhline(1, color="0.6", lw=0.6)
    _labelled(ratio, "mean gap, Persson over ours", yscale="log")
    return figure


def _draw_profile(results: Results) -> Figure:
    figure, (absolute, relative) = panels(2, 1, height=75.0)
    for name, marker in zip(results["profile"], "osx", strict=False):
        data = results["profile"][name].mean("seed")
        for number, load in enumerate(data["load"].values):
            one = data.sel(load=load, number="p99")
            if marker == "o":
                absolute.plot(one["depth"], one["computed"], "o", ms=3, color=f"C{number}", label=f"{load:g}")
                for kind, look in (("gaussian", ":"), ("sparse", "-"), ("spectrum", "--")):
                    absolute.plot(one["depth"], one[kind], look, lw=1, color=f"C{number}")
            relative.plot(
                one["depth"], one["sparse"] / one["computed"], f"{marker}-", ms=3, lw=0.8, color=f"C{number}"
            )
    for look, label in (
        (":", "Gaussian"),
        ("-", "in the contact's share"),
        ("--", "from the heights' spectrum"),
    ):
        absolute.plot([], [], look, color="0.4", label=label)
    absolute.legend(title=r"$\bar{p} / E^*\bar{g}$", fontsize="xx-small")
    relative.axhline(1, color="0.6", lw=0.6)
    relative.axhspan(0.8, 1.2, color="0.93", zorder=0)
    for axis in (absolute, relative):
        axis.set(xscale="log", xlabel=r"depth / $\lambda_s$")
    absolute.set(ylim=(0, 1.35), ylabel=r"99 % of $\sigma_{\mathrm{vM}}$ in a plane / $E^*\bar{g}$")
    relative.set(ylabel="in the contact's share, over computed")
    return figure


def page(results: Results, config: Mapping[str, Any]) -> str:
    """The page README.md beside this file, from its template."""
    wide = {
        name: octaves(data, "pressure_spectrum", config["surfaces"][name]["wavelength_long"])
        for name, data in results["elastic"].items()
    }
    rms = [
        float(abs(data["gaussian"].sel(number="rms") / data["computed"].sel(number="rms") - 1).max())
        for data in results["profile"].values()
    ]
    return rendered(
        HERE / "page.md.j2",
        span=span,
        percent=percent,
        config=config,
        elastic=elastic_rows(results),
        plastic=plastic_rows(results),
        octaves=wide,
        exponents=stiffness_exponents(results, config),
        percolation=percolation_rows(results),
        profile=profile_rows(results, "p99"),
        rms=max(rms),
        certificate=max(float(data["certificate"].max()) for data in results["elastic"].values()),
        critical=PERCOLATION,
        pohrt=POHRT,
        ends=LOW,
    )


def read(config: Mapping[str, Any]) -> Results:
    """Results of all jobs: part → surface → dataset."""
    folder = Path(config["results"])
    return {
        part: {
            name: xr.load_dataset(folder / f"{part}-{name}.nc")
            for name in (config["surfaces"] if part == "elastic" else config[part]["surfaces"])
        }
        for part in contacts.PARTS
    }


def main() -> None:
    """Compute a part, or write the page."""
    config = yaml.safe_load((HERE / "config.yaml").read_text(encoding="utf-8"))
    if sys.argv[1:2] == ["part"]:
        part, surface, file = sys.argv[2:]
        contacts.part_of(config, part, surface).to_netcdf(file)
        return
    results = read(config)
    with style():
        for name, figure in draw(results, config).items():
            save(figure, Path(f"studies/theories/theories_{name}.png"))
    Path("studies/theories/README.md").write_text(page(results, config), encoding="utf-8")


if __name__ == "__main__":
    main()
