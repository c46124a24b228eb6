"""Analysis of the stress in the whole solid in one stream of planes: peaks, depth profile, covariances.

A plane is computed, reduced and discarded: its fields are searched for peaks, and its von Mises stress gives
one point of the depth profile and the covariance of Eq. 22 with the reference plane, that of the largest von
Mises stress. The reference plane is known only when the stream has ended. The plane with the largest value so
far is kept, and the few planes above the final reference are computed again.

The condition of the uniform mode (`Layer.lateral`) adds a constant to σ_xx and σ_yy and changes nothing of
the contact. `analyse_lateral_conditions` analyses several conditions in the same stream.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from asperity import accessor
from asperity.elasticity.layer import LATERALS
from asperity.engines import current_engine
from asperity.finite import require_finite
from asperity.spectral import Work
from asperity.stress.arguments import (
    FIELDS,
    boundary_of,
    checked_contact,
    checked_depths,
    checked_floor,
    checked_names,
    checked_nodes,
    checked_ratios,
    checked_sliding,
    checked_threads,
    checked_tolerance,
)
from asperity.stress.covariance import References
from asperity.stress.depths import depth_grid
from asperity.stress.peak_finder import PeakFinder
from asperity.stress.peaks import plane_peaks
from asperity.stress.periodic import Visit
from asperity.stress.plane_maxima import Maxima, SearchedPlane
from asperity.stress.planes import LinearPlane, Watch, linear_planes
from asperity.stress.pressed import ContactLike, PressedSolid
from asperity.stress.refinement import Peaks
from asperity.stress.search import PlaneSearch, SoughtField
from asperity.stress.selection import peak_dataset
from asperity.types import Array, Progress

accessor.register()

QUANTITIES = ("pressure", *FIELDS)
"""Quantities whose peaks can be sought."""

INDEPENDENT_OF_POISSON = ("zz", "yz", "xz")
"""Fields that are the same for every Poisson's ratio in a half-space."""

INDEPENDENT_OF_LATERAL = ("zz", "yz", "xz", "xy")
"""Fields that are the same for every condition of the uniform mode."""

ROUNDING = 1e-12
"""Maxima below this share of the root mean square of σ_zz of their plane are rounding."""


def analyse_stress(
    contact: ContactLike,
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = ("pressure", "von_mises", "xx", "zz", "xz"),
    *,
    tolerance: float = 1e-6,
    floor: float = 0.01,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    observe: Callable[[LinearPlane], None] | None = None,
) -> xr.Dataset:
    """Peaks, depth profile and covariances of the stress under a contact.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
        A `Contact`, or a `PressedSolid` with any finite pressure.
    depths : (planes,) array, optional
        Rising from 0, the surface; by default those of `depth_grid`, down to the bottom of the layer.
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
        Called with every plane of the stream, a `asperity.stress.planes.LinearPlane`, from the surface
        downward, for numbers that are not in the result. It must not keep the plane.

    Returns
    -------
    dataset
        Stresses in the unit of the contact pressure. Along `peak`, one entry for each peak of each quantity
        and Poisson's ratio: `asperity.peaks` selects from them. Along `plane`, the mean and largest von Mises
        stress, and the covariance with the plane of the largest. Along `lag`, the covariance in that plane.
        The attribute ``effective_modulus`` is E* in the same unit, ``friction`` and ``sliding_direction`` are
        the arguments.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact, poisson=[0.0, 0.3, 0.5], quantities=("von_mises", "zz"))
    >>> deepest = stress["largest_von_mises"].sel(poisson=0.3).argmax("plane")
    >>> bool(0 < stress["plane_depth"][deepest] < 0.05)  # the largest stress lies below the surface
    True
    >>> print(*stress["quantity"].values)
    von_mises zz
    """
    own = contact.layer.lateral
    return analyse_lateral_conditions(
        contact,
        (own,),
        depths,
        poisson,
        quantities,
        tolerance=tolerance,
        floor=floor,
        threads=threads,
        progress=progress,
        work=work,
        friction=friction,
        sliding_direction=sliding_direction,
        observe=observe,
    )[own]


def analyse_lateral_conditions(
    contact: ContactLike,
    laterals: Sequence[str],
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = ("pressure", "von_mises", "xx", "zz", "xz"),
    *,
    tolerance: float = 1e-6,
    floor: float = 0.01,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    observe: Callable[[LinearPlane], None] | None = None,
) -> dict[str, xr.Dataset]:
    """The analysis of `analyse_stress` for several conditions of the uniform mode, in one stream of planes.

    Parameters
    ----------
    laterals : sequence of names
        Conditions as of `Layer.lateral`, among them that of the contact's layer.
    contact, depths, poisson, quantities, tolerance, floor, threads, progress, work
        As for `analyse_stress`.
    friction, sliding_direction, observe
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
    laterals = checked_names("laterals", laterals, LATERALS)
    if contact.layer.lateral not in laterals:
        raise ValueError(
            f"laterals = {list(laterals)!r}: {contact.layer.lateral!r}, the layer's, must be one of them"
        )
    pressure, _ = checked_contact(contact)
    if depths is None:
        depths = depth_grid(contact.grid, contact.layer.height)
    settings = _Settings(
        depths=checked_depths(depths, contact),
        ratios=checked_ratios(poisson, contact.layer),
        quantities=checked_names("quantities", quantities, QUANTITIES),
        tolerance=checked_tolerance(tolerance),
        floor=checked_floor(floor),
        threads=checked_threads(threads),
        work=Work() if work is None else work,
        friction=friction,
        sliding_direction=sliding_direction,
    )
    checked_sliding(friction, sliding_direction, contact.layer)
    if settings.depths[0] != 0:
        raise ValueError(f"depths[0] = {settings.depths[0]:g}: 0, the surface, is needed")
    checked_nodes(contact.grid)
    analysis = _StressAnalysis(
        PressedSolid(pressure, contact.grid, contact.layer, boundary_of(contact)), settings, laterals
    )
    analysis.run(progress, observe)
    found = {lateral: _dataset(analysis, lateral) for lateral in laterals}
    for dataset in found.values():
        require_finite("analyse_stress", dataset.data_vars)
    return found


@dataclass(frozen=True)
class _Settings:
    """Checked arguments of `analyse_stress`."""

    depths: Array
    ratios: list[float]
    quantities: tuple[str, ...]
    tolerance: float
    floor: float
    threads: int
    work: Work
    friction: float
    sliding_direction: str | float


class _StressAnalysis:
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

    def __init__(self, contact: ContactLike, settings: _Settings, laterals: Sequence[str]) -> None:
        self.contact, self.settings = contact, settings
        boundary = boundary_of(contact)
        names = [name for name in settings.quantities if name not in ("pressure", "von_mises")]
        own_first = dict.fromkeys((contact.layer.lateral, *laterals))
        kinds = product(("von_mises", "zz", *names), own_first, settings.ratios)
        fields = dict.fromkeys(self.field(*kind) for kind in kinds)
        self.von_mises = [field for field in fields if field.name == "von_mises"]
        self._search = PlaneSearch(list(fields), boundary == "periodic")
        self._finders = {field: PeakFinder(boundary) for field in fields if field.sought}
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
        nothing = np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
        upper = [
            self._finders[field].candidates if field.sought else nothing for field in self._search.fields
        ]
        self._search.start(plane, self._last, upper, floor, self.references.on(plane))
        return self._search.add_rows

    def _add(self, number: int, plane: LinearPlane) -> None:
        search, grid, last = self._search, plane.grid, self._last
        compared = last is not None and last.grid == grid
        search.finish()
        self._last = plane
        self.points[number] = max(grid.shape)
        self.references.add(number, plane, search.sums)
        count = len(self.von_mises)
        self.mean[:, number] = search.sums[:count, :, 0].sum(axis=1) / grid.size
        self.largest[:, number] = search.sums[:count, :, 2].max(axis=1)
        scale = np.sqrt(search.sums[count, :, 1].sum() / grid.size)
        floor = max(plane.bound, self.settings.floor * scale, ROUNDING * scale)
        parts, periodic = plane.parts(), boundary_of(self.contact) == "periodic"
        every = zip(search.fields, search.maxima, search.lower, strict=True)
        for field, (nodes, here, above), lower in every:
            if field.sought:
                high = np.flatnonzero(np.abs(here[:, 1, 1]) > floor)
                maxima = Maxima.at(nodes[high], here[high], grid, above[high] if compared else None)
                searched = SearchedPlane(plane.depth, grid, parts, field.compiled(plane), periodic)
                self._finders[field].add_maxima(searched, maxima, lower if compared else None)

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
                found[name, label] = self._finders[self.field(name, lateral, ratio)].peaks()
        return found


def _dataset(analysis: _StressAnalysis, lateral: str) -> xr.Dataset:
    """The dataset of a finished analysis under one condition of the uniform mode."""
    settings, contact, references = analysis.settings, analysis.contact, analysis.references
    fields = [analysis.field("von_mises", lateral, ratio) for ratio in settings.ratios]
    own = [analysis.von_mises.index(field) for field in fields]
    lag, in_plane = references.in_plane()
    profiles = ("poisson", "plane")
    variables = {
        "plane_points": ("plane", analysis.points),
        "mean_von_mises": (profiles, analysis.mean[own]),
        "largest_von_mises": (profiles, analysis.largest[own]),
        "covariance_depth": (profiles, references.covariance[own]),
        "covariance_plane": (("poisson", "lag"), in_plane[own]),
        "reference_depth": ("poisson", settings.depths[references.number[own]]),
    }
    coordinates = {
        "quantity": list(settings.quantities),
        "poisson": settings.ratios,
        "plane_depth": ("plane", settings.depths),
        "lag": lag,
    }
    found = peak_dataset(analysis.peaks(lateral), contact).assign(variables).assign_coords(coordinates)
    return found.assign_attrs(
        effective_modulus=contact.layer.effective_modulus,
        friction=float(settings.friction),
        sliding_direction=settings.sliding_direction,
        fft_engine=current_engine().description,
    )
