"""Paraboloid pressed without friction into a bonded elastic slab, by finite elements.

Nothing is shared with the spectral method: the elements are fully integrated 27-node hexahedra in
displacements, and contact is nodal, found by an active set. The model is the quarter of a periodic cell
between its mirror planes, which represents the periodic cell exactly. The slab is bonded to a rigid base at
the bottom.

The mesh is a tensor product of three graded lines, whose quadratic matrices scikit-fem assembles. The
stiffness of the hexahedra is a sum of Kronecker products of these matrices, to rounding
(`tests/physics/test_reference_finite_element.py` compares it with scikit-fem's own three-dimensional
assembly), and is applied factor by factor, never stored. Its three diagonal blocks are inverted exactly by
diagonalising the lines (R. E. Lynch, J. R. Rice, D. H. Thomas, Numer. Math. 6 (1964) 185,
DOI 10.1007/BF01386067) and precondition conjugate gradients: the number of iterations does not grow with the
mesh, and no matrix is factorised. The displacement of contact nodes is prescribed by projecting the
preconditioner.

Arrays are ordered (z, y, x), with z up from the bottom; the axis of the indenter is at x = y = 0. Lengths
are in any unit, stresses in that of Young's modulus.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sp
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


@BilinearForm
def _mass(u, v, _):
    return u * v


@BilinearForm
def _stiffness(u, v, _):
    return u.grad[0] * v.grad[0]


@BilinearForm
def _convection(u, v, _):
    return u.grad[0] * v


@dataclass(frozen=True, eq=False)
class Line:
    """Quadratic elements on a line.

    Parameters
    ----------
    edges : (elements + 1,) array
        Ends of the elements, rising.
    fixed : tuple of int
        End nodes, 0 for the first and −1 for the last, where the field is zero.
    """

    edges: Array
    fixed: tuple[int, ...] = ()

    @cached_property
    def nodes(self) -> Array:
        """Positions of the 2 elements + 1 nodes."""
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return np.sort(np.concatenate([self.edges, middle]))

    @cached_property
    def matrices(self) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array]:
        """Mass ∫φφ, stiffness ∫φ′φ′ and convection ∫φφ′, nodes in rising order, test functions in rows."""
        basis = Basis(MeshLine(self.edges), ElementLineP2(), intorder=4)
        order = np.argsort(basis.doflocs[0])
        mass, stiffness, convection = (
            sp.csr_array(form.assemble(basis).tocsr()[order][:, order])
            for form in (_mass, _stiffness, _convection)
        )
        return mass, stiffness, convection

    @cached_property
    def modes(self) -> tuple[Array, Array]:
        """Eigenvalues of stiffness against mass, and eigenvectors as columns, zero at fixed ends."""
        free = np.delete(np.arange(len(self.nodes)), self.fixed)
        mass, stiffness, _ = (matrix.toarray()[np.ix_(free, free)] for matrix in self.matrices)
        values, vectors = scipy.linalg.eigh(stiffness, mass)
        modes = np.zeros((len(self.nodes), len(free)))
        modes[free] = vectors
        return values, modes

    def at_gauss_points(self, order: int) -> tuple[Array, sp.csr_array]:
        """Positions of the Gauss points, and the matrix that gives a field or its slope there from its nodes.

        Parameters
        ----------
        order : 0 or 1
            0 for the field, 1 for its slope.

        Returns
        -------
        points : (2 elements,) array
        matrix : (2 elements, 2 elements + 1) sparse array
        """
        xi = _GAUSS
        shape = np.array([xi * (xi - 1) / 2, 1 - xi**2, xi * (xi + 1) / 2])
        slope = np.array([xi - 0.5, -2 * xi, xi + 0.5])
        half = 0.5 * np.diff(self.edges)
        points = (0.5 * (self.edges[1:] + self.edges[:-1]))[:, None] + half[:, None] * xi
        local = shape.T[None] + 0 * half[:, None, None] if order == 0 else slope.T / half[:, None, None]
        element = np.arange(len(half))
        rows = np.broadcast_to((2 * element[:, None] + [0, 1])[:, :, None], local.shape)
        columns = np.broadcast_to((2 * element[:, None] + [0, 1, 2])[:, None, :], local.shape)
        size = (points.size, len(self.nodes))
        return points.ravel(), sp.coo_array(
            (local.ravel(), (rows.ravel(), columns.ravel())), shape=size
        ).tocsr()


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
        self.free = Line(plane)
        self.walled = Line(plane, fixed=(0, -1))
        self.column = Line(column, fixed=(0,))
        side = len(self.free.nodes)
        self.shape = (len(self.column.nodes), side, side)
        self._terms = list(self._make_terms())
        # For each displacement component its lines along z, y and x, which carry its boundary conditions.
        self._lines = [
            (self.column, self.free, self.walled),
            (self.column, self.walled, self.free),
            (self.column, self.free, self.free),
        ]
        stiff, soft = self.lame + 2 * self.shear_modulus, self.shear_modulus
        self._inverse = []
        for component, lines in enumerate(self._lines):
            z, y, x = (line.modes[0] for line in lines)
            weights = [stiff if axis == component else soft for axis in (2, 1, 0)]
            self._inverse.append(
                1 / (weights[0] * z[:, None, None] + weights[1] * y[:, None] + weights[2] * x)
            )
        self._held = np.zeros((3, *self.shape), bool)
        self._held[:, 0] = True
        self._held[0, :, :, [0, -1]] = True
        self._held[1, :, [0, -1], :] = True

    def _make_terms(self) -> Iterator[tuple[int, int, Any, Any]]:
        """Terms of the stiffness: test and trial component, factor in the plane (y, x), factor along z."""
        lame, mu = self.lame, self.shear_modulus
        mass, stiff, conv = self.free.matrices
        mass_z, stiff_z, conv_z = self.column.matrices
        both = sp.kron(mass, mass, "csr")
        along_y, along_x = sp.kron(stiff, mass, "csr"), sp.kron(mass, stiff, "csr")
        yield 0, 0, (lame + 2 * mu) * along_x + mu * along_y, mass_z
        yield 0, 0, mu * both, stiff_z
        yield 1, 1, (lame + 2 * mu) * along_y + mu * along_x, mass_z
        yield 1, 1, mu * both, stiff_z
        yield 2, 2, mu * (along_x + along_y), mass_z
        yield 2, 2, (lame + 2 * mu) * both, stiff_z
        shear = lame * sp.kron(conv, conv.T, "csr") + mu * sp.kron(conv.T, conv, "csr")
        yield 0, 1, shear, mass_z
        yield 1, 0, shear.T.tocsr(), mass_z
        for component, slope in ((0, sp.kron(mass, conv, "csr")), (1, sp.kron(conv, mass, "csr"))):
            yield component, 2, lame * slope.T.tocsr(), conv_z
            yield component, 2, mu * slope, conv_z.T.tocsr()
            yield 2, component, lame * slope, conv_z.T.tocsr()
            yield 2, component, mu * slope.T.tocsr(), conv_z

    def force(self, displacement: Array) -> Array:
        """Nodal forces of a displacement, both (3, nz, ny, nx), reactions of supports included."""
        nz = self.shape[0]
        out = np.zeros((3, nz, self.shape[1] * self.shape[2]))
        flat = displacement.reshape(out.shape)
        for test, trial, plane, line in self._terms:
            out[test] += line @ (plane @ flat[trial].T).T
        return out.reshape(displacement.shape)

    def precondition(self, force: Array) -> Array:
        """Displacement under nodal forces by the diagonal blocks of the stiffness alone, zero at supports."""
        out = np.empty_like(force)
        for component, lines in enumerate(self._lines):
            z, y, x = (line.modes[1] for line in lines)
            spectrum = self._inverse[component] * _transform(force[component], z.T, y.T, x.T)
            out[component] = _transform(spectrum, z, y, x)
        return out

    @cached_property
    def _surface(self) -> tuple[Array, Array]:
        """Eigenvectors of u_z in the plane, and the surface displacement under a unit force of each mode."""
        z, y, _ = self._lines[2]
        return y.modes[1], np.einsum("k,kyx->yx", z.modes[1][-1] ** 2, self._inverse[2])

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
        weight = np.asarray(self.free.matrices[0].sum(axis=1)).ravel()
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
        (x, value), (_, slope) = (self.free.at_gauss_points(order) for order in (0, 1))
        (z, value_z), (_, slope_z) = (self.column.at_gauss_points(order) for order in (0, 1))

        def sample(field: Array, along_z: Any, along_y: Any, along_x: Any) -> Array:
            plane = sp.vstack([sp.kron(along_y[i], along_x[i]) for i in range(len(x))]).tocsr()
            return along_z @ (plane @ field.reshape(len(field), -1).T).T

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
    nodes = slab.free.nodes
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
