"""``asperity export``: peaks as a table, and fields of the stress for ParaView and other programs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import xarray as xr

from asperity.cli.arguments import section, sliding
from asperity.cli.compiling import compile_visibly, planes_small
from asperity.cli.files import check_out, stage_of
from asperity.cli.places import is_si, length, places, span
from asperity.errors import shown
from asperity.results import dataset
from asperity.results.export import export_units, make_box, write_box, write_peaks
from asperity.results.export_surface import (
    named,
    surface_fields,
    write_surface_image,
    write_surface_table,
)
from asperity.results.tables import SUFFIXES
from asperity.runtime.preflight import require_space
from asperity.runtime.progress import ProgressBar
from asperity.stress.arguments import FIELDS, checked_ratios, checked_sliding
from asperity.types import Array
from asperity.views.source import sources

_MAKERS = {"surface": "asperity surface", "contact": "asperity solve", "stress": "asperity stress"}


def run(options: argparse.Namespace) -> None:
    """Write the files that are asked for, and print what each holds."""
    fields = [(*_chosen(what), path) for what, path in options.field or ()]
    profiles = [(_line(where), path) for where, path in options.profile or ()]
    endings = {
        **dict.fromkeys([path for *_, path in fields], (".vti",)),
        **dict.fromkeys([path for _, path in profiles], (".csv",)),
        **dict.fromkeys([path for path in [options.peaks] if path], SUFFIXES),
        **dict.fromkeys(options.surface or (), (".vti", ".csv")),
    }
    if not endings:
        raise ValueError(
            "nothing to export: --peaks FILE.csv, --surface FILE.vti, --profile y=PLACE FILE.csv or "
            "--field NAMES:DEPTHS FILE.vti is needed"
        )
    check_out(list(endings), options.results)
    for path, accepted in endings.items():
        if Path(path).suffix not in accepted:
            raise ValueError(f"{path}: a name that ends in {' or '.join(accepted)} is needed")
    given = _by_stage(options.results)
    if options.peaks:
        count = write_peaks(_needed(given, "stress", "--peaks"), options.peaks)
        print(f"{options.peaks}: {count} peaks")
    for path in options.surface or ():
        _export_surface(_with_surface(given), path, options)
    for where, path in profiles:
        _export_profile(_with_surface(given), where, path)
    for names, depths, path in fields:
        _export_box(_needed(given, "contact", "--field"), names, depths, path, options)


def _chosen(text: str) -> tuple[list[str], str]:
    """Names of fields and range of depth, from text such as ``von_mises,xx:0-40um``."""
    names, colon, depths = text.partition(":")
    if not colon or not depths:
        raise ValueError(f"--field {shown(text)}: NAMES:DEPTHS, such as von_mises,xx:0-40um, is needed")
    listed = names.split(",")
    for name in listed:
        if name not in FIELDS or listed.count(name) > 1:
            raise ValueError(f"--field {shown(name)}: each once of {', '.join(FIELDS)} is needed")
    return listed, depths


def _by_stage(paths: list[str]) -> dict[str, xr.Dataset]:
    found: dict[str, xr.Dataset] = {}
    for path in paths:
        data = dataset.read(path)
        stage = stage_of(data)
        if stage not in _MAKERS:
            raise ValueError(
                f"{path}: a result of {stage or 'no stage'}, one of {', '.join(_MAKERS)} is needed"
            )
        if stage in found:
            raise ValueError(f"{path}: a second result of {stage}, one is needed")
        found[stage] = data
    return found


def _needed(given: Mapping[str, xr.Dataset], stage: str, option: str) -> xr.Dataset:
    if stage not in given:
        raise ValueError(f"{option}: a {stage} file (of {_MAKERS[stage]}) is needed, none is given")
    return given[stage]


def _with_surface(given: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """The contact, or without one the surface."""
    return given["contact"] if "contact" in given else _needed(given, "surface", "--surface, --profile")


def _fields(data: xr.Dataset) -> dict[str, Array]:
    """Fields over the surface; the height under a contact follows from gap and displacement."""
    return surface_fields(data, sources(data)[0].fields.get("height"))


def _export_surface(data: xr.Dataset, path: str, options: argparse.Namespace) -> None:
    si, source, fields = is_si(data), sources(data)[0], _fields(data)
    part = source.window(
        **{name: span(f"--{name}", text, si) for name in "yx" if (text := getattr(options, name))}
    )
    write = write_surface_image if Path(path).suffix == ".vti" else write_surface_table
    bytes_of_node = 4 if write is write_surface_image else 16
    require_space(
        Path(path).absolute().parent, 1e-6 * bytes_of_node * part.y.size * part.x.size * len(fields)
    )
    write(data, path, fields, part)
    names = ", ".join(named(fields, export_units(data)))
    print(f"{path}: {names} at {part.x.size} × {part.y.size} nodes along x, y")


def _line(where: str) -> tuple[str, str]:
    """Axis and place of a profile, from text such as ``y=205um``."""
    (found,) = places("--profile", [where], ("y", "x")).items()
    return found


def _export_profile(data: xr.Dataset, where: tuple[str, str], path: str) -> None:
    """Write the fields along the line of nodes nearest to a place."""
    source, fields = sources(data)[0], _fields(data)
    name, axis = where[0], "yx".index(where[0])
    place, edge = length(f"--profile {name}", where[1], is_si(data)), source.grid.length[axis]
    if not 0 <= place <= edge:
        raise ValueError(
            f"--profile {name} = {source.told(place)}: a position from 0 to {source.told(edge)} is needed"
        )
    node = round(place / source.grid.spacing[axis]) % source.grid.shape[axis]
    line, part = slice(node, node + 1), source.window()
    if name == "y":
        part = replace(part, rows=line, y=part.y[line])
    else:
        part = replace(part, columns=line, x=part.x[line])
    count = write_surface_table(data, path, fields, part)
    exact = source.told(float(node * source.grid.spacing[axis]))
    print(f"{path}: {', '.join(named(fields, export_units(data)))} at {count} nodes of {name} = {exact}")


def _export_box(
    contact: xr.Dataset, names: list[str], depths: str, path: str, options: argparse.Namespace
) -> None:
    si = is_si(contact)
    source = sources(contact)[0]
    solid = source.pressed(options.body)
    given = sliding(options)
    traction = source.sliding_of(options.body, given.get("friction"), given.get("sliding_direction"))
    checked_sliding(traction["friction"], traction["sliding_direction"], solid.layer)
    poisson = section(options, "layer").get("poisson")
    checked_ratios(poisson, solid.layer)
    box = make_box(
        solid.grid,
        span("--field", depths, si),
        **{name: span(f"--{name}", text, si) for name in "yx" if (text := getattr(options, name))},
        spacing=length("--spacing", options.spacing, si) if options.spacing else None,
        told=source.told,
    )
    height = solid.layer.height
    if height is not None and box.depths[-1] > height * (1 + 1e-9):
        raise ValueError(
            f"--field {shown(depths)}: depths to at most {source.told(height)}, the height of the layer, "
            "are needed"
        )
    require_space(Path(path).absolute().parent, 4e-6 * len(names) * math.prod(box.shape))
    units = export_units(contact)
    compile_visibly("planes", partial(planes_small, solid, names, poisson))
    with ProgressBar("export") as progress:
        size = write_box(solid, path, box, names, poisson, units, progress, **traction)
    print(
        f"{path}: {', '.join(names)} in {units.stress_name.replace('_', ' ')} on "
        f"{' × '.join(map(str, reversed(box.shape)))} nodes along x, y, z, in "
        f"{'µm' if si else 'cell lengths'}, {size / 1e6:.3g} MB"
    )
