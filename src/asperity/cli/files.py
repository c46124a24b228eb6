"""Result files that the commands read and write."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import xarray as xr

from asperity.results import dataset
from asperity.results.atomic import write_problem

OWN_BEGIN = {
    ".csv": rb"quantity,|[yx]_(um|cell_length),",
    ".vti": rb'<\?xml version="1.0" encoding="UTF-8"\?><VTKFile type="ImageData"',
    ".parquet": rb"PAR1",
    ".png": rb"\x89PNG.{20}\x08\x06",  # eight bits of four colours, which no map has
    ".pdf": rb"%PDF",
    ".svg": rb"<\?xml",
}
"""End of a name → begin of the files of this name that the commands write."""

MAKERS = {
    "surface": "asperity surface",
    "contact": "asperity solve",
    "stress": "asperity stress",
    "statistics": "asperity peaks",
}
"""Stage → command that makes its results."""


def read_result(path: str | Path, stages: Collection[str]) -> tuple[str, xr.Dataset]:
    """Stage and content of a result file, which has to be of one of some stages.

    Raises
    ------
    ValueError
        If it is a result of another stage.
    DatasetError
        If it is missing or damaged.
    """
    data = dataset.read(path)
    stage = dataset.stage_of(data)
    if stage is None or stage not in stages:
        known = " or ".join(stages)
        raise ValueError(f"{path}: a result of {stage or 'no stage'}, one of {known} is needed")
    return stage, data


def required(given: Mapping[str, Any], stage: str, what: str) -> Any:
    """The result of a stage, which an option or a figure needs; `ValueError` if none is given."""
    if stage not in given:
        maker = f" (of {MAKERS[stage]})" if stage in MAKERS else ""
        raise ValueError(f"{what}: a {stage} file{maker} is needed, none is given")
    return given[stage]


def read_stage(path: str | Path, stage: str) -> xr.Dataset:
    """Read a result file of one stage.

    Raises
    ------
    ValueError
        If it is a result of another stage, or of ``asperity run``.
    DatasetError
        If it is missing or damaged.
    """
    _, data = read_result(path, [stage])
    if "map" in dataset.settings_of(data):
        raise ValueError(
            f"{path}: a result of asperity run, which makes those of all stages itself; one of asperity "
            "surface, solve or stress is needed"
        )
    return data


def is_result(path: str | Path) -> bool:
    """True for a result of this package, False for a height map in another format."""
    try:
        with netCDF4.Dataset(path) as opened:
            return "settings" in opened.ncattrs()
    except (OSError, RuntimeError, ValueError):
        return False


def check_out(outs: Iterable[tuple[str, str]], inputs: Iterable[str] = ()) -> None:
    """Raise `ValueError` for the first file that cannot be written, or would destroy another one.

    Commands call it before they compute anything.

    Parameters
    ----------
    outs : iterable of (option, path)
        Files to write.
    inputs : iterable of str
        Files that are read.
    """
    read, written = [Path(path) for path in inputs if os.path.isfile(path)], set()
    for option, out in outs:
        if not out:
            raise ValueError(f"{option} = '': the name of a file is needed")
        if problem := write_problem(out):
            raise ValueError(f"{option} {out}: {problem}")
        path = Path(os.path.realpath(out))
        if path in written:
            raise ValueError(f"{option} {out}: named twice, each file needs its own name")
        written.add(path)
        if os.path.isfile(path):
            if any(path.samefile(each) for each in read):
                raise ValueError(f"{option} {out}: is read too, another name is needed")
            with open(path, "rb") as file:
                begin = file.read(100)
            own = OWN_BEGIN.get(path.suffix)
            # An empty file may be replaced, and one that a command has written under this name.
            if begin and not (is_result(path) if own is None else re.match(own, begin, re.DOTALL)):
                raise ValueError(
                    f"{option} {out}: asperity has not written this file; another name is needed"
                )
