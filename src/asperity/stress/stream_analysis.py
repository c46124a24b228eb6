"""Peaks, depth profiles and covariances of the stress under one contact, plane by plane."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from asperity.spectral import Work
from asperity.stress.arguments import boundary_of
from asperity.stress.covariance import References
from asperity.stress.linear_plane import LinearPlane
from asperity.stress.peak_finder import PeakFinder
from asperity.stress.peaks import plane_peaks
from asperity.stress.periodic import Visit
from asperity.stress.plane_maxima import SearchedPlane
from asperity.stress.planes import Watch, linear_planes
from asperity.stress.pressed import ContactLike
from asperity.stress.refinement import Peaks
from asperity.stress.search import PlaneSearch, SoughtField
from asperity.types import Array, Progress

INDEPENDENT_OF_POISSON = ("zz", "yz", "xz")
"""Fields that are the same for every Poisson's ratio in a half-space."""

INDEPENDENT_OF_LATERAL = ("zz", "yz", "xz", "xy")
"""Fields that are the same for every condition of the uniform mode."""

ROUNDING = 1e-12
"""Maxima below this share of the root mean square of σ_zz of their plane are rounding."""


@dataclass(frozen=True)
class Settings:
    """Checked arguments of `asperity.stress.analysis.analyse_stress`."""

    depths: Array
    ratios: list[float]
    quantities: tuple[str, ...]
    tolerance: float
    floor: float
    threads: int
    work: Work
    friction: float
    sliding_direction: str | float


class StreamAnalysis:
    """Analysis of the stress under one contact, plane by plane.

    Attributes
    ----------
    von_mises : list of SoughtField
        The von Mises stress for each Poisson's ratio and condition of the uniform mode, each different one
        once.
    mean, largest : (von_mises, planes) arrays
        Its mean and largest value in each plane.
    references : References
        The planes of the largest von Mises stress.
    points : (planes,) array
        Nodes on the longer edge of each plane's grid.
    """

    def __init__(self, contact: ContactLike, settings: Settings, laterals: Sequence[str]) -> None:
        self.contact, self.settings = contact, settings
        boundary = boundary_of(contact)
        names = [name for name in settings.quantities if name not in ("pressure", "von_mises")]
        own_first = dict.fromkeys((contact.layer.lateral, *laterals))
        kinds = product(("von_mises", "zz", *names), own_first, settings.ratios)
        fields = dict.fromkeys(self.field(*kind) for kind in kinds)
        self.von_mises = [field for field in fields if field.name == "von_mises"]
        self._search = PlaneSearch(list(fields), boundary == "periodic")
        self._finder = PeakFinder(boundary)
        planes = settings.depths.size
        self.mean, self.largest = np.zeros((2, len(self.von_mises), planes))
        self.references = References(self.von_mises, planes, contact.grid, settings.threads, settings.work)
        self.points = np.zeros(planes, np.int64)
        self._last: LinearPlane | None = None

    def field(self, name: str, lateral: str, poisson: float) -> SoughtField:
        """A field under one condition of the uniform mode, the same one where both give the same stress."""
        layer = self.contact.layer
        if self.is_alike(name):
            poisson = self.settings.ratios[0]
        if name in INDEPENDENT_OF_LATERAL:
            lateral = layer.lateral
        uniform = float(replace(layer, poisson=poisson, lateral=lateral).uniform_stress()[0])
        sought, averaged = name in self.settings.quantities, name in ("von_mises", "zz")
        return SoughtField(name, poisson, uniform, sought, averaged)

    def is_alike(self, name: str) -> bool:
        """True if a field is the same for every Poisson's ratio."""
        return self.contact.layer.height is None and name in INDEPENDENT_OF_POISSON

    def run(self, progress: Progress | None, observe: Callable[[LinearPlane], None] | None) -> None:
        """Let all planes pass, and those above the reference planes again that were not kept."""
        for number, plane in enumerate(self._planes(self.settings.depths, self._watch)):
            self._add(number, plane)
            if observe is not None:
                observe(plane)
            if progress is not None:
                progress(plane.done, 1.0)
        missing = int(self.references.missing.max())
        for number, plane in enumerate(self._planes(self.settings.depths[:missing]) if missing else ()):
            self.references.add_again(number, plane)

    def _planes(self, depths: Array, watch: Watch | None = None) -> Iterator[LinearPlane]:
        settings = self.settings
        return linear_planes(
            self.contact,
            depths,
            settings.ratios,
            ("von_mises",),
            settings.tolerance,
            settings.threads,
            settings.work,
            friction=settings.friction,
            sliding_direction=settings.sliding_direction,
            watch=watch,
        )

    def _watch(self, plane: LinearPlane) -> Visit:
        """Search the rows of a plane when they are computed."""
        # The floor is known when the plane is; until then, one that is a little lower.
        floor = max(plane.bound, 0.99 * self.settings.floor * plane.scale)
        reference = self.references.on(plane)
        taken = self.references.room_for(plane)
        self._search.start(plane, self._last, self._finder.candidates, floor, reference, taken)
        return self._search.add_rows

    def _add(self, number: int, plane: LinearPlane) -> None:
        search, size = self._search, plane.grid.size
        search.finish()
        self._last = plane
        self.points[number] = max(plane.grid.shape)
        self.references.add(number, plane, search.sums)
        count = len(self.von_mises)
        self.mean[:, number] = search.sums[:count, :, 0].sum(axis=1) / size
        self.largest[:, number] = search.sums[:count, :, 2].max(axis=1)
        scale = np.sqrt(search.sums[count, :, 1].sum() / size)
        floor = max(plane.bound, self.settings.floor * scale, ROUNDING * scale)
        periodic = boundary_of(self.contact) == "periodic"
        searched = SearchedPlane(plane.depth, plane.grid, plane.parts(), search.compiled, periodic)
        self._finder.add_maxima(searched, search.maxima_above(floor), search.lower)

    @cached_property
    def _peaks_of_fields(self) -> dict[SoughtField, Peaks]:
        fields = self._search.fields
        return dict(zip(fields, self._finder.peaks_of_fields(len(fields)), strict=True))

    def peaks(self, lateral: str) -> dict[tuple[str, float], Peaks]:
        """Quantity and Poisson's ratio (NaN: the same for every one) → its peaks, when all planes passed."""
        found: dict[tuple[str, float], Peaks] = {}
        ratios = self.settings.ratios
        for name in self.settings.quantities:
            if name == "pressure":
                pressure, boundary = self.contact.pressure, boundary_of(self.contact)
                found[name, np.nan] = plane_peaks(pressure, self.contact.grid, boundary=boundary)
                continue
            labels = {np.nan: ratios[0]} if self.is_alike(name) else {ratio: ratio for ratio in ratios}
            for label, ratio in labels.items():
                found[name, label] = self._peaks_of_fields[self.field(name, lateral, ratio)]
        return found
