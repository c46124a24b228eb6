"""``asperity surface``: a random rough surface."""

import argparse
from pathlib import Path
from typing import Any

from asperity.cli.files import check_out
from asperity.cli.parser import flag, section
from asperity.core.errors import one_line, shown
from asperity.core.units import shown_si, to_si
from asperity.results.dataset import write_result
from asperity.results.variables import in_si
from asperity.settings.accuracy import PRESETS
from asperity.settings.check import default
from asperity.settings.configuration import TWO_NODES_SLACK, Configuration
from asperity.settings.model import NeededError, converted
from asperity.study.stages.surface import make_surface
from asperity.surface.reading.height_map import MapError

LENGTHS = ("wavelength_long", "wavelength_short", "rms_height")
"""Settings that are lengths."""


def run(options: argparse.Namespace) -> None:
    """Make the surface, write it, and print its roughness parameters."""
    check_out([("--out", options.out)])
    given = section(options, "surfaces.NAME")
    edge = None if options.length is None else to_si(options.length, "length", "--length")
    parameters = given | {name: _in_cell_lengths(name, given[name], edge) for name in LENGTHS}
    parameters |= _distribution(options, parameters)
    preset = PRESETS[default("accuracy")]
    points = parameters.setdefault("points", preset.points(parameters["wavelength_short"]))
    try:
        converted(Configuration, "surfaces.NAME.points", str(points))
    except NeededError as needed:
        raise ValueError(f"--points = {points}, the default: {needed} is needed") from None
    if points * parameters["wavelength_short"] < 2 - TWO_NODES_SLACK:
        fewest = f"at least {round(2 / parameters['wavelength_short'])} are needed"
        shortest = f"two on --wavelength-short = {given['wavelength_short']}"
        raise ValueError(f"--points = {points}: {fewest}, {shortest}")
    name = Path(options.out).stem
    parameters.setdefault("label", f"H = {parameters['hurst']:g}")
    try:
        surface = make_surface(parameters, options.seed)
    except MapError as error:
        raise error.renamed(flag) from error
    settings = {"name": name, "seed": options.seed, "surface": parameters}
    if edge is not None:
        surface, settings = in_si(surface, settings, edge)
    write_result(surface, options.out, f"Rough surface {name}", settings)
    height, gradient = float(surface["rms_height"]), float(surface["rms_gradient"])
    missed = ""
    if "heights_residual" in surface:
        missed = (
            f", spectrum kept to {float(surface['spectrum_residual']):.1g}, heights to "
            f"{100 * float(surface['heights_residual']):.2g} % of the rms height"
        )
    print(
        f"{one_line(options.out)}: {surface.sizes['x']} × {surface.sizes['y']} nodes, "
        f"rms height {f'{height:.4g} cell lengths' if edge is None else shown_si(height, 'm')}, "
        f"rms gradient {gradient:.4g}, skewness {float(surface['skewness']):.3g}, "
        f"kurtosis {float(surface['kurtosis']):.3g}{missed}"
    )


def _distribution(options: argparse.Namespace, parameters: dict[str, Any]) -> dict[str, Any]:
    """Settings of the heights of a surface, by `moments` or `heights`, taken from its parameters."""
    popped = {name: parameters.pop(f"moments.{name}", None) for name in ("skewness", "kurtosis")}
    moments = {name: value for name, value in popped.items() if value is not None}
    of_map, parts = section(options, "measured.NAME"), ("rpq", "rvq", "rmq")
    if len(moments) == 1:
        raise ValueError("--skewness, --kurtosis: both are needed, or none of them")
    if options.keep_spectrum and not moments:
        raise ValueError("--keep-spectrum: --skewness and --kurtosis are needed with it")
    if of_map and not options.heights_of:
        raise ValueError(f"{flag(next(iter(of_map)))}: --heights-of is needed with it")
    given = {
        "moments": moments,
        "plateau": options.plateau and dict(zip(parts, options.plateau, strict=True)),
        "map": options.heights_of and {"file": options.heights_of, **of_map},
    }
    given = {kind: value for kind, value in given.items() if value}
    if len(given) > 1:
        raise ValueError("--skewness, --plateau, --heights-of: only one of them is accepted")
    return given if moments and not options.keep_spectrum else {"heights": given} if given else {}


def _in_cell_lengths(name: str, text: str, edge: float | None) -> float:
    """A length as a multiple of the edge of the cell; both must have a unit, or neither."""
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
    try:
        return converted(Configuration, f"surfaces.NAME.{name}", repr(value))
    except NeededError as needed:
        size = shown(text) + ("" if edge is None else f", {value:.4g} of --length")
        raise ValueError(f"{flag(name)} = {size}: {needed}, in cell lengths, is needed") from None
