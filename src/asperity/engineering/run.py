"""All stages from a map to an answer: read, press, stress, yield, resolution. One pure function each.

Accuracy is that of the settings below. The largest error of the numbers is usually that of the map, whose
roughness goes on below its pixels; `coarse_numbers` measures its size with a second solution at half the
resolution.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from asperity.contact import Contact, solve
from asperity.elasticity.layer import Layer
from asperity.engineering.answer import Answer, BodyAnswer, ContactNumbers, Numbers
from asperity.engineering.case import Body, Case, Load
from asperity.engineering.indenter import Indenter, MapSettings, read_indenter
from asperity.spectral import Fourier, Grid, resample
from asperity.stress.analysis import analyse_stress
from asperity.stress.depths import depth_grid
from asperity.stress.patches import contact_patches
from asperity.stress.planes import stress_planes
from asperity.stress.pressed import PressedSolid
from asperity.stress.selection import peaks
from asperity.surface.height_map import HeightMap
from asperity.surface.roughness import roughness_parameters
from asperity.types import Array, Progress

CONTACT_TOLERANCE = 1e-6
"""Error of the pressure relative to its norm."""

STRESS_TOLERANCE = 1e-4
"""Error of a deep plane on a coarser grid, relative to the rms of σ_zz in it."""

DEPTH_SPACING, DEPTH_GROWTH = 0.5, 0.125
"""Distance of the planes near the surface in grid spacings, and farther down over their depth."""

QUANTITIES = ("pressure", "von_mises", "xx", "zz", "xz")
"""Quantities whose peaks are found."""

TRACTION_DIRECTION = {"lower": 0.0, "upper": 180.0}
"""Direction of the shear traction on each body, in degrees from x: they are opposite to each other."""

STAGES = {"map": 0.1, "contact": 0.4, "stress": 0.35, "resolution": 0.15}
"""Share of each stage in the time of a run, for the progress bar."""


@dataclass(frozen=True)
class StressInBody:
    """Stress in one body.

    Parameters
    ----------
    dataset : dataset
        As of `analyse_stress`, in Pa and m.
    above_yield : (planes,) array or None
        Share of each plane whose von Mises stress is above yield; None without a yield stress.
    """

    dataset: xr.Dataset
    above_yield: Array | None


def run(
    source: str | os.PathLike[str] | HeightMap,
    lower: Body,
    upper: Body | None = None,
    *,
    mean_pressure: float | None = None,
    force: float | None = None,
    approach: float | None = None,
    area_fraction: float | None = None,
    friction: float = 0.0,
    map_settings: MapSettings | None = None,
    progress: Progress | None = None,
) -> Answer:
    """Press a measured surface against a flat body and analyse the stress in every elastic body.

    Exactly one of `mean_pressure`, `force`, `approach` and `area_fraction` is given. All numbers are in SI
    units.

    Parameters
    ----------
    source : path or HeightMap
        File of a map, or a map in metres.
    lower : Body
    upper : Body, optional
        By default the other body is rigid. Which of the two is rough does not matter as long as the slopes
        are small.
    mean_pressure : float
        Load over the nominal area, in Pa.
    force : float
        Load on the area of the map, in N.
    approach : float
        Approach of the bodies since their first touch, in m.
    area_fraction : float
        Real over nominal contact area.
    friction : float
        Coefficient of full sliding along x, for the stress; see `Case`.
    map_settings : MapSettings, optional
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Answer

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range or the map cannot be used.
    ConvergenceError
        If the contact does not converge.

    Examples
    --------
    A rough surface of 0.2 mm, made here instead of read from a file, on steel under 50 MPa:

    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> steel = Body(young=210e9, poisson=0.3, yield_stress=1.5e9)
    >>> answer = run(surface, steel, mean_pressure=50e6)
    >>> print(f"real contact {100 * answer.numbers.area_fraction:.1f} % of the area")
    real contact 5.4 % of the area
    >>> lower = answer.bodies["lower"]
    >>> print(f"{lower.largest_von_mises / 1e9:.2f} GPa at a depth of {lower.depth * 1e6:.1f} µm")
    1.58 GPa at a depth of 3.4 µm
    """
    load = Load.chosen(
        {
            "mean_pressure": mean_pressure,
            "force": force,
            "approach": approach,
            "area_fraction": area_fraction,
        }
    )
    case = Case(lower, upper, load, friction)
    report = _Stages(progress)
    settings = map_settings or MapSettings()
    indenter = read_indenter(source, settings)
    contact = press(indenter, case, report.stage("contact"))
    bodies = {}
    for body, share in _shared(report.stage("stress"), list(case.bodies)):
        bodies[body] = stress_in(contact, case, body, share)
    coarse = coarse_numbers(indenter, case, report.stage("resolution"))
    answer = assemble(indenter, case, settings, contact, bodies, coarse)
    report.finish()
    return answer


def press(indenter: Indenter, case: Case, progress: Progress | None = None) -> Contact:
    """The contact of the case."""
    load = case.load
    imposed = {load.kind: load.value}
    if load.kind == "force":
        imposed = {"mean_pressure": load.value / indenter.map_area}
    elif load.kind == "approach":
        imposed = {"approach": float(indenter.height.min()) + load.value}
    return solve(
        indenter.height,
        case.solid,
        indenter.grid.length,
        boundary=indenter.boundary,
        rtol=CONTACT_TOLERANCE,
        progress=progress,
        **imposed,  # type: ignore[arg-type]
    )


def stress_in(contact: Contact, case: Case, name: str, progress: Progress | None = None) -> StressInBody:
    """Stress in one body under the contact pressure, with its own modulus and Poisson's ratio, in Pa."""
    body = case.bodies[name]
    scaled, modulus = scaled_solid(contact, body)
    sliding = {"friction": case.friction, "sliding_direction": TRACTION_DIRECTION[name]}
    depths = depth_grid(contact.grid, body.height, DEPTH_SPACING, DEPTH_GROWTH)
    dataset = analyse_stress(
        scaled,
        depths,
        quantities=QUANTITIES,
        tolerance=STRESS_TOLERANCE,
        progress=progress,
        **sliding,  # type: ignore[arg-type]
    )
    above = None
    if body.yield_stress is not None:
        planes = stress_planes(
            scaled,
            depths,
            fields=("von_mises",),
            tolerance=STRESS_TOLERANCE,
            **sliding,  # type: ignore[arg-type]
        )
        limit = body.yield_stress / modulus
        above = np.array([np.mean(plane.fields["von_mises"] > limit) for plane in planes])
    return StressInBody(in_pascal(dataset, modulus), above)


def scaled_solid(contact: Contact, body: Body) -> tuple[PressedSolid, float]:
    """A body under the contact pressure in units of its E*, and that E* in Pa.

    Stresses are computed in these units, in which they are at most of order one.
    """
    modulus = body.layer.effective_modulus
    layer = Layer(1 - body.poisson**2, body.poisson, body.height, body.bottom)
    return PressedSolid(contact.pressure / modulus, contact.grid, layer, contact.boundary), modulus


def in_pascal(dataset: xr.Dataset, modulus: float) -> xr.Dataset:
    """A stress dataset in units of a modulus as one in Pa."""
    squared = ("covariance_depth", "covariance_plane")
    stresses = {"peak_value": 1, "mean_von_mises": 1, "largest_von_mises": 1, **dict.fromkeys(squared, 2)}
    return dataset.assign({name: dataset[name] * modulus**power for name, power in stresses.items()})


def coarse_numbers(indenter: Indenter, case: Case, progress: Progress | None = None) -> Numbers:
    """The main numbers of the case with pixels twice as large, under the same load."""
    halved = _halved(indenter)
    contact = press(halved, case, progress)
    stress = stress_in(contact, replace(case, lower=replace(case.lower, yield_stress=None)), "lower")
    return main_numbers(contact, stress.dataset)


def _halved(indenter: Indenter) -> Indenter:
    """The surface with pixels twice as large: its long waves, or every second node with a free boundary."""
    grid = indenter.grid
    if indenter.boundary == "free":
        height = indenter.height[::2, ::2]
        length = tuple(2 * step * nodes for step, nodes in zip(grid.spacing, height.shape, strict=True))
        coarse = Grid((height.shape[0], height.shape[1]), length)
    else:
        coarse = Grid((max(grid.shape[0] // 2, 4), max(grid.shape[1] // 2, 4)), grid.length)
        height = Fourier(coarse).inverse(resample(Fourier(grid).forward(indenter.height), grid, coarse))
    return replace(indenter, height=height, grid=coarse)


def main_numbers(contact: Contact, stress: xr.Dataset) -> Numbers:
    """The numbers whose change with the resolution is reported."""
    found = np.abs(peaks(stress, "von_mises", selection="under_contact")["peak_value"].values)
    return Numbers(
        area_fraction=contact.area_fraction,
        largest_pressure=float(contact.pressure.max()),
        largest_von_mises=float(stress["largest_von_mises"].max()),
        peaks_90=float(np.percentile(found, 90)) if found.size else float("nan"),
        peaks_99=float(np.percentile(found, 99)) if found.size else float("nan"),
    )


def assemble(
    indenter: Indenter,
    case: Case,
    settings: MapSettings,
    contact: Contact,
    stresses: dict[str, StressInBody],
    coarse: Numbers,
) -> Answer:
    """The answer from the results of all stages."""
    return Answer(
        indenter=indenter,
        case=case,
        map_settings=settings,
        contact=contact,
        numbers=contact_numbers(indenter, contact),
        bodies={name: body_answer(case.bodies[name], stress, indenter) for name, stress in stresses.items()},
        stresses={name: stress.dataset for name, stress in stresses.items()},
        fine=main_numbers(contact, stresses["lower"].dataset),
        coarse=coarse,
    )


def contact_numbers(indenter: Indenter, contact: Contact) -> ContactNumbers:
    """Numbers of the contact: areas, pressures, patches."""
    touching = contact.pressure > 0
    patch, radii = contact_patches(touching)
    nodes = np.bincount(patch.ravel())[1:]
    carried = np.bincount(patch.ravel(), contact.pressure.ravel().astype(float))[1:]
    area = contact.area_fraction * indenter.map_area
    force = contact.mean_pressure * indenter.map_area
    roughness = roughness_parameters(indenter.height, indenter.grid.length)
    return ContactNumbers(
        nominal_area=indenter.map_area,
        area_fraction=contact.area_fraction,
        contact_area=area,
        nominal_pressure=contact.mean_pressure,
        mean_pressure=force / area if area else 0.0,
        largest_pressure=float(contact.pressure.max()),
        force=force,
        approach=contact.approach - float(contact.height.min()),
        mean_gap=float(contact.gap.mean(dtype=float)),
        rms_height=roughness.rms_height,
        peak_to_valley=float(np.ptp(indenter.height)),
        rms_gradient=roughness.rms_gradient,
        gradient_rms_contact=contact.gradient_rms_contact,
        contact_nodes=int(np.count_nonzero(touching)),
        patches=int(radii.size),
        typical_patch_nodes=_load_median(nodes, carried),
        load_of_largest_node=float(contact.pressure.max() / max(contact.pressure.sum(dtype=float), 1e-300)),
        load_on_small_patches=float(carried[nodes <= 4].sum() / max(carried.sum(), 1e-300)),
        load_on_edges=_load_on_edges(contact.pressure),
        violation=contact.certificate.worst,
    )


def _load_on_edges(pressure: Array) -> float:
    """Share of the load on the outermost nodes."""
    total = float(pressure.sum(dtype=float))
    return 1 - float(pressure[1:-1, 1:-1].sum(dtype=float)) / total if total else 0.0


def _load_median(nodes: Array, carried: Array) -> float:
    """Number of nodes of a patch such that larger patches carry half of the load."""
    if not nodes.size:
        return 0.0
    order = np.argsort(nodes)
    share = np.cumsum(carried[order]) / carried.sum()
    return float(nodes[order][np.searchsorted(share, 0.5)])


def body_answer(body: Body, stress: StressInBody, indenter: Indenter) -> BodyAnswer:
    """Numbers of the stress in one body."""
    dataset = stress.dataset
    found = peaks(dataset, "von_mises")
    size = np.abs(found["peak_value"].values)
    under = np.abs(peaks(dataset, "von_mises", selection="under_contact")["peak_value"].values)
    if size.size:
        top = found.isel(peak=int(np.argmax(size)))
        y, x = indenter.on_map(float(top["peak_y"]), float(top["peak_x"]))
        place = [float(top["peak_depth"]), y, x]
        largest = float(size.max())
    else:
        place, largest = [float("nan")] * 3, float(dataset["largest_von_mises"].max())
    percentiles = {
        percent: float(np.percentile(under, percent)) if under.size else float("nan")
        for percent in (50, 90, 99)
    }
    share = stress.above_yield
    depths = dataset["plane_depth"].values
    volume, bounds, fraction = None, None, None
    if share is not None:
        volume = float(np.trapezoid(share, depths)) * indenter.map_area
        above = np.flatnonzero(share)
        if above.size:
            bounds = float(depths[above[0]]), float(depths[above[-1]])
            fraction = volume / (indenter.map_area * bounds[1]) if bounds[1] else 0.0
    return BodyAnswer(
        body=body,
        largest_von_mises=largest,
        depth=place[0],
        y=place[1],
        x=place[2],
        peak_percentiles=percentiles,
        peak_count=int(under.size),
        volume_above_yield=volume,
        depths_above_yield=bounds,
        fraction_above_yield=fraction,
    )


class _Stages:
    """Progress of a run over its stages."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress

    def stage(self, name: str) -> Progress:
        """Progress of one stage."""
        names = list(STAGES)
        begin = sum(STAGES[other] for other in names[: names.index(name)])
        return self._between(begin, begin + STAGES[name])

    def finish(self) -> None:
        """Report that all is done."""
        if self._progress is not None:
            self._progress(1.0, 1.0)

    def _between(self, begin: float, end: float) -> Callable[[float, float], None]:
        def report(done: float, total: float) -> None:
            if self._progress is not None:
                self._progress(begin + (end - begin) * (done / total if total else 1.0), 1.0)

        return report


def _shared(progress: Progress, names: list[str]) -> list[tuple[str, Progress]]:
    """Names with equal shares of a progress."""

    def part(number: int) -> Progress:
        return lambda done, total: progress(number + (done / total if total else 1.0), len(names))

    return [(name, part(number)) for number, name in enumerate(names)]
