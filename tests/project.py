"""A copy of the project to run the workflow in."""

import contextlib
import io
import os
import runpy
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from unittest import mock

from snakemake import cli

from asperity.results import dataset

ROOT = Path(__file__).parents[1]
OVERLAYS = ("tests/workflow/study.yaml", "tests/workflow/tiny.yaml")
PARTS = ("Snakefile", "config", "workflow", "profiles", "tests/reference", *OVERLAYS)
QUICK = ("--configfile", "config/quick.yaml", "tests/workflow/study.yaml")
STUDY = (*QUICK, "--config", "results=../own results")
TINY = ("--configfile", "config/quick.yaml", "tests/workflow/tiny.yaml")

HIDE = """
from importlib.machinery import PathFinder

found = PathFinder.find_spec
PathFinder.find_spec = lambda name, *rest: None if name in {names} else found(name, *rest)
"""


def hide(folder, *names):
    """Make a folder that hides packages from every process that has the folder first on PYTHONPATH."""
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(HIDE.format(names=names))
    return folder


def environment(folder):
    """Environment of the tests, with the library of the project in `folder`, or else the one under test."""
    own, library = folder / ".venv/bin", folder / "src"
    binaries = own if own.exists() else Path(sys.executable).parent
    return os.environ | {
        "PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(library if library.exists() else ROOT / "src"),
    }


def run(folder, *command):
    """Run a command in a folder, with the library of the project there."""
    return subprocess.run(command, cwd=folder, env=environment(folder), capture_output=True, text=True)


def script(folder, name, *arguments):
    """Run a script of the workflow in this process and in a folder: what it prints, and its last message."""
    said = io.StringIO()
    with (
        contextlib.chdir(folder),
        contextlib.redirect_stdout(said),
        contextlib.redirect_stderr(said),
        mock.patch.object(sys, "argv", [name, *arguments]),
    ):
        try:
            runpy.run_path(str(ROOT / "workflow" / name), run_name="__main__")
        except SystemExit as ended:
            return said.getvalue(), str(ended)
    return said.getvalue(), ""


def snakemake(folder, *arguments, cores=2):
    """Run the workflow of the project in a folder."""
    return run(folder, "python", "-m", "snakemake", "--cores", str(cores), *arguments)


def snakemake_here(folder, *options):
    """Output of the workflow in a folder, run in this process without a job, and its last message.

    A process of its own takes three times as long.
    """
    said = io.StringIO()
    with (
        contextlib.chdir(folder),
        contextlib.redirect_stdout(said),
        contextlib.redirect_stderr(said),
        mock.patch.dict(os.environ),
        mock.patch.object(sys, "path", [*sys.path]),
        mock.patch.object(sys, "executable", sys.executable),
        warnings.catch_warnings(action="ignore"),
    ):
        try:
            cli.main(["--cores", "2", *options])
        except SystemExit as ended:
            return f"{said.getvalue()}\n{ended}"
    return said.getvalue()


def copy_project(folder):
    """Copy everything that a run needs; the library is a link, so that no copy compiles it anew."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "src").symlink_to(ROOT / "src", target_is_directory=True)
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, folder / part)
        else:
            (folder / part).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / part, folder / part)
    return folder


def numbers(path):
    """A result without the times and memory that it measured, and without the digest of the whole."""
    data = dataset.read(path)
    del data.attrs["content_digest"]
    cost = [name for name, values in data.variables.items() if values.attrs.get("units") in ("s", "byte")]
    return data.drop_vars(cost)
