"""The folder of an answer: whole files of one answer, which replace those of an earlier one and no others."""

from __future__ import annotations

import json
import os
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

MANIFEST = ".asperity-run.json"
"""File with the names of all files of an answer in its folder, so that no other file is ever replaced."""

UNFINISHED = ".unfinished-"
"""Begin of the name of the folder in which files are written before they are moved to their places."""

COMPLETE = ".complete"
"""Name of that folder once all its files are written, which then replace those of an earlier answer."""

COMPARISON = ("comparison.csv", "comparison.html")
"""Names of the files that compare several answers."""

ALWAYS_WRITTEN = (
    *("case.yaml", "surface.nc", "contact.nc", "peaks.csv", "spots.csv", "gaps.csv", "answer.csv"),
    *("height.png", "report.html"),
)


def folder_problem(folder: str | os.PathLike[str], names: Iterable[str] = ALWAYS_WRITTEN) -> str:
    """Reason why an answer with files of these names cannot be written into a folder, empty if it can."""
    folder = Path(folder)
    try:
        if not folder.exists():
            return ""
    except OSError as error:
        return f"cannot be written ({error.strerror})"
    if not folder.is_dir():
        return "a file, the name of a folder is needed"
    for path in (folder / name for name in names if (folder / name).exists()):
        if path.name not in names_in(folder):
            return f"holds {path.name}, which asperity run has not written; another folder is needed"
        if not path.stat().st_mode & stat.S_IWUSR:
            return f"holds {path.name}, which is read-only; another folder is needed"
    return ""


@contextmanager
def replacing(folder: Path, kept: set[str]) -> Iterator[Path]:
    """Folder whose files replace those of an earlier answer, except for `kept`, when the block succeeds."""
    with TemporaryDirectory(prefix=UNFINISHED, dir=folder, ignore_cleanup_errors=True) as name:
        unfinished = Path(name)
        yield unfinished
        names = {path.name for path in unfinished.iterdir()}
        if problem := folder_problem(folder, names):
            raise ValueError(f"{folder}: {problem}")
        from asperity.results.atomic import write_text  # the check of a folder does not wait for xarray

        write_text(unfinished / MANIFEST, json.dumps(sorted(kept | names)))
        unfinished.rename(folder / COMPLETE)
    move_complete(folder)


def move_complete(folder: Path) -> None:
    """Move the complete files to their places, after those of the earlier answer are deleted.

    The folder never holds files of two answers. Its manifest is deleted before the first file is moved, and
    moved last, so that the steps can be continued wherever they were interrupted.
    """
    complete = folder / COMPLETE
    if not complete.is_dir():
        return
    new = {path.name for path in complete.iterdir()}
    if (folder / MANIFEST).exists():
        kept = names_in(complete) - new
        for path in (folder / name for name in names_in(folder) - kept):
            if path.exists() and path.name in new:
                shutil.copymode(path, complete / path.name)
            path.unlink(missing_ok=True)
        (folder / MANIFEST).unlink()
    for name in sorted(new, key=MANIFEST.__eq__):
        os.replace(complete / name, folder / name)
    complete.rmdir()


def names_in(folder: Path) -> set[str]:
    """Names of the files of the answer in a folder."""
    for manifest in (folder / MANIFEST, folder / COMPLETE / MANIFEST):
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        return {name for name in found if isinstance(name, str) and Path(name).name == name}
    return set()
