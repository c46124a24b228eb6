"""Contacts of the surfaces that engineers press are solved, under every load and with every solid."""

from dataclasses import replace

import numpy as np
import pytest
from families import FamilyCase, family_arguments
from family_outcomes import ACCEPTABLE, SOLVED, attempt_family, family_outcomes
from samples import difference
from scipy.optimize import lsq_linear
from solution_check import check_solution, energy_error, free_compliance

from asperity.contact import solve_contact, verify_contact


def solved(case):
    """Contact of a case, and the quantity imposed on it."""
    height, solid, imposed, settings = family_arguments(case)
    return solve_contact(height, solid, **imposed, **settings), imposed


def test_every_family_is_solved_at_every_setting():
    found = family_outcomes(every=32)
    assert found[~found["outcome"].isin(ACCEPTABLE)].empty
    assert found["outcome"].isin(SOLVED).mean() > 0.9


def load(exponent, **settings):
    return {"imposed": ("load", 10.0**exponent)} | settings


FREE, SHEET, TIGHT = {"boundary": "free"}, {"solid": "sheet"}, {"precision": ("float64", 1e-10)}
SINGLE = {"precision": ("float32", 1e-4)}


@pytest.mark.parametrize(
    "settings",
    [
        # A height that nothing reaches.
        *(load(exponent, relief=0.01, shape=(128, 128)) for exponent in (-8, -6)),
        load(-8, relief=0.1, shape=(128, 128)),
        load(-6, shape=(128, 128)),
        *(load(exponent, relief=10.0, shape=(128, 128)) for exponent in (-8, -4)),
        load(-6, family="square punch", shape=(101, 101)),
        load(-4, family="square punch", shape=(201, 201)),
        load(-9, family="checkerboard", shape=(5, 5), relief=1e6),
        load(-7, family="pit", shape=(5, 5)),
        load(-6, family="ring", shape=(61, 61)),
        load(-6, family="10 levels", shape=(33, 33)),
        load(-10, family="ridge", shape=(53, 18), relief=1e3),
        # A free boundary.
        load(-6, family="steps", shape=(16, 16), relief=10.0, size=0.2, **FREE),
        load(-2, family="square punch", shape=(16, 16), relief=1e4, **FREE),
        load(-6, family="worn plateaus", shape=(101, 101), relief=0.1, **FREE),
        # An imposed approach or area.
        {"family": "steps", "shape": (1, 10), "imposed": ("approach", 1e-5)},
        {"family": "8-bit map", "imposed": ("approach", 1e-6)},
        {"family": "groove", "imposed": ("area", 0.1), "offset": 1e13, "size": 0.3, **SINGLE},
        # A hardness.
        load(-3, family="terraces", shape=(16, 16), relief=100.0, size=0.1, hardness=30.0),
        load(-3, family="square punch", shape=(8, 8), relief=100.0, hardness=1.1),
        load(-5, family="square punch", shape=(16, 16), hardness=2.0, **FREE),
        load(-9, family="pits", shape=(128, 128), relief=1e6, size=0.1, hardness=1.1, **FREE, **TIGHT),
        # Heights far from zero, both precisions, a tight tolerance.
        load(-6, family="checkerboard", shape=(5, 5), offset=1e6),
        load(-3, family="rough", offset=1e13),
        load(-7, family="square punch", shape=(31, 31), offset=1.0, size=0.1, **FREE, **SINGLE),
        load(-3, family="checkerboard", shape=(16, 16), relief=1e4, **TIGHT),
        # Other solids.
        load(-3, relief=100.0, solid="two bodies"),
        load(-8, family="square punch", shape=(61, 61), relief=0.01, solid="free bottom"),
        load(-5, family="groove", shape=(97, 53), relief=1e-5, size=0.1, solid="very thin"),
        load(-6, family="square punch", shape=(16, 16), **SHEET),
        {"family": "square punch", "shape": (8, 8), "imposed": ("area", 0.7), **SHEET},
        *(load(-2, family="steps", shape=(nodes, nodes), size=0.1, **SHEET) for nodes in (33, 64)),
    ],
    ids=lambda settings: " ".join(map(str, settings.values())),
)
def test_contacts_that_an_active_set_lost_are_solved(settings):
    found = attempt_family(FamilyCase(**{"family": "round punch"} | settings))
    assert found.outcome in SOLVED, f"{found.outcome}: {found.reason}"


@pytest.mark.parametrize(
    "settings", [load(-6), load(-6, hardness=30.0), load(-4, family="rough", relief=1e-3, **FREE)]
)
def test_check_refuses_a_tampered_solution(settings):
    """Although the certificate of heights that nothing reaches sees no violation."""
    contact, imposed = solved(FamilyCase(**{"family": "worn plateaus", "relief": 0.1} | settings))
    assert check_solution(contact, imposed, 1e-6).holds
    wrong = contact.pressure * np.random.default_rng(1).uniform(-1, 1, contact.pressure.shape)
    wrong *= contact.pressure < contact.hardness
    wrong -= contact.pressure * wrong.sum() / contact.pressure.sum()
    tampered = replace(contact, pressure=np.minimum(contact.pressure + 1e-3 * wrong, contact.hardness))
    if "relief" not in settings:
        assert verify_contact(contact.height, tampered.pressure, contact.solid).contact_gap < 1e-6
    assert not check_solution(tampered, imposed, 1e-6).holds


@pytest.mark.parametrize("hardness", [None, 2.0])
@pytest.mark.parametrize("size", [1e-4, 1.0])
def test_energy_bound_of_a_free_map_holds(hardness, size):
    """Against a bounded quadratic program on a dense matrix, by scipy, at the same approach."""
    case = FamilyCase("rough", (12, 12), imposed=("load", 1e-1), hardness=hardness, **FREE, **TIGHT)
    contact, _ = solved(case)
    matrix, _, _ = free_compliance(contact.grid, contact.boundary)
    matrix = matrix / contact.solid.effective_modulus
    root = np.linalg.cholesky(matrix).T
    target = np.linalg.solve(root.T, contact.approach - contact.height.ravel())
    exact = lsq_linear(root, target, (0, contact.hardness), method="bvls", tol=1e-14).x
    assert difference(contact.pressure.ravel(), exact) < 1e-8
    # Pressures at the hardness stay there: below it their overlap counts in full.
    noise = size * np.random.default_rng(2).uniform(-1, 1, contact.pressure.shape)
    noise *= contact.pressure < contact.hardness
    pressure = np.clip(contact.pressure * (1 + noise), 0, contact.hardness)
    bound, _ = energy_error(contact, contact.height, pressure, 0.0, approach=contact.approach)
    wrong = pressure.ravel() - exact
    true = np.sqrt(wrong @ matrix @ wrong / (pressure.ravel() @ matrix @ pressure.ravel()))
    assert 0.02 * bound < true < bound * (1 + 1e-6)
