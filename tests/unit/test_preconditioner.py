"""The preconditioner of the fast solver against the dense compliance, and what it does for the solver."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact import solve
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Problem
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid, Work
from asperity.types import Array

HALF_SPACE = Layer(1.0, 0.0)
LAYERS = {
    "half-space": HALF_SPACE,
    "tall": Layer(1.0, 0.33, height=1.0, bottom="bonded"),
    "thin": Layer(1.0, 0.3, height=0.05, bottom="bonded"),
    "incompressible": Layer(1.0, 0.5, height=0.02, bottom="bonded"),
}


def made(layer: Layer, shape: tuple[int, int], plain: Array) -> tuple[Problem, Preconditioner]:
    problem = Problem(np.zeros(shape), layer, Grid(shape), "float64", 1, Work())
    unit = min(problem.grid.spacing) / problem.modulus
    preconditioner = Preconditioner(problem, unit)
    preconditioner.restrict(plain.astype(np.uint64))
    return problem, preconditioner


def dense(preconditioner: Preconditioner, count: int) -> Array:
    """Columns: images of the nodes one by one."""
    matrix = np.empty((count, count), np.float32)
    for node in range(count):
        preconditioner.apply(np.eye(1, count, node, dtype=np.float32)[0], matrix[node])
    return matrix.astype(float)


def scattered(shape: tuple[int, int], area_fraction: float) -> Array:
    """The lowest nodes of a surface: patches of many sizes, far apart."""
    height = asp.self_affine(shape, 0.8, 1 / 2, 8 / max(shape), 1.0, seed=1)
    return np.flatnonzero(height.reshape(-1) < np.quantile(height, area_fraction))


@pytest.mark.parametrize("layer", LAYERS)
@pytest.mark.parametrize("shape", [(64, 64), (40, 72)])
def test_it_is_symmetric_and_positive_definite(layer: str, shape: tuple[int, int], monkeypatch) -> None:
    # The coarse system is solved to the end here: stopped early, it is symmetric only to its residual.
    monkeypatch.setattr("asperity.contact.preconditioner.COARSE_DROP", 1e-6)
    plain = scattered(shape, 0.1)
    _, preconditioner = made(LAYERS[layer], shape, plain)
    matrix = dense(preconditioner, plain.size)
    assert np.abs(matrix - matrix.T).max() < 1e-5 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0


def test_patches_far_apart_bear_on_each_other(monkeypatch) -> None:
    """A wave of pressure over many small patches, and what meets its displacement: itself, of the same size.

    The stencil alone takes the displacement that the patches cause each other for their own.
    """
    shape = (1024, 1024)
    row, column = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    plain = np.flatnonzero((row % 10 < 2) & (column % 10 < 2))
    wave = np.cos(2 * np.pi * column[plain] / shape[1])
    ratio = {}
    for name, iterations in (("stencil", 0), ("both", 20)):
        monkeypatch.setattr("asperity.contact.preconditioner.COARSE_ITERATIONS", iterations)
        problem, preconditioner = made(HALF_SPACE, shape, plain)
        pressure = np.zeros(shape)
        pressure.reshape(-1)[plain] = wave
        unit = min(problem.grid.spacing) / problem.modulus
        displacement = problem.displacement(pressure).reshape(-1)[plain] / unit
        image = np.empty(plain.size, np.float32)
        preconditioner.apply(displacement.astype(np.float32), image)
        ratio[name] = float(image @ wave) / float(wave @ wave)
    assert ratio["stencil"] > 4
    assert ratio["both"] == pytest.approx(1, abs=0.2)


def test_in_full_contact_long_waves_are_met_as_by_the_whole_solid() -> None:
    shape = (512, 512)
    problem, preconditioner = made(HALF_SPACE, shape, np.arange(512 * 512))
    wave = np.cos(2 * np.pi * np.arange(512) / 512)[None, :] * np.ones((512, 1))
    image = np.empty(wave.size, np.float32)
    preconditioner.apply(wave.astype(np.float32).reshape(-1), image)
    unit = min(problem.grid.spacing) / problem.modulus
    exact = unit / problem.compliance[0, 1]
    # σ q / (σ + q) is 3 % below q here, and cells are steps of a 32nd of the wave.
    assert float(image @ wave.reshape(-1)) / float(np.sum(wave**2)) == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize("hurst", [0.2, 0.8])
def test_the_work_for_a_node_does_not_grow_with_the_grid(hurst: float) -> None:
    """Eight nodes to the shortest wave throughout, so that more and more waves are added."""
    pairs = []
    for points in (128, 256, 512, 1024):
        height = asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)
        load = 0.05 * asp.roughness_parameters(height).rms_gradient
        pairs.append(solve(height, HALF_SPACE, mean_pressure=load, rtol=1e-6).certificate.pairs)
    exponent = np.polyfit(np.log2([128, 256, 512, 1024]), np.log2(pairs), 1)[0]
    assert exponent < 0.15
    assert max(pairs) < 30
