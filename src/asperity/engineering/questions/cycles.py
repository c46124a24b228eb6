"""Stress cycles: a smooth body under a rough one, two rough faces, or a way through a Hertz contact.

Fatigue after Dang Van, shakedown, and the probability that no crack starts follow from them.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.core.errors import InputError
from asperity.core.types import Array, Progress
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.answer_data import FADED, AnswerData
from asperity.engineering.body_stress import STRESS_TOLERANCE
from asperity.engineering.face import RoughFace
from asperity.engineering.moving import MOST_SHIFTS, MovingContact
from asperity.engineering.question import Findings, Picture, Pressed, Question, Stages, part_of
from asperity.engineering.records import (
    DISCRETISATION,
    POSITIVE,
    Advice,
    Position,
    Record,
    find,
    fraction,
    per_cent,
)
from asperity.engineering.scene import Scene
from asperity.results.variables import SI_UNITS
from asperity.settings.body import Body, ResidualStress
from asperity.settings.load import Hertz
from asperity.settings.model import Number, Whole, optional, setting
from asperity.settings.quantities import Area, Volume
from asperity.stress.cycles.criteria import LARGEST_FACTOR, NUMBERS, Criteria, hydrostatic_factor
from asperity.stress.cycles.stress_cycles import TURNED, cracks_per_area, stress_cycles, weibull_exponent
from asperity.stress.cycles.stress_cycles import Cycles as StreamedCycles
from asperity.surface.treatment.treatment import TreatedMap

TOPIC = "stress cycles"

WORST: dict[str, tuple[str, str, dict[str, Any]]] = {
    "dang_van": ("maximum Dang Van stress over limit", "1", {"better": "less"}),
    "shear_range": ("maximum range of shear stress", "Pa", {"better": "less", "bounds": POSITIVE}),
    "shakedown_lower": ("shakedown factor, at least", "1", {"better": "more", "bounds": POSITIVE}),
    "shakedown_upper": ("shakedown factor, at most", "1", {"better": "more", "bounds": POSITIVE}),
}
"""Variable of the cycles → quantity of its worst value, its unit, and more of its record."""

LIMIT_FRACTIONS = (0.5, 0.75, 0.9, 1.0)
"""Fractions of the fatigue limit above which the volume is listed."""

ON_THESE_PIXELS = " on these pixels (discretisation error not known)"

NO_CHANGE = "unlimited, as the stress does not change"
"""Text in place of an infinite shakedown factor."""

CRACKS = "cracks expected per area"
"""Quantity from which the probability on an area follows."""

ABOVE_LIMIT = "volume above 100 % of the limit per area"

DECADE = 10.0
"""Ratio of the ends of an interval of expected cracks from which the interval alone is shown."""

STREAMED = 30.0
"""Work of the cycles of a smooth body, from the planes of its stress."""

FEW_SHIFTS = 0.1
"""Change of the worst cycles with half of the shifts above which these are too few."""


class Cycles(Question):
    """Stress cycles of both bodies; see `asperity.stress.stress_cycles` and
    `asperity.engineering.MovingContact`.

    Without shifts a body with fatigue limits is taken as smooth, under a rough one that slides along x or y.
    """

    ASKS = "Does it fatigue, sliding or rolling?"
    TILES = (
        *("probability of no crack on the track", "maximum Dang Van stress over limit"),
        *("shakedown factor, at least", "probability of no crack on the map"),
    )
    LEAD = "cycles"
    FILES = ("cycles", "fatigue")

    shifts: Whole | None = optional(
        "a smooth body with fatigue limits alone is cycled", ge=2, le=MOST_SHIFTS, example=64
    )
    """Number of positions of the moving bodies, over one period along the sliding direction, or over the way
    of a point through the Hertz contact."""
    slide_to_roll: Number = setting(0.0, gt=-2, lt=2, example=0.1)
    """Slide-to-roll ratio 2 (u2 − u1)/(u2 + u1) in the Hertz contact, with the surface velocities u1 of
    the body and u2 of the counter body."""
    fatigue_scatter: Number | None = optional("no probability", ge=0.01, le=1, example=0.1)
    """Coefficient of variation of the fatigue limits, 0.03 to 0.15 for steels. With `fatigue_volume`, the
    probability that no crack starts is reported."""
    fatigue_volume: Volume | None = optional("no probability", example="100 mm3")
    """Stressed volume of the specimens on which fatigue limits and scatter were measured."""
    area: Area | None = optional("the map alone", example="60 mm2")
    """Area of the track, for the probability that no crack starts on it."""

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a body gives fatigue limits or a residual stress itself."""
        bodies, limits = case.groups_of_bodies.values(), ("fatigue_torsion", "residual_stress")
        return any(body.gives(name) for body in bodies for name in limits)

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Settings that cycles need or exclude, and fatigue limits whose ratio no ductile metal has.

        With the rough face, too few shifts for its waves, or a direction that no line through nodes has.
        """
        if rough is not None:
            try:
                if self.shifts is not None:
                    self._moving(case, rough, 1.0)
            except InputError as error:
                keys = {"shifts": "cycles.shifts", "sliding_direction": "sliding.direction"}
                yield from (
                    (keys[key], text) if key in keys else ("cycles", f": {text}") for key, text in error.found
                )
            return
        bodies = case.groups_of_bodies
        limited = {name: body for name, body in bodies.items() if body.fatigue_torsion is not None}
        for name, body in limited.items():
            try:
                hydrostatic_factor(body.fatigue_torsion, body.fatigue_bending)
            except InputError as error:
                yield from ((f"{name}.{key}", text) for key, text in error.found)
        if (self.fatigue_scatter is None) != (self.fatigue_volume is None):
            yield "cycles", ": both fatigue_scatter and fatigue_volume are needed, or none"
        if self.area is not None and self.fatigue_scatter is None:
            more = "" if limited else ", and fatigue limits of a body (body.fatigue_torsion, fatigue_bending)"
            example = "asperity case rolling has all of them"
            yield "cycles.area", f": requires fatigue_scatter and fatigue_volume{more}; {example}"
        if self.fatigue_scatter is not None and not limited:
            text = f" = {self.fatigue_scatter:g}: fatigue limits of a body are needed"
            yield "cycles.fatigue_scatter", text
        if self.shifts is None:
            if self.slide_to_roll:
                yield "cycles.slide_to_roll", f" = {self.slide_to_roll:g}: needs cycles.shifts"
            if not limited:
                limits = "fatigue limits of a body (fatigue_torsion, fatigue_bending)"
                yield "cycles", f": needs shifts, or {limits}"
            elif case.counter_body is not None and case.counter_body.map is not None:
                yield "counter_body.map", ": needs cycles.shifts, for the stress cycles of two rough faces"
            if case.sliding_direction not in ("x", "y") and float(case.sliding_direction) % 90:
                needed = "x, y or a multiple of 90 is needed for the stress cycles of a smooth body"
                given = f" = {case.sliding_direction:g}"
                yield "sliding.direction", f"{given}: {needed}; another angle of the grid with cycles.shifts"
            return
        refused = {
            "slide_to_roll without a Hertz contact": self.slide_to_roll and case.hertz_contact is None,
            " = ".join(case.map.free_edges or ()): case.map.free_edges,
            "a radius of the map": case.map.radius is not None,
            "a load curve": "load_curve" in case.questions,
            "layers on a body": any(body.interfaces for body in bodies.values()),
        }
        for name in (name for name, given in refused.items() if given):
            yield "cycles.shifts", f" = {self.shifts}: not accepted together with {name}"

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """Contacts and stress of all positions, of a mirrored map in the cell of four images; or cycles."""
        if self.shifts is None:
            limited = [each for each in case.different_bodies.values() if each.fatigue_torsion is not None]
            return 0.0, STREAMED * len(limited)
        images = 4.0 if is_mirrored else 1.0
        return 0.0, images * (17.0 + 2.5 * self.shifts) * len(case.different_bodies)

    def areas(self, nominal: float) -> dict[str, float]:
        """Area of the track, if it is given, and of the map."""
        return ({} if self.area is None else {"track": self.area}) | {"map": nominal}

    @property
    def lower_limits(self) -> str:
        """Factor of the expected cracks if the fatigue limits are 10 % lower, in words."""
        assert self.fatigue_scatter is not None
        return f"with limits 10 % lower {0.9 ** -weibull_exponent(self.fatigue_scatter):.2g} times as many"

    def observer(self, pressed: Pressed, body: str, loaded: LoadedSolid) -> StreamedCycles | None:
        """Cycles of a smooth body from the planes of its stress below a coating."""
        constants = pressed.asked.bodies[body]
        if self.shifts is not None or constants.fatigue_torsion is None:
            return None
        direction, layer = pressed.asked.sliding_of(body)["sliding_direction"], loaded.layer
        criteria = Criteria(**_limits(constants))
        below = max(layer.interfaces, default=-1.0)
        passing = pressed.asked.passage(pressed.contact, body)
        return StreamedCycles(loaded, criteria, direction, layer.poisson, below=below, passing=passing)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """The worst cycles of each body, volumes above fractions of the limit, and cracks."""
        case, bodies, cycles = stages.asked, [*stages.asked.different_bodies], dict[str, Any]()
        records: list[Record] = []
        fatigue: list[tuple[Any, ...]] = []
        peaks: list[pd.DataFrame] = []
        for number, body in enumerate(bodies):
            limits = _limits(case.bodies[body])
            if self.shifts is not None:
                part = partial(part_of, progress, number, number + 1, len(bodies))
                moving = self._moving(case, stages.rough, stages.contact.mean_pressure / case.carried, part)
                one = stress_cycles(moving.in_body(body), **limits, tolerance=STRESS_TOLERANCE)
            elif (observed := stages.bodies[body].observed.get("cycles")) is not None:
                one = observed.dataset()
            else:
                continue
            title = f"Cycles of the stress in the {body} body under rough surface {stages.face.name}"
            cycles[body] = one.assign_attrs(title=f"{title} that moves")
            records += self._records(stages, body, one)
            if "dang_van" in one:
                volumes = one["fatigue_volume"].to_series().items()
                fatigue += [(body, *each) for each in volumes if each[1] > 0]
                peaks.append(_peaks(stages.face, body, one, limits["fatigue_torsion"]))
        columns = ["body", "fraction_of_limit", "volume_per_area_m"]
        return Findings(
            records=records,
            verdict=self._verdict(records, self.area or stages.numbers.nominal_area),
            warnings=[*self._warnings(case, cycles)],
            assumption=f"In stress cycles {self._motion(case)}.",
            tables={"fatigue": pd.DataFrame(fatigue, columns=columns)} if fatigue else {},
            datasets={_name(case, body): one for body, one in cycles.items()},
            peaks=peaks,
        )

    def _moving(
        self, case: Scene, rough: RoughFace, mean_pressure: float, progress: Progress | None = None
    ) -> MovingContact:
        """The faces of a case as they move against each other."""
        assert self.shifts is not None
        height, film = rough.face.height, case.questions.get("film")
        upper = np.zeros_like(height) if rough.upper is None else rough.upper
        most = mean_pressure if (smooth := case.hertz_contact) is None else smooth.maximum_pressure
        hardness = case.hardness or math.inf
        if case.hardness_is_estimated and most >= hardness:
            hardness = math.inf  # no contact bears the load
        return MovingContact(
            upper - height,
            upper,
            case.solid,
            rough.face.grid,
            shifts=self.shifts,
            sliding_direction=case.sliding_direction,
            mean_pressure=mean_pressure if smooth is None else None,
            hertz=smooth,
            at=case.load.at if isinstance(case.load, Hertz) else (0.0, 0.0),
            slide_to_roll=self.slide_to_roll,
            friction=case.friction,
            hardness=hardness,
            film_share=0.0 if film is None else film.share,
            wavelength_short=rough.face.wavelength_short,
            progress=progress,
        )

    def _records(self, stages: Stages, body: str, cycles: xr.Dataset) -> Iterator[Record]:
        """The worst cycles of a body, volumes above fractions of the limit, and cracks.

        The discretisation error is that of the pixels and of the shifts.
        """
        of: dict[str, Any] = {"topic": TOPIC, "body": body}
        few, smooth = cycles.attrs.get("few_shifts_error", 0.0), self._smooth(stages, body, cycles)
        for variable, (quantity, unit, more) in WORST.items():
            if variable not in cycles:
                continue
            value, depth, *place = map(float, cycles.attrs[f"worst_{variable}"])
            at: dict[str, float] = {"y": math.nan, "x": math.nan}
            at |= dict(zip((axis_of(cycles), "x"), place, strict=False))
            position = Position(depth, *map(float, stages.face.grid.on_map(**at)))
            if variable.startswith("shakedown") and value >= LARGEST_FACTOR:
                yield Record(quantity, value, unit, words=NO_CHANGE, **of, **more)
                continue
            pixels = _pixel_error(cycles, variable, stages.bodies[body].cycle_error(variable), smooth)
            error = float(np.hypot(pixels, few * abs(value)))
            record = Record(quantity, value, unit, position=position, varies=True, **of, **more)
            yield record.with_error(DISCRETISATION, error)
        if "fatigue_volume" not in cycles:
            return
        for share in LIMIT_FRACTIONS:
            value = float(cycles["fatigue_volume"].interp(fatigue_share=share))
            name = f"volume above {100 * share:g} % of the limit per area"
            volume = Record(name, value, "m", bounds=POSITIVE, varies=True, better="less", **of)
            yield volume.with_error(DISCRETISATION, math.nan if value else 0.0)
        if self.fatigue_scatter is not None and self.fatigue_volume is not None:
            cracks = cracks_per_area(cycles, self.fatigue_scatter, self.fatigue_volume)
            exponent = weibull_exponent(self.fatigue_scatter)
            pixels = _pixel_error(cycles, "dang_van", stages.bodies[body].cycle_error("dang_van"), smooth)
            error = float(np.hypot(pixels / abs(cycles.attrs["worst_dang_van"][0]), few))
            factors = np.maximum(1 + error * np.array([-1, 1]), 0) ** exponent  # of d^m
            note = f"Weibull exponent {exponent:.3g}; {self.lower_limits}"
            low, high = (cracks * factors).tolist()
            found = Record(CRACKS, cracks, "1/m^2", bounds=POSITIVE, note=note, ends=(low, high), **of)
            nominal = stages.numbers.nominal_area
            yield known_to_a_factor(found)
            yield from (no_crack(found, where, area, nominal) for where, area in self.areas(nominal).items())

    def _smooth(self, stages: Stages, body: str, cycles: xr.Dataset) -> dict[str, Array]:
        """Variable → its number at each depth in the cycle of the smooth Hertz contact; empty without one."""
        case = stages.asked
        if (passing := case.passage(stages.contact, body)) is None:
            return {}
        criteria, found = Criteria(**_limits(case.bodies[body])), []
        order = TURNED if axis_of(cycles) == "x" else [*range(len(TURNED))]
        for depth in cycles["cycle_depth"].values:
            reduced = criteria.reduced(passing(depth)[order, None], True)
            found.append(criteria.at(depth).numbers(reduced)[:, 0])
        return dict(zip(NUMBERS, np.transpose(found), strict=True))

    def _warnings(self, case: Scene, found: dict[str, xr.Dataset]) -> Iterator[Advice]:
        """Error by few shifts, and the stress with which the limits are compared."""
        for body, cycles in found.items():
            if (size := cycles.attrs.get("few_shifts_error")) is not None:
                where = f" of the {body} body" if len(case.different_bodies) > 1 else ""
                worst = f"the worst cycles{where}"
                error = f"with {self.shifts} shifts the error of {worst} is about {per_cent(size)}"
                text = f"{error}, estimated from the result with half of the shifts."
                yield Advice(size > FEW_SHIFTS, "number of shifts", text, f"shifts: {error}", size)
        for body, constants in case.different_bodies.items():
            if constants.fatigue_torsion is None:
                name = (
                    f"the {body} body" if len(case.different_bodies) > 1 else constants.material or "the body"
                )
                left = "shear stress ranges alone" if body in found else "no numbers of its cycles"
                if body in found and constants.yield_stress is not None:
                    left = "shear stress ranges and shakedown factors"
                text = (
                    f"no fatigue limits of {name} are known: there are {left}, and no cracks are predicted."
                )
                yield Advice(True, "fatigue limits", text)
        if any("dang_van" in cycles for cycles in found.values()):
            film = "" if "film" in case.questions else " of dry faces, without a lubricant film"
            text = f"the fatigue limits are compared with elastic stress cycles{film}; residual stress "
            yield Advice(False, "fatigue", f"{text}counts only where it is given, and no life is predicted.")

    def _motion(self, case: Scene) -> str:
        """The motion that makes the cycles, in words."""
        if self.shifts is not None and case.hertz_contact is not None:
            rolling = f"slide-to-roll ratio {self.slide_to_roll:g}, {self.shifts} positions"
            return f"a point moves along {case.along} through the Hertz contact, {rolling}"
        if self.shifts is not None:
            return f"the faces move along {case.along}, {self.shifts} shifts"
        below = ", below its layers" if any(body.interfaces for body in case.bodies.values()) else ""
        moves = (
            f"the rough body moves along {case.along}, over each body as if that were the smooth one{below}"
        )
        if case.hertz_contact is None:
            return moves
        return (
            f"{moves}; besides, each point is unloaded and passes through the Hertz contact of the smooth "
            "bodies: roughness counts at the position of the map alone, and on the whole way with "
            "cycles.shifts"
        )

    def _verdict(self, records: list[Record], area: float) -> str:
        """Fatigue on an area, and shakedown, of the body with the worst cycles, from their intervals."""
        worst = {variable: [*find(records, quantity)] for variable, (quantity, *_) in WORST.items()}
        found = []
        if worst["dang_van"]:
            largest = max(worst["dang_van"], key=lambda each: each.value)
            ratio, (low, high) = largest.value, _ends(largest)
            shown = f"{largest.best_text(whole=False)} times"
            pixels = ON_THESE_PIXELS * bool(largest.lacking)
            text = f"every cycle stays below the fatigue limit{pixels}, at most {shown} it"
            if high > 1:
                text = f"the worst cycle reaches {shown} the fatigue limit: "
                text += "cracks can start" if low > 1 else "it is not decided whether cracks can start"
            if cracks := [each for each in records if each.quantity == CRACKS]:
                most = max(cracks, key=lambda each: each.value)
                stressed = area * next(find(records, ABOVE_LIMIT, most.body)).value
                where = shown_si(area, "m^2", 3)
                if ratio > 1 and self.fatigue_volume is not None and most.value * area < math.log(2):
                    specimens = f"{1e9 * self.fatigue_volume:.3g} mm³"
                    text += (
                        f", but only {1e9 * stressed:.2g} mm³ on {where} is above it, and the limit is that "
                    )
                    text += f"of specimens of {specimens}"
                text += f"; the probability that a crack starts on {where} is {chance(most, area)}"
            found.append(text)
        if worst["shakedown_lower"] and worst["shakedown_upper"]:
            lower, upper = (
                min(worst[name], key=lambda each: each.value)
                for name in ("shakedown_lower", "shakedown_upper")
            )
            between = f"between {lower.value:.2g} and {upper.value:.2g}"
            if upper.value >= LARGEST_FACTOR:
                between = f"at least {lower.value:.2g}"
            returns = "it is not decided whether plastic strain returns in each pass"
            if (stays := _ends(lower)[0] >= 1) or _ends(upper)[1] < 1:
                returns = f"{'no ' * stays}plastic strain returns in each pass"
                returns += ON_THESE_PIXELS * bool((lower if stays else upper).lacking)
            shakes = f"the shakedown limit is {between} times this load: {returns}"
            found.append(shakes)
        return "; ".join(found)

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """The maximum Dang Van stress of the cycles over (y, depth); a contour is the fatigue limit."""
        for body in answer.case.different_bodies:
            name, limit = _name(answer.case, body), answer.case.bodies[body].fatigue_torsion
            if name in answer.datasets and limit is not None:
                cycles = answer.datasets[name]
                caption = (
                    f"Maximum Dang Van stress of each row across {axis_of(cycles)} in the {body} body as "
                    f"{self._motion(answer.case)}; the line is the fatigue limit in torsion, "
                    f"{shown_si(limit, 'Pa')}."
                )
                yield Picture(name, caption, _section(answer, cycles, limit), body)


def _ends(record: Record) -> tuple[float, float]:
    """Ends of the interval of a number; twice the number if its error is not known."""
    return (record.value,) * 2 if math.isnan(record.error) else record.interval


def _pixel_error(cycles: xr.Dataset, variable: str, relative: float, smooth: Mapping[str, Array]) -> float:
    """Error of the worst value of a variable, if at each depth what the roughness adds has a relative one."""
    power = -1 if variable.startswith("shakedown") else 1  # a factor of the load falls as the stress rises
    worst = (cycles[variable] ** power).max(f"cycle_{axis_of(cycles)}").values
    part = relative * np.abs(worst - (smooth[variable] ** power if smooth else 0.0))
    error = float(np.maximum((worst + part).max() - worst.max(), worst.max() - (worst - part).max()))
    return error if power > 0 else error / float(worst.max()) ** 2


def known_to_a_factor(cracks: Record) -> Record:
    """The cracks expected per area as they are shown: the interval alone if it spans more than a decade."""
    words = _spread(cracks, lambda number: f"{1e-6 * number:.2g}", " per mm²")
    return replace(cracks, words=words)


def no_crack(cracks: Record, where: str, area: float, nominal: float) -> Record:
    """The probability that no crack starts on an area, from the cracks expected per area.

    Parameters
    ----------
    cracks : Record
    where : "track" or "map"
    area : float
        In m².
    nominal : float
        Area of the map in m².
    """
    value, high, low = (math.exp(-each * area) for each in (cracks.value, *cracks.ends))
    note = f"on {shown_si(area, 'm^2')}; the probability of a crack is {chance(cracks, area)}"
    if area > nominal:
        note += f"; extrapolated to {area / nominal:.2g} times the area of the map"
    words = _spread(cracks, lambda number: _survival(number * area), falls=True)
    of: dict[str, Any] = {"topic": cracks.topic, "body": cracks.body, "ends": (low, high), "words": words}
    return fraction(f"probability of no crack on the {where}", value, better="more", note=note, **of)


def chance(cracks: Record, area: float) -> str:
    """The probability that a crack starts on an area, in words."""
    return _spread(cracks, lambda number: f"{-math.expm1(-number * area):.2g}")


def _spread(cracks: Record, text: Callable[[float], str], unit: str = "", falls: bool = False) -> str:
    """A function of the expected cracks with its interval; the interval alone beyond a decade of cracks."""
    low, high = cracks.ends
    if math.isnan(low):
        return f"{text(cracks.value)}{unit} on these pixels, ± not known"
    ends = [text(each) for each in ((high, low) if falls else (low, high))]
    if ends[0] == ends[1]:
        return f"{ends[0]}{unit}"
    if high > DECADE * low:
        return f"between {' and '.join(ends)}{unit}"
    return f"{text(cracks.value)} ({' to '.join(ends)}){unit}"


def _survival(cracks: float) -> str:
    """The probability of no crack in per cent, with two digits of what it lacks to 100 %."""
    if cracks > math.log(2):
        return f"{100 * math.exp(-cracks):.2g} %"
    return f"{100 - float(f'{-100 * math.expm1(-cracks):.2g}'):.8g} %"


def _name(case: Scene, body: str) -> str:
    """Name of the cycles of a body among the datasets and pictures."""
    return f"cycles_{body}" if len(case.different_bodies) > 1 else "cycles"


def _limits(body: Body) -> dict[str, Any]:
    """Limits and residual stress of a body, as `asperity.stress.stress_cycles` takes them."""
    names = ("fatigue_torsion", "fatigue_bending", "yield_stress")
    residual: Any = body.residual_stress or 0.0
    if isinstance(residual, ResidualStress):
        residual = residual.depth, residual.stress
    return {name: getattr(body, name) for name in names} | {"residual_stress": residual}


def _peaks(face: TreatedMap, body: str, cycles: xr.Dataset, limit: float) -> pd.DataFrame:
    """Maxima over rows of the maximum Dang Van stress of each row, as rows of the table of peaks."""
    axis, of_row = axis_of(cycles), cycles["dang_van"].max("cycle_depth").values
    above = (of_row > np.roll(of_row, 1)) & (of_row >= np.roll(of_row, -1))
    row, nodes = np.flatnonzero((of_row > 0) & above), face.grid.shape["yx".index(axis)]
    row = row[(row < nodes) | (row == of_row.size - 1)]  # without the mirror images of the map
    deepest = cycles["dang_van"].argmax("cycle_depth").values[row]
    depth = cycles["cycle_depth"].values[deepest]
    values = {"value_Pa": limit * of_row[row], "depth_m": depth}
    place = cycles[f"cycle_{axis}"].values[np.where(row < nodes, row, 0)]
    places = {"y_m": 0.0, "x_m": 0.0} | {f"{axis}_m": place}
    known = {"body": body, "quantity": "dang_van", "under_contact": True, "in_solid": depth > 0}
    return pd.DataFrame(values | places | known)


def _section(answer: AnswerData, cycles: xr.Dataset, limit: float) -> Any:
    """The maximum Dang Van stress over the depth and the axis of the cycles, with a contour at the limit."""
    from asperity.views.scales import STRESS, Look
    from asperity.views.stress_plot import draw_sections, until_faded
    from asperity.views.style import plain_text

    axis, grid = axis_of(cycles), answer.face.grid
    section = (cycles["dang_van"] * limit).rename({"cycle_depth": "depth", f"cycle_{axis}": axis})
    section = section.isel({axis: slice(0, grid.shape["yx".index(axis)])})
    # Every row meets a contact somewhere: bars of the contact would say nothing.
    touching = np.zeros(section.sizes[axis], dtype=bool)
    over_depth = np.full(section.sizes["depth"], limit)
    section = section.assign_coords(contact=(axis, touching), limit=("depth", over_depth))
    # Cycles in a Hertz contact go deeper than the picture, which ends at half of the edge of the map.
    section = section.rename(plain_text(answer.face.name)).sel(depth=slice(0, max(grid.length) / 2))
    look = Look("maximum Dang Van stress of a cycle", "stress", STRESS, "white", np.max, low=0.0)
    faded = until_faded([section.clip(0)], min(FADED * float(section.max()), limit))
    return draw_sections(faded, look, SI_UNITS, None)


def axis_of(cycles: xr.Dataset) -> str:
    """Axis of the cycles beside the depth, ``"y"`` or ``"x"``."""
    return "x" if "cycle_x" in cycles.coords else "y"
