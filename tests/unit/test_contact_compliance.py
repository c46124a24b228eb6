"""The approximate compliance of inner solves and its inverse against exact convolutions and dense solves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.contact.active_set.inner_solve import InnerSolver, System
from asperity.contact.compliance import preconditioner, response_on
from asperity.contact.compliance.inner_response import InnerResponse
from asperity.contact.compliance.response import Response
from asperity.contact.compliance.stencil import RADIUS, StencilProduct, whole_stencil
from asperity.core import parallel
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import TwoBodies
from asperity.fourier.grid import Grid

SOLIDS = {
    "half-space": Layer(1.0, 0.0),
    "tall": Layer(1.0, 0.3, height=0.5, bottom="bonded"),
    "thin": Layer(1.0, 0.3, height=0.01, bottom="bonded"),
    "incompressible": Layer(1.0, 0.5, height=0.02, bottom="bonded"),
}


def lowest_nodes(shape: tuple[int, int], area_fraction: float = 0.1) -> Array:
    """The lowest nodes of a rough surface: patches of many sizes, far apart."""
    height = asp.self_affine((512, 512), 0.8, 1 / 8, 8 / 512, 1.0, seed=1)[: shape[0], : shape[1]].reshape(-1)
    return np.flatnonzero(height < np.quantile(height, area_fraction)).astype(np.uint32)


def displacement(response: Response, nodes: Array, pressure: Array) -> Array:
    """Exact displacement of all nodes, in units of the nodal compliance."""
    field = np.zeros(response.grid.size)
    field[nodes] = pressure
    return response.displacement(field.reshape(response.grid.shape)).reshape(-1) / response.nodal_compliance


@pytest.mark.parametrize(
    ("boundary", "solid", "shape"),
    [
        ("periodic", "thin", (256, 192)),
        ("periodic", "half-space", (256, 192)),
        ("free", "half-space", (255, 201)),
    ],
)
def test_inner_displacement_is_right_to_a_few_per_cent(
    boundary: str, solid: str, shape: tuple[int, int]
) -> None:
    """Error of the division into near and far field, under pressures without any order, the hardest case."""
    grid = Grid(shape, (shape[0] / 256, shape[1] / 256))
    response = response_on(boundary, SOLIDS[solid], grid)
    inner = InnerResponse(response, StencilProduct(grid, response.repeats))
    nodes = lowest_nodes(shape)
    pressure = np.random.default_rng(0).standard_normal(nodes.size).astype(np.float32)
    exact = displacement(response, nodes, pressure)
    found = inner.displacement(pressure, nodes, inner.indices(nodes))
    assert np.linalg.norm(found - exact[nodes]) < 0.025 * np.linalg.norm(exact[nodes])
    at = np.arange(grid.size, dtype=np.uint32)
    everywhere = inner.displacement(pressure, nodes, inner.indices(nodes), at)
    assert np.linalg.norm(everywhere - exact) < 0.03 * np.linalg.norm(exact)
    np.testing.assert_array_equal(everywhere[nodes], found)


@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize("shape", [(9, 12), (7, 5), (3, 40)])
def test_stencil_agrees_with_the_sum_of_its_definition(shape: tuple[int, int], repeats: bool) -> None:
    """Rounding in single precision. The weights depend on the parity of the node of the product."""
    generator, grid = np.random.default_rng(1), Grid(shape)
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

    multiply, weights, rows = (
        StencilProduct(grid, repeats),
        whole_stencil(quadrants),
        nodes,
    )
    for others in (nodes, np.arange(grid.size, dtype=np.uint32)):
        found = multiply(weights, rows, values, others)
        np.testing.assert_allclose(found, [product(int(node)) for node in others], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("solid", [SOLIDS["half-space"], TwoBodies(SOLIDS["tall"], SOLIDS["thin"])])
def test_threads_and_strips_change_no_bit(solid: Any, monkeypatch: Any) -> None:
    grid = Grid((134, 160))
    nodes = lowest_nodes(grid.shape, 0.5)
    pressure = np.random.default_rng(0).random(nodes.size).astype(np.float32)

    def found(threads: int) -> tuple[Array, Array]:
        response = response_on("periodic", solid, grid, threads=threads)
        inner = InnerResponse(response, StencilProduct(grid, repeats=True, threads=threads))
        return response.half_compliance, inner.displacement(pressure, nodes, inner.indices(nodes))

    expected = found(1)
    np.testing.assert_array_equal(expected[0], solid.half_grid_surface_compliance(grid))
    monkeypatch.setattr(parallel, "STRIP", 300)
    monkeypatch.setattr(parallel, "SMALLEST_PART", 500)
    for threads in (1, 3):
        for one, other in zip(found(threads), expected, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(("layer", "shape"), [("half-space", (64, 64)), ("thin", (40, 72))])
def test_preconditioner_is_symmetric_and_positive_definite(
    layer: str, shape: tuple[int, int], monkeypatch: Any
) -> None:
    # The coarse system is solved to rounding here: stopped early, it is symmetric only to its residual.
    monkeypatch.setattr(preconditioner, "COARSE_RESIDUAL_DROP", 1e-6)
    operators = InnerSolver(response_on("periodic", SOLIDS[layer], Grid(shape))).operators(
        lowest_nodes(shape)
    )
    count = operators.nodes.size
    columns = [operators.precondition(np.eye(1, count, node, dtype=np.float32)[0]) for node in range(count)]
    matrix = np.array(columns, float)
    assert np.abs(matrix - matrix.T).max() < 1e-5 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0
    np.testing.assert_allclose(operators.uniform, matrix.sum(axis=0), rtol=1e-3)


def test_coarse_grid_accounts_for_distant_patches(monkeypatch: Any) -> None:
    """The displacement under a wave of pressure over many small patches is mapped back to that pressure.

    The stencil alone overestimates the pressure, as if every patch stood alone.
    """
    grid = Grid((1024, 1024))
    row, column = np.divmod(np.arange(grid.size), 1024)
    nodes = np.flatnonzero((row % 10 < 2) & (column % 10 < 2)).astype(np.uint32)
    wave = np.cos(2 * np.pi * column[nodes] / 1024)
    ratio = {}
    for name, iterations in (("stencil", 0), ("both", 20)):
        monkeypatch.setattr(preconditioner, "MAX_COARSE_ITERATIONS", iterations)
        response = response_on("periodic", SOLIDS["half-space"], grid)
        overlap = displacement(response, nodes, wave)[nodes].astype(np.float32)
        found = InnerSolver(response).operators(nodes).precondition(overlap)
        ratio[name] = float(found @ wave) / float(wave @ wave)
    assert ratio["stencil"] > 4
    assert ratio["both"] == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize("fixed_load", [True, False])
@pytest.mark.parametrize("layer", SOLIDS)
def test_inner_solve_agrees_with_a_dense_solve(layer: str, fixed_load: bool) -> None:
    """Tolerance of the inner solve times the root of the condition number, which is below 14."""
    grid = Grid((24, 36))
    response = response_on("periodic", SOLIDS[layer], grid)
    solver = InnerSolver(response)
    nodes = lowest_nodes(grid.shape, 0.2)
    operators = solver.operators(nodes)
    residual = np.random.default_rng(0).random(nodes.size).astype(np.float32)
    system = System(operators, residual, operators.precondition(residual), fixed_load)
    correction = solver.solve(system, drop=1e-5, max_iterations=100)
    np.testing.assert_array_equal(system.preconditioned, operators.precondition(residual))

    kernel = displacement(response, np.zeros(1, int), np.ones(1)).reshape(grid.shape)
    row, column = np.divmod(nodes.astype(int), grid.shape[1])
    matrix = kernel[(row[:, None] - row) % grid.shape[0], (column[:, None] - column) % grid.shape[1]]
    exact = np.linalg.solve(matrix, residual)
    if fixed_load:
        uniform = np.linalg.solve(matrix, np.ones(nodes.size))
        shift = exact.sum() / uniform.sum()
        exact -= shift * uniform
        assert correction.approach == pytest.approx(-shift * response.nodal_compliance, rel=1e-4)
        assert abs(correction.pressure.sum()) < 1e-4 * np.abs(correction.pressure).sum()
    assert np.linalg.norm(correction.pressure - exact) < 1e-3 * np.linalg.norm(exact)
    displaced = matrix @ correction.pressure
    assert np.abs(correction.displacement - displaced).max() < 2e-5 * np.abs(displaced).max()
