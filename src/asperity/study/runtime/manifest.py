"""Manifest of the results of a study: the SHA-256 hash of every file, as ``sha256sum --check`` reads it."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from asperity.core.errors import DatasetError
from asperity.results.atomic import write_text

MANIFEST = "SHA256SUMS"
"""File in the folder of results; a folder below with a file of this name holds another study."""

_NO_RESULTS = ("log", "benchmark", ".snakemake")


def read_manifest(folder: Path) -> dict[str, str]:
    """Path of every file, relative to the folder → its hash; empty without a manifest.

    Raises
    ------
    DatasetError
        If a line of the manifest is not a hash and a name.
    """
    path = folder / MANIFEST
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    found = [re.fullmatch(r"([0-9a-f]{64})  (.+)", line) for line in text.splitlines()]
    if None in found:
        raise DatasetError(
            f"{path}: line {found.index(None) + 1} is not a hash and a name; delete it and run again"
        )
    return {each[2]: each[1] for each in found if each}


def write_manifest(folder: Path, outputs: Iterable[str | os.PathLike[str]]) -> None:
    """Add files of a run to the manifest of its results, and drop those that are gone.

    The hash of a file that has not been written since the manifest is kept, so that damage stays visible.
    """
    known, path = read_manifest(folder), folder / MANIFEST
    written = path.stat().st_mtime if path.is_file() else 0.0
    names = {*known, *(os.path.relpath(output, folder) for output in outputs)}
    present = [name for name in sorted(names) if (folder / name).is_file()]
    digests = {
        name: known[name]
        if name in known and (folder / name).stat().st_mtime < written
        else hash_of(folder / name)
        for name in present
    }
    write_text(path, "".join(f"{digest}  {name}\n" for name, digest in digests.items()))


def compare(folder: Path) -> Iterator[tuple[str, str]]:
    """Every file that differs from the manifest, and how: missing, not a regular file, changed or extra."""
    known = read_manifest(folder)
    for name, digest in known.items():
        path = folder / name
        if not path.is_file():
            yield name, "not a regular file" if path.exists() else "missing"
        elif hash_of(path) != digest:
            yield name, "changed"
    for place, below, names in os.walk(folder):
        inside = Path(place)
        below[:] = [
            name
            for name in sorted(below)
            if not (inside / name / MANIFEST).exists() and not (inside == folder and name in _NO_RESULTS)
        ]
        for name in sorted(names):
            relative = os.path.relpath(inside / name, folder)
            if relative not in known and relative != MANIFEST:
                yield relative, "extra"


def hash_of(path: Path) -> str:
    """SHA-256 hash of the bytes of a file, in hexadecimal digits."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
