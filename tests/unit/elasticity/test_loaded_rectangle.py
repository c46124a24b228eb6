"""The free-space kernel against multiple precision; padded transforms against sums."""

import mpmath
import numpy as np
import pytest

from asperity.elasticity.loaded_rectangle import (
    PaddedFourier,
    compliance_modes,
    padded_grid,
    rectangle_compliance,
    rectangle_slope_x,
    slope_modes,
)
from asperity.fourier.grid import Grid


def love(y, x, edges):
    """Love's formula in multiple precision, in which nothing cancels noticeably; E* = 1."""
    b, a = (mpmath.mpf(edge) / 2 for edge in edges)

    def corner(x, y):
        return x * mpmath.asinh(y / abs(x)) + y * mpmath.asinh(x / abs(y))

    sides = corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b)
    return sides / mpmath.pi


@pytest.mark.parametrize("edges", [(1.0, 1.0), (0.2, 1.0), (1e-6, 3e-6)])
@pytest.mark.parametrize(("j", "i"), [(0, 0), (0, 1), (2, -3), (4096, 4096), (-9e4, 1)])
def test_compliance_and_slope_in_multiple_precision(edges, j, i):
    """Rounding: about 1e-16 times the distance over the shorter edge."""
    y, x = j * edges[0], i * edges[1]
    with mpmath.workdps(40):
        exact = love(mpmath.mpf(y), mpmath.mpf(x), edges)
        relative = float(rectangle_compliance(y, x, edges, 1.0).item() / exact - 1)
        slope = float(mpmath.diff(lambda x: love(mpmath.mpf(y), x, edges), mpmath.mpf(x)))
    rounding = 1e-15 * (1 + np.hypot(y, x) / min(edges))
    assert abs(relative) < rounding
    assert rectangle_slope_x(y, x, edges, 1.0).item() == pytest.approx(slope, rel=1e-11, abs=rounding)


@pytest.mark.engines
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (16, 16), (13, 22)])
def test_padded_convolution_is_the_sum_over_nodes(shape):
    grid = Grid(shape, (0.3, 2.0))
    pressure = np.random.default_rng(1).random(shape)
    fourier = PaddedFourier(grid)
    y, x = (part.ravel() for part in np.meshgrid(*grid.coordinates(), indexing="ij"))
    dy, dx = y[:, None] - y, x[:, None] - x
    spacing_y, spacing_x = grid.spacing
    slope_y, slope_x = slope_modes(grid, 2.0)
    compliance = compliance_modes(grid, 2.0)[np.abs(padded_grid(grid).ky)]
    for modes, matrix in (
        (compliance, rectangle_compliance(dy, dx, grid.spacing, 2.0)),
        (slope_y, rectangle_slope_x(dx, dy, (spacing_x, spacing_y), 2.0)),
        (slope_x, rectangle_slope_x(dy, dx, (spacing_y, spacing_x), 2.0)),
    ):
        field = fourier.inverse(fourier.forward(pressure) * modes)
        np.testing.assert_allclose(field.ravel(), matrix @ pressure.ravel(), rtol=0, atol=1e-14)


@pytest.mark.parametrize("shape", [(64, 64), (7, 300)])
@pytest.mark.parametrize("length", [(1.0, 1.0), (0.3, 1.7)])
def test_factors_of_the_compliance_are_positive(shape, length):
    """The elastic energy of any pressure is positive, also on the padded grid of the preconditioner."""
    assert compliance_modes(Grid(shape, length), 1.0).min() > 0


@pytest.mark.engines
def test_padded_transforms_do_not_depend_on_threads():
    grid, fields = Grid((200, 130)), []
    pressure = np.random.default_rng(2).random(grid.shape)
    for threads in (1, 2, 3):
        fourier = PaddedFourier(grid, threads=threads)
        fields.append(fourier.inverse(fourier.forward(pressure), overwrite=True))
        rows, columns = padded_grid(grid).shape
        assert fourier.work.nodes == 2 * (200 + rows) * columns // 2
        np.testing.assert_array_equal(fields[-1], fields[0])
    np.testing.assert_allclose(fields[0], pressure, rtol=0, atol=1e-14)
