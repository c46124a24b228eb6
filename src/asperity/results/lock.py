"""The lock of a folder of results: one process writes into it at a time."""

import errno
import os
import random
import secrets
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from asperity.core.errors import DatasetError
from asperity.core.system import has_ended, process_name

LOCK = ".asperity-run.{}.lock"
"""Name of the empty file in a folder that says which process writes into it."""

LOCK_ATTEMPTS = 5
"""Attempts to lock a folder: processes that try at the same moment all withdraw, and retry."""

_held: set[tuple[Path, int]] = set()
"""Folders that are locked, each with the thread that has locked it."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other processes and threads from writing results into a folder while the block runs.

    The folder is made if it is not there, and deleted again if nothing was written into it. The lock is a
    file named after its owner; locks of processes that have ended are deleted.

    Raises
    ------
    DatasetError
        If another process or thread writes into the folder, or no file can be written there.
    """
    target = Path(os.path.realpath(folder))
    held = target, threading.get_ident()
    if held in _held:
        yield
        return
    made = [path for path in (target, *target.parents) if not path.exists()]
    lock = target / LOCK.format(f"{process_name()}.{secrets.token_hex(4)}")
    try:
        try:
            _lock(folder, lock)
        except OSError as error:
            raise DatasetError(f"{folder}: cannot be written ({error.strerror or error})") from error
        _held.add(held)
        yield
    finally:
        _held.discard(held)
        with suppress(OSError):
            lock.unlink(missing_ok=True)
        with suppress(OSError):  # raised by the first folder that is not empty
            for path in made:
                path.rmdir()


def _lock(folder: Path, lock: Path) -> None:
    """Write the file of a lock; `DatasetError` if a running process has locked the folder."""
    others: list[Path] = []
    for attempt in range(LOCK_ATTEMPTS):
        if attempt:
            time.sleep(random.uniform(0.02, 0.2))
        try:
            lock.parent.mkdir(parents=True, exist_ok=True)
            lock.touch(exist_ok=False)
        except FileNotFoundError:  # another process that made the folder has just deleted it
            continue
        others = [path for path in lock.parent.glob(LOCK.format("*")) if path != lock]
        for ended in (path for path in others if has_ended(_owner(path))):
            ended.unlink(missing_ok=True)
        others = [path for path in others if path.exists()]
        if not others:
            return
        lock.unlink()
    if not others:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
    host, process, _ = _owner(others[0]).split(".")
    raise DatasetError(
        f"{folder}: process {process} on {host} writes into it; wait until it ends, or choose "
        f"another folder (if it has been killed, delete {others[0].name} there)"
    )


def _owner(lock: Path) -> str:
    """Name of the process that owns a lock, as of `process_name`."""
    before, after = LOCK.split("{}")
    return lock.name.removeprefix(before).removesuffix(after).rpartition(".")[0]
