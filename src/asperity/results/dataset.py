"""How result files are written and read.

The names, units and descriptions of their variables are those of `asperity.results.variables`. A file is NetCDF-4
with CF attributes, written whole or not at all, and carries a fingerprint of all that is in it; global
attributes rebuild it. No wall-clock time is inside: the same configuration on the same machine gives the
same numbers.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import asperity
from asperity.errors import DatasetError
from asperity.results.variables import VOCABULARY
from asperity.spectral import Grid

CONVENTIONS = "CF-1.11"
PAPER = (
    "Y. Murugesan, S. P. Venugopalan, L. Nicola: "
    "On sub-surface stress caused by contact roughness in compressible elastic solids"
)


FINGERPRINT = "content_digest"
"""Attribute that holds the fingerprint of a file's content."""

_REMEDY = "delete it and run again"
_BLOCK = 2**26
_SPARE = 2**20


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
    DatasetError
        If the file cannot be written; what was there before is still there.
    """
    path = Path(path)
    described = dataset.copy()
    for name in described.variables:
        variable = VOCABULARY.get(str(name))
        if variable is None:
            raise KeyError(f"variable {name!r} of {path.name} is not in asperity.results.dataset.VOCABULARY")
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
    described.attrs[FINGERPRINT] = fingerprint(described)
    with whole(path) as unfinished:
        described.to_netcdf(unfinished, format="NETCDF4", engine="netcdf4", encoding=encoding)


@contextmanager
def whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A file to write that takes its name when the block ends well, and is removed when it does not.

    What a killed process left of the same file is removed too.

    Raises
    ------
    DatasetError
        If it cannot be written; the message names the file and the remedy.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _sweep(path)
        yield unfinished
        os.replace(unfinished, path)
    except (OSError, RuntimeError) as error:
        raise DatasetError(f"{path}: cannot be written ({_reason(error, path)} and run again") from error
    finally:
        with suppress(OSError):
            unfinished.unlink()


def _sweep(path: Path) -> None:
    """Remove unfinished files of `path` whose processes are gone."""
    pattern = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.unfinished")
    for left in path.parent.iterdir():
        found = pattern.fullmatch(left.name)
        if found and not _alive(int(found[1])):
            left.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _reason(error: Exception, path: Path) -> str:
    """Why a file cannot be written, and what helps; the NetCDF library does not say that a disk is full."""
    existing = next(folder for folder in path.absolute().parents if folder.is_dir())
    if getattr(error, "errno", None) == errno.ENOSPC or shutil.disk_usage(existing).free < _SPARE:
        return "the disk is full); free some space"
    return f"{getattr(error, 'strerror', None) or error}); make its folder writable"


def settings_of(dataset: xr.Dataset) -> dict[str, Any]:
    """The settings a file was made from, to hand on to what is made from it."""
    return json.loads(dataset.attrs["settings"])


def grid_of(dataset: xr.Dataset) -> Grid:
    """The grid of a result with coordinates y and x; its longer edge is one."""
    shape = dataset.sizes["y"], dataset.sizes["x"]
    steps = [float(dataset[axis][1]) if dataset.sizes[axis] > 1 else 1.0 for axis in ("y", "x")]
    return Grid(shape, (shape[0] * steps[0], shape[1] * steps[1]))


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a result file whole, checking it against the vocabulary and its fingerprint.

    Raises
    ------
    DatasetError
        If the file is missing, damaged, changed by hand, or not one of this vocabulary.
    """
    with _opened(path) as opened:
        dataset = opened.load()
    _check(dataset, path)
    return dataset


def verify(path: str | os.PathLike[str]) -> None:
    """Check a result file as `read` does, in little memory.

    Raises
    ------
    DatasetError
        As of `read`.
    """
    with _opened(path) as opened:
        _check(opened, path)


@contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[xr.Dataset]:
    """A result file, its values not read yet; what fails in the block is told as damage."""
    if not Path(path).is_file():
        raise DatasetError(f"{path}: no such file")
    try:
        with xr.open_dataset(path, engine="netcdf4", cache=False) as opened:
            yield opened
    except DatasetError:
        raise
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError) as error:
        raise DatasetError(f"{path}: damaged or not NetCDF-4 ({error}); {_REMEDY}") from error


def _check(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    for name, variable in dataset.variables.items():
        expected = VOCABULARY.get(str(name))
        if expected is None:
            raise DatasetError(f"{path}: unknown variable {name!r}; {_REMEDY}")
        if (units := variable.attrs.get("units")) != expected.units:
            raise DatasetError(f"{path}: {name} is in {units!r}, {expected.units!r} expected; {_REMEDY}")
    if dataset.attrs.get(FINGERPRINT) != fingerprint(dataset):
        raise DatasetError(f"{path}: changed since it was written, or by another version; {_REMEDY}")


def fingerprint(dataset: xr.Dataset) -> str:
    """Fingerprint of all names, attributes and values of a dataset, its fingerprint excepted."""
    found = hashlib.blake2b(digest_size=16)
    attributes = {name: value for name, value in dataset.attrs.items() if name != FINGERPRINT}
    found.update(_plain(attributes))
    for name in sorted(dataset.variables, key=str):
        variable = dataset.variables[name]
        found.update(_plain({"name": name, "dims": variable.dims, "shape": variable.shape}))
        found.update(_plain(variable.attrs))
        for block in _blocks(variable):
            found.update(_bytes(block))
    return found.hexdigest()


def _plain(attributes: Mapping[Any, Any]) -> bytes:
    """Attributes as text; a list of one is what NetCDF gives back as its item."""
    values = {str(name): np.atleast_1d(np.asarray(value)).tolist() for name, value in attributes.items()}
    return json.dumps(values, sort_keys=True).encode()


def _blocks(variable: xr.Variable) -> Iterator[Any]:
    """The values, some rows at a time."""
    if not variable.ndim or variable.nbytes <= _BLOCK:
        yield variable.values
        return
    rows = max(1, _BLOCK * variable.shape[0] // variable.nbytes)
    for begin in range(0, variable.shape[0], rows):
        yield variable[begin : begin + rows].values


def _bytes(values: Any) -> Any:
    values = np.asarray(values)
    if values.dtype.kind in "fiub":
        return np.ascontiguousarray(values).data
    return json.dumps(values.astype(str).tolist()).encode()
