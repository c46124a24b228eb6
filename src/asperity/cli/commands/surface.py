"""``asperity surface``: a random rough surface."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity.cli.files import check_out
from asperity.cli.parser import flag, section
from asperity.core.errors import one_line, shown
from asperity.core.units import shown_si, to_si
from asperity.results import write_result
from asperity.results.variables import in_si
from asperity.study.config.check import needed_instead
from asperity.study.config.defaults import PRESETS, default
from asperity.study.config.schema import setting
from asperity.study.stages.surface import make_surface

LENGTHS = ("wavelength_long", "wavelength_short", "rms_height")
"""Settings that are lengths."""

_ROUNDING = 1e-9
"""Two nodes on the shortest wavelength may be missed by this much."""


def run(options: argparse.Namespace) -> None:
    """Make the surface, write it, and print its roughness parameters."""
    check_out([("--out", options.out)])
    given = section(options, "surfaces.NAME")
    edge = None if options.length is None else to_si(options.length, "length", "--length")
    parameters = given | {name: _in_cell_lengths(name, given[name], edge) for name in LENGTHS}
    moments = {name: parameters.pop(f"moments.{name}", None) for name in ("skewness", "kurtosis")}
    if any(value is not None for value in moments.values()):
        if None in moments.values():
            raise ValueError("--skewness, --kurtosis: both are needed, or none of them")
        parameters["moments"] = moments
    points = parameters.setdefault(
        "points", PRESETS[default("accuracy")].points(parameters["wavelength_short"])
    )
    if needed := needed_instead(points, setting("surfaces.NAME.points")):
        raise ValueError(f"--points = {points}, the default: {needed} is needed")
    if points * parameters["wavelength_short"] < 2 - _ROUNDING:
        fewest = round(2 / parameters["wavelength_short"])
        raise ValueError(
            f"--points = {points}: at least {fewest} are needed, two on --wavelength-short = "
            f"{given['wavelength_short']}"
        )
    name = Path(options.out).stem
    parameters.setdefault("label", f"H = {parameters['hurst']:g}")
    surface = make_surface(parameters, options.seed)
    settings = {"name": name, "seed": options.seed, "surface": parameters}
    if edge is not None:
        surface, settings = in_si(surface, settings, edge)
    write_result(surface, options.out, f"Rough surface {name}", settings)
    height, gradient = float(surface["rms_height"]), float(surface["rms_gradient"])
    print(
        f"{one_line(options.out)}: {surface.sizes['x']} × {surface.sizes['y']} nodes, "
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
    if edge is not None:
        value = to_si(text, "length", flag(name)) / edge
    else:
        try:
            value = float(text)
        except ValueError:
            raise ValueError(
                f"{flag(name)} = {shown(text)}: a number in cell lengths is needed, or a length with a unit "
                "together with --length, the edge of the cell"
            ) from None
    if needed := needed_instead(value, setting(f"surfaces.NAME.{name}")):
        size = "" if edge is None else f", {value:.4g} of --length"
        raise ValueError(f"{flag(name)} = {shown(text)}{size}: {needed}, in cell lengths, is needed")
    return value
