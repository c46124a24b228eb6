"""Folders that hold one result: checked before anything is computed, and written atomically."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from asperity.errors import DatasetError
from asperity.system import is_running

_OWN_FILES = re.compile(
    r"(surface|contact|stress(_lower|_upper)?)\.nc|(height|pressure|(section|plane|peaks)(_[a-z0-9_]+)?)\.png"
    r"|(peaks|answer)\.csv|report\.html"
    # Pictures of these results by asperity view, with the names that it chooses.
    r"|(surface|contact|stress(_lower|_upper)?)_(height|pressure|gap|section|plane|peaks)\.png"
)
"""Names of files that a folder of an answer holds; a folder with any other is not written over."""


def folder_problem(folder: str | os.PathLike[str]) -> str:
    """Reason why an answer cannot be written into a folder, empty if it can."""
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        return "a file, the name of a folder is needed"
    if folder.is_dir():
        other = sorted(path.name for path in folder.iterdir() if not _OWN_FILES.fullmatch(path.name))
        if other:
            return f"holds files that are no result of asperity run ({other[0]}); another folder is needed"
    return ""


@contextmanager
def atomic_folder(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary folder beside `folder`: renamed to it when the block succeeds, deleted when it fails.

    Temporary folders of the same name that killed processes have left are deleted too.
    """
    if problem := folder_problem(folder):
        raise ValueError(f"{folder}: {problem}")
    path = Path(folder).absolute()
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _delete_abandoned(path)
        unfinished.mkdir()
        yield unfinished
        _replace(path, unfinished)
    except OSError as error:
        raise DatasetError(f"{folder}: cannot be written ({error.strerror or error})") from error
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _replace(path: Path, new: Path) -> None:
    """Put a folder in the place of another."""
    if path.is_dir():
        earlier = path.with_name(f".{path.name}.{os.getpid()}.earlier")
        os.rename(path, earlier)
        os.rename(new, path)
        shutil.rmtree(earlier, ignore_errors=True)
    else:
        os.rename(new, path)


def _delete_abandoned(path: Path) -> None:
    """Delete temporary folders of `path` whose processes have ended."""
    pattern = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.(unfinished|earlier)")
    for left in path.parent.iterdir():
        found = pattern.fullmatch(left.name)
        if found and left.is_dir() and not is_running(int(found[1])):
            shutil.rmtree(left, ignore_errors=True)
