"""All stages from a map to an answer: read, press, stress, yield, resolution. One pure function each.

Accuracy is that of the settings in `press` and in `asperity.engineering.extremes`. The largest error of the
numbers is usually that of the map, whose roughness goes on below its pixels; `coarse_numbers` measures its
size with a second solution at half the resolution.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace

from asperity.contact import Contact, solve
from asperity.engineering.advice import advise
from asperity.engineering.answer import Answer
from asperity.engineering.case import Body, Case, Load
from asperity.engineering.evaluation import body_answer, contact_numbers, contact_span, main_numbers
from asperity.engineering.extremes import StressInBody, stress_in
from asperity.engineering.findings import Findings, Neighbours, Numbers
from asperity.engineering.indenter import CounterMap, Indenter, MapSettings, read_indenter
from asperity.finite import require_finite
from asperity.spectral import Fourier, Grid, resample
from asperity.stress.arguments import FIELDS, checked_names
from asperity.surface.height_map import HeightMap
from asperity.types import Progress

CONTACT_TOLERANCE = 1e-6
"""Error of the pressure relative to its norm."""

STAGES = {"map": 0.1, "contact": 0.4, "stress": 0.35, "resolution": 0.15}
"""Share of each stage in the time of a run, for the progress bar."""


def run(
    source: str | os.PathLike[str] | HeightMap | Indenter,
    lower: Body,
    upper: Body | None = None,
    *,
    mean_pressure: float | None = None,
    force: float | None = None,
    approach: float | None = None,
    area_fraction: float | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    counter_map: str | os.PathLike[str] | HeightMap | CounterMap | None = None,
    map_settings: MapSettings | None = None,
    fields: Sequence[str] = ("von_mises",),
    progress: Progress | None = None,
) -> Answer:
    """Press a measured surface against a flat or rough body and analyse the stress in every elastic body.

    Exactly one of `mean_pressure`, `force`, `approach` and `area_fraction` is given. All numbers are in SI
    units.

    Parameters
    ----------
    source : path, HeightMap or Indenter
        File of a map, a map in metres, or what `asperity.engineering.indenter.read_indenter` has made of one.
    lower : Body
    upper : Body, optional
        By default the other body is rigid. The map is that of the lower body, but if the other one is flat
        it does not matter which of the two is rough, as long as the slopes are small.
    mean_pressure : float
        Load over the nominal area, in Pa.
    force : float
        Load on the area of the map, in N.
    approach : float
        Approach of the bodies since their first touch, in m.
    area_fraction : float
        Real over nominal contact area.
    friction, sliding_direction : float, str or float
        Coefficient and direction of full sliding, for the stress; see `Case`.
    counter_map : path, HeightMap or CounterMap, optional
        Map of the upper body, with its peaks upward as measured. It is turned over and laid on the other one;
        see `CounterMap`.
    map_settings : MapSettings, optional
    fields : names
        Fields of `asperity.stress_planes` whose peaks are listed and that are drawn.
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
    case = Case(lower, upper, load, friction, sliding_direction)
    names = checked_names("fields", fields, FIELDS)
    report = _Stages(progress)
    settings = map_settings or MapSettings()
    counter = None
    if counter_map is not None:
        counter = counter_map if isinstance(counter_map, CounterMap) else CounterMap(counter_map)
    indenter = source if isinstance(source, Indenter) else read_indenter(source, settings, counter)
    contact = press(indenter, case, report.stage("contact"))
    bodies = {}
    for body, share in _shared(report.stage("stress"), list(case.bodies)):
        bodies[body] = stress_in(contact, case, body, names, share)
    coarse = coarse_numbers(indenter, case, report.stage("resolution"))
    neighbours = None
    if settings.radius is not None and indenter.boundary == "periodic":
        neighbours = neighbours_of(indenter, case, contact)
    answer = assemble(indenter, case, settings, contact, bodies, coarse, names, counter, neighbours)
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


def coarse_numbers(indenter: Indenter, case: Case, progress: Progress | None = None) -> Numbers:
    """The main numbers of the case with pixels twice as large, under the same load."""
    halved = _halved(indenter)
    contact = press(halved, case, progress)
    stress = stress_in(contact, replace(case, lower=replace(case.lower, yield_stress=None)), "lower")
    return main_numbers(contact, stress.dataset)


def neighbours_of(indenter: Indenter, case: Case, contact: Contact) -> Neighbours:
    """Effect of the periodic images on the contact of a ball or cylinder, from a solution without them."""
    span, unknown = contact_span(indenter, contact), float("nan")
    if any(body.height is not None for body in case.bodies.values()):
        return Neighbours(span, unknown, unknown)
    alone = press(indenter.map_alone(), case)
    return Neighbours(span, alone.area_fraction, float(alone.pressure.max()))


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


def assemble(
    indenter: Indenter,
    case: Case,
    settings: MapSettings,
    contact: Contact,
    stresses: dict[str, StressInBody],
    coarse: Numbers,
    fields: tuple[str, ...] = ("von_mises",),
    counter_map: CounterMap | None = None,
    neighbours: Neighbours | None = None,
) -> Answer:
    """The answer from the results of all stages, with the advice on them."""
    findings = Findings(
        indenter=indenter,
        load=case.load,
        numbers=contact_numbers(indenter, contact),
        bodies={name: body_answer(case.bodies[name], stress, indenter) for name, stress in stresses.items()},
        fine=main_numbers(contact, stresses["lower"].dataset),
        coarse=coarse,
        neighbours=neighbours,
    )
    _require_finite(findings)
    return Answer(
        indenter=indenter,
        case=case,
        map_settings=settings,
        contact=contact,
        numbers=findings.numbers,
        bodies=findings.bodies,
        stresses={name: stress.dataset for name, stress in stresses.items()},
        fine=findings.fine,
        coarse=coarse,
        advice=advise(findings),
        fields=fields,
        counter_map=counter_map,
    )


def _require_finite(findings: Findings) -> None:
    """Raise `ValueError` unless all numbers are finite; NaN stands for those of peaks that are not there."""
    results = vars(findings.numbers) | {
        f"{name} with {pixels} pixels": value
        for pixels, numbers in (("all", findings.fine), ("half the", findings.coarse))
        for name, value in vars(numbers).items()
    }
    for body in findings.bodies.values():
        results |= {name: tuple(extreme) for name, extreme in body.largest.items()}
        results |= {
            name: getattr(body, name)
            for name in ("volume_above_yield", "depths_above_yield", "fraction_above_yield")
            if getattr(body, name) is not None
        }
    require_finite("run", results, undefined=True)


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
