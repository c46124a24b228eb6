"""The certificate of a pressure: the error that it bounds, and the changes that it exposes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from random_pressure import error_and_bound, pressures
from samples import HALF_SPACE, load_of, rough

import asperity as asp
from asperity.contact import solve_contact, verify_contact
from asperity.core.errors import ConvergenceError

SLAB = asp.Solid(1.0, 0.3, height=1.0)


@settings(max_examples=100)
@given(pressures)
def test_true_error_is_within_the_bound(case):
    """Against the direct solution of the same load, for solutions and for pressures far from any."""
    try:
        error, bound, rounding = error_and_bound(case)
    except ConvergenceError:
        return
    assert error <= bound + rounding


def test_bound_is_close_to_the_largest_error():
    """Nearly all of the load on one node: no number far below would be a bound."""
    case = {"shape": (16, 16), "length": (1.0, 1.0), "seed": 0, "power": 0, "exponent": 0, "offset": 0.0}
    case |= {"solid": asp.Solid(1 - 0.33**2, 0.33), "load": -2, "change": "node", "size": 3}
    error, bound, _ = error_and_bound(case)
    assert bound < 1.1 * error


def test_no_bound_holds_under_tension():
    assert verify_contact(rough(), -rough(), HALF_SPACE).error_bound == np.inf


@pytest.mark.parametrize(
    ("solid", "boundary", "wrong"),
    [(SLAB, "periodic", {"solid": HALF_SPACE}), (HALF_SPACE, "free", {"boundary": "periodic"})],
)
def test_changed_pressures_and_wrong_solids_are_exposed(solid, boundary, wrong):
    height = rough()
    contact = solve_contact(height, solid, mean_pressure=load_of(height), boundary=boundary, rtol=1e-9)
    claim = {"approach": contact.approach, "mean_pressure": contact.mean_pressure}

    def worst(pressure=contact.pressure, **changes):
        given = {"solid": solid, "boundary": boundary, **claim, **changes}
        return verify_contact(height, pressure, **given).worst

    assert worst() < 1e-6
    assert worst(**wrong) > 1e-2
    assert worst(1.001 * contact.pressure) > 1e-4
    assert worst(np.roll(contact.pressure, 1, axis=0)) > 1e-2
    assert worst(approach=contact.approach + 1e-3 * height.std()) > 1e-4
    for value in (0.0, -contact.maximum_pressure, np.nan):
        assert (
            not worst(np.where(contact.pressure == contact.maximum_pressure, value, contact.pressure)) < 1e-3
        )
    with pytest.raises(ConvergenceError, match="certificate"):
        replace(contact.certificate, tension=0.1).check(1e-3)


def test_flat_certificate_is_relative_to_nodal_displacement():
    """Without heights: the largest pressure times the spacing over E*."""
    flat, pressure, approach = np.zeros((16, 16)), np.full((16, 16), 3.0), 0.1
    found = verify_contact(flat, pressure, asp.Solid(2.0, 0.0), approach=approach)
    assert found.penetration == pytest.approx(approach / (3.0 / 16 / 2.0))
    assert found.complementarity == pytest.approx(found.penetration, rel=1e-12)


def test_heights_of_rounding_errors_are_flat():
    """Faces that mesh: their sum is 1e-16 of the heights, less than the rounding errors of the pressure."""
    waves = np.tile(1e-3 * np.cos(2 * np.pi * np.arange(64) / 64), (4, 1))
    left = waves + np.roll(waves, 32, 1)
    assert 0 < np.ptp(left) < 1e-17
    contact = asp.solve_contact(left, asp.Solid(1.0, 0.3), (1 / 16, 1.0), mean_pressure=1e-3)
    np.testing.assert_allclose(contact.pressure, 1e-3, rtol=1e-6)
