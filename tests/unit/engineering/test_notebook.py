"""What a notebook shows of objects, and the files of contacts and stresses."""

import base64
import re
from io import BytesIO
from pathlib import Path

import nbformat
import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

import asperity as asp
from asperity import Body, run
from asperity.core import markup

ROOT = Path(__file__).parents[3]
LENGTH = (1.5e-4, 2e-4)
HEIGHT = asp.self_affine((48, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=LENGTH)
STEEL, SHEET = asp.Solid(210e9, 0.3), asp.Solid(110e9, 0.34, height=1e-3, bottom="free", lateral="free")


@pytest.fixture(scope="module")
def contact():
    return asp.solve_contact(HEIGHT, STEEL, LENGTH, mean_pressure=50e6)


@pytest.fixture(scope="module")
def stress(contact):
    return asp.analyse_stress(contact, quantities=("von_mises",)).assign_attrs(unit_system="SI")


@pytest.fixture(scope="module")
def objects(contact):
    surface = asp.HeightMap(HEIGHT, LENGTH, periodic=True, unit="m", name="a <b>")
    body = asp.LoadedSolid(contact.pressure, contact.grid, STEEL)
    answer = run(surface, Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    found = [contact, SHEET, asp.TwoBodies(STEEL, SHEET), contact.certificate, body, surface, answer]
    return {type(each).__name__: each for each in found}


def test_representation_is_a_line_and_a_small_table(objects):
    for name, each in objects.items():
        text, page = repr(each), each._repr_html_()
        assert text.strip("<").startswith(name)
        assert "\n" not in text
        assert len(text) < 250
        opened, closed = re.findall(r"<(\w+)", page), re.findall(r"</(\w+)>", page)
        pictures = opened.count("img")  # the only tag without an end
        assert sorted(opened) == sorted(closed + ["img"] * pictures)
        assert pictures == (name in ("Contact", "LoadedSolid", "HeightMap", "Answer"))
        assert 3 <= opened.count("tr") < 40


def test_representation_of_a_solid_makes_it_again():
    for solid in (SHEET, asp.TwoBodies(STEEL, SHEET)):
        assert eval(repr(solid), {"Solid": asp.Solid, "TwoBodies": asp.TwoBodies}) == solid


def test_notebook_runs(tmp_path):
    """In a kernel of its own, its first cell as on Binder, where asperity is installed."""
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(ROOT / "examples/try_asperity.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute(cwd=tmp_path)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert sum("image/png" in output.get("data", ()) for output in outputs) == 3
    texts = "".join(output.get("data", {}).get("text/plain", "") for output in outputs)
    for shown in ("Contact of 256", "von Mises (MPa)", "<Answer"):
        assert shown in texts


def test_names_are_escaped_and_pictures_optional(objects, monkeypatch):
    assert "a &lt;b&gt;" in objects["HeightMap"]._repr_html_()
    monkeypatch.setattr(markup, "find_spec", lambda name: None)
    assert "<img" not in objects["Contact"]._repr_html_()


def test_picture_is_small_and_keeps_the_largest_value():
    values = np.zeros((700, 1500))
    values[699, 1400] = 1.0
    data = re.search(r"base64,([^\"]+)", markup.picture(values, "p"))[1]
    assert len(data) < 20_000
    brightness = imread(BytesIO(base64.b64decode(data)))[..., :3].sum(axis=2)
    assert brightness.min() < 0.1 * brightness.max()  # one dark pixel on a light ground
    assert np.count_nonzero(brightness < brightness.max()) == 1
    for shape in ((1, 5), (3, 1000), (2, 2)):
        assert "<img" in markup.picture(np.ones(shape), "p")


LAYER = asp.Solid(2e9, 0.45, height=4e-5, lateral="free")


@pytest.mark.parametrize("solid", [STEEL, LAYER, asp.TwoBodies(lower=LAYER, upper=STEEL)])
def test_file_of_a_contact_gives_the_same_section(solid, tmp_path):
    """It holds the lower solid."""
    contact = asp.solve_contact(HEIGHT, solid, LENGTH, mean_pressure=1e6)
    contact.to_netcdf(tmp_path / "contact.nc")
    found = asp.read_result(tmp_path / "contact.nc")
    np.testing.assert_array_equal(found["pressure"], contact.pressure)
    assert found["pressure"].attrs["units"] == "Pa"
    body, layer = contact.in_body("lower"), asp.LoadedSolid.from_dataset(found).layer
    for name in ("poisson", "height", "bottom", "lateral"):
        assert getattr(layer, name) == getattr(body.layer, name)
    chosen = {"along": "y", "at": 1e-4, "depths": [0.0, 2e-6]}
    expected = asp.stress_section(body, **chosen)
    assert dict(expected.sizes) == {"poisson": 1, "depth": 2, "y": 48}
    section = asp.stress_section(asp.LoadedSolid.from_dataset(found), **chosen)
    np.testing.assert_allclose(section["von_mises"], expected["von_mises"], rtol=1e-9)
    assert len(asp.views.plot_pressure(contact).axes) == len(asp.views.plot_pressure(found).axes) == 2


def test_stress_dataset_is_a_file(stress, tmp_path):
    stress.to_netcdf(tmp_path / "plain.nc")
    xr.testing.assert_allclose(xr.load_dataset(tmp_path / "plain.nc"), stress)
    asp.write_result(stress, tmp_path / "stress.nc", "Stress")
    xr.testing.assert_equal(asp.read_result(tmp_path / "stress.nc"), stress)
