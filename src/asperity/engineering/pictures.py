"""Pictures of an answer for its folder and its report."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity.engineering.answer import Answer, body_title
from asperity.engineering.run import STRESS_TOLERANCE, scaled_solid
from asperity.stress.planes import stress_planes
from asperity.types import Array
from asperity.units import scaled_unit, shown_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROBUST_PERCENT = 99.9
"""Percentage of the values that a colour scale covers, so that one spike does not flatten it."""

SIZE = (6.4, 5.2)
"""Width and height of a picture in inches."""


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption and the figure."""

    name: str
    caption: str
    figure: Figure


def pictures(answer: Answer) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, and the stress in each body."""
    with _style():
        yield Picture(
            "height",
            "Height of the surface that was pressed, peaks upward, and the outlines of the real contact.",
            _map(answer, -answer.indenter.height, "m", "height", symmetric=True, outline="black"),
        )
        yield Picture(
            "pressure",
            "Contact pressure.",
            _map(answer, answer.contact.pressure, "Pa", "contact pressure", outline=None),
        )
        for body in answer.bodies:
            suffix = "" if len(answer.bodies) == 1 else f"_{body}"
            depth = answer.bodies[body].depth
            if not np.isfinite(depth):
                continue
            yield Picture(
                f"von_mises{suffix}",
                f"Von Mises stress at the depth of its largest value, {shown_si(depth, 'm', 3)}; "
                f"{body_title(answer.case, body)}. The cross marks that value.",
                _plane(answer, body, depth),
            )
            yield Picture(
                f"depth{suffix}",
                f"Largest and mean von Mises stress over depth; {body_title(answer.case, body)}.",
                _profile(answer, body),
            )


@contextmanager
def _style() -> Iterator[None]:
    import matplotlib as mpl

    with mpl.rc_context({"font.size": 11, "figure.dpi": 110, "savefig.dpi": 130, "image.cmap": "viridis"}):
        yield


def _figure() -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(SIZE, layout="constrained")
    return figure, figure.add_subplot()


def _map(
    answer: Answer,
    field: Array,
    unit: str,
    label: str,
    symmetric: bool = False,
    outline: str | None = "white",
) -> Figure:
    """A field on the map, without its mirror images."""
    grid = answer.contact.grid
    rows, columns = (
        round(nodes * edge / cell)
        for nodes, edge, cell in zip(grid.shape, answer.indenter.map_length, grid.length, strict=True)
    )
    figure, axes = _figure()
    touching = (answer.contact.pressure > 0)[:rows, :columns]
    _image(axes, field[:rows, :columns], answer.indenter.map_length, unit, label, symmetric)
    if outline and touching.any() and not touching.all():
        factor, _ = scaled_unit(answer.indenter.map_length, "m")
        (dy, dx), (ny, nx) = grid.spacing, touching.shape
        place = np.arange(nx) * dx / factor, np.arange(ny) * dy / factor
        axes.contour(*place, touching, levels=[0.5], colors=outline, linewidths=0.6)
    return figure


def _plane(answer: Answer, body: str, depth: float) -> Figure:
    """The von Mises stress in one plane."""
    part = answer.case.bodies[body]
    scaled, modulus = scaled_solid(answer.contact, part)
    (plane,) = stress_planes(scaled, [depth], fields=("von_mises",), tolerance=STRESS_TOLERANCE)
    field = plane.fields["von_mises"][0] * modulus
    rows, columns = (
        round(nodes * edge / cell)
        for nodes, edge, cell in zip(
            plane.grid.shape, answer.indenter.map_length, plane.grid.length, strict=True
        )
    )
    figure, axes = _figure()
    _image(axes, field[:rows, :columns], answer.indenter.map_length, "Pa", "von Mises stress", False)
    factor, _ = scaled_unit(answer.indenter.map_length, "m")
    top = answer.bodies[body]
    axes.plot(top.x / factor, top.y / factor, "x", color="red", markersize=9, markeredgewidth=2)
    return figure


def _image(
    axes: Axes, field: Array, length: tuple[float, float], unit: str, label: str, symmetric: bool
) -> None:
    """A field with axes and colours in units with sensible prefixes."""
    length_factor, length_symbol = scaled_unit(length, "m")
    top = float(np.percentile(np.abs(field), ROBUST_PERCENT)) or float(np.abs(field).max()) or 1.0
    factor, symbol = scaled_unit(top, unit)
    extent = (0.0, length[1] / length_factor, 0.0, length[0] / length_factor)
    image = axes.imshow(
        field / factor,
        origin="lower",
        extent=extent,
        vmin=-top / factor if symmetric else 0.0,
        vmax=top / factor,
        cmap="cividis" if symmetric else "viridis",
        interpolation="nearest",
    )
    axes.set(xlabel=f"x ({length_symbol})", ylabel=f"y ({length_symbol})")
    beyond = float(np.abs(field).max()) > top * (1 + 1e-9)
    extend = ("both" if symmetric else "max") if beyond else "neither"
    axes.figure.colorbar(image, ax=axes, label=f"{label} ({symbol})", extend=extend)


def _profile(answer: Answer, body: str) -> Figure:
    """Largest and mean von Mises stress over depth, with the yield stress."""
    stress, part = answer.stresses[body], answer.bodies[body]
    depths = stress["plane_depth"].values
    largest, mean = (stress[f"{name}_von_mises"].values[0] for name in ("largest", "mean"))
    depth_factor, depth_symbol = scaled_unit(_shown_depth(depths, largest), "m")
    factor, symbol = scaled_unit(largest, "Pa")
    figure, axes = _figure()
    shown: list[tuple[str, Any]] = [("largest", largest), ("mean", mean)]
    for label, values in shown:
        axes.plot(values / factor, depths / depth_factor, label=label)
    if part.body.yield_stress is not None:
        axes.axvline(part.body.yield_stress / factor, color="black", linestyle="--", label="yield stress")
    axes.set(
        xlabel=f"von Mises stress ({symbol})",
        ylabel=f"depth ({depth_symbol})",
        xlim=(0, None),
        ylim=(_shown_depth(depths, largest) / depth_factor, 0),
    )
    axes.legend(frameon=False)
    return figure


def _shown_depth(depths: Array, largest: Array) -> float:
    """Depth below which the largest stress stays under a fiftieth of the range above its end value."""
    limit = largest[-1] + 0.02 * (largest.max() - largest[-1])
    above = np.flatnonzero(largest > limit)
    return float(depths[min(above[-1] + 1, depths.size - 1)]) if above.size else float(depths[-1])
