"""Reading and writing of result files.

A file is NetCDF-4 with CF attributes; names, units and descriptions of its variables come from
`asperity.results.variables`, in the system of units that the global attribute ``unit_system`` names. It is
written atomically, and carries a fingerprint of all that is in it and the settings from which it can be made
again. It holds no wall-clock time: the same configuration gives the same numbers on the same machine.
"""

import hashlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.errors import DatasetError, shown
from asperity.core.system import is_locked
from asperity.core.version import __version__
from asperity.fourier import current_engine
from asperity.fourier.grid import grid_of as grid_of
from asperity.results.atomic import atomic_write
from asperity.results.variables import ORIENTATION, STAGES, STUDY_UNITS, UNIT_SYSTEMS, VARIABLES, units_of

CONVENTIONS = "CF-1.11"

UNIT_SYSTEM = "unit_system"
"""Attribute that names the system of units of a file; a file without it is in units of the study."""

FINGERPRINT = "content_digest"
"""Attribute that holds the fingerprint of a file's content."""

FORMAT = "format_version"
"""Attribute that holds the version of the file format; a file without it has version 1."""

FORMAT_VERSION = 1
"""Version that is written, and the newest that is read; it rises if an older asperity would misread files."""

FFT_ENGINE = "fft_engine"
"""Attribute that holds the library of the Fourier transforms, its version and plans."""

_DENSE = ("height", "displacement", "gap")
"""Uncompressed fields: compression would save a sixth of the file and take most of the writing time."""


def digest(settings: Any) -> str:
    """Short fingerprint of a tree of plain values, independent of the order of its keys."""
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:16]


def write(
    dataset: xr.Dataset,
    path: str | os.PathLike[str],
    title: str,
    settings: Mapping[str, Any] | None = None,
) -> None:
    """Write a result file atomically, which `read_result` reads.

    Parameters
    ----------
    dataset : xarray.Dataset
        With variables of `VARIABLES`; their units and descriptions are added here. Its own global attributes
        are kept, except for those that follow from the arguments and its variables; ``unit_system`` is one of
        `UNIT_SYSTEMS`, by default the study's.
    path : path
    title : str
        Content of the file in one line.
    settings : mapping, optional
        Settings from which the file can be made again, a tree of plain values; stored as JSON, with its
        fingerprint. By default the settings of the dataset.

    Raises
    ------
    KeyError
        If a variable is not in `VARIABLES`.
    ValueError
        If the system of units is not in `UNIT_SYSTEMS`.
    DatasetError
        If the file cannot be written; an earlier file of the same name is still there then.

    Examples
    --------
    >>> import tempfile
    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 2e-4, mean_pressure=20e6)
    >>> stress = asp.analyse_stress(contact).assign_attrs(unit_system="SI")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     asp.write_result(stress, f"{folder}/stress.nc", "Stress under a rough surface")
    ...     found = asp.read_result(f"{folder}/stress.nc")
    >>> found["peak_value"].attrs["units"], int(found.attrs["format_version"]) >= 1
    ('Pa', True)
    """
    path = Path(path)
    system = unit_system(dataset)
    if system not in UNIT_SYSTEMS:
        raise ValueError(f"{UNIT_SYSTEM} = {system!r}: one of {', '.join(UNIT_SYSTEMS)} is needed")
    described = dataset.copy()
    for name in described.variables:
        if name not in VARIABLES:
            raise KeyError(f"variable {name!r} of {path.name} is not in asperity.results.variables.VARIABLES")
        described[name].attrs.update(_attributes(str(name), described[name].dtype, system))
    stage = stage_of(dataset)
    if settings is None:
        settings = settings_of(dataset) if "settings" in dataset.attrs else {}
    made = {
        "Conventions": CONVENTIONS,
        "title": title,
        **({"summary": STAGES[stage].summary} if stage else {}),
        FORMAT: FORMAT_VERSION,
        UNIT_SYSTEM: system,
        "comment": UNIT_SYSTEMS[system],
        "settings": json.dumps(settings, sort_keys=True),
        "settings_digest": digest(settings),
    }
    kept = {"source": f"asperity {__version__}", FFT_ENGINE: current_engine().description}
    described.attrs = made | kept | dataset.attrs | made
    described.attrs[FINGERPRINT] = fingerprint(described)
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in described.variables.items():
        if variable.ndim:
            packed = {} if name in _DENSE else {"zlib": True, "complevel": 1, "shuffle": True}
            fixed_width = {} if variable.dtype.kind in "fiub" else {"dtype": "S1"}  # texts
            encoding[str(name)] = {"fletcher32": True, **packed, **fixed_width}
    with atomic_write(path) as unfinished:
        described.to_netcdf(unfinished, format="NETCDF4", engine="netcdf4", encoding=encoding)


def _attributes(name: str, dtype: np.dtype[Any], system: str) -> dict[str, str]:
    """CF attributes of a variable; only numbers have units."""
    units = units_of(name, system) if dtype.kind in "fiu" else ""
    variable = VARIABLES[name]
    attributes = {"units": units, "long_name": variable.long_name, "comment": variable.comment}
    if name == "height":
        attributes["orientation"] = ORIENTATION
    return {key: value for key, value in attributes.items() if value}


def height_of(contact: xr.Dataset) -> xr.DataArray:
    """Height of the indenter [y, x] of a stored contact, before it was flattened."""
    height = contact["gap"] - contact["displacement"] + contact["approach"]
    return height - contact["plastic_depth"] if "plastic_depth" in contact else height


def settings_of(dataset: xr.Dataset) -> dict[str, Any]:
    """The settings from which a result was made."""
    return json.loads(dataset.attrs["settings"])


def stage_of(dataset: xr.Dataset) -> str | None:
    """Stage that made a dataset: surface, contact, stress, statistics, or None."""
    return next((name for name, stage in STAGES.items() if stage.variable in dataset), None)


def unit_system(dataset: xr.Dataset) -> str:
    """System of units of a dataset: its attribute ``unit_system``, by default the study's."""
    return str(dataset.attrs.get(UNIT_SYSTEM, STUDY_UNITS))


MAX_MEMORY = "ASPERITY_MAX_MEMORY"
"""Environment variable with the largest size, in GiB, to which a result may unpack."""

DEFAULT_MAX_MEMORY = 16.0
"""Default of this size: ten times a contact of 8192² nodes."""


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a result file into memory, after checking its names, units and fingerprint.

    Parameters
    ----------
    path : path

    Returns
    -------
    Dataset
        With `units` and `long_name` of every variable.

    Raises
    ------
    DatasetError
        If the file is missing, damaged, changed since it was written, not a result of asperity, or written
        by a newer asperity in a format that this one does not know.

    Examples
    --------
    >>> import tempfile
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     contact.to_netcdf(f"{folder}/contact.nc")
    ...     found = asp.read_result(f"{folder}/contact.nc")
    >>> found["pressure"].dims, bool((found["pressure"] == contact.pressure).all())
    (('y', 'x'), True)
    """
    return read_checked(path, None, is_known=False)


def read_checked(path: str | os.PathLike[str], names: Sequence[str] | None, *, is_known: bool) -> xr.Dataset:
    """All variables of a result file, or some; a file whose checksum `is_known` needs no fingerprint."""
    if Path(path).is_dir():
        raise DatasetError(f"{path}: a folder; a file in it is needed, such as {Path(path) / 'contact.nc'}")
    if not Path(path).is_file():
        raise DatasetError(f"{path}: {'not a regular file' if os.path.exists(path) else 'no such file'}")
    is_result = False
    try:
        with xr.open_dataset(path, engine="netcdf4", cache=False) as opened:
            if FINGERPRINT not in opened.attrs:
                raise ValueError(f"it has no attribute {FINGERPRINT}")
            is_result = True
            if (version := int(opened.attrs.get(FORMAT, 1))) > FORMAT_VERSION:
                raise DatasetError(
                    f"{path}: {FORMAT} = {version}, at most {FORMAT_VERSION} is read by asperity "
                    f"{__version__}; install a newer asperity"
                )
            _check_size(opened, path)
            dataset = (opened if names is None or not is_known else opened[[*names]]).load()
            _check(dataset)
            if not is_known and dataset.attrs[FINGERPRINT] != fingerprint(dataset):
                raise ValueError("changed since it was written, or by another version")
            return dataset if names is None else dataset[[*names]]
    except DatasetError:
        raise
    except Exception as error:  # decoding of damaged attributes fails with errors of any type
        if is_locked(path):
            raise DatasetError(f"{path}: locked by another program; close it there, and try again") from error
        # Only a file with a fingerprint is surely a result: any other may be a measured map of the user.
        if is_result:
            raise DatasetError(f"{path}: damaged ({error}); delete it and run again") from error
        raise DatasetError(f"{path}: not a result of asperity, or damaged ({error})") from error


def _check_size(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Raise `DatasetError` for a file that unpacks to more than is accepted."""
    raw = os.environ.get(MAX_MEMORY, "")
    try:
        limit = float(raw) if raw else DEFAULT_MAX_MEMORY
    except ValueError as error:
        raise DatasetError(f"{MAX_MEMORY} = {shown(raw)}: a number of GiB is needed") from error
    size = dataset.nbytes / 2**30
    if size > limit:
        raise DatasetError(
            f"{path}: {MAX_MEMORY} = {limit:g} GiB: the file holds {size:.3g} GiB of data when it is "
            f"unpacked; set that environment variable to {math.ceil(size)} or more if that is right"
        )


def _check(dataset: xr.Dataset) -> None:
    """Raise `ValueError` if names or units are unknown."""
    system = unit_system(dataset)
    if system not in UNIT_SYSTEMS:
        raise ValueError(f"unknown {UNIT_SYSTEM} {system!r}")
    for name, variable in dataset.variables.items():
        if name not in VARIABLES:
            raise ValueError(f"unknown variable {name!r}")
        expected = _attributes(str(name), variable.dtype, system).get("units")
        if (units := variable.attrs.get("units")) != expected:
            raise ValueError(f"{name} is in {units!r}, {expected!r} expected")


def fingerprint(dataset: xr.Dataset) -> str:
    """Fingerprint of all names, attributes and values of a dataset, except the fingerprint itself."""
    found = hashlib.blake2b(digest_size=16)
    attributes = {name: value for name, value in dataset.attrs.items() if name != FINGERPRINT}
    found.update(_attribute_bytes(attributes))
    for name in sorted(dataset.variables, key=str):
        variable = dataset.variables[name]
        found.update(_attribute_bytes({"name": name, "dims": variable.dims, "shape": variable.shape}))
        found.update(_attribute_bytes(variable.attrs))
        values = np.asarray(variable.values)
        is_number = values.dtype.kind in "fiub"
        texts = "" if is_number else "\0".join([*map(str, values.ravel()), ""])
        found.update(np.ascontiguousarray(values).data if is_number else texts.encode())
    return found.hexdigest()


def _attribute_bytes(attributes: Mapping[Any, Any]) -> bytes:
    """Attributes as JSON; NetCDF returns a list of one item as that item."""
    values = {str(name): np.atleast_1d(np.asarray(value)).tolist() for name, value in attributes.items()}
    return json.dumps(values, sort_keys=True).encode()


read_result, write_result = read, write
"""Public names of the two functions."""
