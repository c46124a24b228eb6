"""Pictures of an answer: overviews of the map, and the place of the largest stress close to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.colors import LogNorm

from asperity.contact.gap import FilmFlow
from asperity.core.types import Array
from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.answer import Answer, body_title, cycle_axis, cycles_title
from asperity.engineering.body_stress import CloseUp
from asperity.engineering.load_curve import AnswerCurve
from asperity.fourier.grid import Grid
from asperity.results.variables import SI_UNITS
from asperity.views.maps import HEIGHT, PLASTIC_DEPTH, PRESSURE, SHEAR_TRACTION, SLIP, Map, draw_maps, map_of
from asperity.views.panels import canvas
from asperity.views.peak_plot import plot_peaks
from asperity.views.scales import STRESS, Look
from asperity.views.source import Part, Source, sources
from asperity.views.stress_plot import draw_sections, field_look, field_words, until_faded
from asperity.views.style import plain_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MAPS = {
    "height": (HEIGHT, "Heights as pressed face down, lowest first, with the outlines of the contact"),
    "pressure": (PRESSURE, "Contact pressure, white where there is no contact"),
    "shear_traction": (SHEAR_TRACTION, "Shear traction by the tangential force"),
    "slip": (
        SLIP,
        "Slip of the faces under the tangential force, white within the outlines where they stick",
    ),
    "plastic_depth": (PLASTIC_DEPTH, "Plastic depth, by which the surface is flattened at the hardness"),
}
"""Field of the contact → its colours, and the caption of its picture."""

CURVE_CAPTION = (
    "Load curve: real contact, mean gap, largest pressure, stiffness and largest von Mises stress against "
    "the mean pressure. A dotted line marks a load where yield begins."
)

CYCLE_CAPTION = (
    "Tangential force against tangential displacement in a cycle between the force and its opposite, after "
    "the first loading (dashed). The loop encloses the energy that a cycle loses."
)

FLOW_CAPTION = (
    "Film that leaks through the gap: volume per time and width over its mean, and pressure. The gap is "
    "closed in the black parts."
)

LEAST_FLUX = 1e-3
"""Flux over the mean one at the lower end of the colours."""

WIDE = 10
"""Largest over smallest value of a number of a load curve above which its axis is logarithmic."""

FADED = 0.1
"""A section ends where the stress is below the yield stress and this share of the largest stress."""

FRAMED = "framed part"
"""Title of the second map."""


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption, the figure, and the body it shows.

    The body is empty for pictures of the contact.
    """

    name: str
    caption: str
    figure: Figure
    body: str = ""


def pictures(answer: Answer) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, and the stress in each body.

    Mirror images of the map are left out. A close-up of the largest stress is beside each overview. The
    stress is drawn in a plane and in a section through the extreme value of each field, and as its peaks.
    """
    (source,) = sources({plain_text(answer.face.name): answer.contact}, SI_UNITS)
    if answer.slip is not None:
        slip = {"shear_traction": answer.slip.traction, "slip": answer.slip.slip}
        source = replace(source, fields=source.fields | slip)
    field = answer.case.fields[0]
    near = _close_up(answer, "lower", field)
    for name, (look, caption) in MAPS.items():
        if name not in source.fields or (name == "plastic_depth" and not answer.contact.plastic_area):
            continue
        maps = [map_of(source, name, _whole(answer, source.grid))]
        if near is not None:
            maps.append(map_of(source, name, near.part, FRAMED))
            caption += f"; on the right close to {_shown(answer, 'lower', field, near)}"
        yield Picture(name, f"{caption}.", _drawn(maps, look))
    if answer.curve is not None:
        yield Picture("curve", CURVE_CAPTION, _of_curve(answer.curve))
    if answer.flow is not None:
        yield Picture("flow", FLOW_CAPTION, _of_flow(answer, answer.flow))
    if answer.cycle is not None:
        yield Picture("cycle", CYCLE_CAPTION, _of_cycle(answer.cycle))
    for body in answer.case.different_bodies:
        for field in answer.case.fields:
            yield from _of_stress(answer, source, body, field)
        yield from _of_cycles(answer, source, body)


def _of_curve(curve: AnswerCurve) -> Figure:
    """Numbers of a load curve against the mean pressure."""
    numbers = curve.numbers
    loads = numbers["mean_pressure"].values
    panels = {
        "area_fraction": ("real contact", 1.0),
        "mean_gap": ("mean gap (nm)", 1e9),
        "largest_pressure": ("largest pressure (GPa)", 1e-9),
        "stiffness": ("stiffness (GPa/µm)", 1e-15),
        "largest_von_mises_stress": ("von Mises stress (GPa)", 1e-9),
    }
    with canvas([0.8] * len(panels), None) as (figure, axes):
        for axis, (name, (label, factor)) in zip(axes, panels.items(), strict=True):
            values = factor * numbers[name].values.reshape(loads.size, -1)
            margin = max((loads[-1] / loads[0]) ** 0.05, 1.01)
            limits = 1e-6 * loads[0] / margin, 1e-6 * loads[-1] * margin
            axis.set(xscale="log", xlim=limits, xlabel="mean pressure (MPa)", ylabel=label)
            for column, marker in zip(values.T, "os", strict=False):
                axis.plot(1e-6 * loads, column, f"-{marker}", ms=3)
            finite = values[np.isfinite(values)]  # the stiffness is infinite in full contact
            highest = finite.max(initial=0)
            if highest > WIDE * finite.min(initial=np.inf) > 0:
                axis.set_yscale("log")
            elif highest > 0:
                axis.set_ylim(0, 1.1 * highest)
        bodies = [str(body) for body in numbers["body"].values]
        if len(bodies) > 1:
            axis.legend([f"{body} body" for body in bodies])
        for name, load in curve.yield_loads.items():
            if 0 < load < np.inf:
                axis.axvline(1e-6 * load, color=f"C{bodies.index(name)}", ls=":", lw=1)
    return figure


def _of_cycle(cycle: pd.DataFrame) -> Figure:
    """Loop of tangential force and displacement; first loading is half of the way back, reversed."""
    factors, symbols = zip(*map(scaled_unit, cycle.abs().max(), ("N", "m")), strict=True)
    force, displacement = (cycle.to_numpy() / factors).T
    back = slice(force.size // 2 + 1)
    with canvas([0.8], None) as (figure, (axis,)):
        axis.plot(displacement, force, "-o", ms=3)
        axis.plot((displacement[0] - displacement[back]) / 2, (force[0] - force[back]) / 2, "--")
        axis.set(xlabel=f"tangential displacement ({symbols[1]})", ylabel=f"tangential force ({symbols[0]})")
    return figure


def _of_flow(answer: Answer, flow: FilmFlow) -> Figure:
    """Maps of the flux of the film over its mean, and of its pressure; black where the gap is closed."""
    (ny, nx), (length, unit) = flow.pressure.shape, scaled_unit(max(answer.face.map_length), "m")
    factor, symbol = scaled_unit(float(np.nanmax(flow.pressure)), "Pa")
    flux = np.hypot(*flow.flux)
    relative = flux / np.hypot(*flow.flux.mean(axis=(1, 2)))
    edges = [edge / length for edge in answer.face.map_length]
    panels: list[tuple[str, Array, dict[str, Any]]] = [
        ("flux over the mean flux", relative, {"norm": LogNorm(LEAST_FLUX, relative.max())}),
        (f"pressure of the film ({symbol})", flow.pressure / factor, {"vmin": 0.0}),
    ]
    with canvas([ny / nx] * 2, None) as (figure, axes):
        for axis, (label, values, colours) in zip(axes, panels, strict=True):
            axis.set_facecolor("black")
            shown = np.ma.masked_where(np.isnan(flow.pressure), values)
            place: dict[str, Any] = {"origin": "lower", "extent": (0, edges[1], 0, edges[0])}
            image = axis.imshow(shown, **place, **colours)
            axis.set(xlabel=f"x ({unit})", ylabel=f"y ({unit})")
            figure.colorbar(image, ax=axis, label=label, location="bottom")
    return figure


def _of_stress(answer: Answer, source: Source, body: str, field: str) -> Iterator[Picture]:
    """Pictures of one field of the stress in one body."""
    end = f"; {body_title(answer.case, body)}."
    level = answer.case.bodies[body].yield_stress if field == "von_mises" else None
    if level is not None:
        below = "" if answer.case.bodies[body].coating is None else " below the coating"
        end = f"; the line is the yield stress{below}, {shown_si(level, 'Pa')}{end}"
    suffix = ("" if field == "von_mises" else f"_{field}") + suffix_of(answer, body)
    word = field_words(field)
    capital, look = word[0].upper() + word[1:], field_look(field)
    near = _close_up(answer, body, field)
    if near is not None:
        depth, grid, values = answer.bodies[body].planes[field]
        whole = _whole(answer, grid)
        close = near.planes[int(np.abs(np.subtract(near.depths, depth)).argmin())][field]
        overview = Map(replace(source, grid=grid, fields={}), whole, values[whole])
        figure = _drawn([overview, Map(source, near.part, close, FRAMED)], look, level)
        place = _shown(answer, body, field, near)
        at_depth = f"at the depth of its largest magnitude, {shown_si(depth, 'm', 3)}"
        caption = f"{capital} {at_depth}; on the right close to {place}"
        yield Picture(f"plane{suffix}", caption + end, figure, body)
        section = _section(answer, source, body, field, near)
        faded = min(FADED * float(np.abs(section.values).max()), level or np.inf)
        figure = draw_sections(until_faded([section], faded), look, source.system, None, level)
        caption = f"{capital} in a section close to {place}; bars are the contact"
        yield Picture(f"section{suffix}", caption + end, figure, body)
    stress = answer.bodies[body].stress.assign_attrs(unit_system=source.system)
    if (stress["peak_quantity"] == field).any():
        images = ", with those of the mirror images of the map" if answer.face.is_mirrored else ""
        figure = plot_peaks({source.title: stress}, field, yield_stress=level)
        yield Picture(f"peaks{suffix}", f"Peaks of the {word} and their depth{images}{end}", figure, body)


def _of_cycles(answer: Answer, source: Source, body: str) -> Iterator[Picture]:
    """The largest Dang Van stress of the cycles over (y, depth); a contour is the fatigue limit."""
    cycles, limit = answer.bodies[body].cycles, answer.case.bodies[body].fatigue_torsion
    if cycles is None or limit is None:
        return
    axis = cycle_axis(cycles)
    rows = _whole(answer, source.grid)["yx".index(axis)]
    section = (cycles["dang_van"] * limit).rename({"cycle_depth": "depth", f"cycle_{axis}": axis})
    touching = (source.field("pressure") > 0).any(axis="xy".index(axis))
    section = section.assign_coords(contact=(axis, touching)).isel({axis: rows}).rename(source.title)
    # Cycles in a Hertz contact go deeper than the picture, which ends at half of the edge of the map.
    section = section.sel(depth=slice(0, max(answer.face.map_length) / 2))
    look = Look("largest Dang Van stress of a cycle", "stress", STRESS, "white", np.max, low=0.0)
    faded = min(FADED * float(section.max()), limit)
    figure = draw_sections(until_faded([section.clip(0)], faded), look, source.system, None, limit)
    caption = (
        f"Largest Dang Van stress of each row across {axis}; bars are rows with contact, the line is the "
        f"fatigue limit in torsion, {shown_si(limit, 'Pa')}; {cycles_title(answer.case, body)}."
    )
    yield Picture(f"cycles{suffix_of(answer, body)}", caption, figure, body)


def suffix_of(answer: Answer, body: str) -> str:
    """End of the names of the files of one body, if there are two."""
    return f"_{body}" if len(answer.case.different_bodies) > 1 else ""


def _close_up(answer: Answer, body: str, field: str) -> CloseUp | None:
    """The close-up that holds the extreme value of a field, else that with the largest values."""
    found = answer.bodies[body].largest[field]

    def rank(box: CloseUp) -> tuple[bool, float]:
        largest = max(float(np.abs(plane[field]).max()) for plane in box.planes)
        return box.node(found.y, found.x) is not None, largest

    return max(answer.bodies[body].close_ups, key=rank, default=None)


def _shown(answer: Answer, body: str, field: str, near: CloseUp) -> str:
    """Description of the place that a close-up shows."""
    found = answer.bodies[body].largest[field]
    return "one of the highest pressures" if near.node(found.y, found.x) is None else "the largest stress"


def _whole(answer: Answer, grid: Grid) -> Part:
    """Nodes of the map on a grid of the cell."""
    rows, columns = (slice(0, count // answer.face.images) for count in grid.shape)
    return rows, columns


def _drawn(maps: list[Map], look: Look, level: float | None = None) -> Figure:
    """Maps in the same colours, with a frame in the first around the part that the second shows."""
    figure = draw_maps(maps, look, None, level)
    if len(maps) > 1:
        from matplotlib.patches import Rectangle

        overview, close = figure.axes[:2]
        (left, right), (low, high) = close.get_xlim(), close.get_ylim()
        overview.add_patch(Rectangle((left, low), right - left, high - low, fill=False, ec="C1", lw=1))
    return figure


def _section(answer: Answer, source: Source, body: str, field: str, near: CloseUp) -> xr.DataArray:
    """Vertical section across the patch, through the extreme value of a field if it is in the close-up."""
    found = answer.bodies[body].largest[field]
    values = np.array([plane[field] for plane in near.planes])
    place = near.node(found.y, found.x) or np.unravel_index(np.abs(values).argmax(), values.shape)[1:]
    axis = "yx".index(near.along)
    across = int(place[1 - axis])
    touching = source.field("pressure")[near.part].take(across, 1 - axis) > 0
    nodes = source.positions(near.part)
    title = f"{source.title}, {'yx'[1 - axis]} = {shown_si(float(nodes[1 - axis][across]), 'm', 4)}"
    return xr.DataArray(
        values.take(across, 2 - axis),
        {"depth": near.depths, near.along: nodes[axis], "contact": (near.along, touching)},
        ("depth", near.along),
        title,
    )
