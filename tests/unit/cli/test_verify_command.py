"""``asperity verify``: contacts of all solids fulfil their certificates; what was changed is named."""

import json
import shutil

import numpy as np
import pytest
from samples import load_of, rough

import asperity as asp
from asperity.cli.main import main
from asperity.engineering.contact_numbers import stored_certificate

STEEL, LAYER = asp.Solid(2.1, 0.3), asp.Solid(0.7, 0.4, height=0.1, bottom="frictionless")
COATED = asp.Solid(4.0, 0.25, height=0.02, base=STEEL)


@pytest.mark.parametrize(
    ("solid", "settings"),
    [
        (LAYER, {}),
        (STEEL, {"boundary": "free"}),
        (STEEL, {"hardness": 0.05}),
        (STEEL, {"dtype": "float32", "rtol": 1e-4}),
        (asp.TwoBodies(COATED, LAYER), {}),
        (asp.TwoBodies(LAYER, STEEL), {"method": "gfmd"}),
    ],
)
def test_file_has_the_certificate_of_the_solver(tmp_path, solid, settings):
    """Heights far from zero leave a rounding of their level: 5 ε over the rms height of 1e-3."""
    level, rounding = (0.0, 2e-5) if "dtype" in settings else (5.0, 1e-9)
    contact = asp.solve_contact(rough() + level, solid, mean_pressure=load_of(rough()), **settings)
    contact.to_netcdf(tmp_path / "contact.nc")
    found, allowed = stored_certificate(asp.read_result(tmp_path / "contact.nc"))
    for name, value in contact.certificate.violations.items():
        assert found.violations[name] == pytest.approx(value, rel=0.1, abs=rounding), name
        assert found.violations[name] <= allowed[name] < value + rounding, name


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Folder with a map and the answer of its case."""
    folder = tmp_path_factory.mktemp("verify")
    height = asp.self_affine((32, 32), 0.8, 16.0, 4.0, rms_height=0.1, seed=1, length=32.0)
    np.savetxt(
        folder / "map.txt", height, header="# Width: 32 um\n# Height: 32 um\n# Value units: um", comments=""
    )
    words = ["run", "map.txt", "--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "50 MPa"]
    with pytest.MonkeyPatch.context() as there:
        there.chdir(folder)
        assert main([*words, "--out", "out"]) == 0
    return folder


def rewrite(folder, name, **attributes):
    """Write a result again with attributes, and the checksum of the folder with it."""
    from asperity.core.system import sha256_of

    found = asp.read_result(folder / name).assign_attrs(attributes)
    if name == "contact.nc":
        found["pressure"] *= 1.0001
    asp.write_result(found, folder / name, "Another")
    sums = json.loads((folder / ".asperity-run.json").read_text()) | {name: sha256_of(folder / name)}
    (folder / ".asperity-run.json").write_text(json.dumps(sums))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda out: (out / "peaks.csv").write_text("1"), "out/peaks.csv: changed since it was written"),
        (lambda out: (out / "plane.png").unlink(), "out/plane.png: missing"),
        (lambda out: (out.parent / "map.txt").write_text("1"), "map.txt: changed since out was computed"),
        (lambda out: (out.parent / "map.txt").unlink(), "map.txt: no such file"),
        (lambda out: rewrite(out, "stress.nc", source="asperity 0.1"), "out: results of one version"),
        (lambda out: rewrite(out, "stress.nc", settings="{}"), "out: results of one settings"),
        (lambda out: rewrite(out, "contact.nc"), "out/contact.nc: load imbalance = 0.0001: at most"),
        (
            lambda out: (out / ".asperity-run.json").write_text('["peaks.csv"]'),
            "out: no answer of asperity run",
        ),
        (lambda out: (out / ".asperity-run.json").unlink(), "out: no answer of asperity run"),
    ],
)
def test_every_change_of_an_answer_is_named(original, tmp_path, monkeypatch, capsys, change, message):
    shutil.copytree(original, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    assert main(["verify", "out", "out/surface.nc"]) == 0
    assert "out/contact.nc: certificate computed anew: its conditions" in capsys.readouterr().out
    change(tmp_path / "out")
    with pytest.raises(SystemExit, match="1"):
        main(["verify", "out"])
    assert f"asperity: {message}" in capsys.readouterr().err
