"""Approximate inverse of the compliance on the contact nodes: a stencil, corrected on a coarse grid.

The inverse of a half-space's compliance is E* |q| / 2, whose kernel in real space decays as r⁻³. Cut off at a
few nodes and restricted to the contact nodes it is a sparse matrix S that is cheap to apply. It is akin to
the FFT-based preconditioner of Vollebregt (J. Comput. Phys. 257 (2014) 333). What S lacks is the elastic
interaction of distant contacts: it removes a uniform residual by the pressure w = S 1, as if every contact
patch stood alone. For residuals that vary over lengths much longer than the patches that pressure is too
large.

New here is the correction of these long waves on a coarse grid. There a contact acts only by its sum over a
cell. Let σ be the sum of w in each cell divided by the cell's area, V the operator that spreads a value of
each cell over its contact nodes in proportion to w, and G the compliance on the coarse grid. The pressure of
a long wave obeys (1/σ + G) p = r, where S assumes p = σ r. With Woodbury's identity,

    (1/σ + G)⁻¹ = σ − σ (σ + 1/G)⁻¹ σ,      the preconditioner becomes      M = S − V (σ + 1/G)⁻¹ Vᵀ.

S is the sum of diag(w) and a graph Laplacian, so that M is positive definite for every G ≥ 0. In full contact
with a half-space, where S has the eigenvalue σ for long waves, M has σ q / (σ + q), which tends to q. The
system of the coarse grid is solved by a few conjugate gradients, preconditioned by the same operator with the
mean of σ.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from asperity.compiled import compiled, sums
from asperity.contact.kernels import add_multiple, dot
from asperity.contact.places import row_plus_column
from asperity.contact.problem import Problem
from asperity.contact.response import multiply_rows
from asperity.contact.stencil import RADIUS, StencilField, whole_stencil
from asperity.parallel import in_parts
from asperity.spectral import Fourier, Grid
from asperity.types import Array

# Nodes on the edge of a cell of the coarse grid. Found by trial on rough surfaces of 512² nodes: with 32
# nodes a solution takes 7 % more transforms, with 8 as many, but the coarse grid is four times larger.
CELL_NODES = 16

# The coarse system is solved until the preconditioned norm of its residual has dropped by this factor, in at
# most so many iterations. Three times smaller or larger, the drop changes the number of transforms of a
# solution on 512² nodes by at most 2 %.
COARSE_RESIDUAL_DROP = 0.03
MAX_COARSE_ITERATIONS = 50

# The more cells, the more S overestimates the longest waves, and the smaller the drop has to be: at most this
# number over the cells on an edge. With 0.03 a solution on 16384² nodes applies the preconditioner of the
# finest grid 40 times instead of 24.
COARSE_RESIDUAL_DROP_OF_EDGE = 6.0

# Rows of cells for which a thread of its own is worth while.
LEAST_ROWS = 64


class Preconditioner:
    """Approximate inverse of the compliance of one grid, restricted to a set of contact nodes.

    It maps residuals, displacements in units of `Problem.nodal_compliance`, to the pressures that remove
    them. `restrict` chooses the contact nodes to which the other methods refer.

    Parameters
    ----------
    problem : Problem
    field : StencilField
        Restricted to the contact nodes before the preconditioner.

    Attributes
    ----------
    nodal_stiffness : float
        Pressure that removes a unit residual of a node that alone is in contact.
    """

    def __init__(self, problem: Problem, field: StencilField) -> None:
        grid = problem.grid
        self._field, self._threads = field, problem.fourier.threads
        quadrants = inverse_stencil(grid)
        self._stencil = whole_stencil(quadrants)
        self.nodal_stiffness = float(quadrants[0, 0, 0, 0])
        self._grid = grid
        cells = Grid(tuple(max(1, n // CELL_NODES) for n in grid.shape), grid.length)  # type: ignore[arg-type]
        self._cells = cells
        self._coarse, compliance = problem.response.on_cells(cells)
        self._compliance = compliance / problem.nodal_compliance

    def restrict(self, nodes: Array) -> None:
        """Restrict the preconditioner to contact nodes, given by their indices in the flattened grid."""
        cells, grid = self._cells, self._grid
        row, column = (np.arange(n) * m // n for n, m in zip(grid.shape, cells.shape, strict=True))
        of_row, of_column = (row * cells.shape[1]).astype(np.uint32), column.astype(np.uint32)
        self._cell = row_plus_column(nodes, of_row, of_column, self._threads)
        # The nodes of whole rows of cells are added up together: the same sums for any number of threads.
        first_rows = -(-np.arange(cells.shape[0] + 1) * grid.shape[0] // cells.shape[0])
        self._first_nodes = np.searchsorted(nodes, (first_rows * grid.shape[1]).astype(nodes.dtype))
        self._weight = np.empty(nodes.size, np.float32)
        self._field.apply(self._stencil, np.ones(nodes.size, np.float32), self._weight)
        self._cell_weight = self._sums_in_cells(_add_in_cells, self._weight)
        sigma = (self._cell_weight * (cells.size / grid.size)).reshape(cells.shape)
        mean = float(sigma.mean())
        self._sigma = self._on_coarse_grid(sigma)
        self._mean_sigma = np.float32(mean)
        self._inverse_for_mean = (self._compliance / (1 + mean * self._compliance)).astype(np.float32)

    def apply(self, residual: Array, out: Array) -> None:
        """Write the pressures M r that approximately remove a residual r on the contact nodes."""
        sums = self._sums_in_cells(_add_weighted_in_cells, self._weight, residual)
        # The coarse system is too small for several threads: the others apply the stencil.
        found: list[Array] = []
        self._field.apply(self._stencil, residual, out, lambda: found.append(self._displacement(sums)))
        self._subtract_far_field(found[0], out)

    def apply_uniform(self) -> Array:
        """Pressures M 1 that approximately remove a residual of one on every contact node."""
        out = self._weight.copy()
        self._subtract_far_field(self._displacement(self._cell_weight.copy()), out)
        return out

    def _subtract_far_field(self, displacement: Array, out: Array) -> None:
        """Subtract V y, given the displacement y of the cells."""

        def subtract(part: slice) -> None:
            _subtract_in_cells(self._cell[part], self._weight[part], displacement, out[part])

        in_parts(subtract, out.size, self._threads)

    def _displacement(self, cell_sums: Array) -> Array:
        """Displacement (σ + 1/G)⁻¹ Vᵀ r of the cells, given the sums of w r over them, which are used up."""
        cell_sums *= self._cells.size / self._grid.size
        displacement = self._solve_coarse(self._on_coarse_grid(cell_sums.reshape(self._cells.shape)))
        ny, nx = self._cells.shape
        return displacement[:ny, :nx].reshape(-1)

    def _sums_in_cells(self, add: Callable[..., None], *values: Array) -> Array:
        """Sums over the contact nodes of each cell."""
        sums = np.zeros(self._cells.size)

        def add_rows(rows: slice) -> None:
            part = slice(self._first_nodes[rows.start], self._first_nodes[rows.stop])
            add(self._cell[part], *(one[part] for one in values), sums)

        in_parts(add_rows, self._cells.shape[0], self._threads, smallest=LEAST_ROWS)
        return sums

    def _on_coarse_grid(self, of_cells: Array) -> Array:
        """Field of the cells in single precision, on the grid of the coarse transforms, zero elsewhere."""
        ny, nx = self._cells.shape
        out = np.zeros(self._coarse.grid.shape, np.float32)
        out[:ny, :nx] = of_cells
        return out

    def _solve_coarse(self, residual: Array) -> Array:
        """Displacement y of the cells with (σ + 1/G) y = residual, which is used up."""
        y, direction, image, response, z = (np.zeros_like(residual) for _ in range(5))
        coefficients = np.empty(self._coarse.grid.half_shape, self._coarse.complex)
        drop = min(COARSE_RESIDUAL_DROP, COARSE_RESIDUAL_DROP_OF_EDGE / max(residual.shape))
        first = previous = 0.0
        for iteration in range(MAX_COARSE_ITERATIONS):
            self._coarse.forward(residual, coefficients)
            multiply_rows(coefficients, self._inverse_for_mean)
            self._coarse.inverse(coefficients, z, overwrite=True)
            product = dot(residual.reshape(-1), z.reshape(-1))
            first = first or product
            if not product > drop**2 * first:
                break
            ratio = np.float32(product / previous) if iteration else np.float32(0)
            previous = product
            fields = (field.reshape(-1) for field in (residual, z, self._sigma, direction, image, response))
            curvature = _next_direction(ratio, self._mean_sigma, *fields)
            if not curvature > 0:
                break
            length = np.float32(product / curvature)
            add_multiple(y.reshape(-1), direction.reshape(-1), length)
            add_multiple(residual.reshape(-1), response.reshape(-1), -length)
        return y


def inverse_stencil(grid: Grid) -> Array:
    """Kernel of E* |q| / 2 in real space times spacing / E*, as a stencil that is the same for all nodes.

    It is zero beyond `RADIUS` nodes, or fewer on a small grid.
    """
    tile = Grid((64, 64), (64 * grid.spacing[0], 64 * grid.spacing[1]))
    kernel = Fourier(tile).inverse(0.5 * tile.wavenumber() * min(grid.spacing) / tile.size + 0j)
    radius = max(0, min(RADIUS, (min(grid.shape) - 1) // 2))
    row, column = np.ogrid[: RADIUS + 1, : RADIUS + 1]
    weights = np.where(row**2 + column**2 <= radius * (radius + 1), kernel[row, column], 0)
    return np.broadcast_to(weights, (2, 2, *weights.shape)).astype(np.float32)


@compiled
def _add_in_cells(cell: Any, weight: Any, sums: Any) -> None:
    """Add the weights to the sums of their cells."""
    for k in range(cell.size):
        sums[cell[k]] += weight[k]


@compiled
def _add_weighted_in_cells(cell: Any, weight: Any, values: Any, sums: Any) -> None:
    """Add weight × value to the sums of their cells."""
    for k in range(cell.size):
        sums[cell[k]] += weight[k] * values[k]


@compiled
def _subtract_in_cells(cell: Any, weight: Any, displacement: Any, out: Any) -> None:
    """Subtract weight × displacement of its cell from every contact node."""
    for k in range(cell.size):
        out[k] -= weight[k] * displacement[cell[k]]


@sums
def _next_direction(
    ratio: Any, mean_sigma: Any, residual: Any, z: Any, sigma: Any, direction: Any, image: Any, response: Any
) -> float:
    """Update direction and response of the coarse system, and return the curvature along the direction.

    `image` is (mean σ + 1/G) × direction. As (mean σ + 1/G) z is the residual, no division by a compliance
    that may be zero is needed.
    """
    curvature = 0.0
    for k in range(z.size):
        direction[k] = ratio * direction[k] + z[k]
        image[k] = ratio * image[k] + (residual[k] - mean_sigma * z[k])
        response[k] = sigma[k] * direction[k] + image[k]
        curvature += np.float64(direction[k]) * np.float64(response[k])
    return curvature
