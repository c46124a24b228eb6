"""Writing of files whole or not at all: under another name, renamed on success, deleted on failure."""

from __future__ import annotations

import errno
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from asperity.errors import DatasetError
from asperity.system import is_running

MIN_FREE_SPACE = 2**20
"""A disk with fewer free bytes is called full: the NetCDF library does not say so itself."""

_unfinished: set[Path] = set()
"""Temporary files of this process."""


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary file beside `path`: renamed to it when the block succeeds, deleted when it fails.

    Temporary files of the same name that killed processes have left are deleted too.

    Raises
    ------
    DatasetError
        If the file cannot be written; the message names the file and the remedy.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    _unfinished.add(unfinished)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _delete_abandoned(path)
        yield unfinished
        os.replace(unfinished, path)
    except (OSError, RuntimeError) as error:
        raise DatasetError(f"{path}: cannot be written ({_cause_and_remedy(error, path)}") from error
    finally:
        with suppress(OSError):
            unfinished.unlink()
        _unfinished.discard(unfinished)


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file atomically, with the same bytes on every system: UTF-8, lines end with a line feed.

    Raises
    ------
    DatasetError
        If the file cannot be written.
    """
    with atomic_write(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")


def delete_unfinished() -> None:
    """Delete the temporary files of this process, which is about to end."""
    for path in list(_unfinished):
        with suppress(OSError):
            path.unlink()


def _delete_abandoned(path: Path) -> None:
    """Delete temporary files of `path` whose processes have ended."""
    pattern = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.unfinished")
    for left in path.parent.iterdir():
        found = pattern.fullmatch(left.name)
        if found and not is_running(int(found[1])):
            left.unlink(missing_ok=True)


def _cause_and_remedy(error: Exception, path: Path) -> str:
    """End of the message that a file cannot be written."""
    existing = next(folder for folder in path.absolute().parents if folder.is_dir())
    if getattr(error, "errno", None) == errno.ENOSPC or shutil.disk_usage(existing).free < MIN_FREE_SPACE:
        return "the disk is full); free some space and run again"
    return f"{getattr(error, 'strerror', None) or error}); make its folder writable and run again"
