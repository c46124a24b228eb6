"""Tests of load paths and of the control of the area: starts, steps of the load, and what they save."""

import math

import numpy as np
import pytest

import asperity as asp
from asperity.contact import solve, solve_path
from asperity.contact.area_control import FEW_NODES, AreaControl
from asperity.contact.load_prediction import LoadPrediction
from asperity.contact.path_prediction import PathPrediction, _level_of_mean
from asperity.contact.problem import State
from asperity.elasticity.layer import Layer
from asperity.types import Array

HALF_SPACE = Layer(1.0, 0.0)
FRACTIONS = [0.05, 0.06, 0.07, 0.08, 0.09, 0.1]


def rough(points: int = 128) -> Array:
    return asp.self_affine((points, points), 0.8, 0.25, 8 / points, 1e-3, seed=2)


def relative_difference(one: Array, other: Array) -> float:
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


def state_of(count: int, error: float) -> State:
    """State in which so many of 100 000 nodes touch, under a unit load."""
    pressure = np.zeros((1, 100_000))
    pressure[0, :count] = 1
    return State(pressure, 0.0, 1.0, error)


# Starts along a path


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("area_fraction", [0.05, 0.06, 0.07]),
        ("mean_pressure", [2.0e-3, 2.4e-3, 2.8e-3]),
        ("force", [2.8e-3, 2.4e-3, 2.0e-3]),
        ("approach", [-1.4e-3, -1.3e-3, -1.2e-3]),
    ],
)
def test_the_predicted_start_is_better_than_the_last_solution(kind: str, values: list[float]) -> None:
    """Rising and falling loads; the last solution is scaled to the load sought."""
    height, prediction = rough(), PathPrediction(kind)
    *before, sought = (solve(height, HALF_SPACE, **{kind: value}) for value in values)
    for value, contact in zip(values, before, strict=False):
        assert prediction.pressure(values[-1]) is None
        prediction.record(value, contact)
    start = prediction.pressure(values[-1])
    assert start is not None
    assert start.min() >= 0
    last = before[-1].pressure * (sought.mean_pressure / before[-1].mean_pressure)
    apart = relative_difference(start, sought.pressure)
    assert apart < 0.6 * relative_difference(last, sought.pressure)
    assert start.mean() == pytest.approx(sought.mean_pressure, rel=0.03)


@pytest.mark.parametrize("value", [0.3, 0.01, 0.0, math.nan, "0.07", None])
def test_no_start_is_predicted_far_away(value: object) -> None:
    height, prediction = rough(64), PathPrediction("area_fraction")
    for fraction in (0.05, 0.06):
        prediction.record(fraction, solve(height, HALF_SPACE, area_fraction=fraction))
    assert prediction.pressure(0.065) is not None
    assert prediction.pressure(value) is None  # type: ignore[arg-type]


def test_lift_off_ends_the_prediction() -> None:
    height = rough(64)
    lowest = float(height.min())
    prediction = PathPrediction("approach")
    for distance in (3e-4, 4e-4, -1e-4, 5e-4):
        prediction.record(lowest + distance, solve(height, HALF_SPACE, approach=lowest + distance))
        known = prediction.pressure(lowest + 4.5e-4) is not None
        assert known == (distance == 4e-4)


def test_level_of_a_mean() -> None:
    values = np.sin(np.arange(1000.0)).astype(np.float32)
    for mean in (1e-3, 0.1, 2.0):
        level = _level_of_mean(values, mean)
        assert level is not None
        assert np.maximum(values - level, 0).mean() == pytest.approx(mean, rel=2e-4)
    assert _level_of_mean(np.full(4, np.nan, np.float32), 1.0) is None


def test_a_path_takes_fewer_transforms_than_its_contacts_alone() -> None:
    height = rough(256)
    path = list(solve_path(height, HALF_SPACE, area_fractions=FRACTIONS))
    alone = [solve(height, HALF_SPACE, area_fraction=fraction) for fraction in FRACTIONS]
    spent, needed = (sum(contact.certificate.pairs for contact in contacts[2:]) for contacts in (path, alone))
    assert spent < 0.85 * needed
    for step, contact in zip(path, alone, strict=True):
        assert abs(step.area_fraction - contact.area_fraction) * height.size <= 1
        assert step.mean_pressure == pytest.approx(contact.mean_pressure, rel=1e-3)


@pytest.mark.parametrize("order", [(2, 0, 1, 3, 1), (3, 2, 1, 0), (0, 0, 0)])
def test_loads_in_any_order(order: tuple[int, ...]) -> None:
    height = rough(64)
    loads = [1e-3 * 1.2**number for number in order]
    for load, step in zip(loads, solve_path(height, HALF_SPACE, mean_pressures=loads), strict=True):
        alone = solve(height, HALF_SPACE, mean_pressure=load)
        assert relative_difference(step.pressure, alone.pressure) < 1e-5


@pytest.mark.parametrize("scale", [1e-60, 1e60])
def test_a_path_in_extreme_units_is_the_same(scale: float) -> None:
    """Powers of two would be exact; the tolerance is that of the pressure."""
    height, loads = rough(64), [1.0e-3, 1.2e-3, 1.4e-3]
    for usual, other in zip(
        solve_path(height, HALF_SPACE, mean_pressures=loads),
        solve_path(height, Layer(scale, 0.0), mean_pressures=[scale * load for load in loads]),
        strict=True,
    ):
        assert relative_difference(other.pressure / scale, usual.pressure) < 1e-5


def test_a_bad_value_late_in_a_path_is_named() -> None:
    path = solve_path(rough(64), HALF_SPACE, mean_pressures=[1e-3, 1.1e-3, "many"])  # type: ignore[list-item]
    assert next(path).area_fraction < next(path).area_fraction
    with pytest.raises((TypeError, ValueError), match=r"mean_pressure = 'many'"):
        next(path)


def test_an_area_that_no_number_holds_is_refused_after_two_solutions() -> None:
    path = solve_path(rough(32), HALF_SPACE, area_fractions=[0.1, 0.11, 10**400])
    assert next(path).area_fraction < next(path).area_fraction
    with pytest.raises(ValueError, match=r"^area_fraction = 1000.*needed"):
        next(path)


# Steps of the load towards an area


def test_no_step_where_the_correction_meets_the_area() -> None:
    area = AreaControl(0.1, 100_000, 1e-6)
    assert area.next_step(state_of(9_000, 1e-2), count=10_000, released=0) is None
    # A tenth of the released nodes will be followed by others.
    assert area.next_step(state_of(9_000, 0.1), count=10_030, released=300) is None


def test_a_step_follows_the_power_law() -> None:
    area = AreaControl(0.1, 100_000, 1e-6)
    step = area.next_step(state_of(9_000, 1e-2), count=9_900, released=0)
    assert step is not None
    assert not step.last_nodes
    assert step.load_change == pytest.approx(math.log(10_000 / 9_900), rel=0.1)


def test_the_last_nodes_are_sought_near_convergence_only() -> None:
    area = AreaControl(0.02, 100_000, 1e-6)
    missed = 2_000 + FEW_NODES // 2
    assert area.next_step(state_of(2_000, 1e-2), missed, released=0) is None
    step = area.next_step(state_of(2_000, 1e-4), missed, released=0)
    assert step is not None
    assert step.last_nodes
    assert step.load_change < 0


def test_a_solution_takes_few_steps_of_the_load() -> None:
    area = AreaControl(0.1, 100_000, 1e-6)
    taken = [
        area.next_step(state_of(9_000, 1e-2), 9_500, 0)
        for _ in range(100)
        if area.may_steer(state_of(9_000, 1e-2))
    ]
    assert 0 < len(taken) < 20


def test_the_load_of_the_next_grid_follows_those_of_the_coarser_ones() -> None:
    """Loads that converge with the first power of the spacing, at areas that are missed."""
    prediction, limit = LoadPrediction(0.1), 1.3
    for nodes in (64, 128, 256, 512):
        load = math.exp(-limit * 32 / nodes)
        control, predicted = prediction.next_control(load, 0.1, (2 * nodes) ** 2, is_finest=nodes == 512)
    assert control.kind == "area_fraction"
    assert math.log(predicted) == pytest.approx(-limit * 32 / 1024, abs=0.01)


def test_coarse_grids_with_many_contact_nodes_are_solved_at_a_load() -> None:
    prediction = LoadPrediction(0.1)
    kinds = [
        prediction.next_control(1.0, 0.1, size, is_finest=False)[0].kind for size in (1_000, 1_000, 100_000)
    ]
    assert kinds == ["area_fraction", "area_fraction", "mean_pressure"]
