"""A folder in which the study of the paper can run: Snakefile, workflow, configurations and profiles."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

PARTS = (
    "Snakefile",
    "config",
    "profiles",
    "workflow/Snakefile",
    "workflow/cost.py",
    "workflow/crate.py",
    "workflow/envs",
    "workflow/report",
    "workflow/rules",
    "workflow/scripts",
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
        If the folder cannot be written; nothing of it is left then.
    """
    path = Path(folder)
    is_new = not path.exists()
    if not is_new and not path.is_dir():
        raise ValueError(f"{folder}: a file; the name of an empty or new folder is needed")
    if not is_new and (held := sorted(entry.name for entry in path.iterdir())):
        raise ValueError(f"{folder}: holds {held[0]}; the name of an empty or new folder is needed")
    path.mkdir(parents=True, exist_ok=True)
    try:
        with TemporaryDirectory(dir=path) as unfinished:
            for part in PARTS:
                _copy(source(), part, Path(unfinished))
            for entry in list(Path(unfinished).iterdir()):
                entry.rename(path / entry.name)
    except OSError:
        if is_new:
            path.rmdir()
        raise
    return path


def _copy(project: Path, part: str, folder: Path) -> None:
    """Copy a part of the project, without permissions and times: an installed package may be read-only."""
    origin = project / part
    for file in origin.rglob("*") if origin.is_dir() else [origin]:
        if file.is_file() and file.parent.name != "__pycache__":
            target = folder / file.relative_to(project)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, target)
