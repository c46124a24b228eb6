"""Stencils applied to values on the contact nodes: the product with a kernel of short range.

Values are spread on an array with a margin that repeats the map, or is zero if nothing surrounds the map. The
weights of a stencil are symmetric, and may differ between even and odd rows and columns.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from asperity.contact.places import row_plus_column
from asperity.parallel import in_parts
from asperity.spectral import Grid
from asperity.types import Array

RADIUS = 3
"""Radius of the stencils, in nodes: they reach the nodes with row² + column² ≤ RADIUS (RADIUS + 1)."""

# Rows of a stencil, and numbers in each of them with a zero at the end: they fill a vector register.
_ROWS = 2 * RADIUS + 1
_LANES = _ROWS + 1


class StencilField:
    """Values on contact nodes, spread on an array with a margin, to which stencils are applied.

    Parameters
    ----------
    grid : Grid
    repeats : bool
        True if nodes at opposite edges of the map are neighbours.
    threads : int
    """

    def __init__(self, grid: Grid, repeats: bool, threads: int = 1) -> None:
        self._threads = threads
        ny, nx = grid.shape
        self._shape = grid.shape
        self._repeats = repeats
        # The last row of a stencil reads one number beyond it.
        memory = np.zeros((ny + 2 * RADIUS) * (nx + 2 * RADIUS) + 1, np.float32)
        self._field = memory[:-1].reshape(ny + 2 * RADIUS, nx + 2 * RADIUS)
        self._position = np.empty(0, np.uint32)

    def restrict(self, nodes: Array) -> None:
        """Choose the nodes that bear values, by their sorted indices in the flattened map."""
        _erase(self._field.reshape(-1), self._position)
        self._position, self._parity = self._locate(nodes)

    def spread(self, values: Array) -> None:
        """Spread values on the nodes."""
        field = self._field.reshape(-1)
        self._in_parts(lambda part: _scatter(field, self._position[part], values[part]), values.size)
        if self._repeats:
            _fill_margin(self._field)

    def apply(self, stencil: Array, values: Array, out: Array) -> None:
        """Write the products of a stencil with values on the nodes, at the nodes.

        Parameters
        ----------
        stencil : array
            From `whole_stencil`.
        values, out : (count,) arrays
        """
        self.spread(values)
        self._apply(stencil, self._position, self._parity, out)

    def apply_at(self, stencil: Array, nodes: Array) -> Array:
        """Products of a stencil with the values spread last, at other nodes."""
        out = np.empty(nodes.size, np.float32)
        self._apply(stencil, *self._locate(nodes), out)
        return out

    def _locate(self, nodes: Array) -> tuple[Array, Array]:
        """Indices of nodes in the array with the margin, and 2 × parity of the row + that of the column."""
        ny, nx = self._shape
        rows, columns = np.arange(ny, dtype=np.uint32), np.arange(nx, dtype=np.uint32)
        first = (rows + np.uint32(RADIUS)) * np.uint32(self._field.shape[1])
        position = row_plus_column(nodes, first, columns + np.uint32(RADIUS), self._threads)
        parity = (2 * (rows % 2)).astype(np.uint8), (columns % 2).astype(np.uint8)
        return position, row_plus_column(nodes, *parity, self._threads)

    def _apply(self, stencil: Array, position: Array, parity: Array, out: Array) -> None:
        field, width = self._field.reshape(-1), self._field.shape[1]

        def apply(part: slice) -> None:
            _apply(field, width, position[part], parity[part], stencil, out[part])

        self._in_parts(apply, out.size)

    def _in_parts(self, work: Callable[[slice], None], count: int) -> None:
        in_parts(work, count, self._threads)


def whole_stencil(quadrants: Array) -> Array:
    """All weights of a symmetric stencil, from those of a quadrant for each parity of row and column.

    Parameters
    ----------
    quadrants : (2, 2, RADIUS + 1, RADIUS + 1) array
        Weights [parity of the row, parity of the column, rows off, columns off].
    """
    off = np.abs(np.arange(-RADIUS, RADIUS + 1))
    out = np.zeros((4, _ROWS, _LANES), np.float32)
    out[:, :, :_ROWS] = quadrants.reshape(4, RADIUS + 1, RADIUS + 1)[:, off[:, None], off]
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _scatter(field: Any, position: Any, values: Any) -> None:
    for k in range(position.size):
        field[position[k]] = values[k]


@njit(cache=True, nogil=True, error_model="numpy")
def _erase(field: Any, position: Any) -> None:
    for k in range(position.size):
        field[position[k]] = 0


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_margin(field: Any) -> None:
    """Repeat the map periodically in the margin."""
    ny, nx = field.shape[0] - 2 * RADIUS, field.shape[1] - 2 * RADIUS
    for i in range(RADIUS, RADIUS + ny):
        for step in range(1, RADIUS + 1):
            field[i, RADIUS - step] = field[i, RADIUS + (nx - step) % nx]
            field[i, RADIUS + nx + step - 1] = field[i, RADIUS + (step - 1) % nx]
    for step in range(1, RADIUS + 1):
        for j in range(field.shape[1]):
            field[RADIUS - step, j] = field[RADIUS + (ny - step) % ny, j]
            field[RADIUS + ny + step - 1, j] = field[RADIUS + (step - 1) % ny, j]


@intrinsic
def _product(typing_context: Any, field: Any, first: Any, width: Any, weights: Any, stencil: Any) -> Any:
    """Sum over the rows of a stencil of weights × numbers, from the index of the first number.

    Written for the compiler, which does not turn the loops into operations on vectors: with a vector for each
    row it takes half the time.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector = ir.VectorType(ir.FloatType(), _LANES)
        numbers, factors = (
            context.make_array(signature.args[of])(context, builder, arguments[of]).data for of in (0, 3)
        )
        number, step = arguments[1], arguments[2]
        factor = builder.mul(arguments[4], ir.Constant(step.type, _ROWS * _LANES))
        total = None
        for _ in range(_ROWS):
            row, weight = (
                builder.load(builder.bitcast(builder.gep(data, [index]), vector.as_pointer()), align=4)
                for data, index in ((numbers, number), (factors, factor))
            )
            product = builder.fmul(row, weight, flags=("contract",))
            total = product if total is None else builder.fadd(total, product, flags=("contract",))
            number = builder.add(number, step)
            factor = builder.add(factor, ir.Constant(step.type, _LANES))
        half = _LANES // 2
        while half:
            others = [(lane + half) % _LANES for lane in range(_LANES)]
            order = ir.Constant(ir.VectorType(ir.IntType(32), _LANES), others)
            total = builder.fadd(total, builder.shuffle_vector(total, total, order))
            half //= 2
        return builder.extract_element(total, ir.Constant(ir.IntType(32), 0))

    return types.float32(field, types.intp, types.intp, weights, types.intp), generate


@njit(cache=True, nogil=True, error_model="numpy")
def _apply(field: Any, width: int, position: Any, parity: Any, weights: Any, out: Any) -> None:
    """Product of the stencil with the field, at positions."""
    for k in range(position.size):
        first = np.int64(position[k]) - RADIUS * (width + 1)
        out[k] = _product(field, first, width, weights, np.int64(parity[k]))  # type: ignore[call-arg]
