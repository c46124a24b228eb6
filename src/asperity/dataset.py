"""How result files are written and read.

The names, units and descriptions of their variables are those of `asperity.vocabulary`. A file is NetCDF-4
with CF attributes, checksummed, and written whole or not at all; global attributes rebuild it. No
wall-clock time is inside: the same configuration on the same machine gives the same numbers.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

import asperity
from asperity.spectral import Grid
from asperity.vocabulary import VOCABULARY

CONVENTIONS = "CF-1.11"
PAPER = (
    "Y. Murugesan, S. P. Venugopalan, L. Nicola: "
    "On sub-surface stress caused by contact roughness in compressible elastic solids"
)


class DatasetError(RuntimeError):
    """A result file that cannot be taken for one; the message names the file and the remedy."""


def digest(settings: Any) -> str:
    """Short fingerprint of a configuration, independent of the order of its keys."""
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:16]


def write(dataset: xr.Dataset, path: str | os.PathLike[str], title: str, settings: Mapping[str, Any]) -> None:
    """Write a result file, whole or not at all.

    Parameters
    ----------
    dataset : xarray.Dataset
        Variables of the vocabulary; their units and long names are attached here. Its own global
        attributes (what was decided or reached on the way) are kept.
    path : path
    title : str
        What the file holds, for a stranger.
    settings : mapping
        All that rebuilds the file, as a tree of plain values; stored as JSON, with its fingerprint.

    Raises
    ------
    KeyError
        If a variable is not in the vocabulary.
    """
    path = Path(path)
    described = dataset.copy()
    for name in described.variables:
        variable = VOCABULARY.get(str(name))
        if variable is None:
            raise KeyError(f"variable {name!r} of {path.name} is not in asperity.dataset.VOCABULARY")
        described[name].attrs.update(variable._asdict())
    described.attrs = {
        "Conventions": CONVENTIONS,
        "title": title,
        "source": f"asperity {asperity.__version__}",
        "references": PAPER,
        "settings": json.dumps(settings, sort_keys=True),
        "settings_digest": digest(settings),
        **dataset.attrs,
    }
    encoding = {
        str(name): {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True}
        for name, variable in described.variables.items()
        if variable.ndim and variable.dtype.kind in "fiu"
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    try:
        described.to_netcdf(unfinished, format="NETCDF4", engine="netcdf4", encoding=encoding)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def settings_of(dataset: xr.Dataset) -> dict[str, Any]:
    """The settings a file was made from, to hand on to what is made from it."""
    return json.loads(dataset.attrs["settings"])


def grid_of(dataset: xr.Dataset) -> Grid:
    """The grid of a result with coordinates y and x; its longer edge is one."""
    shape = dataset.sizes["y"], dataset.sizes["x"]
    steps = [float(dataset[axis][1]) if dataset.sizes[axis] > 1 else 1.0 for axis in ("y", "x")]
    return Grid(shape, (shape[0] * steps[0], shape[1] * steps[1]))


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a result file whole, checking it against the vocabulary and its checksums.

    Raises
    ------
    DatasetError
        If the file is missing, damaged, or not one of this vocabulary.
    """
    path = Path(path)
    remedy = "delete it and run again"
    if not path.is_file():
        raise DatasetError(f"{path}: no such file")
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            dataset = opened.load()
    except (OSError, RuntimeError, ValueError) as error:
        raise DatasetError(f"{path}: damaged or not NetCDF-4 ({error}); {remedy}") from error
    for name, variable in dataset.variables.items():
        expected = VOCABULARY.get(str(name))
        if expected is None:
            raise DatasetError(f"{path}: unknown variable {name!r}; {remedy}")
        if variable.attrs.get("units") != expected.units:
            raise DatasetError(
                f"{path}: {name} is in {variable.attrs.get('units')!r}, {expected.units!r} expected; {remedy}"
            )
    return dataset
