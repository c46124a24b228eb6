"""The iterate of the active-set solver, whose pressures live on the contact nodes, against whole fields."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact.active_set.area import AreaControl
from asperity.contact.active_set.iterate import Pressure, evaluate
from asperity.contact.compliance import response_on
from asperity.contact.problem import Control, Problem
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.fourier.grid import Grid


def example(threads: int = 1) -> tuple[Problem, Array]:
    height = asp.self_affine((200, 256), 0.8, 1 / 2, 1 / 16, 1e-3, seed=1)
    problem = Problem(height, response_on("periodic", Layer(1.0, 0.0), Grid(height.shape), threads=threads))
    return problem, np.maximum(np.quantile(height, 0.1) - height, 0)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("kind", ["mean_pressure", "approach"])
def test_evaluation_scales_the_pressure(kind: str, threads: int) -> None:
    """To the load, or to the pressure of least energy, at which p · (h + u − δ) = 0."""
    problem, pressure = example(threads)
    value = 1e-3 if kind == "mean_pressure" else float(np.quantile(problem.height, 0.2))
    iterate = evaluate(problem, Control(kind, value), Pressure.of_field(pressure, 1e-3))
    field = iterate.pressure_field()
    gap = problem.height + problem.response.displacement(field)
    np.testing.assert_allclose(iterate.displacement, gap - problem.height, atol=1e-14)
    np.testing.assert_allclose(iterate.gap, gap.reshape(-1)[iterate.nodes], atol=1e-14)
    if kind == "mean_pressure":
        assert field.mean() == pytest.approx(value, rel=1e-13)
    else:
        work = float(np.vdot(field, gap - value))
        assert abs(work) < 1e-12 * float(np.vdot(field, np.abs(gap - value)))


@pytest.mark.parametrize("threads", [1, 3])
def test_free_nodes_below_a_level_are_found(threads: int) -> None:
    problem, pressure = example(threads)
    iterate = evaluate(problem, Control("mean_pressure", 1e-3), Pressure.of_field(pressure, 1e-3))
    gap = problem.height + iterate.displacement
    free = np.flatnonzero((pressure == 0) & (gap < np.quantile(gap, 0.3)))
    nodes, gaps = iterate.free_nodes_below(float(np.quantile(gap, 0.3)))
    np.testing.assert_array_equal(nodes, free)
    np.testing.assert_array_equal(gaps, gap.reshape(-1)[free])


def test_a_bracket_of_loads_closes_on_a_jump_of_the_area() -> None:
    """The contact jumps from 8 to 16 nodes at a load of 0.3; 11 nodes are asked for."""
    area, load, loads = AreaControl(11 / 4096, 4096, 1e-4), 1.0, []
    while load is not None and len(loads) < 100:
        loads.append(load)
        count = 8 if load < 0.3 else 16
        load = area.bracketed(load, count, area.power_law(load, count))
    assert loads[-1] < 0.3
    assert loads[-1] == pytest.approx(0.3, rel=1e-4)
    assert not area.misses(8)
