"""What a study stands on, looked at before its first job: packages, its folder, memory, earlier results.

Nothing is imported here that may be missing. Whatever is wrong raises `PreflightError`: one line that names
it and the remedy.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import socket
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path

from asperity.errors import DatasetError, PreflightError

PACKAGES = {
    "SurfaceTopography": "SurfaceTopography",
    "ducc0": "ducc0",
    "jsonschema": "jsonschema",
    "lazy_loader": "lazy-loader",
    "matplotlib": "matplotlib",
    "mpmath": "mpmath",
    "netCDF4": "netCDF4",
    "numba": "numba",
    "numpy": "numpy",
    "scipy": "scipy",
    "skfem": "scikit-fem",
    "tqdm": "tqdm",
    "uvw": "uvw",
    "xarray": "xarray",
    "yaml": "pyyaml",
}
"""What the jobs of the study import, and the package that has it."""

BASE_PACKAGES = (
    "ducc0",
    "jsonschema",
    "lazy_loader",
    "netCDF4",
    "numba",
    "numpy",
    "scipy",
    "tqdm",
    "xarray",
    "yaml",
)
"""What the library imports wherever it is used."""

REMEDY = "all that is needed: pip install --requirement requirements.lock"

_RUNNING = ".running"
_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def require_packages(modules: Iterable[str] = tuple(PACKAGES)) -> None:
    """Raise `PreflightError` if a package that has one of these modules is not installed."""
    missing = [PACKAGES[module] for module in modules if find_spec(module) is None]
    if missing:
        raise PreflightError(f"not installed: {', '.join(missing)}; {REMEDY}")


def claim(folder: str | os.PathLike[str]) -> int:
    """Take a folder of results for this process alone, until it ends in whatever way.

    Parameters
    ----------
    folder : path
        Made if it is not there.

    Returns
    -------
    descriptor : int
        Of the file ``.running`` in the folder; the operating system gives the claim up with it.

    Raises
    ------
    PreflightError
        If the folder cannot be written, or another process has claimed it.
    """
    path = Path(folder) / _RUNNING
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise PreflightError(
            f"{folder}: cannot be written ({error.strerror}); make it writable or set another as results"
        ) from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        owner = os.read(descriptor, 200).decode(errors="replace").strip() or "of unknown number"
        os.close(descriptor)
        raise PreflightError(
            f"{folder}: another study is at work here (process {owner}); wait for its end, "
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
        What is to be made → memory that its making needs, in MB.
    limit : float, optional
        Memory to be used, in MB; by default what the machine has, or what its control group may use.
    """
    available, source = (physical_memory(), "this machine has") if limit is None else (limit, "mem_mb allows")
    made = max(needs, key=lambda name: needs[name], default=None)
    if made is not None and needs[made] > available:
        raise PreflightError(
            f"{made} needs about {needs[made] / 1e3:.3g} GB of memory, {source} "
            f"{available / 1e3:.3g} GB; choose fewer points, or a machine with more"
        )


def physical_memory() -> float:
    """Memory that this process may use, in MB: the machine's, or less where its control group has less."""
    limits = [path.read_text().strip() for path in map(Path, _GROUP_LIMITS) if path.is_file()]
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return min([machine, *(int(limit) for limit in limits if limit.isdigit())]) / 1e6


def require_space(folder: str | os.PathLike[str], need: float) -> None:
    """Raise `PreflightError` if the disk of a folder has less than `need` MB left."""
    free = shutil.disk_usage(folder).free / 1e6
    if need > free:
        raise PreflightError(
            f"{folder}: about {need:.3g} MB will be written, {free:.3g} MB are free; "
            f"free some space, or set a folder on another disk as results"
        )


def require_undamaged(paths: Iterable[str | os.PathLike[str]]) -> None:
    """Raise `PreflightError` for the first result file that is not as it was written."""
    from asperity.results import dataset

    for path in paths:
        try:
            dataset.verify(path)
        except DatasetError as error:
            raise PreflightError(str(error)) from error
