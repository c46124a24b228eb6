"""The coarsest grid that holds the stress at a depth, and the bound of its error.

Bound
-----
A pressure mode of amplitude |p̂| and wavenumber q has, at depth d, no field (component, principal, largest
shear, hydrostatic or von Mises stress) larger than K (1 + q d) e^(−q d) |p̂|, with the constant K of
`envelope_of`. No field changes by more than the fields of the modes that are dropped: the largest shear and
the von Mises stress are seminorms, and principal stresses move by at most the spectral norm of the change (H.
Weyl, Math. Ann. 71 (1912) 441, DOI 10.1007/BF01456804). The sum over the modes that a grid drops therefore
bounds the error of every field at every node. ``paper/supplement/method.md`` has the proof of K in a
half-space; for a layer K is computed from its kernels. The grid chosen is the coarsest whose bound is below
the tolerance times the root mean square of σ_zz in that plane, which Parseval's theorem gives beforehand and
which is at most the largest |σ_zz| there. The rest of the tolerance bounds the columns of modes that are left
out of the transforms along y.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from asperity.core.sizes import good_size
from asperity.core.types import Array
from asperity.elasticity.solid import Solid
from asperity.elasticity.stack import MAX_SCALED_DEPTH
from asperity.fourier.grid import Grid

ENVELOPE_MARGIN = 0.01
"""Allowance for wavenumbers between which the bound of a layer is computed; the largest found by
``benchmarks/bound.py`` is 1e-4."""

MIN_NODES = 16
"""Fewest nodes on an edge of a coarse grid: below it a plane costs no less."""


class PlaneGrid(NamedTuple):
    """Grid of a plane.

    Parameters
    ----------
    grid : Grid
    bound : float
        Bound of the error of the plane.
    scale : float
        Root mean square of σ_zz, or a little less; 0 where it is not known.
    columns : int
        Number of columns of modes, the first ones, that the plane needs.
    """

    grid: Grid
    bound: float
    scale: float
    columns: int


class Truncation:
    """Chooses the coarsest sufficient grid for every depth under one pressure.

    Parameters
    ----------
    pressure : array
        Coefficients of the contact pressure, of the `mode_shape` of the first grid.
    grids : sequence of Grid
        Grids to choose from, finest first: the grid of the coefficients, and coarser ones of the same cell.
    layer : Solid
    tolerance : float
        Largest error relative to the root mean square of σ_zz in the plane; 0 keeps the grid.
    envelope : callable
        Depth → the constant K.
    aliases : float
        Largest number of short waves of comparable amplitude that are aliased to one long wave on the nodes
        of a plane; 0 where planes are transformed from their modes.
    sliding : array, optional
        Coefficients of the part of the pressure that causes the shear traction; by default all of it.
    """

    def __init__(
        self,
        pressure: Array,
        grids: Sequence[Grid],
        layer: Solid,
        tolerance: float,
        envelope: Callable[[float], float],
        aliases: float = 0.0,
        sliding: Array | None = None,
    ) -> None:
        grid, self._grids, self._layer = grids[0], grids, layer
        self._tolerance, self._envelope, self._aliases = tolerance, envelope, aliases
        width = 2 * np.pi / max(grid.period)
        numbers = grid.half_wavenumber()
        numbers /= width
        np.floor(numbers, out=numbers)
        if numbers.max() < numbers.size:
            ring = numbers.astype(np.int64)
            occupied = np.arange(int(ring.max()) + 1)
        else:  # most rings of a long and narrow cell hold no mode
            occupied, ring = np.unique(numbers, return_inverse=True)
            ring = ring.reshape(numbers.shape)
        rings = occupied.size
        self._width, self._wavenumber = width, width * occupied
        magnitude = np.abs(pressure)
        largest = magnitude
        if sliding is not None and sliding is not pressure:
            largest = np.maximum(magnitude, np.abs(sliding))
        amplitude = _folded(largest, grid)
        magnitude *= magnitude
        power = _folded(magnitude, grid)
        self._qx, self._of_columns = grid.qx, amplitude.sum(axis=0)
        self._power = np.bincount(ring.ravel(), power.ravel(), rings)
        self._mean_square = float(np.abs(pressure[0, 0]) ** 2)
        self._power[0] = 0.0
        # The last (coarsest) of the grids that keeps the modes ±ky, of the `half_shape` of the grid.
        along_y, along_x = (
            np.sum(
                [2 * np.arange(modes) < each.whole_cell.shape[axis] for each in grids[1:]], axis=0, dtype=int
            )
            for axis, modes in enumerate(grid.half_shape)
        )
        last = np.minimum.outer(along_y, along_x)
        flat = (last * rings + ring).ravel()
        amount = np.bincount(flat, amplitude.ravel(), len(self._grids) * rings).reshape(-1, rings)
        self._dropped = np.cumsum(amount, axis=0) - amount
        self._kept = amount.sum(axis=0) - self._dropped

    def scale(self, depth: float) -> float:
        """Root mean square of σ_zz at `depth`, from the spectrum, or a little less.

        The modes of a ring of wavenumbers are taken to decay as at its outer edge.
        """
        normal = np.asarray(self._layer.kernels(self._wavenumber + self._width, depth).normal)
        return float(np.sqrt(self._mean_square + np.sum(self._power * normal**2)))

    def bounds(self, depth: float) -> Array:
        """Largest error of any stress at `depth` on each of the grids, (grids,)."""
        bounds = self._dropped @ _decayed(self._wavenumber * depth)
        if self._aliases:
            for number, grid in enumerate(self._grids[1:], start=1):
                nyquist = np.pi / max(grid.spacing)
                alias = np.maximum(2 * nyquist - self._wavenumber, nyquist)
                bounds[number] += self._aliases * self._kept[number] @ _decayed(alias * depth)
        return self._envelope(depth) * bounds

    def choose(self, depth: float, all_columns: bool = False) -> PlaneGrid:
        """The coarsest sufficient grid at `depth`, and its bound."""
        scale, grid, bound = self.scale(depth), self._grids[0], 0.0
        if self._tolerance == 0:
            return PlaneGrid(grid, bound, scale, grid.mode_shape[1])
        allowed = self._tolerance * scale
        bounds = self.bounds(depth)
        coarsest = np.flatnonzero(bounds <= allowed)[-1]
        grid, bound = self._grids[coarsest], float(bounds[coarsest])
        if all_columns:
            return PlaneGrid(grid, bound, scale, grid.mode_shape[1])
        # The tolerance less the error of the grid allows columns to be left out of the transforms along y.
        count = grid.mode_shape[1]
        dropped = self._of_columns[:count] * _decayed(self._qx[:count] * depth)
        dropped *= self._envelope(depth)
        beyond = np.append(np.cumsum(dropped[::-1])[::-1], 0.0)
        columns = max(1, int(np.flatnonzero(beyond <= allowed - bound)[0]))
        return PlaneGrid(grid, bound + float(beyond[columns]), scale, columns)


def envelope_of(layer: Solid, poisson: float, friction: float, depth: float) -> float:
    """The constant K at a depth, under pressure and a shear traction `friction` times it.

    In a half-space it is the same at every depth, and holds for all ratios ≥ `poisson`. In a layer it is the
    largest ratio of the bound of a mode, from its kernels, to the bound of the half-space without K, at
    wavenumbers so close that it changes by less than `ENVELOPE_MARGIN` between them; in a layered solid of
    all that are not zero at the depth.
    """
    lateral = 1 - 2 * poisson
    of_pressure, of_traction = max(np.sqrt(3.0), lateral), max(np.sqrt(5.0), np.sqrt(3.0 + lateral**2))
    half_space = float(of_pressure + friction * of_traction)
    if layer.height is None:
        return half_space
    # Below these the kernels have their limits for thin layers, above them their values in the half-space.
    wavenumber, ratio = np.geomspace(1e-4, 40.0, 500) / layer.height, layer.poisson
    if layer.base is not None:
        # Stiff or soft layers have their limits at longer waves, what lies below at shorter ones.
        young = [part.young for part in layer.parts]
        lowest = 1e-4 * min(young) / max(young)
        count = int(90 * np.log10(MAX_SCALED_DEPTH / lowest))
        wavenumber = np.geomspace(lowest, MAX_SCALED_DEPTH, count) / max(depth, layer.interfaces[-1])
        ratio = layer.part_at(depth).poisson
    z, along, shear = layer.kernels(wavenumber, depth)[:3]
    bound = _mode_bound(z, along, ratio * (z + along), shear)
    if friction:
        n, m, x, across, turn = layer.shear_kernels(wavenumber, depth)
        of_across = np.sqrt(3.0) * np.maximum(np.abs(across), np.abs(turn))
        bound = bound + friction * np.hypot(_mode_bound(n, m, ratio * (n + m), x), of_across)
    largest = np.max(bound / _decayed(wavenumber * depth))
    return max(half_space, float(largest) * (1 + ENVELOPE_MARGIN))


def _mode_bound(z: Array, along: Array, across: Array, shear: Array) -> Array:
    """Bound of every field of modes with these normal stresses in phase, and a shear stress out of phase.

    The von Mises stress is largest where either the normal stresses or the shear stress are. Half of the sum
    and the half of the difference of two normal stresses, or the shear stress, bound the principal stresses,
    by which the hydrostatic stress is bounded; the maximum shear stress is at most the von Mises stress over
    √3.
    """
    differences = (z - along) ** 2 + (along - across) ** 2 + (across - z) ** 2
    von_mises = np.maximum(np.sqrt(0.5 * differences), np.sqrt(3.0) * np.abs(shear))
    half = np.maximum(0.5 * np.abs(z - along), np.abs(shear))
    return np.maximum.reduce([von_mises, 0.5 * np.abs(z + along) + half, np.abs(across)])


def coarser_grids(grid: Grid) -> list[Grid]:
    """The grid and coarser ones of the same cell: 7/8, 6/8, 5/8, 4/8 of its nodes, and so on by halves.

    Every number of nodes is one whose transform is fast, and at least `MIN_NODES`, or as many as the grid
    has. These are numbers along a period: a mirrored map has half as many.
    """
    grids, images, nodes = [grid], 2 if grid.mirrored else 1, grid.whole_cell.shape
    halving = 1.0
    while True:
        for eighths in (7, 6, 5, 4):
            fraction = halving * eighths / 8
            shape = tuple(min(n, max(good_size(int(np.ceil(n * fraction))), MIN_NODES)) for n in nodes)
            shape = shape[0] // images, shape[1] // images
            if shape != grids[-1].shape:
                grids.append(Grid(shape, grid.length, grid.mirrored))
        halving /= 2
        if min(nodes) * halving < MIN_NODES:
            return grids


def _decayed(decay: Array) -> Array:
    """Bound of a mode at the depth `decay`/q over its pressure, without the constant K."""
    return (1 + decay) * np.exp(-decay)


def _folded(values: Array, grid: Grid) -> Array:
    """Weighted sum over the modes ±ky of values of the stored modes, of the `half_shape` of the grid."""
    rows, columns = grid.multiplicity
    half = grid.half_shape[0]
    out = values[:half] * columns
    if grid.mirrored:
        out *= rows[:, None]
    out[1 : values.shape[0] - half + 1] += values[: half - 1 : -1] * columns
    return out
