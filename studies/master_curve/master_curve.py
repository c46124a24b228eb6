"""Test whether height and depth of the von Mises peaks follow one curve: writes README.md beside it,
.csv, .png.

    python studies/master_curve/master_curve.py studies/master_curve/config.yaml

computes the surfaces that are missing in the folder of results, then the table master_curve.csv. Without
a configuration the page is written from the table that is kept. Run it in the project's folder.

A number y over its scale s is one curve if ln(y/s) depends on Poisson's ratio alone. The *scatter* of a scale
is the root mean square of ln(y/s) after subtraction of the mean of each Poisson's ratio, over
all surfaces and areas. All errors are standard errors of the jackknife over surfaces.
"""

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.markup import with_error
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, gradient
from asperity.reference.hertz import Hertz
from asperity.results.dataset import grid_of
from asperity.settings.study import read_study
from asperity.stress import autocorrelation
from asperity.stress.statistics.covariance import half_length
from asperity.study.small_studies import computed_once, rendered, write_study
from asperity.study.stages.contact import press_surface
from asperity.study.stages.statistics import seed_statistics
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface
from asperity.views.style import panels

HEIGHT_SCALES = {
    "height_gradient_contact": ("E\\*ḡ_r, gradient of the contact", r"$E^*\bar{g}_r$"),
    "height_gradient_whole": ("E\\*ḡ, gradient of the whole surface", r"$E^*\bar{g}$"),
    "height_contact_pressure": ("p̄/a_r, mean pressure of the contact", r"($\bar{p}/a_r$)"),
}
"""Column of the table → scale of the height on the page, and in the figure."""

DEPTH_SCALES = {
    "depth_pressure_length": ("ℓ_p, half width of the autocovariance of the pressure", r"$\ell_p$"),
    "depth_hydraulic_radius": ("area over half the boundary of contact", "(2 area/boundary)"),
    "depth_patch_radius": ("area-weighted mean radius of the patches", "patch radius"),
    "depth_curvature_length": ("√(m₂/m₄) over the contact", r"$\sqrt{m_2/m_4}$"),
    "depth_height_length": ("√(m₀/m₂) over the contact", r"$\sqrt{m_0/m_2}$"),
    "depth_wavelength": ("λ_s", r"$\lambda_s$"),
}
"""Column of the table → scale of the depth on the page, and in the figure; the last one is λ_s itself."""

WAVELENGTH = "depth_wavelength"
COLLAPSED = 0.05
"""Largest scatter that counts as one curve."""

REFERENCE = 0.33
"""Poisson's ratio to which the others are compared."""


def contact_lengths(height: np.ndarray, contact: xr.Dataset) -> dict[str, float]:
    """Lengths of one contact, in units of the cell.

    ``pressure_length``: distance at which the autocovariance of the pressure falls to half;
    ``hydraulic_radius``: twice the area over the length of its boundary, the radius of a circle;
    ``height_length``: rms height over rms profile slope over the contact, √(m₀/m₂)_r;
    ``curvature_length``: rms profile slope over curvature over the contact, √(m₂/m₄)_r.
    """
    grid, pressure = grid_of(contact), contact["pressure"].values
    touching = pressure > 0
    fourier = Fourier(grid)
    coefficients = fourier.forward(height)
    slope_y, slope_x = gradient(coefficients, fourier)
    laplacian = fourier.inverse(-(grid.wavenumber() ** 2) * coefficients)
    slope = np.sqrt((slope_y**2 + slope_x**2)[touching].mean() / 2)
    edges = [np.sum(touching != np.roll(touching, 1, axis)) for axis in (0, 1)]
    boundary = edges[0] * grid.spacing[1] + edges[1] * grid.spacing[0]
    lag, covariance = autocorrelation(pressure, grid)
    return {
        "pressure_length": half_length(lag, covariance / covariance[0]),
        "hydraulic_radius": 2 * touching.mean() / boundary * (4 / np.pi),
        "height_length": float(height[touching].std() / slope),
        "curvature_length": float(slope / np.sqrt(3 / 8 * (laplacian[touching] ** 2).mean())),
    }


def numbers_of(parameters: Mapping[str, Any], seed: int, settings: Mapping[str, Any]) -> xr.Dataset:
    """Height and depth of the high peaks of one seed over every scale, under all areas."""
    surface, contact_settings = make_surface(parameters, seed), settings["contact"]
    found = []
    for area in sorted(
        {*contact_settings["path_contact_area_fractions"], contact_settings["contact_area_fraction"]}
    ):
        of_area = {**contact_settings, "contact_area_fraction": area, "path_contact_area_fractions": []}
        contact = press_surface(surface, settings["layer"], of_area)
        layer = settings["layer"]
        stress = compute_stress(contact, layer, settings["stress"])[layer["lateral"]]
        high = seed_statistics(surface, contact, stress).sel(quantity="von_mises", level=0.99, drop=True)
        scaled, depth = high["seed_peak_quantile"], high["seed_mean_depth_highest"]
        slope, touching = high["seed_gradient_rms_contact"], high["seed_contact_area_fraction"]
        lengths = {"wavelength": parameters["wavelength_short"], "patch_radius": high["seed_patch_radius"]}
        lengths |= contact_lengths(surface["height"].values, contact)
        numbers = {
            "area": touching,
            "height_gradient_contact": scaled,
            "height_gradient_whole": scaled * slope / high["seed_rms_gradient"],
            "height_contact_pressure": scaled * slope * touching / high["seed_mean_pressure"],
            **{f"depth_{name}": depth / length for name, length in lengths.items()},
        }
        found.append(xr.Dataset(numbers))
    return xr.concat(found, "load")


def numbers_of_seeds(surface: Mapping[str, Any], config: Mapping[str, Any]) -> xr.Dataset:
    """Numbers of all seeds of a surface."""
    return xr.concat([numbers_of(surface, seed, config) for seed in config["seeds"]], "seed")


def collect(config: Mapping[str, Any]) -> dict[str, xr.Dataset]:
    """Surface → numbers of all seeds, read from their files or computed."""
    parts = {section: config[section] for section in ("layer", "contact", "stress", "seeds")}
    folder = Path(config["results"])
    return {
        name: computed_once(folder / f"{name}.nc", [surface, parts], numbers_of_seeds, surface, config)
        for name, surface in config["surfaces"].items()
    }


def table(config: Mapping[str, Any], samples: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Mean height and depth over every scale, a row for each surface, area and Poisson's ratio."""
    rows = []
    for name, data in samples.items():
        surface = config["surfaces"][name]
        for load in range(data.sizes["load"]):
            for poisson in data["poisson"].values:
                row = {
                    "surface": name,
                    "hurst": surface["hurst"],
                    "ratio": surface["wavelength_long"] / surface["wavelength_short"],
                    "skewed": "johnson" in surface,
                    "area": float(data["area"].isel(load=load).mean()),
                    "poisson": float(poisson),
                    "seeds": data.sizes["seed"],
                }
                for key in (*HEIGHT_SCALES, *DEPTH_SCALES):
                    each = np.log(data[key].isel(load=load).sel(poisson=poisson).values)
                    row[key] = math.exp(each.mean())
                    row[f"{key}_error"] = row[key] * each.std(ddof=1) / math.sqrt(each.size)
                rows.append(row)
    return pd.DataFrame(rows)


def _design(rows: pd.DataFrame, terms: Sequence[str]) -> Array:
    """Columns of least squares: one for each Poisson's ratio, then the terms.

    A term is ``"ln a_r"``, or a key of `DEPTH_SCALES`: the logarithm of that length over λ_s, from the depth
    over both.
    """
    known = {"ln a_r": np.log(rows["area"])}
    known |= {key: np.log(rows[WAVELENGTH] / rows[key]) for key in DEPTH_SCALES}
    constants = [(rows["poisson"] == nu).astype(float) for nu in np.sort(rows["poisson"].unique())]
    return np.column_stack([*constants, *(known[term] for term in terms)])


def _fit(rows: pd.DataFrame, key: str, terms: Sequence[str]) -> Array:
    """Coefficients of the least squares of the logarithm of a number."""
    return np.linalg.lstsq(_design(rows, terms), np.log(rows[key].to_numpy()), rcond=None)[0]


def _left(rows: pd.DataFrame, key: str, terms: Sequence[str], coefficients: Array) -> Array:
    """Residual of the logarithm of a number after a fit."""
    return np.log(rows[key].to_numpy()) - _design(rows, terms) @ coefficients


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _jackknife(rows: pd.DataFrame, function: Callable[[pd.DataFrame], Any]) -> Array:
    """A function of the rows and its standard errors, leaving one surface out at a time."""
    names = rows["surface"].unique()
    found = np.array([function(rows[rows["surface"] != name]) for name in names])
    variance = (names.size - 1) / names.size * ((found - found.mean(axis=0)) ** 2).sum(axis=0)
    return np.array([function(rows), np.sqrt(variance)])


def scatter(rows: pd.DataFrame, key: str, terms: Sequence[str] = ()) -> Array:
    """Scatter of a number over its scale, after terms that are fitted too, and its error."""
    return _jackknife(rows, lambda some: _root_mean_square(_left(some, key, terms, _fit(some, key, terms))))


def exponent(rows: pd.DataFrame, key: str, term: str) -> Array:
    """Slope of the logarithm of a number with a term, and its error."""
    return _jackknife(rows, lambda some: _fit(some, key, [term])[-1])


def of_poisson(rows: pd.DataFrame, key: str) -> dict[float, Array]:
    """Geometric mean of a number over surfaces and areas at each Poisson's ratio, and its error."""
    found = _jackknife(rows, lambda some: np.exp(_fit(some, key, ())))
    return dict(zip(np.sort(rows["poisson"].unique()).tolist(), found.T, strict=True))


def held_out(rows: pd.DataFrame, key: str, terms: Sequence[str]) -> float:
    """Root mean square error with which a fit to all other surfaces predicts the logarithm for a surface."""
    errors = []
    for name in rows["surface"].unique():
        chosen = rows["surface"] == name
        errors.append(_left(rows[chosen], key, terms, _fit(rows[~chosen], key, terms)))
    return _root_mean_square(np.concatenate(errors))


def hertz_peak(poisson: float) -> tuple[float, float]:
    """Largest von Mises stress on the axis of a Hertzian contact over its mean pressure, and depth over a."""
    contact, radius = Hertz.from_approach(1e-2, 1.0), math.sqrt(1e-2)
    depth = np.linspace(0, 1.5, 3001) * radius
    stress = contact.stress(np.zeros_like(depth), depth, poisson).von_mises
    top = int(np.argmax(stress))
    return float(stress[top] / contact.mean_contact_pressure), float(depth[top] / radius)


def draw(rows: pd.DataFrame) -> Figure:
    """Height over E*ḡ_r, depth over λ_s, and the curve of the depth."""
    figure, (height, depth, curve) = panels(3, 1)
    for axis, key in ((height, "height_gradient_contact"), (depth, WAVELENGTH)):
        _draw_points(axis, rows, rows["area"], key, [0.02, 0.05, 0.1, 0.2])
        axis.set(xlabel="area fraction $a_r$", ylim=(0, None))
    length = rows[WAVELENGTH] / rows["depth_curvature_length"]
    _draw_points(curve, rows, length, WAVELENGTH, [0.12, 0.15, 0.2, 0.25, 0.3])
    power = _fit(rows, WAVELENGTH, ["depth_curvature_length"])[-1]
    ends = np.array([length.min(), length.max()])
    for colour, (_, some) in enumerate(rows.groupby("poisson")):
        factor = np.exp(np.log(some[WAVELENGTH] / length[some.index] ** power).mean())
        curve.plot(ends, factor * ends**power, color=f"C{colour}", lw=0.8)
    curve.set(yscale="log", xlabel=r"$\sqrt{m_2/m_4}$ over contact / $\lambda_s$")
    ticks = [0.1, 0.15, 0.2, 0.25, 0.3]
    curve.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    curve.set_yticks([], minor=True)
    height.legend(loc="lower right", ncols=2, fontsize="x-small")
    return figure


def _draw_points(axis: Axes, rows: pd.DataFrame, along: pd.Series, key: str, ticks: Sequence[float]) -> None:
    """Points with their errors: a colour for each Poisson's ratio, a marker for each kind of surface."""
    kinds = [(f"$H$ = {hurst:g}", (rows["hurst"] == hurst) & ~rows["skewed"]) for hurst in (0.2, 0.5, 0.8)]
    kinds.append(("skewed", rows["skewed"]))
    ratios = sorted(rows["poisson"].unique())
    for marker, (name, chosen) in zip("os^D", kinds, strict=True):
        for colour, poisson in enumerate(ratios):
            some = rows[chosen & (rows["poisson"] == poisson)]
            x, y, error = along[some.index], some[key], some[f"{key}_error"]
            axis.errorbar(x, y, error, fmt=marker, ms=3, lw=0.7, color=f"C{colour}")
        axis.plot([], [], marker, color="0.4", ms=3, ls="none", label=name)
    for colour, poisson in enumerate(ratios):
        axis.plot([], [], color=f"C{colour}", label=rf"$\nu$ = {poisson:g}")
    axis.set(xscale="log", ylabel=_label(key))
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_xticks([], minor=True)


def _label(key: str) -> str:
    return f"{key.partition('_')[0]} / {(HEIGHT_SCALES | DEPTH_SCALES)[key][1]}"


def page(rows: pd.DataFrame) -> str:
    """The page README.md beside this file, from its template."""
    height = min(HEIGHT_SCALES, key=lambda key: scatter(rows, key)[0])
    length = min(list(DEPTH_SCALES)[:-1], key=lambda key: scatter(rows, WAVELENGTH, [key])[0])
    filters = {
        "percent": lambda found: f"{with_error(*(100 * found))} %",
        "error": lambda found: with_error(*found),
    }
    deviations = [
        found[nu][0] / found[REFERENCE][0] * hertz_peak(REFERENCE)[number] / hertz_peak(nu)[number] - 1
        for number, found in enumerate((of_poisson(rows, height), of_poisson(rows, length)))
        for nu in found
    ]
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        filters,
        rows=rows,
        height=height,
        length=length,
        names={key: name for key, (name, _) in (HEIGHT_SCALES | DEPTH_SCALES).items()},
        depths=DEPTH_SCALES,
        wavelength=WAVELENGTH,
        collapsed=COLLAPSED,
        reference=REFERENCE,
        hertz=max(map(abs, deviations)),
        **{function.__name__: function for function in (scatter, exponent, held_out, of_poisson)},
    )


if __name__ == "__main__":
    write_study(
        "master_curve", lambda _: table(config := read_study(sys.argv[1:]), collect(config)), draw, page
    )
