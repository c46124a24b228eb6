"""Maps that repeat along one axis and end along the other one, such as a roller."""

import numpy as np
import pytest
from samples import HALF_SPACE, LAYER, centred, difference, refuses, rough
from scipy.special import k0

import asperity as asp
from asperity.contact import verify_contact
from asperity.elasticity.loaded_rectangle import (
    PaddedFourier,
    compliance_modes,
    padded_grid,
    rectangle_compliance,
    slope_modes,
    surface_influence,
)
from asperity.reference.hertz import LineHertz

ACROSS = {"y": ("periodic", "free"), "x": ("free", "periodic")}
"""Axis along which a map repeats → boundary."""


def images(y, x, grid):
    """Compliance of a node and its images along y, summed one by one; E* = 1.

    The images beyond the Nth are a strip less a long rectangle, to O(1/N²), which is extrapolated to N → ∞.
    """
    (dy, dx), (period, width) = grid.spacing, grid.length

    def part(count):
        places = y + period * np.arange(-count, count + 1)
        mean = 2 * dx * dy / period * np.log((2 * count + 1) * period / width) / np.pi
        return rectangle_compliance(places, np.full(places.size, x), (dy, dx), 1.0).sum() - mean

    one, two, four = part(4000), part(8000), part(16000)
    first, second = two + (two - one) / 3, four + (four - two) / 3
    return second + (second - first) / 15


@pytest.mark.parametrize(
    ("shape", "length"),
    [((8, 8), (1.0, 1.0)), ((5, 12), (3.0, 0.5)), ((1, 6), (1.0, 1.0)), ((64, 32), (1.0, 0.5))],
)
def test_compliance_is_the_sum_over_images(shape, length):
    """The sum one by one converges to about 1e-11."""
    grid, turned = asp.Grid(shape, length), asp.Grid(shape[::-1], length[::-1])
    y, x = grid.spacing[0] * np.arange(shape[0] // 2 + 1), grid.spacing[1] * np.arange(2 * shape[1])
    found = surface_influence(y, x, grid, 1.0, (False, True))
    np.testing.assert_allclose(
        surface_influence(x, y, turned, 1.0, (True, False)).T, found, rtol=0, atol=1e-13
    )
    for j, i in ((0, 0), (y.size - 1, 0), (y.size // 2, 1), (y.size // 2, x.size - 1)):
        assert found[j, i] == pytest.approx(images(y[j], x[i], grid), abs=1e-10 * found.max())
    assert compliance_modes(grid, 1.0, (False, True)).min() > 0


@pytest.mark.parametrize(("j", "i"), [(0, 3), (2, 2), (4, 5)])
def test_compliance_in_modes_along_the_axis(j, i):
    """The Fourier series along the axis: the logarithm, and modified Bessel functions over the rectangle."""
    grid = asp.Grid((8, 8), (1.0, 1.5))
    (dy, dx), (period, width) = grid.spacing, grid.length
    y, x = j * dy, i * dx
    places, weights = np.polynomial.legendre.leggauss(40)
    places, weights = x + dx / 2 * places, dx / 2 * weights
    q = 2 * np.pi * np.arange(1, 60)[:, None] / period
    modes = 4 * np.cos(q * y) * np.sinc(q * dy / 2 / np.pi) * k0(q * places)
    exact = (modes.sum(axis=0) - 2 * np.log(places / width)) @ weights * dy / (np.pi * period)
    found = surface_influence(np.array([y]), np.array([x]), grid, 1.0, (False, True)).item()
    assert found == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("free", [(False, True), (True, False)])
def test_convolution_and_slopes_are_sums_over_nodes(free):
    """Rounding; the slopes against differences of the compliance, whose error is of order step²."""
    grid, step = asp.Grid((9, 8), (0.7, 1.1)), 1e-4
    pressure = np.random.default_rng(1).random(grid.shape)
    fourier = PaddedFourier(grid, free=free)
    modes = compliance_modes(grid, 1.0, free)[np.abs(padded_grid(grid, free).ky)]
    found = fourier.inverse(fourier.forward(pressure) * modes)
    of_node = surface_influence(*grid.coordinates(), grid, 1.0, free)
    j, i = np.indices(grid.shape).reshape(2, -1)
    apart = of_node[np.abs(j[:, None] - j), np.abs(i[:, None] - i)]
    np.testing.assert_allclose(found.ravel(), apart @ pressure.ravel(), rtol=1e-11)
    one = np.zeros(grid.shape)
    one[2, 3] = 1
    y, x = (places[:, None] + [-step, step] for places in grid.coordinates())
    y, x = y[1:4] - y[2].mean(), x[1:4] - x[3].mean()  # beside the node, not on an edge of its rectangle
    slopes = [fourier.inverse(fourier.forward(one) * each)[1:4, 1:4] for each in slope_modes(grid, 1.0, free)]
    along_y = np.diff(surface_influence(y.ravel(), x.mean(axis=1), grid, 1.0, free).reshape(3, 2, 3), axis=1)
    along_x = np.diff(surface_influence(y.mean(axis=1), x.ravel(), grid, 1.0, free).reshape(3, 3, 2), axis=2)
    np.testing.assert_allclose(slopes[0], along_y[:, 0] / (2 * step), rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(slopes[1], along_x[:, :, 0] / (2 * step), rtol=1e-5, atol=1e-6)


def cylinder(points, length, axis="y", rows=16):
    """Contact of a cylinder of radius 2 with a force per length, and the closed form."""
    shape, edges = (rows, points), (length, 1.0)
    exact = LineHertz.from_load(load := 5e-2, 2.0, HALF_SPACE.effective_modulus)
    height = np.tile(centred(asp.Grid(shape, edges))[1] ** 2 / 4, (rows, 1))
    if axis == "x":
        height, edges = height.T, edges[::-1]
    contact = asp.solve_contact(
        height, HALF_SPACE, edges, force=load * length, boundary=ACROSS[axis], rtol=1e-8
    )
    return contact, exact, load


def test_cylinder_is_hertzian_for_every_length_of_the_cell():
    """Grid error; the approach of a line load, (F/π E*) (1 + 2 ln(2c/b)), from a distance c."""
    errors = []
    for points in (64, 128, 256):
        contact, exact, load = cylinder(points, 1.0)
        approach = load / (np.pi * HALF_SPACE.effective_modulus) * (1 + 2 * np.log(2 / exact.half_width))
        lowest = contact.height.min()
        errors.append(
            (
                contact.maximum_pressure / exact.maximum_pressure - 1,
                contact.contact_area_fraction / (2 * exact.half_width) - 1,
                (contact.approach - lowest) / approach - 1,
            )
        )
    assert np.abs(errors[-1]).max() < 8e-3
    assert np.abs(errors[-1][::2]).max() < 1e-3
    assert np.abs(errors[-1][0]) < np.abs(errors[0][0]) / 3
    for length, axis in ((0.1, "y"), (30.0, "y"), (1.0, "x")):
        other = cylinder(256, length, axis)[0]
        assert difference(other.pressure if axis == "y" else other.pressure.T, contact.pressure) < 1e-6
        assert other.approach == pytest.approx(contact.approach, rel=1e-7)


def roller(shape, length, seed=1):
    """A rough cylinder whose axis is y."""
    x = centred(asp.Grid(shape, length))[1]
    return 3 * rough(shape, seed) + x**2


@pytest.mark.parametrize(
    "imposed",
    [
        {"mean_pressure": 4e-3},
        {"approach": 0.0},
        {"contact_area_fraction": 0.04},
        {"mean_pressure": 4e-3, "hardness": 0.1},
    ],
)
def test_mirrored_along_the_axis_is_the_doubled_cell(imposed):
    """Solver error, of the contact, its certificate and its stiffness."""
    shape, length = (48, 64), (0.75, 1.0)
    height = roller(shape, length)
    grid = asp.Grid(shape, length, mirrored=True)
    contact = asp.solve_contact(height, HALF_SPACE, grid, boundary=ACROSS["y"], **imposed)
    doubled = np.concatenate([height, height[::-1]])
    whole = asp.solve_contact(doubled, HALF_SPACE, (1.5, 1.0), boundary="free along x", **imposed)
    assert (contact.grid.mirrored, contact.boundary) == ((True, False), "free along x")
    assert difference(np.concatenate([contact.pressure, contact.pressure[::-1]]), whole.pressure) < 1e-5
    assert contact.approach == pytest.approx(whole.approach, rel=1e-6)
    found = verify_contact(
        height, contact.pressure, HALF_SPACE, grid, approach=contact.approach,
        hardness=imposed.get("hardness"), boundary=ACROSS["y"],
    )  # fmt: skip
    assert found.worst < 1e-5
    for name, value in found.violations.items():  # as `asperity verify` computes them anew
        assert value <= contact.certificate.violations[name] + 1e-12
    assert contact.stiffness == pytest.approx(whole.stiffness, rel=1e-6)
    assert contact.gradient_rms_contact == pytest.approx(whole.gradient_rms_contact, rel=1e-6)


def test_middle_of_a_long_free_map():
    """A roughness that repeats, three and nine times along a map with free ends: the difference falls."""
    shape, length, found = (32, 64), (0.5, 1.0), []
    height = roller(shape, length)
    for count in (3, 9):
        long, cell = np.tile(height, (count, 1)), slice(count // 2 * 32, (count // 2 + 1) * 32)
        alone = asp.solve_contact(long, HALF_SPACE, (0.5 * count, 1.0), mean_pressure=4e-3, boundary="free")
        load = alone.pressure[cell].mean()
        across = asp.solve_contact(height, HALF_SPACE, length, mean_pressure=load, boundary=ACROSS["y"])
        found.append(difference(alone.pressure[cell], across.pressure))
    assert found[1] < 0.2 * found[0] < 0.2 * 0.05


@pytest.mark.parametrize(("axis", "ratio"), [("x", 1.0), ("y", 1 / (1 - 0.3))])
def test_partial_slip_of_a_line_contact_is_exact(axis, ratio):
    """Plane strain, with the compliance of a pressure, and antiplane shear."""
    contact = cylinder(256, 1.0)[0]
    slip = asp.contact.partial_slip(
        contact, 0.3, tangential_force=0.15 * contact.force, sliding_direction=axis
    )
    assert slip.compliance_ratio == pytest.approx(ratio, rel=1e-9)
    assert slip.deviation < 1e-6
    assert slip.sticking_area == pytest.approx(np.sqrt(0.5), rel=0.02)


def pressed(solid, grid, axis):
    return asp.solve_contact(np.eye(8), solid, grid, force=1.0, boundary=ACROSS[axis])


SHEETS = asp.Grid((8, 8), 1.0, (True, False))
test_wrong_argument_is_refused = refuses(
    (lambda: pressed(LAYER, 1.0, "y"), "boundary = 'free along x': half-spaces are needed"),
    (lambda: pressed(HALF_SPACE, SHEETS, "x"), "boundary = 'free along y': a grid without mirror images"),
)
