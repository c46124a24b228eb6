"""Extreme cases are solved correctly or end with a named error; values out of range are refused by name."""

from dataclasses import replace

import extremes
import numpy as np
import pytest
from extremes import ACCEPTABLE, CHECKED, REFUSED, ExtremeCase
from samples import HALF_SPACE, difference, rough
from solution_check import check_solution, mode_compliance

import asperity as asp
from asperity.contact import solve_contact, verify_contact
from asperity.reference.pivoting import pivot


def test_extremes_are_solved_and_never_silently_wrong():
    found = extremes.outcomes(levels="ends")
    assert found[~found["outcome"].isin(ACCEPTABLE)].empty
    assert (found["outcome"] == CHECKED).mean() > 0.9


def test_values_out_of_range_are_refused_by_name():
    found = extremes.refusals()
    assert len(found) > 10
    assert found[found["outcome"] != REFUSED].empty


@pytest.mark.parametrize(
    "changes",
    [
        {"scaled_height": 1e-3},
        {"scaled_height": 1e-3, "poisson": 0.5, "points": 64},
        {"scaled_height": 0.1, "poisson": 0.5},
        {"scaled_height": 1e-6, "precision": "float32"},
        {"imposed": ("load", 1e-9), "points": 128},
        {"imposed": ("area", 1e-9), "points": 512},
        {"imposed": ("area", 1e-9), "precision": "float32"},
    ],
)
def test_thin_layers_and_vanishing_contacts_are_solved(changes):
    assert extremes.attempt(ExtremeCase(**changes)).outcome.startswith("certified")


@pytest.mark.parametrize(("points", "direct"), [(24, True), (128, False)])
def test_check_refuses_a_tampered_solution(points, direct):
    height, layer, tolerance = rough((points, points)), asp.Solid(1.0, 0.0), 1e-6
    load = 0.03 * extremes.closing_pressure(height, layer)
    contact = solve_contact(height, layer, mean_pressure=load)
    check = check_solution(contact, {"mean_pressure": load}, tolerance)
    assert check.holds
    assert check.direct == direct
    if direct:
        exact = pivot(height, mode_compliance(layer, contact.grid), mean_pressure=load)
        assert check.error == pytest.approx(difference(contact.pressure, exact) / tolerance, rel=1e-3)
    error = contact.pressure * np.random.default_rng(1).standard_normal(height.shape)
    error -= contact.pressure * error.sum() / contact.pressure.sum()
    tampered = replace(contact, pressure=contact.pressure + 1e-4 * error)
    assert not check_solution(tampered, {"mean_pressure": load}, tolerance).holds


@pytest.mark.parametrize(
    "layer", [HALF_SPACE, *(asp.Solid(1.0, nu, 1e-4) for nu in (0.3, 0.5)), asp.Solid(1.0, 0.3, 0.1, "free")]
)
def test_pivoting_fulfils_the_conditions_of_contact(layer):
    """Rounding alone: there is no tolerance."""
    height = rough((24, 24))
    closing, modes = extremes.closing_pressure(height, layer), mode_compliance(layer, asp.Grid(height.shape))
    for part in (1e-30, 0.03, 0.5, 0.9999, 1.0001):
        pressure = pivot(height, modes, mean_pressure=part * closing)
        assert pressure.mean() == pytest.approx(part * closing, rel=1e-12)
        assert verify_contact(height, pressure, layer, mean_pressure=part * closing).worst < 1e-10
        if part > 0.9:
            assert np.sum(pressure == 0) == (part < 1)  # the last gap closes
