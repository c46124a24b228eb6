"""The wheel as a user has it: outside the project, where only what it holds is found.

The environments of the fast tests share the installed packages of the environment of the tests. Those of the
slow ones (`make wheel-test`) are empty, and pip fills them from the package index.
"""

import filecmp
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml
from project import ROOT

import asperity
from asperity.cli.parser import parse
from asperity.core.packages import ALTERNATIVES, PACKAGES

SPECTRUM = "{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.004}"
RESULTS = """
import asperity as asp
height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
contact = asp.solve_contact(height, asp.Solid(1.0, 0.3), contact_area_fraction=0.1)
contact.to_netcdf("c.nc")
asp.write_result(asp.analyse_stress(contact).assign_attrs(unit_system="SI"), "t.nc", "Stress")
"""
"""Makes the results that the commands take."""
STEEL = ROOT / "tests/data/steel.x3p"
COMMANDS = (
    ("", ["plan", SPECTRUM]),
    ("", ["verify", "c.nc"]),
    ("", ["export", "t.nc", "--peaks", "p.csv"]),
    ("", ["export", "c.nc", "--field", "von_mises:0-0.1m", "f.vti"]),
    ("", ["study", "init", "study"]),
    ("plot", ["view", "c.nc", "height"]),
    ("maps", ["info", str(STEEL.with_suffix(".gwy"))]),
    ("maps", ["run", str(STEEL), "--material", "100Cr6", "--mean-pressure", "50MPa", "--out", "steel"]),
)
"""Extra that a command needs, and the command."""

pytestmark = pytest.mark.xdist_group("wheel")  # what is built and installed is shared


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

    def share_machine_code(self):
        """Copy the machine code of the project, which numba takes for modules of the same size and time."""
        for path in (ROOT / "src").rglob("*.*"):
            copy = self.packages / path.relative_to(ROOT / "src")
            if path.suffix == ".py":
                shutil.copystat(path, copy)
            elif path.suffix in (".nbi", ".nbc"):
                copy.parent.mkdir(exist_ok=True)
                shutil.copy(path, copy)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Paths of the source distribution and of the wheel."""
    return build(tmp_path_factory.mktemp("built"))


@pytest.fixture(scope="module")
def shared(built, tmp_path_factory):
    """An environment with the wheel and the packages of the environment of the tests."""
    environment = Environment(tmp_path_factory.mktemp("shared"), "--without-pip")
    environment.share_packages()
    pip = [sys.executable, "-m", "pip", "--python", str(environment.scripts / "python")]
    subprocess.run([*pip, "install", "--quiet", "--no-deps", "--no-index", str(built[1])], check=True)
    environment.share_machine_code()
    return environment


def test_the_version_is_the_same_everywhere(built):
    version = re.escape(asperity.__version__)
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == asperity.__version__
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(r"^## (\S+)", changes, re.M)[1] == asperity.__version__
    assert all(re.match(rf"asperity-{version}(\.tar\.gz|-py3-none-any\.whl)$", path.name) for path in built)


def test_both_distributions_hold_every_file(built):
    source, wheel = built
    package = ROOT / "src/asperity"
    needed = {
        path.relative_to(package.parent).as_posix()
        for path in package.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    with zipfile.ZipFile(wheel) as archive:
        assert needed <= set(archive.namelist())
    with tarfile.open(source) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {f"src/{name}" for name in needed} <= names


def test_the_commands_are_accepted():
    for _, command in COMMANDS:
        parse(command)


def test_commands_work_outside_the_project(shared):
    for found in (shared.run("python", "-c", RESULTS), shared.run("asperity", "verify", "c.nc", "t.nc")):
        assert found.returncode == 0, found.stderr
    where = shared.run("python", "-c", "import asperity; print(asperity.__file__, asperity.__version__)")
    assert str(shared.packages) in where.stdout
    assert where.stdout.endswith(f" {asperity.__version__}\n")


def test_the_study_of_the_wheel_can_be_planned(shared):
    folder = shared.folder / "paper"
    found = shared.run("asperity", "study", "init", "paper")
    assert found.returncode == 0, found.stderr
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for part in project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]:
        files = [path for path in (ROOT / part, *(ROOT / part).rglob("*")) if path.is_file()]
        names = [path.relative_to(ROOT) for path in files if "__pycache__" not in path.parts]
        assert names
        assert all(filecmp.cmp(ROOT / name, folder / name, shallow=False) for name in names)
    planned = shared.run("python", "-m", "snakemake", "--dry-run", "--quiet", "rules", folder=folder)
    assert planned.returncode == 0, planned.stdout + planned.stderr


@pytest.mark.wheel
@pytest.mark.parametrize("extra", ["", "plot", "maps"])
def test_commands_work_or_name_the_missing_extra(built, tmp_path, extra):
    environment = Environment(tmp_path)
    install(environment, built, extra)
    extras = [*PACKAGES, *ALTERNATIVES]
    made = environment.run("python", "-c", RESULTS)
    assert made.returncode == 0, made.stderr
    for needed, command in COMMANDS:
        found = environment.run("asperity", *command)
        if extras.index(needed) <= extras.index(extra):
            assert found.returncode == 0, f"{command}: {found.stderr}"
        else:
            assert found.returncode == 1
            assert re.fullmatch(rf'asperity: not installed: .*"asperity\[{needed}\]"\n', found.stderr)


@pytest.mark.wheel
def test_a_study_of_the_wheel_runs(built, tmp_path):
    environment = Environment(tmp_path)
    install(environment, built, "study")
    environment.run("asperity", "study", "init", "study")
    folder = environment.folder / "study"
    tiny = ROOT / "tests/workflow/tiny.yaml"
    options = ["--cores", "2", "--configfile", "config/quick.yaml", str(tiny)]
    found = environment.run("snakemake", *options, folder=folder)
    assert found.returncode == 0, found.stdout + found.stderr
    results = [*(f"figures/fig{number:02d}.png" for number in range(1, 19)), "claims.md", "claims.csv"]
    assert all((folder / "results/tiny" / name).stat().st_size > 1000 for name in results)


def install(environment, built, extra):
    """Install the wheel with an extra from the package index."""
    wheel = f"asperity{f'[{extra}]' if extra else ''} @ {built[1].as_uri()}"
    found = environment.run("python", "-m", "pip", "install", "--quiet", wheel)
    assert found.returncode == 0, found.stderr
