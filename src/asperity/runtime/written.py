"""Fingerprints of the files that a job of a study has written, kept in its log.

A file of results is damaged if its bytes are not those that its job wrote. Every log holds one line for each
file, with its place relative to the log, so that a folder of results can be moved as a whole.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from asperity.errors import DatasetError

LOGS = "log"
"""Folder of the logs, in the folder of the results of a study."""

REMEDY = "delete it and run again"

_LINE = re.compile(r"wrote (.+), fingerprint ([0-9a-f]{32})$", re.MULTILINE)


def fingerprint_of(path: str | os.PathLike[str]) -> str:
    """Fingerprint of all bytes of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


def lines_about(outputs: Iterable[str | os.PathLike[str]], log: str | os.PathLike[str]) -> Iterator[str]:
    """Lines for a log that state what a job has written."""
    for output in outputs:
        if os.path.isfile(output):
            place = os.path.relpath(output, Path(log).parent)
            yield f"wrote {place}, fingerprint {fingerprint_of(output)}"


def written(folder: str | os.PathLike[str]) -> dict[str, str]:
    """Normalised path of every file that the logs of a study state → its fingerprint."""
    found = {}
    for log in sorted(Path(folder, LOGS).rglob("*.log")):
        for place, fingerprint in _LINE.findall(log.read_text(encoding="utf-8", errors="replace")):
            found[os.path.normpath(log.parent / place)] = fingerprint
    return found


def is_as_written(path: str | os.PathLike[str], stated: dict[str, str]) -> bool:
    """True for a file with the fingerprint that a log states, False for another or without one."""
    fingerprint = stated.get(os.path.normpath(path))
    try:
        return fingerprint is not None and fingerprint == fingerprint_of(path)
    except OSError as error:
        raise DatasetError(f"{path}: cannot be read ({error.strerror})") from error


def require_as_written(path: str | os.PathLike[str], stated: dict[str, str]) -> None:
    """Check a file of results against its fingerprint, or without one a dataset against the one in it.

    Parameters
    ----------
    path : path
    stated : dict
        As from `written`.

    Raises
    ------
    DatasetError
        If the file is missing, empty or not as its job wrote it.
    """
    if is_as_written(path, stated):
        return
    if not os.path.getsize(path):
        raise DatasetError(f"{path}: empty; {REMEDY}")
    if Path(path).suffix == ".nc":
        from asperity.results import dataset  # takes a second, and all jobs import this module

        dataset.verify(path)
    if os.path.normpath(path) in stated:
        raise DatasetError(f"{path}: changed since it was written; {REMEDY}")
