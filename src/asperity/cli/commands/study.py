"""``asperity study init``: a folder in which the study of the paper runs."""

import argparse
import shutil
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

from asperity.core.errors import one_line
from asperity.core.packages import absent, install_command
from asperity.core.types import FilePath

PACKAGED = "study/project"
"""Folder of the installed package with the study; pyproject.toml puts it there when the wheel is built."""

_NEXT = """\
next:
    cd {folder}
    snakemake --cores 2 --configfile config/quick.yaml    # every rule on small cells, one minute
    snakemake --cores 2 --configfile config/mine.yaml     # a study of your own, to change
    snakemake --cores 2                                   # the paper; figures in results/figures
config/README.md describes every setting"""


def run(options: argparse.Namespace) -> None:
    """Write the folder, and print the commands that run the study."""
    folder = one_line(str(make_study_folder(options.folder)))
    print(f"{folder}: Snakefile, config, profiles and workflow of the study")
    if missing := absent():
        print(f"first:\n    {install_command(missing)}")
    print(_NEXT.format(folder=folder))


def make_study_folder(folder: FilePath) -> Path:
    """Write the study into a folder, new or empty, and return the folder.

    Raises
    ------
    ValueError
        If there is a file of this name, or the folder holds anything.
    OSError
        If the folder cannot be written; a new one is deleted again.
    """
    path = Path(folder)
    is_new = not path.exists()
    if not is_new and not path.is_dir():
        raise ValueError(f"{folder}: a file; the name of an empty or new folder is needed")
    if not is_new and (held := sorted(entry.name for entry in path.iterdir())):
        raise ValueError(f"{folder}: holds {held[0]}; the name of an empty or new folder is needed")
    path.mkdir(parents=True, exist_ok=True)
    package = Path(__file__).parents[2]
    source, parts = package / PACKAGED, ["."]
    if not source.is_dir():  # the project around the package
        source = package.parents[1]
        project = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))
        parts = [*project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]]
    try:
        with TemporaryDirectory(dir=path) as temporary:
            unfinished = Path(temporary)
            # Without permissions and times: an installed package may be read-only.
            for file in (each for part in parts for each in (source / part, *(source / part).rglob("*"))):
                if file.is_file() and file.parent.name != "__pycache__":
                    target = unfinished / file.relative_to(source)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(file, target)
            for entry in list(unfinished.iterdir()):
                entry.rename(path / entry.name)
    except OSError:
        if is_new:
            path.rmdir()
        raise
    return path
