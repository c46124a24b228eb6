"""Percolation of the gap between the bodies, and leakage of a fluid through it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.contact.half_grid import solve_on_half
from asperity.core.packages import require
from asperity.core.types import Array, Progress
from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.continuum import solved_on_half
from asperity.engineering.face import RoughFace
from asperity.engineering.numbers import elastic_record
from asperity.engineering.press import press
from asperity.engineering.question import (
    Findings,
    Picture,
    Question,
    Stages,
    advice_on_pixels,
    on_map,
    part_of,
)
from asperity.engineering.records import (
    DISCRETISATION,
    FLOW_RATE,
    PER_WIDTH,
    POSITIVE,
    SEARCH,
    Advice,
    Position,
    Record,
)
from asperity.engineering.scene import Scene
from asperity.settings.model import YesNo, optional, setting
from asperity.settings.quantities import Pressure, Viscosity
from asperity.surface.treatment.treatment import TreatedMap

if TYPE_CHECKING:
    from asperity.contact.gap import Percolation
    from asperity.contact.reynolds import FilmFlow

GASES = 1e-4
"""Viscosity in Pa s below which a fluid is a gas."""

TOPIC = "gap"

FLOW_CAPTION = (
    "Film that leaks through the gap: volume per time and width over its mean, and pressure. In the black "
    "parts the gap is closed, or no path leads to an edge."
)

LEAST_FLUX = 1e-3
"""Flux over the mean one at the lower end of the colours."""

LEAST_WIDTH = 1e-9
"""Width in m below which a constriction is smaller than a few molecules."""

SEALING_LOAD, SEALING_ERROR = "mean pressure that seals", 0.01
"""The load that seals, and its relative error; half of the error costs one contact more."""

SEALING_CONTACTS, MOST_CONTACTS = 12, 40
"""Usual number of contacts to find the load that seals, and the most."""

BELOW_HARDNESS = 0.99
"""Largest mean pressure over the hardness under which the load that seals is searched."""

LEAST_LOAD = 1e-12
"""Load over the load of the case below which every load seals."""

WIDE = 10
"""Maximum over minimum of a picture above which its colours, or its axis, are logarithmic."""

CLOSE_UP = 20
"""Pixels to each side of the narrowest constriction in its picture."""


class Leak(Question):
    """Percolation of the gap, and leakage of a fluid through it; see `asperity.contact.film_flow`."""

    ASKS = "Does the gap leak?"
    TILES = (
        *("leakage along x", "leakage along y", SEALING_LOAD),
        *("narrowest constriction along x", "narrowest constriction along y"),
    )
    LEAD = "constriction"
    FILES = ("constriction", "flow")

    direction: Literal["x", "y"] = setting("x")
    """Direction in which the fluid leaks."""
    viscosity: Viscosity | None = optional("percolation alone, no leakage", example="30 mPa s")
    """Dynamic viscosity of the fluid; needs `asperity[flow]`."""
    pressure_difference: Pressure | None = optional("percolation alone, no leakage", example="5 bar")
    """Fall of the pressure of the fluid over the length of the map."""
    seal: YesNo | None = optional("with a load curve", example=True)
    """Search the mean pressure that seals the gap, from any load."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """A viscosity without a pressure difference, or the other way round; the flow needs a package."""
        names = ("viscosity", "pressure_difference")
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) == 1:
            yield f"leak.{given[0]}", f": needs leak.{({*names} - {*given}).pop()}"
        elif given and rough is not None:
            require(["pyamg"])

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """The flow is solved on the map and on half of its nodes."""
        return 0.0, self.flow_cost + (0.8 * SEALING_CONTACTS if self._is_sought(case) else 0.0)

    @property
    def flow_cost(self) -> float:
        """Work of the percolation and the flow on the map and on half of its nodes."""
        return 0.5 if self.viscosity is None else 4.5

    def _is_sought(self, case: Scene) -> bool:
        """True if the load that seals is searched."""
        return "load_curve" in case.questions if self.seal is None else self.seal

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Percolation, the narrowest constriction, and the leakage with its discretisation error."""
        from asperity.contact.gap import percolation

        contact, axis = stages.contact, "yx".index(self.direction)
        is_sought = self._is_sought(stages.asked)
        flow_part = partial(part_of, progress, 0.0, 0.5 if is_sought else 1.0, 1.0)
        search = partial(part_of, progress, 0.5, 1.0, 1.0)
        paths = percolation(contact)
        on_half = self._flow(stages.coarse.contact)
        flow = self._flow(contact, on_half, flow_part)
        records, width = [*_records(paths)], paths.constriction[axis]
        warnings: list[Advice] = []
        datasets = self._close_up(contact, "under the load")
        verdict = (
            f"not sealed along {self.direction}: the narrowest constriction is {shown_si(width, 'm', 3)}"
        )
        name, note = f"leakage along {self.direction}", ""
        if (width if flow is None else flow.flow_rate) == 0:
            verdict = f"sealed along {self.direction}: the contact closes the gap"
            note = "" if is_sought else "while leak.seal finds the load that seals"
        if flow is not None and flow.flow_rate == 0:
            words = "0, sealed: the contact closes the gap"
            leakage = Record(name, 0.0, FLOW_RATE, TOPIC, words=words, note=note)
            records = [leakage, *self._elastic(leakage, stages, flow, warnings), *records]
        elif flow is not None and on_half is not None:
            length, across = contact.grid.length[axis], contact.grid.length[1 - axis]
            through = f"{shown_si(across, 'm', 3)} wide and {shown_si(length, 'm', 3)} long"
            error = abs(flow.flow_rate - on_half.flow_rate)
            of: dict[str, Any] = {"topic": TOPIC, "bounds": POSITIVE, "varies": True, "better": "less"}
            leakage = Record(name, flow.flow_rate, FLOW_RATE, note=f"through a seal {through}", **of)
            leakage = leakage.with_error(DISCRETISATION, error)
            per_width = Record(f"{name} per width", flow.flow_rate / across, PER_WIDTH, **of)
            per_width = per_width.with_error(DISCRETISATION, error / across)
            note = "relative to the flow between planes at the mean gap"
            factor = Record("pressure flow factor", flow.flow_factor, topic=TOPIC, note=note)
            elastic = self._elastic(leakage, stages, flow, warnings)
            records = [leakage, *elastic, per_width, factor, *records]
            verdict = f"leaks {leakage.best_text()} along {self.direction} through a seal {through}, "
            verdict += f"{per_width.best_text()}, with the discretisation error"
            if self.viscosity is not None and self.viscosity < GASES:
                text = "the leakage is that of a fluid of constant volume, at the mean pressure of the gap: "
                text += "a gas expands, and slips through constrictions as narrow as its mean free path."
                warnings.append(Advice(True, "gas", text, "model: a gas expands, and this fluid does not"))
            warnings.append(advice_on_pixels("leakage", {name: flow.flow_rate}, {name: on_half.flow_rate}))
            flux_y, flux_x = flow.flux / np.hypot(*flow.flux.mean(axis=(1, 2)))
            fields = {"film_flux_y": flux_y, "film_flux_x": flux_x, "film_pressure": flow.pressure}
            datasets["leak"] = on_map(contact, "Film that leaks through the gap", **fields)
        if is_sought:
            seals, last_open = self._sealing(stages, search)
            records.insert(min(len(records), 1), seals)
            if not seals.words:
                closes = f"; a mean pressure of {seals.best_text()} seals it"
                if (fluid := self.pressure_difference or 0.0) > seals.value:
                    closes = (
                        f"; a mean pressure of {seals.best_text()} closes the gap, and more than that of "
                    )
                    closes += f"the fluid, {shown_si(fluid, 'Pa', 3)}, keeps it closed"
                verdict += closes
                datasets |= self._close_up(last_open, "just below the load that seals")
        if 0 < width < LEAST_WIDTH:
            text = f"the narrowest constriction, {shown_si(width, 'm', 3)}, is smaller than molecules"
            warnings.append(Advice(True, "constriction", f"{text}: there the gap is closed to a fluid."))
        return Findings(
            records=records,
            verdict=verdict,
            warnings=[*warnings, *self._lifted(stages.contact.mean_pressure)],
            assumption="" if flow is None else "The film is laminar, fills the gap and does not open it.",
            datasets=datasets,
        )

    def _lifted(self, mean_pressure: float) -> Iterator[Advice]:
        """A warning if the pressure of the fluid is above that of the contact."""
        if (fluid := self.pressure_difference or 0.0) > mean_pressure > 0:
            above, below = (shown_si(pressure, "Pa", 3) for pressure in (fluid, mean_pressure))
            lifts = f"the fluid, at {above}, would lift faces under {below}"
            text = f"{lifts}, which the answer leaves out: a larger mean pressure is needed."
            yield Advice(True, "pressure of the fluid", text, f"model: {lifts}", fluid / mean_pressure - 1)

    def _elastic(
        self, leakage: Record, stages: Stages, start: FilmFlow, warnings: list[Advice]
    ) -> Iterator[Record]:
        """The leakage through the elastic contact, where a hardness was estimated and it matters."""
        if stages.elastic is None or (flow := self._flow(stages.elastic, start)) is None:
            return
        for each in elastic_record(leakage.quantity, flow.flow_rate, [leakage]):
            yield each
            leaks = f"an elastic contact, without the estimated hardness, leaks {each.number(digits=3)}"
            size = abs(each.value / leakage.value - 1) if leakage.value else math.inf
            subject = "hardness from the yield stress"
            warnings.append(Advice(True, subject, f"{leaks}.", f"model: {leaks}", size))

    def _flow(
        self, contact: Contact, start: FilmFlow | None = None, progress: Progress | None = None
    ) -> FilmFlow | None:
        """Flow of the film through the map, from a similar flow; None without a film."""
        from asperity.contact.reynolds import film_flow

        if self.viscosity is None or self.pressure_difference is None:
            return None
        given = contact, self.viscosity, self.pressure_difference, self.direction, progress
        return film_flow(*given, start)

    def under_load(self, contact: Contact) -> dict[str, float]:
        """Constriction and leakage of a contact of a load curve, also on half of the nodes."""
        from asperity.contact.gap import percolation

        found, flow = dict[str, float](), None
        for name, each in (("_on_half", solved_on_half(contact).contact), ("", contact)):
            narrowest = percolation(each).constriction["yx".index(self.direction)]  # 0 if the gap is sealed
            numbers = {f"constriction{name}": narrowest}
            if (flow := self._flow(each, flow)) is not None:
                numbers[f"leakage{name}"] = flow.flow_rate
            found = numbers | found
        return found

    def _sealing(self, stages: Stages, progress: Progress) -> tuple[Record, Contact]:
        """The mean pressure that seals the gap, from any load, and the contact just below it."""
        from asperity.contact.gap import open_gap, spanned

        case, face, axis = stages.case, stages.face, "yx".index(self.direction)
        given = None if case.hardness_is_estimated else case.hardness
        most = math.inf if given is None else BELOW_HARDNESS * given
        last = [stages.contact]  # from which the next contact is solved
        known = {stages.contact.mean_pressure: stages.contact}

        def pressed(load: float) -> Contact:
            progress(min(len(known), SEALING_CONTACTS), SEALING_CONTACTS + 1)
            if load not in known:
                known[load] = press(face, case.under(mean_pressure=load), start=last.pop())
            return known[load]

        def on_half(load: float) -> Contact:
            given = {"mean_pressure": load, "hardness": case.under(mean_pressure=load).hardness}
            return solve_on_half(face.height, case.solid, face.grid, face.boundary, **given)[0]

        def is_open(solved: Callable[[float], Contact], load: float) -> bool:
            contact = solved(load)
            if solved is pressed:
                last[:] = [contact]
            return spanned(open_gap(contact) > 0, contact.edges_meet, diagonals=False)[axis]

        load, low = _sealing_load(partial(is_open, pressed), stages.contact.mean_pressure, 2.0, most)
        record = Record(SEALING_LOAD, min(load, most), "Pa", TOPIC, bounds=POSITIVE, varies=True)
        if load == math.inf:
            words = f"above {shown_si(most, 'Pa', 3)}, {BELOW_HARDNESS:g} of the hardness"
            return replace(record, words=words), stages.contact
        if load == 0:
            return replace(record, words="any: the first contact closes the gap"), stages.contact
        coarse, _ = _sealing_load(partial(is_open, on_half), load, 1.1, most)
        if coarse < math.inf:
            record = record.with_error(DISCRETISATION, abs(load - coarse))
        return record.with_error(SEARCH, SEALING_ERROR * load), known[low]

    def _close_up(self, contact: Contact, under: str) -> dict[str, xr.Dataset]:
        """The gap around the narrowest constriction along the leak; empty if the gap is sealed."""
        from asperity.contact.gap import open_gap, percolation

        paths, axis = percolation(contact), "yx".index(self.direction)
        if not paths.constriction[axis]:
            return {}
        nodes = np.rint(np.divide(paths.place[axis], contact.grid.spacing)).astype(int)
        part = tuple(slice(max(node - CLOSE_UP, 0), node + CLOSE_UP + 1) for node in nodes)
        y, x = (at[each] for at, each in zip(contact.grid.coordinates(), part, strict=True))
        attributes = {
            "title": f"Gap around the narrowest constriction along {self.direction}, {under}",
            "narrowest": [paths.constriction[axis], *paths.place[axis]],
            "mean_pressure": contact.mean_pressure,
        }
        gap = (("close_up_y", "close_up_x"), open_gap(contact)[part])
        return {"constriction": xr.Dataset({"gap": gap}, {"close_up_y": y, "close_up_x": x}, attributes)}

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """The gap around the narrowest constriction, and maps of the flux of the film and of its pressure."""
        if (close := answer.datasets.get("constriction")) is not None:
            width = float(close.attrs["narrowest"][0])
            narrowest = shown_si(width, "m", 3) if width >= LEAST_WIDTH else "less than 1 nm"
            pressure = shown_si(float(close.attrs["mean_pressure"]), "Pa", 3)
            caption = (
                f"{close.attrs['title']} (mean pressure {pressure}): {narrowest} in the ring. The contact is "
                "black."
            )
            yield Picture("constriction", caption, _gap(close, answer.face.grid.spacing))
        if (film := answer.datasets.get("leak")) is not None:
            yield Picture("flow", FLOW_CAPTION, _maps_of_flow(answer.face, film))


def _records(paths: Percolation) -> Iterator[Record]:
    """Percolation and the narrowest constriction."""
    for phase, percolates in (("contact", paths.contact), ("gap", paths.gap)):
        for axis in (1, 0):
            words = "yes" if percolates[axis] else "no"
            name = f"{phase} percolates along {'yx'[axis]}"
            yield Record(name, float(percolates[axis]), topic=TOPIC, words=words)
    for axis in (1, 0):
        name, (y, x) = f"narrowest constriction along {'yx'[axis]}", paths.place[axis]
        words = "" if paths.gap[axis] else "none, the gap is closed"
        at = Position(y=float(y), x=float(x))
        yield Record(name, paths.constriction[axis], "m", TOPIC, position=at, words=words)


def _sealing_load(
    is_open: Callable[[float], bool], start: float, factor: float, most: float
) -> tuple[float, float]:
    """Load above which a gap is closed, to `SEALING_ERROR`, and the largest load under which it is open.

    The load is multiplied, or divided, by rising factors until it is between two known loads, then halved on
    a logarithmic scale. It is infinite if the gap is open under the load `most`, and 0 if it is closed under
    `LEAST_LOAD` of the first one.
    """
    low, high, load = 0.0, math.inf, min(start, most)
    for _ in range(MOST_CONTACTS):
        low, high = (load, high) if is_open(load) else (low, load)
        if low == most:
            return math.inf, low
        if high < LEAST_LOAD * start:
            return 0.0, low
        if low and high / low <= 1 + 2 * SEALING_ERROR:
            break
        if low and high < math.inf:
            load = math.sqrt(low * high)
        else:
            load, factor = min(load * factor, most) if low else load / factor, 2 * factor
    return math.sqrt(low * high), low


def _gap(close: xr.Dataset, spacing: Sequence[float]) -> Any:
    """The gap around a constriction, with a ring around it; black where it is closed."""
    from matplotlib.colors import LogNorm, Normalize

    gap, (narrowest, y, x) = close["gap"].values, map(float, close.attrs["narrowest"])
    factor, symbol = scaled_unit(gap.max(), "m")
    bottom, left = (
        float(close[f"close_up_{axis}"][0]) - step / 2 for axis, step in zip("yx", spacing, strict=True)
    )
    height, width = np.multiply(spacing, gap.shape)
    with _panels(1, height / width) as (figure, (panel,)):
        shown = np.ma.masked_where(gap <= 0, gap / factor)
        low, high = narrowest / factor, 1.01 * shown.max()
        norm = (LogNorm if high > WIDE * low else Normalize)(low, high, clip=True)
        box = left, left + width, bottom, bottom + height
        scale = _draw(figure, panel, shown, box, f"gap ({symbol})", norm=norm)
        panel.plot(x / scale, y / scale, "o", mfc="none", mec="red", ms=12, mew=1.5)
    return figure


def _maps_of_flow(face: TreatedMap, film: xr.Dataset) -> Any:
    """Maps of the flux of the film over its mean, and of its pressure; black where the gap is closed."""
    from matplotlib.colors import LogNorm

    pressure, flux_y, flux_x = (film[f"film_{name}"].values for name in ("pressure", "flux_y", "flux_x"))
    flux = np.hypot(flux_y, flux_x)
    factor, symbol = scaled_unit(float(np.nanmax(pressure)), "Pa")
    panels: list[tuple[str, Any, dict[str, Any]]] = [
        ("flux over the mean flux", flux, {"norm": LogNorm(LEAST_FLUX, flux.max(), clip=True)}),
        (f"pressure of the film ({symbol})", pressure / factor, {"vmin": 0.0}),
    ]
    height, width = face.grid.length
    with _panels(2, height / width) as (figure, axes):
        for axis, (label, values, colours) in zip(axes, panels, strict=True):
            shown = np.ma.masked_where(np.isnan(pressure), values)
            _draw(figure, axis, shown, (0.0, width, 0.0, height), label, **colours)
    return figure


@contextmanager
def _panels(count: int, shape: float) -> Iterator[tuple[Any, list[Any]]]:
    """A new figure with panels beside each other, of a height over width, each with a colour bar below."""
    from matplotlib.figure import Figure

    from asperity.views.panels import SINGLE
    from asperity.views.style import MILLIMETRE, PAGE, style

    width = SINGLE if count == 1 else PAGE
    with style():
        height = min(0.8 * shape / count, 1.0) * width + 30 * MILLIMETRE
        figure = Figure(figsize=(width, height), layout="compressed")
        yield figure, list(figure.subplots(1, count, squeeze=False)[0])


def _draw(figure: Any, axis: Any, values: Array, box: Sequence[float], label: str, **colours: Any) -> float:
    """Draw values of the map in a panel, black where they are masked; returns the unit of lengths in m.

    `box` holds the left, right, lower and upper edge.
    """
    factor, unit = scaled_unit([box[3], box[1]], "m")
    axis.set_facecolor("black")
    image = axis.imshow(values, origin="lower", extent=[edge / factor for edge in box], **colours)
    axis.set(xlabel=f"x ({unit})", ylabel=f"y ({unit})")
    figure.colorbar(image, ax=axis, label=label, location="bottom")
    return factor
