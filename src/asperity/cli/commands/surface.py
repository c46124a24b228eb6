"""``asperity surface``: a random rough surface."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from asperity.cli.files import check_out
from asperity.cli.parser import section
from asperity.core.errors import shown
from asperity.core.units import shown_si, to_si
from asperity.results import write_result
from asperity.results.variables import in_si
from asperity.study.config.check import needed_instead
from asperity.study.config.defaults import default
from asperity.study.config.presets import PRESETS
from asperity.study.config.schema import setting
from asperity.study.stages.surface import make_surface

LENGTHS = ("wavelength_long", "wavelength_short", "rms_height")
"""Settings that are lengths."""

_ROUNDING = 1e-9
"""Two nodes on the shortest wavelength may be missed by this much."""


def run(options: argparse.Namespace) -> None:
    """Make the surface, write it, and print its roughness parameters."""
    check_out([options.out])
    given = section(options, "surfaces.NAME")
    edge = None if options.length is None else to_si(options.length, "length", "--length")
    parameters = given | {name: _in_cell_lengths(name, given[name], edge) for name in LENGTHS}
    moments = {name: parameters.pop(f"moments.{name}", None) for name in ("skewness", "kurtosis")}
    if any(value is not None for value in moments.values()):
        parameters["moments"] = _checked_moments(moments)
    short = parameters["wavelength_short"]
    parameters.setdefault("points", PRESETS[default("accuracy")].points(short))
    _check_band(parameters, given)
    name = Path(options.out).stem
    parameters.setdefault("label", f"H = {parameters['hurst']:g}")
    surface = make_surface(parameters, options.seed)
    settings = {"name": name, "seed": options.seed, "surface": parameters}
    if edge is not None:
        surface, settings = in_si(surface, settings, edge)
    write_result(surface, options.out, f"Rough surface {name}", settings)
    height, gradient = float(surface["rms_height"]), float(surface["rms_gradient"])
    print(
        f"{options.out}: {surface.sizes['x']} × {surface.sizes['y']} nodes, "
        f"rms height {f'{height:.4g} cell lengths' if edge is None else shown_si(height, 'm')}, "
        f"rms gradient {gradient:.4g}, skewness {float(surface['skewness']):.3g}, "
        f"kurtosis {float(surface['kurtosis']):.3g}"
    )


def _in_cell_lengths(name: str, text: str, edge: float | None) -> float:
    """A length as a multiple of the edge of the cell.

    Raises
    ------
    ValueError
        If it has a unit and the cell has none or the reverse, or the schema does not accept it.
    """
    flag = _flag(name)
    if edge is not None:
        value = to_si(text, "length", flag) / edge
    else:
        try:
            value = float(text)
        except ValueError:
            raise ValueError(
                f"{flag} = {shown(text)}: a number in cell lengths is needed, or a length with a unit "
                "together with --length, the edge of the cell"
            ) from None
    if needed := needed_instead(value, setting(f"surfaces.NAME.{name}")):
        size = "" if edge is None else f", {value:.4g} of --length"
        raise ValueError(f"{flag} = {shown(text)}{size}: {needed}, in cell lengths, is needed")
    return value


def _checked_moments(moments: dict[str, float | None]) -> dict[str, float]:
    skewness, kurtosis = moments["skewness"], moments["kurtosis"]
    if skewness is None or kurtosis is None:
        raise ValueError("--skewness, --kurtosis: both are needed, or none of them")
    if kurtosis <= 1 + skewness**2:
        raise ValueError(
            f"--kurtosis = {kurtosis:g}: a number > {1 + skewness**2:g}, 1 + skewness², is needed"
        )
    return {"skewness": skewness, "kurtosis": kurtosis}


def _check_band(parameters: dict[str, Any], given: dict[str, Any]) -> None:
    """Raise `ValueError` if the wavelengths contradict each other or the number of nodes."""
    short, long, points = (parameters[name] for name in ("wavelength_short", "wavelength_long", "points"))
    if short > long:
        raise ValueError(
            f"--wavelength-short = {shown(given['wavelength_short'])}: at most --wavelength-long = "
            f"{given['wavelength_long']} is needed"
        )
    most = setting("surfaces.NAME.points")["maximum"]
    if points > most:
        raise ValueError(f"--points: the default, {points}, is more than {most}; another number is needed")
    if points * short < 2 - _ROUNDING:
        raise ValueError(
            f"--points = {points}: at least {round(2 / short)} are needed, two on --wavelength-short = "
            f"{given['wavelength_short']}"
        )


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")
