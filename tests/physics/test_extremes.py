"""Extreme cases are solved correctly or end with a named error; values out of range are refused by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.contact import solve, verify_contact
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.fourier.grid import Grid
from asperity.reference import pivoting
from asperity.reference.pivoting import PivotingError, pivot
from asperity.study.validation import extremes
from asperity.study.validation.extremes import ACCEPTABLE, CHECKED, OUTCOMES, ExtremeCase
from asperity.study.validation.solution_check import check_solution, mode_compliance

HALF_SPACE = Layer(1.0, 0.0)


def rough() -> Array:
    return asp.self_affine((24, 24), 0.8, 0.5, 1 / 6, 1e-3, 1)


def pressure_by_pivoting(height: Array, layer: Layer = HALF_SPACE, **imposed: float) -> Array:
    return pivot(height, mode_compliance(layer, Grid(height.shape)), **imposed)


@pytest.fixture(scope="module")
def matrix() -> xr.Dataset:
    return extremes.outcome_matrix(levels="ends", largest=64)


def test_nothing_is_silently_wrong(matrix: xr.Dataset) -> None:
    axis, value = matrix["level_axis"].values, matrix["level_value"].values
    bad = ~np.isin(matrix["outcome"].values, ACCEPTABLE)
    found = [f"{axis[i]} {value[i]}, {axis[j]} {value[j]}" for i, j in np.argwhere(bad)]
    assert not found


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
def test_thin_layers_and_vanishing_contacts_are_solved(changes: dict) -> None:
    assert OUTCOMES[extremes.attempt(ExtremeCase(**changes)).outcome].startswith("certified")


def test_nearly_all_extremes_are_solved_and_checked(matrix: xr.Dataset) -> None:
    outcome = matrix["outcome"].values
    assert np.sum(outcome == CHECKED) > 0.9 * np.sum(outcome != 0)


def test_every_value_out_of_range_is_refused_by_name(matrix: xr.Dataset) -> None:
    assert matrix["beyond_axis"].size > 10
    for axis, value, outcome, reason in zip(
        *(matrix[f"beyond_{name}"].values for name in ("axis", "value", "outcome", "reason")), strict=True
    ):
        assert OUTCOMES[outcome] == "refused", f"{axis} {value}: {reason}"
        assert any(mark in reason for mark in (" = ", "height:")), reason


@pytest.mark.parametrize(
    ("error", "outcome"),
    [(UserWarning(), "warned"), (FloatingPointError(), "warned"), (KeyError(), "failed")],
)
def test_warnings_and_other_exceptions_are_defects(error: Exception, outcome: str, monkeypatch) -> None:
    def fails(*_, **__):
        raise error

    monkeypatch.setattr(extremes, "solve", fails)
    assert OUTCOMES[extremes.attempt.__wrapped__(ExtremeCase()).outcome] == outcome


@pytest.mark.parametrize(("points", "direct"), [(24, True), (128, False)])
def test_check_refuses_a_tampered_solution(points: int, direct: bool) -> None:
    case = ExtremeCase(points=points)
    height = case.rms_gradient * extremes.unit_surface(case)
    load = case.rms_gradient * 0.03 * extremes.closing_pressure(height / case.rms_gradient, HALF_SPACE)
    contact = solve(height, HALF_SPACE, mean_pressure=load)
    tolerance = extremes.TOLERANCES[case.precision]
    check = check_solution(contact, {"mean_pressure": load}, tolerance)
    assert check.holds
    assert check.direct == direct
    if direct:
        exact = pressure_by_pivoting(height, mean_pressure=load)
        error = np.linalg.norm(contact.pressure - exact) / np.linalg.norm(exact)
        assert check.error == pytest.approx(error / tolerance, rel=1e-6)
    generator = np.random.default_rng(1)
    error = contact.pressure * generator.standard_normal(height.shape)
    error -= contact.pressure * error.sum() / contact.pressure.sum()
    tampered = replace(contact, pressure=contact.pressure + 1e-4 * error)
    assert not check_solution(tampered, {"mean_pressure": load}, tolerance).holds


@pytest.mark.parametrize(
    "layer", [HALF_SPACE, Layer(1.0, 0.5, 1e-4), Layer(1.0, 0.3, 1e-4), Layer(1.0, 0.3, 0.1, "free")]
)
def test_pivoting_fulfils_the_conditions_of_contact(layer: Layer) -> None:
    """Rounding alone: there is no tolerance."""
    height = rough()
    closing = extremes.closing_pressure(height, layer)
    for part in (1e-30, 0.03, 0.5, 2.0):
        pressure = pressure_by_pivoting(height, layer, mean_pressure=part * closing)
        assert pressure.mean() == pytest.approx(part * closing, rel=1e-12)
        assert verify_contact(height, pressure, layer, mean_pressure=part * closing).worst < 1e-10


def test_closing_pressure_closes_the_last_gap() -> None:
    height = rough()
    closing = extremes.closing_pressure(height, HALF_SPACE)
    assert np.all(pressure_by_pivoting(height, mean_pressure=1.0001 * closing) > 0)
    assert np.sum(pressure_by_pivoting(height, mean_pressure=0.9999 * closing) == 0) == 1


def test_pivoting_that_does_not_end_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pivoting, "MAX_PIVOTS", 1)
    height = rough()
    with pytest.raises(PivotingError, match="of 576 nodes still wrong after 1 pivots"):
        pressure_by_pivoting(height, mean_pressure=1e-3)


@pytest.mark.parametrize("part", [0.3, 0.99, 0.999])
def test_damped_dynamics_near_full_contact(part: float) -> None:
    """The load grows without limit towards the mean height; it counts as much as the tractions."""
    height = rough()
    approach = (1 - part) * float(height.min())
    contact = solve(height, HALF_SPACE, approach=approach, method="gfmd", rtol=1e-6)
    true = pressure_by_pivoting(height, approach=approach)
    assert np.linalg.norm(contact.pressure - true) < 3e-6 * np.linalg.norm(true)
