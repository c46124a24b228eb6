"""Results as the pictures need them: title, grid, fields, unit system, and the solid under a contact."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.errors import shown
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid, Sliding, layer_from, layer_of, traction_direction
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import TwoBodies
from asperity.fourier.grid import Grid, grid_of
from asperity.results.dataset import height_of, settings_of, unit_system
from asperity.results.variables import SI_UNITS
from asperity.views.style import label, plain_text

SURFACE_FIELDS = ("height", "pressure", "gap", "displacement", "plastic_depth", "sticking_pressure")

Span = tuple[float, float]
"""First and last position of a part of an axis."""

Part = tuple[slice, slice]
"""Rows and columns of the nodes of a part of a cell: index of a field [y, x]."""

_EDGE_ERROR = 1e-9
"""A node outside by at most this fraction of the edge, by rounding, is taken as inside."""


@dataclass(frozen=True)
class Source:
    """A result to draw or to export.

    Parameters
    ----------
    title : str
        Label of the surface; empty if it has none.
    grid : Grid
    system : str or None
        Unit system, None if it is not known.
    fields : dict
        Members of `SURFACE_FIELDS` that the result has, as arrays [y, x].
    layers : dict
        ``lower`` and, of two elastic bodies, ``upper`` → the solid, if the result is a contact and describes
        it.
    boundary : "periodic" | "free"
        As of a `Contact`.
    sliding : Sliding
        Of the lower body.
    load : callable, optional
        Name of a body → the body under everything that loads it; by default under the pressure alone.
    """

    title: str
    grid: Grid
    system: str | None
    fields: dict[str, Array]
    layers: dict[str, Solid]
    boundary: str = "periodic"
    sliding: Sliding = Sliding()  # noqa: RUF009  is immutable
    load: Callable[[str], LoadedSolid] | None = None

    def field(self, name: str) -> Array:
        """One of the fields.

        Raises
        ------
        ValueError
            If the result does not have it.
        """
        if name not in self.fields:
            known = ", ".join(self.fields) or "no fields over the surface"
            raise ValueError(f"{name}: the result has {known}")
        return self.fields[name]

    def shown(self, length: float) -> str:
        """A length with its unit, for messages."""
        return shown_si(length, "m") if self.system == SI_UNITS else f"{length:.6g}"

    def part(self, y: Span | None = None, x: Span | None = None) -> Part:
        """The nodes between two positions along each axis, both included; by default all of them.

        Raises
        ------
        ValueError
            If the positions do not rise, lie outside the cell, or have fewer than two nodes between them.
        """
        rows, columns = (self._nodes(axis, span) for axis, span in enumerate((y, x)))
        return rows, columns

    def _nodes(self, axis: int, span: Span | None) -> slice:
        nodes, edge = self.grid.coordinates()[axis], self.grid.length[axis]
        if span is None:
            return slice(0, nodes.size)
        low, high = span
        given, margin = f"{'yx'[axis]} = {self.shown(low)} to {self.shown(high)}", _EDGE_ERROR * edge
        if not 0 <= low < high <= edge + margin:
            raise ValueError(f"{given}: rising positions from 0 to {self.shown(edge)} are needed")
        first, last = map(int, np.searchsorted(nodes, (low - margin, high + margin)))
        if last - first < 2:
            apart = self.shown(edge / nodes.size)
            raise ValueError(f"{given}: at least two nodes are needed, they are {apart} apart")
        return slice(first, last)

    def positions(self, part: Part) -> tuple[Array, Array]:
        """Positions y and x of the nodes of a part."""
        y, x = self.grid.coordinates()
        return y[part[0]], x[part[1]]

    def node(self, axis: str, position: float) -> int:
        """The node nearest to a position along an axis.

        Raises
        ------
        ValueError
            If the position lies outside the cell.
        """
        number = "yx".index(axis)
        edge = self.grid.length[number]
        if not 0 <= position <= edge:
            raise ValueError(
                f"{axis} = {self.shown(position)}: a position from 0 to {self.shown(edge)} is needed"
            )
        node, nodes = round(position / self.grid.spacing[number]), self.grid.shape[number]
        return min(node, nodes - 1) if self.grid.mirrored else node % nodes

    def loaded(
        self,
        body: str = "lower",
        friction: float | None = None,
        sliding_direction: str | float | None = None,
    ) -> tuple[LoadedSolid, dict[str, Any]]:
        """A body under its contact pressure, and its friction as arguments of `asperity.stress_planes`.

        Parameters
        ----------
        body : "lower" | "upper"
        friction, sliding_direction : float, str or float, optional
            Coefficient, and direction in which the upper body moves over the lower one; by default as in the
            result.

        Raises
        ------
        ValueError
            If the result is no contact, does not describe its solid, or has no such body.
        """
        if not self.layers or "pressure" not in self.fields:
            raise ValueError("contact: the result of a contact, with its pressure and its solid, is needed")
        if body not in self.layers:
            raise ValueError(f"body = {shown(body)}: {' or '.join(self.layers)} is needed")
        direction = self.sliding.sliding_direction if sliding_direction is None else sliding_direction
        if self.load is not None:
            solid = self.load(body)
        else:
            pressure, sticking = self.fields["pressure"].astype(float), self.fields.get("sticking_pressure")
            layer = self.layers[body]
            solid = LoadedSolid(pressure, self.grid, layer, self.boundary, sticking_pressure=sticking)
        return solid, {
            "friction": self.sliding.friction if friction is None else friction,
            "sliding_direction": traction_direction(direction, body),
        }


def titled(results: Any) -> list[tuple[str | None, Any]]:
    """Results with the titles that are given, of one result, a sequence, or a mapping from titles to results.

    Raises
    ------
    ValueError
        If there is none.
    """
    if isinstance(results, Mapping) and not isinstance(results, xr.Dataset):
        found: list[tuple[str | None, Any]] = [(str(title), result) for title, result in results.items()]
    elif isinstance(results, Sequence) and not isinstance(results, str):
        found = [(None, result) for result in results]
    else:
        found = [(None, results)]
    if not found:
        raise ValueError("result: at least one result is needed")
    return found


def sources(results: Any, unit_system: str | None = None) -> list[Source]:
    """Sources of one result, of a sequence of results, or of a mapping from titles to results.

    Parameters
    ----------
    results : dataset, object with ``grid``, answer, sequence or mapping
        Datasets of stage surface or contact, objects such as `Contact`, or answers of `asperity.run`.
    unit_system : str, optional
        Of results that do not say theirs.

    Raises
    ------
    TypeError
        If a result is of another kind.
    ValueError
        If there is none, or some are dimensionless and others are not.
    """
    found = [_source(result, unit_system, title) for title, result in titled(results)]
    require_same_system([source.system for source in found])
    return found


def require_same_system(systems: Sequence[str | None]) -> None:
    """Raise `ValueError` if results have several unit systems."""
    if len(set(systems)) > 1:
        raise ValueError("result: results in one unit system are needed, not SI beside dimensionless ones")


def title_of(data: xr.Dataset) -> str:
    """Label of the surface of a dataset, or its name as plain text; empty if it has neither."""
    if "settings" not in data.attrs:
        return ""
    try:
        return label(data)
    except (KeyError, TypeError):
        return plain_text(str(settings_of(data).get("name", "")))


def _source(result: Any, unit_system: str | None, title: str | None) -> Source:
    if isinstance(result, xr.Dataset):
        return _source_of_dataset(result, title)
    if hasattr(result, "contact") and hasattr(result, "loaded"):  # an answer, with film, slip and coating
        found, case = _source(result.contact, SI_UNITS, title), result.case
        sliding = Sliding(case.friction, case.sliding_direction)
        return replace(
            found, title=title or plain_text(result.face.name), sliding=sliding, load=result.loaded
        )
    grid = getattr(result, "grid", None)
    named = {name: getattr(result, name, None) for name in SURFACE_FIELDS}
    fields = {name: values for name, values in named.items() if values is not None}
    if not isinstance(grid, Grid) or not fields:
        raise TypeError(
            f"result = {shown(result)}: a result of stage surface or contact, or an object with grid and "
            "height or pressure, such as a Contact, is needed"
        )
    solid = getattr(result, "solid", None) or getattr(result, "layer", None)
    layers = {"lower": solid} if isinstance(solid, Solid) else {}
    if isinstance(solid, TwoBodies):
        layers = {"lower": solid.lower, "upper": solid.upper}
    system = getattr(result, "unit_system", unit_system)
    return Source(title or "", grid, system, fields, layers, getattr(result, "boundary", "periodic"))


def _source_of_dataset(data: xr.Dataset, title: str | None) -> Source:
    if not {"y", "x"} <= set(data.sizes):
        raise TypeError("result: a dataset of stage surface or contact, with fields over y and x, is needed")
    found = {name: data[name].transpose("y", "x") for name in SURFACE_FIELDS if name in data}
    if "height" not in found and {"gap", "displacement", "approach"} <= set(data.variables):
        height = height_of(data).transpose("y", "x")
        found = {"height": height - height.mean(), **found}
    layers, sliding = {}, Sliding()
    if "settings" in data.attrs:
        settings = settings_of(data)
        sliding = Sliding(settings.get("friction", 0.0), settings.get("sliding_direction", "x"))
        if "pressure" in data and "solid" in data.attrs:
            layers["lower"] = layer_of(data)  # the stress depends on the pressure and not on the modulus
        if layers and (upper := settings.get("upper")):
            layers["upper"] = layer_from(upper)
    return Source(
        title_of(data) if title is None else title,
        grid_of(data),
        unit_system(data),
        {name: values.values for name, values in found.items()},
        layers,
        str(data.attrs.get("boundary", "periodic")),
        sliding,
    )
