"""Quadratic finite elements on a line: the factors of tensor-product meshes of 27-node hexahedra."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine

from asperity.types import Array

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
