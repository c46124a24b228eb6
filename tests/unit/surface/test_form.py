"""Spheres and cylinders added to a roughness."""

from __future__ import annotations

import numpy as np
import pytest
from samples import refuses

import asperity as asp
from asperity.surface.form import add_cylinder, add_sphere


def test_the_exact_sphere_is_higher():
    """Tolerance: the next term of the series is r⁶/(16 R⁵)."""
    height, radius = add_sphere(np.zeros((1, 101)), (0.01, 1.01), 2.0), 2.0
    r = 0.01 * (np.arange(101) - 50)
    sphere = radius - np.sqrt(radius**2 - r**2)
    np.testing.assert_allclose(sphere - height[0], r**4 / (8 * radius**3), atol=0.5**6 / (12 * radius**5))


@pytest.mark.parametrize("axis", ["y", "x"])
def test_a_cylinder_does_not_curve_along_its_axis(axis):
    roughness = np.random.default_rng(1).standard_normal((6, 6))
    form = add_cylinder(roughness, 3.0, 4.0, axis=axis) - roughness
    across = form if axis == "y" else form.T
    np.testing.assert_allclose(across, np.tile((0.5 * np.arange(6) - 1.25) ** 2 / 8, (6, 1)), atol=1e-15)


FLAT = np.zeros((4, 4))


test_wrong_argument_is_refused = refuses(
    (lambda: add_cylinder(FLAT, 1.0, 0.0), "radius = 0.0: a number > 0"),
    (lambda: add_cylinder(FLAT, asp.Grid((3, 3)), 1.0), r"length = Grid.*: a grid of shape \(4, 4\) is need"),
    (lambda: add_cylinder(np.zeros(4), 1.0, 1.0), r"height of shape \(4,\)"),
    (lambda: add_cylinder(FLAT, 1.0, 1.0, axis="z"), "axis = 'z': one of y, x is needed"),
)
