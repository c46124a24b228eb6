"""Solved contacts over a free boundary, with their stress, against closed forms of single contacts.

Elliptic contact: `asperity.reference.elliptic_hertz`; sliding sphere: G. M. Hamilton and L. E. Goodman,
J. Appl. Mech. 33 (1966) 371.
"""

import numpy as np
import pytest

import asperity as asp
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere

STEEL, ALUMINIUM = asp.Layer(210e9, 0.3), asp.Layer(70e9, 0.33)
LARGEST_PRESSURE, SEMI_MINOR, MARGIN = 1e9, 1e-4, 1.15
"""Pressure in Pa, semi-axis in m, and half the edge of the map over the semi-axis."""

POINTS = 48
"""Nodes on an edge: about twenty in the semi-minor axis."""


def pressed(ratio, solid):
    """The closed form and the solved contact of a paraboloid with an ellipse of contact of some b/a."""
    exact = EllipticHertz(SEMI_MINOR / ratio, SEMI_MINOR, LARGEST_PRESSURE, solid.effective_modulus)
    radius_x, radius_y = exact.curvature_radii
    length = 2 * MARGIN * SEMI_MINOR, 2 * MARGIN * SEMI_MINOR / ratio
    y, x = ((np.arange(POINTS) - POINTS // 2) * edge / POINTS for edge in length)
    height = y[:, None] ** 2 / (2 * radius_y) + x**2 / (2 * radius_x)
    return exact, asp.solve(height, solid, length, force=exact.load, boundary="free")


def check_body(exact, contact, body):
    """Pressure, area, and von Mises stress and largest shear on the axis with the depth of the first."""
    found = contact.in_body(body)
    depths = np.linspace(0.2, 1.0, 81) * SEMI_MINOR
    middle = [(POINTS // 2 * step,) * 2 for step in contact.grid.spacing]
    box = asp.stress_box(found, depths, *middle, fields=("von_mises", "largest_shear")).dataset()
    von_mises, shear = box["von_mises"].values.ravel(), box["largest_shear"].values.ravel()
    poisson = found.layer.poisson
    expected = exact.largest_von_mises_on_axis(poisson)
    area = np.pi * exact.semi_major * exact.semi_minor
    assert contact.max_pressure == pytest.approx(exact.largest_pressure, rel=1e-3)
    assert contact.area_fraction * contact.grid.area == pytest.approx(area, rel=0.03)  # whole nodes
    assert von_mises.max() == pytest.approx(expected.value, rel=2e-3)
    assert depths[von_mises.argmax()] == pytest.approx(expected.depth, abs=0.5 * (depths[1] - depths[0]))
    assert shear.max() == pytest.approx(exact.largest_shear_on_axis(poisson).value, rel=2e-3)


@pytest.mark.parametrize("ratio", [1.0, 0.85, 0.7, 0.5, 0.35, 0.2])
def test_ellipse_on_steel(ratio):
    exact, contact = pressed(ratio, STEEL)
    check_body(exact, contact, "lower")


def test_sphere_between_steel_and_aluminium():
    exact, contact = pressed(1.0, asp.TwoBodies(STEEL, ALUMINIUM))
    check_body(exact, contact, "lower")
    check_body(exact, contact, "upper")


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.5])
def test_sliding_sphere(friction):
    """Every component at every node of five planes, within 0.2 % of the largest pressure."""
    _, contact = pressed(1.0, STEEL)
    modulus = STEEL.effective_modulus
    curvature = 2 * SEMI_MINOR * modulus / (np.pi * LARGEST_PRESSURE)
    sphere = SlidingSphere(Hertz(SEMI_MINOR, curvature_radius=curvature), friction)
    names = ("xx", "yy", "zz", "yz", "xz", "xy")
    y, x = ((np.arange(POINTS) - POINTS // 2) * step for step in contact.grid.spacing)
    depths = SEMI_MINOR * np.array([0.2, 0.5, 1.0, 2.0, 5.0])
    for plane in asp.stress_planes(contact, depths, fields=names, tolerance=0, friction=friction):
        exact = sphere.stress(y[:, None], x[None, :], plane.depth, STEEL.poisson) * modulus
        found = np.stack([plane.fields[name][0] for name in names], axis=-1)
        np.testing.assert_allclose(found, exact, rtol=0, atol=2e-3 * LARGEST_PRESSURE)
