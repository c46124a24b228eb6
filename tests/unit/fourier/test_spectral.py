"""The Fourier convention, tested against explicit sums, and refused arguments."""

import numpy as np
import pytest
import xarray as xr
from samples import refuses

from asperity.fourier.grid import (
    Fourier,
    Grid,
    Work,
    gradient,
    grid_of,
    mean_square,
    radial_average,
    resample,
    with_mirror_images,
)

pytestmark = pytest.mark.engines

SHAPES = [(8, 8), (7, 9), (8, 5), (6, 12), (1, 4)]


def explicit_coefficients(values, grid):
    y, x = grid.coordinates()
    phase_y = np.exp(-1j * np.outer(grid.qy, y))
    phase_x = np.exp(-1j * np.outer(x, grid.qx))
    return phase_y @ values @ phase_x / grid.size


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("dtype", "bound"), [("float64", 1e-14), ("float32", 1e-6)])
def test_forward_is_the_explicit_sum(shape, dtype, bound):
    grid = Grid(shape, (2.0, 3.0))
    values = np.random.default_rng(1).normal(size=shape)
    fourier = Fourier(grid, dtype)
    coefficients = fourier.forward(values)
    assert coefficients.dtype == fourier.coefficient_type
    np.testing.assert_allclose(coefficients, explicit_coefficients(values, grid), atol=bound)
    np.testing.assert_allclose(fourier.inverse(coefficients), values, atol=10 * bound)
    assert mean_square(coefficients, grid) == pytest.approx(np.mean(values**2), rel=bound)  # Parseval


@pytest.mark.parametrize("threads", [2, 3])
@pytest.mark.parametrize(
    ("shape", "dtype"), [((256, 360), "float64"), ((326, 512), "float32"), ((625, 625), "float64")]
)
def test_transforms_do_not_depend_on_threads(shape, dtype, threads):
    grid = Grid(shape)
    values = np.random.default_rng(3).normal(size=shape)
    one, many = Fourier(grid, dtype), Fourier(grid, dtype, threads=threads)
    coefficients = one.forward(values)
    assert np.array_equal(coefficients, many.forward(values))
    assert np.array_equal(one.inverse(coefficients), many.inverse(coefficients))


def cell_of_four(values, odd=(False, False)):
    """A field and its mirror images, which change their sign along an axis on which it is odd."""
    for axis, is_odd in enumerate(odd):
        image = np.flip(values, axis)
        values = np.concatenate([values, -image if is_odd else image], axis)
    return values


PARITIES = [(False, False), (True, False), (False, True), (True, True)]


@pytest.mark.parametrize("shape", [*SHAPES, (1, 1), (2, 3), (130, 257)])
@pytest.mark.parametrize("odd", PARITIES)
@pytest.mark.parametrize(("dtype", "bound"), [("float64", 1e-14), ("float32", 1e-6)])
def test_mirrored_coefficients_are_those_of_the_cell_of_four(shape, odd, dtype, bound):
    grid = Grid(shape, (2.0, 3.0), mirrored=True)
    values = np.random.default_rng(1).normal(size=shape).astype(dtype)
    fourier = Fourier(grid, dtype)
    coefficients = fourier.forward(values, odd=odd)
    whole = Grid(tuple(2 * n for n in shape), grid.period)
    expected = Fourier(whole).forward(cell_of_four(values, odd))[: shape[0], : shape[1]]
    # In the cell of four the first node is half a spacing from the mirror line.
    expected = expected * np.exp(-0.5j * whole.qy[: shape[0], None] * whole.spacing[0])
    expected = expected * np.exp(-0.5j * whole.qx[: shape[1]] * whole.spacing[1]) * 1j ** sum(odd)
    np.testing.assert_allclose(coefficients, expected, atol=bound)
    assert np.all(coefficients[0] == 0) or not odd[0]
    assert np.all(coefficients[:, 0] == 0) or not odd[1]
    if any(odd):  # the sine of two nodes, which is not stored, is nowhere 0
        smooth = fourier.inverse(coefficients, odd=odd)
        np.testing.assert_allclose(fourier.forward(smooth, odd=odd), coefficients, atol=bound)
        return
    np.testing.assert_allclose(fourier.inverse(coefficients), values, atol=10 * bound)
    assert mean_square(coefficients, grid) == pytest.approx(np.mean(values.astype(float) ** 2), rel=bound)


@pytest.mark.parametrize("odd", PARITIES)
@pytest.mark.parametrize(("shape", "dtype"), [((300, 1024), "float32"), ((625, 350), "float64")])
def test_mirrored_transforms_do_not_depend_on_threads(shape, dtype, odd):
    grid = Grid(shape, mirrored=True)
    values = np.random.default_rng(3).normal(size=shape)
    one, many = Fourier(grid, dtype), Fourier(grid, dtype, threads=3)
    coefficients = one.forward(values, odd=odd)
    assert np.array_equal(coefficients, many.forward(values, odd=odd))
    assert np.array_equal(one.inverse(coefficients, odd=odd), many.inverse(coefficients, odd=odd))


@pytest.mark.parametrize("shape", [(12, 16), (7, 9), (5, 1)])
def test_mirrored_gradient_and_spectra_are_those_of_the_cell_of_four(shape):
    grid = Grid(shape, (1.0, 2.0), mirrored=True)
    values = np.random.default_rng(2).normal(size=shape)
    whole, fourier = Fourier(Grid(tuple(2 * n for n in shape), grid.period)), Fourier(grid)
    modes, of_whole = fourier.forward(values), whole.forward(cell_of_four(values))
    for found, expected in zip(gradient(modes, fourier), gradient(of_whole, whole), strict=True):
        np.testing.assert_allclose(found, expected[: shape[0], : shape[1]], atol=1e-11)
    rings, power = radial_average(np.abs(modes) ** 2, grid)
    of_cell = dict(zip(*radial_average(np.abs(of_whole) ** 2, whole.grid), strict=True))
    np.testing.assert_allclose(power, [of_cell[ring] for ring in rings], atol=1e-15)
    finer = Grid((2 * shape[0] + 1, 3 * shape[1]), grid.length, mirrored=True)
    there = resample(modes, grid, finer)
    np.testing.assert_array_equal(resample(there, finer, grid), modes)
    np.testing.assert_allclose(mean_square(there, finer), np.mean(values**2))
    with pytest.raises(ValueError, match="as of the source"):
        resample(modes, grid, Grid(shape, grid.length))


def test_whole_cell_of_a_mirrored_map():
    grid, values = Grid((2, 3), (1.0, 2.0), mirrored=True), np.arange(6.0).reshape(2, 3)
    assert grid.whole_cell == Grid((4, 6), (2.0, 4.0))
    np.testing.assert_array_equal(with_mirror_images(values, grid), cell_of_four(values))
    periodic = Grid((2, 3), (1.0, 2.0))
    assert periodic.whole_cell == periodic
    assert with_mirror_images(values, periodic) is values


def test_mirrored_grid_in_a_dataset_and_as_a_length():
    grid = Grid((4, 6), (1.0, 2.0), mirrored=True)
    assert Grid((4, 6), grid) == grid != Grid((4, 6), grid.length)
    dataset = xr.Dataset(coords=grid.dataset_coordinates())
    assert grid_of(dataset) == grid


def test_gradient_of_a_wave_and_nyquist_mode():
    grid = Grid((12, 16), (1.0, 2.0))
    y, x = grid.coordinates()
    fourier = Fourier(grid)
    wave = np.sin(2 * np.pi * 3 * y)[:, None] * np.cos(np.pi * 2 * x)[None, :]
    slope_y, slope_x = gradient(fourier.forward(wave), fourier)
    expected_y = 6 * np.pi * np.outer(np.cos(6 * np.pi * y), np.cos(2 * np.pi * x))
    expected_x = -2 * np.pi * np.outer(np.sin(6 * np.pi * y), np.sin(2 * np.pi * x))
    np.testing.assert_allclose(slope_y, expected_y, atol=1e-12)
    np.testing.assert_allclose(slope_x, expected_x, atol=1e-12)
    nyquist = np.ones(12)[:, None] * (-1.0) ** np.arange(16)[None, :]
    assert np.abs(gradient(fourier.forward(nyquist), fourier)).max() < 1e-13


@pytest.mark.parametrize(
    ("source", "target"), [((12, 15), (24, 20)), ((24, 20), (12, 15)), ((9, 9), (9, 30))]
)
def test_resample_is_exact_for_modes_both_grids_hold(source, target):
    rng = np.random.default_rng(4)
    modes = [(ky, kx, *rng.normal(size=2)) for ky in (-3, 0, 2) for kx in (0, 1, 4)]

    def sample(grid):
        y, x = grid.coordinates()
        phase = [2 * np.pi * (ky * y[:, None] + kx * x[None, :]) for ky, kx, _, _ in modes]
        return sum(a * np.cos(p) + b * np.sin(p) for p, (_, _, a, b) in zip(phase, modes, strict=True))

    coarse, fine = Grid(source), Grid(target)
    moved = Fourier(fine).inverse(resample(Fourier(coarse).forward(sample(coarse)), coarse, fine))
    np.testing.assert_allclose(moved, sample(fine), atol=1e-13)


def test_resample_drops_the_nyquist_mode():
    coarse, fine = Grid((8, 8)), Grid((16, 16))
    nyquist = np.broadcast_to((-1.0) ** np.arange(8), (8, 8))
    assert not resample(Fourier(coarse).forward(nyquist), coarse, fine).any()


def test_radial_average_recovers_a_radial_function():
    grid = Grid((64, 96), (1.0, 1.5))
    wavenumber, average = radial_average(grid.wavenumber(), grid)
    assert np.all(np.abs(average - wavenumber) < 2 * np.pi / 1.5 / 2)


def test_work_is_counted_in_nodes_and_shared():
    work, fine, coarse = Work(), Grid((8, 8)), Grid((4, 4))
    Fourier(fine, work=work).forward(np.zeros((8, 8)))
    Fourier(coarse, work=work).forward(np.zeros((4, 4)))
    assert work.nodes == 80
    assert work.pairs(coarse) == 2.5


FOURIER = Fourier(Grid((4, 6)))


test_wrong_argument_is_refused = refuses(
    (lambda: Grid((0, 4)), r"shape = \(0, 4\): a pair"),
    (lambda: Grid((4.5, 4)), "shape"),
    (lambda: Grid((4, 4), Grid((4, 8))), r"length = Grid.*: a grid of shape \(4, 4\) is needed"),
    (lambda: Grid((4, 4), 5e-324), "length = 5e-324: a number > 0, from 1e-75"),
    (lambda: Grid((4, 4), (1.0, 2.0, 3.0)), "length = .*: one number or a pair"),
    (lambda: Fourier(FOURIER.grid, "float16"), "dtype = 'float16': float64 or float32 is needed"),
    (lambda: FOURIER.forward(np.ones((6, 4))), r"values of shape \(6, 4\)"),
    (lambda: FOURIER.inverse(np.ones((4, 6), complex)), r"coefficients of shape \(4, 6\)"),
    (lambda: resample(np.ones((4, 4), complex), FOURIER.grid, Grid((4, 6), 2.0)), "target of length"),
)
