"""Pictures that the page draws: maps of a field, curves, sections, and peaks over their depth, by Bokeh."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from bokeh.events import Pan, PanEnd, PanStart
from bokeh.models import ColumnDataSource, CustomJS, HoverTool, LinearColorMapper
from bokeh.models.annotations import ColorBar
from bokeh.palettes import Cividis256, RdBu11, Viridis256, interp_palette
from bokeh.plotting import figure

from asperity.core.types import Array
from asperity.core.units import scaled_unit

SIGNED = tuple(interp_palette(RdBu11[::-1], 255))
"""Colours of a field with a sign; all palettes are safe for the colour-blind."""

Ends = tuple[float, float, float, float]
"""Places x, y, x, y of the ends of a line, in m."""

DRAG = """
const end = cb_obj, line = source.data;
if (cb_obj.event_name === "panstart") { line.x = [end.x, end.x]; line.y = [end.y, end.y]; }
else { line.x = [line.x[0], end.x]; line.y = [line.y[0], end.y]; }
source.change.emit();
"""
"""Draws the line while it is dragged, without a way to the server."""


class Units:
    """Units of lengths and stresses, chosen once for all pictures; empty for those that suit the values."""

    def __init__(self, length: str = "", stress: str = "") -> None:
        self.length, self.stress = length, stress

    def of(self, values: Any, unit: str) -> tuple[float, str]:
        """Factor and symbol of the unit in which values in m or Pa are shown."""
        chosen = {"m": self.length, "Pa": self.stress}[unit]
        prefix = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
        if chosen in ("m", "Pa"):
            return 1.0, chosen
        return (prefix[chosen[0]], chosen) if chosen else scaled_unit(values, unit)


def _figure(label: str, **options: Any) -> Any:
    """An empty figure that takes the colours of the page, described for a screen reader."""
    made = figure(
        sizing_mode="stretch_width",
        tools="wheel_zoom,box_zoom,pan,reset,save",
        active_drag=None,
        active_scroll=None,
        toolbar_location="above",
        background_fill_alpha=0,
        border_fill_alpha=0,
        outline_line_color=None,
        name=label,
        **options,
    )
    made.toolbar.logo = None
    made.title.text_font_size = "11pt"  # type: ignore[union-attr]
    made.grid.grid_line_alpha = 0.25
    return made


class MapFigure:
    """A field over the map, with a scale, values under the pointer, marked places, and a line to drag.

    Parameters
    ----------
    title : str
    quantity : str
        Name of the values in the hover.
    unit : "m" or "Pa"
        Of the values.
    palette : sequence of str
    on_line : callable, optional
        Called with the ends of a line that was dragged.
    peaks : ColumnDataSource, optional
        Places that can be selected, in columns ``x`` and ``y``.
    is_section : bool
        The vertical axis is the depth, downward.
    """

    def __init__(
        self,
        title: str,
        quantity: str,
        unit: str,
        palette: Sequence[str],
        on_line: Callable[[Ends], None] | None = None,
        peaks: ColumnDataSource | None = None,
        is_section: bool = False,
    ) -> None:
        self.title, self.quantity, self.unit, self.palette = title, quantity, unit, palette
        self.image = ColumnDataSource({name: [] for name in ("image", "x", "y", "dw", "dh")})
        self.line = ColumnDataSource({"x": [], "y": []})
        self.outline = ColumnDataSource({"xs": [], "ys": []})
        self.mapper = LinearColorMapper(palette=palette, nan_color="rgba(0,0,0,0)")
        ratio = {} if is_section else {"match_aspect": True}
        self.figure = _figure(
            title, title=title, height=260 if is_section else 420, min_border_right=10, **ratio
        )
        self._factor, self._on_line = 1.0, on_line
        drawn = self.figure.image("image", "x", "y", "dw", "dh", source=self.image, color_mapper=self.mapper)
        self.figure.multi_line("xs", "ys", source=self.outline, line_color="#d55e00", line_width=1.5)
        self.figure.line("x", "y", source=self.line, line_color="#d55e00", line_width=3, line_dash="dashed")
        self.hover = HoverTool(renderers=[drawn], tooltips=None)
        self.figure.add_tools(self.hover)
        self.bar = ColorBar(
            color_mapper=self.mapper, width=10, padding=4, background_fill_alpha=0, title_standoff=6
        )
        self.figure.add_layout(self.bar, "right")
        self.figure.x_range.range_padding = self.figure.y_range.range_padding = 0
        if is_section:
            self.figure.y_range.flipped = True
        if peaks is not None:
            self.figure.scatter(
                *("x", "y"), source=peaks, size=9, fill_alpha=0, line_color="#ffffff", line_alpha=0.55,
                selection_line_color="#d55e00", selection_line_width=3, selection_line_alpha=1,
                selection_fill_alpha=0, nonselection_line_alpha=0.3, nonselection_fill_alpha=0,
            )  # fmt: skip
            self.figure.add_tools("tap")
        if on_line is not None:
            drag = CustomJS(args={"source": self.line}, code=DRAG)
            for event in (PanStart, Pan):
                self.figure.js_on_event(event, drag)
            self._start: tuple[float, float] | None = None
            self.figure.on_event(PanStart, self._begin)
            self.figure.on_event(PanEnd, self._end)

    def _begin(self, event: Any) -> None:
        self._start = event.x, event.y

    def _end(self, event: Any) -> None:
        if self._start is not None and self._on_line is not None and self._start != (event.x, event.y):
            self._on_line(tuple(self._factor * each for each in (*self._start, event.x, event.y)))  # type: ignore[arg-type]

    def draw_line(self, ends: Ends) -> None:
        """Show the line of a section or profile, which may have been dragged in another tab."""
        x, y, to_x, to_y = (each / self._factor for each in ends)
        self.line.data = {"x": [x, to_x], "y": [y, to_y]}

    def show(
        self,
        shown: Mapping[str, Any],
        units: Units,
        title: str = "",
        level: float | None = None,
        limits: tuple[float, float] | None = None,
    ) -> None:
        """Draw a field on its frame in m, with the contour of a level, in colours between two limits."""
        values, edge = shown["values"], max(shown["dw"], shown["dh"])
        self._factor, length = units.of(edge, "m")
        low, high = limits or (float(np.nanmin(values)), float(np.nanmax(values)))
        factor, symbol = units.of([low, high], self.unit)
        is_signed = self.palette is SIGNED
        if is_signed:
            low, high = -max(-low, high), max(-low, high)
        self.mapper.update(low=low / factor, high=max(high, low + 1e-30) / factor)
        self.bar.title = symbol
        frame = {name: [shown[name] / self._factor] for name in ("x", "y", "dw", "dh")}
        self.image.data = {"image": [values / np.float32(factor)], **frame}
        self.figure.xaxis.axis_label = f"x ({length})"
        self.figure.yaxis.axis_label = f"{'depth' if self.figure.y_range.flipped else 'y'} ({length})"
        self.hover.tooltips = [
            (self.quantity, f"@image{{0.000}} {symbol}"),
            ("place", f"$x{{0.00}} {length}, $y{{0.00}} {length}"),
        ]
        self.figure.title.text = title or self.title
        self.outline.data = dict(zip(("xs", "ys"), self._contour(shown, level), strict=True))

    def _contour(self, shown: Mapping[str, Any], level: float | None) -> tuple[list[Array], list[Array]]:
        from contourpy import contour_generator

        values = np.nan_to_num(shown["values"])
        if level is None or min(values.shape) < 2 or not values.min() < level < values.max():
            return [], []
        rows, columns = values.shape
        x = (shown["x"] + (np.arange(columns) + 0.5) * shown["dw"] / columns) / self._factor
        y = (shown["y"] + (np.arange(rows) + 0.5) * shown["dh"] / rows) / self._factor
        lines: Any = contour_generator(x, y, values).lines(level)
        return [line[:, 0] for line in lines], [line[:, 1] for line in lines]


class CurveFigure:
    """Curves over one axis."""

    def __init__(self, title: str, x: str, y: str, **options: Any) -> None:
        self.source = ColumnDataSource({"x": [], "y": []})
        self.figure = _figure(title, title=title, height=220, **options)
        self.figure.line("x", "y", source=self.source, line_width=2, line_color="#0072b2")
        self.figure.add_tools(HoverTool(tooltips=[(x, "@x{0.000a}"), (y, "@y{0.000a}")], mode="vline"))
        self._labels = x, y

    def show(self, x: Array, y: Array, units: tuple[str, str]) -> None:
        """Draw a curve, whose numbers are in the units."""
        self.source.data = {"x": x, "y": y}
        for axis, label, unit in zip(
            (self.figure.xaxis, self.figure.yaxis), self._labels, units, strict=True
        ):
            axis.axis_label = f"{label} ({unit})" if unit else label


class MapPictures:
    """Pictures of the step "Map"."""

    def __init__(self, on_line: Callable[[Ends], None]) -> None:
        self.image = MapFigure("Height, peaks upward", "height", "m", Cividis256, on_line)
        self.profile = CurveFigure("Profile along the dragged line", "distance", "height")
        self.histogram = CurveFigure("Distribution of heights", "height", "density")
        self.spectrum = CurveFigure("Spectrum", "wavelength", "C(q)", x_axis_type="log", y_axis_type="log")

    def roots(self) -> dict[str, Any]:
        """Name in the page → figure."""
        return {f"map_{name}": each.figure for name, each in vars(self).items()}

    def show(self, found: Mapping[str, Any], units: Units) -> None:
        """Draw the heights of a check."""
        if "picture" not in found:
            return
        self.image.show(found["picture"], units, "Height in the file" if found.get("is_raw") else "")
        if "histogram" in found:
            density, edges = found["histogram"]
            factor, symbol = units.of(edges, "m")
            self.histogram.show(
                np.repeat(edges, 2)[1:-1] / factor, np.repeat(density, 2) * factor, (symbol, f"1/{symbol}")
            )
            wavenumber, power = found["spectrum"]
            kept = power > 0
            factor, symbol = units.of(2 * np.pi / wavenumber, "m")
            self.spectrum.show(2 * np.pi / wavenumber[kept] / factor, power[kept] * 1e24, (symbol, "µm⁴"))

    def show_profile(self, found: Mapping[str, Any], ends: Ends, units: Units) -> None:
        """Draw the heights along a line."""
        self.image.draw_line(ends)
        (factor, symbol), (high, unit) = units.of(found["distance"], "m"), units.of(found["values"], "m")
        self.profile.show(found["distance"] / factor, found["values"] / high, (symbol, unit))


class AnswerPictures:
    """Linked pictures of one answer: contact, plane, section, and peaks over depth.

    Parameters
    ----------
    place : str
        Suffix of the names in the page.
    on_line : callable
        Called with the ends of a line dragged in the plane.
    on_peak : callable
        Called with the number of a peak that was selected.
    """

    def __init__(self, place: str, on_line: Callable[[Ends], None], on_peak: Callable[[int], None]) -> None:
        self._place, self._on_peak, self._is_marking = place, on_peak, False
        self.peaks = ColumnDataSource({name: [] for name in ("x", "y", "depth", "value")})
        self.peaks.selected.on_change("indices", self._selected)
        self.contact = MapFigure("Contact pressure", "pressure", "Pa", Viridis256, peaks=self.peaks)
        self.plane = MapFigure("Stress in a plane", "stress", "Pa", Viridis256, on_line, self.peaks)
        self.section = MapFigure(
            "Section along the dragged line", "stress", "Pa", Viridis256, is_section=True
        )
        self.scatter = _figure("Peaks over depth", title="Peaks over depth", height=300)
        drawn = self.scatter.scatter(
            *("value", "depth"), source=self.peaks, size=8, color="#0072b2", alpha=0.7,
            selection_color="#d55e00", selection_alpha=1, nonselection_alpha=0.35,
        )  # fmt: skip
        self.scatter.y_range.flipped = True
        self._tip = HoverTool(renderers=[drawn], tooltips=None)
        self.scatter.add_tools(self._tip, "tap")

    def roots(self) -> dict[str, Any]:
        """Name in the page → figure."""
        figures = {"contact": self.contact.figure, "plane": self.plane.figure}
        figures |= {"section": self.section.figure, "scatter": self.scatter}
        return {f"{name}{self._place}": each for name, each in figures.items()}

    def _selected(self, _: str, __: Any, indices: list[int]) -> None:
        if indices and not self._is_marking:
            self._on_peak(indices[0])

    def show(self, summary: Mapping[str, Any], which: str, units: Units, limits: Any = None) -> None:
        """Draw the contact: its pressure, or the gap."""
        shown = dict(summary[which])
        if which == "pressure":
            shown["values"] = np.where(shown["values"] > 0, shown["values"], np.nan)
        self.contact.unit, self.contact.quantity = ("m", "gap") if which == "gap" else ("Pa", "pressure")
        if not np.isfinite(shown["values"]).any():
            shown["values"] = np.zeros_like(shown["values"])
        self.contact.show(shown, units, "Gap" if which == "gap" else "Contact pressure", limits=limits)

    def show_peaks(self, peaks: Mapping[str, Array], units: Units, frame: Mapping[str, Any]) -> None:
        """Draw the peaks of the field that is shown; columns x, y, depth in m, value in Pa."""
        place = units.of(max(frame["dw"], frame["dh"]), "m")[0]
        deep, depth_unit = units.of(peaks["depth"] if len(peaks["depth"]) else [1e-6], "m")
        factor, symbol = units.of(peaks["value"] if len(peaks["value"]) else [1e6], "Pa")
        self.peaks.data = {
            "x": peaks["x"] / place,
            "y": peaks["y"] / place,
            "depth": peaks["depth"] / deep,
            "value": peaks["value"] / factor,
        }
        self.scatter.xaxis.axis_label, self.scatter.yaxis.axis_label = (
            f"peak ({symbol})",
            f"depth ({depth_unit})",
        )
        self._tip.tooltips = [
            ("peak", f"@value{{0.000}} {symbol}"),
            ("depth", f"@depth{{0.00}} {depth_unit}"),
        ]

    def mark(self, number: int | None) -> None:
        """Mark a peak in all pictures."""
        self._is_marking = True
        self.peaks.selected.indices = [] if number is None else [number]
        self._is_marking = False

    def show_plane(
        self, found: Mapping[str, Any], units: Units, words: str, level: float | None, limits: Any
    ) -> None:
        """Draw a plane, with the line of the yield stress."""
        palette = SIGNED if limits[0] < 0 else Viridis256
        for each in (self.plane, self.section):
            each.palette, each.mapper.palette = palette, palette
        self.plane.show(found["plane"], units, words, level, limits)

    def show_section(
        self, found: Mapping[str, Any], ends: Ends, units: Units, level: float | None, limits: Any
    ) -> None:
        """Draw the section along a line."""
        self.plane.draw_line(ends)
        self.section.show(found["section"], units, "", level, limits)


def later(document: Any, change: Callable[..., None], *arguments: Any) -> None:
    """Change a document when it is free."""
    document.add_next_tick_callback(partial(change, *arguments))
