"""A folder in which the study of the paper can run: Snakefile, workflow, configurations and profiles."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

PARTS = (
    "Snakefile",
    "config",
    "profiles",
    "workflow/cost.py",
    "workflow/report",
    "workflow/rules",
    "workflow/scripts",
    "workflow/verify.py",
)
"""Files and folders of the study, by their place in the project."""

PACKAGED = "study/project"
"""Folder of the installed package that holds them; pyproject.toml puts them there when the wheel is built."""


def source() -> Path:
    """Folder of the parts: in the installed package, else the project around its sources."""
    package = Path(__file__).parents[2]
    packaged = package / PACKAGED
    return packaged if packaged.is_dir() else package.parents[1]


def make_study_folder(folder: str | os.PathLike[str]) -> Path:
    """Write the study into a folder, new or empty, and return the folder.

    Raises
    ------
    ValueError
        If there is a file of this name, or the folder holds anything.
    OSError
        If the folder cannot be written.
    """
    path = Path(folder)
    if path.is_dir() and (held := sorted(entry.name for entry in path.iterdir())):
        raise ValueError(f"{folder}: holds {held[0]}; the name of an empty or new folder is needed")
    if path.exists() and not path.is_dir():
        raise ValueError(f"{folder}: a file; the name of an empty or new folder is needed")
    for part in PARTS:
        origin, target = source() / part, path / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if origin.is_dir():  # without permissions and times: an installed package may be read-only
            left_out = shutil.ignore_patterns("__pycache__")
            shutil.copytree(origin, target, ignore=left_out, copy_function=shutil.copyfile)
        else:
            shutil.copyfile(origin, target)
    return path
