"""``asperity solve``: the solid pressed against a surface."""

import argparse
from contextlib import suppress
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.cli.files import check_out, in_words, is_result, read_stage
from asperity.cli.parser import flag, section
from asperity.contact.solution import SHOWN_ERROR
from asperity.core.errors import one_line, shown
from asperity.core.units import to_si
from asperity.results.dataset import grid_of, settings_of, unit_system, write_result
from asperity.results.variables import SI_UNITS, cell_length, in_cell_lengths, in_si
from asperity.settings.check import default
from asperity.settings.configuration import Contact
from asperity.settings.load import UNITS
from asperity.settings.model import SettingsError
from asperity.study.progress_and_log import ProgressBar
from asperity.study.stages.contact import press_surface
from asperity.study.stages.surface import read_surface
from asperity.surface.reading.height_map import MapError
from asperity.surface.reading.map_file import path_problem

DIMENSIONS = {"mean_pressure": "pressure", "force": "force", "approach": "length", "hardness": "pressure"}
"""Quantities that can be imposed in place of the area, and the hardness → dimension of their unit."""


def run(options: argparse.Namespace) -> None:
    """Solve the contact, write it, and print its area, load and approach."""
    check_out([("--out", options.out)], [options.surface])
    layer, contact = section(options, "layer"), section(options, "contact")
    young = options.young and _in_si("young", options.young, "pressure")
    given = {name: text for name in DIMENSIONS if (text := getattr(options, name, None)) is not None}
    names = [flag(name) for name in (*given, *contact) if name in UNITS]
    if len(names) > 1:
        raise ValueError(f"{names[0]}: not accepted together with {names[1]}; one load is imposed")
    if not names:
        contact["area_fraction"] = default("contact.area_fraction")
    surface, settings, edge = _surface(Path(options.surface), section(options, "measured.NAME"))
    if young and edge is None:
        raise ValueError(f"--young: for surfaces with a unit, {options.surface} has none")
    if edge is not None and not young and "map_cell_length" not in surface.attrs:
        needed = "a pressure with its unit is needed"
        raise ValueError(f"--young: missing; {options.surface} is in SI units, {needed}")
    modulus = young and young / (1 - layer["poisson"] ** 2)
    si = bool(edge and modulus)
    for name, text in given.items():
        load = _load(name, text, edge if name == "approach" else modulus, si)
        if name == "force" and edge:
            name = "mean_pressure"
            load /= grid_of(surface).area * edge**2
        contact[name] = load
    try:
        Contact.read(contact)
    except SettingsError as error:
        raise error.renamed(flag) from None
    contact["path_area_fractions"] = sorted(contact.get("path_area_fractions", []))
    with ProgressBar(one_line(f"contact {settings['name']}")) as progress:
        result = press_surface(surface, layer, contact, progress=progress)
    settings |= {"layer": layer, "contact": contact}
    scale = 1.0
    if edge and modulus:
        result, settings = in_si(result, settings, edge, modulus)
        settings["young"], scale = young, edge
    write_result(result, options.out, f"Contact with rough surface {settings['name']}", settings)
    lowest = float(surface["height"].min()) * scale
    pressure, approach = float(result["mean_pressure"]), float(result["approach"]) - lowest
    reached = float(result["area_fraction"])
    wanted = contact.get("area_fraction", reached)
    plastic = ""
    if "plastic_load" in result:
        plastic = f"{100 * float(result['plastic_load']):.4g} % of the load at the hardness, "
    missed = f" ({wanted:g} was asked for, the surface allows no nearer area)"
    print(
        f"area fraction {reached:.6g}{missed if abs(reached - wanted) > SHOWN_ERROR * wanted else ''}, "
        f"mean pressure {in_words(pressure, 'Pa', si)}, "
        f"{plastic}approach since first touch {in_words(approach, 'm', si)}, "
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
        edge = cell_length(found) if unit_system(found) == SI_UNITS else None
        return (*in_cell_lengths(found, settings_of(found)), edge)
    parameters = {"label": path.stem.replace("$", r"\$"), "file": str(path), **given}
    try:
        surface = read_surface(parameters)
    except MapError as error:
        raise error.renamed(flag) from error
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    settings = {"name": path.stem, "seed": 0, "surface": parameters}
    return surface, settings, surface.attrs.get("map_cell_length")


def _load(name: str, text: str, unit: float | None, si: bool) -> float:
    """A load or the hardness in the units of the study; a force over the effective modulus.

    `unit` is the edge of the cell in m, or the effective modulus in Pa, if they are known. With `si` both are
    known, and a value with a unit is accepted.
    """
    if name != "force":
        with suppress(ValueError):
            return float(text)
    value = _in_si(name, text, DIMENSIONS[name])
    if not (si and unit):
        raise ValueError(f"{flag(name)} = {shown(text)}: needs --young and a surface with a unit")
    return value / unit


def _in_si(name: str, text: str, dimension: str) -> float:
    """A positive quantity in SI, from its value as the user gives it."""
    value = to_si(text, dimension, flag(name))
    if not value > 0:
        raise ValueError(f"{flag(name)} = {shown(text)}: more than 0 is needed")
    return value
