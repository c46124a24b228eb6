"""Atomic writing of files, and the lock of a folder, into which one process writes at a time.

A file is written under a temporary name, which is renamed on success and deleted on failure.
"""

import errno
import os
import random
import re
import secrets
import shutil
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile

from asperity.core.errors import DatasetError
from asperity.core.system import flush, has_ended, process_name

MIN_FREE_SPACE = 2**20
"""Fewer free bytes than this are reported as a full disk, because the NetCDF library does not report one."""

# Number of characters of a name that its temporary file keeps; a file name has at most 255 bytes.
_LONGEST_STEM = 30


def name_problem(path: str | os.PathLike[str]) -> str:
    """Reason why no result can be written under a name, empty if it can."""
    if re.search("[\0\ud800-\udfff]", os.path.abspath(path)):  # the NetCDF library takes UTF-8 alone
        return "its path is not UTF-8; another one is needed"
    return ""


def write_problem(path: str | os.PathLike[str]) -> str:
    """Reason why a file cannot be written, empty if it can; called before its content is computed."""
    if problem := name_problem(path):
        return problem
    target = Path(os.path.realpath(path))
    try:
        if target.is_dir():
            return "a folder, the name of a file is needed"
        if problem := _problem_of(target):
            return problem
        folder = next(parent for parent in target.parents if parent.exists())
        if not folder.is_dir():
            return f"{folder} is a file, the name of a folder is needed there"
        with TemporaryFile(dir=folder):
            return ""
    except OSError as error:
        return f"cannot be written ({error.strerror})"


def _problem_of(target: Path) -> str:
    """Reason why a file that is there must not be replaced, empty if it may be."""
    if not target.exists():
        return ""
    mode = target.stat().st_mode
    if not stat.S_ISREG(mode):
        return "not a regular file; another name is needed"
    return "" if mode & stat.S_IWUSR else "read-only; make it writable, or choose another name"


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary file beside `path`: renamed to it when the block succeeds, deleted when it fails.

    It is flushed to the disk before it replaces an earlier file, which a power failure therefore keeps. Only
    regular files are replaced; the new one has the permissions of the earlier one. A symbolic link is
    followed. Temporary files of the same name that killed processes have left are deleted too.

    Raises
    ------
    DatasetError
        If the file cannot be written; the message names the file and the remedy.
    """
    target = Path(os.path.realpath(path))
    stem = f".{target.name[:_LONGEST_STEM]}.{process_name()}.{secrets.token_hex(8)}"
    unfinished = target.with_name(f"{stem}.unfinished")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if problem := _problem_of(target):
            raise DatasetError(f"{path}: {problem}")
        earlier = target.stat().st_mode if target.exists() else None
        stem = re.escape(target.name[:_LONGEST_STEM])
        abandoned = re.compile(rf"\.{stem}\.([\w-]+\.\d+\.\d+)\.\w+\.unfinished")
        for left in target.parent.iterdir():
            if (found := abandoned.fullmatch(left.name)) and has_ended(found[1]):
                left.unlink(missing_ok=True)
        os.close(os.open(unfinished, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield unfinished
        if earlier is not None:
            unfinished.chmod(stat.S_IMODE(earlier))
        flush(unfinished)
        os.replace(unfinished, target)
        flush(target.parent)
    except (OSError, RuntimeError) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(f"{path}: cannot be written ({_cause_and_remedy(error, target)}") from error
    finally:
        with suppress(OSError):
            unfinished.unlink()


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file atomically, with the same bytes on every system: UTF-8, lines end with a line feed.

    Raises
    ------
    DatasetError
        If the file cannot be written.
    """
    with atomic_write(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")


def _cause_and_remedy(error: Exception, path: Path) -> str:
    """End of the message that a file cannot be written."""
    existing = next(folder for folder in path.parents if folder.is_dir())
    reason, space = getattr(error, "strerror", None) or error, shutil.disk_usage(existing)
    if getattr(error, "errno", None) == errno.ENOSPC or (space.total and space.free < MIN_FREE_SPACE):
        return "the disk is full); free some space and run again"
    if getattr(error, "errno", None) == errno.EFBIG:
        return f"{reason}); a disk or a limit of the system that allows larger files is needed"
    return f"{reason}); make its folder writable and run again"


LOCK = ".asperity-run.{}.lock"
"""Name of the empty file that names the process writing into a folder."""

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
