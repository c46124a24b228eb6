"""Percolation of the gap between the bodies, and leakage of a fluid through it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from asperity.core.units import shown_si
from asperity.engineering.question import Advice, Picture, Question, Row, advice_on_pixels
from asperity.settings.model import Number, optional, setting
from asperity.settings.quantities import Pressure

if TYPE_CHECKING:
    from xarray import Dataset

    from asperity.contact.gap import Percolation
    from asperity.contact.reynolds import FilmFlow
    from asperity.core.types import Array, Progress
    from asperity.engineering.question import Answer, Case, Contact, RoughFace
    from asperity.surface.treatment.treatment import TreatedMap

GROUP = "gap"

FLOW_CAPTION = (
    "Film that leaks through the gap: volume per time and width over its mean, and pressure. In the black "
    "parts the gap is closed, or no path leads to an edge."
)

LEAST_FLUX = 1e-3
"""Flux over the mean one at the lower end of the colours."""


SEALING_ERROR = 0.01
"""Relative error of the load that seals; half of the error costs one contact more."""

WIDE = 10
"""Largest over smallest value of a picture above which its colours, or its axis, are logarithmic."""

CLOSE_UP = 20
"""Pixels to each side of the narrowest constriction in its picture."""


@dataclass(frozen=True, eq=False)
class LeakResult:
    """Percolation of contact and gap, flow through the map, and leakage on half of the nodes.

    The flow is None without a viscosity.
    """

    paths: Percolation
    flow: FilmFlow | None
    on_half: float


@dataclass(frozen=True, eq=False)
class Sealing:
    """Mean pressure that seals the gap, the same on half of the nodes, and a contact just below it.

    The pressure is 0 if all loads of the curve seal, and infinite if none does; then there is no contact.
    """

    load: float
    on_half: float
    last_open: Contact | None


class Leak(Question):
    """Percolation of the gap, and leakage of a fluid through it; see `asperity.contact.film_flow`."""

    TILES = (
        *("leakage along x", "leakage along y", "mean pressure that seals"),
        *("narrowest constriction along x", "narrowest constriction along y"),
    )
    LEAD = "constriction"

    direction: Literal["x", "y"] = setting("x")
    """Direction in which the fluid leaks."""
    viscosity: Number | None = optional(
        "percolation alone, no leakage", unit="Pa s", gt=0, le=1e20, example=0.03
    )
    """Dynamic viscosity of the fluid; needs `asperity[flow]`."""
    pressure_difference: Pressure | None = optional("percolation alone, no leakage", example="5 bar")
    """Fall of the pressure of the fluid over the length of the map."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Refuse a viscosity without a pressure difference, and a pressure difference without a viscosity."""
        names = ("viscosity", "pressure_difference")
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) == 1:
            yield f"leak.{given[0]}", f": needs leak.{({*names} - {*given}).pop()}"

    def on_map(self, case: Case, rough: RoughFace) -> Iterator[tuple[str, str]]:
        """The flow needs a package."""
        from asperity.core.packages import require

        if self.viscosity is not None:
            require(["pyamg"])
        return iter(())

    def of_contact(self, answer: Answer, progress: Progress) -> LeakResult:
        """Percolation, and the flow on the map and on half of its nodes."""
        from asperity.contact.gap import percolation

        flow = self._flow(answer.contact, lambda done, total: progress(0.8 * done, total))
        on_half = self._flow(answer.half.contact)
        paths = percolation(answer.contact)
        return LeakResult(paths, flow, 0.0 if on_half is None else on_half.flow_rate)

    def _flow(self, contact: Contact, progress: Progress | None = None) -> FilmFlow | None:
        """Flow of the film through the map; None without a film."""
        from asperity.contact.reynolds import film_flow

        if self.viscosity is None or self.pressure_difference is None:
            return None
        return film_flow(contact, self.viscosity, self.pressure_difference, self.direction, progress)

    def under_load(self, answer: Answer, contact: Contact) -> dict[str, float]:
        """Constriction and leakage of a contact of a load curve, also on half of the nodes."""
        from asperity.engineering.continuum import solved_on_half

        found, half = {}, solved_on_half(contact).contact
        for name, each in (("", contact), ("_on_half", half)):
            found[f"constriction{name}"] = self._constriction(each)
            if (flow := self._flow(each)) is not None:
                found[f"leakage{name}"] = flow.flow_rate
        return found

    def _constriction(self, contact: Contact) -> float:
        """Narrowest constriction along the direction of the leak; 0 if the gap is sealed."""
        from asperity.contact.gap import percolation

        return percolation(contact).constriction["yx".index(self.direction)]

    def sealing(self, answer: Answer, curve: Dataset, progress: Progress) -> Sealing:
        """The mean pressure that seals the gap, by bisection between loads of a curve."""
        from asperity.contact.half_grid import solve_on_half
        from asperity.engineering.press import press

        face, case, loads = answer.face, answer.case, curve["mean_pressure"].values

        def pressed(load: float) -> Contact:
            return press(face, case.under(mean_pressure=load))

        def on_half(load: float) -> Contact:
            given = {"mean_pressure": load, "hardness": case.hardness}
            return solve_on_half(face.height, case.solid, face.grid, face.boundary, **given)[0]

        found: dict[str, float] = {}
        for number, (name, solved) in enumerate((("", pressed), ("_on_half", on_half))):
            opened = curve[f"constriction{name}"].values > 0

            def is_open(load: float, solved: Callable[[float], Contact] = solved) -> bool:
                return self._constriction(solved(load)) > 0

            found[name] = _last_open_load(loads, opened, is_open)
            progress(number + 1, 2)
        load = found[""]
        last_open = pressed(load * (1 - SEALING_ERROR)) if 0 < load < math.inf else None
        return Sealing(load, found["_on_half"], last_open)

    def verdict(self, answer: Answer) -> str:
        """Sealed gap, or else its leakage, and the load that seals."""
        found: LeakResult = answer.of(self)
        width = found.paths.constriction["yx".index(self.direction)]
        rate = width if found.flow is None else found.flow.flow_rate
        if rate == 0:
            text = f"sealed along {self.direction}: the contact closes the gap"
        elif found.flow is None:
            narrowest = f"the narrowest constriction is {shown_si(width, 'm', 3)}"
            text = f"not sealed along {self.direction}: {narrowest}"
        else:
            row = Row(GROUP, "", rate, "m^3/s", "").by(abs(rate - found.on_half))
            shown = row.with_error or shown_si(rate, "m^3/s", 3)
            text = f"leaks {shown} along {self.direction}, with the error by the pixels"
        curve = answer.found.get("load_curve")
        if curve is not None and 0 < curve.sealing.load < math.inf:
            text += f"; sealed above a mean pressure of {shown_si(curve.sealing.load, 'Pa', 3)}"
        return text

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Percolation, the narrowest constriction, and the leakage."""
        found: LeakResult = answer.of(self)
        paths, flow = found.paths, found.flow
        for phase, percolates in (("contact", paths.contact), ("gap", paths.gap)):
            for axis in (1, 0):
                name, shown = f"{phase} percolates along {'yx'[axis]}", "yes" if percolates[axis] else "no"
                yield Row(GROUP, name, float(percolates[axis]), "1", shown)
        for axis in (1, 0):
            width, words = paths.constriction[axis], "none, the gap is closed"
            if paths.gap[axis]:
                y, x = paths.place[axis]
                at = f"x = {shown_si(float(x), 'm')}, y = {shown_si(float(y), 'm')}"
                words = f"{shown_si(width, 'm')} at {at}"
            yield Row(GROUP, f"narrowest constriction along {'yx'[axis]}", width, "m", words)
        if flow is None:
            return
        name, rate = f"leakage along {self.direction}", flow.flow_rate
        if rate == 0:
            words = "0, sealed: the contact closes the gap"
            if answer.case.load_curve is None:
                words += "; a load_curve from smaller loads finds the load that seals"
            yield Row(GROUP, name, 0.0, "m^3/s", words)
            return
        row = Row(GROUP, name, rate, "m^3/s", shown_si(rate, "m^3/s"))
        yield row.by(abs(rate - found.on_half))
        words = f"{flow.flow_factor:.4g} of the flow between planes at the mean gap"
        yield Row(GROUP, "pressure flow factor", flow.flow_factor, "1", words)

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Error of the leakage by the pixels."""
        found: LeakResult = answer.of(self)
        if found.flow is not None and found.flow.flow_rate > 0:
            name = f"leakage along {self.direction}"
            yield advice_on_pixels("leakage", {name: found.flow.flow_rate}, {name: found.on_half})

    def assumption(self, answer: Answer) -> str:
        """A laminar film that does not open the gap."""
        if self.viscosity is None:
            return ""
        return "The film is laminar, fills the gap and does not open it."

    def files(self, case: Case) -> list[str]:
        """The pictures of the narrowest constriction and of the flow."""
        return ["constriction.png", *([] if self.viscosity is None else ["flow.png"])]

    def pictures(self, answer: Answer) -> Iterator[Picture]:
        """The gap around the narrowest constriction, and maps of the flux of the film and of its pressure."""
        contact, under = answer.contact, "under the load"
        curve = answer.found.get("load_curve")
        if curve is not None and curve.sealing is not None and curve.sealing.last_open is not None:
            contact, under = curve.sealing.last_open, "just below the load that seals"
        if self._constriction(contact) > 0:
            yield self._picture_of_constriction(contact, under)
        if (flow := answer.of(self).flow) is not None and flow.flow_rate > 0:
            yield Picture("flow", FLOW_CAPTION, _maps_of_flow(answer.face, flow))

    def _picture_of_constriction(self, contact: Contact, under: str) -> Picture:
        """The gap around the narrowest constriction of the best path along the direction of the leak."""
        import numpy as np
        from matplotlib.colors import LogNorm, Normalize

        from asperity.contact.gap import open_gap, percolation
        from asperity.core.units import scaled_unit

        grid, paths, axis = contact.grid, percolation(contact), "yx".index(self.direction)
        narrowest, (y, x) = paths.constriction[axis], paths.place[axis]
        nodes = [round(place / step) for place, step in zip((y, x), grid.spacing, strict=True)]
        part = tuple(slice(max(node - CLOSE_UP, 0), node + CLOSE_UP + 1) for node in nodes)
        gap = open_gap(contact)[part]
        factor, symbol = scaled_unit(gap.max(), "m")
        bottom, left = (step * (each.start - 0.5) for step, each in zip(grid.spacing, part, strict=True))
        height, width = (step * size for step, size in zip(grid.spacing, gap.shape, strict=True))
        with _panels(1, height / width) as (figure, (panel,)):
            shown = np.ma.masked_where(gap <= 0, gap / factor)
            low, high = narrowest / factor, 1.01 * shown.max()
            norm = (LogNorm if high > WIDE * low else Normalize)(low, high, clip=True)
            box = left, left + width, bottom, bottom + height
            scale = _draw(figure, panel, shown, box, f"gap ({symbol})", norm=norm)
            panel.plot(x / scale, y / scale, "o", mfc="none", mec="red", ms=12, mew=1.5)
        caption = (
            f"Gap around the narrowest constriction along {self.direction}, {shown_si(narrowest, 'm', 3)} in "
            f"the ring, {under} (mean pressure {shown_si(contact.mean_pressure, 'Pa', 3)}). The contact is "
            "black."
        )
        return Picture("constriction", caption, figure)


def _last_open_load(loads: Array, opened: Array, is_open: Callable[[float], bool]) -> float:
    """Load above which a gap is closed, to `SEALING_ERROR`; 0 below all loads, and infinite above them."""
    if opened.all():
        return math.inf
    first = int(opened.argmin())
    if first == 0:
        return 0.0
    low, high = float(loads[first - 1]), float(loads[first])
    while high / low > 1 + 2 * SEALING_ERROR:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_open(middle) else (low, middle)
    return math.sqrt(low * high)


def _maps_of_flow(face: TreatedMap, flow: FilmFlow) -> Any:
    """Maps of the flux of the film over its mean, and of its pressure; black where the gap is closed."""
    import numpy as np
    from matplotlib.colors import LogNorm

    from asperity.core.units import scaled_unit

    factor, symbol = scaled_unit(float(np.nanmax(flow.pressure)), "Pa")
    relative = np.hypot(*flow.flux) / np.hypot(*flow.flux.mean(axis=(1, 2)))
    panels: list[tuple[str, Any, dict[str, Any]]] = [
        ("flux over the mean flux", relative, {"norm": LogNorm(LEAST_FLUX, relative.max(), clip=True)}),
        (f"pressure of the film ({symbol})", flow.pressure / factor, {"vmin": 0.0}),
    ]
    height, width = face.grid.length
    with _panels(2, height / width) as (figure, axes):
        for axis, (label, values, colours) in zip(axes, panels, strict=True):
            shown = np.ma.masked_where(np.isnan(flow.pressure), values)
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
    from asperity.core.units import scaled_unit

    factor, unit = scaled_unit([box[3], box[1]], "m")
    axis.set_facecolor("black")
    image = axis.imshow(values, origin="lower", extent=[edge / factor for edge in box], **colours)
    axis.set(xlabel=f"x ({unit})", ylabel=f"y ({unit})")
    figure.colorbar(image, ax=axis, label=label, location="bottom")
    return factor
