"""``asperity solve``: the solid pressed against a surface."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.cli.files import check_out, is_result, read_stage
from asperity.cli.notice import progress_bar
from asperity.cli.parser import flag, section
from asperity.contact.solution import SHOWN_ERROR
from asperity.core.errors import shown
from asperity.core.units import shown_si, to_si
from asperity.results import dataset, write_result
from asperity.results.dataset import grid_of
from asperity.results.variables import SI_UNITS, cell_length, in_cell_lengths, in_si
from asperity.study.config.check import check_section
from asperity.study.config.defaults import complete_map, default
from asperity.study.stages.contact import largest_approach, solve_contact
from asperity.study.stages.solid import solid
from asperity.study.stages.surface import read_surface
from asperity.surface.reading.formats import path_problem
from asperity.surface.reading.height_map import MapError

DIMENSIONS_OF_LOADS = {"mean_pressure": "pressure", "force": "force", "approach": "length"}
"""Quantities that can be imposed in place of the area, and their dimensions."""


def run(options: argparse.Namespace) -> None:
    """Solve the contact, write it, and print its area, load and approach."""
    check_out([options.out], [options.surface])
    layer, contact = section(options, "layer"), section(options, "contact")
    young = options.young and to_si(options.young, "pressure", "--young")
    given = _loads_given(options, contact)
    check_section("contact", contact, flag)
    contact["path_area_fractions"] = sorted(contact.get("path_area_fractions", []))
    surface, settings, edge = _surface(Path(options.surface), section(options, "measured.NAME"))
    _check_system(options.surface, surface, edge, young)
    if given:
        scale = None if edge is None or not young else (edge, young / (1 - layer["poisson"] ** 2))
        load = _load(*given, scale, _map_area(surface, settings))
        _check_approach(given[1], load, surface, layer, edge)
        check_section("contact", load, flag)
        contact |= load
    with progress_bar(f"contact {settings['name']}") as progress:
        result = solve_contact(surface, layer, contact, progress=progress)
    settings |= {"layer": layer, "contact": contact}
    if young and edge is not None:
        result, settings = in_si(result, settings, edge, young / (1 - layer["poisson"] ** 2))
        settings["young"] = young
    write_result(result, options.out, f"Contact with rough surface {settings['name']}", settings)
    lowest = float(surface["height"].min()) * (edge if young and edge else 1.0)
    pressure, approach = float(result["mean_pressure"]), float(result["approach"]) - lowest
    reached = float(result["area_fraction"])
    wanted = contact.get("area_fraction", reached)
    missed = f" ({wanted:g} was asked for, the surface allows no nearer area)"
    print(
        f"area fraction {reached:.6g}{missed if abs(reached - wanted) > SHOWN_ERROR * wanted else ''}, "
        f"mean pressure {shown_si(pressure, 'Pa') if young else f'{pressure:.6g} E*'}, "
        f"approach since first touch {shown_si(approach, 'm') if young else f'{approach:.6g}'}, "
        f"rms gradient in contact {float(result['gradient_rms_contact']):.6g}; {result.attrs['solid']}"
    )


def _surface(path: Path, given: dict[str, Any]) -> tuple[xr.Dataset, dict[str, Any], float | None]:
    """Surface and its settings in cell lengths, and the edge of the cell in m if it is known.

    The surface comes from a result of stage surface, or from a height map.
    """
    if problem := path_problem(path):
        raise ValueError(f"{path}: {problem}")
    if is_result(path):
        if given:
            raise ValueError(f"{flag(next(iter(given)))}: for height maps, {path} is a surface")
        found = read_stage(path, "surface")
        edge = cell_length(found) if dataset.unit_system(found) == SI_UNITS else None
        return (*in_cell_lengths(found, dataset.settings_of(found)), edge)
    parameters = complete_map({"label": path.stem.replace("$", r"\$"), "file": str(path), **given})
    try:
        surface = read_surface(parameters)
    except MapError as error:
        raise error.renamed(flag) from error
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    settings = {"name": path.stem, "seed": 0, "surface": parameters}
    return surface, settings, surface.attrs.get("map_cell_length")


def _check_system(path: str, surface: xr.Dataset, edge: float | None, young: float | None) -> None:
    """Raise `ValueError` if only one of the surface and the solid is in SI units."""
    if young and edge is None:
        raise ValueError(f"--young: for surfaces with a unit, {path} has none")
    if edge is not None and not young and "map_cell_length" not in surface.attrs:
        raise ValueError(f"--young: missing; {path} is in SI units, a pressure with its unit is needed")


def _loads_given(options: argparse.Namespace, contact: dict[str, Any]) -> tuple[str, str] | None:
    """Name and text of an imposed quantity other than the area; without one `contact` gets an area."""
    others = {name: getattr(options, name) for name in DIMENSIONS_OF_LOADS}
    given = [(name, text) for name, text in others.items() if text is not None]
    names = [flag(name) for name, _ in given] + ["--area-fraction"] * ("area_fraction" in contact)
    if len(names) > 1:
        raise ValueError(f"{names[0]}: not accepted together with {names[1]}; one load is imposed")
    if given:
        return given[0]
    contact.setdefault("area_fraction", default("contact.area_fraction"))
    return None


def _load(name: str, text: str, scale: tuple[float, float] | None, area: float) -> dict[str, float]:
    """The load as a setting of section ``contact``, in the units of the study.

    Parameters
    ----------
    name, text : str
        Imposed quantity, and its value as the user gives it.
    scale : (length, modulus) or None
        Edge of the cell in m and effective modulus in Pa; None without them.
    area : float
        On which a force acts, over the square of the edge of the cell.
    """
    try:
        number = float(text)
    except ValueError:
        number = None
    if number is not None and name != "force":
        return {name: number}
    if number is not None:
        raise ValueError(f"{flag(name)} = {shown(text)}: a force with its unit, such as '12 N', is needed")
    value = to_si(text, DIMENSIONS_OF_LOADS[name], flag(name))
    if not value > 0:
        raise ValueError(f"{flag(name)} = {shown(text)}: more than 0 is needed")
    if scale is None:
        raise ValueError(f"{flag(name)} = {shown(text)}: needs --young and a surface with a unit")
    length, modulus = scale
    if name == "approach":
        return {"approach": value / length}
    return {"mean_pressure": value / modulus / (area * length**2 if name == "force" else 1)}


def _map_area(surface: xr.Dataset, settings: dict[str, Any]) -> float:
    """Area on which a force acts, in cell lengths: that of the cell, of which a mirrored map is a quarter."""
    images = 4 if settings["surface"].get("periodic") == "mirrored" else 1
    return grid_of(surface).area / images


def _check_approach(
    text: str, load: dict[str, float], surface: xr.Dataset, layer: dict[str, Any], edge: float | None
) -> None:
    """Raise `ValueError` for an approach that no pressure causes."""
    most = largest_approach(surface["height"].values, solid(layer)[0])
    if load.get("approach", 0.0) >= most:
        shown_most = f"{most:.6g}" if edge is None else shown_si(most * edge, "m")
        raise ValueError(
            f"--approach = {text}: less than {shown_most} is needed, the height of the mean plane above the "
            "point that touches first; there a periodic half-space is in full contact"
        )
