"""Sections and boxes against the planes of the stress on the full grid."""

import numpy as np
import pytest
from samples import refuses, spots

import asperity as asp
from asperity.stress import section
from asperity.stress.planes.fields import FIELDS
from asperity.stress.section import stress_box, stress_section

DEPTHS = [0.0, 0.01, 0.05, 0.2]
SHAPE, LENGTH = (96, 120), (0.8, 1.0)


def full(contact, depths, poisson, names=FIELDS, **settings):
    """Fields of all planes on the grid of the contact, (ratios, planes, ny, nx) each."""
    planes = list(asp.stress_planes(contact, depths, poisson, names, 0, **settings))
    return {name: np.stack([plane.fields[name] for plane in planes], axis=1) for name in names}


@pytest.mark.parametrize(("boundary", "error"), [("periodic", 1e-6), ("free", 1e-4)])
@pytest.mark.parametrize("settings", [{}, {"friction": 0.3, "sliding_direction": "y"}])
def test_section_is_a_line_of_every_plane(boundary, error, settings):
    contact, ratios = spots(SHAPE, LENGTH, boundary=boundary), [0.0, 0.4]
    expected = full(contact, DEPTHS, ratios, **settings)
    along_x = stress_section(contact, "x", 40 * 0.8 / 96, DEPTHS, FIELDS, ratios, tolerance=1e-6, **settings)
    along_y = stress_section(contact, "y", 50 / 120, DEPTHS, FIELDS, ratios, tolerance=1e-6, **settings)
    assert along_x["von_mises"].dims == ("poisson", "depth", "x")
    assert float(along_x["y"]) == pytest.approx(40 * 0.8 / 96)
    allowed = error * np.abs(expected["zz"]).max()
    for name in FIELDS:
        for found, lines in ((along_x, expected[name][:, :, 40]), (along_y, expected[name][..., 50])):
            np.testing.assert_allclose(found[name].values, lines, rtol=0, atol=allowed)


@pytest.mark.parametrize("nodes", [95, 96])
def test_section_between_nodes_is_trigonometric(nodes):
    """Against the pressure on twice the rows, without its Nyquist modes, which decay to 1e-6 there."""
    contact = spots((nodes, 120), LENGTH)
    modes = np.fft.rfft2(contact.pressure)
    padded = np.zeros((2 * nodes, modes.shape[1]), complex)
    above, below = (nodes + 1) // 2, (nodes - 1) // 2
    padded[:above], padded[-below:] = modes[:above], modes[-below:]
    padded[:, -1] = 0
    pressure = np.fft.irfft2(padded, s=(2 * nodes, 120)) * 2
    smooth = asp.LoadedSolid(pressure, asp.Grid(pressure.shape, LENGTH), contact.layer)
    between = stress_section(contact, "x", 81 * 0.4 / nodes, [0.05, 0.1], ("xx", "xz"), tolerance=0)
    for name, expected in full(smooth, [0.05, 0.1], 0.3, ("xx", "xz")).items():
        np.testing.assert_allclose(between[name].values, expected[:, :, 81], atol=1e-6)


@pytest.mark.parametrize("layer", [asp.Solid(1.0, 0.3), asp.Solid(1.0, 0.4, 0.3)])
def test_box_holds_the_nodes_asked_for(layer):
    contact = spots(SHAPE, LENGTH, layer)
    data = stress_box(contact, DEPTHS, y=(0.1, 0.5), x=(0.2, 0.7), fields=("von_mises", "xx")).dataset()
    expected = full(contact, DEPTHS, None, ("von_mises", "xx"))
    np.testing.assert_allclose(data["y"], np.arange(12, 61) / 120)
    np.testing.assert_allclose(data["x"], np.arange(24, 85) / 120)
    for name, field in expected.items():
        np.testing.assert_allclose(data[name].values, field[..., 12:61, 24:85], rtol=0, atol=1e-5)
    coarse = stress_box(contact, [0.05], spacing=1 / 24, fields=("xx",)).dataset()["xx"].values[:, 0]
    np.testing.assert_allclose(coarse, expected["xx"][:, 2, ::5, ::5][:, : coarse.shape[1]], atol=1e-5)


def test_box_is_streamed_and_too_large_refused(monkeypatch):
    box = stress_box(spots(SHAPE, LENGTH), np.linspace(0, 1, 1000), fields=("von_mises",))
    stream = box.planes()
    assert next(stream)["von_mises"].shape == (1, 96, 120)
    stream.close()
    monkeypatch.setattr(section, "LARGEST_DATASET", 2**20)
    with pytest.raises(ValueError, match=r"^box of 1000 × 96 × 120 nodes: 0\.1 GiB, at most"):
        box.dataset()


SOLID = spots((8, 10), LENGTH)


test_wrong_section_or_box_is_refused = refuses(
    (lambda: stress_section(SOLID, "z"), "along = 'z': one of x, y is needed"),
    (lambda: stress_section(SOLID, at=0.9), r"at = 0\.9: a position from 0 to 0\.8 is needed"),
    (lambda: stress_section(SOLID, fields=("mises",)), "fields = 'mises': names from xx"),
    (lambda: stress_section(SOLID, depths=[0.1, 0.1]), r"depths\[1\] = 0\.1: more than"),
    (lambda: stress_box(SOLID, [0.0], y=(0.5, 0.1)), r"y = \(0\.5, 0\.1\): a pair \(first, last\) of rising"),
    (lambda: stress_box(SOLID, [0.0], x=0.5), r"x = 0\.5: a pair"),
    (lambda: stress_box(SOLID, [0.0], x=(0.0, 2.0)), r"x = 2\.0: a pair"),
    (lambda: stress_box(SOLID, [0.0], spacing=0.0), r"spacing = 0\.0: a number of at least"),
)
