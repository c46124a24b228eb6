"""The stress in the solid analysed in one stream of planes: peaks, depth profile, covariances.

A plane is computed, looked at and forgotten. The plane of the largest von Mises stress, to which the
covariance of Eq. 22 refers, is known only when it has passed: it is kept as the stream goes on, and
the few planes above it are computed again at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import ArrayLike

from asperity.spectral import Fourier, Grid, Work, resample
from asperity.stress.peaks import PeakFinder, Peaks, plane_peaks
from asperity.stress.planes import FIELDS, Contact, LinearPlane, depth_grid, linear_planes
from asperity.stress.statistics import autocorrelation
from asperity.types import Array

EVERY_POISSON = -1
QUANTITIES = ("pressure", *FIELDS)

_INDEPENDENT_OF_POISSON = ("zz", "yz", "xz")


def analyse_stress(
    contact: Contact,
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = ("pressure", "von_mises", "xx", "zz", "xz"),
    tolerance: float = 1e-6,
    spacing: float = 0.5,
    growth: float = 0.125,
    floor: float = 0.01,
    threads: int = 1,
    progress: Callable[[float, float], None] | None = None,
    work: Work | None = None,
) -> xr.Dataset:
    """Peaks, depth profile and covariances of the stress under a contact.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
    depths : (planes,) array, optional
        By default those of `depth_grid` with `spacing` and `growth`, down to the bottom of the layer.
    poisson, tolerance, threads, work
        As in `stress_planes`.
    quantities : names
        Fields whose peaks are sought: any of ``xx, yy, zz, yz, xz, xy, von_mises``, above their 26
        neighbours in the solid, and ``pressure``, above its 8 neighbours in the surface.
    floor : float
        Peaks below `floor` times the root mean square of σ_zz of their plane are left out: most of them
        are ripples of the interpolated pressure between the nodes, away from the contacts.
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    dataset
        Stresses in units of E*. Along `peak`, one entry for each peak of each quantity and Poisson's
        ratio (−1: the same for every one). Along `plane`, the mean and largest von Mises stress, and the
        covariance with the plane of the largest. Along `lag`, the covariance in that plane.
    """
    layer, grid = contact.layer, contact.grid
    if depths is None:
        depths = depth_grid(grid, layer.height, spacing, growth)
    depths = np.atleast_1d(np.asarray(depths, dtype=float))
    ratios = [layer.poisson] if poisson is None else [float(nu) for nu in np.atleast_1d(np.asarray(poisson))]
    unknown = [name for name in quantities if name not in QUANTITIES]
    if unknown:
        raise ValueError(f"quantities = {unknown[0]!r}: names from {', '.join(QUANTITIES)} are needed")
    if not (np.isfinite(floor) and floor >= 0):
        raise ValueError(f"floor = {floor!r}: a finite number of at least 0 is needed")
    work = Work() if work is None else work
    free = _INDEPENDENT_OF_POISSON if layer.height is None else ()
    finders = {
        (number, index): PeakFinder()
        for number, name in enumerate(quantities)
        if name != "pressure"
        for index in ((EVERY_POISSON,) if name in free else range(len(ratios)))
    }
    references = [_Reference(depths.size, threads, work) for _ in ratios]
    points = np.zeros(depths.size, np.int64)
    mean, largest = np.zeros((2, len(ratios), depths.size))

    def stream(several: Array) -> Iterator[LinearPlane]:
        return linear_planes(contact, several, ratios, ("von_mises",), tolerance, threads, work)

    def look_at(plane: LinearPlane, number: int, lowest: float, index: int) -> None:
        """All that is asked of one Poisson's ratio in one plane; −1 for what does not depend on it."""
        nu = ratios[max(index, 0)]
        asked = {name: finders.get((quantity, index)) for quantity, name in enumerate(quantities)}
        field: Array | None = None
        if index >= 0:
            field = plane.field("von_mises", nu)
            largest[index, number] = field.max()
            mean[index, number] = references[index].add(number, plane.grid, field, largest[index, number])
            search(plane, asked.pop("von_mises", None), "von_mises", nu, field, lowest)
            if references[index].field is field:
                field = None
        for name, finder in asked.items():
            if finder is not None:
                field = plane.field(name, nu, field)
                search(plane, finder, name, nu, field, lowest)

    def search(
        plane: LinearPlane, finder: PeakFinder | None, name: str, nu: float, field: Array, lowest: float
    ) -> None:
        if finder is not None:
            finder.add(plane.depth, plane.grid, field, lowest, partial(plane.look, name, nu))

    with ThreadPoolExecutor(threads) as pool:
        for number, plane in enumerate(stream(depths)):
            points[number] = max(plane.grid.shape)
            square = _moments(plane.constant["zz"], plane.constant["zz"])[2]
            lowest = max(plane.bound, floor * np.sqrt(square), 1e-12 * np.sqrt(square))
            for reference in references:
                reference.show_on(plane.grid)
            list(pool.map(partial(look_at, plane, number, lowest), range(EVERY_POISSON, len(ratios))))
            if progress is not None:
                progress(plane.done, 1.0)
    found = {key: finder.peaks() for key, finder in finders.items()}
    finders.clear()
    repeated = max(reference.number for reference in references)
    for number, plane in enumerate(stream(depths[:repeated]) if repeated else ()):
        for nu, reference in zip(ratios, references, strict=True):
            if number < reference.number:
                reference.show_on(plane.grid)
                reference.compare(number, plane.grid, plane.field("von_mises", nu))
    if "pressure" in quantities:
        key = quantities.index("pressure"), EVERY_POISSON
        found[key] = plane_peaks(contact.pressure / layer.effective_modulus, grid)
    return _dataset(contact, depths, ratios, quantities, found, references, points, mean, largest)


class _Reference:
    """The plane of the largest von Mises stress so far, and the covariance of other planes with it."""

    def __init__(self, planes: int, threads: int, work: Work) -> None:
        self.number, self.largest = -1, -np.inf
        self.covariance = np.full(planes, np.nan)
        self.grid: Grid | None = None
        self.field: Array | None = None
        self._threads, self._work = threads, work
        self._modes: tuple[Grid, Array] | None = None
        self._shown: tuple[Grid, Array] | None = None

    def add(self, number: int, grid: Grid, field: Array, largest: float) -> float:
        """The next plane downward; it becomes the reference if its largest value is the largest."""
        if largest > self.largest:
            self.number, self.largest, self.grid, self.field = number, largest, grid, field
            self._modes = self._shown = None
        return self.compare(number, grid, field)

    def compare(self, number: int, grid: Grid, field: Array) -> float:
        """Covariance of a plane with the reference, and its mean."""
        own = self.field if self._shown is None or self._shown[0] != grid else self._shown[1]
        assert own is not None
        mean_own, mean, product = _moments(own, field)
        self.covariance[number] = product - mean_own * mean
        return mean

    def show_on(self, grid: Grid) -> None:
        """Make ready the reference on the modes of another grid."""
        if self.grid is None or self.field is None or grid == self.grid:
            self._shown = None
        elif self._shown is None or self._shown[0] != grid:
            if self._modes is None or np.any(np.array(grid.shape) > self._modes[0].shape):
                fourier = Fourier(self.grid, threads=self._threads, work=self._work)
                self._modes = self.grid, fourier.forward(self.field)
            # Grids become coarser: what this one does not hold is not needed again.
            self._modes = grid, resample(self._modes[1], self._modes[0], grid)
            self._shown = grid, Fourier(grid, threads=self._threads, work=self._work).inverse(self._modes[1])


@njit(cache=True, error_model="numpy", nogil=True)
def _moments(one: Any, two: Any) -> tuple[float, float, float]:
    """Means of two fields and of their product, summed row by row."""
    mean_one = mean_two = product = 0.0
    for j in range(one.shape[0]):
        row_one = row_two = row_product = 0.0
        for i in range(one.shape[1]):
            row_one += one[j, i]
            row_two += two[j, i]
            row_product += one[j, i] * two[j, i]
        mean_one += row_one
        mean_two += row_two
        product += row_product
    return mean_one / one.size, mean_two / one.size, product / one.size


def _dataset(
    contact: Contact,
    depths: Array,
    ratios: list[float],
    quantities: Sequence[str],
    found: dict[tuple[int, int], Peaks],
    references: list[_Reference],
    points: Array,
    mean: Array,
    largest: Array,
) -> xr.Dataset:
    sizes = [peaks.size for peaks in found.values()]

    def column(name: str) -> Array:
        return np.concatenate([getattr(peaks, name) for peaks in found.values()])

    under = [peaks.under_contact(contact.pressure, contact.grid) for peaks in found.values()]
    planes = []
    for reference in references:
        assert reference.grid is not None
        assert reference.field is not None
        lag, covariance = autocorrelation(reference.field, reference.grid, contact.grid)
        planes.append(covariance)
    return xr.Dataset(
        {
            "peak_quantity": ("peak", np.repeat([q for q, _ in found], sizes).astype(np.int16)),
            "peak_poisson": ("peak", np.repeat([nu for _, nu in found], sizes).astype(np.int16)),
            "peak_value": ("peak", column("value")),
            "peak_depth": ("peak", column("depth")),
            "peak_y": ("peak", column("y")),
            "peak_x": ("peak", column("x")),
            "peak_interior": ("peak", column("interior").astype(np.int8)),
            "peak_under_contact": ("peak", np.concatenate(under).astype(np.int8)),
            "plane_depth": ("plane", depths),
            "plane_points": ("plane", points),
            "mean_von_mises": (("poisson", "plane"), mean),
            "largest_von_mises": (("poisson", "plane"), largest),
            "covariance_depth": (("poisson", "plane"), np.stack([r.covariance for r in references])),
            "covariance_plane": (("poisson", "lag"), np.stack(planes)),
            "reference_depth": ("poisson", depths[[r.number for r in references]]),
        },
        coords={"quantity": list(quantities), "poisson": ratios, "lag": lag},
    )
