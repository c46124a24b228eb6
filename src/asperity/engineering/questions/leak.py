"""The gap between the bodies: whether it percolates, and how much of a fluid leaks through it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from asperity.engineering.question import Advice, Picture, Question, Row, advice_on_pixels
from asperity.settings.model import Number, setting
from asperity.settings.quantities import Pressure

if TYPE_CHECKING:
    from asperity.contact import Contact
    from asperity.contact.gap import FilmFlow, Percolation
    from asperity.engineering.answer import Answer
    from asperity.engineering.case import Case
    from asperity.engineering.face import RoughFace
    from asperity.surface.treatment.treatment import TreatedMap

GROUP = "gap"

FLOW_CAPTION = (
    "Film that leaks through the gap: volume per time and width over its mean, and pressure. The gap is "
    "closed in the black parts."
)

LEAST_FLUX = 1e-3
"""Flux over the mean one at the lower end of the colours."""


@dataclass(frozen=True, eq=False)
class LeakResult:
    """Percolation of contact and gap, flow through the map, and leakage on half of the nodes.

    The flow is None without a viscosity, and where the contact closes the gap: nothing leaks.
    """

    paths: Percolation
    flow: FilmFlow | None
    on_half: float


class Leak(Question):
    """Percolation of the gap, and leakage of a fluid through it; see `asperity.contact.film_flow`."""

    direction: Literal["x", "y"] = setting("x")
    """Direction in which the fluid leaks."""
    viscosity: Number | None = setting(
        None, default_text="percolation alone, no leakage", unit="Pa s", gt=0, le=1e20, example=0.03
    )
    """Dynamic viscosity of the fluid; needs `asperity[flow]`."""
    pressure_difference: Pressure | None = setting(
        None, default_text="percolation alone, no leakage", example="5 bar"
    )
    """Fall of the pressure of the fluid over the length of the map."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """A viscosity without a pressure difference, or the reverse."""
        names = ("viscosity", "pressure_difference")
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) == 1:
            yield f"leak.{given[0]}", f": needs leak.{({*names} - {*given}).pop()}"

    def on_map(self, case: Case, rough: RoughFace) -> Iterator[tuple[str, str]]:
        """A map on which the flow cannot be solved."""
        if self.viscosity is not None:
            from asperity.contact.gap import check_film_grid
            from asperity.core.packages import require

            require(["reynoldsflow"])
            try:
                check_film_grid(rough.face.grid)
            except ValueError as error:
                yield "map", str(error).removeprefix("map")

    def of_contact(self, answer: Answer) -> LeakResult:
        """Percolation, and the flow on the map and on half of its nodes."""
        from asperity.contact.gap import percolation

        flow = self._flow(answer.contact, answer.face)
        on_half = self._flow(answer.half.contact, answer.face)
        return LeakResult(percolation(answer.contact), flow, 0.0 if on_half is None else on_half.flow_rate)

    def _flow(self, contact: Contact, face: TreatedMap) -> FilmFlow | None:
        """Flow of the film through one map of the cell; None where the gap is closed."""
        import numpy as np

        from asperity.contact.gap import film_flow, open_along

        if self.viscosity is None or self.pressure_difference is None:
            return None
        if not open_along(contact)["yx".index(self.direction)]:
            return None
        images, fall = face.images, self.pressure_difference
        flow = film_flow(contact, self.viscosity, images * fall, self.direction)
        rows, columns = (nodes // images for nodes in contact.grid.shape)
        return replace(
            flow,
            flow_rate=flow.flow_rate / images,
            flux=np.stack([along[:rows, :columns] for along in flow.flux]),
            pressure=flow.pressure[:rows, :columns] - (images - 1) * fall,
        )

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Percolation, the narrowest constriction, and the leakage."""
        from asperity.core.units import shown_si

        found: LeakResult = answer.of(self)
        paths, flow = found.paths, found.flow
        for phase, percolates in (("contact", paths.contact), ("gap", paths.gap)):
            for axis in (1, 0):
                shown = "yes" if percolates[axis] else "no"
                yield Row(
                    GROUP, f"{phase} percolates along {'yx'[axis]}", float(percolates[axis]), "1", shown
                )
        for axis in (1, 0):
            width, words = paths.constriction[axis], "none, the gap is closed"
            if paths.gap[axis]:
                y, x = answer.face.on_map(*paths.place[axis])
                at = f"x = {shown_si(float(x), 'm')}, y = {shown_si(float(y), 'm')}"
                words = f"{shown_si(width, 'm')} at {at}"
            yield Row(GROUP, f"narrowest constriction along {'yx'[axis]}", width, "m", words)
        if self.viscosity is None:
            return
        if flow is None:
            yield Row(
                GROUP,
                f"leakage along {self.direction}",
                0.0,
                "m^3/s",
                "0, sealed: the contact closes the gap",
            )
            return
        shown = f"{1e9 * flow.flow_rate:.4g} mm³/s, to {100 * flow.conservation_error:.1g} % of it"
        yield Row(GROUP, f"leakage along {self.direction}", flow.flow_rate, "m^3/s", shown)
        words = f"{flow.flow_factor:.4g} of the flow between planes at the mean gap"
        yield Row(GROUP, "pressure flow factor", flow.flow_factor, "1", words)

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Error of the leakage by the pixels."""
        found: LeakResult = answer.of(self)
        if self.viscosity is not None:
            name = f"leakage along {self.direction}"
            fine = 0.0 if found.flow is None else found.flow.flow_rate
            yield advice_on_pixels("leakage", {name: fine}, {name: found.on_half})

    def assumption(self, answer: Answer) -> str:
        """What the flow assumes."""
        if self.viscosity is None:
            return ""
        return "The film is laminar, fills the gap and does not open it."

    def files(self, case: Case) -> list[str]:
        """The picture of the flow."""
        return [] if self.viscosity is None else ["flow.png"]

    def pictures(self, answer: Answer) -> Iterator[Picture]:
        """Maps of the flux of the film and of its pressure."""
        if (flow := answer.of(self).flow) is not None:
            yield Picture("flow", FLOW_CAPTION, _maps(answer.face, flow))


def _maps(face: TreatedMap, flow: FilmFlow) -> Any:
    """Maps of the flux of the film over its mean, and of its pressure; black where the gap is closed."""
    import numpy as np
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    from asperity.core.units import scaled_unit
    from asperity.views.style import MILLIMETRE, PAGE, style

    (ny, nx), (length, unit) = flow.pressure.shape, scaled_unit(max(face.map_length), "m")
    factor, symbol = scaled_unit(float(np.nanmax(flow.pressure)), "Pa")
    relative = np.hypot(*flow.flux) / np.hypot(*flow.flux.mean(axis=(1, 2)))
    edges = [edge / length for edge in face.map_length]
    panels: list[tuple[str, Any, dict[str, Any]]] = [
        ("flux over the mean flux", relative, {"norm": LogNorm(LEAST_FLUX, relative.max())}),
        (f"pressure of the film ({symbol})", flow.pressure / factor, {"vmin": 0.0}),
    ]
    with style():
        height = min(0.4 * ny / nx, 1.0) * PAGE + 30 * MILLIMETRE
        figure = Figure(figsize=(PAGE, height), layout="compressed")  # with a colour bar below each panel
        axes = figure.subplots(1, 2)
        for axis, (label, values, colours) in zip(axes, panels, strict=True):
            axis.set_facecolor("black")
            shown = np.ma.masked_where(np.isnan(flow.pressure), values)
            place: dict[str, Any] = {"origin": "lower", "extent": (0, edges[1], 0, edges[0])}
            image = axis.imshow(shown, **place, **colours)
            axis.set(xlabel=f"x ({unit})", ylabel=f"y ({unit})")
            figure.colorbar(image, ax=axis, label=label, location="bottom")
    return figure
