"""The iterate of the active-set solver, whose pressures live on the contact nodes, against whole fields."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.contact import kernels
from asperity.contact.boundaries import response_on
from asperity.contact.iterate import Iterate
from asperity.contact.places import places_in_union
from asperity.contact.problem import Control, Problem
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.types import Array


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
    iterate = Iterate.of_field(problem, pressure, value, 1e-3)
    iterate.evaluate(Control(kind, value))
    field = iterate.pressure_field()
    gap = problem.height + problem.displacement(field)
    np.testing.assert_allclose(iterate.displacement, gap - problem.height, atol=1e-14)
    np.testing.assert_allclose(iterate.gap, gap.reshape(-1)[iterate.nodes], atol=1e-14)
    if kind == "mean_pressure":
        assert field.mean() == pytest.approx(value, rel=1e-13)
    else:
        work = float(np.vdot(field, gap - value))
        assert abs(work) < 1e-12 * float(np.vdot(field, np.abs(gap - value)))


@pytest.mark.parametrize("threads", [1, 3])
def test_free_nodes_below_a_level(threads: int) -> None:
    problem, pressure = example(threads)
    iterate = Iterate.of_field(problem, pressure, 0.0, 1e-3)
    iterate.evaluate(Control("mean_pressure", 1e-3))
    gap = problem.height + iterate.displacement
    free = np.flatnonzero((pressure == 0) & (gap < np.quantile(gap, 0.3)))
    found, gaps = iterate.free_nodes_below(float(np.quantile(gap, 0.3)))
    np.testing.assert_array_equal(found, free)
    np.testing.assert_array_equal(gaps, gap.reshape(-1)[free])
    again, _ = iterate.free_nodes_below(float(np.quantile(gap, 0.1)))
    np.testing.assert_array_equal(again, free)  # known nodes above the level may be returned


def test_one_scan_for_free_nodes_follows_an_evaluation_in_double_precision(monkeypatch: Any) -> None:
    """The solution in single precision tells how far gaps will close."""
    calls = {"evaluate": 0, "_free_nodes_below": 0}

    def counted(name: str) -> None:
        genuine = getattr(Iterate, name)

        def method(self: Iterate, *arguments: Any) -> Any:
            calls[name] += self.pressure.dtype == np.float64
            return genuine(self, *arguments)

        monkeypatch.setattr(Iterate, name, method)

    for name in calls:
        counted(name)
    height = asp.self_affine((256, 256), 0.8, 1 / 8, 1 / 32, 1e-3, seed=1)
    asp.solve(height, Layer(1.0, 0.0), mean_pressure=1e-3)
    assert calls["evaluate"] == calls["_free_nodes_below"] > 0


def test_other_nodes_are_inserted_in_order_with_their_values() -> None:
    nodes, others = np.array([1, 5, 9], np.uint32), np.array([0, 6, 7, 12], np.uint32)
    places = places_in_union(nodes, others)
    np.testing.assert_array_equal(kernels.inserted(places, nodes, others), [0, 1, 5, 6, 7, 9, 12])
    values = kernels.inserted(places, np.array([1.0, 5.0, 9.0]), np.array([0.0, 6.0, 7.0, 12.0]))
    np.testing.assert_array_equal(values, [0, 1, 5, 6, 7, 9, 12])
    empty = np.empty(0, np.uint32)
    np.testing.assert_array_equal(kernels.inserted(places_in_union(empty, nodes), empty, nodes), nodes)
    np.testing.assert_array_equal(kernels.inserted(places_in_union(nodes, empty), nodes, empty), nodes)


@pytest.mark.parametrize("threads", [1, 3])
def test_nodes_without_pressure_are_dropped(threads: int) -> None:
    problem, pressure = example(threads)
    iterate = Iterate.of_field(problem, pressure, 0.0, 1e-3)
    iterate.evaluate(Control("mean_pressure", 1e-3))
    nodes, gap = iterate.nodes, iterate.gap
    np.testing.assert_array_equal(nodes, np.flatnonzero(pressure > 0))
    left = iterate.pressure > np.quantile(iterate.pressure, 0.3)
    iterate.pressure[~left] = 0
    iterate.drop_free_nodes()
    np.testing.assert_array_equal(iterate.nodes, nodes[left])
    np.testing.assert_array_equal(iterate.gap, gap[left])
    assert iterate.pressure.min() > 0
