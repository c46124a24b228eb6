"""Checks made before the first job of a study: packages, the results folder, memory, disk, earlier results.

A check that fails raises `PreflightError`, whose message names in one line what is wrong and what helps. This
module imports nothing that may be missing.
"""

from __future__ import annotations

import os
import shutil
import socket
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path

from asperity.errors import DatasetError, PreflightError
from asperity.runtime.system import available_memory, lock
from asperity.runtime.written import require_as_written, written

PACKAGES = {
    "SurfaceTopography": "SurfaceTopography",
    "ducc0": "ducc0",
    "h5py": "h5py",
    "jinja2": "jinja2",
    "jsonschema": "jsonschema",
    "lazy_loader": "lazy-loader",
    "matplotlib": "matplotlib",
    "mpmath": "mpmath",
    "netCDF4": "netCDF4",
    "numba": "numba",
    "numpy": "numpy",
    "olefile": "olefile",
    "pandas": "pandas",
    "pint": "pint",
    "psutil": "psutil",
    "scipy": "scipy",
    "skfem": "scikit-fem",
    "tifffile": "tifffile",
    "tqdm": "tqdm",
    "uvw": "uvw",
    "xarray": "xarray",
    "yaml": "pyyaml",
}
"""Modules that the jobs of the study import → name of the package that provides them."""

BASE_PACKAGES = (
    "ducc0",
    "jinja2",
    "jsonschema",
    "lazy_loader",
    "netCDF4",
    "numba",
    "numpy",
    "pandas",
    "pint",
    "scipy",
    "tqdm",
    "xarray",
    "yaml",
)
"""Modules that the library itself imports."""

REMEDY = "install everything with: pip install --requirement requirements.lock"

_LOCK_FILE = ".running"


def require_packages(modules: Iterable[str] = tuple(PACKAGES)) -> None:
    """Raise `PreflightError` if one of the modules is not installed."""
    missing = [PACKAGES[module] for module in modules if find_spec(module) is None]
    if missing:
        raise PreflightError(f"not installed: {', '.join(missing)}; {REMEDY}")


def claim(folder: str | os.PathLike[str]) -> int:
    """Reserve a results folder for this process, until the process ends in whatever way.

    Parameters
    ----------
    folder : path
        Made if it does not exist.

    Returns
    -------
    descriptor : int
        Open file ``.running`` in the folder. The operating system frees the folder when the file is closed.

    Raises
    ------
    PreflightError
        If the folder cannot be written, or another process has reserved it.
    """
    path = Path(folder) / _LOCK_FILE
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Python opens files so that programs started by this process do not inherit them, nor the lock.
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise PreflightError(
            f"{folder}: cannot be written ({error.strerror}); make it writable or set another as results"
        ) from error
    try:
        lock(descriptor)
    except OSError as error:
        owner = os.read(descriptor, 200).decode(errors="replace").strip() or "of unknown number"
        os.close(descriptor)
        raise PreflightError(
            f"{folder}: another study is running here (process {owner}); wait until it ends, "
            f"or set another folder as results"
        ) from error
    try:
        os.ftruncate(descriptor, 0)
        os.write(descriptor, f"{os.getpid()} on {socket.gethostname()}\n".encode())
    except OSError as error:
        os.close(descriptor)
        raise PreflightError(f"{path}: cannot be written ({error.strerror}); free some space") from error
    return descriptor


def require_memory(needs: Mapping[str, float], limit: float | None = None) -> None:
    """Raise `PreflightError` if a job needs more memory than there is.

    Parameters
    ----------
    needs : mapping
        File to be made → memory in MB that its job needs.
    limit : float, optional
        Memory that the jobs may use, in MB; by default all memory available to this process.
    """
    available, source = (
        (available_memory(), "this machine has") if limit is None else (limit, "mem_mb allows")
    )
    largest = max(needs, key=lambda name: needs[name], default=None)
    if largest is not None and needs[largest] > available:
        raise PreflightError(
            f"{largest} needs about {needs[largest] / 1e3:.3g} GB of memory, {source} "
            f"{available / 1e3:.3g} GB; choose fewer points, or a machine with more"
        )


def require_space(folder: str | os.PathLike[str], need: float) -> None:
    """Raise `PreflightError` if less than `need` MB are free on the disk of the folder."""
    free = shutil.disk_usage(folder).free / 1e6
    if need > free:
        raise PreflightError(
            f"{folder}: about {need:.3g} MB will be written, {free:.3g} MB are free; "
            f"free some space, or set a folder on another disk as results"
        )


def require_undamaged(paths: Iterable[str | os.PathLike[str]], folder: str | os.PathLike[str]) -> None:
    """Raise `PreflightError` for the first file of a study that is damaged or changed since it was written.

    Parameters
    ----------
    paths : iterable of paths
    folder : path
        Results of the study, whose logs hold the fingerprints of the files.
    """
    stated = written(folder)
    for path in paths:
        try:
            require_as_written(path, stated)
        except DatasetError as error:
            raise PreflightError(str(error)) from error
