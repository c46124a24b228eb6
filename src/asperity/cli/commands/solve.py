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
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.surface import read_surface
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar


def run(options: argparse.Namespace) -> None:
    """Solve the contact, write it, and print its area, load and approach."""
    check_out([options.out], [options.surface])
    layer, contact = section(options, "layer"), section(options, "contact")
    check_section("contact", contact, flag)
    contact["path_area_fractions"] = sorted(contact.get("path_area_fractions", []))
    surface, settings = _surface(Path(options.surface), section(options, "measured.NAME"))
    compile_visibly("contact", partial(solve_small, layer, contact))
    with ProgressBar(f"contact {settings['name']}") as progress:
        result = solve_contact(surface, layer, contact, progress=progress)
    settings |= {"layer": layer, "contact": contact}
    write_result(result, options.out, "Contact with rough surface", settings)
    print(
        f"area fraction {float(result['area_fraction']):.6g}, "
        f"mean pressure {float(result['mean_pressure']):.6g} E*, approach {float(result['approach']):.6g}, "
        f"rms gradient in contact {float(result['gradient_rms_contact']):.6g}; {result.attrs['solid']}"
    )


def _surface(path: Path, given: dict[str, Any]) -> tuple[xr.Dataset, dict[str, Any]]:
    """Surface and its settings, from a result of the study or from a height map."""
    if not is_file(path):
        raise ValueError(f"{path}: {'a folder, a file is needed' if os.path.isdir(path) else 'no such file'}")
    if is_result(path):
        if given:
            raise ValueError(f"{flag(next(iter(given)))}: for height maps, {path} is a surface")
        surface = read_result(path, "surface")
        return surface, dataset.settings_of(surface)
    parameters = complete_map({"label": path.stem, "file": str(path), **given})
    surface = read_surface(parameters, option=flag)
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    return surface, {"name": path.stem, "seed": 0, "surface": parameters}
