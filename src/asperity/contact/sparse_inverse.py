"""A sparse approximate inverse of the compliance of any solid, restricted to the contact nodes.

Under layers the compliance G falls with the wavenumber in many ways, as q⁻⁴ where a stiff film bends like a
plate, and the inverse of its stencil is neither short nor positive. G restricted to the contact nodes is a
smooth covariance, though: the displacement of a node hardly depends on a far one once those nearby are
given. G⁻¹ ≈ U Uᵀ with a few numbers in each column of U is the best approximation of that sparsity in
the Kullback–Leibler divergence (F. Schäfer, M. Katzfuss and H. Owhadi, SIAM J. Sci. Comput. 43 (2021) A2019,
DOI 10.1137/20M1336254). With G on a set of nodes, own node last, and G = L Lᵀ there, the column is L⁻ᵀ e.

The nodes are ordered from coarse to fine: one in the whole map, one in each quarter, and so on. The set of a
node are the earlier ones in the cells around it, of the size at which the node appears, so that the first
columns hold the elastic interaction of distant contacts.
"""

from typing import Any

import numpy as np

from asperity.contact.response import Response
from asperity.core.compiled import compiled, compiled_with_arrays
from asperity.core.parallel import in_parts
from asperity.core.types import Array
from asperity.fourier.grid import Fourier

REACH = 2
"""Cells in which earlier nodes are taken, on each side of the cell of a node."""

MOST = (2 * REACH + 1) ** 2
"""Most nodes of a column."""

JITTER = 1e-9
"""Relative increase of the diagonal of G, above the rounding errors of its smallest eigenvalues."""


def influence(response: Response) -> Array:
    """Displacement of a whole period by a pressure on its first node, in units of the nodal compliance."""
    whole = response.grid.whole_cell
    wavenumber = whole.half_wavenumber()
    modes = response.solid.surface_compliance(wavenumber)
    if not modes[0, 0]:  # undefined, or none: as of the longest wave
        modes[0, 0] = modes.ravel()[1:].max()
    modes = modes[np.abs(whole.ky)]
    return Fourier(whole).inverse(modes / (whole.size * response.nodal_compliance) + 0j)


class SparseInverse:
    """M ≈ G⁻¹ on contact nodes, as `asperity.contact.operators.NodePreconditioner`.

    Parameters
    ----------
    kernel : array
        Of `influence`.
    shape : (ny, nx)
        Of the map; half a period along each axis on a mirrored one.
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    threads : int
    """

    def __init__(self, kernel: Array, shape: tuple[int, int], nodes: Array, threads: int) -> None:
        mirrored = kernel.shape != shape
        place = np.stack(np.divmod(nodes.astype(np.int64), shape[1]))
        self._members = np.full((nodes.size, MOST), -1, np.int32)
        _write_members(place, *shape, mirrored, self._members)
        self._weights = np.zeros((nodes.size, MOST), np.float32)
        in_parts(
            lambda part: _write_weights(kernel, place, mirrored, self._members[part], self._weights[part]),
            nodes.size,
            threads,
        )
        self.uniform = self(np.ones(nodes.size, np.float32))

    def __call__(self, residual: Array) -> Array:
        """Pressures M r that approximately remove a residual r on the contact nodes."""
        out = np.zeros(residual.size)
        _apply(self._members, self._weights, residual, out)
        return out.astype(np.float32)


@compiled_with_arrays
def _write_members(place: Any, ny: int, nx: int, mirrored: bool, members: Any) -> None:
    """Write the nodes of each column, the own node first, as indices of contact nodes."""
    count, rank, done = place.shape[1], np.full(place.shape[1], -1), 0
    order, level = np.empty(count, np.int64), 0
    while (max(ny, nx) - 1) >> level:
        level += 1
    while level >= 0:
        rows, columns = ((ny - 1) >> level) + 1, ((nx - 1) >> level) + 1
        inside = np.full((rows, columns), -1)
        for k in order[:done]:
            inside[place[0, k] >> level, place[1, k] >> level] = k
        first = done
        for k in range(count):
            if rank[k] < 0 and inside[place[0, k] >> level, place[1, k] >> level] < 0:
                inside[place[0, k] >> level, place[1, k] >> level] = k
                rank[k], order[done] = done, k
                done += 1
        for k in order[first:done]:
            row, column, found = place[0, k] >> level, place[1, k] >> level, 1
            members[k, 0] = k
            for i in range(max(row - REACH, row - (rows - 1) // 2), min(row + REACH, row + rows // 2) + 1):
                for j in range(
                    max(column - REACH, column - (columns - 1) // 2),
                    min(column + REACH, column + columns // 2) + 1,
                ):
                    if mirrored and not (0 <= i < rows and 0 <= j < columns):
                        continue
                    other = inside[i % rows, j % columns]
                    if other >= 0 and rank[other] < rank[k]:
                        members[k, found] = other
                        found += 1
        level -= 1


@compiled_with_arrays
def _write_weights(kernel: Any, place: Any, mirrored: bool, members: Any, weights: Any) -> None:
    """Write the columns of U for the members of each."""
    ny, nx = kernel.shape
    factor, column = np.empty((MOST, MOST)), np.empty(MOST)
    for k in range(members.shape[0]):
        size = 0
        while size < MOST and members[k, size] >= 0:
            size += 1
        for i in range(size):  # Cholesky factor, the own node last
            a = members[k, size - 1 - i]
            for j in range(i + 1):
                b = members[k, size - 1 - j]
                dy, dx = place[0, a] - place[0, b], place[1, a] - place[1, b]
                dy, dx = dy + ny * (dy < 0), dx + nx * (dx < 0)
                value = kernel[dy, dx]
                if mirrored:
                    sy, sx = place[0, a] + place[0, b] + 1, place[1, a] + place[1, b] + 1
                    value += kernel[sy, dx] + kernel[dy, sx] + kernel[sy, sx]
                if i == j:
                    value *= 1.0 + JITTER
                for m in range(j):
                    value -= factor[i, m] * factor[j, m]
                factor[i, j] = np.sqrt(max(value, JITTER * kernel[0, 0])) if i == j else value / factor[j, j]
        for i in range(size - 1, -1, -1):
            value = 1.0 if i == size - 1 else 0.0
            for m in range(i + 1, size):
                value -= factor[m, i] * column[m]
            column[i] = value / factor[i, i]
            weights[k, size - 1 - i] = column[i]


@compiled
def _apply(members: Any, weights: Any, residual: Any, out: Any) -> None:
    """Add U Uᵀ r."""
    for k in range(members.shape[0]):
        total = 0.0
        for n in range(MOST):
            if members[k, n] < 0:
                break
            total += weights[k, n] * residual[members[k, n]]
        for n in range(MOST):
            if members[k, n] < 0:
                break
            out[members[k, n]] += weights[k, n] * total
