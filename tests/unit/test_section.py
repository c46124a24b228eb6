"""Sections and boxes against the planes of the stress on the full grid."""

import numpy as np
import pytest

from asperity.elasticity.layer import Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Grid
from asperity.stress import section
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.planes import stress_planes
from asperity.stress.section import stress_box, stress_section

DEPTHS = [0.0, 0.01, 0.05, 0.2]


def solid(boundary="periodic", shape=(96, 120), length=(0.8, 1.0), layer=None):
    grid = Grid(shape, length)
    y, x = grid.coordinates()
    draw = np.random.default_rng(7)
    pressure = np.zeros(shape)
    for cy, cx, radius in zip(*draw.uniform(0.2, 0.6, (2, 7)), draw.uniform(0.04, 0.12, 7), strict=True):
        square = (y[:, None] - cy) ** 2 + (x[None, :] - cx) ** 2
        pressure += np.sqrt(np.maximum(1 - square / radius**2, 0))
    return LoadedSolid(pressure, grid, layer or Layer(1.0, 0.3), boundary)


def full(contact, depths, poisson, names=FIELDS, **settings):
    """Fields of all planes on the grid of the contact, (ratios, planes, ny, nx) each."""
    planes = list(stress_planes(contact, depths, poisson, names, 0, **settings))
    return {name: np.stack([plane.fields[name] for plane in planes], axis=1) for name in names}


@pytest.mark.parametrize(("boundary", "error"), [("periodic", 1e-6), ("free", 1e-4)])
@pytest.mark.parametrize("settings", [{}, {"friction": 0.3, "sliding_direction": "y"}])
def test_section_is_a_line_of_every_plane(boundary, error, settings):
    contact, ratios = solid(boundary), [0.0, 0.4]
    expected = full(contact, DEPTHS, ratios, **settings)
    along_x = stress_section(contact, "x", 40 * 0.8 / 96, DEPTHS, FIELDS, ratios, tolerance=1e-6, **settings)
    along_y = stress_section(contact, "y", 50 / 120, DEPTHS, FIELDS, ratios, tolerance=1e-6, **settings)
    assert along_x["von_mises"].dims == ("poisson", "depth", "x")
    assert float(along_x["y"]) == pytest.approx(40 * 0.8 / 96)
    for name in FIELDS:
        scale = np.abs(expected["zz"]).max()
        for found, lines in ((along_x, expected[name][:, :, 40]), (along_y, expected[name][..., 50])):
            np.testing.assert_allclose(found[name].values, lines, rtol=0, atol=error * scale)


def test_section_goes_through_the_largest_pressure():
    contact = solid()
    through = stress_section(contact, depths=DEPTHS, fields=("zz",))
    row = np.unravel_index(contact.pressure.argmax(), contact.pressure.shape)[0]
    assert float(through["y"]) == pytest.approx(row * contact.grid.spacing[0])
    assert through["zz"].values[0, 0].min() == pytest.approx(-contact.pressure.max(), rel=1e-12)


@pytest.mark.parametrize("nodes", [95, 96, 100])
def test_section_between_nodes_is_trigonometric(nodes):
    contact, fine = solid(shape=(nodes, 120)), solid(shape=(2 * nodes, 120))
    modes = np.fft.rfft2(contact.pressure)
    padded = np.zeros((2 * nodes, modes.shape[1]), complex)
    above, below = (nodes + 1) // 2, (nodes - 1) // 2
    padded[:above], padded[-below:] = modes[:above], modes[-below:]
    padded[:, -1] = 0
    smooth = LoadedSolid(np.fft.irfft2(padded, s=(2 * nodes, 120)) * 2, fine.grid, fine.layer)
    between = stress_section(contact, "x", 81 * 0.4 / nodes, [0.05, 0.1], ("xx", "xz"), tolerance=0)
    expected = full(smooth, [0.05, 0.1], 0.3, ("xx", "xz"))
    for name in ("xx", "xz"):  # the Nyquist modes have decayed to 1e-6 there
        np.testing.assert_allclose(between[name].values, expected[name][:, :, 81], atol=1e-6)


@pytest.mark.parametrize("layer", [None, Layer(1.0, 0.4, 0.3)])
def test_box_holds_the_nodes_asked_for(layer):
    contact = solid(layer=layer)
    box = stress_box(contact, DEPTHS, y=(0.1, 0.5), x=(0.2, 0.7), fields=("von_mises", "xx"))
    data = box.dataset()
    expected = full(contact, DEPTHS, None, ("von_mises", "xx"))
    rows, columns = np.rint(data["y"] * 120).astype(int).values, np.rint(data["x"] * 120).astype(int).values
    np.testing.assert_allclose(data["y"], 0.1 + np.arange(rows.size) / 120)
    assert (rows[0], columns[0], columns[-1]) == (12, 24, 84)
    for name in ("von_mises", "xx"):
        part = expected[name][:, :, rows][..., columns]
        np.testing.assert_allclose(data[name].values, part, rtol=0, atol=1e-5)
    coarse = stress_box(contact, [0.05], spacing=1 / 24, fields=("xx",)).dataset()
    np.testing.assert_allclose(
        coarse["xx"][:, 0], expected["xx"][:, 2, ::5, ::5][:, : coarse.sizes["y"]], atol=1e-5
    )


def test_box_is_streamed_and_too_large_a_dataset_is_refused(monkeypatch):
    box = stress_box(solid(), np.linspace(0, 1, 1000), fields=("von_mises",))
    stream = box.planes()
    assert next(stream)["von_mises"].shape == (1, 96, 120)
    stream.close()
    monkeypatch.setattr(section, "LARGEST_DATASET", 2**20)
    with pytest.raises(ValueError, match=r"^box of 1000 × 96 × 120 nodes: 0\.1 GiB, at most"):
        box.dataset()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"along": "z"}, "along = 'z': one of x, y is needed"),
        ({"at": 0.9}, r"at = 0\.9: a position from 0 to 0\.8 is needed"),
        ({"at": "0.1"}, r"at = '0\.1': a position"),
        ({"fields": ("mises",)}, "fields = 'mises': names from xx"),
        ({"depths": [0.1, 0.1]}, r"depths\[1\] = 0\.1: more than"),
    ],
)
def test_bad_section_names_argument_value_and_range(changes, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        stress_section(solid(), **changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"y": (0.5, 0.1)}, r"y = \(0\.5, 0\.1\): a pair \(first, last\) of rising positions from 0 to 0\.8"),
        ({"x": 0.5}, r"x = 0\.5: a pair"),
        ({"x": (0.0, 2.0)}, r"x = 2\.0: a pair"),
        ({"spacing": 0.0}, r"spacing = 0\.0: a number of at least"),
    ],
)
def test_bad_box_names_argument_value_and_range(changes, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        stress_box(solid(), [0.0], **changes)
