"""The finite-element slab: its matrices against scikit-fem's own, exact solutions, and its contact."""

import numpy as np
import pytest
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

from asperity.reference.finite_element import Slab, graded, press

YOUNG, POISSON = 1.3, 0.3


@pytest.fixture(scope="module")
def slab():
    return Slab(graded(0.5, 3, 2.0), 1 - graded(1.0, 4, 3.0)[::-1], YOUNG, POISSON)


def test_stiffness_is_that_of_27_node_hexahedra(slab):
    plane, column = slab.plane.edges, slab.column.edges
    mesh = skfem.MeshHex.init_tensor(plane, plane, column)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=4)
    stiffness = linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis)
    assert stiffness.shape[0] == 3 * np.prod(slab.shape)

    def numbers(lines, positions):
        return np.abs(lines[:, None] - positions[None, :]).argmin(axis=0)

    x, y, z = basis.doflocs
    node = [numbers(slab.column.nodes, z), numbers(slab.plane.nodes, y), numbers(slab.plane.nodes, x)]
    component = np.empty(len(x), int)
    for number, name in enumerate(("u^1", "u^2", "u^3")):
        component[basis.get_dofs(elements=True).all(name)] = number
    displacement = np.random.default_rng(0).standard_normal((3, *slab.shape))
    ours = slab.force(displacement)[component, *node]
    theirs = stiffness @ displacement[component, *node]
    # Rounding.
    np.testing.assert_allclose(ours, theirs, atol=1e-12 * np.abs(theirs).max())


def test_stress_is_exact_at_gauss_points(slab):
    """Of a field of the elements, and of x³ and z³: their quadratic interpolants have their slopes there."""
    z, y, x = np.meshgrid(slab.column.nodes, slab.plane.nodes, slab.plane.nodes, indexing="ij")
    moved = np.stack([x * y + z**2 + x**3, 2 * x * z, x**2 - 3 * y * z + z**3])
    along, up, displacement, stress = slab.on_diagonal(moved)
    z, x = np.meshgrid(up, along, indexing="ij")
    mu, lame = slab.shear_modulus, slab.lame
    extension = np.stack([x + 3 * x**2, 0 * x, -3 * x + 3 * z**2])
    normal = lame * extension.sum(axis=0) + 2 * mu * extension
    expected = [*normal, mu * (2 * x - 3 * z), mu * (2 * z + 2 * x), mu * (x + 2 * z)]
    # Rounding.
    np.testing.assert_allclose(stress, np.stack(expected, axis=-1), atol=1e-13)
    np.testing.assert_allclose(displacement[..., 1], 2 * x * z, atol=1e-14)


def test_contact_is_complementary():
    slab = Slab(graded(0.5, 8, 2.0), 1 - graded(1.0, 7, 6.0)[::-1], YOUNG, POISSON)
    displacement, push = press(slab, 10.0, 0.002, tolerance=1e-10)
    nodes, contact = slab.plane.nodes, push > 0
    gap = (nodes[:, None] ** 2 + nodes**2) / 20 - displacement[2, -1] - 0.002
    assert 4 < contact.sum() < 40
    assert np.all(push[~contact] == 0)
    assert np.all(gap[~contact] > 0)
    # Rounding, against the approach.
    assert np.abs(gap[contact]).max() < 1e-12
    # The slab is stiffer than the half-space of Hertz contact.
    hertz = 4 / 3 * YOUNG / (1 - POISSON**2) * np.sqrt(10.0) * 0.002**1.5
    assert hertz < 4 * push.sum() < 1.2 * hertz


def test_solve_that_does_not_converge_says_so(slab):
    with pytest.raises(RuntimeError, match="after 2 iterations"):
        slab.equilibrium(np.zeros((3, *slab.shape)), np.array([0]), np.array([-1.0]), 1e-12, max_iterations=2)
