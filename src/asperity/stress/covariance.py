"""Covariance of the planes of a stream with the plane of the largest von Mises stress (Eq. 22)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from asperity.spectral import Fourier, Grid, Work, resample
from asperity.stress.fields import SHARED, fill_fields, moments, pack
from asperity.stress.linear_plane import LinearPlane
from asperity.stress.search import SoughtField
from asperity.stress.statistics import LagRings
from asperity.types import Array

SKIPPED_ABOVE = 0.5
"""Planes with more than this share of the nodes of the contact along each axis are compared at every second
node along each axis where single precision will do: the error of the covariance is below 3e-5 of it. Planes
less than a spacing deep, where the stress has edges at those of the contacts, are compared at all nodes."""

FEWEST_SKIPPED = 512
"""Fewest nodes along an axis of such planes."""

MOST_KEPT = 8
"""Planes above the reference that are kept while the largest value still rises from plane to plane."""

PACKED = 65535
"""Steps from 0 to the largest value in which planes in single precision are kept. The rounding, 1e-5 of the
largest value, is averaged over all nodes: the error of a covariance is below 1e-6 of it."""


class References:
    """For several fields, the plane with the largest value so far, and the covariance of all planes with it.

    The planes come one by one, each on a grid no finer than the one before. Those above the reference are
    compared with it when it becomes the reference, as far as they are kept: all of them, if the largest value
    rose from every plane to the next and they are on one grid. Others are to be added again.

    Parameters
    ----------
    fields : sequence of SoughtField
        The von Mises stress for some Poisson's ratios and uniform modes.
    planes : int
        Number of planes of the stream.
    finest : Grid
        Grid on which lags in a plane are sampled.
    threads : int
    work : Work
        Where transforms are counted.

    Attributes
    ----------
    number : (fields,) array
        Which plane of the stream is the reference of each field.
    covariance : (fields, planes) array
        Mean of the product of the fields of each plane and of the reference, less the product of their means;
        NaN where a plane has not been compared.
    missing : (fields,) array
        Number of the uppermost planes that are to be added again.
    """

    def __init__(
        self,
        fields: Sequence[SoughtField],
        planes: int,
        finest: Grid,
        threads: int,
        work: Work,
    ) -> None:
        count = len(fields)
        self.number = np.full(count, -1)
        self.covariance = np.full((count, planes), np.nan)
        self.missing = np.zeros(count, int)
        self._sought, self._finest, self._threads, self._work = list(fields), finest, threads, work
        self._largest = np.full(count, -np.inf)
        self._grid: Grid | None = None
        self._fields = np.empty((count, 0, 0))
        self._compared = self._fields
        self._spare = self._taken = self._fields[:0]
        self._rises = False
        self._unfilled: dict[int, LinearPlane] = {}
        self._depths = np.zeros(count)
        self._means = np.zeros(count)
        self._kept: list[list[_Packed] | None] = [[] for _ in fields]
        self._modes: list[tuple[Grid, Array] | None] = [None for _ in fields]
        self._in_plane: list[Array | None] = [None for _ in fields]
        self._own: list[tuple[Grid, Array] | None] = [None for _ in fields]
        self._rings: LagRings | None = None

    def on(self, plane: LinearPlane) -> Array:
        """The references at every node of a plane or every second one, (fields, ny, nx).

        There are none before the first plane.
        """
        if self._grid is None:
            self._fields = np.empty((len(self._sought), *plane.grid.shape), plane.dtype)
            self._compared = self._fields
            return self._compared[:0]
        if plane.grid != self._grid:
            for m in range(len(self._sought)):
                self._transform(m, plane.grid)
            step = self._step(plane.grid)
            ny, nx = plane.grid.shape
            self._resample(Grid((ny // step, nx // step), plane.grid.length))
            self._compared, self._grid = self._fields, plane.grid
        return self._compared

    def room_for(self, plane: LinearPlane) -> Array:
        """Where the fields of a plane are to be written that may become references, after a call of `on`.

        At every node or every second one, as they will be compared; empty if they are hardly needed.
        """
        step = self._step(plane.grid, plane.depth)
        self._taken = self._fields[:0]
        if self._grid is None:
            self._taken = self._fields
        elif self._rises and step > 1:
            count, ny, nx = len(self._sought), *plane.grid.shape
            if self._spare.shape != (count, ny // step, nx // step):
                self._spare = np.empty((count, ny // step, nx // step), plane.dtype)
            self._taken = self._spare
        return self._taken

    def _resample(self, grid: Grid) -> None:
        """Transform all references to a grid from their modes."""
        self._fields = np.empty((len(self._sought), *grid.shape), self._fields.dtype)
        for m, (field, modes) in enumerate(zip(self._fields, self._modes, strict=True)):
            assert modes is not None
            source, coefficients = modes
            fourier = Fourier(grid, field.dtype, self._threads, self._work)
            self._means[m] = coefficients[0, 0].real
            fourier.inverse(resample(coefficients, source, grid), out=field, overwrite=True)

    def _transform(self, m: int, target: Grid) -> None:
        """Transform a reference that is on its own grid, and keep the modes that coarser grids need."""
        self._complete(m)
        self._compare_kept(m)
        if self._modes[m] is None:
            assert self._grid is not None
            field = self._fields[m]
            modes = Fourier(self._grid, field.dtype, self._threads, self._work).forward(field)
            self._in_plane[m] = self._autocovariance(modes, self._grid)
            self._modes[m] = target, resample(modes, self._grid, target)
            if self.missing[m]:
                self._own[m] = self._grid, field.copy()

    def _autocovariance(self, modes: Array, grid: Grid) -> Array:
        if self._rings is None:
            self._rings = LagRings(self._finest)
        return self._rings.autocovariance(modes, grid, self._work)

    def in_plane(self) -> tuple[Array, Array]:
        """Lags, (lags,), and the covariance of each reference within its plane, (fields, lags)."""
        for m, found in enumerate(self._in_plane):
            if found is None and self._grid is not None:
                self._transform(m, self._grid)
        assert self._rings is not None
        return self._rings.lag, np.stack([found for found in self._in_plane if found is not None])

    def add(self, number: int, plane: LinearPlane, sums: Array) -> None:
        """Add the next plane downward, of which the rows have been summed with the references on its grid.

        It becomes the reference of the fields whose largest value is the largest so far.
        """
        size, compared = plane.grid.size, self._grid is not None
        self._grid = plane.grid
        totals = sums[:, :, [0, 1, 3, 4]].sum(axis=1) / size
        totals[:, 2:] *= size / self._compared[0].size
        largest = sums[:, :, 2].max(axis=1)
        if compared:
            means, products = totals[: len(self._sought), 2:].T
            self.covariance[:, number] = products - means * self._means
        has_risen = largest[: len(self._sought)] > self._largest
        risen = np.flatnonzero(has_risen)
        self._rises = risen.size > 0
        for m in risen.tolist():
            self._unfilled.pop(m, None)
        for m in np.flatnonzero(~has_risen).tolist():
            self._complete(m)
            self._compare_kept(m)
        for m in risen.tolist():
            self._kept[m] = self._kept_above(m, number)
        if not risen.size:
            return
        if self._fields.shape[1:] != plane.grid.shape:
            self._resample(plane.grid)
        self._depths[risen] = plane.depth
        self._take(plane, risen, totals[risen, 0])
        for m in risen.tolist():
            self._modes[m] = self._in_plane[m] = self._own[m] = None
            mean, square, _, _ = totals[m]
            self._largest[m] = largest[m]
            self.number[m], self.covariance[m, number] = number, square - mean * mean
            self.missing[m] = number if self._kept[m] is None else 0

    def _take(self, plane: LinearPlane, risen: Array, means: Array) -> None:
        """Take some fields of a plane, with these means, as references.

        Where only every second value is compared, the others are left out for now: the largest value often
        rises from plane to plane, and all values are needed of the last plane alone.
        """
        step = self._step(plane.grid, self._depths.min())
        if step == 1:
            self._compared = self._fields
            if self._taken is not self._fields:
                self._fill(plane, risen, self._fields)
            self._means[risen] = means
            return
        all_rise, changed = risen.size == len(self._sought), risen.tolist()
        if self._compared is self._fields:
            sampled = self._fields[:, ::step, ::step]
            self._compared = np.empty(sampled.shape, sampled.dtype) if all_rise else sampled.copy()
            changed = range(len(self._sought))
        if self._taken.size:
            if all_rise:
                self._compared, self._spare = self._spare, self._compared
            else:
                self._compared[risen] = self._spare[risen]
            self._unfilled.update(dict.fromkeys(risen.tolist(), plane))
        else:
            self._fill(plane, risen, self._fields)
            self._compared[risen] = self._fields[risen, ::step, ::step]
        for m in changed:
            self._means[m] = moments(self._compared[m], self._compared[m])[0]

    def _complete(self, m: int) -> None:
        """Take all values of a reference, if some have been left out, while its plane is still there."""
        plane = self._unfilled.get(m)
        if plane is not None:
            alike = [other for other, its in self._unfilled.items() if its is plane]
            self._fill(plane, np.array(alike), self._fields)
            for other in alike:
                del self._unfilled[other]

    def _step(self, grid: Grid, depth: float = np.inf) -> int:
        """2 if planes on a grid, from a depth on, are compared at every second node of each axis, else 1."""
        if depth < min(self._finest.spacing):
            return 1
        fine = [n > SKIPPED_ABOVE * most for n, most in zip(grid.shape, self._finest.shape, strict=True)]
        even = [n % 2 == 0 and n >= FEWEST_SKIPPED for n in grid.shape]
        return 2 if self._fields.dtype == np.float32 and all(fine) and all(even) else 1

    def _kept_above(self, m: int, number: int) -> list[_Packed] | None:
        """Planes above one that becomes the reference of a field; None if some have not been kept."""
        kept = self._kept[m]
        if not number or kept is None:
            return kept
        if len(kept) == MOST_KEPT:
            return None
        return [*kept, _Packed.of(self._compared[m], float(self._largest[m]))]

    def _compare_kept(self, m: int) -> None:
        """Compare the kept planes with the reference below them, and give back their memory."""
        for above, packed in enumerate(self._kept[m] or []):
            same = self._fields if packed.field.shape == self._fields.shape[1:] else self._compared
            self.covariance[m, above] = packed.unit * _covariance(packed.field, same[m])
        self._kept[m] = None

    def _fill(self, plane: LinearPlane, places: Array, out: Array) -> None:
        """Write some of the fields of a plane to their places in `out`."""
        compiled = [field.compiled(plane) for field in self._sought]
        ratios, uniforms = (
            np.array([getattr(field, name) for field in compiled], plane.dtype)
            for name in ("ratio", "uniform")
        )
        shared = np.empty(SHARED, plane.dtype)
        fill_fields(plane.parts(), compiled[0].kind, ratios, uniforms, places, shared, out)

    def add_again(self, number: int, plane: LinearPlane) -> None:
        """Compare a plane above some references that has not been compared."""
        again = np.flatnonzero(self.missing > number)
        for m in again.tolist():
            self._complete(m)
        here = np.empty((len(self._sought), *plane.grid.shape), plane.dtype)
        self._fill(plane, again, here)
        for m in again.tolist():
            self.covariance[m, number] = _covariance(here[m], self._on_finer(m, plane.grid))

    def _on_finer(self, m: int, grid: Grid) -> Array:
        """A reference on its own grid or a finer one."""
        assert self._grid is not None
        source, field = self._own[m] or (self._grid, self._fields[m])
        if source == grid:
            return field
        modes = Fourier(source, field.dtype, self._threads, self._work).forward(field)
        fourier = Fourier(grid, field.dtype, self._threads, self._work)
        return fourier.inverse(resample(modes, source, grid), overwrite=True)


class _Packed(NamedTuple):
    """A field in little memory: `unit` times an array."""

    unit: float
    field: Array

    @classmethod
    def of(cls, field: Array, largest: float) -> _Packed:
        """A field from 0 to `largest`, in steps of that over `PACKED`, or as it is in double precision."""
        if field.dtype != np.float32 or not largest:
            return cls(1.0, field.copy())
        packed = np.empty(field.shape, np.uint16)
        pack(field, PACKED / largest, packed)
        return cls(largest / PACKED, packed)


def _covariance(one: Array, two: Array) -> float:
    mean_one, mean_two, product = moments(one, two)
    return product - mean_one * mean_two
