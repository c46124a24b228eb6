"""Pictures that the page draws: maps of a field, curves, sections, and peaks over their depth, by Bokeh."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.events import Pan, PanEnd, PanStart
from bokeh.models import ColumnDataSource, CustomJS, FixedTicker, HoverTool, LinearColorMapper, TapTool
from bokeh.models.annotations import ColorBar
from bokeh.palettes import Cividis256, RdBu11, Viridis256, interp_palette
from bokeh.plotting import figure

from asperity.core.types import Array
from asperity.core.units import scaled_unit, to_si

SIGNED = tuple(interp_palette(RdBu11[::-1], 255))
"""Colours of a field with a sign; all palettes are safe for the colour-blind."""

SPIKES = 3.0
"""Distance from the quartiles of heights, over their range, beyond which all have one colour."""

Ends = tuple[float, float, float, float]
"""Coordinates x, y of the first end of a line and x, y of the second one, in m."""

Limits = tuple[float, float]
"""Smallest and largest value of the colours."""

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
        """Factor and symbol of the unit in which values in an SI unit are shown."""
        chosen = {"m": self.length, "Pa": self.stress}.get(unit, "")
        dimension = "length" if unit == "m" else "pressure"
        return (to_si(f"1 {chosen}", dimension), chosen) if chosen else scaled_unit(values, unit)


def _figure(label: str, **options: Any) -> Any:
    """An empty figure that takes the colours of the page, described for a screen reader."""
    options.setdefault("sizing_mode", "stretch_width")
    made = figure(
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
        self.title, self.quantity, self.unit = title, quantity, unit
        self.image = ColumnDataSource({name: [] for name in ("image", "x", "y", "dw", "dh")})
        self.line = ColumnDataSource({"x": [], "y": []})
        self.outline = ColumnDataSource({"xs": [], "ys": []})
        self.mapper = LinearColorMapper(palette=palette, nan_color="rgba(0,0,0,0)")
        self._is_section, self._shown = is_section, (0.0, 0.0, 0.0, 0.0)
        self._values, self._drawn = np.empty((0, 0)), dict[str, Any]()
        mode: dict[str, Any] = {} if is_section else {"sizing_mode": "scale_width"}
        self.figure = _figure(
            title,
            title=title,
            height=260 if is_section else 420,
            min_border_right=10,
            x_range=(0, 1),
            y_range=(0, 1),
            **mode,
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
        if peaks is not None:
            self.figure.scatter(
                *("x", "y"), source=peaks, size=9, fill_alpha=0, line_color="#ffffff", line_alpha=0.55,
                selection_line_color="#d55e00", selection_line_width=3, selection_line_alpha=1,
                selection_fill_alpha=0, nonselection_line_alpha=0.3, nonselection_fill_alpha=0,
            )  # fmt: skip
            self.figure.add_tools(TapTool(mode="replace"))
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
        limits: Limits | None = None,
        deepest: float = 0.0,
    ) -> None:
        """Draw a field on its frame in m, with the contour of a level, in colours between two limits.

        `deepest` is the end of the depth axis of a section.
        """
        values, edge = shown["values"], max(shown["dw"], shown["dh"])
        self._factor, length = units.of(edge, "m")
        low, high = limits or (float(np.nanmin(values)), float(np.nanmax(values)))
        factor, symbol = units.of([low, high], self.unit)
        if self.mapper.palette == list(SIGNED):
            low, high = -max(-low, high), max(-low, high)
        self.mapper.update(low=low / factor, high=max(high, low + 1e-30) / factor)
        self.bar.title = symbol
        frame = {name: [shown[name] / self._factor] for name in ("x", "y", "dw", "dh")}
        self.figure.xaxis.axis_label = f"{'along the line' if self._is_section else 'x'} ({length})"
        self.figure.yaxis.axis_label = f"{'depth' if self._is_section else 'y'} ({length})"
        self.hover.tooltips = [
            (self.quantity, f"@image{{0.000}} {symbol}"),
            ("place", f"$x{{0.00}} {length}, $y{{0.00}} {length}"),
        ]
        self.figure.title.text = title or self.title
        x, y, width, height = (frame[name][0] for name in ("x", "y", "dw", "dh"))
        if self._is_section:
            y, height = deepest / self._factor, -deepest / self._factor
        else:
            self.figure.aspect_ratio = float(np.clip(1.15 * shown["dw"] / shown["dh"], 0.7, 2.5))
        if self._shown != (x, y, width, height):  # into a map that was shown before one may have zoomed
            self._shown = x, y, width, height
            for axis, start, size in ((self.figure.x_range, x, width), (self.figure.y_range, y, height)):
                axis.update(start=start, end=start + size, reset_start=start, reset_end=start + size)
        drawn = frame | {"factor": factor, "level": level}
        if values is self._values and drawn == self._drawn:  # megabytes, which the browser has
            return
        self._values, self._drawn = values, drawn
        self.image.data = {"image": [values / np.float32(factor)], **frame}
        lines: Any = []
        if level is not None and min(values.shape) >= 2 and values.min() < level < values.max():
            from contourpy import contour_generator

            rows, columns = values.shape
            along_x = (shown["x"] + (np.arange(columns) + 0.5) * shown["dw"] / columns) / self._factor
            along_y = (shown["y"] + (np.arange(rows) + 0.5) * shown["dh"] / rows) / self._factor
            lines = contour_generator(along_x, along_y, values).lines(level)
        self.outline.data = {"xs": [line[:, 0] for line in lines], "ys": [line[:, 1] for line in lines]}


def _curve(title: str, x: str, y: str, **options: Any) -> Any:
    """A figure of one curve, with values under the pointer."""
    made = _figure(title, title=title, height=220, **options)
    made.line("x", "y", source=ColumnDataSource({"x": [], "y": []}), line_width=2, line_color="#0072b2")
    made.add_tools(HoverTool(tooltips=[(x, "@x{0.000a}"), (y, "@y{0.000a}")], mode="vline"))
    made.xaxis.axis_label, made.yaxis.axis_label = x, y
    return made


def _draw_curve(curve: Any, x: Array, y: Array, units: tuple[str, str]) -> None:
    """Draw a curve, whose numbers are in the units."""
    curve.renderers[0].data_source.data = {"x": x, "y": y}
    for axis, unit in zip((curve.xaxis, curve.yaxis), units, strict=True):
        axis.axis_label = f"{axis[0].axis_label.partition(' (')[0]} ({unit})"


class MapPictures:
    """Pictures of the step "Map"."""

    def __init__(self, on_line: Callable[[Ends], None]) -> None:
        self.image = MapFigure("Height, peaks upward", "height", "m", Cividis256, on_line)
        self.profile = _curve("Profile along the line", "distance", "height")
        self.histogram = _curve("Distribution of heights", "height", "density")
        self.spectrum = _curve(
            "Power spectrum", "wavelength", "density", x_axis_type="log", y_axis_type="log"
        )
        decades = np.outer(10.0 ** np.arange(-6, 7), [1, 3]).ravel().tolist()
        self.spectrum.xaxis.ticker = FixedTicker(ticks=decades)

    def roots(self) -> dict[str, Any]:
        """Name in the page → figure."""
        curves = {"profile": self.profile, "histogram": self.histogram, "spectrum": self.spectrum}
        return {f"map_{name}": each for name, each in ({"image": self.image.figure} | curves).items()}

    def show(self, found: Mapping[str, Any], units: Units) -> None:
        """Draw the heights of a map, and their distribution."""
        values = found["picture"]["values"]
        least, low, high, most = np.percentile(values, (0, 25, 75, 100)).tolist()
        reach = SPIKES * (high - low)
        self.image.show(found["picture"], units, limits=(max(least, low - reach), min(most, high + reach)))
        density, edges = found["histogram"]
        factor, symbol = units.of(edges, "m")
        steps = np.repeat(edges, 2)[1:-1] / factor, np.repeat(density, 2) * 1e-6
        _draw_curve(self.histogram, *steps, (symbol, "1/µm"))

    def show_spectrum(self, wavelength: Array, power: Array, units: Units) -> None:
        """Draw the power spectrum of a map."""
        factor, symbol = units.of(wavelength, "m")
        _draw_curve(self.spectrum, wavelength / factor, power * 1e24, (symbol, "µm⁴"))

    def show_profile(self, distance: Array, values: Array, ends: Ends, units: Units) -> None:
        """Draw the heights along a line."""
        self.image.draw_line(ends)
        (factor, symbol), (high, unit) = units.of(distance, "m"), units.of(values, "m")
        _draw_curve(self.profile, distance / factor, values / high, (symbol, unit))


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
        self.prefix = ""  # of the titles: the number of the answer, where two are shown
        self.peaks = ColumnDataSource({name: [] for name in ("x", "y", "depth", "value")})
        self.peaks.selected.on_change("indices", self._selected)
        self.contact = MapFigure("Contact pressure", "pressure", "Pa", Viridis256, peaks=self.peaks)
        self.plane = MapFigure("Stress in a plane", "stress", "Pa", Viridis256, on_line, self.peaks)
        self.section = MapFigure("Section along the line", "stress", "Pa", Viridis256, is_section=True)
        self.scatter = _figure("Peaks over depth", title="Peaks over depth", height=300)
        marked = {f"selection_{name}": value for name, value in (("color", "#d55e00"), ("alpha", 1))}
        look = {"size": 8, "color": "#0072b2", "alpha": 0.7, "nonselection_alpha": 0.35}
        drawn = self.scatter.scatter("value", "depth", source=self.peaks, **look, **marked)
        self.scatter.y_range.flipped = True
        self._tip = HoverTool(renderers=[drawn], tooltips=None)
        self.scatter.add_tools(self._tip, TapTool(mode="replace"))

    def roots(self) -> dict[str, Any]:
        """Name in the page → figure."""
        figures = {name: getattr(self, name).figure for name in ("contact", "plane", "section")}
        return {f"{name}{self._place}": each for name, each in (figures | {"scatter": self.scatter}).items()}

    def _selected(self, _: str, __: Any, indices: list[int]) -> None:
        if indices and not self._is_marking:
            self._on_peak(indices[0])

    def show_contact(self, shown: Mapping[str, Any], which: str, units: Units, limits: Limits) -> None:
        """Draw the contact: its pressure, or the gap."""
        self.contact.unit, self.contact.quantity = ("m", "gap") if which == "gap" else ("Pa", "pressure")
        title = "Gap" if which == "gap" else "Contact pressure"
        self.contact.show(shown, units, self.prefix + title, limits=limits)

    def show_peaks(
        self, peaks: Mapping[str, Array], units: Units, frame: Mapping[str, Any], limits: Limits
    ) -> None:
        """Draw peaks with columns x, y, depth in m and value in Pa over a frame.

        The limits are the largest depth and value of all answers, which have their units and axes in common.
        """
        place = units.of(max(frame["dw"], frame["dh"]), "m")[0]
        (deep, length), (factor, symbol) = units.of(limits[0], "m"), units.of(limits[1], "Pa")
        factors = {"x": place, "y": place, "depth": deep, "value": factor}
        self.peaks.data = {name: peaks[name] / each for name, each in factors.items()}
        self.scatter.title.text = f"{self.prefix}Peaks over depth"
        self.scatter.xaxis.axis_label, self.scatter.yaxis.axis_label = f"peak ({symbol})", f"depth ({length})"
        self._tip.tooltips = [("peak", f"@value{{0.000}} {symbol}"), ("depth", f"@depth{{0.00}} {length}")]

    def mark(self, number: int) -> None:
        """Mark a peak in all pictures; none for a negative number."""
        self._is_marking = True
        self.peaks.selected.indices = [] if number < 0 else [number]
        self._is_marking = False

    def show_planes(
        self,
        plane: Mapping[str, Any],
        section: Mapping[str, Any] | None,
        ends: Ends,
        units: Units,
        title: str,
        level: float | None,
        limits: Limits,
        deepest: float,
    ) -> None:
        """Draw a plane and a section to a depth in common colours, with the line of the yield stress."""
        for each in (self.plane, self.section):
            each.mapper.palette = SIGNED if limits[0] < 0 else Viridis256
        self.plane.show(plane["picture"], units, self.prefix + title, level, limits)
        self.plane.draw_line(ends)
        if section is not None:
            title = self.prefix + self.section.title
            self.section.show(section["picture"], units, title, level, limits, deepest)
