"""Compiled formulas of the fields of a plane, from the basis fields A and B of its stress components.

The stress is A + ν B with fields A and B that do not depend on Poisson's ratio ν. Fields are computed for
rows of a plane, or at nodes, on the grid of the plane or another one of the same cell. All use one formula
in one order of operations, so that the results have the same bits, in the precision of the plane.

Principal stresses
------------------
They are in closed form. The deviator is divided by its largest element. Its eigenvalue λ farthest from the
two others comes from the trigonometric solution of the cubic (O. K. Smith, Commun. ACM 4 (1961) 168, DOI
10.1145/355578.366316), which is accurate for this one only: the two others may be close together, and there
the arc cosine loses half of the digits. Their mean is −λ/2, and half of their difference follows from the
part of the tensor in the plane across the first principal direction n, less its mean. With the deviator S,
n nᵀ is the adjugate of S − λ I over its trace, which has no small divisor because λ is far from the others.
All three are accurate to rounding of the maximum stress.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from asperity.core.compiled import compiled, inlined
from asperity.core.parallel import in_parts
from asperity.core.types import FIELDS as FIELDS
from asperity.core.types import Array
from asperity.elasticity.solid import COMPONENTS
from asperity.fourier.grid import BOUNDARIES, EVEN, Grid

MEASURES = ("von_mises", "maximum_shear", "principal_1", "principal_2", "principal_3")
"""Names of the fields that need all six components of the stress."""

# Places in `FIELDS`, which are their numbers in the compiled functions; the components have the same places
# in `BASIS`, for their fields A.
_XX, _YY, _ZZ, _YZ, _XZ, _XY = range(6)
_VON_MISES, _LARGEST_SHEAR, _PRINCIPAL_1, _PRINCIPAL_2, _PRINCIPAL_3, _HYDROSTATIC = range(6, 12)

# Places in `BASIS` of the fields B.
_SLOPE_XX, _SLOPE_YY, _SLOPE_XY = 6, 7, 8


ODD = {"yz": (True, False), "xz": (False, True), "xy": (True, True)}
"""Shear stress of a mirrored map → whether it is odd along y and along x; the other fields are even."""

PERIODIC, FREE, MIRRORED = range(3)
"""Neighbour of an outermost node beyond the edge: the node at the opposite edge; over a free boundary, where
there is none, the neighbour on the other side; on a mirrored map the node itself, with the other sign if the
field is odd."""

Visit = Callable[[int, int, int], None]
"""Called with a band, see `bands_of`, and the first row and last row + 1 of the computed rows."""


class BasisField(NamedTuple):
    """A linear combination `constant` × A + `slope` × B of the basis fields of one component."""

    component: str
    constant: float
    slope: float


BASIS = (*((name, "constant") for name in COMPONENTS), ("xx", "slope"), ("yy", "slope"), ("xy", "slope"))
"""Components of A and of B for which `Basis.index` has an entry."""

ROW_MARGIN = 16
"""Numbers before the first node of a row of fields; the last of them is the neighbour beyond the edge."""

BANDS = 8
"""Most bands of a plane."""

ROWS_OF_BAND = 64
"""Fewest rows of a band, if there are several."""

NODES_AT_ONCE = 2**15
"""Nodes of rows that are transformed, searched and summed while they are in the cache."""

COMPARED_AT_ONCE = 2**16
"""Maxima that are compared with a plane together: the values around them take memory."""

SMALLEST_DEVIATOR = 1e-300
"""Principal stresses of a tensor whose deviator has only smaller elements are its mean."""

BLOCK = 512
"""Nodes for which the values that all von Mises stresses share fit into the processor's cache."""

SUMS = 4
"""Numbers of each row in `sum_row`."""

LANES = 64
"""Numbers that are added side by side in `sum_row`."""

PACKED = {"float32": np.int16, "float64": np.int32}
"""Types of the whole numbers in which planes are kept. Rounding, by 2e-5 or 2e-10 of the largest value, is
averaged over all nodes: the error of a covariance is below 1e-6 or 1e-11 of it (1e-5 or 1e-10 on 16² nodes).
"""


class Basis(NamedTuple):
    """Basis fields of the stress in a plane.

    Parameters
    ----------
    values : (fields, ny, at least `columns`) array
    columns : int
        Nodes of a row.
    index : (9,) integer array
        Index in `values` of each entry of `BASIS`; −1 for a field that is not needed, and for B_yy, which is
        computed from A_xx + A_yy + A_zz = B_xx + B_yy, true for all but the mean mode. For a single
        Poisson's ratio A is the stress itself and ν is 0 in the formulas, so that B is multiplied by 0: its
        entries have the indices of A.
    mean_pressure : float
        Minus the uniform part of A_zz, in the precision of `values`.
    """

    values: Any
    columns: int
    index: Any
    mean_pressure: Any


class Formulas(NamedTuple):
    """Fields to compute from basis fields.

    Parameters
    ----------
    kinds : integer array
        Places of the names in `FIELDS`; all von Mises stresses stand first.
    ratios : array in the precision of the plane
        Poisson's ratios; 0 where A is the stress itself.
    uniforms : array in the precision of the plane
        Uniform parts of σ_xx and σ_yy.
    """

    kinds: Any
    ratios: Any
    uniforms: Any


@dataclass(frozen=True)
class PlaneFields:
    """Fields of a plane, computed from its basis fields where they are asked for.

    Parameters
    ----------
    basis : Basis
    formulas : Formulas
    edges : (int, int)
        `PERIODIC`, `FREE` or `MIRRORED` along y and along x.
    """

    basis: Basis
    formulas: Formulas
    edges: tuple[int, int]

    @classmethod
    def of_array(cls, values: Array, edges: tuple[int, int], name: str = "zz") -> PlaneFields:
        """A plane of one given field, (ny, nx), which takes the place of σ_zz, or of an odd component."""
        real = values.dtype.type
        basis = Basis(np.ascontiguousarray(values)[None], values.shape[1], np.zeros(len(BASIS), int), real(0))
        nothing = np.zeros(1, real)
        kind = FIELDS.index(name if name in ODD else "zz")
        return cls(basis, Formulas(np.array([kind]), nothing, nothing), edges)

    def rows(self, first: int, last: int) -> Array:
        """Fields in consecutive rows with their neighbours beyond the edges.

        Parameters
        ----------
        first, last : int
            First row and last row + 1, which may be beyond an edge.

        Returns
        -------
        (fields, last − first, at least `ROW_MARGIN` + nx + 1) array
            Node i of a row has the index `ROW_MARGIN` + i.
        """
        shape = self.formulas.kinds.size, last - first, row_length(self.basis.columns)
        out = np.empty(shape, self.basis.values.dtype)
        shared = np.empty((5, BLOCK), out.dtype)
        fill_rows(self.basis, self.formulas, first, self.edges, shared, out, 0, last - first)
        return out

    def whole(self) -> Array:
        """Fields in the whole plane, (fields, ny, nx)."""
        return self.rows(0, self.basis.values.shape[1])[:, :, ROW_MARGIN : ROW_MARGIN + self.basis.columns]

    def at(self, row: Array, column: Array) -> Array:
        """Values of the first field at some nodes of the plane, (nodes,)."""
        out = np.empty(row.size, self.basis.values.dtype)
        kind, ratio, uniform = (each[0] for each in self.formulas)
        _take_nodes(self.basis, kind, ratio, uniform, row, column, out)
        return out

    def exceeded(
        self, which: Array, row: Array, column: Array, shape: tuple[int, int], magnitude: Array, threads: int
    ) -> tuple[Array, Array]:
        """Nodes where a magnitude is above the nine values at and around a node, and these values.

        On another grid than the plane's, the basis fields are interpolated in double precision by Lagrange's
        formula on the six nearest nodes along each axis.

        Parameters
        ----------
        which, row, column : (nodes,) integer arrays
            One of the fields, and a node of a grid of the same cell.
        shape : (rows, columns)
            Of this grid.
        magnitude : (nodes,) array in the precision of the plane
        threads : int

        Returns
        -------
        kept : (kept nodes,) integer array
            Indices of these nodes.
        values : (kept nodes, 3, 3) array in the precision of the plane
        """
        own, real = (self.basis.values.shape[1], self.basis.columns), self.basis.values.dtype
        if not which.size:
            return np.empty(0, np.int64), np.empty((0, 3, 3), real)
        kept = np.empty(which.size, bool)
        interpolation: tuple[Any, ...] = ()
        if shape != own:
            index = np.where(self.basis.index < 0, -1, np.arange(len(BASIS)))
            at_node = Basis(np.empty((len(BASIS), 1, 1)), 1, index, float(self.basis.mean_pressure))
            formulas = Formulas(self.formulas.kinds, *(each.astype(float) for each in self.formulas[1:]))
            needed = np.array([_needed(int(kind), self.basis.index) for kind in self.formulas.kinds])
            stencils = tuple(lagrange_stencils(*each) for each in zip(shape, own, self.edges, strict=True))
            odd = np.array([ODD.get(component, EVEN) for component, _ in BASIS]).astype(np.int64)
            interpolation = at_node, formulas, needed, stencils, odd
        values = [np.empty((0, 3, 3), real)]
        for start in range(0, which.size, COMPARED_AT_ONCE):
            some = slice(start, start + COMPARED_AT_ONCE)
            nodes = which[some], row[some], column[some], magnitude[some]
            above, out = kept[some], np.empty((kept[some].size, 3, 3), real)

            def compare(part: slice) -> Array:
                own_nodes, around = tuple(each[part] for each in nodes), out[part]  # noqa: B023
                if not interpolation:
                    plane = self.basis, self.formulas, self.edges
                    return around[: _compare(plane, own_nodes, above[part], around)]  # noqa: B023
                at_node = interpolation[0]._replace(values=np.empty_like(interpolation[0].values))
                known = (at_node, *interpolation[1:])
                return around[: _compare_between(self.basis, known, own_nodes, above[part], around)]  # noqa: B023

            values.append(np.concatenate(in_parts(compare, above.size, threads, smallest=256)))
        return np.flatnonzero(kept), np.concatenate(values)


def _needed(kind: int, index: Array) -> Array:
    """True for every entry of `BASIS` on which a field depends."""
    needed = np.zeros(len(BASIS), bool)
    if kind < _VON_MISES and (kind != _YY or index[_SLOPE_YY] >= 0):
        slope = {_XX: _SLOPE_XX, _YY: _SLOPE_YY, _XY: _SLOPE_XY}.get(kind, kind)
        needed[[kind, slope]] = True
        return needed
    return index >= 0


def row_length(columns: int) -> int:
    """Numbers in a row of fields with its margins."""
    return -(-(ROW_MARGIN + columns + 1) // ROW_MARGIN) * ROW_MARGIN


def bands_of(rows: int) -> list[tuple[int, int]]:
    """First row and last row + 1 of bands of a plane; a thread goes through a band from row to row."""
    count = min(BANDS, max(1, rows // ROWS_OF_BAND))
    edges = [rows * number // count for number in range(count + 1)]
    return list(pairwise(edges))


def rows_at_once(columns: int) -> int:
    """Most rows of a band that are transformed, searched and summed together."""
    return max(4, NODES_AT_ONCE // columns)


def strips_of(band: tuple[int, int], columns: int) -> list[tuple[int, int]]:
    """First row and last row + 1 of the strips of a band that are searched one after the other."""
    rows = rows_at_once(columns)
    return [(first, min(first + rows, band[1])) for first in range(*band, rows)]


def edges_of(boundary: str, grid: Grid) -> tuple[int, int]:
    """`PERIODIC`, `FREE` or `MIRRORED` along y and along x for the boundary of a contact and its grid."""
    along_y, along_x = (
        FREE if ends else MIRRORED if images == 2 else PERIODIC
        for ends, images in zip(BOUNDARIES[boundary], grid.images, strict=True)
    )
    return along_y, along_x


@inlined
def neighbour(node: int, nodes: int, edges: int) -> int:
    """Index of a node at most two beyond the edges: at the opposite edge, or its mirror image."""
    if 0 <= node < nodes:
        return node
    if edges == PERIODIC:
        return node % nodes
    repeated = edges - FREE  # 1 if the outermost node is its own image
    return -node - repeated if node < 0 else 2 * nodes - 2 + repeated - node


@inlined
def image_sign(kind: int, row: int, column: int, shape: Any, edges: Any) -> int:
    """A field at a node over its value at the `neighbour`: −1 at the image of a node of an odd field."""
    sign = 1
    if edges[0] == MIRRORED and not 0 <= row < shape[0] and kind in (_YZ, _XY):
        sign = -sign
    if edges[1] == MIRRORED and not 0 <= column < shape[1] and kind in (_XZ, _XY):
        sign = -sign
    return sign


@compiled
def principal_stresses(
    xx: float, yy: float, zz: float, yz: float, xz: float, xy: float
) -> tuple[float, float, float]:
    """Principal stresses σ1 ≥ σ2 ≥ σ3 of a symmetric tensor."""
    mean = (xx + yy + zz) / 3.0
    a, b, c = xx - mean, yy - mean, zz - mean
    scale = max(abs(a), abs(b), abs(c), abs(yz), abs(xz), abs(xy))
    if scale < SMALLEST_DEVIATOR:
        return mean, mean, mean
    per = 1.0 / scale
    a, b, c, f, g, h = a * per, b * per, c * per, yz * per, xz * per, xy * per
    # Where the three normal stresses are equal, rounding of the mean would leave a false deviator.
    rest = (a + b + c) / 3.0
    mean += scale * rest
    a, b, c = a - rest, b - rest, c - rest
    radius = np.sqrt((a * a + b * b + c * c + 2.0 * (f * f + g * g + h * h)) / 6.0)
    if radius < 1e-15:
        return mean, mean, mean
    determinant = a * (b * c - f * f) - h * (h * c - f * g) + g * (h * f - b * g)
    cosine = min(1.0, abs(determinant) / (2.0 * radius * radius * radius))
    apart = 2.0 * radius * np.cos(np.arccos(cosine) / 3.0)
    if determinant < 0.0:
        apart = -apart
    middle, x, y, z = -0.5 * apart, a - apart, b - apart, c - apart
    # The adjugate of the deviator less `apart`, whose trace is the product of its two other eigenvalues.
    aa, bb, cc = y * z - f * f, x * z - g * g, x * y - h * h
    ff, gg, hh = g * h - f * x, f * h - g * y, f * g - h * z
    per_trace = 1.5 * apart / (aa + bb + cc)
    a, b, c = a - middle - per_trace * aa, b - middle - per_trace * bb, c - middle - per_trace * cc
    f, g, h = f - per_trace * ff, g - per_trace * gg, h - per_trace * hh
    half = np.sqrt(0.5 * (a * a + b * b + c * c) + f * f + g * g + h * h)
    upper, lower = middle + half, middle - half
    if determinant < 0.0:
        return mean + scale * max(upper, apart), mean + scale * lower, mean + scale * min(lower, apart)
    return mean + scale * max(upper, apart), mean + scale * upper, mean + scale * min(lower, apart)


@inlined
def _von_mises(first: float, second: float, xy: float, across: float) -> float:
    """The von Mises stress from σ_xx − σ_yy, σ_yy − σ_zz, σ_xy and σ_yz² + σ_xz²."""
    shear = xy * xy + across
    # The factor is in single precision, so that a product in single precision stays so.
    return np.sqrt(first * (first + second) + second * second + np.float32(3) * shear)


@compiled
def _measure(kind: int, x: float, y: float, z: float, yz: float, xz: float, xy: float) -> float:
    """The maximum shear stress or a principal stress."""
    first, second, third = principal_stresses(float(x), float(y), float(z), float(yz), float(xz), float(xy))
    if kind == _LARGEST_SHEAR:
        return 0.5 * (first - third)
    if kind == _PRINCIPAL_1:
        return first
    return second if kind == _PRINCIPAL_2 else third


@inlined
def value_at(basis: Any, kind: int, ratio: Any, uniform: Any, row: Any, column: Any) -> float:
    """A field at one node."""
    values, _, index, mean = basis
    if kind < _VON_MISES and (kind != _YY or index[_SLOPE_YY] >= 0):
        value = values[index[kind], row, column]
        if kind in (_ZZ, _YZ, _XZ):
            return value
        slope = values[index[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind], row, column]
        return value + ratio * slope + (uniform - uniform if kind == _XY else uniform)
    xx = values[index[_XX], row, column]
    yy = values[index[_YY], row, column]
    zz = values[index[_ZZ], row, column]
    trace = xx + yy + zz
    if kind == _HYDROSTATIC:
        # The trace of B is the trace of A without its uniform part.
        return (trace + ratio * (trace + mean) + uniform + uniform) / 3.0
    slope = values[index[_SLOPE_XX], row, column]
    slope_yy = trace + mean - slope
    y = yy + ratio * slope_yy + uniform
    if kind == _YY:
        return y
    x = xx + ratio * slope + uniform
    xy = values[index[_XY], row, column] + ratio * values[index[_SLOPE_XY], row, column]
    yz, xz = values[index[_YZ], row, column], values[index[_XZ], row, column]
    if kind == _VON_MISES:
        first, second = xx - yy + ratio * (slope - slope_yy), yy - zz + ratio * slope_yy + uniform
        return _von_mises(first, second, xy, yz * yz + xz * xz)
    return _measure(kind, x, y, zz, yz, xz, xy)


@compiled
def _fill_row(basis: Any, kind: int, ratio: Any, uniform: Any, row: int, out: Any) -> None:
    """Fill `out`, (nx,), with one row of a field other than the von Mises stress."""
    values, _, index, _ = basis
    if kind < _VON_MISES and (kind != _YY or index[_SLOPE_YY] >= 0):
        constant = values[index[kind], row]
        if kind in (_ZZ, _YZ, _XZ):
            for i in range(out.size):
                out[i] = constant[i]
            return
        slope = values[index[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind], row]
        added = uniform - uniform if kind == _XY else uniform
        for i in range(out.size):
            out[i] = constant[i] + ratio * slope[i] + added
        return
    for i in range(out.size):
        out[i] = value_at(basis, kind, ratio, uniform, row, i)


@compiled
def _fill_von_mises(basis: Any, fields: Any, row: int, shared: Any, out: Any, line: int) -> None:
    """Fill one line of all von Mises stresses, the first of the fields, with a row.

    Their common parts are computed once, in the array `shared`, (5, `BLOCK`). Loops that read and write few
    arrays are turned into operations on vectors, one long loop is not.
    """
    values, columns, index, mean = basis
    first, second, slope_yy, across, slope_first = shared[0], shared[1], shared[2], shared[3], shared[4]
    for start in range(0, columns, BLOCK):
        stop = min(start + BLOCK, columns)
        xx, yy = values[index[_XX], row, start:stop], values[index[_YY], row, start:stop]
        zz, yz = values[index[_ZZ], row, start:stop], values[index[_YZ], row, start:stop]
        xz, xy = values[index[_XZ], row, start:stop], values[index[_XY], row, start:stop]
        slope, slope_xy = (
            values[index[_SLOPE_XX], row, start:stop],
            values[index[_SLOPE_XY], row, start:stop],
        )
        for i in range(xx.size):
            slope_yy[i] = xx[i] + yy[i] + zz[i] + mean - slope[i]
        for i in range(xx.size):
            slope_first[i] = slope[i] - slope_yy[i]
        for i in range(xx.size):
            first[i] = xx[i] - yy[i]
        for i in range(xx.size):
            second[i] = yy[i] - zz[i]
        for i in range(xx.size):
            across[i] = yz[i] * yz[i] + xz[i] * xz[i]
        for m in range(fields.kinds.size):
            if fields.kinds[m] != _VON_MISES:
                break
            ratio, uniform = fields.ratios[m], fields.uniforms[m]
            field = out[m, line, ROW_MARGIN + start : ROW_MARGIN + stop]
            for i in range(field.size):
                field[i] = _von_mises(
                    first[i] + ratio * slope_first[i],
                    second[i] + ratio * slope_yy[i] + uniform,
                    xy[i] + ratio * slope_xy[i],
                    across[i],
                )


@compiled
def fill_rows(
    basis: Any, fields: Any, first: int, edges: Any, shared: Any, out: Any, start: int, stop: int
) -> None:
    """Fill the lines from `start` to `stop` − 1 of `out` with rows from `first` on, see `PlaneFields.rows`.

    `shared` is an array (5, `BLOCK`) in the precision of the plane.
    """
    ny, nx = basis.values.shape[1], basis.columns
    for line in range(start, stop):
        row = neighbour(first + line - start, ny, edges[0])
        if fields.kinds[0] == _VON_MISES:
            _fill_von_mises(basis, fields, row, shared, out, line)
        for m in range(fields.kinds.size):
            here = out[m, line, ROW_MARGIN : ROW_MARGIN + nx]
            if fields.kinds[m] != _VON_MISES:
                _fill_row(basis, fields.kinds[m], fields.ratios[m], fields.uniforms[m], row, here)
            kind, node = fields.kinds[m], first + line - start
            if image_sign(kind, node, 0, (ny, nx), edges) < 0:
                for i in range(nx):
                    here[i] = -here[i]
            sign = image_sign(kind, 0, -1, (ny, nx), edges)
            out[m, line, ROW_MARGIN - 1] = sign * here[neighbour(-1, nx, edges[1])]
            out[m, line, ROW_MARGIN + nx] = sign * here[neighbour(nx, nx, edges[1])]


@compiled
def sum_row(line: Any, references: Any, m: int, row: int, largest: Any, lanes: Any, out: Any) -> None:
    """Sum one row of a field: the sum, the sum of squares, and the sum of products with a reference.

    Numbers are added by lanes, as operations on vectors do it: the order of additions, and so the rounding,
    does not depend on the compiler's choices, nor on the process that compiled the loop.

    Parameters
    ----------
    line : (columns,) array
    references : (fields, ny, columns) array
        Products are summed where the field `m` has a reference.
    m, row : int
    largest : (`LANES`,) array in the precision of the field
        The largest values so far.
    lanes : (3, `LANES`) array in the precision of the field
        Working space.
    out : (`SUMS`,) array
        The sums become its numbers 0, 1 and 3.
    """
    part, squares, products = lanes[0], lanes[1], lanes[2]
    for i in range(LANES):
        part[i] = squares[i] = products[i] = 0
    for begin in range(0, line.size, LANES):
        some = line[begin : begin + LANES]
        for i in range(some.size):
            value = some[i]
            part[i] += value
            squares[i] += value * value
            largest[i] = value if value > largest[i] else largest[i]
        if m < references.shape[0]:
            other = references[m, row, begin : begin + LANES]
            for i in range(some.size):
                products[i] += some[i] * some.dtype.type(other[i])
    total = square = product = 0.0
    for i in range(LANES):
        total += part[i]
        square += squares[i]
        product += products[i]
    out[0], out[1], out[3] = total, square, product


@compiled
def _take_nodes(basis: Any, kind: int, ratio: Any, uniform: Any, row: Any, column: Any, out: Any) -> None:
    for n in range(out.size):
        out[n] = value_at(basis, kind, ratio, uniform, row[n], column[n])


@inlined
def exceeds_around(
    basis: Any, formula: Any, row: int, column: int, edges: Any, magnitude: float, out: Any
) -> bool:
    """True if a magnitude is above the nine values at and around a node, which are written to `out`."""
    kind, ratio, uniform = formula
    shape, is_above = (basis.values.shape[1], basis.columns), True
    for a in range(3):
        for b in range(3):
            j, i = row - 1 + a, column - 1 + b
            sign = image_sign(kind, j, i, shape, edges)
            j, i = neighbour(j, shape[0], edges[0]), neighbour(i, shape[1], edges[1])
            value = sign * value_at(basis, kind, ratio, uniform, j, i)
            out[a, b] = value
            is_above &= magnitude > abs(value)
    return is_above


@compiled
def _compare(plane: Any, nodes: Any, kept: Any, out: Any) -> int:
    """As `PlaneFields.exceeded` at nodes of the plane; their number, whose values begin `out`."""
    (basis, (kinds, ratios, uniforms), edges), (which, row, column, magnitude) = plane, nodes
    for n in range(which.size):  # without branches, the values of many nodes are fetched at the same time
        m = which[n]
        kept[n] = magnitude[n] > abs(value_at(basis, kinds[m], ratios[m], uniforms[m], row[n], column[n]))
    count = 0
    for n in range(which.size):
        if kept[n]:
            formula = kinds[which[n]], ratios[which[n]], uniforms[which[n]]
            kept[n] = exceeds_around(basis, formula, row[n], column[n], edges, magnitude[n], out[count])
            count += kept[n]
    return count


_FROM_CENTRE = ((0, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, -1), (-1, 1))
"""A node and those around it: most maxima end at the node itself."""


@compiled
def _compare_between(basis: Any, interpolation: Any, nodes: Any, kept: Any, out: Any) -> int:
    """As `PlaneFields.exceeded` at nodes of another grid; their number, whose values begin `out`.

    `interpolation` holds basis fields at one node, in which those that a field needs are written, the
    formulas, the fields that each needs, stencils along y and x, and whether a basis field is odd.
    """
    at_node, (kinds, ratios, uniforms), needed, stencils, odd = interpolation
    (which, row, column, magnitude), ((place_y, weights_y), (place_x, weights_x)) = nodes, stencils
    count, zero = 0, np.int64(0)
    for n in range(which.size):
        m, is_above = which[n], True
        for k in range(9):
            a, b = _FROM_CENTRE[k]
            j, i = row[n] + a + 1, column[n] + b + 1
            for part in range(at_node.index.size):
                if needed[m, part]:
                    along_y = place_y[j], weights_y[odd[part, 0]][j]
                    along_x = place_x[i], weights_x[odd[part, 1]][i]
                    values = basis.values[basis.index[part]]
                    at_node.values[part, 0, 0] = lagrange(values, along_y, along_x)
            found = value_at(at_node, kinds[m], ratios[m], uniforms[m], zero, zero)
            value = basis.values.dtype.type(found)
            out[count, a + 1, b + 1] = value
            is_above &= magnitude[n] > abs(value)
            if not is_above:
                break
        kept[n] = is_above
        count += is_above
    return count


@inlined
def lagrange(values: Any, along_y: Any, along_x: Any) -> float:
    """Lagrange's formula from the values at the places of a stencil along each axis."""
    place, weight = along_x
    a, b, c, d, e, f = place[0], place[1], place[2], place[3], place[4], place[5]
    u, v, w, x, y, z = weight[0], weight[1], weight[2], weight[3], weight[4], weight[5]
    total = 0.0
    for k in range(6):
        line = values[along_y[0][k]]
        along = (u * line[a] + v * line[b]) + (w * line[c] + x * line[d]) + (y * line[e] + z * line[f])
        total += along_y[1][k] * along
    return total


def lagrange_weights(places: Array, at: Array) -> Array:
    """Weights of the values at places, (..., nodes), in the polynomial through them at positions, (...)."""
    own = np.eye(places.shape[-1], dtype=bool)
    apart = np.where(own, 1.0, places[..., None] - places[..., None, :])
    return np.prod(np.where(own, 1.0, at[..., None, None] - places[..., None, :]) / apart, axis=-1)


_INVERSE_PRODUCTS = np.array([1 / np.prod([k - m for m in range(6) if m != k]) for k in range(6)])
"""Denominators of Lagrange's formula on six nodes."""


@lru_cache(maxsize=256)
def lagrange_stencils(others: int, nodes: int, edges: int) -> tuple[Array, Array]:
    """Places and weights of the six nodes nearest to nodes −1 to `others` of another grid.

    Over a free boundary a node beyond an edge is its mirror image, and all six lie within the map. Of a
    mirrored map the first nodes of both grids are half a spacing from the mirror line.

    Returns
    -------
    places : (others + 2, 6) integer array
    weights : (2, others + 2, 6) array
        Of fields that are even and odd about the mirror lines.
    """
    node = np.arange(-1, others + 1)
    if edges == FREE:
        node[[0, -1]] = 1, others - 2
    first = 0.5 if edges == MIRRORED else 0.0
    position = (node + first) * (nodes / others) - first
    base = np.floor(position).astype(np.int64)
    if edges == FREE:
        base = np.clip(base, 2, nodes - 4)
    steps = np.arange(-2, 4)
    apart = (position - base)[:, None] - steps
    weights = np.prod(np.where(np.eye(6, dtype=bool), 1.0, apart[:, None]), axis=2)
    place = base[:, None] + steps
    weights *= _INVERSE_PRODUCTS
    if edges != MIRRORED:
        return place % nodes, np.stack([weights, weights])
    place %= 2 * nodes
    of_odd = np.where(place < nodes, weights, -weights)
    return np.minimum(place, 2 * nodes - 1 - place), np.stack([weights, of_odd])
