"""Displacement of the contact nodes in inner solves, by a stencil and a grid of half the nodes.

An inner solve computes a correction, and the outer loop evaluates the gap anew: its displacement need not be
more accurate than a per cent. The convolution with the compliance G is therefore divided into

    G ≈ near + P far Pᵀ,

where P interpolates linearly from every second node on each axis, `far` is a convolution on those nodes, and
`near` is a stencil on all nodes. The far field takes one pair of transforms of a quarter of the nodes, in
single precision. It is G, divided by the square of the transform of P and smoothly cut off towards the
shortest wave of the coarser grid. The stencil is what of G is missing within its radius. Since the
interpolation from coarse-grid nodes is not the same at even and at odd nodes, neither is the stencil.

The division into a near field and a coarser grid is that of Brandt & Lubrecht (1990,
10.1016/0021-9991(90)90171-V), and a stencil that corrects what the coarser grid makes of the near field is
known from Phillips & White (1997, 10.1109/43.662670).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compliance import coarse_nodes, stencil
from asperity.contact.compliance.response import Response, multiply
from asperity.contact.compliance.stencil import StencilProduct, whole_stencil
from asperity.contact.compliance.vectors import field_of
from asperity.core.parallel import in_parts, in_strips
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid

# The far field is multiplied by exp(−(CUTOFF q / q_c)⁴), with the shortest wave q_c of the coarser grid. The
# displacement under random pressures on the contact of a rough surface of 256² nodes is then wrong by 1.2 %,
# with 0.7 or 0.9 instead by 2.3 %; without the factor a solution takes twice as many steps.
CUTOFF = 0.8

# Grids with fewer nodes on an axis are not divided: their transforms take no time.
MIN_POINTS = 128

# The spacings of a grid that is divided differ at most by this factor: the stencil has the same radius, in
# nodes, on both axes.
MAX_SPACING_RATIO = 1.5

# Nodes on the edge of the small map on which the stencil is computed.
_TILE = 64


class InnerResponse:
    """Displacements, in units of `Response.nodal_compliance`, under pressures on some nodes.

    Parameters
    ----------
    response : Response
    products : StencilProduct
        For the same grid.
    """

    def __init__(self, response: Response, products: StencilProduct) -> None:
        self._grid, self._unit = response.grid, response.nodal_compliance
        self._products = products
        self._far: FarField | None = None
        self._response: Response | None = None
        if _can_be_divided(response):
            self._far = FarField(response, 1 / self._unit)
            self._stencil = near_stencil(response)
        else:
            single = response.fourier.real == np.float32
            self._response = response if single else response.in_precision("float32")

    def indices(self, nodes: Array) -> Array | None:
        """Indices of nodes among the coarse-grid nodes, which `displacement` needs."""
        return None if self._far is None else self._far.indices(nodes)

    def displacement(
        self,
        pressure: Array,
        nodes: Array,
        indices: Array | None,
        at: Array | None = None,
    ) -> Array:
        """Displacements under pressures on nodes, at these nodes or at others.

        Parameters
        ----------
        pressure : (count,) array
        nodes : (count,) array of unsigned integers
            Sorted indices in the flattened map.
        indices : array or None
            From `indices`.
        at : array, optional
        """
        if self._far is None:
            assert self._response is not None
            field = field_of(self._grid.shape, nodes, pressure)
            self._response.displacement(field, field)
            return field.reshape(-1)[nodes if at is None else at] * np.float32(1 / self._unit)
        far = self._far
        out = self._products(
            self._stencil, nodes, pressure, at, meanwhile=lambda: far.restrict(pressure, indices)
        )
        far.convolve()
        far.add(out, indices if at is None else far.indices(at))
        return out


class FarField:
    """Convolution on every second node of the long waves of a compliance, in an array of its own.

    Parameters
    ----------
    response : Response
    scale : float
        Factor of the displacements.
    dtype : "float32" or "float64"
    """

    def __init__(self, response: Response, scale: float, dtype: str = "float32") -> None:
        modes = response.mode_grid
        ny, nx = modes.shape
        self._shape = response.grid.shape
        self._repeats = response.repeats
        grid = Grid((ny // 2, nx // 2), modes.length)
        self._fourier = Fourier(grid, dtype, response.fourier.threads, response.fourier.work)
        half = response.half_compliance[: grid.shape[0] // 2 + 1, : nx // 4 + 1]
        self._half_factors = np.empty(half.shape, self._fourier.real)
        (cosine_y, distance_y), (cosine_x, distance_x) = (
            (np.cos(np.pi * wavenumber / nodes) ** 2, (4 * wavenumber / nodes) ** 2)
            for wavenumber, nodes in ((grid.ky[: len(half), None], ny), (grid.kx[None, :], nx))
        )

        def fill(rows: slice) -> None:
            attenuation, distance = cosine_y[rows] * cosine_x, distance_y[rows] + distance_x
            factors = np.exp(-((CUTOFF**2 * distance) ** 2)) / attenuation**2 * (scale / 4)
            self._half_factors[rows] = half[rows].astype(float) * factors

        in_strips(fill, half.shape, response.fourier.threads)
        self._padded = np.zeros((grid.shape[0] + 1, grid.shape[1] + 1), self._fourier.real)
        self._coefficients = np.empty(grid.half_shape, self._fourier.complex)

    def indices(self, nodes: Array) -> Array:
        """Indices of nodes of the map among the coarse-grid nodes."""
        return coarse_nodes.coarse_indices(nodes, self._shape, self._padded.shape[1])

    def restrict(self, pressure: Array, indices: Any) -> None:
        """Write the sums of pressures on nodes over the coarse-grid nodes."""
        self._padded[:] = 0
        coarse_nodes.restrict(indices, pressure, self._padded.shape[1], self._padded.reshape(-1))

    def convolve(self) -> None:
        """Replace sums over the coarse-grid nodes by displacements there.

        The last row and column repeat the first ones.
        """
        padded = self._padded
        if self._repeats:
            padded[0] += padded[-1]
            padded[:, 0] += padded[:, -1]
        values = padded[:-1, :-1]
        coefficients = self._fourier.forward(values, self._coefficients)
        multiply(coefficients, self._half_factors, self._fourier.threads)
        self._fourier.inverse(coefficients, values, overwrite=True)
        padded[-1, :-1], padded[:-1, -1] = padded[0, :-1], padded[:-1, 0]
        padded[-1, -1] = padded[0, 0]

    def add(self, out: Array, indices: Any) -> None:
        """Add the displacements at nodes, given by their indices, to values."""
        field, width = self._padded.reshape(-1), self._padded.shape[1]

        def add(part: slice) -> None:
            coarse_nodes.add_prolongated(field, indices[part], width, out[part])

        in_parts(add, out.size, self._fourier.threads)


def near_stencil(response: Response) -> Array:
    """Displacements near one node under pressure that the far field lacks, in units of the nodal compliance.

    Returns
    -------
    array
        A stencil of `asperity.contact.compliance.stencil.whole_stencil`.
    """
    radius = stencil.RADIUS
    spacing = response.grid.spacing
    tile = Grid((_TILE, _TILE), (_TILE * spacing[0], _TILE * spacing[1]))
    of_tile = type(response)(response.solid, response.transforms(tile))
    far = FarField(of_tile, 1.0, "float64")
    everywhere = far.indices(np.arange(tile.size, dtype=np.uint32))
    offsets = np.arange(-radius, radius + 1)
    inside = offsets[:, None] ** 2 + offsets[None, :] ** 2 <= radius * (radius + 1)
    edge = inside & (offsets[:, None] ** 2 + offsets[None, :] ** 2 > radius * (radius - 1))
    out = np.zeros((2, 2, radius + 1, radius + 1), np.float32)
    for row, column in np.ndindex(2, 2):
        y, x = _TILE // 2 + row, _TILE // 2 + column
        unit = np.zeros(tile.shape)
        unit[y, x] = 1
        missing = of_tile.displacement(unit)
        far.restrict(np.ones(1), far.indices(np.array([y * _TILE + x], np.uint32)))
        far.convolve()
        far_field = np.zeros(tile.size)
        far.add(far_field, everywhere)
        missing -= far_field.reshape(tile.shape)
        around = missing[y - radius : y + radius + 1, x - radius : x + radius + 1]
        weights = np.where(inside, around, 0)
        # The remainder beyond the stencil is added to its edge, so that uniform pressures are right.
        weights[edge] += (missing.sum() - weights.sum()) / np.count_nonzero(edge)
        out[row, column] = weights[radius:, radius:] / response.nodal_compliance
    return whole_stencil(out)


def _can_be_divided(response: Response) -> bool:
    """True if the grid is large enough, and every second node of it is a grid of its own."""
    grid = response.grid
    even = all(nodes % 2 == 0 for nodes in response.mode_grid.shape)
    ratio = max(grid.spacing) / min(grid.spacing)
    return even and min(grid.shape) >= MIN_POINTS and ratio <= MAX_SPACING_RATIO
