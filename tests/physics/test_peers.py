"""Pressures and stresses of other programs (`make peers`), within the tolerances of both."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from samples import load_of, rough

import asperity as asp

pytestmark = [pytest.mark.peers, pytest.mark.filterwarnings("ignore::ImportWarning")]  # of NuMPI, without MPI
PEERS = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks/peers.py"))
CANDIDATES = "ASPHER, candidate nodes"
UNIT = asp.Solid(1.0, 0.0)


@pytest.mark.parametrize(
    ("program", "boundary"),
    [
        (program, boundary)
        for program in PEERS["SOLVERS"]
        for boundary in ("periodic", "free")
        if program.partition(", ")[2] != "single precision"  # which has no tolerance
        and (program, boundary) != (CANDIDATES, "periodic")  # whose sums have no period
    ],
)
def test_pressure_agrees_with_other_programs(program, boundary):
    height = rough((128, 128), 2)
    theirs = PEERS["SOLVERS"][program](height, load_of(height), 1e-11, boundary)
    ours = asp.solve_contact(
        height, UNIT, mean_pressure=load_of(height), boundary=boundary, rtol=1e-11
    ).pressure
    tolerance = 2e-5 if program == CANDIDATES else 1e-8  # that of its hierarchical sum
    np.testing.assert_allclose(ours, theirs[:128, :128], atol=tolerance * ours.max())


@pytest.mark.parametrize("share", [0.5, 0.2])
def test_plastic_pressure_is_that_of_contact_mechanics(share):
    height = rough((256, 256))
    load = load_of(height, 0.02)
    hardness = share * asp.solve_contact(height, UNIT, mean_pressure=load).maximum_pressure
    ours = asp.solve_contact(height, UNIT, mean_pressure=load, hardness=hardness, rtol=1e-10).pressure
    theirs = PEERS["contact_mechanics"](height, load, 1e-11, "periodic", hardness)
    np.testing.assert_allclose(ours, theirs, atol=1e-7 * hardness)


def test_adhesive_pressure_is_that_of_tamaas():
    height = rough((128, 128), 2)
    adhesion = asp.Adhesion.fitted(1e-6, UNIT, asp.Grid((128, 128)))
    approach = float(height.min() + 0.3 * (height.mean() - height.min()))
    ours = asp.solve_contact(height, UNIT, approach=approach, adhesion=adhesion, rtol=1e-8).pressure
    theirs = PEERS["tamaas_adhesion"](height, adhesion, height.mean() - approach, 1e-10)
    np.testing.assert_allclose(ours, theirs, atol=1e-6 * adhesion.strength)


def test_stress_is_that_of_tamaas():
    """All components at the surface and two depths, to rounding."""
    height = rough((32, 32))
    contact = asp.solve_contact(height, asp.Solid(1.0, 0.3), mean_pressure=load_of(height))
    assert PEERS["stress_difference"](asp.LoadedSolid.of(contact), np.array([0.01, 0.1])) < 1e-13
