"""Surface of a half-space under an isolated load: compliance of a loaded rectangle, and padded transforms.

A pressure p on a rectangle displaces the surface of a half-space by

    u(x, y) = p / (π E*) ∫∫ dξ dη / √((x − ξ)² + (y − η)²),

which A. E. H. Love (Phil. Trans. R. Soc. A 228 (1929) 377, DOI 10.1098/rsta.1929.0009) gave in closed form.
With the edges x₁ < x₂ and y₁ < y₂ of the rectangle as seen from the point,

    u π E* / p = x₂ D(y; x₂) − x₁ D(y; x₁) + y₂ D(x; y₂) − y₁ D(x; y₁),
    D(t; s) = asinh(t₂ / |s|) − asinh(t₁ / |s|).

Nothing repeats and nothing is approximated. If the pressure is uniform on the rectangle of each node, the
displacement of all nodes is a sum of such terms. That sum is a convolution, and it is a product of Fourier
coefficients on a grid of at least twice the nodes, on which the pressure is padded with zeros (R. W. Hockney,
Methods Comput. Phys. 9 (1970) 135; S. Liu, Q. Wang, G. Liu, Wear 243 (2000) 101, DOI
10.1016/S0043-1648(00)00427-0).

A map may repeat along one axis and end along the other one, such as a roller's. A rectangle then has images
at all multiples of the period, and along the axis that repeats nothing is padded. The displacement by a
uniform line grows with the logarithm of the distance, without limit; it is measured from the surface at a
distance from the line equal to the edge of the map along the axis that ends.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from asperity.core.compiled import compiled
from asperity.core.sizes import good_size
from asperity.core.types import Array, ArrayLike
from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Fourier, Grid

# Distance over half of the longer edge beyond which sixth moments of a rectangle are below rounding errors.
_FAR = 200.0

# A sum over images takes the nearest three at all points, more up to a number of them at a few rows between
# which it is interpolated, and the others as long rectangles, with so many differences of these: its error is
# below 1e-11 of the influence at a distance of the period.
_IMAGES, _ROWS_BETWEEN, _DIFFERENCES = 12, 20, 5

# Length of a rectangle that stands for an infinite strip, over the distances along and across it.
_STRIP = 1e11

FREE = True, True
"""The map ends along both axes."""

Influence = Callable[[Array, Array, tuple[float, float]], Array]
"""(y, x, edges) → influence, (ny, nx), of a rectangle at distances y and x from its middle."""

# Columns at the end of the padded rows, so that the same elements of several rows do not compete for the same
# lines of the processor's cache.
_UNUSED_COLUMNS = 16


def rectangle_compliance(
    y: ArrayLike, x: ArrayLike, edges: tuple[float, float], effective_modulus: float
) -> Array:
    """Downward displacement per unit of a uniform pressure on a rectangle, at points of the surface.

    Parameters
    ----------
    y, x : array
        Position of the points relative to the centre of the rectangle; they broadcast.
    edges : (edge_y, edge_x)
    effective_modulus : float

    Returns
    -------
    compliance : array
        In length per pressure, of the broadcast shape. The relative rounding error is about 1e-16 times the
        distance over an edge.
    """
    y, x = np.broadcast_arrays(np.abs(np.asarray(y, float)), np.abs(np.asarray(x, float)))
    out = np.empty(y.shape)
    _fill_compliance(y.flatten(), x.flatten(), 0.5 * edges[0], 0.5 * edges[1], out.reshape(-1))
    out /= np.pi * effective_modulus
    return out


def rectangle_slope_x(
    y: ArrayLike, x: ArrayLike, edges: tuple[float, float], effective_modulus: float
) -> Array:
    """Derivative of `rectangle_compliance` with respect to x; infinite on the two edges along y."""
    y, x = np.broadcast_arrays(np.asarray(y, float), np.asarray(x, float))
    out = np.empty(y.shape)
    _fill_slope(np.abs(y).ravel(), np.abs(x).ravel(), 0.5 * edges[0], 0.5 * edges[1], out.reshape(-1))
    out *= np.sign(x) / (np.pi * effective_modulus)
    return out


def rectangle_moments(y: ArrayLike, x: ArrayLike, edges: tuple[float, float]) -> Array:
    """∫∫ of η²/ρ³, ξ²/ρ³ and η ξ/ρ³ over a rectangle, at points of the surface.

    ρ = (η, ξ) is the vector from a point of the rectangle to the point of the surface. The first two add up
    to the integral of 1/ρ in the compliance; all three make up the displacement by a shear traction
    (V. Cerruti; K. L. Johnson, Contact Mechanics, 1985, section 3.6).

    Parameters
    ----------
    y, x, edges
        As for `rectangle_compliance`.

    Returns
    -------
    (3, ...) array
        Lengths.
    """
    y, x = np.broadcast_arrays(np.asarray(y, float), np.asarray(x, float))
    out = np.empty((3, *y.shape))
    _fill_moments(np.abs(y).ravel(), np.abs(x).ravel(), 0.5 * edges[0], 0.5 * edges[1], out.reshape(3, -1))
    out[2] *= np.sign(y) * np.sign(x)
    return out


def with_images(
    influence: Influence,
    y: Array,
    x: Array,
    grid: Grid,
    free: tuple[bool, bool],
    at_reference: tuple[float, float] = (0.0, 0.0),
    far: float = 0.0,
) -> Array:
    """Influence, (ny, nx), of the rectangle of a node and of its images along the axis that repeats.

    The images beyond the Mth are written as boxes of the length of the period, each a series of even central
    differences of such boxes (the formula of Euler and Maclaurin in differences): with t = δ/2 and w the edge
    over the period, a rectangle is sinh(w asinh t)/t times the box. The sum of the boxes is an infinite strip
    less a long rectangle.

    Parameters
    ----------
    influence : callable
        (y, x, edges) → influence, (ny, nx), of a rectangle at distances from its middle.
    y, x : (ny,), (nx,) arrays
        Along the axis within a period.
    grid : Grid
    free : (bool, bool)
        The map ends along one axis.
    at_reference : (float, float)
        a and b, if a line of length H has the influence a ln(H/c) + b where it is measured from, at a
        distance of the edge c of the map.
    far : float
        Another distance, as `y` and `x`.
    """
    if free[0]:
        turned = Grid(grid.shape[::-1], grid.length[::-1])
        kernel: Influence = lambda y, x, edges: influence(x, y, edges[::-1]).T  # noqa: E731
        return with_images(kernel, x, y, turned, free[::-1], at_reference, far).T
    (edge, across), (period, width) = grid.spacing, grid.length
    middle, half = 0.5 * (y.max() + y.min()), 0.5 * (y.max() - y.min()) or 0.1 * period
    nodes = np.cos(np.pi * (np.arange(_ROWS_BETWEEN) + 0.5) / _ROWS_BETWEEN)
    rows, share = middle + half * nodes, edge / period
    strip = _STRIP * max(_IMAGES * period, np.abs(x).max(), far)
    a, b = at_reference
    rest = share * (influence(rows, x, (strip, across)) - across * (a * math.log(strip / width) + b))
    for image in range(2, _IMAGES + 1):
        for place in (rows - image * period, rows + image * period):
            rest += influence(place, x, (edge, across))
    factors, factor = np.zeros(2 * _DIFFERENCES + 1), share
    for k in range(_DIFFERENCES + 1):
        binomials = [(-1) ** (k + step) * math.comb(2 * k, k + step) for step in range(-k, k + 1)]
        factors[_DIFFERENCES - k : _DIFFERENCES + k + 1] += factor * np.array(binomials)
        factor *= (share**2 - (2 * k + 1) ** 2) / (4 * (2 * k + 2) * (2 * k + 3))
    for step, factor in enumerate(factors.tolist(), -_DIFFERENCES):
        rest -= factor * influence(rows, x, ((2 * (_IMAGES + step) + 1) * period, across))
    chebyshev = np.polynomial.chebyshev.chebvander
    series = np.linalg.solve(chebyshev(nodes, _ROWS_BETWEEN - 1), rest)
    out = chebyshev((y - middle) / half, _ROWS_BETWEEN - 1) @ series
    for place in (y - period, y, y + period):
        out += influence(place, x, (edge, across))
    return out


def surface_influence(
    y: Array, x: Array, grid: Grid, effective_modulus: float, free: tuple[bool, bool] = FREE
) -> Array:
    """`rectangle_compliance` of a node of a grid at distances y and x, (ny, nx), with its images."""

    def influence(y: Array, x: Array, edges: tuple[float, float]) -> Array:
        return rectangle_compliance(y[:, None], x, edges, effective_modulus)

    if all(free):
        return influence(y, x, grid.spacing)
    return with_images(influence, y, x, grid, free, (2 / (np.pi * effective_modulus), 0.0))


@compiled
def _span(low: float, high: float, aside: float) -> float:
    """asinh(high / |aside|) − asinh(low / |aside|) for high > |low|, without cancellation."""
    if low <= 0:
        return np.arcsinh(high / abs(aside)) - np.arcsinh(low / abs(aside))
    near, far = np.hypot(low, aside), np.hypot(high, aside)
    return np.log1p((high - low) * (1 + (high + low) / (far + near)) / (low + near))


@compiled
def _part(edge: float, low: float, high: float) -> float:
    """One of the four terms of the displacement; zero in the limit of an edge through the point."""
    return edge * _span(low, high, edge) if edge != 0 else 0.0


@compiled
def _fill_compliance(y: Any, x: Any, half_y: float, half_x: float, out: Any) -> None:
    """∫∫ dξ dη / ρ over the rectangle, at points with y, x ≥ 0; far from it by multipoles, to 1e-13."""
    area, far = 4 * half_y * half_x, (_FAR * max(half_y, half_x)) ** 2
    for i in range(out.size):  # at all points, without a branch: several at a time
        inverse = 1 / (y[i] ** 2 + x[i] ** 2)
        a, b = half_y**2 * inverse, half_x**2 * inverse
        s, t = y[i] ** 2 * inverse, x[i] ** 2 * inverse
        second = (a * (3 * s - 1) + b * (3 * t - 1)) / 6
        along = a**2 * (105 * s**2 - 90 * s + 9) + b**2 * (105 * t**2 - 90 * t + 9)
        fourth = along / 120 + a * b * (105 * s * t - 12) / 36
        out[i] = area * (1 + second + fourth) * np.sqrt(inverse)
    for i in range(out.size):
        if y[i] ** 2 + x[i] ** 2 > far:
            continue
        y1, y2, x1, x2 = y[i] - half_y, y[i] + half_y, x[i] - half_x, x[i] + half_x
        along_x = _part(x2, y1, y2) - _part(x1, y1, y2)
        out[i] = along_x + _part(y2, x1, x2) - _part(y1, x1, x2)


@compiled
def _fill_moments(y: Any, x: Any, half_y: float, half_x: float, out: Any) -> None:
    """∫∫ of η²/ρ³, ξ²/ρ³ and η ξ/ρ³ over the rectangle, at points with y, x ≥ 0."""
    for i in range(y.size):
        y1, y2, x1, x2 = y[i] - half_y, y[i] + half_y, x[i] - half_x, x[i] + half_x
        out[0, i] = _part(x2, y1, y2) - _part(x1, y1, y2)
        out[1, i] = _part(y2, x1, x2) - _part(y1, x1, x2)
        near, far = np.hypot(y1, x1) + np.hypot(y1, x2), np.hypot(y2, x1) + np.hypot(y2, x2)
        out[2, i] = (x2 - x1) * (x2 + x1) * (1 / near - 1 / far)


@compiled
def _fill_slope(y: Any, x: Any, half_y: float, half_x: float, out: Any) -> None:
    """∂/∂x of ∫∫ dξ dη / ρ over the rectangle, at points with y, x ≥ 0."""
    for i in range(out.size):
        y1, y2 = y[i] - half_y, y[i] + half_y
        out[i] = _span(y1, y2, x[i] + half_x) - _span(y1, y2, x[i] - half_x)


@dataclass
class PaddedFourier(Fourier):
    """Transforms of fields that are zero outside their grid, on a grid of at least twice the nodes.

    Along an axis that is not `free` fields repeat, and the grid has no more nodes. The forward transform maps
    (ny, nx) fields to the coefficients on `padded_grid`; the inverse returns the part of its field that lies
    on `grid`. Lines of zeros, and lines of the inverse that are not returned, are
    not transformed: on twice the nodes along both axes a transform costs as much as three of `grid`.
    """

    free: tuple[bool, bool] = FREE

    def __post_init__(self) -> None:
        super().__post_init__()
        self.padded_grid = padded_grid(self.grid, self.free)
        self._work_nodes = (self.grid.shape[0] + self.padded_grid.shape[0]) * self.padded_grid.shape[1] // 2
        ny, nx = self.grid.shape[0], self.padded_grid.shape[1]
        self._rows = np.zeros((ny, nx + _UNUSED_COLUMNS), self.real)[:, :nx]

    def forward(self, values: Array, out: Array | None = None) -> Array:  # type: ignore[override]
        """Coefficients on the padded grid, of its `mode_shape`, of a field on the grid."""
        self.work.nodes += self._work_nodes
        nx = self.grid.shape[1]
        self._rows[:, :nx] = values
        self._rows[:, nx:] = 0
        if out is None:
            out = np.empty(self.padded_grid.mode_shape, self.coefficient_type)
        self.engine.forward(self._rows, out, self.threads)
        return out

    def inverse(  # type: ignore[override]
        self, coefficients: Array, out: Array | None = None, overwrite: bool = False
    ) -> Array:
        """The part on the grid of the field with these coefficients on the padded grid."""
        self.work.nodes += self._work_nodes
        work = coefficients if overwrite else np.empty_like(coefficients)
        self.engine.inverse_along_y(coefficients, work, self.threads)
        self.engine.inverse_along_x(work[: len(self._rows)], self._rows, self.threads)
        if out is None:
            out = np.empty(self.grid.shape, self.real)
        out[:] = self._rows[:, : self.grid.shape[1]]
        return out


def padded_grid(grid: Grid, free: tuple[bool, bool] = FREE) -> Grid:
    """Grid of the same spacing on which distances up to the diagonal of `grid` do not wrap around.

    Along an axis that is not free the map repeats, and the grid is the same.
    """
    ny, nx = (good_size(2 * n - 1) if ends else n for n, ends in zip(grid.shape, free, strict=True))
    edges = zip((ny, nx), grid.spacing, grid.length, free, strict=True)
    length = [nodes * step if ends else edge for nodes, step, edge, ends in edges]
    return Grid((ny, nx), (length[0], length[1]))


def compliance_modes(grid: Grid, effective_modulus: float, free: tuple[bool, bool] = FREE) -> Array:
    """Real factors that turn the padded coefficients of a pressure into coefficients of its displacement.

    Of the `half_shape` of `padded_grid`. The compliance is even in y and in x: on even numbers of nodes the
    factors are the cosine transform of type 1 of a quarter of it, both lines of symmetry included.
    """
    import scipy.fft

    padded = padded_grid(grid, free)
    rows, columns = padded.half_shape
    y, x = (step * np.arange(nodes) for step, nodes in zip(grid.spacing, (rows, columns), strict=True))
    quarter = surface_influence(y, x, grid, effective_modulus, free)
    if all(nodes % 2 == 0 for nodes in padded.shape):
        return scipy.fft.dctn(quarter, type=1, overwrite_x=True)
    row, column = (np.minimum(np.arange(n), n - np.arange(n)) for n in padded.shape)
    return _modes(quarter[row[:, None], column], padded).real[:rows].copy()


def slope_modes(grid: Grid, effective_modulus: float, free: tuple[bool, bool] = FREE) -> tuple[Array, Array]:
    """Factors that turn the padded coefficients of a pressure into coefficients of ∂u/∂y and ∂u/∂x."""
    modulus = effective_modulus
    return (
        _kernel_modes(lambda y, x, edges: rectangle_slope_x(x, y[:, None], edges[::-1], modulus), grid, free),
        _kernel_modes(lambda y, x, edges: rectangle_slope_x(y[:, None], x, edges, modulus), grid, free),
    )


def shear_modes(
    grid: Grid, bodies: Sequence[Solid], degrees: float, free: tuple[bool, bool] = FREE
) -> tuple[Array, Array]:
    """Factors that turn padded coefficients of a shear traction into coefficients of its displacement.

    Parameters
    ----------
    grid : Grid
    bodies : sequence of Solid
        Half-spaces, whose displacements add up.
    degrees : float
        Direction of the traction.

    Returns
    -------
    along, across : (ny, nx // 2 + 1) complex arrays
        Of the displacement in the direction of the traction, and a quarter turn further.
    """
    # Of an infinite line along an axis: the integral along it, and the one across, at the reference.
    at_reference = [(2.0, -2.0), (0.0, 2.0)] if free[1] else [(0.0, 2.0), (2.0, -2.0)]
    yy, xx, yx = (
        _kernel_modes(partial(_moment, n), grid, free, constants)
        for n, constants in enumerate([*at_reference, (0.0, 0.0)])
    )
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    units = [(1 + body.poisson) / (np.pi * body.young) for body in bodies]
    alike = sum(unit * (1 - body.poisson) for unit, body in zip(units, bodies, strict=True))
    turned = sum(unit * body.poisson for unit, body in zip(units, bodies, strict=True))
    along = alike * (yy + xx) + turned * (cosine**2 * xx + sine**2 * yy + 2 * sine * cosine * yx)
    across = turned * (sine * cosine * (yy - xx) + (cosine**2 - sine**2) * yx)
    return along, across


def _moment(number: int, y: Array, x: Array, edges: tuple[float, float]) -> Array:
    return rectangle_moments(y[:, None], x, edges)[number]


def _kernel_modes(
    influence: Influence, grid: Grid, free: tuple[bool, bool], at_reference: tuple[float, float] = (0.0, 0.0)
) -> Array:
    """Factors on the padded grid of a convolution with the influence of a rectangle, as of `with_images`."""
    padded = padded_grid(grid, free)
    y, x = (np.fft.fftfreq(n, 1 / n) * step for n, step in zip(padded.shape, grid.spacing, strict=True))
    if all(free):
        return _modes(influence(y, x, grid.spacing), padded)
    return _modes(with_images(influence, y, x, grid, free, at_reference), padded)


def _modes(kernel: Array, padded: Grid) -> Array:
    """Coefficients of a kernel on a padded grid, as factors of a convolution."""
    modes = Fourier(padded).forward(kernel)
    modes *= padded.size
    return modes
