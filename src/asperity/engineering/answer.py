"""The answer of a case: its numbers in SI units, as text, as tables, and the peaks of the stress."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.markup import picture, table
from asperity.core.units import scaled_unit, shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.body_stress import DIRECTION, BodyAnswer
from asperity.engineering.contact_numbers import ContactNumbers, gap_of
from asperity.engineering.continuum import HalfGrid
from asperity.engineering.face import RoughFace
from asperity.engineering.places import Blocks, blocks_of
from asperity.engineering.question import HARDNESS_OVER_YIELD, Advice, Question, Row, per_cent
from asperity.settings.load import UNITS, Hertz
from asperity.stress.peaks.selection import has_percentile, select_peaks
from asperity.surface.treatment.treatment import TreatedMap

if TYPE_CHECKING:
    from asperity.engineering.case import Case

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
"""Number that is estimated for vanishing pixels → its variable and quantity in `asperity.continuum_limit`."""

POSITION_NAMES = "at depth", "at x", "at y"
"""Numbers that give the position of another one."""

ALIKE = 0.01
"""Relative difference up to which numbers of two bodies of one material are shown once."""

CONTACT_TILES = ("real contact", "largest pressure", "largest von Mises stress")
"""Numbers of contact and stress at the top of the report."""

ONE_PLACE = (
    "the map is from one place of the surface: an error by the pixels does not show how places differ; "
    "several maps (--pooled) do"
)

INTERFACE_TILES = "largest shear stress on the interface", "largest tension across the interface"
"""Numbers of the interface of a coating, in the order of `Interface.largest`."""

REPEATS = (
    f"upper body: of the same material; its numbers are listed where they differ by more than {ALIKE:.0%}"
)

PERCENTS = (50, 90, 99)
"""Percentiles of the von Mises peaks below the contacts that are listed."""

GAP_SHARES = np.linspace(0, 1, 101)
"""Shares of the area for which the gap is listed."""

UNCERTAINTIES = 3
"""Number of uncertainties shown above the answer, the largest ones."""

PEAK_COLUMNS = {"value": "value_Pa", "depth": "depth_m", "y": "y_m", "x": "x_m", "interior": "in_solid"}
"""Name of a property of peaks → its column in the table of peaks."""


AnyRow = TypeVar("AnyRow", bound=Any)


@dataclass(eq=False, repr=False)
class Answer:
    """The answer of a case; ``print`` shows it, `frame` returns it as a table.

    Attributes
    ----------
    case : Case
        The case as it was asked.
    pressed : Case
        The case as the bodies were pressed: questions such as film and run-in change load or hardness.
    rough : RoughFace
        The rough surface that was pressed, in m, with the treatment of its map, and doubts about the map.
    contact : Contact
        In SI units.
    half : HalfGrid
        The contact on half of the nodes.
    spots : DataFrame
        Patches of contact on the map; see `asperity.engineering.contact_numbers.contact_spots`.
    numbers : ContactNumbers
    found : dict
        Name of a question → its result.
    bodies : dict
        ``lower`` and, if it is elastic, ``upper`` → `BodyAnswer`.
    neighbours : (float, Contact or None) or None
        Width of the contact of a ball or cylinder over the distance to its periodic images (the larger ratio
        along y and x, or across the cylinder), and the contact under the same load without images (None for
        layers and cylinders). None without such a form, or with a free boundary.
    plastic : Contact or None
        With pressure limited to the hardness; 3 times the yield stress if none is given.
    unfiltered : Contact or None
        Under the same load without the Gaussian filters; None if there are none.
    advice : tuple of Advice
        Warnings and notes, warnings first.
    """

    case: Case
    pressed: Case
    rough: RoughFace
    contact: Contact
    half: HalfGrid
    spots: pd.DataFrame
    numbers: ContactNumbers
    found: dict[str, Any]
    bodies: dict[str, BodyAnswer] = field(default_factory=dict)
    neighbours: tuple[float, Contact | None] | None = None
    plastic: Contact | None = None
    unfiltered: Contact | None = None
    advice: tuple[Advice, ...] = ()

    def of(self, question: Question) -> Any:
        """The result of a question of the case."""
        return self.found[next(name for name, each in self.case.questions.items() if each is question)]

    @property
    def nominal_pressure(self) -> float:
        """Mean pressure on the map, of which a film may carry a part."""
        film = self.case.film
        return self.contact.mean_pressure / (1 - (0.0 if film is None else film.share))

    def loaded_body(self, contact: Contact, body: str) -> LoadedSolid:
        """A body under a contact: the contact of the answer, or the contact on half of its nodes."""
        for question in self.case.questions.values():
            if (loaded := question.loaded(self, contact, body)) is not None:
                return loaded
        return self.case.loaded_body(contact, body)

    def suffix_of(self, body: str) -> str:
        """End of the names of the files of one body, if there are two."""
        return f"_{body}" if len(self.case.different_bodies) > 1 else ""

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
        for each in fields(ContactNumbers):
            if each.metadata:
                unit, value = each.metadata["unit"], getattr(self.numbers, each.name)
                words = words_of.get(each.name) or shown_si(value, unit)
                limits = self.bodies["lower"].limits
                row = _row("contact", each.metadata["name"], value, unit, words, limits)
                shown.append(row.of_places(self.area_of_places) if each.name == "area_fraction" else row)
        shown += _hertz_rows(self.case)
        questions = self.case.questions.values()
        if self.plastic is not None:
            shown += _plastic_rows(self.plastic, self.pressed.hardness is not None, self.numbers.rms_gradient)
        for question in questions:
            shown += question.rows(self)
        for name in self.case.different_bodies:
            shown += _body_rows(self, name)
            for question in questions:
                shown += question.rows_of_body(self, name)
        if (asked := self.case.sensitivity) is not None:
            shown = [row.of_inputs(asked.relative_error(self, row)) for row in shown]
        groups = list(dict.fromkeys(row.group for row in shown))
        return sorted(shown, key=lambda row: groups.index(row.group))

    @cached_property
    def blocks(self) -> Blocks | None:
        """Blocks of the map, whose scatter gives the error by place; None if too few, or with a form.

        Under an imposed approach or real contact the numbers do not follow the load on a block.
        """
        imposed = self.case.load.kind in ("approach", "area_fraction")
        if imposed or self.case.map.radius is not None or self.face.boundary == "free":
            return None
        return blocks_of(self.face, self.contact.pressure)

    @cached_property
    def area_of_places(self) -> float:
        """Relative error of the real contact from place to place; NaN where it is not known."""
        if self.blocks is None:
            return np.nan
        return self.blocks.error(self.blocks.means(self.contact.pressure > 0))

    @property
    def tiles(self) -> list[Row]:
        """Rows at the top of the page: answers to the questions, then numbers of the contact."""
        rows = without_repeats(self.rows)
        return [row for name in tile_names(self.case) for row in rows if row.name == name]

    @property
    def verdicts(self) -> list[str]:
        """The answer to each question in a sentence, then a sentence about interfaces and the contact."""
        found = [question.verdict(self) for question in self.case.questions.values()]
        for name in self.case.different_bodies:
            if (interface := self.bodies[name].interface) is not None:
                shear, tension = (max(each.value, 0.0) for each in interface.largest.values())
                pulled = f"a tension of up to {shown_si(tension, 'Pa', 3)}" if tension else "no tension"
                shown = f"shear of up to {shown_si(shear, 'Pa', 3)} and {pulled}"
                found.append(f"the interface of the coating of the {name} body bears {shown}")
        pressure = shown_si(self.numbers.largest_pressure, "Pa", 3)
        contact = f"the bodies touch on {per_cent(self.numbers.area_fraction)} of the area"
        found.append(f"{contact}, under a pressure of up to {pressure}")
        return [f"{text[0].upper()}{text[1:]}." for text in found if text]

    @property
    def uncertainties(self) -> list[str]:
        """The largest uncertainties of the answer in a few words, the largest first."""
        sized = sorted((advice for advice in self.advice if advice.short), key=lambda advice: -advice.size)
        return list(dict.fromkeys(advice.short for advice in sized))[:UNCERTAINTIES]

    def frame(self) -> pd.DataFrame:
        """All numbers as a table; the columns are described in ``docs/tables.md``."""
        found = pd.DataFrame(self.rows, columns=Row._fields).drop(columns="shown")
        return found.assign(error_of=found["error_of"].replace("", None))

    def advice_table(self) -> pd.DataFrame:
        """Verdicts, warnings and notes: level, subject, text."""
        found = [("verdict", "", text) for text in self.verdicts]
        found += [(each.level, each.subject, each.text) for each in self.advice]
        return pd.DataFrame(found, columns=["level", "subject", "text"])

    def gaps(self) -> pd.DataFrame:
        """Gap below which a share of the area of the map lies: share, gap_m."""
        gaps = np.quantile(gap_of(self.contact), GAP_SHARES)
        return pd.DataFrame({"share": GAP_SHARES, "gap_m": gaps})

    def peaks(self) -> pd.DataFrame:
        """Peaks of the contact pressure and of the fields of the answer, the largest magnitudes first.

        Columns: body, quantity, value_Pa, depth_m, y_m, x_m, in_solid, under_contact.
        """
        tables = []
        for body in self.case.different_bodies:
            stress = self.bodies[body].stress
            names = [str(name) for name in stress.variables if stress[name].dims == ("peak",)]
            table = pd.DataFrame({name.removeprefix("peak_"): stress[name].values for name in names})
            table = table.rename(columns=PEAK_COLUMNS)
            table = table[table["quantity"].isin(("pressure", *self.case.fields))]
            more = [question.peaks(self, body) for question in self.case.questions.values()]
            table = pd.concat([table, *(rows for rows in more if rows is not None)], ignore_index=True)
            tables.append(table.assign(body=body, size=table["value_Pa"].abs()))
        found = pd.concat(tables, ignore_index=True)
        order = {"body": True, "quantity": False, "size": False}
        found = found.sort_values([*order], ascending=[*order.values()], ignore_index=True)
        return found[["body", "quantity", *PEAK_COLUMNS.values(), "under_contact"]]

    def text(self) -> str:
        """The answer as a block of text, warnings last."""
        width = max(len(row.name) for row in self.rows)
        lines = [self.title, "", *self.verdicts]
        if self.uncertainties:
            lines += ["", "largest uncertainties", *(f"  {text}" for text in self.uncertainties)]
        shown = without_repeats(self.rows)
        for group, rows in groupby(shown, key=lambda row: row.group):
            lines += ["", group, *(f"  {row.name:<{width}}  {row.shown}" for row in rows)]
        lines += ["", ONE_PLACE]
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


def tile_names(case: Case) -> list[str]:
    """Names of the numbers at the top of a page: first of the questions of the case, then of the contact."""
    of_questions = [name for question in case.questions.values() for name in question.TILES]
    coated = any(body.coating is not None for body in case.bodies.values())
    return list(dict.fromkeys([*(INTERFACE_TILES if coated else ()), *of_questions, *CONTACT_TILES]))


def without_repeats(rows: Sequence[AnyRow]) -> list[AnyRow]:
    """Rows without those numbers of the upper body that equal the lower body's, if both have one material."""
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
    value = shown_si(load.value, UNITS[load.kind])
    if load.kind == "area_fraction":
        kind, value = "real contact area", f"{100 * load.value:.4g} %"
    counter = case.elastic_counter_body
    upper = "a rigid body" if counter is None else counter.in_words
    direction = case.sliding_direction
    along = direction if isinstance(direction, str) else f"{direction:g}° from x"
    sliding = f", sliding along {along} with friction {case.friction:g}" if case.friction else ""
    if (slip := case.partial_slip) is not None:
        moved = "tangential force " + shown_si(slip.tangential_force or 0.0, "N")
        if slip.tangential_displacement is not None:
            moved = "tangential displacement " + shown_si(slip.tangential_displacement, "m")
        sliding = f", {moved} along {along} with friction {case.friction:g}"
    return f"{case.body.in_words} against {upper}, {kind} imposed: {value}{sliding}"


def _hertz_rows(case: Case) -> Iterator[Row]:
    """The smooth Hertz contact around the map."""
    contact, load, group = case.hertz_contact, case.load, "Hertz contact of the smooth bodies"
    if contact is None or not isinstance(load, Hertz):
        return
    y, x = load.at
    shear, depth = contact.largest_shear(case.body.poisson)
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


def _plastic_rows(contact: Contact, is_given: bool, rms_gradient: float) -> Iterator[Row]:
    """Numbers of a contact under a hardness, which is given or follows from the yield stress."""
    group, hardness, shares = "plastic contact", shown_si(contact.hardness, "Pa"), {}
    if not is_given:
        given = f"{HARDNESS_OVER_YIELD:g} times the yield stress"
        hardness += f", if it were {given}; all other groups are elastic"
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
    group, body = answer.case.stress_title(name_of_body), answer.bodies[name_of_body]
    coating = body.body.coating

    def row(name: str, value: float, unit: str = "Pa", shown: str = "", error: float = np.nan) -> Row:
        return _row(group, name, value, unit, shown or shown_si(value, unit), body.limits, error)

    yield row("largest von Mises stress", body.largest_von_mises)
    yield row("at depth", body.depth, "m")
    factor, symbol = scaled_unit([body.x, body.y], "m")
    for axis, position in (("x", body.x), ("y", body.y)):
        yield row(f"at {axis}", position, "m", f"{position / factor:.4g} {symbol}")
    for name_of_field, name in EXTREME_WORDS.items():
        found = body.largest[name_of_field]
        value = DIRECTION[name_of_field] * found.value
        depth = f"at depth {shown_si(found.depth, 'm')}" if found.depth else "in the surface"
        shown, error = f"{shown_si(value, 'Pa')} {depth}", body.grid_error(name_of_field) * value
        yield row(name, value, "Pa", shown, error) if value > 0 else row(name, 0.0, "Pa", "none")
    if body.interface is not None:
        for material, part in body.materials.items():
            place = f"at depth {shown_si(part.depth, 'm')}"
            value, name = part.largest_von_mises, f"largest von Mises stress in the {material}"
            yield row(name, value, "Pa", f"{shown_si(value, 'Pa')} {place}")
        for name, found in zip(INTERFACE_TILES, body.interface.largest.values(), strict=True):
            place = f"x = {shown_si(found.x, 'm')}, y = {shown_si(found.y, 'm')}"
            shown = f"{shown_si(found.value, 'Pa')} at {place}"
            yield row(name, max(found.value, 0.0), "Pa", shown if found.value > 0 else "none")
        for material, value in zip(body.materials, body.interface.along, strict=True):
            yield row(f"σ_xx on the interface, in the {material}", value)
        if coating is not None and coating.residual_stress:
            energy = (1 - coating.poisson) * coating.residual_stress**2 * coating.thickness / coating.young
            shown = f"{energy:.3g} J/m², which a coating that comes off sets free"
            yield row("energy of the residual stress of the coating", energy, "J/m^2", shown)
        if coating is not None and coating.yield_stress is not None:
            yield row("yield stress of the coating", coating.yield_stress)
    peaks = select_peaks(body.stress, "von_mises", selection="under_contact")["peak_value"].values
    for percent in PERCENTS:
        if has_percentile(peaks.size, percent / 100):
            value = float(np.percentile(np.abs(peaks), percent))
            yield row(f"{percent}th percentile of the peaks", value, "Pa", shown_si(value, "Pa", 3))


def _row(
    group: str,
    name: str,
    value: float,
    unit: str,
    shown: str,
    limits: xr.Dataset,
    error: float = np.nan,
) -> Row:
    """A line, with the estimate for vanishing pixels if there is one, else with the error of the value."""
    if name not in LIMITS:
        return Row(group, name, value, unit, shown).by(error)
    values = limit_of(limits, name)
    estimate, error = values["estimate"], values["estimate"] * values["error"]
    row = Row(group, name, value, unit, shown, estimate, error, "the pixels")
    if not np.isfinite(estimate) or not error > 0:
        return Row(group, name, value, unit, shown)
    return row._replace(shown=f"{shown}; {row.with_error} for vanishing pixels")


def limit_of(limits: xr.Dataset, name: str) -> dict[str, float]:
    """Kind → value of a number of `LIMITS` in a result of `asperity.continuum_limit`."""
    output, quantity = LIMITS[name]
    values = limits[output] if quantity is None else limits[output].sel(quantity=quantity)
    return dict(zip(limits["kind"].values.tolist(), values.values.ravel().tolist(), strict=True))
