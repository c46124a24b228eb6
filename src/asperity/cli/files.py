"""Result files that the commands read and write."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from asperity.results import dataset
from asperity.results.dataset import settings_of, stage_of
from asperity.study.config.reader import is_file


def read_stage(path: str | Path, stage: str) -> xr.Dataset:
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
    if "map" in settings_of(data):
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
