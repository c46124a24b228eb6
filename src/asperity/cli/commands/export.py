"""``asperity export``: peaks as a table, and fields of the stress for ParaView and other programs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from asperity.cli.arguments import section
from asperity.cli.files import check_out, stage_of
from asperity.cli.places import is_si, length, span
from asperity.errors import shown
from asperity.results import dataset
from asperity.results.export import export_units, make_box, write_box, write_peaks
from asperity.results.tables import SUFFIXES
from asperity.runtime.preflight import require_space
from asperity.runtime.progress import ProgressBar
from asperity.stress.arguments import FIELDS, checked_ratios
from asperity.views.source import sources

_MAKERS = {"contact": "asperity solve", "stress": "asperity stress"}


def run(options: argparse.Namespace) -> None:
    """Write the files that are asked for, and print what each holds."""
    fields = [(*_chosen(what), path) for what, path in options.field or ()]
    outs = [path for path in (options.peaks, *(path for *_, path in fields)) if path]
    if not outs:
        raise ValueError("nothing to export: --peaks FILE.csv or --field NAMES:DEPTHS FILE.vti is needed")
    check_out(outs, options.results)
    for path in outs:
        accepted = SUFFIXES if path == options.peaks else (".vti",)
        if Path(path).suffix not in accepted:
            raise ValueError(f"{path}: a name that ends in {' or '.join(accepted)} is needed")
    given = _by_stage(options.results)
    if options.peaks:
        count = write_peaks(_needed(given, "stress", "--peaks"), options.peaks)
        print(f"{options.peaks}: {count} peaks")
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
            raise ValueError(f"{path}: a result of {stage or 'no stage'}, one of contact or stress is needed")
        if stage in found:
            raise ValueError(f"{path}: a second result of {stage}, one is needed")
        found[stage] = data
    return found


def _needed(given: Mapping[str, xr.Dataset], stage: str, option: str) -> xr.Dataset:
    if stage not in given:
        raise ValueError(f"{option}: a {stage} file (of {_MAKERS[stage]}) is needed, none is given")
    return given[stage]


def _export_box(
    contact: xr.Dataset, names: list[str], depths: str, path: str, options: argparse.Namespace
) -> None:
    si = is_si(contact)
    source = sources(contact)[0]
    solid = source.pressed()
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
    with ProgressBar("export") as progress:
        size = write_box(solid, path, box, names, poisson, units, progress)
    print(
        f"{path}: {', '.join(names)} in {units.stress_name.replace('_', ' ')} on "
        f"{' × '.join(map(str, reversed(box.shape)))} nodes along x, y, z, in "
        f"{'µm' if si else 'cell lengths'}, {size / 1e6:.3g} MB"
    )
