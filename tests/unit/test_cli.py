"""The command line: a chain of one-off commands, files that the figures accept, one-line errors."""

import numpy as np
import pytest

from asperity import dataset
from asperity.cli import main
from asperity.study.surface import make_surface

PARAMETERS = {
    "label": "small",
    "hurst": 0.8,
    "wavelength_long": 0.5,
    "wavelength_short": 0.125,
    "rms_height": 1e-3,
    "points": 64,
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The results of one chain: surface, contact, body, statistics."""
    folder = tmp_path_factory.mktemp("chain")
    paths = {
        stage: str(folder / f"{stage}.nc") for stage in ("surface", "contact", "body", "statistics", "curve")
    }
    dataset.write(
        make_surface(PARAMETERS, 1),
        paths["surface"],
        title="Rough surface",
        settings={"name": "small", "seed": 1, "surface": PARAMETERS},
    )
    assert main(["solve", paths["surface"], "--area-fraction", "0.2", "--out", paths["contact"]]) == 0
    assert main(["body", paths["contact"], "--poisson", "0.0", "0.33", "--out", paths["body"]]) == 0
    assert main(["peaks", paths["body"], "--contact", paths["contact"], "--out", paths["statistics"]]) == 0
    return paths


def test_the_results_are_files_of_the_study(files):
    contact, body = dataset.read(files["contact"]), dataset.read(files["body"])
    assert float(contact["area_fraction"]) == pytest.approx(0.2, abs=1e-3)  # one node of 64²
    assert body["poisson"].values.tolist() == [0.0, 0.33]
    settings = dataset.settings_of(dataset.read(files["statistics"]))
    assert settings["surface"] == PARAMETERS
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
    main(["peaks", files["body"], "--contact", files["contact"], "--out", str(tmp_path / "again.nc")])
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


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("solve {folder}/none.nc --out {folder}/x.nc", "none.nc: no such file"),
        ("solve {contact} --out {folder}/x.nc", "a result of contact, one of surface is needed"),
        ("solve {surface} --detrend tilt --out {folder}/x.nc", "--detrend: for height maps"),
        ("solve {surface} --precision float32 --tolerance 1e-14 --out {folder}/x.nc", "tolerance"),
        ("body {surface} --out {folder}/x.nc", "a result of surface, one of contact is needed"),
        ("body {folder} --out {folder}/x.nc", "no such file"),
        ("peaks {body} {body} --contact {contact} --out {folder}/x.nc", "one for each body is needed"),
        (
            "plot 7 {statistics} --out {folder}/x.png",
            "figure 7: a contact file (of asperity solve) is needed",
        ),
        ("plot 12 {statistics} --out {folder}/x.png", "figure 12 is drawn from the study's validation alone"),
        ("plot 9 {statistics} --out {folder}/x.docx", "docx"),
    ],
)
def test_a_failure_is_one_line_and_leaves_no_file(files, tmp_path, capsys, arguments, line):
    filled = [part.format(folder=tmp_path, **files) for part in arguments.split()]
    assert main(filled) == 1
    error = capsys.readouterr().err
    assert line in error
    assert error.startswith("asperity: ")
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_layer_has_the_ratio_of_its_contact_alone(files, tmp_path, capsys):
    thin = str(tmp_path / "thin.nc")
    assert main(["solve", files["surface"], "--layer-height", "0.1", "--out", thin]) == 0
    assert dataset.read(thin).attrs["solid"] == "layer, bonded bottom"
    assert main(["body", thin, "--poisson", "0.2", "--out", str(tmp_path / "body.nc")]) == 1
    assert "which has that one only" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("", "the following arguments are required"),
        ("solve s.nc", "required: --out"),
        ("solve s.nc --out x.nc --poisson 0.6", "--poisson: '0.6': a number > -1 and ≤ 0.5 is needed"),
        ("solve s.nc --out x.nc --area-fraction ten", "'ten': a number > 0 and ≤ 1 is needed"),
        ("solve s.nc --out x.nc --points 3.5", "'3.5': a whole number ≥ 8 is needed"),
        ("peaks b.nc --contact c.nc --out x.nc --bins 1", "'1': a whole number ≥ 2 is needed"),
        ("plot 19 s.nc --out x.png", "'19': one of 1, 2"),
        ("polish", "invalid choice"),
    ],
)
def test_bad_usage_ends_with_two_and_says_what_is_accepted(capsys, arguments, line):
    with pytest.raises(SystemExit) as stopped:
        main(arguments.split())
    assert stopped.value.code == 2
    assert line in capsys.readouterr().err


@pytest.mark.parametrize("command", ["", "solve", "body", "peaks", "plot"])
def test_every_command_has_help(capsys, command):
    with pytest.raises(SystemExit) as stopped:
        main([*command.split(), "--help"])
    assert stopped.value.code == 0
    assert "None" not in capsys.readouterr().out
