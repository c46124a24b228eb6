"""Paraboloid pressed without friction into a bonded elastic slab, by finite elements.

Nothing is shared with the spectral method: the elements are fully integrated 27-node hexahedra in
displacements, and contact is nodal, found by an active set. The model is the quarter of a periodic cell
between its mirror planes, which represents the periodic cell exactly. The slab is bonded to a rigid base at
the bottom.

The mesh is a tensor product of three graded lines, whose quadratic matrices scikit-fem assembles. The
stiffness of the hexahedra is a sum of Kronecker products of these matrices, to rounding
(`tests/physics/test_reference_finite_element.py` compares it with scikit-fem's own three-dimensional
assembly), and is applied axis by axis, never stored. Its three diagonal blocks are inverted exactly by
diagonalising the lines (R. E. Lynch, J. R. Rice, D. H. Thomas, Numer. Math. 6 (1964) 185,
DOI 10.1007/BF01386067) and precondition conjugate gradients: the number of iterations does not grow with the
mesh, and no matrix is factorised. The displacement of contact nodes is prescribed by projecting the
preconditioner.

Arrays are ordered (z, y, x), with z up from the bottom; the axis of the indenter is at x = y = 0. Lengths are
in any unit, stresses in the unit of Young's modulus.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
import scipy.linalg
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine
from skfem.models.poisson import laplace, mass

from asperity.core.arguments import require_positive
from asperity.core.types import Array

MAX_ITERATIONS = 500
"""Limit on the conjugate-gradient iterations of one solve, which takes about 16 on graded meshes."""

MAX_ACTIVE_SETS = 40
"""Limit on the active sets of one contact, which takes two to four."""


def graded(length: float, elements: int, ratio: float) -> Array:
    """Ends of elements over 0 … `length`, (elements + 1,); the last is `ratio` times as long as the first."""
    sizes = ratio ** (np.arange(elements) / max(elements - 1, 1))
    return length * np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()


class Line:
    """Quadratic elements on a line.

    Parameters
    ----------
    edges : (elements + 1,) array
        Ends of the elements, rising.

    Attributes
    ----------
    nodes : (2 elements + 1,) array
        Positions of the nodes.
    matrices : dict
        ∫φφ, ∫φφ′, ∫φ′φ and ∫φ′φ′, by whether test and trial function are differentiated.
    """

    def __init__(self, edges: Array) -> None:
        self.edges = edges
        self.nodes = np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])]))
        basis = Basis(MeshLine(edges), ElementLineP2(), intorder=4)
        self._order = np.argsort(basis.doflocs[0])
        masses, stiffness, convection = (
            form.assemble(basis).toarray()[np.ix_(self._order, self._order)]
            for form in (mass, laplace, BilinearForm(lambda u, v, _: u.grad[0] * v))
        )
        slopes = [(False, False), (False, True), (True, False), (True, True)]
        self.matrices = dict(zip(slopes, (masses, convection, convection.T, stiffness), strict=True))

    def modes(self, fixed: Sequence[int]) -> tuple[Array, Array]:
        """Eigenvalues of stiffness against mass and eigenvectors as columns, zero at fixed nodes."""
        free = np.delete(np.arange(len(self.nodes)), fixed)
        mass, stiffness = (self.matrices[slope, slope][np.ix_(free, free)] for slope in (False, True))
        values, vectors = scipy.linalg.eigh(stiffness, mass)
        modes = np.zeros((len(self.nodes), len(free)))
        modes[free] = vectors
        return values, modes

    def at_gauss_points(self) -> tuple[Array, Array, Array]:
        """Positions of the Gauss points, and the matrices that give a field and its slope there.

        Each element has two, where stresses of quadratic elements are most accurate.

        Returns
        -------
        points : (2 elements,) array
        value, slope : (2 elements, 2 elements + 1) arrays
        """
        points = 0.5 + np.array([[-0.5, 0.5]]) / np.sqrt(3.0)
        basis = Basis(MeshLine(self.edges), ElementLineP2(), quadrature=(points, np.full(2, 0.5)))
        fields = [basis.interpolate(unit) for unit in np.eye(basis.N)[self._order]]
        value = np.stack([np.asarray(field).ravel() for field in fields], axis=-1)
        slope = np.stack([field.grad[0].ravel() for field in fields], axis=-1)
        return value @ self.nodes, value, slope


class Slab:
    """Elastic slab between the mirror planes of a quarter cell: stiffness, equilibrium and stress.

    Parameters
    ----------
    plane : (elements + 1,) array
        Ends of the elements along x and along y, from the axis to half a period.
    column : (elements + 1,) array
        Ends of the elements along z, from the bonded bottom to the surface.
    young, poisson : float

    Raises
    ------
    ValueError
        If Young's modulus is not positive, or unless −1 < poisson < 1/2.
    """

    def __init__(self, plane: Array, column: Array, young: float, poisson: float) -> None:
        require_positive(young=young)
        if not -1 < poisson < 0.5:
            raise ValueError(f"poisson = {poisson!r}: −1 < poisson < 0.5 is needed by these elements")
        self.shear_modulus = young / (2 * (1 + poisson))
        self.lame = 2 * self.shear_modulus * poisson / (1 - 2 * poisson)
        self.plane, self.column = Line(plane), Line(column)
        side = len(self.plane.nodes)
        self.shape = (len(self.column.nodes), side, side)
        along_z, free, walled = self.column.modes([0]), self.plane.modes([]), self.plane.modes([0, -1])
        # Of each displacement component the modes along z, y and x, which carry its boundary conditions, and
        # the inverse of its diagonal block.
        self._blocks = []
        for component, modes in enumerate(
            [(along_z, free, walled), (along_z, walled, free), (along_z, free, free)]
        ):
            stiff = self.lame + 2 * self.shear_modulus
            moduli = [stiff if axis == component else self.shear_modulus for axis in (2, 1, 0)]
            z, y, x = (modulus * values for modulus, (values, _) in zip(moduli, modes, strict=True))
            vectors = [vector for _, vector in modes]
            self._blocks.append((vectors, 1 / (z[:, None, None] + y[:, None] + x)))

    def force(self, displacement: Array) -> Array:
        """Nodal forces of a displacement, both (3, nz, ny, nx), reactions of supports included.

        The work of the force on v is ∫ (λ ∂_i v_i ∂_j u_j + μ ∂_j v_i (∂_i u_j + ∂_j u_i)).
        """
        out = np.zeros_like(displacement)
        for i, j in product(range(3), repeat=2):
            out[i] += self.lame * self._integral(displacement[j], i, j)
            out[i] += self.shear_modulus * self._integral(displacement[j], j, i)
            out[i] += self.shear_modulus * self._integral(displacement[i], j, j)
        return out

    def _integral(self, field: Array, i: int, j: int) -> Array:
        """∫ ∂_i φ ∂_j u of a field for all test functions φ; 0, 1, 2 are x, y, z."""
        lines = (self.plane, self.plane, self.column)
        x, y, z = (line.matrices[axis == i, axis == j] for axis, line in enumerate(lines))
        return _transform(field, z, y, x)

    def precondition(self, force: Array) -> Array:
        """Displacement under nodal forces by the diagonal blocks of the stiffness alone, zero at supports."""
        out = np.empty_like(force)
        for component, ((z, y, x), inverse) in enumerate(self._blocks):
            spectrum = inverse * _transform(force[component], z.T, y.T, x.T)
            out[component] = _transform(spectrum, z, y, x)
        return out

    def on_diagonal(self, displacement: Array) -> tuple[Array, Array, Array, Array]:
        """Displacement and stress on the vertical plane x = y, at the Gauss points of the elements.

        Parameters
        ----------
        displacement : (3, nz, ny, nx) array
            At the nodes.

        Returns
        -------
        x, z : (nx,), (nz,) arrays
            Positions along the axes; the distance from the axis of the indenter is √2 x.
        displacement : (nz, nx, 3) array
        stress : (nz, nx, 6) array
            In the order xx, yy, zz, yz, xz, xy.
        """
        x, value, slope = self.plane.at_gauss_points()
        z, value_z, slope_z = self.column.at_gauss_points()

        def sample(along_z: Array, along_y: Array, along_x: Array) -> Array:
            """The three components at the points of the plane, (nz, nx, 3)."""
            operands = along_z, along_y, along_x, displacement
            return np.einsum("az,by,bx,czyx->abc", *operands, optimize=True)

        gradient = np.stack(
            [sample(value_z, value, slope), sample(value_z, slope, value), sample(slope_z, value, value)]
        )
        trace = self.lame * np.einsum("iabi->ab", gradient)
        stress = self.shear_modulus * (gradient + np.moveaxis(gradient, (0, -1), (-1, 0)))
        normal = [trace + stress[i, ..., i] for i in range(3)]
        shear = [stress[i, ..., j] for i, j in ((1, 2), (0, 2), (0, 1))]
        return x, z, sample(value_z, value, value), np.stack([*normal, *shear], axis=-1)

    def equilibrium(
        self, start: Array, nodes: Array, value: Array, tolerance: float, max_iterations: int = MAX_ITERATIONS
    ) -> tuple[Array, Array]:
        """Equilibrium with u_z prescribed at some surface nodes, by preconditioned conjugate gradients.

        Parameters
        ----------
        start : (3, nz, ny, nx) array
            First guess of the displacement, zero at supports.
        nodes, value : (n,) arrays
            Flat indices of surface nodes, and their u_z.
        tolerance : float
            Allowed error of the energy norm, as estimated by the preconditioner, relative to the solution's.
        max_iterations : int

        Returns
        -------
        displacement, force : (3, nz, ny, nx) arrays
            The force is zero except at supports and at the nodes with prescribed u_z.

        Raises
        ------
        RuntimeError
            If the tolerance is not reached within `max_iterations`.
        """
        # Displacement u_z of the nodes under forces at them, by the preconditioner.
        (z, y, x), inverse = self._blocks[2]
        row, column = np.divmod(nodes, self.shape[2])
        modes = (y[row][:, :, None] * x[column][:, None, :]).reshape(len(nodes), -1)
        response = np.einsum("k,kyx->yx", z[-1] ** 2, inverse)
        factor = scipy.linalg.cho_factor((modes * response.ravel()) @ modes.T)

        def pushed(wanted: Array) -> Array:
            """Displacement by the preconditioner under the forces that move the nodes as wanted."""
            load = np.zeros((3, *self.shape))
            load[2, -1].reshape(-1)[nodes] = scipy.linalg.cho_solve(factor, wanted)
            return self.precondition(load)

        displacement = start + pushed(value - start[2, -1].reshape(-1)[nodes])
        force = self.force(displacement)
        direction, product = np.zeros_like(force), 1.0
        for iteration in range(max_iterations):
            residual = -force  # at supports the preconditioner ignores it
            residual[2, -1].reshape(-1)[nodes] = 0.0
            step = self.precondition(residual)
            step -= pushed(step[2, -1].reshape(-1)[nodes])
            previous, product = product, float(np.vdot(residual, step))
            if product <= tolerance**2 * float(np.vdot(displacement, force)):
                return displacement, force
            direction = step + (product / previous if iteration else 0.0) * direction
            response = self.force(direction)
            length = product / float(np.vdot(direction, response))
            displacement += length * direction
            force += length * response
        raise RuntimeError(f"finite elements: residual above {tolerance:g} after {max_iterations} iterations")


def press(
    slab: Slab, curvature_radius: float, approach: float, tolerance: float = 1e-8
) -> tuple[Array, Array]:
    """Contact of a paraboloid ``r²/(2R)`` with the slab at an approach.

    Parameters
    ----------
    slab : Slab
    curvature_radius : float
        R.
    approach : float
        Downward displacement of the indenter from first touch.
    tolerance : float
        Tolerance of each linear solve, in the energy norm.

    Returns
    -------
    displacement : (3, nz, ny, nx) array
    push : (ny, nx) array
        Forces of the indenter on the surface nodes of the quarter cell, downward; the load on the whole
        indenter is four times their sum.

    Raises
    ------
    RuntimeError
        If the active set does not converge.
    """
    require_positive(curvature_radius=curvature_radius, approach=approach)
    nodes = slab.plane.nodes
    depth = (approach - (nodes[:, None] ** 2 + nodes**2) / (2 * curvature_radius)).ravel()
    # First guess: the edge of contact is displaced by half of the approach, as in Hertz contact.
    contact = depth > 0.5 * approach
    displacement = np.zeros((3, *slab.shape))
    for _ in range(MAX_ACTIVE_SETS):
        touching = np.flatnonzero(contact)
        displacement, force = slab.equilibrium(displacement, touching, -depth[touching], tolerance)
        push = -force[2, -1].ravel()
        penetration = depth + displacement[2, -1].ravel()
        settled = np.where(contact, push > 0, penetration > 0)
        if np.array_equal(settled, contact):
            return displacement, np.where(contact, push, 0.0).reshape(slab.shape[1:])
        contact = settled
    raise RuntimeError(f"finite elements: contact not converged after {MAX_ACTIVE_SETS} active sets")


def _transform(values: Array, z: Array, y: Array, x: Array) -> Array:
    """Product of a (z, y, x) array with one matrix along each axis."""
    values = y @ (values @ x.T)
    return (z @ values.reshape(len(values), -1)).reshape(len(z), *values.shape[1:])
