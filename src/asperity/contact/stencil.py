"""Stencils applied to values on the contact nodes: the product with a kernel of short range.

Values are spread on an array with a margin that repeats the map, or is zero if nothing surrounds the map. In
each row of it the even columns come before the odd ones, so that a stencil whose weights differ between even
and odd columns is applied to many columns of each kind at once. The columns are divided into blocks, and only blocks
that hold a contact node are visited.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from asperity.spectral import Grid
from asperity.types import Array

RADIUS = 3
"""Radius of the stencils, in nodes: they reach the nodes with row² + column² ≤ RADIUS (RADIUS + 1)."""

# Width of the margin: even, so that a node has the same parity in the map and in the array with the margin.
_MARGIN = 4

# Even columns of a block, and odd ones. Smaller blocks hold fewer nodes without contact, but a row of blocks is
# faster the longer it is.
_LANES = 32


class StencilField:
    """Values on contact nodes, spread on an array with a margin, to which stencils are applied.

    Parameters
    ----------
    grid : Grid
    repeats : bool
        True if nodes at opposite edges of the map are neighbours.
    """

    def __init__(self, grid: Grid, repeats: bool) -> None:
        ny, nx = grid.shape
        self._shape = grid.shape
        self._repeats = repeats
        self._blocks_per_row = -(-nx // (2 * _LANES))
        half = self._blocks_per_row * _LANES + _MARGIN
        self._field = np.zeros((ny + 2 * _MARGIN, 2, half), np.float32)
        self._sums = np.empty((2, half), np.float32)
        self._products_of_blocks = np.empty((0, 2, _LANES), np.float32)
        self.restrict(np.empty(0, np.uint32))

    def restrict(self, nodes: Array) -> None:
        """Choose the nodes that bear values, by their sorted indices in the flattened map."""
        self._field.fill(0)
        self._position = _positions(nodes, self._shape[1], self._field.shape[2])
        self._blocks, self._slot = _blocks_of(nodes, self._shape[1], self._blocks_per_row)

    def apply(self, stencil: Array, values: Array, out: Array) -> None:
        """Write the products of a stencil with values on the nodes, at the nodes.

        Parameters
        ----------
        stencil : (2, 2, 2 RADIUS + 1, 2 RADIUS + 1) array
            Weights [parity of the row, parity of the column, row, column] around the node of the product.
        values, out : (count,) arrays
        """
        self.spread(values)
        _gather(self._products(stencil, self._blocks), self._slot, out)

    def apply_at(self, stencil: Array, nodes: Array) -> Array:
        """Products of a stencil with the values spread last, at other nodes."""
        blocks, slot = _blocks_of(nodes, self._shape[1], self._blocks_per_row)
        out = np.empty(nodes.size, np.float32)
        _gather(self._products(stencil, blocks), slot, out)
        return out

    def spread(self, values: Array) -> None:
        """Spread values on the nodes."""
        _scatter(self._field.reshape(-1), self._position, values)
        if self._repeats:
            _fill_margin(self._field, *self._shape)

    def restrict_to_even_nodes(self, out: Array) -> None:
        """Add the values spread last to the coarse grid of the even nodes, by transposed linear interpolation.

        `out` has a row and a column more than there are even rows and columns. They take what lies beyond the
        last even node.
        """
        _restrict(self._field, self._blocks, self._blocks_per_row, out)

    def _products(self, stencil: Array, blocks: Array) -> Array:
        if self._products_of_blocks.shape[0] < blocks.size:
            # Memory that is used again takes half the time of fresh memory.
            self._products_of_blocks = np.empty((blocks.size + blocks.size // 4, 2, _LANES), np.float32)
        products = self._products_of_blocks
        _apply(self._field, blocks, self._blocks_per_row, stencil, self._sums, products)
        return products.reshape(-1)


@njit(cache=True, nogil=True, error_model="numpy")
def _positions(nodes: Any, nx: int, half: int) -> Any:
    """Indices of nodes in the flattened array with the margin."""
    out = np.empty(nodes.size, np.uint32)
    row, start = 0, 0
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + nx:
            row = node // nx
            start = row * nx
        column = node - start + _MARGIN
        out[k] = ((row + _MARGIN) * 2 + (column & 1)) * half + (column >> 1)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _blocks_of(nodes: Any, nx: int, blocks_per_row: int) -> tuple[Any, Any]:
    """Blocks that hold the nodes, and the indices of the nodes in an array [block, parity, lane]."""
    blocks = np.empty(nodes.size, np.uint32)
    slot = np.empty(nodes.size, np.uint32)
    count, last = 0, -1
    row, start = 0, 0
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + nx:
            row = node // nx
            start = row * nx
        column = node - start
        block = row * blocks_per_row + column // (2 * _LANES)
        if block != last:
            blocks[count] = block
            count += 1
            last = block
        within = column & (2 * _LANES - 1)
        slot[k] = ((count - 1) * 2 + (within & 1)) * _LANES + (within >> 1)
    return blocks[:count].copy(), slot


@njit(cache=True, nogil=True, error_model="numpy")
def _scatter(field: Any, position: Any, values: Any) -> None:
    for k in range(position.size):
        field[position[k]] = values[k]


@njit(cache=True, nogil=True, error_model="numpy")
def _gather(field: Any, position: Any, out: Any) -> None:
    for k in range(position.size):
        out[k] = field[position[k]]


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_margin(field: Any, ny: int, nx: int) -> None:
    """Repeat the map periodically in the margin."""
    for i in range(_MARGIN, _MARGIN + ny):
        for step in range(1, RADIUS + 1):
            to, source = _MARGIN - step, _MARGIN + (nx - step) % nx
            field[i, to & 1, to >> 1] = field[i, source & 1, source >> 1]
            to, source = _MARGIN + nx + step - 1, _MARGIN + (step - 1) % nx
            field[i, to & 1, to >> 1] = field[i, source & 1, source >> 1]
    for step in range(1, RADIUS + 1):
        field[_MARGIN - step] = field[_MARGIN + (ny - step) % ny]
        field[_MARGIN + ny + step - 1] = field[_MARGIN + (step - 1) % ny]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _apply(field: Any, blocks: Any, blocks_per_row: int, stencil: Any, sums: Any, out: Any) -> None:
    """Products of the stencil with the field, in blocks; neighbouring blocks of a row together."""
    start = 0
    while start < blocks.size:
        row = np.int64(blocks[start]) // blocks_per_row
        stop = start + 1
        last_of_row = (row + 1) * blocks_per_row
        while stop < blocks.size and blocks[stop] == blocks[stop - 1] + 1 and blocks[stop] < last_of_row:
            stop += 1
        first = (np.int64(blocks[start]) - row * blocks_per_row) * _LANES
        count = (stop - start) * _LANES
        even, odd = sums[0, :count], sums[1, :count]
        even[:] = 0
        odd[:] = 0
        for i in range(2 * RADIUS + 1):
            e = field[row + i + _MARGIN - RADIUS, 0, first : first + count + _MARGIN]
            o = field[row + i + _MARGIN - RADIUS, 1, first : first + count + _MARGIN]
            _add_row(even, odd, e, o, stencil[row & 1, 0, i], stencil[row & 1, 1, i], abs(i - RADIUS))
        for block in range(start, stop):
            offset = (block - start) * _LANES
            for j in range(_LANES):
                out[block, 0, j] = even[offset + j]
                out[block, 1, j] = odd[offset + j]
        start = stop


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _add_row(even: Any, odd: Any, e: Any, o: Any, w: Any, v: Any, distance: int) -> None:
    """Add the products of one row of the stencil, of weights w for even and v for odd columns."""
    w0, w1, w2, w3, w4, w5, w6 = w[0], w[1], w[2], w[3], w[4], w[5], w[6]
    v0, v1, v2, v3, v4, v5, v6 = v[0], v[1], v[2], v[3], v[4], v[5], v[6]
    if distance <= 1:
        for j in range(even.size):
            even[j] += (
                w1 * e[j + 1]
                + w3 * e[j + 2]
                + w5 * e[j + 3]
                + (w0 * o[j] + w2 * o[j + 1] + w4 * o[j + 2] + w6 * o[j + 3])
            )
            odd[j] += (
                v1 * o[j + 1]
                + v3 * o[j + 2]
                + v5 * o[j + 3]
                + (v0 * e[j + 1] + v2 * e[j + 2] + v4 * e[j + 3] + v6 * e[j + 4])
            )
    elif distance == 2:
        for j in range(even.size):
            even[j] += w1 * e[j + 1] + w3 * e[j + 2] + w5 * e[j + 3] + (w2 * o[j + 1] + w4 * o[j + 2])
            odd[j] += v1 * o[j + 1] + v3 * o[j + 2] + v5 * o[j + 3] + (v2 * e[j + 2] + v4 * e[j + 3])
    else:
        for j in range(even.size):
            even[j] += w3 * e[j + 2] + (w2 * o[j + 1] + w4 * o[j + 2])
            odd[j] += v3 * o[j + 2] + (v2 * e[j + 2] + v4 * e[j + 3])


@njit(cache=True, nogil=True, error_model="numpy")
def _restrict(field: Any, blocks: Any, blocks_per_row: int, out: Any) -> None:
    """Add every value to the even nodes around it, with the weights of linear interpolation."""
    half = np.float32(0.5)
    margin = _MARGIN // 2
    for b in range(blocks.size):
        row = np.int64(blocks[b]) // blocks_per_row
        first = (np.int64(blocks[b]) - row * blocks_per_row) * _LANES
        e = field[row + _MARGIN, 0, first + margin : first + margin + _LANES]
        o = field[row + _MARGIN, 1, first + margin : first + margin + _LANES]
        count = min(_LANES, out.shape[1] - 1 - first)
        weight = half if row & 1 else np.float32(1)
        for line in range(row >> 1, ((row + 1) >> 1) + 1):
            to = out[line, first : first + count + 1]
            for j in range(count):
                to[j] += weight * (e[j] + half * o[j])
            for j in range(count):
                to[j + 1] += weight * half * o[j]


@njit(cache=True, nogil=True, error_model="numpy")
def interpolate_from_even_nodes(coarse: Any, nodes: Any, nx: int, out: Any) -> None:
    """Add the linear interpolant of a field on the even nodes to values at nodes.

    `coarse` has a row and a column more than there are even rows and columns.
    """
    quarter, half = np.float32(0.25), np.float32(0.5)
    row, start = 0, 0
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + nx:
            row = node // nx
            start = row * nx
        column = node - start
        j, i = row >> 1, column >> 1
        if row & 1:
            if column & 1:
                out[k] += quarter * (
                    (coarse[j, i] + coarse[j, i + 1]) + (coarse[j + 1, i] + coarse[j + 1, i + 1])
                )
            else:
                out[k] += half * (coarse[j, i] + coarse[j + 1, i])
        elif column & 1:
            out[k] += half * (coarse[j, i] + coarse[j, i + 1])
        else:
            out[k] += coarse[j, i]
