"""Stress cycles: a smooth body under a rough one, two rough faces, or a way through a Hertz contact.

Fatigue after Dang Van, shakedown, and the probability that no crack starts follow from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from asperity.core.units import shown_si
from asperity.engineering.question import MOST_SHIFTS, Advice, Picture, Question, Row, per_cent, row
from asperity.settings.body import ResidualStress
from asperity.settings.model import Number, Whole, optional, setting
from asperity.settings.quantities import Volume

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from asperity.engineering.moving import MovingContact
    from asperity.engineering.question import Answer, Case, LinearPlane, LoadedSolid, Progress, RoughFace
    from asperity.settings.body import Body

WORDS = {
    "dang_van": ("largest Dang Van stress over limit", "1"),
    "shear_range": ("largest range of shear stress", "Pa"),
    "shakedown_lower": ("shakedown factor, at least", "1"),
    "shakedown_upper": ("shakedown factor, at most", "1"),
}
"""Variable of the cycles → name of its worst value among the numbers, and its unit."""

LIMIT_SHARES = (0.5, 0.75, 0.9, 1.0)
"""Shares of the fatigue limit above which the volume is listed."""

CRACKS = "cracks expected per area"
"""Name of the number from which the probability on an area follows."""

FEW_SHIFTS = 0.1
"""Change of the worst cycles with half of the shifts above which these are too few."""


class Cycles(Question):
    """Stress cycles of both bodies; see `asperity.stress.stress_cycles` and
    `asperity.engineering.MovingContact`.

    Without shifts a body with fatigue limits is taken as smooth, under a rough one that slides along x or y.
    """

    TILES = (
        *("largest Dang Van stress over limit", "shakedown factor, at least"),
        *("probability of no crack on the map",),
    )
    LEAD = "cycles"

    shifts: Whole | None = optional(
        "cycles of a smooth body under a rough one, with fatigue limits", ge=2, le=MOST_SHIFTS, example=64
    )
    """Number of positions of the moving bodies for which the contact is solved. They divide one period
    along the sliding direction, or the way of a point through the Hertz contact."""
    slide_to_roll: Number = setting(0.0, gt=-2, lt=2, example=0.1)
    """Slide-to-roll ratio 2 (u2 − u1)/(u2 + u1) in the Hertz contact, with the surface velocities u1 of
    the body and u2 of the counter body."""
    fatigue_scatter: Number | None = optional("no probability", ge=0.01, le=1, example=0.1)
    """Coefficient of variation of the fatigue limits, 0.03 to 0.15 for steels. With `fatigue_volume`, the
    probability that no crack starts is reported."""
    fatigue_volume: Volume | None = optional("no probability", example="100 mm3")
    """Stressed volume of the specimens on which fatigue limits and scatter were measured."""

    @classmethod
    def is_implied(cls, case: Case) -> bool:
        """True if a body gives fatigue limits or a residual stress itself."""
        bodies, limits = case.groups_of_bodies.values(), ("fatigue_torsion", "residual_stress")
        return any(body.gives(name) for body in bodies for name in limits)

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Settings that cycles need or exclude, and fatigue limits whose ratio no ductile metal has."""
        from asperity.stress.cycles.criteria import hydrostatic_factor

        bodies = case.groups_of_bodies
        limited = {name: body for name, body in bodies.items() if body.fatigue_torsion is not None}
        for name, body in limited.items():
            try:
                hydrostatic_factor(body.fatigue_torsion, body.fatigue_bending)
            except ValueError as error:
                yield f"{name}.fatigue_torsion", str(error).removeprefix("fatigue_torsion")
        if (self.fatigue_scatter is None) != (self.fatigue_volume is None):
            yield "cycles", ": both fatigue_scatter and fatigue_volume are needed, or none"
        if self.fatigue_scatter is not None and not limited:
            text = f" = {self.fatigue_scatter:g}: fatigue limits of a body are needed"
            yield "cycles.fatigue_scatter", text
        if self.shifts is None:
            if self.slide_to_roll:
                yield "cycles.slide_to_roll", f" = {self.slide_to_roll:g}: needs cycles.shifts"
            if not limited:
                yield (
                    "cycles",
                    ": needs shifts, or fatigue limits of a body (fatigue_torsion, fatigue_bending)",
                )
            elif case.counter_body is not None and case.counter_body.map is not None:
                yield "counter_body.map", ": needs cycles.shifts, for the stress cycles of two rough faces"
            if case.sliding_direction not in ("x", "y") and float(case.sliding_direction) % 90:
                needed = "x, y or a multiple of 90 is needed for the stress cycles of a smooth body"
                text = (
                    f" = {case.sliding_direction:g}: {needed}; another angle of the grid with cycles.shifts"
                )
                yield "sliding.direction", text
            return
        refused = {
            "slide_to_roll without a Hertz contact": self.slide_to_roll and case.hertz_contact is None,
            "map.periodic = none": case.map.periodic == "none",
            "a radius of the map": case.map.radius is not None,
            "a load curve": case.load_curve is not None,
            "a coating": any(body.coating is not None for body in bodies.values()),
        }
        for name in (name for name, given in refused.items() if given):
            yield "cycles.shifts", f" = {self.shifts}: not accepted together with {name}"

    def on_map(self, case: Case, rough: RoughFace) -> Iterator[tuple[str, str]]:
        """Too few shifts for the waves of the faces, or a direction that no line through nodes has."""
        if self.shifts is None:
            return
        try:
            moving_contact(case, rough, 1.0)
        except ValueError as error:
            name, equals, rest = str(error).partition(" = ")
            keys = {"shifts": "cycles.shifts", "sliding_direction": "sliding.direction"}
            yield (keys[name], f"{equals}{rest}") if name in keys else ("cycles", f": {error}")

    def of_contact(self, answer: Answer, progress: Progress) -> dict[str, Any]:
        """Body → its cycles; filled as the bodies are analysed."""
        return {}

    def watch(self, answer: Answer, body: str, loaded: LoadedSolid) -> Callable[[LinearPlane], None] | None:
        """Cycles of a smooth body from the planes of its stress."""
        from asperity.stress.cycles.criteria import Criteria
        from asperity.stress.cycles.stress_cycles import Cycles as StreamedCycles

        constants = answer.case.bodies[body]
        if self.shifts is not None or constants.fatigue_torsion is None:
            return None
        direction = answer.case.sliding_of(body)["sliding_direction"]
        criteria = Criteria(**_limits(constants))
        cycles = StreamedCycles(loaded, criteria, direction, loaded.layer.poisson)
        answer.of(self)[body] = cycles
        below = loaded.layer.interface or -1.0
        return lambda plane: cycles.add(plane) if plane.depth > below else None

    def of_body(self, answer: Answer, body: str, progress: Progress) -> None:
        """The dataset of the cycles of a body."""
        found = answer.of(self)
        if self.shifts is not None:
            from asperity.engineering.body_stress import STRESS_TOLERANCE
            from asperity.stress.cycles.stress_cycles import stress_cycles

            moving = moving_contact(answer.case, answer.rough, answer.nominal_pressure, progress)
            limits = _limits(answer.case.bodies[body])
            found[body] = stress_cycles(moving.in_body(body), **limits, tolerance=STRESS_TOLERANCE)
        elif body in found:
            found[body] = found[body].dataset()

    def verdict(self, answer: Answer) -> str:
        """Fatigue and shakedown of the body with the worst cycles."""
        each = answer.of(self).values()
        worst = {name: [one.attrs[f"worst_{name}"][0] for one in each if name in one] for name in WORDS}
        found = []
        if worst["dang_van"]:
            ratio = max(worst["dang_van"])
            text = f"every cycle stays below the fatigue limit, at most {ratio:.3g} times it"
            if ratio > 1:
                text = f"the worst cycle reaches {ratio:.3g} times the fatigue limit: cracks can start"
            found.append(text)
        if worst["shakedown_lower"] and worst["shakedown_upper"]:
            low, high = min(worst["shakedown_lower"]), min(worst["shakedown_upper"])
            between = f"{low:.2g} to {high:.2g} times the load"
            if low >= 1:
                shakes = f"up to {low:.3g} times the load no plastic strain returns in each pass"
            elif high < 1:
                shakes = f"plastic strain returns in each pass; it would end below {between}"
            else:
                shakes = f"whether plastic strain ends is not decided; it ends below {between}"
            found.append(shakes)
        return "; ".join(found)

    def rows_of_body(self, answer: Answer, body: str) -> Iterator[Row]:
        """The worst cycles, volumes above shares of the limit, and the probability that no crack starts."""
        import numpy as np

        if (cycles := answer.of(self).get(body)) is None:
            return
        group = _title(answer.case, body)
        for variable, (words, unit) in WORDS.items():
            if variable in cycles:
                value, depth, *place = cycles.attrs[f"worst_{variable}"]
                axes = [axis_of(cycles), *("x" for _ in place[1:])]
                positions = {"y": 0.0, "x": 0.0} | dict(zip(axes, place, strict=True))
                y, x = answer.face.grid.on_map(positions["y"], positions["x"])
                on_map = {"y": shown_si(float(y), "m"), "x": shown_si(float(x), "m")}
                at = ", ".join(f"{axis} = {on_map[axis]}" for axis in axes)
                few = cycles.attrs.get("few_shifts_error", 0.0)
                of_grid = np.nan_to_num(answer.bodies[body].grid_error(variable))
                source = "the pixels and the shifts" if few else "the pixels"
                shown = f"{shown_si(value, unit)} at depth {shown_si(depth, 'm')}, {at}"
                error = float(np.hypot(of_grid, few)) * abs(value)
                yield Row(group, words, value, unit, shown).by(error, source)
        if "fatigue_volume" not in cycles:
            return
        for share in LIMIT_SHARES:
            value = float(cycles["fatigue_volume"].interp(fatigue_share=share))
            name = f"volume above {100 * share:g} % of the limit per area"
            yield row(group, name, value, "m")
        if self.fatigue_scatter is not None and self.fatigue_volume is not None:
            from asperity.stress.cycles.stress_cycles import cracks_per_area, weibull_exponent

            area = answer.numbers.nominal_area
            cracks = cracks_per_area(cycles, self.fatigue_scatter, self.fatigue_volume)
            exponent = f"Weibull exponent {weibull_exponent(self.fatigue_scatter):.3g}"
            yield Row(group, CRACKS, cracks, "1/m^2", f"{1e-6 * cracks:.3g} per mm², {exponent}")
            none = math.exp(-cracks * area)
            shown = (
                f"{none:.4g} on {shown_si(area, 'm^2')}; one starts with {-math.expm1(-cracks * area):.2g}"
            )
            yield Row(group, "probability of no crack on the map", none, "1", shown)

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Error by few shifts, and the stress with which the limits are compared."""
        found, known = answer.of(self), answer.case.different_bodies
        for body in known:
            if (size := found[body].attrs.get("few_shifts_error") if body in found else None) is not None:
                where = f" of the {body} body" if len(known) > 1 else ""
                worst = f"the worst cycles{where}"
                error = f"with {self.shifts} shifts the error of {worst} is about {per_cent(size)}"
                text = f"{error}, estimated from the result with half of the shifts."
                yield Advice(size > FEW_SHIFTS, "number of shifts", text, f"shifts: {error}", size)
        if any("dang_van" in cycles for cycles in found.values()):
            film = "" if "film" in answer.case.questions else "of dry faces: there is no lubricant film, "
            text = f"the fatigue limits are compared with elastic stress cycles {film}no residual stress "
            yield Advice(False, "fatigue", f"{text}except the one given, and no life is predicted.")

    def files(self, case: Case) -> list[str]:
        """Datasets, pictures and table."""
        found = []
        for body, constants in case.different_bodies.items():
            suffix = f"_{body}" if len(case.different_bodies) > 1 else ""
            limited = constants.fatigue_torsion is not None
            found += [f"cycles{suffix}.nc"] if limited or self.shifts else []
            found += [f"cycles{suffix}.png", "fatigue.csv"] if limited else []
        return list(dict.fromkeys(found))

    def tables(self, answer: Answer) -> Mapping[str, pd.DataFrame]:
        """Volume per nominal area above shares of the fatigue limit: body, share, volume_per_area_m."""
        import pandas as pd

        found = []
        for body in answer.case.different_bodies:
            cycles = answer.of(self).get(body)
            if cycles is not None and "fatigue_volume" in cycles:
                volume = cycles["fatigue_volume"].to_series()
                found += [(body, share, value) for share, value in volume[volume > 0].items()]
        columns = ["body", "share", "volume_per_area_m"]
        return {"fatigue": pd.DataFrame(found, columns=columns)} if found else {}

    def datasets(self, answer: Answer) -> Iterator[tuple[str, xr.Dataset, str]]:
        """The cycles of each body."""
        for body in answer.case.different_bodies:
            if (cycles := answer.of(self).get(body)) is not None:
                of = f"{body} body under rough surface {answer.face.name} that moves"
                title = f"Cycles of the stress in {of}"
                yield f"cycles{answer.suffix_of(body)}", cycles.assign_attrs(body=body), title

    def peaks(self, answer: Answer, body: str) -> pd.DataFrame | None:
        """Maxima over rows of the largest Dang Van stress of each row, in the columns of `Answer.peaks`."""
        import numpy as np
        import pandas as pd

        cycles, limit = answer.of(self).get(body), answer.case.bodies[body].fatigue_torsion
        if cycles is None or "dang_van" not in cycles or limit is None:
            return None
        axis, of_row = axis_of(cycles), cycles["dang_van"].max("cycle_depth").values
        above = (of_row > np.roll(of_row, 1)) & (of_row >= np.roll(of_row, -1))
        row, nodes = np.flatnonzero((of_row > 0) & above), answer.face.grid.shape["yx".index(axis)]
        row = row[(row < nodes) | (row == of_row.size - 1)]  # without the mirror images of the map
        deepest = cycles["dang_van"].argmax("cycle_depth").values[row]
        values = {"value_Pa": limit * of_row[row], "depth_m": cycles["cycle_depth"].values[deepest]}
        place = cycles[f"cycle_{axis}"].values[np.where(row < nodes, row, 0)]
        places = {"y_m": 0.0, "x_m": 0.0} | {f"{axis}_m": place}
        rows = pd.DataFrame(values | places | {"quantity": "dang_van", "under_contact": True})
        rows["in_solid"] = rows["depth_m"] > 0
        return rows

    def pictures_of_body(self, answer: Answer, body: str) -> Iterator[Picture]:
        """The largest Dang Van stress of the cycles over (y, depth); a contour is the fatigue limit."""
        import numpy as np

        from asperity.engineering.pictures import FADED, source_of
        from asperity.views.scales import STRESS, Look
        from asperity.views.stress_plot import draw_sections, until_faded

        cycles, limit = answer.of(self).get(body), answer.case.bodies[body].fatigue_torsion
        if cycles is None or limit is None:
            return
        axis, source = axis_of(cycles), source_of(answer)
        rows = slice(0, source.grid.shape["yx".index(axis)])
        section = (cycles["dang_van"] * limit).rename({"cycle_depth": "depth", f"cycle_{axis}": axis})
        # Every row meets a contact somewhere: bars of the contact would say nothing.
        section = section.isel({axis: rows}).rename(source.title)
        touching = np.zeros(section.sizes[axis], dtype=bool)
        over_depth = np.full(section.sizes["depth"], limit)
        section = section.assign_coords(contact=(axis, touching), limit=("depth", over_depth))
        # Cycles in a Hertz contact go deeper than the picture, which ends at half of the edge of the map.
        section = section.sel(depth=slice(0, max(answer.face.grid.length) / 2))
        look = Look("largest Dang Van stress of a cycle", "stress", STRESS, "white", np.max, low=0.0)
        faded = min(FADED * float(section.max()), limit)
        figure = draw_sections(until_faded([section.clip(0)], faded), look, source.system, None)
        caption = (
            f"Largest Dang Van stress of each row across {axis}; the line is the "
            f"fatigue limit in torsion, {shown_si(limit, 'Pa')}; {_title(answer.case, body)}."
        )
        yield Picture(f"cycles{answer.suffix_of(body)}", caption, figure, body)


def _limits(body: Body) -> dict[str, Any]:
    """Limits and residual stress of a body, as `asperity.stress.stress_cycles` takes them."""
    names = ("fatigue_torsion", "fatigue_bending", "yield_stress")
    residual: Any = body.residual_stress or 0.0
    if isinstance(residual, ResidualStress):
        residual = residual.depth, residual.stress
    return {name: getattr(body, name) for name in names} | {"residual_stress": residual}


def moving_contact(
    case: Case, rough: RoughFace, mean_pressure: float, progress: Progress | None = None
) -> MovingContact:
    """The faces of a case as they move against each other."""
    import numpy as np

    from asperity.engineering.moving import MovingContact
    from asperity.settings.load import Hertz

    assert case.cycles is not None
    assert case.cycles.shifts is not None
    height = rough.face.height
    upper = np.zeros_like(height) if rough.upper is None else rough.upper
    return MovingContact(
        upper - height,
        upper,
        case.solid,
        rough.face.grid,
        shifts=case.cycles.shifts,
        sliding_direction=case.sliding_direction,
        mean_pressure=mean_pressure if case.hertz_contact is None else None,
        hertz=case.hertz_contact,
        at=case.load.at if isinstance(case.load, Hertz) else (0.0, 0.0),
        slide_to_roll=case.cycles.slide_to_roll,
        friction=case.friction,
        hardness=case.hardness,
        film_share=0.0 if case.film is None else case.film.share,
        wavelength_short=rough.face.wavelength_short,
        progress=progress,
    )


def axis_of(cycles: xr.Dataset) -> str:
    """Axis of the cycles beside the depth, ``"y"`` or ``"x"``."""
    return "x" if "cycle_x" in cycles.coords else "y"


def _title(case: Case, body: str) -> str:
    """Heading of the cycles of one body."""
    asked, along = case.cycles or Cycles(), case.sliding_direction
    along, shifts = along if isinstance(along, str) else f"{along:g}° from x", asked.shifts
    if shifts is not None and case.hertz_contact is not None:
        rolling = f"slide-to-roll ratio {asked.slide_to_roll:g}, {shifts} places"
        return f"cycles of the {body} body on its way along {along} through the Hertz contact, {rolling}"
    if shifts is not None:
        return f"cycles of the {body} body as the faces move along {along}, {shifts} shifts"
    of = case.stress_title(body).removeprefix("stress in ").removeprefix("both bodies")
    place = of or "either body"
    if case.bodies[body].coating is not None:
        place += ", below the coating,"
    return f"cycles as the rough body moves along {along}, in {place} as if it were the smooth one"
