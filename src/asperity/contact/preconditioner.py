"""Approximate inverse of the compliance on the contact: a stencil for what is near, a coarse grid beyond.

The inverse of the compliance acts like |q|, whose kernel decays as r⁻³. Cut off at a few nodes and restricted
to the contact it is a sparse matrix S, almost free to apply. It does not know that distant contacts bear
on each other: a uniform residual is met by the pressure w = S 1, as if every patch stood alone. On waves much
longer than the patches that pressure is too large. There contacts act by their sums over the cells of a
coarse grid alone. With σ the sum of w in each cell per area, V spreading a value of each cell over its
contact nodes in proportion to w, and G the compliance on the coarse grid, the pressures of a wave obey
(1/σ + G) p = r, where S assumes p = σ r. By Woodbury's identity what is to be taken off is

    M = S − V (σ + 1/G)⁻¹ Vᵀ.

S is w on its diagonal and a graph Laplacian besides, so that M is positive definite for any G ≥ 0; in full
contact with a half-space, where S has the eigenvalue σ for long waves, M has σ q / (σ + q), which tends to q.
The system of the coarse grid is solved by a few conjugate gradients, preconditioned by its mean σ.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from asperity.contact.kernels import dot
from asperity.contact.problem import Problem
from asperity.spectral import Fourier, Grid
from asperity.types import Array

# Radius, in nodes, of the stencil.
RADIUS = 3

# Nodes on the edge of a cell of the coarse grid.
CELL = 16

# The coarse system is solved until its residual has dropped so far, or for so many iterations.
COARSE_DROP = 0.03
COARSE_ITERATIONS = 20


class Preconditioner:
    """Approximate inverse of a compliance, restricted to a set of contact nodes.

    Residuals are displacements in units of `unit`; what meets them are pressures.

    Parameters
    ----------
    problem : Problem
    unit : float
        Displacement of a node per pressure on it: spacing / E*.
    """

    def __init__(self, problem: Problem, unit: float) -> None:
        grid, outer = problem.grid, problem.fourier
        ny, nx = grid.shape
        self.grid = grid
        self.weights = stencil(grid)
        self.padded = np.zeros((ny + 2 * RADIUS, nx + 2 * RADIUS), np.float32)
        self.cells = Grid((max(1, ny // CELL), max(1, nx // CELL)), grid.length)
        self.coarse = Fourier(self.cells, np.float32, outer.threads, outer.work)
        self.compliance = problem.layer.grid_surface_compliance(self.cells, np.dtype(float)) / unit
        self._nodes = np.empty(0, np.uint64)

    def restrict(self, plain: Array) -> None:
        """Take a set of contact nodes, by their numbers in the flattened grid."""
        self.padded.fill(0)
        self._nodes, self._cell = _locate(plain, *self.grid.shape, *self.cells.shape)
        self._weight = np.empty(plain.size, np.float32)
        self._apply_stencil(np.ones(plain.size, np.float32), self._weight)
        self._total = _sum_in_cells(self._cell, self._weight, self.cells.size)
        share = (self._total * (self.cells.size / self.grid.size)).reshape(self.cells.shape)
        mean = float(share.mean())
        self._share = share.astype(np.float32)
        self._mean_share = np.float32(mean)
        self._smoother = (self.compliance / (1 + mean * self.compliance)).astype(np.float32)

    def spread(self, values: Array) -> Array:
        """Values on the contact as a field [y, x] that is zero elsewhere, a view of the working space."""
        _scatter(self.padded.reshape(-1), self._nodes, values)
        ny, nx = self.grid.shape
        return self.padded[RADIUS : RADIUS + ny, RADIUS : RADIUS + nx]

    def apply(self, values: Array, out: Array) -> None:
        """Pressures that meet a residual on the contact."""
        self._apply_stencil(values, out)
        self._take_off(_weighted_sum_in_cells(self._cell, self._weight, values, self.cells.size), out)

    def apply_uniform(self) -> Array:
        """Pressures that meet a residual of one."""
        out = self._weight.copy()
        self._take_off(self._total.copy(), out)
        return out

    def _take_off(self, total: Array, out: Array) -> None:
        total *= self.cells.size / self.grid.size
        displacement = self._solve_coarse(total.astype(np.float32).reshape(self.cells.shape))
        _take_off(self._cell, self._weight, displacement.reshape(-1), out)

    def _apply_stencil(self, values: Array, out: Array) -> None:
        self.spread(values)
        _wrap(self.padded)
        _apply_stencil(self.padded.reshape(-1), self.padded.shape[1], self._nodes, self.weights, out)

    def _solve_coarse(self, residual: Array) -> Array:
        """Displacement y of the cells with (σ + 1/G) y = residual, which is used up."""
        y = np.zeros_like(residual)
        direction = np.zeros_like(residual)
        image = np.zeros_like(residual)
        first = previous = 0.0
        for iteration in range(COARSE_ITERATIONS):
            coefficients = self.coarse.forward(residual)
            coefficients *= self._smoother
            z = self.coarse.inverse(coefficients, overwrite=True)
            product = dot(residual.reshape(-1), z.reshape(-1))
            first = first or product
            if not product > COARSE_DROP**2 * first:
                break
            ratio = np.float32(product / previous) if iteration else np.float32(0)
            previous = product
            direction *= ratio
            direction += z
            # (mean σ + 1/G) z is the residual: 1/G z needs no division by a compliance that may be zero.
            image *= ratio
            image += residual
            image -= self._mean_share * z
            response = self._share * direction
            response += image
            curvature = dot(direction.reshape(-1), response.reshape(-1))
            if not curvature > 0:
                break
            length = np.float32(product / curvature)
            y += length * direction
            residual -= length * response
        return y


def stencil(grid: Grid) -> Array:
    """Real-space kernel of |q|, in units of the inverse spacing: one quadrant, (RADIUS + 1, RADIUS + 1).

    It is cut off at `RADIUS` nodes, or less on a small grid.
    """
    tile = Grid((64, 64), (64 * grid.spacing[0], 64 * grid.spacing[1]))
    kernel = Fourier(tile).inverse(0.5 * tile.wavenumber() * min(grid.spacing) / tile.size + 0j)
    radius = max(0, min(RADIUS, (min(grid.shape) - 1) // 2))
    row, column = np.ogrid[: RADIUS + 1, : RADIUS + 1]
    near = row**2 + column**2 <= radius * (radius + 1)
    return np.where(near, kernel[: RADIUS + 1, : RADIUS + 1], 0).astype(np.float32)


@njit(cache=True, error_model="numpy")
def _locate(plain: Any, ny: int, nx: int, cells_y: int, cells_x: int) -> tuple[Any, Any]:
    """Numbers of contact nodes in the padded array, and of the cells they lie in."""
    # Unsigned, because the compiler guards every access by a signed number against one below zero.
    nodes = np.empty(plain.size, np.uint64)
    cell = np.empty(plain.size, np.uint32)
    of_column = (np.arange(nx) * cells_x) // nx
    for k in range(plain.size):
        i = np.int64(plain[k])
        row = i // nx
        column = i - row * nx
        nodes[k] = (row + RADIUS) * (nx + 2 * RADIUS) + column + RADIUS
        cell[k] = (row * cells_y) // ny * cells_x + of_column[column]
    return nodes, cell


@njit(cache=True, error_model="numpy")
def _sum_in_cells(cell: Any, weight: Any, count: int) -> Any:
    total = np.zeros(count)
    for k in range(cell.size):
        total[cell[k]] += weight[k]
    return total


@njit(cache=True, error_model="numpy")
def _weighted_sum_in_cells(cell: Any, weight: Any, values: Any, count: int) -> Any:
    total = np.zeros(count)
    for k in range(cell.size):
        total[cell[k]] += weight[k] * values[k]
    return total


@njit(cache=True, error_model="numpy")
def _take_off(cell: Any, weight: Any, displacement: Any, out: Any) -> None:
    for k in range(cell.size):
        out[k] -= weight[k] * displacement[cell[k]]


@njit(cache=True, error_model="numpy")
def _scatter(field: Any, nodes: Any, values: Any) -> None:
    for k in range(nodes.size):
        field[nodes[k]] = values[k]


@njit(cache=True, error_model="numpy")
def _wrap(field: Any) -> None:
    """Repeat the cell in the padding."""
    ny, nx = field.shape[0] - 2 * RADIUS, field.shape[1] - 2 * RADIUS
    for i in range(RADIUS, RADIUS + ny):
        for j in range(RADIUS):
            field[i, j] = field[i, RADIUS + (j - RADIUS) % nx]
        for j in range(RADIUS + nx, field.shape[1]):
            field[i, j] = field[i, RADIUS + (j - RADIUS) % nx]
    for i in range(RADIUS):
        field[i] = field[RADIUS + (i - RADIUS) % ny]
        field[RADIUS + ny + i] = field[RADIUS + i % ny]


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _apply_stencil(field: Any, width: int, nodes: Any, weights: Any, out: Any) -> None:
    row = np.uint64(width)
    for k in range(nodes.size):
        node = nodes[k]
        value = weights[0, 0] * field[node]
        for i in range(1, RADIUS + 1):
            up = np.uint64(i) * row
            value += weights[i, 0] * _pair(field, node, up) + weights[0, i] * _pair(field, node, np.uint64(i))
            for j in range(1, RADIUS + 1):
                if i * i + j * j <= RADIUS * (RADIUS + 1):
                    aside = np.uint64(j)
                    value += weights[i, j] * (_pair(field, node + up, aside) + _pair(field, node - up, aside))
        out[k] = value


@njit(cache=True, error_model="numpy")
def _pair(field: Any, node: Any, step: Any) -> Any:
    return field[node + step] + field[node - step]
