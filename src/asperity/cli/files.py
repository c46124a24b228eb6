"""Result files that the commands read and write."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.results import dataset
from asperity.study.config.reader import is_file

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
        with xr.open_dataset(path, engine="netcdf4") as opened:
            return "settings" in opened.attrs
    except (OSError, RuntimeError, ValueError):
        return False


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
