"""``asperity export``: peaks as a table, and fields of the stress for ParaView and other programs."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import xarray as xr

from asperity.cli.files import check_out, read_result, required
from asperity.cli.parser import section, sliding
from asperity.cli.positions import is_si, length, positions, span
from asperity.core.errors import one_line, shown
from asperity.results.tables import SUFFIXES
from asperity.results.variables import SI_UNITS
from asperity.stress.planes.fields import FIELDS
from asperity.study.runtime.preflight import require_space
from asperity.study.runtime.progress import ProgressBar
from asperity.views.export import (
    box_below,
    export_units,
    surface_fields,
    write_box,
    write_peaks,
    write_surface_image,
    write_surface_table,
)
from asperity.views.source import Source, sources


def run(options: argparse.Namespace) -> None:
    """Write the files that are asked for, and print what each holds."""
    boxes = [(*_box_chosen(text), path) for text, path in options.field or ()]
    profiles = [(*_line_chosen(text), path) for text, path in options.profile or ()]
    suffixes = {
        **{path: (".vti",) for *_, path in boxes},
        **{path: (".csv",) for *_, path in profiles},
        **{path: SUFFIXES for path in [options.peaks] if path},
        **dict.fromkeys(options.surface or (), (".vti", ".csv")),
    }
    if not suffixes:
        raise ValueError(
            "nothing to export: --peaks FILE.csv, --surface FILE.vti, --profile y=PLACE FILE.csv or "
            "--field NAMES:DEPTHS FILE.vti is needed"
        )
    check_out(list(suffixes), options.results)
    for path, accepted in suffixes.items():
        if Path(path).suffix not in accepted:
            raise ValueError(f"{path}: a name that ends in {' or '.join(accepted)} is needed")
    given: dict[str, xr.Dataset] = {}
    for path in options.results:
        stage, data = read_result(path, ("surface", "contact", "stress"))
        if stage in given:
            raise ValueError(f"{path}: a second result of {stage}, one is needed")
        given[stage] = data
    if options.peaks:
        count = write_peaks(required(given, "stress", "--peaks"), options.peaks)
        print(f"{one_line(options.peaks)}: {count} peaks")
    if options.surface or profiles:
        stage = "contact" if "contact" in given else "surface"
        data = required(given, stage, "--surface, --profile")
        source = sources(data)[0]
        for path in options.surface or ():
            _export_surface(source, path, options)
        for axis, text, path in profiles:
            _export_profile(source, axis, text, path)
    for names, depths, path in boxes:
        _export_box(required(given, "contact", "--field"), names, depths, path, options)


def _box_chosen(text: str) -> tuple[list[str], str]:
    """Names of fields and range of depth, from text such as ``von_mises,xx:0-40um``."""
    names, _, depths = text.partition(":")
    if not depths:
        raise ValueError(f"--field {shown(text)}: NAMES:DEPTHS, such as von_mises,xx:0-40um, is needed")
    listed = names.split(",")
    for name in listed:
        if name not in FIELDS or listed.count(name) > 1:
            raise ValueError(f"--field {shown(name)}: each once of {', '.join(FIELDS)} is needed")
    return listed, depths


def _line_chosen(text: str) -> tuple[str, str]:
    """Axis and position of a profile, from text such as ``y=205um``."""
    (found,) = positions("--profile", [text], ("y", "x")).items()
    return found


def _spans(options: argparse.Namespace, si: bool) -> dict[str, tuple[float, float]]:
    """Parts of the cell along y and x that are given."""
    texts = {"y": options.y, "x": options.x}
    return {name: span(f"--{name}", text, si) for name, text in texts.items() if text}


def _export_surface(source: Source, path: str, options: argparse.Namespace) -> None:
    fields = surface_fields(source, source.part(**_spans(options, source.system == SI_UNITS)))
    image = Path(path).suffix == ".vti"
    nodes = math.prod(fields.sizes.values()) * len(fields)
    require_space(Path(path).absolute().parent, 1e-6 * nodes * (4 if image else 16))
    write = write_surface_image if image else write_surface_table
    write(path, fields)
    ny, nx = fields.sizes.values()
    print(f"{one_line(path)}: {', '.join(map(str, fields))} at {nx} × {ny} nodes along x, y")


def _export_profile(source: Source, axis: str, text: str, path: str) -> None:
    """Write the fields along the line of nodes nearest to a position."""
    node = source.node(axis, length(f"--profile {axis}", text, source.system == SI_UNITS))
    rows, columns = source.part()
    line = slice(node, node + 1)
    fields = surface_fields(source, (line, columns) if axis == "y" else (rows, line))
    count = write_surface_table(path, fields)
    exact = source.shown(float(node * source.grid.spacing["yx".index(axis)]))
    print(f"{one_line(path)}: {', '.join(map(str, fields))} at {count} nodes of {axis} = {exact}")


def _export_box(
    contact: xr.Dataset, names: list[str], depths: str, path: str, options: argparse.Namespace
) -> None:
    si = is_si(contact)
    source = sources(contact)[0]
    part = _spans(options, si)
    box = box_below(
        source,
        names,
        span("--field", depths, si),
        part.get("y"),
        part.get("x"),
        spacing=length("--spacing", options.spacing, si) if options.spacing else None,
        poisson=section(options, "layer").get("poisson"),
        body=options.body,
        **sliding(options),
    )
    shape = box.x.size, box.y.size, box.depth.size
    require_space(Path(path).absolute().parent, 4e-6 * len(names) * math.prod(shape))
    units = export_units(source.system)
    with ProgressBar("export") as progress:
        size = write_box(box, path, units, progress)
    print(
        f"{one_line(path)}: {', '.join(names)} in {units.stress_name.replace('_', ' ')} on "
        f"{' × '.join(map(str, shape))} nodes along x, y, z, in "
        f"{'µm' if si else 'cell lengths'}, {size / 1e6:.3g} MB"
    )
