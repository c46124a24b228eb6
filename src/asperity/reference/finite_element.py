"""A paraboloid pressed into an elastic slab, by finite elements with a contact of their own.

Nothing is shared with the spectral method: displacement-based 27-node hexahedra, fully integrated, and
nodal contact by an active set. A quarter of the cell between its mirror planes is the periodic cell exactly;
the slab is bonded to the ground at the bottom and free of friction at the top.

The mesh is a tensor product of three graded lines, whose quadratic matrices scikit-fem assembles; the
hexahedral stiffness is their Kronecker product to rounding (`tests/physics/test_reference_finite_element.py`
compares it with scikit-fem's own three-dimensional assembly) and is applied factor by factor, never stored.
The three diagonal blocks of that stiffness are inverted exactly by diagonalising the lines, and precondition
conjugate gradients (R. E. Lynch, J. R. Rice, D. H. Thomas, Numer. Math. 6 (1964) 185,
DOI 10.1007/BF01386067): a number of iterations independent of the mesh, and no factorisation.
Nodes in contact are held by projecting the preconditioner.

Arrays are ordered (z, y, x), z up from the bottom; the axis of the indenter is at x = y = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine

from asperity.reference.hertz import require_positive
from asperity.types import Array

# Points of an element, along each axis, where the stress of quadratic elements is most accurate.
_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)


def graded(length: float, elements: int, ratio: float) -> Array:
    """Edges of elements over 0 … `length`, in geometric progression; the last over the first is `ratio`."""
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
        End nodes (0, −1) where a field with this line's conditions vanishes.
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
        """Mass ∫φφ, stiffness ∫φ′φ′ and convection ∫φφ′ (rows are test functions), nodes in order."""
        basis = Basis(MeshLine(self.edges), ElementLineP2(), intorder=4)
        order = np.argsort(basis.doflocs[0])
        mass, stiffness, convection = (
            sp.csr_array(form.assemble(basis).tocsr()[order][:, order])
            for form in (_mass, _stiffness, _convection)
        )
        return mass, stiffness, convection

    @cached_property
    def modes(self) -> tuple[Array, Array]:
        """Eigenvalues of stiffness against mass, and the modes as columns, zero at the fixed ends."""
        free = np.delete(np.arange(len(self.nodes)), self.fixed)
        mass, stiffness, _ = (matrix.toarray()[np.ix_(free, free)] for matrix in self.matrices)
        values, vectors = scipy.linalg.eigh(stiffness, mass)
        modes = np.zeros((len(self.nodes), len(free)))
        modes[free] = vectors
        return values, modes

    def at_gauss_points(self, order: int) -> tuple[Array, sp.csr_array]:
        """Two points an element, and the matrix giving there a field (0) or its slope (1) from the nodes."""
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
    """Stiffness of the quarter cell, its preconditioner, and its stress.

    Parameters
    ----------
    plane : (elements + 1,) array
        Edges of the elements along x and along y, from the axis to half a period.
    column : (elements + 1,) array
        Edges along z, from the bonded bottom to the surface.
    young, poisson : float
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
        # Lines of each displacement component in the order z, y, x.
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
        """Blocks of the stiffness: test and trial component, factor in the plane, factor along z."""
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
        """Nodal forces of a displacement, (3, nz, ny, nx) both; held components included."""
        nz = self.shape[0]
        out = np.zeros((3, nz, self.shape[1] * self.shape[2]))
        flat = displacement.reshape(out.shape)
        for test, trial, plane, line in self._terms:
            out[test] += line @ (plane @ flat[trial].T).T
        return out.reshape(displacement.shape)

    def precondition(self, force: Array) -> Array:
        """Displacement by the diagonal blocks of the stiffness alone, zero where held."""
        out = np.empty_like(force)
        for component, lines in enumerate(self._lines):
            z, y, x = (line.modes[1] for line in lines)
            spectrum = self._inverse[component] * _transform(force[component], z.T, y.T, x.T)
            out[component] = _transform(spectrum, z, y, x)
        return out

    @cached_property
    def _surface(self) -> tuple[Array, Array]:
        """Modes in the plane of u_z, and what one of unit force there moves the surface by."""
        z, y, _ = self._lines[2]
        return y.modes[1], np.einsum("k,kyx->yx", z.modes[1][-1] ** 2, self._inverse[2])

    def surface_compliance(self, nodes: Array) -> Array:
        """Displacement u_z at surface nodes by forces there, in the preconditioner."""
        modes, response = self._surface
        y, x = np.divmod(nodes, self.shape[2])
        shape = (modes[y][:, :, None] * modes[x][:, None, :]).reshape(len(nodes), -1)
        return (shape * response.ravel()) @ shape.T

    def spread(self, nodes: Array, force: Array) -> Array:
        """Displacement by forces along z at surface nodes, in the preconditioner."""
        load = np.zeros((3, *self.shape))
        load[2, -1].reshape(-1)[nodes] = force
        return self.precondition(load)

    def nodal_area(self) -> Array:
        """Area that each node of the surface stands for, (ny, nx)."""
        weight = np.asarray(self.free.matrices[0].sum(axis=1)).ravel()
        return np.outer(weight, weight)

    def on_diagonal(self, displacement: Array) -> tuple[Array, Array, Array, Array]:
        """Displacement and stress on the vertical plane x = y, at the elements' Gauss points.

        Returns
        -------
        x, z : (nx,), (nz,) arrays
            Positions along each axis; the distance from the indenter's axis is √2 x.
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

    def solve_held(
        self, start: Array, nodes: Array, value: Array, tolerance: float, limit: int = 500
    ) -> tuple[Array, Array, int]:
        """Equilibrium with u_z given at some surface nodes, by preconditioned conjugate gradients.

        Parameters
        ----------
        start : (3, nz, ny, nx) array
            First guess, zero where held.
        nodes, value : (n,) arrays
            Flat index of surface nodes, and their u_z.
        tolerance : float
            Largest error of the energy norm, estimated by the preconditioner, relative to the solution's.
        limit : int
            Most iterations.

        Returns
        -------
        displacement, force : (3, nz, ny, nx) arrays
            The force is zero but where something is held.
        iterations : int

        Raises
        ------
        RuntimeError
            If the limit is reached.
        """
        factor = scipy.linalg.cho_factor(self.surface_compliance(nodes))

        def project(step: Array) -> Array:
            there = step[2, -1].reshape(-1)[nodes]
            return step - self.spread(nodes, scipy.linalg.cho_solve(factor, there))

        miss = value - start[2, -1].reshape(-1)[nodes]
        displacement = start + self.spread(nodes, scipy.linalg.cho_solve(factor, miss))
        force = self.force(displacement)
        direction, product = np.zeros_like(force), 1.0
        for iteration in range(limit):
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
        raise RuntimeError(f"finite elements: residual above {tolerance:g} after {limit} iterations")


@dataclass(frozen=True)
class SlabContact:
    """A paraboloid in contact with the slab.

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
        Conjugate-gradient iterations in all, and active sets tried.
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
        """Radius of the circle with the area of contact, each node counting by its area."""
        return float(np.sqrt(4 * self.slab.nodal_area()[self.contact].sum() / np.pi))


def press(
    slab: Slab,
    curvature_radius: float,
    approach: float,
    tolerance: float = 1e-8,
    progress: Callable[[float, float], None] | None = None,
) -> SlabContact:
    """Press a paraboloid ``r²/(2R)`` into the slab down to an approach.

    Parameters
    ----------
    slab : Slab
    curvature_radius : float
    approach : float
        Downward displacement of the indenter from first touch.
    tolerance : float
        Of each linear solve, in the energy norm.
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
    # Half of the approach is taken up by the displacement at the edge, as without a slab.
    contact = depth > 0.5 * approach
    displacement = np.zeros((3, *slab.shape))
    iterations, limit = 0, 40
    for active_set in range(1, limit + 1):
        held = np.flatnonzero(contact)
        displacement, force, done = slab.solve_held(displacement, held, -depth[held], tolerance)
        iterations += done
        push = -force[2, -1].ravel()
        penetration = depth + displacement[2, -1].ravel()
        settled = np.where(contact, push > 0, penetration > 0)
        if progress:
            progress(active_set, limit)
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
    raise RuntimeError(f"finite elements: contact not settled after {limit} active sets")


def _transform(values: Array, z: Array, y: Array, x: Array) -> Array:
    """Apply a matrix along each axis."""
    values = values @ x.T
    values = y @ values
    return (z @ values.reshape(len(values), -1)).reshape(len(z), *values.shape[1:])
