"""The command line: a chain of one-off commands, files that the figures accept, one-line errors."""

import os
import subprocess
import sys

import numpy as np
import pytest
from bad_input import SMALL, make_chain
from project import ROOT, hide

from asperity.cli.main import main
from asperity.results import dataset
from asperity.runtime.preflight import BASE_PACKAGES, PACKAGES


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The results of one chain: surface, contact, stress, statistics."""
    return make_chain(tmp_path_factory.mktemp("chain"))


def test_the_results_are_files_of_the_study(files):
    contact, stress = dataset.read(files["contact"]), dataset.read(files["stress"])
    assert float(contact["area_fraction"]) == pytest.approx(0.2, abs=1e-3)  # one node of 64²
    assert stress["poisson"].values.tolist() == [0.0, 0.33]
    settings = dataset.settings_of(dataset.read(files["statistics"]))
    assert settings["surface"] == SMALL
    assert settings["contact"]["area_fraction"] == 0.2
    assert settings["seed"] == [1]


def test_the_surface_is_found_again_in_the_contact(files):
    surface, statistics = dataset.read(files["surface"]), dataset.read(files["statistics"])
    for name in ("skewness", "kurtosis", "rms_gradient"):
        assert float(statistics[f"member_{name}"][0]) == pytest.approx(float(surface[name]), rel=1e-9)


@pytest.mark.parametrize(
    ("figure", "stages"),
    [
        ("6", ["surface", "statistics"]),
        ("7", ["contact"]),
        ("fig09", ["statistics"]),
        ("14", ["statistics"]),
        ("17", ["statistics"]),
    ],
)
def test_the_figures_of_the_study_are_drawn_from_them(files, tmp_path, figure, stages):
    pictures = [tmp_path / "figure.png", tmp_path / "figure.pdf"]
    code = main(["plot", figure, *(files[stage] for stage in stages), "--out", *map(str, pictures)])
    assert code == 0
    assert all(picture.stat().st_size > 3000 for picture in pictures)


def test_peaks_prints_what_it_counted(files, capsys, tmp_path):
    main(["peaks", files["stress"], "--contact", files["contact"], "--out", str(tmp_path / "again.nc")])
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("von_mises") for line in lines)
    assert dataset.read(tmp_path / "again.nc").identical(dataset.read(files["statistics"]))


def test_a_height_map_is_pressed_face_down(tmp_path, capsys):
    pytest.importorskip("SurfaceTopography")
    height = np.cos(2 * np.pi * np.arange(16) / 16)
    path, out = tmp_path / "waves.asc", tmp_path / "contact.nc"
    header = "# Channel: Height\n# Width: 16 m\n# Height: 16 m\n# Value units: m\n"
    rows = [" ".join(f"{0.01 * (a + b):.9f}" for b in height) for a in height]
    path.write_text(header + "\n".join(rows) + "\n")
    assert main(["solve", str(path), "--out", str(out)]) == 1
    assert "set periodic to mirrored, windowed or declared" in capsys.readouterr().err
    assert main(["solve", str(path), "--periodic", "declared", "--out", str(out)]) == 0
    pressure = dataset.read(out)["pressure"].values
    assert np.unravel_index(pressure.argmax(), pressure.shape) == (0, 0)
    assert dataset.settings_of(dataset.read(out))["surface"]["label"] == "waves"


def test_a_layer_has_the_ratio_of_its_contact_alone(files, tmp_path, capsys):
    thin = str(tmp_path / "thin.nc")
    assert main(["solve", files["surface"], "--layer-height", "0.1", "--out", thin]) == 0
    assert dataset.read(thin).attrs["solid"] == "layer, bonded bottom"
    assert main(["stress", thin, "--poisson", "0.2", "--out", str(tmp_path / "stress.nc")]) == 1
    assert "which has that one only" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["", "solve", "stress", "peaks", "plot", "plan"])
def test_every_command_has_help(capsys, command):
    with pytest.raises(SystemExit) as stopped:
        main([*command.split(), "--help"])
    assert stopped.value.code == 0
    assert "None" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "command"),
    [
        *((name, "--version") for name in BASE_PACKAGES),
        ("yaml", "plan {}"),
        ("matplotlib", "plot 9 a.nc --out b.png"),
    ],
)
def test_a_missing_package_is_one_line(tmp_path, name, command):
    path = os.pathsep.join([str(hide(name, tmp_path / "dark")), str(ROOT / "src")])
    found = subprocess.run(
        [sys.executable, "-m", "asperity.cli.main", *command.split()],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert found.returncode == 1
    assert found.stderr == (
        f"asperity: not installed: {PACKAGES[name]}; install everything with: "
        "pip install --requirement requirements.lock\n"
    )
    assert not found.stdout
