"""What a notebook user guesses: representations, plot, section, files, and dataset.asperity."""

from __future__ import annotations

import base64
import re
from io import BytesIO

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

import asperity as asp
from asperity.core import markup
from asperity.engineering import Body, run


@pytest.fixture(autouse=True)
def _without_a_screen():
    with mpl.rc_context({"backend": "agg"}):
        yield


HEIGHT = asp.self_affine((48, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=(1.5e-4, 2e-4))
STEEL = asp.Layer(210e9, 0.3)


@pytest.fixture(scope="module")
def contact():
    return asp.solve(HEIGHT, STEEL, (1.5e-4, 2e-4), mean_pressure=50e6)


@pytest.fixture(scope="module")
def stress(contact):
    return asp.analyse_stress(contact, quantities=("von_mises",)).assign_attrs(unit_system="SI")


@pytest.fixture(scope="module")
def objects(contact):
    surface = asp.HeightMap(HEIGHT, (1.5e-4, 2e-4), periodic=True, unit="m", name="a <b>")
    bronze = asp.Layer(110e9, 0.34, height=1e-3, bottom="free", lateral="free")
    return {
        "Contact": contact,
        "Layer": bronze,
        "TwoBodies": asp.TwoBodies(STEEL, bronze),
        "Certificate": contact.certificate,
        "LoadedSolid": asp.LoadedSolid(contact.pressure, contact.grid, STEEL),
        "HeightMap": surface,
        "Answer": run(surface, Body(young=210e9, poisson=0.3), mean_pressure=50e6),
    }


NAMES = ("Contact", "Layer", "TwoBodies", "Certificate", "LoadedSolid", "HeightMap", "Answer")


@pytest.mark.parametrize("name", NAMES)
def test_the_representation_is_one_line_and_a_small_table(objects, name):
    text, page = repr(objects[name]), objects[name]._repr_html_()
    assert text.strip("<").startswith(name)
    assert "\n" not in text
    assert len(text) < 250
    opened, closed = re.findall(r"<(\w+)", page), re.findall(r"</(\w+)>", page)
    pictures = opened.count("img")  # the only tag without an end
    assert sorted(opened) == sorted(closed + ["img"] * pictures)
    assert pictures == (name in ("Contact", "LoadedSolid", "HeightMap", "Answer"))
    assert 3 <= opened.count("tr") < 40


def test_the_representation_of_a_layer_makes_it_again(objects):
    for name in ("Layer", "TwoBodies"):
        assert eval(repr(objects[name]), {"Layer": asp.Layer, "TwoBodies": asp.TwoBodies}) == objects[name]


def test_names_are_escaped_and_pictures_optional(objects, monkeypatch):
    assert "a &lt;b&gt;" in objects["HeightMap"]._repr_html_()
    monkeypatch.setattr(markup, "find_spec", lambda name: None)
    assert "<img" not in objects["Contact"]._repr_html_()


def test_a_picture_is_small_and_keeps_the_largest_value():
    values = np.zeros((700, 1500))
    values[699, 1400] = 1.0
    data = re.search(r"base64,([^\"]+)", markup.picture(values, "p"))[1]
    assert len(data) < 20_000
    brightness = imread(BytesIO(base64.b64decode(data)))[..., :3].sum(axis=2)
    assert brightness.min() < 0.1 * brightness.max()  # one dark pixel on a light ground
    assert np.count_nonzero(brightness < brightness.max()) == 1
    for shape in ((1, 5), (3, 1000), (2, 2)):
        assert "<img" in markup.picture(np.ones(shape), "p")


def test_a_contact_plots_itself_and_its_section(contact):
    assert len(contact.plot().axes) == 2
    section = contact.section("y", at=1e-4, depths=[0.0, 2e-6], fields=("zz",))
    assert dict(section.sizes) == {"poisson": 1, "depth": 2, "y": 48}
    xr.testing.assert_equal(
        section, asp.stress_section(contact, along="y", at=1e-4, depths=[0.0, 2e-6], fields=("zz",))
    )


def test_a_contact_is_a_file_that_gives_the_same_section(contact, tmp_path):
    contact.to_netcdf(tmp_path / "contact.nc")
    found = asp.read_result(tmp_path / "contact.nc")
    np.testing.assert_array_equal(found["pressure"], contact.pressure)
    assert found["pressure"].attrs["units"] == "Pa"
    section = found.asperity.section("x", depths=[0.0, 2e-6])
    expected = contact.section("x", depths=[0.0, 2e-6])
    np.testing.assert_allclose(section["von_mises"], expected["von_mises"], rtol=1e-12)
    assert len(found.asperity.plot().axes) == 2


def test_files_hold_the_lower_solid(tmp_path):
    layer = asp.Layer(2e9, 0.45, height=4e-5, bottom="bonded", lateral="free")
    pair = asp.TwoBodies(lower=layer, upper=STEEL)
    for solid in (layer, pair):
        contact = asp.solve(HEIGHT, solid, (1.5e-4, 2e-4), mean_pressure=1e6)
        data = contact.to_dataset()
        pressed = asp.LoadedSolid.from_dataset(data)
        assert (pressed.layer.poisson, pressed.layer.height) == (0.45, 4e-5)
        assert (pressed.layer.bottom, pressed.layer.lateral) == ("bonded", "free")
        section = data.asperity.section(depths=[0.0, 1e-5])
        np.testing.assert_allclose(
            section["von_mises"], contact.section(depths=[0.0, 1e-5])["von_mises"], rtol=1e-9
        )


def test_the_stress_dataset_plots_and_is_a_file(stress, tmp_path):
    assert repr(stress.asperity) == "<result of stage stress: plot(), peaks()>"
    assert stress.asperity.plot("von_mises").axes
    assert stress.asperity.peaks("von_mises", selection="under_contact").sizes["peak"] > 0
    stress.to_netcdf(tmp_path / "plain.nc")
    xr.testing.assert_allclose(xr.load_dataset(tmp_path / "plain.nc"), stress)
    asp.write_result(stress, tmp_path / "stress.nc", "Stress")
    xr.testing.assert_equal(asp.read_result(tmp_path / "stress.nc"), stress)


@pytest.mark.parametrize(
    ("method", "message"),
    [
        ("section", "section: a result of stage contact is needed, not of stress"),
        ("plot", "plot: a result of stage surface or contact or stress is needed, not of none"),
    ],
)
def test_impossible_methods_are_refused_in_one_line(stress, method, message):
    data = stress if method == "section" else xr.Dataset({"a": 1})
    with pytest.raises(ValueError, match=message):
        getattr(data.asperity, method)()
