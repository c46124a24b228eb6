"""The preconditioner against exact inverses, and the inner solve that uses it against a dense solve."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact import solve
from asperity.contact.assembly import Assembler
from asperity.contact.boundaries import response_on
from asperity.contact.inner_solve import InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Control, Problem
from asperity.contact.stencil import StencilField
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.types import Array

HALF_SPACE = Layer(1.0, 0.0)
LAYERS = {
    "half-space": HALF_SPACE,
    "tall": Layer(1.0, 0.33, height=1.0, bottom="bonded"),
    "thin": Layer(1.0, 0.3, height=0.05, bottom="bonded"),
    "incompressible": Layer(1.0, 0.5, height=0.02, bottom="bonded"),
}


def restricted(layer: Layer, shape: tuple[int, int], nodes: Array) -> tuple[Problem, Preconditioner]:
    problem = Problem(np.zeros(shape), response_on("periodic", layer, Grid(shape)))
    field = StencilField(problem.grid, repeats=True)
    preconditioner = Preconditioner(problem, field)
    field.restrict(nodes.astype(np.uint32))
    preconditioner.restrict(nodes.astype(np.uint32))
    return problem, preconditioner


def matrix_of(preconditioner: Preconditioner, count: int) -> Array:
    """The preconditioner as a dense matrix."""
    matrix = np.empty((count, count), np.float32)
    for node in range(count):
        preconditioner.apply(np.eye(1, count, node, dtype=np.float32)[0], matrix[node])
    return matrix.astype(float)


def scattered(shape: tuple[int, int], area_fraction: float) -> Array:
    """The lowest nodes of a rough surface: patches of many sizes, far apart."""
    height = asp.self_affine(shape, 0.8, 1 / 2, 8 / max(shape), 1.0, seed=1)
    return np.flatnonzero(height.reshape(-1) < np.quantile(height, area_fraction))


@pytest.mark.parametrize("layer", LAYERS)
@pytest.mark.parametrize("shape", [(64, 64), (40, 72)])
def test_preconditioner_is_symmetric_and_positive_definite(
    layer: str, shape: tuple[int, int], monkeypatch
) -> None:
    # The coarse system is solved to rounding here: stopped early, it is symmetric only to its residual.
    monkeypatch.setattr("asperity.contact.preconditioner.COARSE_RESIDUAL_DROP", 1e-6)
    nodes = scattered(shape, 0.1)
    _, preconditioner = restricted(LAYERS[layer], shape, nodes)
    matrix = matrix_of(preconditioner, nodes.size)
    assert np.abs(matrix - matrix.T).max() < 1e-5 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0


def test_coarse_grid_accounts_for_the_interaction_of_distant_patches(monkeypatch) -> None:
    """The displacement under a wave of pressure over many small patches is mapped back to that pressure.

    The stencil alone overestimates the pressure, as if every patch stood alone.
    """
    shape = (1024, 1024)
    row, column = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    nodes = np.flatnonzero((row % 10 < 2) & (column % 10 < 2))
    wave = np.cos(2 * np.pi * column[nodes] / shape[1])
    ratio = {}
    for name, iterations in (("stencil", 0), ("both", 20)):
        monkeypatch.setattr("asperity.contact.preconditioner.MAX_COARSE_ITERATIONS", iterations)
        problem, preconditioner = restricted(HALF_SPACE, shape, nodes)
        pressure = np.zeros(shape)
        pressure.reshape(-1)[nodes] = wave
        displacement = problem.displacement(pressure).reshape(-1)[nodes] / problem.nodal_compliance
        image = np.empty(nodes.size, np.float32)
        preconditioner.apply(displacement.astype(np.float32), image)
        ratio[name] = float(image @ wave) / float(wave @ wave)
    assert ratio["stencil"] > 4
    assert ratio["both"] == pytest.approx(1, abs=0.2)


def test_long_waves_in_full_contact_see_the_stiffness_of_the_solid() -> None:
    shape = (512, 512)
    problem, preconditioner = restricted(HALF_SPACE, shape, np.arange(512 * 512))
    wave = np.cos(2 * np.pi * np.arange(512) / 512)[None, :] * np.ones((512, 1))
    image = np.empty(wave.size, np.float32)
    preconditioner.apply(wave.astype(np.float32).reshape(-1), image)
    exact = problem.nodal_compliance / problem.compliance[0, 1]
    # σ q / (σ + q) is 3 % below q here, and the wave is sampled by 32 cells.
    assert float(image @ wave.reshape(-1)) / float(np.sum(wave**2)) == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize("hurst", [0.2, 0.8])
def test_pairs_of_transforms_do_not_grow_with_the_grid(hurst: float) -> None:
    """The shortest wavelength is eight nodes on every grid, so that finer grids hold more waves."""
    pairs = []
    for points in (128, 256, 512, 1024):
        height = asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)
        load = 0.05 * asp.roughness_parameters(height).rms_gradient
        pairs.append(solve(height, HALF_SPACE, mean_pressure=load, rtol=1e-6).certificate.pairs)
    exponent = np.polyfit(np.log2([128, 256, 512, 1024]), np.log2(pairs), 1)[0]
    assert exponent < 0.15
    assert max(pairs) < 30


@pytest.mark.parametrize("fixed_load", [True, False])
@pytest.mark.parametrize("layer", LAYERS)
def test_inner_solve_agrees_with_a_dense_solve(layer: str, fixed_load: bool) -> None:
    """Tolerance of the inner solve times the root of the condition number, which is below 14."""
    shape = (24, 36)
    height = asp.self_affine(shape, 0.8, 1 / 2, 1 / 6, 1e-3, seed=1)
    problem = Problem(height, response_on("periodic", LAYERS[layer], Grid(shape)))
    pressure = np.maximum(np.quantile(height, 0.2) - height, 0) * problem.modulus
    iterate = Iterate.of_field(problem, pressure, float(height.mean()), float(pressure.mean()))
    iterate.evaluate(Control("mean_pressure", float(pressure.mean())))
    solver = InnerSolver(problem)
    system = Assembler(problem, solver).assemble(iterate, fixed_load)
    np.testing.assert_allclose(iterate.pressure_field(), pressure, rtol=1e-12)
    residual, nodes = system.residual.astype(float), system.contact_nodes.astype(int)
    correction = solver.solve(system, drop=1e-5, max_iterations=100)

    unit = np.zeros(shape)
    unit[0, 0] = 1
    kernel = problem.displacement(unit) / problem.nodal_compliance
    row, column = np.divmod(nodes, shape[1])
    matrix = kernel[(row[:, None] - row) % shape[0], (column[:, None] - column) % shape[1]]
    exact = np.linalg.solve(matrix, residual)
    if fixed_load:
        uniform = np.linalg.solve(matrix, np.ones(nodes.size))
        shift = exact.sum() / uniform.sum()
        exact -= shift * uniform
        assert correction.approach == pytest.approx(-shift * problem.nodal_compliance, rel=1e-4)
        assert abs(correction.pressure.sum()) < 1e-4 * np.abs(correction.pressure).sum()
    error = np.linalg.norm(correction.pressure - exact) / np.linalg.norm(exact)
    assert error < 2e-4
    displaced = matrix @ correction.pressure
    assert np.abs(correction.displacement - displaced).max() < 2e-5 * np.abs(displaced).max()
