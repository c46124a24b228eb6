"""Peaks between the nodes, against quadratics whose maxima are known."""

import numpy as np
import pytest

from asperity.stress.refinement import refine_in_plane, refine_in_solid, wrapped

DEPTHS = (0.2, 0.5, 0.7)
UNIT = 0.2  # the smaller distance of the planes


def quadratics(count, axes, seed=0):
    """Heights, places (depth per `UNIT`, y, x) and second derivatives of maxima near the middle node."""
    draw = np.random.default_rng(seed)
    root = draw.standard_normal((count, axes, axes))
    second = -np.einsum("nij,nkj->nik", root, root) - 0.5 * np.eye(axes)
    return draw.uniform(5, 6, count), draw.uniform(-0.4, 0.4, (count, axes)), second


def values_at(offsets, heights, places, second):
    """Values of the quadratics at offsets from the node."""
    away = offsets - places
    return heights + 0.5 * np.einsum("ni,nij,nj->n", away, second, away)


def stencil(heights, places, second, depth=None):
    """Values at 3 × 3 nodes, in the plane at a depth per `UNIT` from the node."""
    out = np.empty((heights.size, 3, 3))
    for row in range(3):
        for column in range(3):
            offset = np.array(
                [row - 1.0, column - 1.0] if depth is None else [depth, row - 1.0, column - 1.0]
            )
            out[:, row, column] = values_at(offset, heights, places, second)
    return out


@pytest.mark.parametrize("sign", [1, -1])
def test_maxima_of_quadratics_in_a_plane_are_exact(sign):
    heights, places, second = quadratics(200, 2)
    value, y, x = refine_in_plane(sign * stencil(heights, places, second))
    np.testing.assert_allclose(value, heights, rtol=1e-12)
    np.testing.assert_allclose(np.stack([y, x], axis=1), places, atol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_maxima_of_quadratics_between_unequal_planes_are_exact(sign):
    heights, places, second = quadratics(200, 3)
    along = (np.array(DEPTHS) - DEPTHS[1]) / UNIT
    planes = [sign * stencil(heights, places, second, depth) for depth in along]
    value, depth, y, x = refine_in_solid(*planes, DEPTHS)
    np.testing.assert_allclose(value, heights, rtol=1e-12)
    np.testing.assert_allclose((depth - DEPTHS[1]) / UNIT, places[:, 0], atol=1e-11)
    np.testing.assert_allclose(np.stack([y, x], axis=1), places[:, 1:], atol=1e-11)


def test_a_saddle_is_refined_along_the_axis_that_gains_most():
    """A maximum along y and x, but not along the diagonal."""
    slope = 0.1
    heights, places = np.array([1.0]), np.zeros((1, 2))
    second = np.array([[[-1.0, 2.0], [2.0, -1.0]]])
    values = stencil(heights, places, second) + slope * np.array([-1.0, 0.0, 1.0])[:, None]
    value, y, x = refine_in_plane(values)
    assert (y, x) == (pytest.approx(slope), 0)
    assert value == pytest.approx(1 + 0.5 * slope**2)


def test_a_step_along_one_axis_is_at_most_half_a_spacing():
    values = np.array([[[0.0, 0, 0], [0, 1.0, 0.99], [0, 2.5, 0]]])
    value, y, x = refine_in_plane(values)
    assert 0 <= max(abs(y[0]), abs(x[0])) <= 0.5
    assert min(abs(y[0]), abs(x[0])) == 0
    assert value >= 1


def test_places_in_a_periodic_cell_are_below_its_length():
    """Also just beyond the first edge, where the remainder is rounded to the length."""
    assert -1e-20 % 5.0 == 5.0
    places = np.array([[-1e-20, -0.5], [5.0, 7.0], [2.0, 6.9]])
    np.testing.assert_allclose(wrapped(places, np.array([5.0, 7.0])), [[0, 6.5], [0, 0], [2, 6.9]])
