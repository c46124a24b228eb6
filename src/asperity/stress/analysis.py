"""Analysis of the stress in the whole solid in one stream of planes: peaks, depth profile, covariances.

A plane is computed, reduced and discarded: its fields are searched for peaks, and its von Mises stress gives
one point of the depth profile and the covariance of Eq. 22 with the reference plane, that of the largest von
Mises stress. The reference plane is known only when the stream has ended. The plane with the largest value so
far is kept, and the few planes above the final reference are computed again.

The condition of the uniform mode (`Layer.lateral`) adds a constant to σ_xx and σ_yy and changes nothing of
the contact. `analyse_lateral_conditions` analyses several conditions in the same stream.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

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
from asperity.stress.covariance import ReferencePlane
from asperity.stress.depths import depth_grid
from asperity.stress.kernels import moments
from asperity.stress.peaks import PeakFinder, Peaks, plane_peaks
from asperity.stress.planes import LinearPlane, linear_planes
from asperity.stress.pressed import ContactLike, PressedSolid
from asperity.stress.selection import peak_dataset
from asperity.stress.statistics import autocorrelation
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


class _PeakSearch:
    """Search for the peaks of fields that are the same for every Poisson's ratio.

    Parameters
    ----------
    names : sequence of str
        Fields in which peaks are sought.
    poisson : float
        Poisson's ratio with which the fields are computed.
    boundary : "periodic" | "free"
    """

    def __init__(self, names: Iterable[str], poisson: float, boundary: str) -> None:
        self.poisson = poisson
        self.finders = {name: PeakFinder(boundary) for name in names}

    def add(self, number: int, plane: LinearPlane, floor: float) -> None:
        """Add the next plane downward; maxima of a magnitude at or below `floor` are left out."""
        self._search_others(plane, floor, None)

    def _search_others(self, plane: LinearPlane, floor: float, room: Array | None) -> None:
        """Search all fields but the von Mises stress, each computed in `room`."""
        for name in self.finders:
            if name != "von_mises":
                room = plane.field(name, self.poisson, room)
                self._search(plane, name, room, floor)

    def _search(self, plane: LinearPlane, name: str, field: Array, floor: float) -> None:
        sample = partial(plane.sample, name, self.poisson)
        self.finders[name].add(plane.depth, plane.grid, field, floor, sample)


class _RatioAnalysis(_PeakSearch):
    """Analysis for one Poisson's ratio: peaks, and profile and covariance of the von Mises stress.

    Attributes
    ----------
    mean, largest : (planes,) arrays
        Mean and largest von Mises stress of each plane.
    reference : ReferencePlane
    """

    def __init__(self, names: Iterable[str], poisson: float, settings: _Settings, boundary: str) -> None:
        super().__init__(names, poisson, boundary)
        planes = settings.depths.size
        self.mean, self.largest = np.zeros(planes), np.zeros(planes)
        self.reference = ReferencePlane(planes, settings.threads, settings.work)

    def add(self, number: int, plane: LinearPlane, floor: float) -> None:
        field = plane.field("von_mises", self.poisson)
        self.largest[number] = field.max()
        self.mean[number] = self.reference.add(number, plane.grid, field, self.largest[number])
        if "von_mises" in self.finders:
            self._search(plane, "von_mises", field, floor)
        kept = self.reference.field is field
        self._search_others(plane, floor, None if kept else field)

    def add_again(self, number: int, plane: LinearPlane) -> None:
        """Add a plane above the reference for its covariance."""
        if number < self.reference.number:
            self.reference.resample_to(plane.grid)
            self.reference.compare(number, plane.grid, plane.field("von_mises", self.poisson))


class _StressAnalysis:
    """Analysis of the stress under one contact, plane by plane.

    Attributes
    ----------
    independent : _PeakSearch
        For the fields that do not depend on Poisson's ratio.
    dependent : dict
        Condition of the uniform mode, that of the contact first → an analysis for each Poisson's ratio, the
        same one where both conditions give the same stress.
    points : (planes,) array
        Nodes on the longer edge of each plane's grid.
    peaks : dict
        Condition → quantity and Poisson's ratio (NaN: the same for every one) → its peaks, when all planes
        have passed.
    """

    def __init__(self, contact: ContactLike, settings: _Settings, laterals: Sequence[str]) -> None:
        self.contact, self.settings = contact, settings
        alike = INDEPENDENT_OF_POISSON if contact.layer.height is None else ()
        fields = [name for name in settings.quantities if name != "pressure"]
        own = [name for name in fields if name not in alike]
        boundary = boundary_of(contact)
        shared = [name for name in fields if name in alike]
        self.independent = _PeakSearch(shared, settings.ratios[0], boundary)
        first = [_RatioAnalysis(own, nu, settings, boundary) for nu in settings.ratios]
        self.dependent = {contact.layer.lateral: first}
        changed = [name for name in own if name not in INDEPENDENT_OF_LATERAL]
        for lateral in laterals:
            if lateral != contact.layer.lateral:
                self.dependent[lateral] = [
                    one
                    if self._uniform(lateral, nu) == self._uniform(contact.layer.lateral, nu)
                    else _RatioAnalysis(changed, nu, settings, boundary)
                    for one, nu in zip(first, settings.ratios, strict=True)
                ]
        self.points = np.zeros(settings.depths.size, np.int64)
        self.peaks: dict[str, dict[tuple[str, float], Peaks]] = {}

    def _uniform(self, lateral: str, poisson: float) -> float:
        """Uniform part of σ_xx and σ_yy per unit mean pressure."""
        layer = replace(self.contact.layer, poisson=poisson, lateral=lateral)
        return float(layer.uniform_stress()[0])

    def _under(self, plane: LinearPlane) -> list[tuple[_RatioAnalysis, LinearPlane]]:
        """All analyses, each once, with the plane under their condition of the uniform mode."""
        found: dict[int, tuple[_RatioAnalysis, LinearPlane]] = {}
        for lateral, analyses in self.dependent.items():
            own = lateral == self.contact.layer.lateral
            uniform = {nu: plane.mean_pressure * self._uniform(lateral, nu) for nu in self.settings.ratios}
            here = plane if own else replace(plane, lateral=uniform)
            for one in analyses:
                found.setdefault(id(one), (one, here))
        return list(found.values())

    def run(self, progress: Progress | None, observe: Callable[[LinearPlane], None] | None) -> None:
        """Let all planes pass, and those above the reference planes once more."""
        with ThreadPoolExecutor(self.settings.threads) as pool:
            for number, plane in enumerate(self._planes(self.settings.depths)):
                self._add(number, plane, pool)
                if observe is not None:
                    observe(plane)
                if progress is not None:
                    progress(plane.done, 1.0)
        self._collect_peaks()
        above = max(ratio.reference.number for ratios in self.dependent.values() for ratio in ratios)
        for number, plane in enumerate(self._planes(self.settings.depths[:above]) if above else ()):
            for ratio, here in self._under(plane):
                ratio.add_again(number, here)

    def _planes(self, depths: Array) -> Iterator[LinearPlane]:
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
        )

    def _add(self, number: int, plane: LinearPlane, pool: ThreadPoolExecutor) -> None:
        self.points[number] = max(plane.grid.shape)
        normal = plane.constant["zz"]
        scale = np.sqrt(moments(normal, normal)[2])
        floor = max(plane.bound, self.settings.floor * scale, ROUNDING * scale)
        dependent = self._under(plane)
        for ratio, _ in dependent:
            ratio.reference.resample_to(plane.grid)
        searches = [(self.independent, plane), *dependent]
        list(pool.map(lambda search: search[0].add(number, search[1], floor), searches))

    def _collect_peaks(self) -> None:
        """Take the peaks from the searches, which release the last plane."""
        first, *others = self.dependent.items()
        peaks = self.peaks[first[0]] = {}
        for name in self.settings.quantities:
            if name in self.independent.finders:
                peaks[name, np.nan] = self.independent.finders.pop(name).peaks()
            elif name != "pressure":
                for ratio in first[1]:
                    peaks[name, ratio.poisson] = ratio.finders.pop(name).peaks()
        if "pressure" in self.settings.quantities:
            peaks["pressure", np.nan] = plane_peaks(
                self.contact.pressure, self.contact.grid, boundary=boundary_of(self.contact)
            )
        for lateral, ratios in others:
            self.peaks[lateral] = dict(peaks)
            for ratio in ratios:  # one that both conditions share has no finders any more
                for name in list(ratio.finders):
                    self.peaks[lateral][name, ratio.poisson] = ratio.finders.pop(name).peaks()


def _dataset(analysis: _StressAnalysis, lateral: str) -> xr.Dataset:
    """The dataset of a finished analysis under one condition of the uniform mode."""
    settings, contact, ratios = analysis.settings, analysis.contact, analysis.dependent[lateral]
    references = [ratio.reference for ratio in ratios]
    in_plane = []
    for reference in references:
        lag, covariance = autocorrelation(reference.field, reference.grid, contact.grid)
        in_plane.append(covariance)
    profiles = ("poisson", "plane")
    variables = {
        "plane_points": ("plane", analysis.points),
        "mean_von_mises": (profiles, np.stack([ratio.mean for ratio in ratios])),
        "largest_von_mises": (profiles, np.stack([ratio.largest for ratio in ratios])),
        "covariance_depth": (profiles, np.stack([reference.covariance for reference in references])),
        "covariance_plane": (("poisson", "lag"), np.stack(in_plane)),
        "reference_depth": ("poisson", settings.depths[[reference.number for reference in references]]),
    }
    coordinates = {
        "quantity": list(settings.quantities),
        "poisson": settings.ratios,
        "plane_depth": ("plane", settings.depths),
        "lag": lag,
    }
    found = peak_dataset(analysis.peaks[lateral], contact).assign(variables).assign_coords(coordinates)
    return found.assign_attrs(
        effective_modulus=contact.layer.effective_modulus,
        friction=float(settings.friction),
        sliding_direction=settings.sliding_direction,
        fft_engine=current_engine().description,
    )
