"""The command line: commands in a row, files that figures accept, arguments, errors in one line."""

import os
import subprocess
import sys

import numpy as np
import pytest
from project import ROOT, hide

from asperity.cli.main import main
from asperity.core.packages import message
from asperity.results import dataset

COSINE = np.cos(2 * np.pi * np.arange(16) / 16)
HEADER = "# Channel: Height\n# Width: 16 m\n# Height: 16 m\n# Value units: m\n"
WAVES = "".join(" ".join(f"{0.01 * (a + b):.9f}" for b in COSINE) + "\n" for a in COSINE)
"""Height map of waves along x and y, whose highest node is the first."""

STEEL = ROOT / "tests/data/steel.x3p"


def test_closed_streams_take_no_output():
    """As of `>&-`: neither a traceback, nor a file that is opened later in their place."""
    code = f"import os, sys; from asperity.cli.main import main; main(['info', {str(STEEL)!r}]); os.fstat(1)"
    command = ["sh", "-c", '"$0" -c "$1" <&- >&-', sys.executable, code]
    found = subprocess.run(command, capture_output=True, text=True)
    assert (found.returncode, found.stderr) == (0, "")


@pytest.mark.parametrize("fault", [lambda: {}["mean"], lambda: None + 1, lambda: int("x"), lambda: 1 / 0])
def test_own_faults_have_a_traceback(monkeypatch, capsys, fault):
    """A refusal, which a raise statement makes, is one line."""
    monkeypatch.setattr("asperity.cli.commands.info.run", lambda _: fault())
    assert main(["info", str(STEEL)]) == 1
    first, *_, last = capsys.readouterr().err.splitlines()
    assert first.startswith("Traceback")
    assert last.startswith("asperity: an error of asperity itself")


@pytest.mark.parametrize(
    ("figure", "stage"), [("7", "contact"), ("fig09", "statistics"), ("14", "statistics")]
)
def test_figures_of_the_study_are_drawn(chain, tmp_path, figure, stage):
    pictures = [tmp_path / "figure.png", tmp_path / "figure.pdf"]
    assert main(["plot", figure, chain[stage], "--out", *map(str, pictures)]) == 0
    assert all(picture.stat().st_size > 3000 for picture in pictures)


def test_a_height_map_is_pressed_face_down(tmp_path):
    pytest.importorskip("SurfaceTopography")
    path, out = tmp_path / "waves.asc", tmp_path / "contact.nc"
    path.write_text(HEADER + WAVES)
    assert main(["solve", str(path), "--periodic", "declared", "--out", str(out)]) == 0
    pressure = dataset.read(out)["pressure"].values
    assert np.unravel_index(pressure.argmax(), pressure.shape) == (0, 0)
    assert dataset.settings_of(dataset.read(out))["surface"]["label"] == "waves"
    # The force acts on the map, of 16 m x 16 m, and not on its mirror images.
    force = ["--periodic", "mirrored", "--young", "1 GPa", "--force", "256 kN", "--out", str(out)]
    assert main(["solve", str(path), *force]) == 0
    assert float(dataset.read(out)["mean_pressure"]) == pytest.approx(1e3, rel=1e-4)


def test_layer_has_the_ratio_of_its_contact(chain, tmp_path, capsys):
    thin = str(tmp_path / "thin.nc")
    assert main(["solve", chain["surface"], "--layer-height", "0.1", "--out", thin]) == 0
    assert dataset.read(thin).attrs["solid"] == "layer, bonded bottom"
    assert main(["stress", thin, "--poisson", "0.2", "--out", str(tmp_path / "stress.nc")]) == 1
    assert "--poisson 0.2: only 0.33 is accepted" in capsys.readouterr().err


HELP = "import sys; from asperity.cli.parser import make_parser; make_parser('').format_help(); "
FIGURES = "import sys; from asperity.paper.figures import known; known(); "


@pytest.mark.parametrize(("code", "library"), [(HELP, "numpy"), (FIGURES, "matplotlib")])
def test_help_does_not_wait_for_libraries(code, library):
    code += f"sys.exit({library!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize(
    ("name", "command", "program"),
    [
        ("numba", "asperity --version", "asperity"),
        ("yaml", "asperity.settings check config/config.yaml", "config"),
        ("matplotlib", "asperity plot 9 a.nc --out b.png", "asperity"),
        ("SurfaceTopography", f"asperity info {STEEL.with_suffix('.gwy')}", "asperity"),
    ],
)
def test_a_missing_package_is_one_line(tmp_path, name, command, program):
    path = os.pathsep.join([str(hide(tmp_path / "dark", name)), str(ROOT / "src")])
    command, environment = [sys.executable, "-m", *command.split()], os.environ | {"PYTHONPATH": path}
    found = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert (found.returncode, found.stdout, found.stderr) == (1, "", f"{program}: {message([name])}\n")


def test_solve_imposes_pressure_force_and_approach_alike(tmp_path, capsys):
    """In SI units, and as numbers in the units of the study."""
    surface, out = str(tmp_path / "s.nc"), str(tmp_path / "c.nc")
    lengths = ["--wavelength-long", "20um", "--wavelength-short", "10um", "--rms-height", "80nm"]
    main(["surface", "--hurst", "0.8", *lengths, "--length", "80um", "--points", "32", "--out", surface])
    steel = ["--young", "210 GPa", "--poisson", "0.3", "--out", out]
    modulus = 210e9 / (1 - 0.3**2)
    main(["solve", surface, *steel, "--mean-pressure", "50 MPa"])
    wanted = dataset.read(out)
    assert float(wanted["mean_pressure"]) == pytest.approx(50e6, rel=1e-6)
    assert dataset.settings_of(wanted)["contact"]["mean_pressure"] == pytest.approx(50e6)
    approach = float(wanted["approach"] - dataset.read(surface)["height"].min())
    for load in (
        ["--mean-pressure", repr(50e6 / modulus)],
        ["--force", f"{50e6 * 80e-6**2!r} N"],
        ["--approach", f"{approach!r} m"],
        ["--approach", repr(approach / 80e-6)],
    ):
        assert main(["solve", surface, *steel, *load]) == 0
        np.testing.assert_allclose(dataset.read(out)["pressure"], wanted["pressure"], rtol=1e-4, atol=1e3)
    assert f"approach since first touch {1e9 * approach:.4g} nm" in capsys.readouterr().out
