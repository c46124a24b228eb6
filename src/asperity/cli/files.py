"""Result files that the commands read and write."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.config.reader import is_file
from asperity.results import dataset
from asperity.results.systems import in_cell_lengths
from asperity.results.variables import STUDY_UNITS

_MARKS = {"surface": "spectrum", "contact": "pressure", "stress": "peak_value", "statistics": "peak_density"}
"""Stage → a variable that only its results have."""


def read_result(path: str | Path, stage: str) -> xr.Dataset:
    """Read a result file of one stage.

    Raises
    ------
    ValueError
        If it is a result of another stage, or of ``asperity run``.
    DatasetError
        If it is missing or damaged.
    """
    data = dataset.read(path)
    if (found := stage_of(data)) != stage:
        raise ValueError(f"{path}: a result of {found or 'no stage'}, one of {stage} is needed")
    if "map" in dataset.settings_of(data):
        raise ValueError(
            f"{path}: a result of asperity run, which makes those of all stages itself; one of asperity "
            "surface, solve or stress is needed"
        )
    return data


def read_in_cell_lengths(path: str | Path, stage: str) -> tuple[xr.Dataset, dict[str, Any]]:
    """A result file of one stage and its settings in units of the study; raises as `read_result`."""
    data = read_result(path, stage)
    return in_cell_lengths(data, dataset.settings_of(data))


def read_dimensionless(path: str | Path) -> xr.Dataset:
    """Read a result file of any stage in units of the cell length and the effective modulus.

    Raises
    ------
    ValueError
        If it is in SI units, as results of ``asperity run`` are.
    DatasetError
        If it is missing or damaged.
    """
    data = dataset.read(path)
    if (system := dataset.unit_system(data)) != STUDY_UNITS:
        raise ValueError(f"{path}: in {system} units; a result in cell lengths, as of the study, is needed")
    return data


def stage_of(data: xr.Dataset) -> str | None:
    """Stage that a result is of, None for other datasets."""
    return next((stage for stage, mark in _MARKS.items() if mark in data), None)


def is_result(path: str | Path) -> bool:
    """True for a result of this package, False for a height map in another format."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            return "settings" in opened.attrs
    except (OSError, RuntimeError, ValueError):
        return False


def write_result(result: xr.Dataset, path: str, title: str, settings: dict[str, Any]) -> None:
    """Write a result file; its title ends with the name of the surface."""
    dataset.write(result, path, title=f"{title} {settings['name']}", settings=settings)


def check_out(outs: Iterable[str], inputs: Iterable[str] = ()) -> None:
    """Raise `ValueError` if a file to write is a folder, or one of the files that are read.

    Commands call it before they compute anything.
    """
    read = [Path(path) for path in inputs if is_file(path)]
    for out in map(Path, outs):
        if out.is_dir():
            raise ValueError(f"--out {out}: a folder, the name of a file is needed")
        if is_file(out) and any(out.samefile(path) for path in read):
            raise ValueError(f"--out {out}: is read too, another name is needed")
