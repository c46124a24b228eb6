"""``asperity export``: peaks as a table, and fields of the stress for ParaView and other programs."""

import argparse
import math
from pathlib import Path
from typing import Any

from asperity.cli.files import check_out, is_si, length, positions, read_results, required, span
from asperity.cli.parser import section
from asperity.core.errors import one_line, shown
from asperity.results.tables import write_table
from asperity.stress.planes.fields import FIELDS
from asperity.study.preflight_and_manifest import require_space
from asperity.study.progress_and_log import ProgressBar
from asperity.views.export import (
    ExportUnits,
    box_below,
    peak_table,
    surface_fields,
    write_box,
    write_surface_image,
    write_surface_table,
)
from asperity.views.source import Part, Source, Span, sources

FORMATS = {"peaks": (".csv",), "surface": (".vti", ".csv"), "profile": (".csv",), "field": (".vti",)}
"""Option → suffixes of its files."""


def run(options: argparse.Namespace) -> None:
    """Write the requested files, and print a summary of each."""
    wanted = {option: getattr(options, option) or [] for option in FORMATS}
    if not any(wanted.values()):
        raise ValueError(
            "nothing to export: --peaks FILE.csv, --surface FILE.vti, --profile y=PLACE FILE.csv or "
            "--field NAMES:DEPTHS FILE.vti is needed"
        )
    boxes = []
    for text, _ in wanted["field"]:  # such as von_mises,xx:0-40um
        listed, _, depths = text.partition(":")
        if not depths:
            raise ValueError(f"--field {shown(text)}: NAMES:DEPTHS, such as von_mises,xx:0-40um, is needed")
        names = listed.split(",")
        for name in names:
            if name not in FIELDS or names.count(name) > 1:
                raise ValueError(f"--field {shown(name)}: each once of {', '.join(FIELDS)} is needed")
        boxes.append((names, depths))
    lines = [next(iter(positions("--profile", [text], ("y", "x")).items())) for text, _ in wanted["profile"]]
    files = [(option, words[-1]) for option, given in wanted.items() for words in given]
    check_out([(f"--{option}", path) for option, path in files], options.results)
    for option, path in files:
        if Path(path).suffix not in FORMATS[option]:
            raise ValueError(f"{path}: a name that ends in {' or '.join(FORMATS[option])} is needed")
    results: dict[str, Any] = {}
    for path in options.results:
        for stage, data in read_results(path, ("surface", "contact", "stress")).items():
            if stage in results:
                raise ValueError(f"{path}: a second result of {stage}, one is needed")
            results[stage] = data
    for (path,) in wanted["peaks"]:
        table = peak_table(required(results, "stress", "--peaks"))
        write_table(table, "export_peaks", path, float_format="%.7g")
        print(f"{one_line(path)}: {len(table)} peaks")
    if wanted["surface"] or lines:
        stage = "contact" if "contact" in results else "surface"
        data = required(results, stage, "--surface, --profile")
        (source,), parts = sources(data), _parts(options, is_si(data))
        for (path,) in wanted["surface"]:
            fields, shape = _export_surface(source, source.part(**parts), path)
            print(f"{one_line(path)}: {fields} at {shape[1]} × {shape[0]} nodes along x, y")
        for (axis, text), (_, path) in zip(lines, wanted["profile"], strict=True):
            node = source.node(axis, length(f"--profile {axis}", text, is_si(data)))
            rows, columns = source.part()
            line = slice(node, node + 1)
            fields, shape = _export_surface(source, (line, columns) if axis == "y" else (rows, line), path)
            exact = source.shown(float(node * source.grid.spacing["yx".index(axis)]))
            print(f"{one_line(path)}: {fields} at {math.prod(shape)} nodes of {axis} = {exact}")
    for (names, depths), (_, path) in zip(boxes, wanted["field"], strict=True):
        _export_box(required(results, "contact", "--field"), names, depths, path, options)


def _parts(options: argparse.Namespace, si: bool) -> dict[str, Span]:
    """Given parts of the cell along y and x."""
    texts = {"y": options.y, "x": options.x}
    return {name: span(f"--{name}", text, si) for name, text in texts.items() if text}


def _export_surface(source: Source, part: Part, path: str) -> tuple[str, list[int]]:
    """Write the fields over a part of the surface; return their names and the node counts along y and x."""
    fields = surface_fields(source, part)
    shape, image = [*fields.sizes.values()], Path(path).suffix == ".vti"
    require_space(Path(path).absolute().parent, 1e-6 * math.prod(shape) * len(fields) * (4 if image else 16))
    (write_surface_image if image else write_surface_table)(path, fields)
    return ", ".join(map(str, fields)), shape


def _export_box(contact: Any, names: list[str], depths: str, path: str, options: argparse.Namespace) -> None:
    si = is_si(contact)
    (source,) = sources(contact)
    box = box_below(
        source,
        names,
        span("--field", depths, si),
        **_parts(options, si),
        spacing=length("--spacing", options.spacing, si) if options.spacing else None,
        poisson=section(options, "layer").get("poisson"),
        body=options.body,
        **section(options, "sliding"),
    )
    shape = box.x.size, box.y.size, box.depth.size
    require_space(Path(path).absolute().parent, 4e-6 * len(names) * math.prod(shape))
    units = ExportUnits.of(source.system)
    with ProgressBar("export") as progress:
        size = write_box(box, path, units, progress)
    print(
        f"{one_line(path)}: {', '.join(names)} in {units.stress_name.replace('_', ' ')} on "
        f"{' × '.join(map(str, shape))} nodes along x, y, z, in "
        f"{'µm' if si else 'cell lengths'}, {size / 1e6:.3g} MB"
    )
