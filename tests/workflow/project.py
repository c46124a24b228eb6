"""A copy of the project to run the workflow in."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PARTS = ("Snakefile", "config", "workflow", "profiles", "src", "tests/reference")
QUICK = ("--configfile", "config/quick.yaml")


def run(folder, *command):
    """Run a command of the environment in a folder."""
    binaries = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(folder / "src"),
    }
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


def snakemake(folder, *arguments, cores=2):
    """Run the workflow in a folder."""
    return run(folder, "snakemake", "--cores", str(cores), *arguments)


def copy_project(folder):
    """All that a run needs."""
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / part, folder / part)
    return folder
