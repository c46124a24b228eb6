"""Checks made before the first job of a study: packages, the results folder, memory, disk, earlier results.

A check that fails raises `PreflightError`, whose message names in one line what is wrong and what helps. This
module imports nothing that may be missing.
"""

from __future__ import annotations

import os
import shutil
import socket
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.errors import DatasetError, PreflightError
from asperity.packages import NEEDED, MissingPackageError, require
from asperity.runtime.written import require_as_written, written
from asperity.system import available_memory

if TYPE_CHECKING:
    from filelock import BaseFileLock

OWNER = ".running"
"""File in the folder of results of every study: number and machine of the process that uses it."""

LOCK = ".running.lock"
"""Empty file that this process keeps locked. Apart from the owner, which others cannot read in a file that
Windows has locked."""

_CLAIMED: list[BaseFileLock] = []
"""Locks of this process: a lock ends with its object."""


def require_packages(modules: Iterable[str] = NEEDED) -> None:
    """Raise `PreflightError` if one of the modules is not installed, by default of all that a study needs."""
    try:
        require(modules)
    except MissingPackageError as error:
        raise PreflightError(str(error)) from error


def claim(folder: str | os.PathLike[str]) -> BaseFileLock:
    """Reserve a results folder for this process, until the process ends in whatever way.

    Parameters
    ----------
    folder : path
        Made if it does not exist.

    Returns
    -------
    lock : filelock.BaseFileLock
        Lock of the folder, for who releases it earlier.

    Raises
    ------
    PreflightError
        If the folder cannot be written, or another process has reserved it.
    """
    from filelock import FileLock, Timeout

    owner = Path(folder) / OWNER
    lock = FileLock(owner.with_name(LOCK))
    try:
        owner.parent.mkdir(parents=True, exist_ok=True)
        lock.acquire(blocking=False)
    except Timeout as error:
        raise PreflightError(
            f"{folder}: another study is running here (process {_read_owner(owner)}); wait until it ends, "
            f"or set another folder as results"
        ) from error
    except (OSError, NotImplementedError) as error:
        reason = getattr(error, "strerror", None) or error
        raise PreflightError(
            f"{folder}: cannot be written ({reason}); make it writable or set another as results"
        ) from error
    try:
        owner.write_text(f"{os.getpid()} on {socket.gethostname()}\n", encoding="utf-8")
    except OSError as error:
        lock.release()
        raise PreflightError(f"{owner}: cannot be written ({error.strerror}); free some space") from error
    _CLAIMED.append(lock)
    return lock


def _read_owner(path: Path) -> str:
    """Number and machine of the process that a file of the owner names."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip() or "of unknown number"
    except OSError:
        return "of unknown number"


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
