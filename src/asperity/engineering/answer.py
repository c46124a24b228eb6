"""The answer of a case: its numbers in SI units, as text, as tables, and the peaks of the stress."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import groupby
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.contact.gap import FilmFlow, Percolation
from asperity.contact.slip import PartialSlip
from asperity.core.markup import picture, table, with_error
from asperity.core.units import DIMENSIONS, scaled_unit, shown_si
from asperity.engineering.body_stress import DIRECTION, BodyAnswer
from asperity.engineering.case import CONTROL_UNITS, HARDNESS_OVER_YIELD, TANGENTIAL, Body, Case
from asperity.engineering.contact_numbers import IN_FULL_CONTACT, ContactNumbers, gap_of, gap_rows, slip_rows
from asperity.engineering.face import RoughFace
from asperity.engineering.load_curve import YIELD_LOAD_ERROR, AnswerCurve
from asperity.stress.cycles.survival import cracks_per_area, weibull_exponent
from asperity.stress.peaks.selection import peaks
from asperity.surface.treatment.treatment import TreatedMap

EXTREME_WORDS = {
    "largest_shear": "largest shear stress (Tresca)",
    "principal_1": "largest tensile stress",
    "principal_3": "largest compressive stress",
    "hydrostatic": "largest hydrostatic pressure",
}
"""Field → name of its extreme value among the numbers, beside the von Mises stress."""

LIMITS = {
    "real contact": ("area_fraction", None),
    "rms gradient in contact": ("gradient_rms_contact", None),
    "largest pressure": ("largest", "pressure"),
    "largest von Mises stress": ("largest", "von_mises"),
    "90th percentile of the peaks": ("p90", "von_mises"),
    "99th percentile of the peaks": ("p99", "von_mises"),
}
"""Number that is estimated for vanishing pixels → its variable and quantity in `asperity.continuum`."""

IN_PER_CENT = (
    *("real contact", "plastic real contact", "share above yield"),
    *("area at the hardness", "load at the hardness"),
)
"""Dimensionless numbers that are shown in per cent."""

POSITION_NAMES = "at depth", "at x", "at y"
"""Numbers that give the position of another one."""

ALIKE = 0.01
"""Relative difference up to which numbers of two bodies of one material are shown once."""

REPEATS = (
    f"upper body: of the same material; its numbers are listed where they differ by more than {ALIKE:.0%}"
)

CYCLE_WORDS = {
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

PERCENTS = (50, 90, 99)
"""Percentiles of the von Mises peaks below the contacts that are listed."""

GAP_SHARES = np.linspace(0, 1, 101)
"""Shares of the area for which the gap is listed."""

CONDUCTANCE_UNITS = {"thermal_conductance": "W/(m² K)", "electrical_conductance": "S/m²"}
"""Conductance per nominal area → its unit."""

UNCERTAINTIES = 3
"""Number of uncertainties shown above the answer, the largest ones."""

PEAK_COLUMNS = {"value": "value_Pa", "depth": "depth_m", "y": "y_m", "x": "x_m", "interior": "in_solid"}
"""Name of a property of peaks → its column in the table of peaks."""


class Advice(NamedTuple):
    """A warning or a note.

    Attributes
    ----------
    level : "warning" or "note"
        A warning says that a number of the answer must not be used without a check; a note adds
        information.
    subject : str
        Short heading.
    text : str
        One or two sentences.
    short : str
        The uncertainty of the answer in a few words; empty if there is none.
    size : float
        Relative size of that uncertainty.
    """

    level: str
    subject: str
    text: str
    short: str = ""
    size: float = 0.0


class Row(NamedTuple):
    """One line of the answer: group, name, value in SI, its unit, and all numbers for a reader.

    The estimate for vanishing pixels and its error are NaN where there is none.
    """

    group: str
    name: str
    value: float
    unit: str
    shown: str
    estimate: float = float("nan")
    error: float = float("nan")

    @property
    def with_error(self) -> str:
        """The estimate and its error as text; empty where there is none."""
        if not self.error > 0:
            return ""
        factor, symbol = (
            (1.0, "") if self.unit == "1" else scaled_unit([self.estimate, self.error], self.unit)
        )
        if self.name in IN_PER_CENT:
            factor, symbol = 0.01, "%"
        return f"{with_error(self.estimate / factor, self.error / factor)} {symbol}".strip()


AnyRow = TypeVar("AnyRow", bound=Any)


@dataclass(frozen=True, eq=False, repr=False)
class Answer:
    """The answer of a case; ``print`` shows it, `frame` returns it as a table.

    Attributes
    ----------
    case : Case
    rough : RoughFace
        The rough surface that was pressed, in m, what was done to the map, and what is doubtful about it.
    contact : Contact
        In SI units.
    spots : DataFrame
        Patches of contact on the map; see `asperity.engineering.contact_numbers.contact_spots`.
    numbers : ContactNumbers
    bodies : dict
        ``lower`` and, if it is elastic, ``upper`` → `BodyAnswer`.
    neighbours : (float, Contact or None) or None
        Width of the contact of a ball or cylinder over the distance to its periodic images (the larger ratio
        along y and x, or across the cylinder), and the contact under the same load without images (None for
        layers and cylinders). None without such a form, or with a free boundary.
    plastic : Contact or None
        With pressure limited to the hardness; 3 times the yield stress if none is given.
    curve : AnswerCurve or None
        Of several loads.
    unfiltered : Contact or None
        Under the same load without the Gaussian filters; None if there are none.
    coarse : dict or None
        Name of a number of partial slip or of the gap → its value with pixels twice as large.
    paths : Percolation or None
        Of contact and gap.
    flow : FilmFlow or None
        Of a film through the gap, on the map.
    slip : PartialSlip or None
        Under the tangential force or displacement.
    cycle : DataFrame or None
        Force and displacement in a cycle between the tangential force and its opposite.
    advice : tuple of Advice
        Warnings and notes, warnings first.
    """

    case: Case
    rough: RoughFace
    contact: Contact
    spots: pd.DataFrame
    numbers: ContactNumbers
    bodies: dict[str, BodyAnswer]
    neighbours: tuple[float, Contact | None] | None = None
    plastic: Contact | None = None
    curve: AnswerCurve | None = None
    unfiltered: Contact | None = None
    coarse: Mapping[str, float] | None = None
    paths: Percolation | None = None
    flow: FilmFlow | None = None
    slip: PartialSlip | None = None
    cycle: pd.DataFrame | None = None
    advice: tuple[Advice, ...] = ()

    @property
    def face(self) -> TreatedMap:
        """The rough surface that was pressed."""
        return self.rough.face

    @property
    def title(self) -> str:
        """Name of the map, and the case in words."""
        return f"{self.face.name}: {case_in_words(self.case)}"

    @cached_property
    def rows(self) -> list[Row]:
        """All numbers, line by line."""
        shown, area = [], shown_si(self.numbers.nominal_area, "m^2")
        words_of = {
            "area_fraction": f"{100 * self.numbers.area_fraction:.4g} % of {area}",
            "patches": f"{self.numbers.patches}, {self.numbers.contact_nodes} nodes",
        }
        for field in fields(ContactNumbers):
            if field.metadata:
                unit, value = field.metadata["unit"], getattr(self.numbers, field.name)
                words = words_of.get(field.name) or shown_si(value, unit)
                limits = self.bodies["lower"].limits
                shown.append(_row("contact", field.metadata["name"], value, unit, words, limits))
        shown += _hertz_rows(self.case)
        for name, resistivity in self.case.resistivities.items():
            value, unit = self.contact.conductance(resistivity), CONDUCTANCE_UNITS[name]
            words = name.replace("_", " contact ")
            number = IN_FULL_CONTACT if np.isposinf(value) else f"{value:.4g} {unit}"
            shown.append(Row("contact", words, value, unit, f"{number}, without films and gap"))
        if self.plastic is not None:
            shown += _plastic_rows(self.plastic, self.case.hardness is not None, self.numbers.rms_gradient)
        if self.paths is not None:
            numbers = gap_rows(self.paths, self.flow, self.face, self.case.flow_direction or "x")
            shown += [Row("gap", *row) for row in numbers]
        if self.slip is not None:
            shown += [Row("partial slip", *row) for row in slip_rows(self.slip, self.face.map_area)]
        if self.curve is not None:
            shown += _curve_rows(self.curve, len(self.case.bodies) > 1)
        for name in self.case.different_bodies:
            shown += [*_body_rows(self, name), *_cycle_rows(self, name)]
        return shown

    @property
    def uncertainties(self) -> list[str]:
        """The largest uncertainties of the answer in a few words, the largest first."""
        sized = sorted((advice for advice in self.advice if advice.short), key=lambda advice: -advice.size)
        return list(dict.fromkeys(advice.short for advice in sized))[:UNCERTAINTIES]

    def frame(self) -> pd.DataFrame:
        """All numbers as a table; the columns are described in ``docs/tables.md``."""
        return pd.DataFrame(self.rows, columns=Row._fields).drop(columns="shown")

    def gaps(self) -> pd.DataFrame:
        """Gap below which a share of the area of the map lies: share, gap_m."""
        gaps = np.quantile(gap_of(self.face, self.contact), GAP_SHARES)
        return pd.DataFrame({"share": GAP_SHARES, "gap_m": gaps})

    def peaks(self) -> pd.DataFrame:
        """Peaks of the contact pressure and of the fields of the answer, those of largest magnitude first.

        Columns: body, quantity, value_Pa, depth_m, y_m, x_m, in_solid, under_contact. Positions are those on
        the map; the peaks of its mirror images are left out. A peak on the edge of a mirrored map, between
        two equal nodes, is listed once.
        """
        tables = []
        for body in self.case.different_bodies:
            stress = self.bodies[body].stress
            names = [str(name) for name in stress.variables if stress[name].dims == ("peak",)]
            table = pd.DataFrame({name.removeprefix("peak_"): stress[name].values for name in names})
            table = table.rename(columns=PEAK_COLUMNS)
            own = self.face.is_on_map(table["y_m"].to_numpy(), table["x_m"].to_numpy())
            table = table[own & table["quantity"].isin(("pressure", *self.case.fields))]
            cycles, limit = self.bodies[body].cycles, self.case.bodies[body].fatigue_torsion
            if cycles is not None and "dang_van" in cycles and limit is not None:
                # Maxima over rows of the largest Dang Van stress of each row.
                axis, of_row = cycle_axis(cycles), cycles["dang_van"].max("cycle_depth").values
                above = (of_row > np.roll(of_row, 1)) & (of_row >= np.roll(of_row, -1))
                row = np.flatnonzero((of_row > 0) & above)
                deepest = cycles["dang_van"].argmax("cycle_depth").values[row]
                values = {"value_Pa": limit * of_row[row], "depth_m": cycles["cycle_depth"].values[deepest]}
                places = {"y_m": 0.0, "x_m": 0.0} | {f"{axis}_m": cycles[f"cycle_{axis}"].values[row]}
                rows = pd.DataFrame(values | places | {"quantity": "dang_van", "under_contact": True})
                rows["in_solid"] = rows["depth_m"] > 0
                own = self.face.is_on_map(rows["y_m"].to_numpy(), rows["x_m"].to_numpy())
                table = pd.concat([table, rows[own]], ignore_index=True)
            table["y_m"], table["x_m"] = self.face.on_map(table["y_m"], table["x_m"])
            tables.append(table.assign(body=body, size=table["value_Pa"].abs()))
        found = pd.concat(tables, ignore_index=True)
        order = {"body": True, "quantity": False, "size": False}
        found = found.sort_values([*order], ascending=[*order.values()], ignore_index=True)
        return found[["body", "quantity", *PEAK_COLUMNS.values(), "under_contact"]]

    def fatigue(self) -> pd.DataFrame:
        """Volume per nominal area above shares of the fatigue limit: body, share, volume_per_area_m."""
        found = []
        for body in self.case.different_bodies:
            cycles = self.bodies[body].cycles
            if cycles is not None and "fatigue_volume" in cycles:
                volume = cycles["fatigue_volume"].to_series()
                found += [(body, share, value) for share, value in volume[volume > 0].items()]
        return pd.DataFrame(found, columns=["body", "share", "volume_per_area_m"])

    def text(self) -> str:
        """The answer as a block of text, warnings last."""
        width = max(len(row.name) for row in self.rows)
        lines = [self.title]
        if self.uncertainties:
            lines += ["", "largest uncertainties", *(f"  {text}" for text in self.uncertainties)]
        shown = without_repeats(self.rows)
        for group, rows in groupby(shown, key=lambda row: row.group):
            lines += ["", group, *(f"  {row.name:<{width}}  {row.shown}" for row in rows)]
        lines += ["", REPEATS] if len(shown) < len(self.rows) else []
        lines += ["", "what was done to the map", *(f"  {step}" for step in self.face.done)]
        for advice in self.advice:
            lines += ["", f"{advice.level}: {advice.text}"]
        return "\n".join(lines)

    __str__ = text

    def _repr_html_(self) -> str:
        rows = [(row.name, row.shown) for row in self.rows]
        rows += [(advice.level, advice.text) for advice in self.advice]
        return table(self.title, rows, picture(self.contact.pressure, "contact pressure"))

    def __repr__(self) -> str:
        return f"<Answer of {self.title}>"


def without_repeats(rows: Sequence[AnyRow]) -> list[AnyRow]:
    """Rows without numbers of the upper body that equal the lower body's, if both have one material."""
    known = {(row.group, row.name): row.value for row in rows}

    def is_repeated(row: AnyRow) -> bool:
        lower = known.get((row.group.replace("upper body", "lower body"), row.name))
        if "upper body" not in row.group or lower is None:
            return False
        return row.name in POSITION_NAMES or abs(row.value - lower) <= ALIKE * abs(lower)

    return [row for row in rows if not is_repeated(row)]


def case_in_words(case: Case) -> str:
    """Bodies and load in one line."""
    load, kind = case.load, case.load.kind.replace("_", " ").replace("hertz", "Hertz")
    value = shown_si(load.value, CONTROL_UNITS[load.kind])
    if load.kind == "area_fraction":
        kind, value = "real contact area", f"{100 * load.value:.4g} %"
    upper = "a rigid body" if case.upper is None else _material(case.upper)
    direction = case.sliding_direction
    along = direction if isinstance(direction, str) else f"{direction:g}° from x"
    moved = "sliding"
    for name, dimension in TANGENTIAL.items():
        if (imposed := getattr(case, name)) is not None:
            moved = f"{name.replace('_', ' ')} {shown_si(imposed, DIMENSIONS[dimension].unit)}"
    sliding = f", {moved} along {along} with friction {case.friction:g}" if case.friction else ""
    return f"{_material(case.lower)} against {upper}, {kind} imposed: {value}{sliding}"


def body_title(case: Case, name: str) -> str:
    """Heading of the numbers of one body."""
    if case.upper is None:
        return "stress in the elastic body"
    if len(case.different_bodies) == 1:
        return "stress in both bodies"
    return f"stress in the {name} body ({_material(case.bodies[name])})"


def _material(body: Body) -> str:
    layer = "" if body.height is None else f", {shown_si(body.height, 'm')} thick, {body.bottom} bottom"
    if body.coating is not None:
        young, poisson = shown_si(body.layer.young, "Pa"), body.layer.poisson
        layer = f" under {shown_si(body.coating, 'm')} of E = {young}, ν = {poisson:g}"
    return f"E = {shown_si(body.young, 'Pa')}, ν = {body.poisson:g}{layer}"


def _hertz_rows(case: Case) -> Iterator[Row]:
    """The smooth Hertz contact around the map."""
    contact, group = case.hertz_contact, "Hertz contact of the smooth bodies"
    if contact is None or case.hertz is None:
        return
    y, x = case.hertz.at
    shear, depth = contact.largest_shear(case.lower.poisson)
    at = f"at {y:g} half-widths along y and {x:g} along x" if y or x else "in the middle"
    values = {
        "largest Hertz pressure": (contact.largest_pressure, "Pa", ""),
        "half-width along x": (contact.half_width_x, "m", ""),
        "half-width along y": (contact.half_width_y, "m", ""),
        "Hertz pressure on the map": (case.cell_pressure, "Pa", at),
        "largest shear stress, smooth": (
            shear,
            "Pa",
            f"at depth {shown_si(depth, 'm', 3)}, without friction",
        ),
    }
    for name, (value, unit, where) in values.items():
        if math.isfinite(value):
            yield Row(group, name, value, unit, f"{shown_si(value, unit)} {where}".strip())


def _curve_rows(curve: AnswerCurve, several: bool) -> Iterator[Row]:
    loads = curve.numbers["mean_pressure"].values
    group = f"load curve, {loads.size} loads"
    stiffness = float(curve.numbers["stiffness"][-1])
    number = IN_FULL_CONTACT if np.isposinf(stiffness) else f"{shown_si(stiffness * 1e-6, 'Pa')}/µm"
    yield Row(group, "stiffness", stiffness, "Pa/m", f"{number} at the last load")
    for name, load in curve.yield_loads.items():
        value = min(max(load, float(loads[0])), float(loads[-1]))
        words = f"{shown_si(value, 'Pa', 3)} ± {100 * YIELD_LOAD_ERROR:g} %"
        if not 0 < load < np.inf:
            words = f"{'below' if load == 0 else 'above'} {shown_si(value, 'Pa', 3)}, beyond the curve"
        subject = f"the {name} body yields" if several else "yield begins"
        yield Row(group, f"mean pressure where {subject}", value, "Pa", words)


def _plastic_rows(contact: Contact, is_given: bool, rms_gradient: float) -> Iterator[Row]:
    """Numbers of a contact under a hardness, which is given or follows from the yield stress."""
    group, hardness, shares = "plastic contact", shown_si(contact.hardness, "Pa"), {}
    if not is_given:
        hardness += (
            f", if it were {HARDNESS_OVER_YIELD:g} times the yield stress; all other groups are elastic"
        )
        shares["plastic real contact"] = contact.area_fraction
    shares |= {"area at the hardness": contact.plastic_area, "load at the hardness": contact.plastic_load}
    yield Row(group, "hardness", contact.hardness, "Pa", hardness)
    for name, share in shares.items():
        yield Row(group, name, share, "1", f"{100 * share:.4g} %")
    depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
    yield Row(group, "largest plastic depth", depth, "m", shown_si(depth, "m"))
    index = contact.solid.effective_modulus * rms_gradient / contact.hardness
    yield Row(group, "plasticity index", index, "1", f"{index:.3g}, E* × rms gradient / hardness")


def _body_rows(answer: Answer, name_of_body: str) -> Iterator[Row]:
    group, body = body_title(answer.case, name_of_body), answer.bodies[name_of_body]

    def row(name: str, value: float, unit: str = "Pa", shown: str = "", error: float = np.nan) -> Row:
        return _row(group, name, value, unit, shown or shown_si(value, unit), body.limits, error)

    yield row("largest von Mises stress", body.largest_von_mises)
    yield row("at depth", body.depth, "m")
    factor, symbol = scaled_unit([body.x, body.y], "m")
    for axis, position in (("x", body.x), ("y", body.y)):
        yield row(f"at {axis}", position, "m", f"{position / factor:.4g} {symbol}")
    for field, name in EXTREME_WORDS.items():
        found = body.largest[field]
        value = DIRECTION[field] * found.value
        depth = f"at depth {shown_si(found.depth, 'm')}" if found.depth else "in the surface"
        shown, error = f"{shown_si(value, 'Pa')} {depth}", body.grid_error(field) * value
        yield row(name, value, "Pa", shown, error) if value > 0 else row(name, 0.0, "Pa", "none")
    if body.interface is not None:
        for material, part in body.materials.items():
            place = f"at depth {shown_si(part.depth, 'm')}"
            value, name = part.largest_von_mises, f"largest von Mises stress in the {material}"
            yield row(name, value, "Pa", f"{shown_si(value, 'Pa')} {place}")
        yield row("largest shear stress on the interface", max(body.interface["shear"]))
        tension = max(body.interface["zz"][0], 0.0)
        yield row("largest tension across the interface", tension, "Pa", "" if tension else "none")
        for material, value in zip(body.materials, body.interface["xx"], strict=True):
            yield row(f"σ_xx on the interface, in the {material}", value)
        if body.body.coating_yield is not None:
            yield row("yield stress of the coating", body.body.coating_yield)
    found_peaks = np.abs(peaks(body.stress, "von_mises", selection="under_contact")["peak_value"].values)
    for percent in PERCENTS if found_peaks.size else ():
        value = float(np.percentile(found_peaks, percent))
        yield row(f"{percent}th percentile of the peaks", value, "Pa", shown_si(value, "Pa", 3))
    if (limit := body.body.yield_stress) is None:
        return
    yield row("yield stress", limit)
    volume, depths, fraction = body.volume_above_yield, body.depths_above_yield, body.fraction_above_yield
    per_area, error = ((volume or 0.0) / answer.face.map_area, body.volume_error / answer.face.map_area)
    shown, source = shown_si(per_area, "m"), "the pixels and planes"
    of_area = _row(group, "volume above yield per area", per_area, "m", shown, body.limits, error, source)
    if volume is None or depths is None or fraction is None:
        yield row("volume above yield", 0.0, "m^3", "none: everything stays elastic")
        yield of_area
    else:
        first, last = depths
        factor, symbol = scaled_unit([last], "m")
        share = f"{100 * fraction:.3g} % of the volume down to {shown_si(last, 'm', 3)}"
        between = f"depths from {first / factor:.3g} to {last / factor:.3g} {symbol}"
        yield row("volume above yield", volume, "m^3", shown_si(volume, "m^3", 3))
        yield of_area
        yield _row(group, "share above yield", fraction, "1", share, body.limits, error / last, source)
        yield row("deepest point above yield", last, "m", between)
    all_peaks = answer.peaks().query("body == @name_of_body and quantity == 'von_mises'")
    below = all_peaks["depth_m"] > (body.body.coating or -1.0)
    density = int(((all_peaks["value_Pa"] > limit) & below).sum()) / answer.numbers.nominal_area
    yield row("peaks above yield", density, "1/m^2", f"{1e-6 * density:.4g} per mm²")


def _cycle_rows(answer: Answer, name: str) -> Iterator[Row]:
    """The worst stress cycles of a body, and the probability that no crack starts."""
    body, group = answer.bodies[name], cycles_title(answer.case, name)
    cycles = body.cycles
    if cycles is None:
        return
    for variable, (words, unit) in CYCLE_WORDS.items():
        if variable in cycles:
            value, depth, *place = cycles.attrs[f"worst_{variable}"]
            axes = [cycle_axis(cycles), *("x" for _ in place[1:])]
            positions = {"y": 0.0, "x": 0.0} | dict(zip(axes, place, strict=True))
            y, x = answer.face.on_map(positions["y"], positions["x"])
            on_map = {"y": shown_si(float(y), "m"), "x": shown_si(float(x), "m")}
            at = ", ".join(f"{axis} = {on_map[axis]}" for axis in axes)
            few = cycles.attrs.get("few_shifts_error", 0.0)
            error = float(np.hypot(np.nan_to_num(body.grid_error(variable)), few)) * abs(value)
            source = "the pixels and the shifts" if few else "the pixels"
            shown = f"{shown_si(value, unit)} at depth {shown_si(depth, 'm')}, {at}"
            yield _row(group, words, value, unit, shown, body.limits, error, source)
    if "fatigue_volume" not in cycles:
        return
    for share in LIMIT_SHARES:
        value = float(cycles["fatigue_volume"].interp(fatigue_share=share))
        name = f"volume above {100 * share:g} % of the limit per area"
        yield Row(group, name, value, "m", shown_si(value, "m"))
    case, area = answer.case, answer.numbers.nominal_area
    if case.fatigue_scatter is not None and case.fatigue_volume is not None:
        cracks = cracks_per_area(cycles, case.fatigue_scatter, case.fatigue_volume)
        exponent = f"Weibull exponent {weibull_exponent(case.fatigue_scatter):.3g}"
        yield Row(group, CRACKS, cracks, "1/m^2", f"{1e-6 * cracks:.3g} per mm², {exponent}")
        none = math.exp(-cracks * area)
        shown = f"{none:.4g} on {shown_si(area, 'm^2')}; one starts with {-math.expm1(-cracks * area):.2g}"
        yield Row(group, "probability of no crack on the map", none, "1", shown)


def cycle_axis(cycles: xr.Dataset) -> str:
    """Axis of the cycles beside the depth, ``"y"`` or ``"x"``."""
    return "x" if "cycle_x" in cycles.coords else "y"


def cycles_title(case: Case, name: str) -> str:
    """Heading of the cycles of one body."""
    along = case.sliding_direction
    along = along if isinstance(along, str) else f"{along:g}° from x"
    if case.shifts is not None and case.hertz is not None:
        rolling = f"slide-to-roll ratio {case.slide_to_roll:g}, {case.shifts} places"
        return f"cycles of the {name} body on its way along {along} through the Hertz contact, {rolling}"
    if case.shifts is not None:
        return f"cycles of the {name} body as the faces move along {along}, {case.shifts} shifts"
    of = body_title(case, name).removeprefix("stress in ").removeprefix("both bodies")
    place = of or "either body"
    if case.bodies[name].coating is not None:
        place += ", below the coating,"
    return f"cycles as the rough body moves along {along}, in {place} as if it were the smooth one"


def _row(
    group: str,
    name: str,
    value: float,
    unit: str,
    shown: str,
    limits: xr.Dataset,
    error: float = np.nan,
    source: str = "the pixels",
) -> Row:
    """A line, with the estimate for vanishing pixels if there is one, else with the error of the value."""
    estimate, words = value, f"by {source}"
    if name in LIMITS:
        values, words = limit_of(limits, name), "for vanishing pixels"
        estimate, error = values["estimate"], values["estimate"] * values["error"]
    if not np.isfinite(estimate) or not error > 0:
        return Row(group, name, value, unit, shown, *((estimate, 0.0) if error == 0 else ()))
    row = Row(group, name, value, unit, shown, estimate, error)
    number = row.with_error if name in LIMITS else row.with_error[row.with_error.index("±") :]
    return row._replace(shown=f"{shown}; {number} {words}")


def limit_of(limits: xr.Dataset, name: str) -> dict[str, float]:
    """Kind → value of a number of `LIMITS` in a result of `asperity.continuum`."""
    output, quantity = LIMITS[name]
    values = limits[output] if quantity is None else limits[output].sel(quantity=quantity)
    return dict(zip(limits["kind"].values.tolist(), values.values.ravel().tolist(), strict=True))
