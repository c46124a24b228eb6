"""Compiled loops over the contact nodes: sums, interpolation from a coarser grid, stencils.

Fields are flattened. `nodes` holds the sorted indices of the contact nodes in the flattened field; arrays of
that size hold one element for each contact node. Sums accumulate in double precision.

A coarse-grid node lies in the middle of four nodes, two in each row and column. A field on them has a margin
of one row or column at each edge.

A stencil is a kernel of short range. The map is taken in strips of rows, which stay in the processor's cache.
The values of a strip and of the rows around it are written to an array with a margin that repeats the map,
mirrors it, or is zero if nothing surrounds the map. The weights of a stencil for odd rows and columns are the
mirror image of the weights for even ones.
"""

import math
from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np
from llvmlite import ir

from asperity.core.compiled import compiled, compiled_with_arrays, inlined, intrinsic, types, vectorised_sums
from asperity.core.parallel import in_parts
from asperity.core.types import Array
from asperity.fourier.grid import Grid

RADIUS, WIDE_RADIUS, WIDER_RADIUS = 3, 15, 31
"""Radii of stencils, in nodes: they reach the nodes with row² + column² ≤ radius (radius + 1).

The numbers in a row of a stencil, with a zero at the end, fill vector registers.
"""

# Numbers in a vector register.
_LANES = 8

# Numbers in a strip with its margin, which are half of a cache of 1 MiB, and its least number of rows.
_STRIP = 2**17
_LEAST_ROWS = 16


def field_of(shape: tuple[int, int], nodes: Array, values: Array, out: Array | None = None) -> Array:
    """Field [y, x] of values on nodes, zero on all others; `out` is an array for it."""
    if out is None:
        out = np.empty(shape, values.dtype)
    _write_field(nodes, values, out.reshape(-1))
    return out


@compiled
def _write_field(nodes: Any, values: Any, out: Any) -> None:
    out[:] = 0
    for k in range(nodes.size):
        out[nodes[k]] = values[k]


@compiled_with_arrays
def inserted(values: Any, at: Any, others: Any) -> Any:
    """Values with others inserted before sorted indices, in a third of the time of `numpy.insert`."""
    out = np.empty(values.size + others.size, values.dtype)
    first = 0
    for k in range(at.size):
        for i in range(first, at[k]):
            out[i + k] = values[i]
        out[at[k] + k] = others[k]
        first = at[k]
    for i in range(first, values.size):
        out[i + at.size] = values[i]
    return out


@vectorised_sums
def added(a: Any) -> float:
    """Σ a."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k])
    return total


@vectorised_sums
def dot(a: Any, b: Any) -> float:
    """Σ a b."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k]) * np.float64(b[k])
    return total


def norm(a: Array) -> float:
    """√(Σ a²), of the same rounding for every number of threads, unlike `numpy.linalg.norm`."""
    return math.sqrt(dot(a, a))


@compiled
def add_multiple(values: Any, others: Any, factor: Any) -> None:
    """Add factor × others to values."""
    for k in range(values.size):
        values[k] += factor * others[k]


@compiled_with_arrays
def row_plus_column(nodes: Any, of_row: Any, of_column: Any) -> Any:
    """For each of some nodes, the sum of the number given for its row and the one given for its column.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    of_row, of_column : (ny,) and (nx,) arrays of the same type

    Returns
    -------
    (count,) array of that type
    """
    out = np.empty(nodes.size, of_row.dtype)
    row, start = np.int64(0), np.int64(0)
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + of_column.size:
            row = node // of_column.size
            start = row * of_column.size
        out[k] = of_row[row] + of_column[node - start]
    return out


def coarse_indices(nodes: Array, shape: tuple[int, int], width: int) -> Array:
    """For each node, 4 × index of a coarse-grid node + 2 × parity of its row + parity of its column.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    shape : (ny, nx)
        Nodes of the map.
    width : int
        Columns of the field on the coarse-grid nodes with its margin. The index, in this flattened field,
        belongs to the coarse-grid node in the row and the column before.
    """
    rows, columns = (np.arange(count, dtype=np.uint32) for count in shape)
    of_row = 4 * ((rows + 1) // 2 * np.uint32(width)) + 2 * (rows % 2)
    return row_plus_column(nodes, of_row, 4 * ((columns + 1) // 2) + columns % 2)


@compiled
def restrict(indices: Any, values: Any, width: int, field: Any) -> None:
    """Write values on nodes to a flattened field on the coarse-grid nodes, by transposed interpolation."""
    field[:] = 0
    for k in range(indices.size):
        index, value = int(indices[k]), values[k]
        i = index >> 2
        below = _weight_after(index >> 1) * value
        above, after = value - below, _weight_after(index)
        field[i] += above - after * above
        field[i + 1] += after * above
        field[i + width] += below - after * below
        field[i + width + 1] += after * below


@compiled
def add_prolongated(field: Any, indices: Any, width: int, out: Any) -> None:
    """Add the interpolant of a flattened field on the coarse-grid nodes to values on nodes."""
    for k in range(indices.size):
        index = int(indices[k])
        i = index >> 2
        down, after = _weight_after(index >> 1), _weight_after(index)
        above = field[i] + after * (field[i + 1] - field[i])
        below = field[i + width] + after * (field[i + width + 1] - field[i + width])
        out[k] += above + down * (below - above)


@inlined
def _weight_after(place: int) -> Any:
    """Weight of the coarse-grid node after a row or column: 3/4 if it is even, else 1/4."""
    return np.float32(0.75) - np.float32(0.5) * np.float32(place & 1)


class StencilProduct:
    """Products of stencils with values on some nodes of a map.

    Parameters
    ----------
    grid : Grid
    free : (bool, bool)
        Whether the map ends along y and along x.
    threads : int
    radius : int
        Radius of the stencils, one of the radii above.
    """

    def __init__(self, grid: Grid, free: tuple[bool, bool], threads: int = 1, radius: int = RADIUS) -> None:
        self._shape, self._threads = grid.shape, threads
        ny, nx = grid.whole_cell.shape
        self._period = 0 if free[0] else ny, 0 if free[1] else nx
        ny, nx = grid.shape
        width = nx + 2 * radius
        self._strip_shape = min(ny, max(_LEAST_ROWS, _STRIP // width)) + 2 * radius, width
        self._strips: list[Array] = []
        self._rows = (np.arange(ny + 1) * nx).astype(np.uint32)
        self._known: tuple[Any, Any] = None, None  # the nodes of the last product, and the first in each row

    def __call__(
        self,
        stencil: Array,
        nodes: Array,
        values: Array,
        at: Array | None = None,
        meanwhile: Callable[[], object] | None = None,
    ) -> Array:
        """Product of a stencil with values on nodes, at these nodes or at others.

        Parameters
        ----------
        stencil : array
            From `whole_stencil`.
        nodes : (count,) array of unsigned integers
            Sorted indices in the flattened map.
        values : (count,) array
        at : array, optional
            Sorted indices of the other nodes.
        meanwhile : callable, optional
            Called without arguments by one of the threads, at the same time.
        """
        others = nodes if at is None else at
        out = np.empty(others.size, np.float32)
        # The first node of each row, and the number of nodes at the end.
        if nodes is not self._known[0]:
            self._known = nodes, np.searchsorted(nodes, self._rows)
        first = self._known[1]
        first_other = first if at is None else np.searchsorted(at, self._rows)

        def apply(part: slice) -> None:
            begin, end = np.searchsorted(first_other[:-1], (part.start, part.stop))
            try:
                strip = self._strips.pop()
            except IndexError:
                # The last row of a stencil reads one number beyond it.
                strip = np.zeros(math.prod(self._strip_shape) + 1, np.float32)[:-1].reshape(self._strip_shape)
            given, asked = (nodes, first, values), (others, first_other, out)
            _apply_in_strips(strip, given, asked, self._shape, self._period, stencil, begin, end)
            self._strips.append(strip)

        in_parts(apply, out.size, self._threads, meanwhile=meanwhile)
        return out


def whole_stencil(weights: Array) -> Array:
    """Weights of a stencil for each parity of row and column, from the weights for even rows and columns.

    Parameters
    ----------
    weights : (2 radius + 1, 2 radius + 1) array
        For an even row and column; for an odd row or column they are mirrored.
    """
    out = np.zeros((4, weights.shape[0], weights.shape[0] + 1), np.float32)
    out[:, :, :-1] = weights, weights[:, ::-1], weights[::-1], weights[::-1, ::-1]
    return out


def _product_of(radius: int) -> Any:
    """Compiled sum over the rows of a stencil of weights × numbers, from the index of the first number.

    Written for the compiler, which does not turn the loops into operations on vectors: with a vector for each
    row a node takes 4 ns instead of 16, and a contact of half the area on 1024² nodes 0.9 s instead of 1.3.
    """
    rows, vectors = 2 * radius + 1, (radius + 1) // (_LANES // 2)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector = ir.VectorType(ir.FloatType(), _LANES)
        numbers, factors = (
            context.make_array(signature.args[of])(context, builder, arguments[of]).data for of in (0, 3)
        )
        number, step = arguments[1], arguments[2]
        factor = builder.mul(arguments[4], ir.Constant(step.type, rows * vectors * _LANES))
        totals: list[Any] = [None] * vectors
        for _ in range(rows):
            for k, total in enumerate(totals):
                offset = ir.Constant(step.type, k * _LANES)
                row, weight = (
                    builder.load(
                        builder.bitcast(builder.gep(data, [builder.add(index, offset)]), vector.as_pointer()),
                        align=4,
                    )
                    for data, index in ((numbers, number), (factors, factor))
                )
                product = builder.fmul(row, weight, flags=("contract",))
                totals[k] = product if total is None else builder.fadd(total, product, flags=("contract",))
            number = builder.add(number, step)
            factor = builder.add(factor, ir.Constant(step.type, vectors * _LANES))
        sum_of_vectors = reduce(builder.fadd, totals)
        half = _LANES // 2
        while half:
            others = [(lane + half) % _LANES for lane in range(_LANES)]
            order = ir.Constant(ir.VectorType(ir.IntType(32), _LANES), others)
            turned = builder.shuffle_vector(sum_of_vectors, sum_of_vectors, order)
            sum_of_vectors = builder.fadd(sum_of_vectors, turned, flags=("contract",))
            half //= 2
        return builder.extract_element(sum_of_vectors, ir.Constant(ir.IntType(32), 0))

    @intrinsic
    def product(typing_context: Any, field: Any, first: Any, width: Any, weights: Any, stencil: Any) -> Any:
        return types.float32(field, types.intp, types.intp, weights, types.intp), generate

    return product


_product, _wide_product, _wider_product = map(_product_of, (RADIUS, WIDE_RADIUS, WIDER_RADIUS))


@compiled
def _apply_in_strips(
    strip: Any,
    given: Any,
    asked: Any,
    shape: tuple[int, int],
    period: tuple[int, int],
    weights: Any,
    begin: int,
    end: int,
) -> None:
    """Product of the stencil with values on nodes, at the other nodes of some rows of the map.

    Parameters
    ----------
    strip : array
        Memory for the values of some rows, of zeros; the loop leaves zeros there.
    given : tuple
        The nodes that bear values, the index of the first one in each row, and the values.
    asked : tuple
        The nodes of the products, the index of the first one in each row, and the products.
    shape, period
        Numbers of nodes of the map, and numbers of nodes after which the values repeat: twice as many if they
        are mirrored, 0 where the map ends.
    weights : array
        The stencil.
    begin, end : int
        The rows.
    """
    (nodes, first, values), (others, first_other, out) = given, asked
    radius = weights.shape[1] // 2
    rows, width = strip.shape[0] - 2 * radius, strip.shape[1]
    flat = strip.reshape(-1)
    for top in range(begin, end, rows):
        bottom = min(top + rows, end)
        if first_other[top] == first_other[bottom]:
            continue
        for line in range(bottom - top + 2 * radius):
            row = _place_of(top + line - radius, shape[0], period[0])
            if row < 0:
                continue
            numbers, start = strip[line], row * shape[1] - radius
            for k in range(first[row], first[row + 1]):
                numbers[np.int64(nodes[k]) - start] = values[k]
            for step in range(radius if period[1] else 0):  # what repeats in the margin
                numbers[radius - 1 - step] = numbers[radius + _place_of(-1 - step, shape[1], period[1])]
                beyond = _place_of(shape[1] + step, shape[1], period[1])
                numbers[radius + shape[1] + step] = numbers[radius + beyond]
        for row in range(top, bottom):
            some = slice(first_other[row], first_other[row + 1])
            start, parity = row * shape[1], 2 * (row % 2)
            _multiply(flat[(row - top) * width :], width, others[some], start, weights, parity, out[some])
        for line in range(bottom - top + 2 * radius):
            row = _place_of(top + line - radius, shape[0], period[0])
            if row >= 0:
                numbers, start = strip[line], row * shape[1] - radius
                for k in range(first[row], first[row + 1]):
                    numbers[np.int64(nodes[k]) - start] = 0
                numbers[:radius] = 0
                numbers[width - radius :] = 0


@compiled
def _place_of(place: int, count: int, period: int) -> int:
    """The row or column of the map that is repeated or mirrored beyond its edges; −1 if nothing is there."""
    if period == 0:
        return place if 0 <= place < count else -1
    place %= period
    return place if place < count else period - 1 - place


@compiled
def _multiply(field: Any, width: int, nodes: Any, start: int, weights: Any, parity: int, out: Any) -> None:
    """Product of the stencil with the strip from a radius above nodes of one row of the map."""
    for k in range(nodes.size):
        column = np.int64(nodes[k]) - start
        if weights.shape[1] == 2 * RADIUS + 1:
            out[k] = _product(field, column, width, weights, parity + column % 2)
        elif weights.shape[1] == 2 * WIDE_RADIUS + 1:  # the four stencils are equal
            out[k] = _wide_product(field, column, width, weights, 0)
        else:
            out[k] = _wider_product(field, column, width, weights, 0)
