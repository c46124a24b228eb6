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

Arrays are ordered (z, y, x), with z up from the bottom; the axis of the indenter is at x = y = 0. Lengths
are in any unit, stresses in that of Young's modulus.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import scipy.linalg
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine

from asperity.core.arguments import require_positive
from asperity.core.types import Array, Progress

MAX_ITERATIONS = 500
"""Limit on the conjugate-gradient iterations of one solve, which takes about 16 on graded meshes."""

MAX_ACTIVE_SETS = 40
"""Limit on the active sets of one contact, which takes two to four."""

# Local coordinates of the two Gauss points of an element, where stresses of quadratic elements are most
# accurate.
_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)


def graded(length: float, elements: int, ratio: float) -> Array:
    """Ends of elements over 0 … `length`, (elements + 1,); the last is `ratio` times as long as the first."""
    sizes = ratio ** (np.arange(elements) / max(elements - 1, 1))
    return length * np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()


@dataclass(frozen=True, eq=False)
class Line:
    """Quadratic elements on a line.

    Parameters
    ----------
    edges : (elements + 1,) array
        Ends of the elements, rising.
    """

    edges: Array

    @cached_property
    def nodes(self) -> Array:
        """Positions of the 2 elements + 1 nodes."""
        return np.sort(np.concatenate([self.edges, 0.5 * (self.edges[1:] + self.edges[:-1])]))

    @cached_property
    def matrices(self) -> dict[tuple[bool, bool], Array]:
        """∫φφ, ∫φφ′, ∫φ′φ and ∫φ′φ′, by whether test and trial function are differentiated."""
        basis = Basis(MeshLine(self.edges), ElementLineP2(), intorder=4)
        order = np.argsort(basis.doflocs[0])
        mass, stiffness, convection = (
            form.assemble(basis).toarray()[np.ix_(order, order)]
            for form in (
                BilinearForm(lambda u, v, _: u * v),
                BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0]),
                BilinearForm(lambda u, v, _: u.grad[0] * v),
            )
        )
        return {
            (False, False): mass,
            (False, True): convection,
            (True, False): convection.T,
            (True, True): stiffness,
        }

    def modes(self, fixed: Sequence[int]) -> tuple[Array, Array]:
        """Eigenvalues of stiffness against mass and eigenvectors as columns, zero at fixed nodes."""
        free = np.delete(np.arange(len(self.nodes)), fixed)
        inside = np.ix_(free, free)
        values, vectors = scipy.linalg.eigh(
            self.matrices[True, True][inside], self.matrices[False, False][inside]
        )
        modes = np.zeros((len(self.nodes), len(free)))
        modes[free] = vectors
        return values, modes

    def at_gauss_points(self) -> tuple[Array, Array, Array]:
        """Positions of two Gauss points an element, and what gives a field and its slope there."""
        xi = _GAUSS[:, None]
        shape = np.hstack([xi * (xi - 1) / 2, 1 - xi**2, xi * (xi + 1) / 2])
        slope = np.hstack([xi - 0.5, -2 * xi, xi + 0.5])
        half, middle = 0.5 * np.diff(self.edges), 0.5 * (self.edges[1:] + self.edges[:-1])
        value, derivative = np.zeros((2, 2 * len(half), len(self.nodes)))
        for element, size in enumerate(half):
            here = slice(2 * element, 2 * element + 2), slice(2 * element, 2 * element + 3)
            value[here], derivative[here] = shape, slope / size
        return (middle[:, None] + half[:, None] * _GAUSS).ravel(), value, derivative


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
        free, walled, column_modes = self.plane.modes(()), self.plane.modes((0, -1)), self.column.modes((0,))
        # The modes along z, y and x of each displacement component, which carry its boundary conditions.
        self._modes = [(column_modes, free, walled), (column_modes, walled, free), (column_modes, free, free)]
        stiff, soft = self.lame + 2 * self.shear_modulus, self.shear_modulus
        self._inverse = []
        for component, modes in enumerate(self._modes):
            z, y, x = ((stiff if axis == component else soft) * modes[2 - axis][0] for axis in (2, 1, 0))
            self._inverse.append(1 / (z[:, None, None] + y[:, None] + x))
        self._held = np.zeros((3, *self.shape), bool)
        self._held[:, 0] = True
        self._held[0, :, :, [0, -1]] = True
        self._held[1, :, [0, -1], :] = True

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
        for component, modes in enumerate(self._modes):
            z, y, x = (vectors for _, vectors in modes)
            spectrum = self._inverse[component] * _transform(force[component], z.T, y.T, x.T)
            out[component] = _transform(spectrum, z, y, x)
        return out

    @cached_property
    def _surface(self) -> tuple[Array, Array]:
        """Eigenvectors of u_z in the plane, and the surface displacement under a unit force of each mode."""
        (_, z), (_, y), _ = self._modes[2]
        return y, np.einsum("k,kyx->yx", z[-1] ** 2, self._inverse[2])

    def surface_compliance(self, nodes: Array) -> Array:
        """Displacement u_z of surface nodes under forces at them by the preconditioner, (nodes, nodes)."""
        modes, response = self._surface
        y, x = np.divmod(nodes, self.shape[2])
        shape = (modes[y][:, :, None] * modes[x][:, None, :]).reshape(len(nodes), -1)
        return (shape * response.ravel()) @ shape.T

    def precondition_surface_force(self, nodes: Array, force: Array) -> Array:
        """Displacement under forces along z at surface nodes by the preconditioner, (3, nz, ny, nx)."""
        load = np.zeros((3, *self.shape))
        load[2, -1].reshape(-1)[nodes] = force
        return self.precondition(load)

    def nodal_area(self) -> Array:
        """Integral of the shape function of each surface node, (ny, nx)."""
        weight = self.plane.matrices[False, False].sum(axis=1)
        return np.outer(weight, weight)

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

        def sample(field: Array, along_z: Array, along_y: Array, along_x: Array) -> Array:
            return np.einsum("zpp->zp", _transform(field, along_z, along_y, along_x))

        moved = np.stack([sample(part, value_z, value, value) for part in displacement], axis=-1)
        strain = np.empty((3, 3, len(z), len(x)))
        for component, part in enumerate(displacement):
            strain[component, 0] = sample(part, value_z, value, slope)
            strain[component, 1] = sample(part, value_z, slope, value)
            strain[component, 2] = sample(part, slope_z, value, value)
        pressure = self.lame * np.trace(strain)
        mu = self.shear_modulus
        normal = [pressure + 2 * mu * strain[i, i] for i in range(3)]
        shear = [mu * (strain[i, j] + strain[j, i]) for i, j in ((1, 2), (0, 2), (0, 1))]
        return x, z, moved, np.stack([*normal, *shear], axis=-1)

    def equilibrium(
        self,
        start: Array,
        nodes: Array,
        value: Array,
        tolerance: float,
        max_iterations: int = MAX_ITERATIONS,
    ) -> tuple[Array, Array, int]:
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
        iterations : int

        Raises
        ------
        RuntimeError
            If the tolerance is not reached within `max_iterations`.
        """
        factor = scipy.linalg.cho_factor(self.surface_compliance(nodes))

        def project(step: Array) -> Array:
            there = step[2, -1].reshape(-1)[nodes]
            return step - self.precondition_surface_force(nodes, scipy.linalg.cho_solve(factor, there))

        miss = value - start[2, -1].reshape(-1)[nodes]
        displacement = start + self.precondition_surface_force(nodes, scipy.linalg.cho_solve(factor, miss))
        force = self.force(displacement)
        direction, product = np.zeros_like(force), 1.0
        for iteration in range(max_iterations):
            residual = -np.where(self._held, 0.0, force)
            residual[2, -1].reshape(-1)[nodes] = 0.0
            step = project(self.precondition(residual))
            previous, product = product, float(np.vdot(residual, step))
            if product <= tolerance**2 * float(np.vdot(displacement, force)):
                return displacement, force, iteration
            direction = step + (product / previous if iteration else 0.0) * direction
            response = self.force(direction)
            length = product / float(np.vdot(direction, response))
            displacement += length * direction
            force += length * response
        raise RuntimeError(f"finite elements: residual above {tolerance:g} after {max_iterations} iterations")


@dataclass(frozen=True)
class SlabContact:
    """Contact of a paraboloid with the slab.

    Attributes
    ----------
    slab : Slab
    displacement : (3, nz, ny, nx) array
    pressure : (ny, nx) array
        Nodal force over nodal area, on the surface.
    load : float
        Force on the whole indenter, four quarters.
    contact : (ny, nx) bool array
        Nodes in contact.
    iterations, active_sets : int
        Number of conjugate-gradient iterations in total, and of active sets.
    """

    slab: Slab
    displacement: Array
    pressure: Array
    load: float
    contact: Array
    iterations: int
    active_sets: int

    @property
    def contact_radius(self) -> float:
        """Radius of the circle with the contact area, the sum of the nodal areas in contact."""
        return float(np.sqrt(4 * self.slab.nodal_area()[self.contact].sum() / np.pi))


def press(
    slab: Slab,
    curvature_radius: float,
    approach: float,
    tolerance: float = 1e-8,
    progress: Progress | None = None,
) -> SlabContact:
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
    progress : callable, optional
        Called as progress(done, total) after each active set.

    Raises
    ------
    RuntimeError
        If the active set does not settle.
    """
    require_positive(curvature_radius=curvature_radius, approach=approach)
    nodes = slab.plane.nodes
    depth = (approach - (nodes[:, None] ** 2 + nodes**2) / (2 * curvature_radius)).ravel()
    # First guess: the edge of contact is displaced by half of the approach, as in Hertz contact.
    contact = depth > 0.5 * approach
    displacement = np.zeros((3, *slab.shape))
    iterations = 0
    for active_set in range(1, MAX_ACTIVE_SETS + 1):
        held = np.flatnonzero(contact)
        displacement, force, done = slab.equilibrium(displacement, held, -depth[held], tolerance)
        iterations += done
        push = -force[2, -1].ravel()
        penetration = depth + displacement[2, -1].ravel()
        settled = np.where(contact, push > 0, penetration > 0)
        if progress:
            progress(active_set, MAX_ACTIVE_SETS)
        if np.array_equal(settled, contact):
            push = np.where(contact, push, 0.0).reshape(slab.shape[1:])
            return SlabContact(
                slab=slab,
                displacement=displacement,
                pressure=push / slab.nodal_area(),
                load=4 * float(push.sum()),
                contact=contact.reshape(slab.shape[1:]),
                iterations=iterations,
                active_sets=active_set,
            )
        contact = settled
    raise RuntimeError(f"finite elements: contact not settled after {MAX_ACTIVE_SETS} active sets")


def _transform(values: Array, z: Array, y: Array, x: Array) -> Array:
    """Product of a (z, y, x) array with one matrix along each axis."""
    values = values @ x.T
    values = y @ values
    return (z @ values.reshape(len(values), -1)).reshape(len(z), *values.shape[1:])
