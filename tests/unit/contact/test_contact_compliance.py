"""The approximate compliance of inner solves and its inverse against exact convolutions and dense solves."""

import numpy as np
import pytest
from samples import HALF_SPACE, difference

import asperity as asp
from asperity.contact.contact_nodes import RADIUS, StencilProduct, whole_stencil
from asperity.contact.inner_solve import InnerSolver, System
from asperity.contact.load import AreaControl
from asperity.contact.operators import InnerResponse
from asperity.contact.response import response_on
from asperity.core import parallel

THIN = asp.Solid(1.0, 0.3, height=0.01)
SOLIDS = [HALF_SPACE, asp.Solid(1.0, 0.3, height=0.5), THIN, asp.Solid(1.0, 0.5, height=0.02)]
SOLIDS += [asp.Solid(3.0, 0.2, 0.02, base=HALF_SPACE), asp.Solid(0.2, 0.5, 0.02, base=HALF_SPACE)]


def lowest_nodes(shape, contact_area_fraction=0.1):
    """The lowest nodes of a rough surface: patches of many sizes, far apart."""
    height = asp.self_affine((512, 512), 0.8, 1 / 8, 8 / 512, 1.0, seed=1)[: shape[0], : shape[1]].reshape(-1)
    return np.flatnonzero(height < np.quantile(height, contact_area_fraction)).astype(np.uint32)


def displacement(response, nodes, pressure):
    """Exact displacement of all nodes, in units of the nodal compliance."""
    field = np.zeros(response.grid.shape)
    field.reshape(-1)[nodes] = pressure
    return response.displacement(field).reshape(-1) / response.nodal_compliance


@pytest.mark.parametrize(
    ("boundary", "solid", "shape"),
    [
        ("periodic", THIN, (256, 192)),
        ("periodic", HALF_SPACE, (256, 192)),
        ("mirrored", THIN, (256, 192)),
        ("mirrored", HALF_SPACE, (202, 192)),
        ("free", HALF_SPACE, (255, 201)),
        ("free along y", HALF_SPACE, (255, 202)),
        ("free along x", HALF_SPACE, (200, 255)),
    ],
)
def test_inner_displacement_is_right_to_few_per_cent(boundary, solid, shape):
    """Error of the division into near and far field, under pressures without any order, the hardest case."""
    grid = asp.Grid(shape, (shape[0] / 256, shape[1] / 256), boundary == "mirrored")
    response = response_on("periodic" if boundary == "mirrored" else boundary, solid, grid)
    inner, nodes = InnerResponse(response, StencilProduct(grid, response.free)), lowest_nodes(shape)
    pressure = np.random.default_rng(0).standard_normal(nodes.size).astype(np.float32)
    exact = displacement(response, nodes, pressure)
    every = np.arange(grid.size, dtype=np.uint32)
    found = inner.displacement(pressure, nodes, inner.indices(nodes))
    everywhere = inner.displacement(pressure, nodes, inner.indices(nodes), every)
    assert difference(found, exact[nodes]) < 0.025
    assert difference(everywhere, exact) < 0.03
    np.testing.assert_array_equal(everywhere[nodes], found)


@pytest.mark.parametrize(
    "modes", [("wrap",) * 2, ("symmetric",) * 2, ("constant",) * 2, ("wrap", "constant")]
)
@pytest.mark.parametrize("shape", [(9, 12), (7, 5), (3, 40), (1, 2)])
def test_stencil_is_the_sum_of_its_definition(shape, modes):
    """Rounding in single precision. The weights depend on the parity of the node of the product."""
    generator, grid = np.random.default_rng(1), asp.Grid(shape, mirrored=modes[0] == "symmetric")
    edge = 2 * RADIUS + 1
    weights = generator.standard_normal((edge, edge)).astype(np.float32)
    nodes = np.flatnonzero(generator.random(grid.size) < 0.5).astype(np.uint32)
    values = generator.standard_normal(nodes.size).astype(np.float32)
    field = np.zeros(shape)
    field.reshape(-1)[nodes] = values
    around = np.pad(field, [(RADIUS,) * 2, (0, 0)], modes[0])
    around, expected = np.pad(around, [(0, 0), (RADIUS,) * 2], modes[1]), np.zeros(shape)
    for row, column in np.ndindex(shape):
        turned = weights[:: 1 - 2 * (row % 2), :: 1 - 2 * (column % 2)]
        expected[row, column] = (turned * around[row : row + edge, column : column + edge]).sum()
    multiply, stencil = (
        StencilProduct(grid, (modes[0] == "constant", modes[1] == "constant")),
        whole_stencil(weights),
    )
    for others in (nodes, np.arange(grid.size, dtype=np.uint32)):
        found = multiply(stencil, nodes, values, others)
        np.testing.assert_allclose(found, expected.reshape(-1)[others], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("solid", [HALF_SPACE, asp.TwoBodies(*SOLIDS[1:3])])
def test_threads_and_strips_change_no_bit(solid, mirrored, monkeypatch):
    grid, nodes = asp.Grid((134, 160), mirrored=mirrored), lowest_nodes((134, 160), 0.5)
    pressure = np.random.default_rng(0).random(nodes.size).astype(np.float32)

    def found(threads):
        response = response_on("periodic", solid, grid, threads=threads)
        inner = InnerResponse(response, StencilProduct(grid, response.free, threads))
        return response.half_compliance, inner.displacement(pressure, nodes, inner.indices(nodes))

    expected = found(1)
    np.testing.assert_array_equal(expected[0], solid.surface_compliance(grid.half_wavenumber()))
    monkeypatch.setattr(parallel, "STRIP", 300)
    monkeypatch.setattr(parallel, "SMALLEST_PART", 500)
    for threads in (1, 3):
        for one, other in zip(found(threads), expected, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("solid", "shape"), [(HALF_SPACE, (64, 64)), (THIN, (40, 72))])
def test_preconditioner_is_symmetric_and_positive_definite(solid, shape, mirrored, monkeypatch):
    # The coarse system is solved to rounding here: stopped early, it is symmetric only to its residual.
    monkeypatch.setattr("asperity.contact.operators.COARSE_RESIDUAL_DROP", 1e-6)
    solver = InnerSolver(response_on("periodic", solid, asp.Grid(shape, mirrored=mirrored)))
    operators = solver.operators(lowest_nodes(shape))
    units = np.eye(operators.nodes.size, dtype=np.float32)
    matrix = np.array([operators.precondition(unit) for unit in units], float)
    assert np.abs(matrix - matrix.T).max() < 1e-5 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0
    np.testing.assert_allclose(operators.uniform, matrix.sum(axis=0), rtol=1e-3)


@pytest.mark.parametrize("fixed_load", [True, False])
@pytest.mark.parametrize("solid", SOLIDS)
def test_inner_solve_agrees_with_dense_solve(solid, fixed_load):
    """Tolerance of the inner solve times the root of the condition number, which is below 14."""
    grid, nodes = asp.Grid((24, 36)), lowest_nodes((24, 36), 0.2)
    response = response_on("periodic", solid, grid)
    solver = InnerSolver(response)
    operators = solver.operators(nodes)
    residual = np.random.default_rng(0).random(nodes.size).astype(np.float32)
    system = System(operators, residual, operators.precondition(residual), fixed_load)
    correction = solver.solve(system, drop=1e-5, max_iterations=100)
    np.testing.assert_array_equal(system.preconditioned, operators.precondition(residual))

    matrix = np.array([displacement(response, [node], 1.0)[nodes] for node in nodes]).T
    exact = np.linalg.solve(matrix, residual)
    if fixed_load:
        uniform = np.linalg.solve(matrix, np.ones(nodes.size))
        shift = exact.sum() / uniform.sum()
        exact -= shift * uniform
        assert correction.approach == pytest.approx(-shift * response.nodal_compliance, rel=1e-4)
        assert abs(correction.pressure.sum()) < 1e-4 * np.abs(correction.pressure).sum()
    assert difference(correction.pressure, exact) < 1e-3
    displaced = matrix @ correction.pressure
    assert np.abs(correction.displacement - displaced).max() < 2e-5 * np.abs(displaced).max()


def test_bracket_of_the_load_is_halved():
    """A guess is taken if it lies inside and the bracket has shrunk to half; the ends count 40 and 60."""
    area = AreaControl(0.5, 100, rtol=1e-6)
    assert area.bracketed(1.0, 40, 3.0) == 3.0
    assert area.bracketed(3.0, 60, 2.4) == 2.4
    assert area.bracketed(2.4, 60, 1.9) == pytest.approx(1.7)
    assert area.bracketed(1.7, 60, 1.2) == 1.2
    assert area.bracketed(1.2, 40, 1.8) == pytest.approx(1.45)
