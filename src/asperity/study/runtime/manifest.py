"""Manifest of the results of a study: the SHA-256 hash of every file, as ``sha256sum --check`` reads it."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable
from pathlib import Path

from asperity.results.atomic import write_text

MANIFEST = "SHA256SUMS"
"""File in the folder of results."""


def write_manifest(folder: Path, outputs: Iterable[str | os.PathLike[str]]) -> None:
    """Add files of a run to the manifest of its results, and drop those that are gone.

    The hash of a file that has not been written since the manifest is kept, so that damage stays visible.
    """
    path = folder / MANIFEST
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    known = {name: digest for digest, name in re.findall(r"^([0-9a-f]{64})  (.+)$", text, re.MULTILINE)}
    written = path.stat().st_mtime if path.is_file() else 0.0
    names = {*known, *(os.path.relpath(output, folder) for output in outputs)}
    lines = []
    for name in sorted(names):
        file = folder / name
        if not file.is_file():
            continue
        if name not in known or file.stat().st_mtime >= written:
            with open(file, "rb") as content:
                known[name] = hashlib.file_digest(content, "sha256").hexdigest()
        lines.append(f"{known[name]}  {name}\n")
    write_text(path, "".join(lines))
