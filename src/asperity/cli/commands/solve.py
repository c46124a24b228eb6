"""``asperity solve``: the solid pressed against a surface."""

from __future__ import annotations

import argparse
import os
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.cli.arguments import flag, section
from asperity.cli.compiling import compile_visibly, solve_small
from asperity.cli.files import check_out, is_result, read_result, write_result
from asperity.config.check import check_section
from asperity.config.defaults import complete_map
from asperity.config.reader import is_file
from asperity.contact.solution import SHOWN_ERROR
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.surface import read_surface
from asperity.results import dataset
from asperity.results.systems import cell_length, in_cell_lengths, in_si
from asperity.results.variables import SI_UNITS
from asperity.runtime.progress import ProgressBar
from asperity.units import shown_si, to_si


def run(options: argparse.Namespace) -> None:
    """Solve the contact, write it, and print its area, load and approach."""
    check_out([options.out], [options.surface])
    layer, contact = section(options, "layer"), section(options, "contact")
    young = options.young and to_si(options.young, "pressure", "--young")
    check_section("contact", contact, flag)
    contact["path_area_fractions"] = sorted(contact.get("path_area_fractions", []))
    surface, settings, edge = _surface(Path(options.surface), section(options, "measured.NAME"))
    _check_system(options.surface, surface, edge, young)
    compile_visibly("contact", partial(solve_small, layer, contact))
    with ProgressBar(f"contact {settings['name']}") as progress:
        result = solve_contact(surface, layer, contact, progress=progress)
    settings |= {"layer": layer, "contact": contact}
    if young and edge is not None:
        result, settings = in_si(result, settings, edge, young / (1 - layer["poisson"] ** 2))
        settings["young"] = young
    write_result(result, options.out, "Contact with rough surface", settings)
    pressure, approach = float(result["mean_pressure"]), float(result["approach"])
    wanted, reached = contact["area_fraction"], float(result["area_fraction"])
    missed = f" ({wanted:g} was asked for, the surface allows no nearer area)"
    print(
        f"area fraction {reached:.6g}{missed if abs(reached / wanted - 1) > SHOWN_ERROR else ''}, "
        f"mean pressure {shown_si(pressure, 'Pa') if young else f'{pressure:.6g} E*'}, "
        f"approach {shown_si(approach, 'm') if young else f'{approach:.6g}'}, "
        f"rms gradient in contact {float(result['gradient_rms_contact']):.6g}; {result.attrs['solid']}"
    )


def _surface(path: Path, given: dict[str, Any]) -> tuple[xr.Dataset, dict[str, Any], float | None]:
    """Surface and its settings in cell lengths, and the edge of the cell in m if it is known.

    The surface comes from a result of stage surface, or from a height map.
    """
    if not is_file(path):
        raise ValueError(f"{path}: {'a folder, a file is needed' if os.path.isdir(path) else 'no such file'}")
    if is_result(path):
        if given:
            raise ValueError(f"{flag(next(iter(given)))}: for height maps, {path} is a surface")
        found = read_result(path, "surface")
        edge = cell_length(found) if dataset.unit_system(found) == SI_UNITS else None
        return (*in_cell_lengths(found, dataset.settings_of(found)), edge)
    parameters = complete_map({"label": path.stem, "file": str(path), **given})
    surface = read_surface(parameters, option=flag)
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    settings = {"name": path.stem, "seed": 0, "surface": parameters}
    return surface, settings, surface.attrs.get("map_cell_length")


def _check_system(path: str, surface: xr.Dataset, edge: float | None, young: float | None) -> None:
    """Raise `ValueError` if only one of the surface and the solid is in SI units."""
    if young and edge is None:
        raise ValueError(f"--young: for surfaces with a unit, {path} has none")
    if edge is not None and not young and "map_cell_length" not in surface.attrs:
        raise ValueError(f"--young: missing; {path} is in SI units, a pressure with its unit is needed")
