"""Approximate inverse of the compliance on the contact nodes: a stencil, corrected on a coarse grid.

The inverse of a half-space's compliance is E* |q| / 2, whose kernel in real space decays as r⁻³. Cut off at a
few nodes and restricted to the contact nodes it is a sparse matrix S that is cheap to apply. It is akin to
the FFT-based preconditioner of Vollebregt (J. Comput. Phys. 257 (2014) 333). What S lacks is the elastic
interaction of distant contacts: it removes a uniform residual by the pressure w = S 1, as if every contact
patch stood alone. For residuals that vary over lengths much longer than the patches that pressure is too
large.

New here is the correction of these long waves on a coarse grid. There a contact acts only by its sum over a
cell. Let σ be the sum of w in each cell divided by the cell's area, V the operator that distributes a value
of each cell over its contact nodes in proportion to w, and G the compliance on the coarse grid. The pressure
of a long wave obeys (1/σ + G) p = r, where S assumes p = σ r. With Woodbury's identity,

    (1/σ + G)⁻¹ = σ − σ (σ + 1/G)⁻¹ σ,      the preconditioner becomes      M = S − V (σ + 1/G)⁻¹ Vᵀ.

S is the sum of diag(w) and a graph Laplacian, so that M is positive definite for every G ≥ 0. In full contact
with a half-space, where S has the eigenvalue σ for long waves, M has σ q / (σ + q), which tends to q. The
system of the coarse grid is solved by a few conjugate gradients, preconditioned by the same operator with the
mean of σ.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compliance.response import Response, multiply_rows
from asperity.contact.compliance.stencil import RADIUS, StencilProduct, whole_stencil
from asperity.contact.compliance.vectors import add_multiple, dot, row_plus_column
from asperity.core.compiled import compiled, sums
from asperity.core.parallel import in_parts
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid

# Nodes on the edge of a cell of the coarse grid. Found by trial on rough surfaces of 512² nodes: with 32
# nodes a solution takes 7 % more transforms, with 8 as many, but the coarse grid is four times larger.
CELL_NODES = 16

# The coarse system is solved until the preconditioned norm of its residual has dropped by this factor, or on
# more than 200 cells by 6 / cells on an edge: the more cells, the more S overestimates the longest waves.
COARSE_RESIDUAL_DROP = 0.03
MAX_COARSE_ITERATIONS = 50


class Preconditioner:
    """Approximate inverse of the compliance of one grid.

    Parameters
    ----------
    response : Response
    products : StencilProduct
        For the same grid.

    Attributes
    ----------
    nodal_stiffness : float
        Pressure that removes a unit residual of a node that alone is in contact.
    """

    def __init__(self, response: Response, products: StencilProduct) -> None:
        grid = response.grid
        quadrants = inverse_stencil(grid)
        self.nodal_stiffness = float(quadrants[0, 0, 0, 0])
        self.grid, self.products, self.threads = grid, products, response.fourier.threads
        self.stencil = whole_stencil(quadrants)
        self.cells = Grid(tuple(max(1, n // CELL_NODES) for n in grid.shape), grid.length)  # type: ignore[arg-type]
        self.coarse, compliance = response.on_cells(self.cells)
        self.compliance = compliance / response.nodal_compliance

    def on_coarse_grid(self, of_cells: Array) -> Array:
        """Field of the cells in single precision, on the grid of the coarse transforms, zero elsewhere."""
        ny, nx = self.cells.shape
        out = np.zeros(self.coarse.grid.shape, np.float32)
        out[:ny, :nx] = of_cells.reshape(ny, nx)
        return out


class NodePreconditioner:
    """A preconditioner restricted to contact nodes.

    It maps residuals, displacements in units of `Response.nodal_compliance`, to the pressures that remove
    them.

    Parameters
    ----------
    whole : Preconditioner
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.

    Attributes
    ----------
    uniform : (count,) array
        Pressures M 1 that approximately remove a residual of one on every contact node.
    """

    def __init__(self, whole: Preconditioner, nodes: Array) -> None:
        self._whole, self._nodes = whole, nodes
        grid, cells = whole.grid, whole.cells
        row, column = (np.arange(n) * m // n for n, m in zip(grid.shape, cells.shape, strict=True))
        of_row, of_column = (row * cells.shape[1]).astype(np.uint32), column.astype(np.uint32)
        self._cell = row_plus_column(nodes, of_row, of_column)
        ones = np.ones(nodes.size, np.float32)
        self._weight = whole.products(whole.stencil, nodes, ones)
        cell_weight = self._sums_in_cells(ones)
        sigma = cell_weight * (cells.size / grid.size)
        mean = float(sigma.mean())
        self._sigma, self._mean_sigma = whole.on_coarse_grid(sigma), np.float32(mean)
        self._inverse_for_mean = (whole.compliance / (1 + mean * whole.compliance)).astype(np.float32)
        self.uniform = self._weight.copy()
        self._subtract_far_field(self._displacement(cell_weight), self.uniform)

    def __call__(self, residual: Array) -> Array:
        """Pressures M r that approximately remove a residual r on the contact nodes."""
        found: list[Array] = []

        def solve_coarse() -> None:
            found.append(self._displacement(self._sums_in_cells(residual)))

        # The coarse system is too small for several threads: the others apply the stencil.
        whole = self._whole
        out = whole.products(whole.stencil, self._nodes, residual, meanwhile=solve_coarse)
        self._subtract_far_field(found[0], out)
        return out

    def _subtract_far_field(self, displacement: Array, out: Array) -> None:
        """Subtract V y, given the displacement y of the cells."""

        def subtract(part: slice) -> None:
            _subtract_in_cells(self._cell[part], self._weight[part], displacement, out[part])

        in_parts(subtract, out.size, self._whole.threads)

    def _sums_in_cells(self, values: Array) -> Array:
        """Sums of w × value over the contact nodes of each cell."""
        out = np.zeros(self._whole.cells.size)
        _add_weighted_in_cells(self._cell, self._weight, values, out)
        return out

    def _displacement(self, cell_sums: Array) -> Array:
        """Displacement (σ + 1/G)⁻¹ Vᵀ r of the cells, given the sums of w r over them."""
        whole, fourier = self._whole, self._whole.coarse
        residual = whole.on_coarse_grid(cell_sums * (whole.cells.size / whole.grid.size))
        y, direction, image, response, z = (np.zeros_like(residual) for _ in range(5))
        coefficients = np.empty(fourier.grid.half_shape, fourier.complex)
        drop = min(COARSE_RESIDUAL_DROP, 6.0 / max(residual.shape))
        first = previous = 0.0
        for iteration in range(MAX_COARSE_ITERATIONS):
            fourier.forward(residual, coefficients)
            multiply_rows(coefficients, self._inverse_for_mean)
            fourier.inverse(coefficients, z, overwrite=True)
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
        ny, nx = whole.cells.shape
        return y[:ny, :nx].reshape(-1)


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
