"""The wheel, built from the source distribution, and installed in environments of their own."""

import os
import subprocess
import sys
import sysconfig
import tarfile
from pathlib import Path

ROOT = Path(__file__).parents[2]


def build(folder):
    """Build the source distribution, and from its unpacked content the wheel; returns both paths."""
    hatchling = [sys.executable, "-m", "hatchling", "build", "--directory", str(folder)]
    subprocess.run([*hatchling, "--target", "sdist"], cwd=ROOT, check=True, capture_output=True)
    (source,) = folder.glob("asperity-*.tar.gz")
    with tarfile.open(source) as archive:
        # Python 3.11.0 to 3.11.3 have no filters.
        archive.extractall(folder, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    unpacked = folder / source.name.removesuffix(".tar.gz")
    subprocess.run([*hatchling, "--target", "wheel"], cwd=unpacked, check=True, capture_output=True)
    (wheel,) = folder.glob("asperity-*.whl")
    return source, wheel


class Environment:
    """A virtual environment outside the project, and an empty folder in which its commands run."""

    def __init__(self, folder, *options):
        subprocess.run([sys.executable, "-m", "venv", *options, str(folder / "env")], check=True)
        places = {"base": str(folder / "env"), "platbase": str(folder / "env")}
        self.scripts = Path(sysconfig.get_path("scripts", "venv", places))
        self.packages = Path(sysconfig.get_path("purelib", "venv", places))
        self.folder = folder / "empty"
        self.folder.mkdir()

    def run(self, command, *arguments, folder=None):
        """Run a command of the environment, without anything of the project on its paths."""
        variables = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        variables["PATH"] = f"{self.scripts}{os.pathsep}{os.environ['PATH']}"
        settings = {"cwd": folder or self.folder, "env": variables, "encoding": "utf-8"}
        return subprocess.run([self.scripts / command, *arguments], capture_output=True, **settings)

    def share_packages(self):
        """Let the environment import the packages of the environment of the tests, but not the project."""
        (self.packages / "shared.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
