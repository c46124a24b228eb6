"""Analysis of the stress in the whole solid in one stream of planes: peaks, depth profile, covariances.

A plane is computed, reduced and discarded: its fields are searched for peaks, and its von Mises stress gives
one point of the depth profile and, where it is asked for, the covariance of Eq. 22 with the reference plane,
which has the maximum von Mises stress. The reference plane is known only when the stream has ended: the
planes above it are kept, or computed again.

On a mirrored map planes cover the map alone. Where the stress is no mirror image (`PlaneStream.solid`),
planes, profile, covariances and peaks cover the whole cell.

The condition of the mean (q = 0) mode (`Solid.lateral`) adds a constant to σ_xx and σ_yy and changes nothing
of the contact. `analyse_lateral_conditions` analyses several conditions in the same stream.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from asperity.core.arguments import choices, own_errors, require_finite
from asperity.core.parallel import KeptArrays
from asperity.core.types import Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.elasticity.solid import SMALLEST_IN_PASCAL
from asperity.fourier import current_engine
from asperity.fourier.grid import Work
from asperity.stress.peaks.finder import (
    PeakFinder,
    Peaks,
    SearchedPlane,
    check_nodes,
    checked_floor,
    plane_peaks,
)
from asperity.stress.peaks.search import PlaneSearch
from asperity.stress.planes.fields import FIELDS, PlaneFields, Visit
from asperity.stress.planes.planes import default_depths
from asperity.stress.planes.stream import PLANE_TOLERANCE, LinearPlane, PlaneStream, uniform_part
from asperity.stress.statistics.covariance import References

QUANTITIES = ("pressure", *FIELDS)
"""Quantities whose peaks can be sought."""

SOUGHT = ("pressure", "von_mises", "xx", "zz", "xz")
"""Quantities whose peaks are sought by default."""

INDEPENDENT_OF_POISSON = ("zz", "yz", "xz")
"""Fields that are the same for every Poisson's ratio in a half-space."""

INDEPENDENT_OF_LATERAL = ("zz", "yz", "xz", "xy")
"""Fields that are the same for every condition of the mean mode."""

ROUNDING_SHARE = 1e-12
"""Maxima below this fraction of the root mean square of σ_zz of their plane are rounding errors."""

PLASTIC_CONTACT = (
    "the hardness limits the pressure; the stress under it is elastic, without plastic strain and residual "
    "stress"
)
"""Attribute ``plastic_contact`` of a stress under a contact that reaches its hardness."""


@own_errors
def analyse_stress(
    contact: ContactLike,
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = SOUGHT,
    *,
    tolerance: float = PLANE_TOLERANCE,
    floor: float = 0.01,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    observe: Callable[[LinearPlane], None] | None = None,
    covariances: bool = False,
) -> xr.Dataset:
    """Peaks and depth profile of the stress under a contact.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
        A `Contact`, or a `LoadedSolid` with any finite pressure.
    depths : (planes,) array, optional
        Rising from 0, the surface; by default from `depth_grid`, down to the bottom of the layer, and below
        to where a background has its maximum stresses.
    poisson, tolerance, threads, work, friction, sliding_direction
        As for `stress_planes`.
    quantities : names
        Quantities whose peaks are sought: any field of `stress_planes`, above its 26 neighbours in the solid,
        and ``pressure``, above its 8 neighbours in the surface.
    floor : float
        Peaks below `floor` times the root mean square of σ_zz of their plane are left out: most of them
        are ripples of the interpolated pressure between the nodes, away from the contacts.
    progress : callable, optional
        Called as progress(done, total).
    observe : callable, optional
        Called with every plane of the stream, an `asperity.stress.planes.stream.LinearPlane`, from the
        surface downward, for numbers that are not in the result. It must not keep the plane.
    covariances : bool
        True for the covariances of the von Mises stress (Eq. 22), from which `asperity.continuum_limit` and
        `asperity.stress.pool_peaks` find decay lengths. They take a tenth of the time.

    Returns
    -------
    dataset
        Stresses in the unit of the contact pressure. Along `peak`, one entry for each peak of each quantity
        and Poisson's ratio: `asperity.stress.select_peaks` selects from them. Along `plane`, the mean and
        maximum von Mises stress and, with `covariances`, the covariance with the plane of the largest; along
        `lag`, the covariance in that plane. The attribute ``effective_modulus`` is E* in the same unit,
        ``friction`` and ``sliding_direction`` are the arguments; ``plastic_contact``, where the pressure
        reaches the hardness, states the consequence. Of a mirrored map places are on the map, and
        ``peak_weight`` is the number of peaks that an entry counts for: 1/2 on a mirror line, 1/4 at a
        corner. Under friction the profile, the covariances and the peaks cover the map and its three images,
        which all slide the same way, and `observe` gets planes of this cell: ``peak_weight`` is 1/4, and
        ``peak_on_image`` is true for peaks of an image that seen from the map slides in another direction.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact, poisson=[0.0, 0.3, 0.5], quantities=("von_mises", "zz"))
    >>> deepest = stress["maximum_von_mises"].sel(poisson=0.3).argmax("plane")
    >>> bool(0 < stress["plane_depth"][deepest] < 0.05)  # the largest stress lies below the surface
    True
    >>> print(*stress["quantity"].values)
    von_mises zz
    """
    solid = LoadedSolid.of(contact)
    own = solid.layer.lateral
    if depths is None:
        depths = default_depths(solid)
    settings = tolerance, threads, work, friction, sliding_direction
    stream = PlaneStream(solid, depths, poisson, ("von_mises",), *settings)
    return _Analysis(stream, (own,), quantities, floor, covariances).run(progress, observe)[own]


def analyse_lateral_conditions(
    contact: ContactLike,
    laterals: Sequence[str],
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = SOUGHT,
    *,
    tolerance: float = PLANE_TOLERANCE,
    progress: Progress | None = None,
) -> dict[str, xr.Dataset]:
    """The analysis of `analyse_stress`, with covariances, for several conditions of the mean mode.

    Parameters
    ----------
    laterals : sequence of names
        Conditions as of `Solid.lateral`.
    contact, depths, poisson, quantities, tolerance, progress
        As for `analyse_stress`.

    Returns
    -------
    dict
        Condition → dataset as of `analyse_stress`.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.
    """
    stream = PlaneStream(contact, depths, poisson, ("von_mises",), tolerance)
    return _Analysis(stream, laterals, quantities, 0.01, True).run(progress, None)


class _Field(NamedTuple):
    """A field that is computed in every plane.

    The uniform parts over the mean pressure are given for each of `Solid.parts`.
    """

    name: str
    poisson: float
    uniform: tuple[float, ...]


class _Analysis:
    """Analysis of the stress under one contact, plane by plane.

    The fields are the von Mises stresses, σ_zz, whose root mean square is the scale of the floor, and the
    others that are searched, each different one once.
    """

    def __init__(
        self,
        stream: PlaneStream,
        laterals: Sequence[str],
        quantities: Sequence[str],
        floor: float,
        covariances: bool,
    ) -> None:
        solid, depths = stream.solid, stream.depths
        self._stream, self._laterals = stream, laterals
        self._quantities = choices("quantities", quantities, QUANTITIES)
        self._floor = checked_floor(floor)
        if depths[0] != 0:
            raise ValueError(f"depths[0] = {depths[0]:g}: 0, the surface, is needed")
        check_nodes(solid.grid)
        names = [name for name in self._quantities if name not in ("pressure", "von_mises")]
        own_first = dict.fromkeys((solid.layer.lateral, *laterals))
        kinds = product(("von_mises", "zz", *names), own_first, stream.ratios)
        self._fields = list(dict.fromkeys(self._field(*kind) for kind in kinds))
        self._sought = np.array([field.name in self._quantities for field in self._fields])
        count = self._von_mises = sum(field.name == "von_mises" for field in self._fields)
        self._finder = PeakFinder(stream.threads)
        self._search: PlaneSearch | None = None
        self._kept = KeptArrays()
        self._mean, self._largest = np.zeros((2, count, depths.size))
        self._references: References | None = None
        if covariances:
            kinds_of = stream.dtype, stream.keeps_planes, stream.threads, stream.work
            self._references = References(count, depths.size, solid.grid, *kinds_of)
        self._points = np.zeros(depths.size, np.int64)
        self._finest: list[LinearPlane] = []  # planes on the grid of the contact, while they may be missing

    def _field(self, name: str, lateral: str, poisson: float) -> _Field:
        """A field under one condition of the mean mode, the same one where both give the same stress."""
        layer = self._stream.solid.layer
        if self._is_alike(name):
            poisson = self._stream.ratios[0]
        if name in INDEPENDENT_OF_LATERAL:
            lateral = layer.lateral
        layer = replace(layer, lateral=lateral)
        return _Field(
            name, poisson, tuple(uniform_part(layer, poisson, depth) for depth in (*layer.interfaces, np.inf))
        )

    def _is_alike(self, name: str) -> bool:
        """True if a field is the same for every Poisson's ratio."""
        return self._stream.solid.layer.height is None and name in INDEPENDENT_OF_POISSON

    def run(
        self, progress: Progress | None, observe: Callable[[LinearPlane], None] | None
    ) -> dict[str, xr.Dataset]:
        """Take all planes, and those above the reference planes again that were not kept."""
        for number, plane in enumerate(self._stream.planes(progress, watch=self._watch)):
            search, size, count = self._search, plane.grid.size, self._von_mises
            assert search is not None
            if self._references is not None:
                if number == len(self._finest) and not self._stream.keeps_planes:
                    self._finest.append(plane)
                self._references.add(number, search.sums[:count], partial(self._fields_of, plane))
            self._points[number] = max(plane.grid.shape)
            self._mean[:, number] = search.sums[:count, :, 0].sum(axis=1) / size
            self._largest[:, number] = search.sums[:count, :, 2].max(axis=1)
            if observe is not None:
                observe(plane)
                plane.forget_fields()
            scale = np.sqrt(search.sums[count, :, 1].sum() / size)
            searched = SearchedPlane(plane.depth, plane.grid, plane.first_node, search.fields, plane.refresh)
            floor = max(plane.bound, self._floor * scale, ROUNDING_SHARE * scale)
            self._finder.add(searched, search, floor)
        self._finder.finish()
        self._search = None
        del plane, search, searched  # with the basis fields
        if self._references is not None and (missing := int(self._references.missing.max())):
            for number, _ in enumerate(self._stream.planes(count=missing, watch=self._watch_again)):
                self._compare_again(number)
            self._search = None
        found = {lateral: self._dataset(lateral) for lateral in self._laterals}
        for dataset in found.values():
            require_finite("analyse_stress", dataset.data_vars)
        return found

    def _compare_again(self, number: int) -> None:
        assert self._search is not None
        assert self._references is not None
        self._references.compare(number, self._search.sums, self._references.missing > number)

    def _fields_of(self, plane: LinearPlane, chosen: Iterable[int]) -> PlaneFields:
        names, ratios, uniforms = zip(*(self._fields[number] for number in chosen), strict=True)
        place = np.searchsorted(plane.solid.layer.interfaces, plane.depth)
        return plane.fields(names, ratios, [uniform[place] for uniform in uniforms])

    def _watch(self, plane: LinearPlane) -> Visit:
        """Search and sum the rows of a plane as they are computed."""
        references = self._references
        if references is not None and self._finest and plane.grid != self._finest[0].grid:
            # Planes on the grid of the contact are compared with the references, if these lie on that grid.
            # From then on the references need the memory of coarser grids only.
            finest, self._finest = self._finest, []
            if references.number.max() < len(finest) - 1:
                for number in range(int(references.missing.max())):
                    finest[number].refresh(self._watch_again(finest[number]))
                    self._compare_again(number)
                references.settle(plane.basis.values)
        # The floor is known when the plane is computed; until then a slightly lower one is used.
        floor = max(plane.bound, 0.99 * self._floor * plane.scale)
        fields = self._fields_of(plane, range(len(self._fields)))
        above, candidates = self._finder.plane_above(plane.depth, plane.grid)
        self._search = PlaneSearch(
            fields,
            self._sought,
            floor,
            self._von_mises + 1,
            None if references is None else references.on(plane.grid, plane.basis.values),
            self._kept,
            above if self._stream.keeps_planes else None,
            candidates,
        )
        return self._search.add_rows

    def _watch_again(self, plane: LinearPlane) -> Visit:
        """Sum the rows of a plane that is computed again."""
        assert self._references is not None
        count = self._von_mises
        fields = self._fields_of(plane, range(count))
        references = self._references.on(plane.grid, plane.basis.values)
        self._search = PlaneSearch(fields, np.zeros(count, bool), np.inf, count, references, self._kept)
        return self._search.add_rows

    def _peaks(self, lateral: str) -> dict[tuple[str, float], Peaks]:
        """Quantity and Poisson's ratio (NaN: the same for every one) → its peaks, when all planes passed."""
        found: dict[tuple[str, float], Peaks] = {}
        solid, ratios = self._stream.solid, self._stream.ratios
        for name in self._quantities:
            if name == "pressure":
                found[name, np.nan] = plane_peaks(solid.pressure, solid.grid, boundary=solid.boundary)
                continue
            labels = {np.nan: ratios[0]} if self._is_alike(name) else {ratio: ratio for ratio in ratios}
            for label, ratio in labels.items():
                found[name, label] = self._finder.peaks(self._fields.index(self._field(name, lateral, ratio)))
        if self._stream.map_grid.mirrored:  # without those of images that have the same stress
            images = {key: self._stream.images(peaks.y, peaks.x)[1] for key, peaks in found.items()}
            found = {key: peaks.select(np.flatnonzero(images[key])) for key, peaks in found.items()}
        return found

    def _dataset(self, lateral: str) -> xr.Dataset:
        """Results under one condition of the mean mode."""
        stream, solid = self._stream, self._stream.solid
        own = [self._fields.index(self._field("von_mises", lateral, ratio)) for ratio in stream.ratios]
        found = self._peaks(lateral)
        every, sizes = Peaks.join(found.values()), [peaks.size for peaks in found.values()]
        under_contact = every.under_contact(solid.pressure, solid.grid, solid.boundary)
        y, x, of_images = every.y, every.x, {}
        if stream.map_grid.mirrored:
            y, x = stream.map_grid.on_map(y, x)
            on_image, weight = stream.images(every.y, every.x)
            of_images = {"peak_on_image": ("peak", on_image), "peak_weight": ("peak", weight)}
        profiles = ("poisson", "plane")
        dataset = xr.Dataset(
            {
                "peak_value": ("peak", every.node_value if solid.is_plastic else every.value),
                "peak_depth": ("peak", every.depth),
                "peak_y": ("peak", y),
                "peak_x": ("peak", x),
                "peak_interior": ("peak", every.interior),
                "peak_under_contact": ("peak", under_contact),
                **of_images,
                "plane_points": ("plane", self._points),
                "mean_von_mises": (profiles, self._mean[own]),
                "maximum_von_mises": (profiles, self._largest[own]),
                "reference_depth": ("poisson", stream.depths[self._largest[own].argmax(axis=1)]),
            },
            coords={
                "peak_quantity": ("peak", np.repeat([name for name, _ in found], sizes)),
                "peak_poisson": ("peak", np.repeat([ratio for _, ratio in found], sizes)),
                "quantity": list(self._quantities),
                "poisson": stream.ratios,
                "plane_depth": ("plane", stream.depths),
            },
            attrs={
                "effective_modulus": solid.layer.effective_modulus,
                "friction": stream.friction,
                "sliding_direction": stream.sliding_direction,
                "fft_engine": current_engine().description,
                **({"unit_system": "SI"} if solid.layer.effective_modulus >= SMALLEST_IN_PASCAL else {}),
                **({"plastic_contact": PLASTIC_CONTACT} if solid.is_plastic else {}),
            },
        )
        if self._references is not None:
            dataset["covariance_depth"] = profiles, self._references.covariance[own]
            lag, in_plane = self._references.in_plane()
            dataset = dataset.assign_coords(lag=lag)
            dataset["covariance_plane"] = ("poisson", "lag"), in_plane[own]
        return dataset
