"""Displacement of the contact nodes in inner solves, by a stencil and a grid of half the nodes.

An inner solve computes a correction, and the outer loop evaluates the gap anew: its displacement need not be
more accurate than a per cent. The convolution with the compliance G is therefore divided into

    G ≈ near + P far Pᵀ,

where P interpolates linearly from every second node on each axis, `far` is a convolution on those nodes, and
`near` is a stencil on all nodes. The far field takes one pair of transforms of a quarter of the nodes, in
single precision. It is G, divided by the square of the transform of P and smoothly cut off towards the
shortest wave of the coarser grid. The stencil is what of G is missing within its radius. Since the
interpolation from even nodes is not the same at even and at odd ones, neither is the stencil.

The division into a near field and a coarser grid is that of Brandt & Lubrecht (1990,
10.1016/0021-9991(90)90171-V), and a stencil that corrects what the coarser grid makes of the near field is
known from Phillips & White (1997, 10.1109/43.662670).
"""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np

from asperity.contact import even_nodes, kernels, stencil
from asperity.contact.problem import Problem
from asperity.contact.response import Response, multiply
from asperity.contact.stencil import StencilField, whole_stencil
from asperity.parallel import STRIP, in_parts, in_strips
from asperity.spectral import Fourier, Grid
from asperity.types import Array

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
    """Displacements, in units of `Problem.nodal_compliance`, under pressures on contact nodes.

    Parameters
    ----------
    problem : Problem

    Attributes
    ----------
    field : StencilField
        Restricted to the contact nodes. The preconditioner shares it.
    """

    def __init__(self, problem: Problem) -> None:
        self._response, self._unit = problem.response, problem.nodal_compliance
        self.field = StencilField(problem.grid, problem.response.repeats, problem.fourier.threads)
        self._divided = _can_be_divided(problem)
        if self._divided:
            self._far = FarField(problem.response, 1 / problem.nodal_compliance)
            self._stencil = near_stencil(problem)

    def restrict(self, nodes: Array) -> None:
        """Choose the contact nodes, by their sorted indices in the flattened grid."""
        self._nodes = nodes
        self.field.restrict(nodes)
        if self._divided:
            self._far.restrict(nodes)

    def respond(self, pressure: Array, out: Array) -> None:
        """Write the displacements of the contact nodes under pressures on them."""
        if not self._divided:
            out[:] = self.of_all_nodes(pressure).reshape(-1)[self._nodes]
            return
        self.field.apply(self._stencil, pressure, out)
        self._far.spread(pressure)
        self._far.add(out)

    def respond_at(self, nodes: Array, pressure: Array) -> Array:
        """Displacements of other nodes under pressures on the contact nodes."""
        if not self._divided:
            return self.of_all_nodes(pressure).reshape(-1)[nodes]
        out = self.field.apply_at(self._stencil, pressure, nodes)
        self._far.spread(pressure)
        self._far.add_at(nodes, out)
        return out

    def of_all_nodes(self, pressure: Array) -> Array:
        """Displacement [y, x] of all nodes, to single precision."""
        field = np.empty(self._response.grid.shape, np.float32)
        kernels.spread(field.reshape(-1), self._nodes, pressure, 0)
        self._in_single_precision.displacement(field, field)
        field *= np.float32(1 / self._unit)
        return field

    @cached_property
    def _in_single_precision(self) -> Response:
        single = self._response.fourier.real == np.float32
        return self._response if single else self._response.in_single_precision()


class FarField:
    """Convolution on every second node of the long waves of a compliance.

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

    def restrict(self, nodes: Array) -> None:
        """Choose the nodes under pressure, by their sorted indices in the flattened map."""
        even_rows, width = self._padded.shape
        self._places = even_nodes.places_of(nodes, self._shape, width, self._fourier.threads)
        ny, nx = self._shape
        strips = max(2, even_rows * width // max(STRIP, width))
        self._edges = even_rows * np.arange(strips + 1) // strips
        first_rows = np.minimum(2 * self._edges, ny)
        self._first_nodes = np.searchsorted(nodes, (first_rows * nx).astype(nodes.dtype))

    def spread(self, pressure: Array) -> None:
        """Convolve the pressures on the chosen nodes."""
        width, field = self._padded.shape[1], self._padded.reshape(-1)
        strips = self._edges, width

        def spread(odd: int, some: slice) -> None:
            chosen = some.start, some.stop, odd
            even_nodes.spread_transposed(self._places, pressure, self._first_nodes, *strips, *chosen, field)

        for odd, count in enumerate((self._edges.size // 2, (self._edges.size - 1) // 2)):
            in_parts(partial(spread, odd), count, self._fourier.threads, smallest=1)
        self._convolve(self._padded)

    def add(self, out: Array) -> None:
        """Add the displacements at the chosen nodes to values."""
        self._add(self._places, out)

    def add_at(self, nodes: Array, out: Array) -> None:
        """Add the displacements at other nodes to values."""
        width, threads = self._padded.shape[1], self._fourier.threads
        self._add(even_nodes.places_of(nodes, self._shape, width, threads), out)

    def _add(self, places: Array, out: Array) -> None:
        field, width = self._padded.reshape(-1), self._padded.shape[1]

        def add(part: slice) -> None:
            even_nodes.add_interpolated(field, places[part], width, out[part])

        in_parts(add, out.size, self._fourier.threads)

    def _convolve(self, padded: Array) -> None:
        """Replace sums over the even nodes by displacements there.

        The last row and column repeat the first ones.
        """
        if self._repeats:
            padded[0] += padded[-1]
            padded[:, 0] += padded[:, -1]
        values = padded[:-1, :-1]
        coefficients = self._fourier.forward(values, self._coefficients)
        multiply(coefficients, self._half_factors, self._fourier.threads)
        self._fourier.inverse(coefficients, values, overwrite=True)
        padded[-1, :-1], padded[:-1, -1] = padded[0, :-1], padded[:-1, 0]
        padded[-1, -1] = padded[0, 0]


def near_stencil(problem: Problem) -> Array:
    """Displacements near one node under pressure that the far field lacks, in units of the nodal compliance.

    Returns
    -------
    array
        A stencil of `asperity.contact.stencil.whole_stencil`.
    """
    outer, radius = problem.response, stencil.RADIUS
    spacing = problem.grid.spacing
    tile = Grid((_TILE, _TILE), (_TILE * spacing[0], _TILE * spacing[1]))
    response = type(outer).on(problem.solid, tile, np.float64)
    far = FarField(response, 1.0, "float64")
    offsets = np.arange(-radius, radius + 1)
    inside = offsets[:, None] ** 2 + offsets[None, :] ** 2 <= radius * (radius + 1)
    edge = inside & (offsets[:, None] ** 2 + offsets[None, :] ** 2 > radius * (radius - 1))
    out = np.zeros((2, 2, radius + 1, radius + 1), np.float32)
    for row in range(2):
        for column in range(2):
            y, x = _TILE // 2 + row, _TILE // 2 + column
            unit = np.zeros(tile.shape)
            unit[y, x] = 1
            missing = response.displacement(unit)
            far.restrict(np.array([y * _TILE + x], np.uint32))
            far.spread(np.ones(1))
            far_field = np.zeros(tile.size)
            far.add_at(np.arange(tile.size, dtype=np.uint32), far_field)
            missing -= far_field.reshape(tile.shape)
            around = missing[y - radius : y + radius + 1, x - radius : x + radius + 1]
            weights = np.where(inside, around, 0)
            # What is beyond the stencil is added to its edge, so that uniform pressures are displaced right.
            weights[edge] += (missing.sum() - weights.sum()) / np.count_nonzero(edge)
            out[row, column] = weights[radius:, radius:] / problem.nodal_compliance
    return whole_stencil(out)


def _can_be_divided(problem: Problem) -> bool:
    """True if the grid is large enough, and every second node of it is a grid of its own."""
    ratio = max(problem.grid.spacing) / min(problem.grid.spacing)
    even = all(nodes % 2 == 0 for nodes in problem.response.mode_grid.shape)
    return even and min(problem.grid.shape) >= MIN_POINTS and ratio <= MAX_SPACING_RATIO
