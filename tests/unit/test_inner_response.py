"""The displacement in inner solves against the whole convolution, and stencils against sums."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity import parallel
from asperity.contact.boundaries import response_on
from asperity.contact.even_nodes import add_interpolated, add_transposed, places_of, spread_transposed
from asperity.contact.inner_response import MIN_POINTS, FarField, InnerResponse
from asperity.contact.problem import Problem
from asperity.contact.response import PeriodicResponse
from asperity.contact.stencil import RADIUS, StencilField, whole_stencil
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import Solid, TwoBodies
from asperity.spectral import Grid
from asperity.types import Array

SOLIDS = {
    "half-space": Layer(1.0, 0.0),
    "tall": Layer(1.0, 0.3, height=0.5, bottom="bonded"),
    "thin": Layer(1.0, 0.3, height=0.01, bottom="bonded"),
    "incompressible": Layer(1.0, 0.5, height=0.02, bottom="bonded"),
}


def contact_nodes(shape: tuple[int, int]) -> Array:
    """The lowest tenth of the nodes of a rough surface."""
    height = asp.self_affine((512, 512), 0.8, 1 / 8, 8 / 512, 1.0, seed=1)[: shape[0], : shape[1]].reshape(-1)
    return np.flatnonzero(height < np.quantile(height, 0.1)).astype(np.uint32)


@pytest.mark.parametrize(
    ("boundary", "solid", "shape"),
    [("periodic", solid, (256, 192)) for solid in SOLIDS]
    + [("free", "half-space", (256, 192)), ("free", "half-space", (255, 201))],
)
def test_displacement_of_inner_solves_is_right_to_a_few_per_cent(
    boundary: str, solid: str, shape: tuple[int, int]
) -> None:
    """Error of the division into near and far field, under pressures without any order, the hardest case."""
    grid = Grid(shape, (shape[0] / 256, shape[1] / 256))
    problem = Problem(np.zeros(shape), response_on(boundary, SOLIDS[solid], grid))
    nodes = contact_nodes(shape)
    pressure = np.random.default_rng(0).standard_normal(nodes.size).astype(np.float32)
    inner = InnerResponse(problem)
    inner.restrict(nodes)
    field = np.zeros(grid.size)
    field[nodes] = pressure
    exact = problem.displacement(field.reshape(shape)).reshape(-1) / problem.nodal_compliance
    found = np.empty_like(pressure)
    inner.respond(pressure, found)
    assert np.linalg.norm(found - exact[nodes]) < 0.025 * np.linalg.norm(exact[nodes])
    everywhere = inner.respond_at(np.arange(grid.size, dtype=np.uint32), pressure)
    assert np.linalg.norm(everywhere - exact) < 0.03 * np.linalg.norm(exact)
    np.testing.assert_array_equal(everywhere[nodes], found)
    single = inner.of_all_nodes(pressure).reshape(-1)
    assert np.linalg.norm(single - exact) < 1e-5 * np.linalg.norm(exact)


@pytest.mark.parametrize("shape", [(MIN_POINTS - 2, 256), (255, 256)])
def test_small_and_odd_grids_are_not_divided(shape: tuple[int, int]) -> None:
    problem = Problem(np.zeros(shape), response_on("periodic", SOLIDS["thin"], Grid(shape)))
    nodes = contact_nodes(shape)
    inner = InnerResponse(problem)
    inner.restrict(nodes)
    pressure = np.ones(nodes.size, np.float32)
    found = np.empty_like(pressure)
    inner.respond(pressure, found)
    field = np.zeros(shape)
    field.reshape(-1)[nodes] = 1
    exact = problem.displacement(field).reshape(-1)[nodes] / problem.nodal_compliance
    np.testing.assert_allclose(found, exact, rtol=1e-4)


@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize("shape", [(9, 12), (7, 5), (3, 40)])
def test_stencil_against_the_sum_of_its_definition(shape: tuple[int, int], repeats: bool) -> None:
    """Rounding in single precision. The weights depend on the parity of the node of the product."""
    generator = np.random.default_rng(1)
    quadrants = generator.standard_normal((2, 2, RADIUS + 1, RADIUS + 1)).astype(np.float32)
    nodes = np.flatnonzero(generator.random(shape).reshape(-1) < 0.5).astype(np.uint32)
    values = generator.standard_normal(nodes.size).astype(np.float32)
    field = np.zeros(shape)
    field.reshape(-1)[nodes] = values

    def product(node: int) -> float:
        row, column = divmod(node, shape[1])
        total = 0.0
        for i in range(-RADIUS, RADIUS + 1):
            for j in range(-RADIUS, RADIUS + 1):
                y, x = row + i, column + j
                if repeats or (0 <= y < shape[0] and 0 <= x < shape[1]):
                    weight = quadrants[row % 2, column % 2, abs(i), abs(j)]
                    total += weight * field[y % shape[0], x % shape[1]]
        return total

    stencil = StencilField(Grid(shape), repeats)
    for chosen in (nodes[::2], nodes):  # restricted twice: nothing of the first may be left
        stencil.restrict(chosen)
    found = np.empty_like(values)
    stencil.apply(whole_stencil(quadrants), values, found)
    np.testing.assert_allclose(found, [product(int(node)) for node in nodes], rtol=1e-4, atol=1e-4)
    others = np.arange(shape[0] * shape[1], dtype=np.uint32)
    everywhere = stencil.apply_at(whole_stencil(quadrants), values, others)
    np.testing.assert_allclose(everywhere, [product(int(node)) for node in others], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("repeats", [True, False])
def test_strips_and_threads_change_no_bit_of_a_stencil(repeats, monkeypatch) -> None:
    generator, shape = np.random.default_rng(3), (301, 203)
    weights = whole_stencil(generator.random((2, 2, RADIUS + 1, RADIUS + 1)).astype(np.float32))
    nodes = np.flatnonzero(generator.random(shape).reshape(-1) < 0.6).astype(np.uint32)
    values, found = generator.random(nodes.size).astype(np.float32), []
    for least_rows, threads in ((shape[0], 1), (2, 1), (5, 2)):
        monkeypatch.setattr("asperity.contact.stencil._STRIP", 1)
        monkeypatch.setattr("asperity.contact.stencil._LEAST_ROWS", least_rows)
        stencil = StencilField(Grid(shape), repeats, threads)
        stencil.restrict(nodes)
        found.append(np.empty_like(values))
        stencil.apply(weights, values, found[-1])
    np.testing.assert_array_equal(found[1], found[0])
    np.testing.assert_array_equal(found[2], found[0])


@pytest.mark.parametrize("solid", [SOLIDS["half-space"], TwoBodies(SOLIDS["tall"], SOLIDS["thin"])])
def test_strips_and_threads_change_no_bit_of_a_compliance(solid: Solid, monkeypatch: Any) -> None:
    grid = Grid((134, 160))
    whole = PeriodicResponse.on(solid, grid, "float64")
    np.testing.assert_array_equal(whole.half_compliance, solid.half_grid_surface_compliance(grid))
    pressure = np.random.default_rng(0).random(200)
    nodes = np.arange(0, grid.size, grid.size // 200, dtype=np.uint32)[:200]

    def far_field(response: PeriodicResponse) -> Array:
        far, out = FarField(response, 1.0), np.zeros(grid.size)
        far.restrict(nodes)
        far.spread(pressure)
        far.add_at(np.arange(grid.size, dtype=np.uint32), out)
        return out

    expected = far_field(whole)
    monkeypatch.setattr(parallel, "STRIP", 300)
    for threads in (1, 3):
        response = PeriodicResponse.on(solid, grid, "float64", threads)
        np.testing.assert_array_equal(response.half_compliance, whole.half_compliance)
        np.testing.assert_array_equal(far_field(response), expected)


def test_restriction_to_even_nodes_is_the_transpose_of_interpolation() -> None:
    ny, nx = 8, 10
    width = nx // 2 + 1
    generator = np.random.default_rng(2)
    for nodes in (np.arange(ny * nx, dtype=np.uint32), np.array([3, 17, 28, 29, 71], np.uint32)):
        places = places_of(nodes, (ny, nx), width)
        coarse = generator.random((ny // 2 + 1, width))
        values = generator.random(nodes.size)
        interpolated = np.zeros(nodes.size)
        add_interpolated(coarse.reshape(-1), places, width, interpolated)
        summed = np.zeros_like(coarse)
        add_transposed(places, values, width, summed.reshape(-1))
        assert np.vdot(interpolated, values) == pytest.approx(np.vdot(coarse, summed), rel=1e-12)
        plane = np.add.outer(2.0 * np.arange(ny // 2 + 1), 6.0 * np.arange(width))
        linear = np.zeros(nodes.size)
        add_interpolated(plane.reshape(-1), places, width, linear)
        row, column = np.divmod(nodes.astype(int), nx)
        np.testing.assert_allclose(linear, row + 3.0 * column)


@pytest.mark.parametrize("strips", [2, 3, 8])
def test_pressures_are_added_up_strip_by_strip(strips: int) -> None:
    """As all at once on a field of zeros, whatever the field held before."""
    ny, nx = shape = (48, 40)
    rows, width = ny // 2 + 1, nx // 2 + 1
    nodes = np.flatnonzero(np.random.default_rng(0).random(ny * nx) < 0.3).astype(np.uint32)
    values, places = np.random.default_rng(1).random(nodes.size), places_of(nodes, shape, width)
    expected = np.zeros(rows * width)
    add_transposed(places, values, width, expected)
    edges = rows * np.arange(strips + 1) // strips
    first = np.searchsorted(nodes, np.minimum(2 * edges, ny) * nx)
    field = np.full(rows * width, 7.0)
    for odd, count in enumerate(((strips + 1) // 2, strips // 2)):
        for number in range(count):
            spread_transposed(places, values, first, edges, width, number, number + 1, odd, field)
    np.testing.assert_allclose(field, expected, rtol=1e-14)
