"""Percolation of the gap between the bodies, and leakage of a fluid through it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.numbers import elastic_record
from asperity.engineering.question import Findings, Picture, Question, Stages, advice_on_pixels
from asperity.engineering.records import DISCRETISATION, POSITIVE, Advice, Position, Record
from asperity.engineering.scene import Scene
from asperity.settings.model import Number, optional, setting
from asperity.settings.quantities import Pressure

if TYPE_CHECKING:
    import xarray as xr

    from asperity.contact.gap import Percolation
    from asperity.contact.reynolds import FilmFlow
    from asperity.engineering.face import RoughFace
    from asperity.surface.treatment.treatment import TreatedMap

TOPIC = "gap"

FLOW_CAPTION = (
    "Film that leaks through the gap: volume per time and width over its mean, and pressure. In the black "
    "parts the gap is closed, or no path leads to an edge."
)

LEAST_FLUX = 1e-3
"""Flux over the mean one at the lower end of the colours."""

SEALING_ERROR = 0.01
"""Relative error of the load that seals; half of the error costs one contact more."""

WIDE = 10
"""Maximum over minimum of a picture above which its colours, or its axis, are logarithmic."""

CLOSE_UP = 20
"""Pixels to each side of the narrowest constriction in its picture."""


class Leak(Question):
    """Percolation of the gap, and leakage of a fluid through it; see `asperity.contact.film_flow`."""

    ASKS = "Does the gap leak?"
    TILES = (
        *("leakage along x", "leakage along y", "mean pressure that seals"),
        *("narrowest constriction along x", "narrowest constriction along y"),
    )
    LEAD = "constriction"
    FILES = ("constriction", "flow")

    direction: Literal["x", "y"] = setting("x")
    """Direction in which the fluid leaks."""
    viscosity: Number | None = optional(
        "percolation alone, no leakage", unit="Pa s", gt=0, le=1e20, example=0.03
    )
    """Dynamic viscosity of the fluid; needs `asperity[flow]`."""
    pressure_difference: Pressure | None = optional("percolation alone, no leakage", example="5 bar")
    """Fall of the pressure of the fluid over the length of the map."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """A viscosity without a pressure difference, or the other way round; the flow needs a package."""
        names = ("viscosity", "pressure_difference")
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) == 1:
            yield f"leak.{given[0]}", f": needs leak.{({*names} - {*given}).pop()}"
        elif given and rough is not None:
            from asperity.core.packages import require

            require(["pyamg"])

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """The flow is solved on the map and on half of its nodes."""
        return 0.0, 0.1 if self.viscosity is None else 2.0

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Percolation, the narrowest constriction, and the leakage with its discretisation error."""
        from asperity.contact.gap import percolation

        contact, axis = stages.contact, "yx".index(self.direction)
        paths = percolation(contact)
        flow = self._flow(contact, lambda done, total: progress(0.8 * done, total))
        on_half = self._flow(stages.coarse.contact)
        records, width = [*_records(paths)], paths.constriction[axis]
        warnings: list[Advice] = []
        datasets = self._close_up(contact, "under the load")
        verdict = (
            f"not sealed along {self.direction}: the narrowest constriction is {shown_si(width, 'm', 3)}"
        )
        name, note = f"leakage along {self.direction}", ""
        if (width if flow is None else flow.flow_rate) == 0:
            verdict = f"sealed along {self.direction}: the contact closes the gap"
            if "load_curve" not in stages.asked.questions:
                note = "while a load_curve from smaller loads finds the load that seals"
        if flow is not None and flow.flow_rate == 0:
            words = "0, sealed: the contact closes the gap"
            leakage = Record(name, 0.0, "m^3/s", TOPIC, words=words, note=note)
            records += [leakage, *self._elastic(leakage, stages, warnings)]
        elif flow is not None and on_half is not None:
            leakage = Record(name, flow.flow_rate, "m^3/s", TOPIC, bounds=POSITIVE)
            leakage = leakage.with_error(DISCRETISATION, abs(flow.flow_rate - on_half.flow_rate))
            note = "relative to the flow between planes at the mean gap"
            records += [leakage, *self._elastic(leakage, stages, warnings)]
            records.append(Record("pressure flow factor", flow.flow_factor, topic=TOPIC, note=note))
            verdict = f"leaks {leakage.best_text()} along {self.direction}, with the discretisation error"
            warnings.append(advice_on_pixels("leakage", {name: flow.flow_rate}, {name: on_half.flow_rate}))
            datasets["leak"] = _fields(contact, flow)
        return Findings(
            records=records,
            verdict=verdict,
            warnings=warnings,
            assumption="" if flow is None else "The film is laminar, fills the gap and does not open it.",
            datasets=datasets,
        )

    def _elastic(self, leakage: Record, stages: Stages, warnings: list[Advice]) -> Iterator[Record]:
        """The leakage through the elastic contact, where a hardness was estimated and it matters."""
        if stages.elastic is None or (flow := self._flow(stages.elastic)) is None:
            return
        for each in elastic_record(leakage.quantity, flow.flow_rate, [leakage]):
            yield each
            short = (
                f"model: an elastic contact, without the estimated hardness, leaks {each.number(digits=3)}"
            )
            size = abs(each.value / leakage.value - 1) if leakage.value else math.inf
            warnings.append(Advice(True, "hardness from the yield stress", f"{short[7:]}.", short, size))

    def _flow(self, contact: Contact, progress: Progress | None = None) -> FilmFlow | None:
        """Flow of the film through the map; None without a film."""
        from asperity.contact.reynolds import film_flow

        if self.viscosity is None or self.pressure_difference is None:
            return None
        return film_flow(contact, self.viscosity, self.pressure_difference, self.direction, progress)

    def under_load(self, contact: Contact) -> dict[str, float]:
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

    def sealing(
        self, face: TreatedMap, case: Scene, curve: xr.Dataset, progress: Progress
    ) -> tuple[float, float, dict[str, xr.Dataset]]:
        """The mean pressure that seals the gap, by bisection between loads of a curve.

        Returns
        -------
        load, on_half : float
            The mean pressure, and that on half of the nodes; 0 if all loads of the curve seal, and infinite
            if none does.
        datasets : dict
            ``constriction`` of a contact just below the load; empty if the load is not on the curve.
        """
        from asperity.contact.half_grid import solve_on_half
        from asperity.engineering.press import press

        def pressed(load: float) -> Contact:
            return press(face, case.under(mean_pressure=load))

        def on_half(load: float) -> Contact:
            given = {"mean_pressure": load, "hardness": case.under(mean_pressure=load).hardness}
            return solve_on_half(face.height, case.solid, face.grid, face.boundary, **given)[0]

        found: list[float] = []
        for name, solved in (("", pressed), ("_on_half", on_half)):
            opened = curve[f"constriction{name}"].values > 0

            def is_open(load: float, solved: Callable[[float], Contact] = solved) -> bool:
                return self._constriction(solved(load)) > 0

            found.append(_last_open_load(curve["mean_pressure"].values, opened, is_open))
            progress(len(found), 2)
        load, coarse = found
        if not 0 < load < math.inf:
            return load, coarse, {}
        last_open = pressed(load * (1 - SEALING_ERROR))
        return load, coarse, self._close_up(last_open, "just below the load that seals")

    def _close_up(self, contact: Contact, under: str) -> dict[str, xr.Dataset]:
        """The gap around the narrowest constriction along the leak; empty if the gap is sealed."""
        import xarray as xr

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
            narrowest = shown_si(float(close.attrs["narrowest"][0]), "m", 3)
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


def _fields(contact: Contact, flow: FilmFlow) -> xr.Dataset:
    """Flux of the film over its mean, and its pressure, on the nodes of the map."""
    import xarray as xr

    relative = flow.flux / np.hypot(*flow.flux.mean(axis=(1, 2)))
    fields = {"film_flux_y": relative[0], "film_flux_x": relative[1], "film_pressure": flow.pressure}
    return xr.Dataset(
        {name: (("y", "x"), values) for name, values in fields.items()},
        contact.grid.dataset_coordinates(),
        {"title": "Film that leaks through the gap", "unit_system": "SI"},
    )


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
