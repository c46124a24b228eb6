"""The certificate of a pressure: what it notices, and the error that it bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from random_pressure import error_and_bound, pressures

import asperity as asp
from asperity.contact import solve, verify_contact
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array
from asperity.elasticity.layer import Layer

HALF_SPACE = Layer(1 - 0.33**2, 0.33)
SLAB = Layer(1 - 0.33**2, 0.33, height=1.0)


def rough() -> Array:
    return asp.self_affine((64, 64), 0.8, 0.5, 0.125, 1e-3, 1)


@settings(max_examples=100)
@given(pressures)
def test_true_error_is_within_the_bound(case: dict) -> None:
    """Against the direct solution of the same load, for solutions and for pressures far from any."""
    try:
        error, bound, rounding = error_and_bound(case)
    except ConvergenceError:
        return
    assert error <= bound + rounding


def test_bound_is_close_to_the_largest_error() -> None:
    """Nearly all of the load on one node: no number far below would be a bound."""
    case = {"shape": (16, 16), "length": (1.0, 1.0), "seed": 0, "power": 0, "exponent": 0, "offset": 0.0}
    case |= {"solid": HALF_SPACE, "load": -2, "change": "node", "size": 3}
    error, bound, _ = error_and_bound(case)
    assert bound < 1.1 * error


def test_no_bound_holds_under_tension() -> None:
    assert verify_contact(rough(), -rough(), HALF_SPACE).error_bound == np.inf


def test_certificate_exposes_changed_pressures() -> None:
    height = rough()
    contact = solve(height, SLAB, mean_pressure=1e-3, rtol=1e-9)

    def again(pressure: Array, approach: float = contact.approach) -> float:
        return verify_contact(height, pressure, SLAB, approach=approach, mean_pressure=1e-3).worst

    assert again(contact.pressure) < 1e-6
    assert again(1.001 * contact.pressure) > 1e-4
    assert again(np.roll(contact.pressure, 1, axis=0)) > 1e-2
    assert again(contact.pressure, contact.approach + 1e-3 * height.std()) > 1e-4
    node = np.unravel_index(np.argmax(contact.pressure), height.shape)
    for value in (0.0, -contact.pressure[node], np.nan):
        tampered = contact.pressure.copy()
        tampered[node] = value
        assert not again(tampered) < 1e-3
    with pytest.raises(ConvergenceError, match="certificate"):
        replace(contact.certificate, tension=0.1).check(1e-3)


def test_certificate_has_no_scale_of_the_pressure_under_test() -> None:
    """A uniform pressure leaves the gaps of a half-space as they are, however large it is."""
    height = rough()
    worst = [verify_contact(height, np.full(height.shape, size), HALF_SPACE).worst for size in (1e-3, 1e7)]
    assert worst[1] == pytest.approx(worst[0], rel=1e-3)
    assert worst[0] > 1
