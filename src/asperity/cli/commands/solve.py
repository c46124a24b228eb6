"""``asperity solve``: the solid pressed against a surface."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.cli.arguments import flag, section
from asperity.cli.files import check_out, is_result, read_result, write_result
from asperity.config.defaults import complete_map
from asperity.config.reader import is_file
from asperity.contact.solution import SHOWN_ERROR
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.surface import read_surface
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar


def run(options: argparse.Namespace) -> None:
    """Solve the contact, write it, and print its area, load and approach."""
    check_out([options.out], [options.surface])
    surface, settings = _surface(Path(options.surface), section(options, "measured.NAME"))
    layer, contact = section(options, "layer"), section(options, "contact")
    contact["path_area_fractions"] = sorted(contact.get("path_area_fractions", []))
    with ProgressBar(f"contact {settings['name']}") as progress:
        result = solve_contact(surface, layer, contact, progress=progress)
    settings |= {"layer": layer, "contact": contact}
    write_result(result, options.out, "Contact with rough surface", settings)
    wanted, reached = contact["area_fraction"], float(result["area_fraction"])
    missed = f" ({wanted:g} was asked for, the surface allows no nearer area)"
    print(
        f"area fraction {reached:.6g}{missed if abs(reached / wanted - 1) > SHOWN_ERROR else ''}, "
        f"mean pressure {float(result['mean_pressure']):.6g} E*, approach {float(result['approach']):.6g}, "
        f"rms gradient in contact {float(result['gradient_rms_contact']):.6g}; {result.attrs['solid']}"
    )


def _surface(path: Path, given: dict[str, Any]) -> tuple[xr.Dataset, dict[str, Any]]:
    """Surface and its settings, from a result of the study or from a height map."""
    if not is_file(path):
        raise ValueError(f"{path}: no such file")
    if is_result(path):
        if given:
            raise ValueError(f"{flag(next(iter(given)))}: for height maps, {path} is a surface")
        surface = read_result(path, "surface")
        return surface, dataset.settings_of(surface)
    parameters = complete_map({"label": path.stem, "file": str(path), **given})
    surface = read_surface(parameters, option=flag)
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    return surface, {"name": path.stem, "seed": 0, "surface": parameters}
