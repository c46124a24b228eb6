"""Results as the pictures need them: title, grid, fields, unit system, and the solid under a contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import TwoBodies
from asperity.errors import shown
from asperity.results.dataset import settings_of
from asperity.results.window import Span, Window, window
from asperity.spectral import Grid, grid_of
from asperity.stress.pressed import PressedSolid, Sliding, layer_of, traction_direction
from asperity.types import Array
from asperity.views.measures import STUDY, told
from asperity.views.style import label

FIELDS = ("height", "pressure", "gap")

NO_SLIDING = Sliding()


@dataclass(frozen=True)
class Source:
    """A result to draw.

    Parameters
    ----------
    title : str
        Label of the surface; empty if it has none.
    grid : Grid
    system : str or None
        Unit system, None if it is not known.
    fields : dict
        Those of `FIELDS` that the result has, as arrays [y, x].
    layers : dict
        ``lower`` and, of two elastic bodies, ``upper`` → the solid, if the result is a contact and describes
        it.
    boundary : "periodic" | "free"
        As of a `Contact`.
    sliding : Sliding
        Of the lower body.
    """

    title: str
    grid: Grid
    system: str | None
    fields: dict[str, Array]
    layers: dict[str, Layer]
    boundary: str = "periodic"
    sliding: Sliding = NO_SLIDING

    def field(self, name: str) -> Array:
        """One of the fields.

        Raises
        ------
        ValueError
            If the result does not have it.
        """
        if not isinstance(name, str) or name not in self.fields:
            known = ", ".join(self.fields) or "no fields over the surface"
            raise ValueError(f"{name}: the result has {known}")
        return self.fields[name]

    def told(self, value: float) -> str:
        """A length with its unit, for messages."""
        return told(value, "length", self.system)

    def window(self, y: Span | None = None, x: Span | None = None) -> Window:
        """The part between two positions along each axis, by default all of it."""
        return window(self.grid, y, x, self.told)

    def pressed(self, body: str = "lower") -> PressedSolid:
        """A body under its contact pressure.

        Raises
        ------
        ValueError
            If the result is no contact, does not describe its solid, or has no such body.
        """
        if not self.layers or "pressure" not in self.fields:
            raise ValueError("contact: the result of a contact, with its pressure and its solid, is needed")
        if not isinstance(body, str) or body not in self.layers:
            raise ValueError(f"body = {shown(body)}: {' or '.join(self.layers)} is needed")
        pressure = self.fields["pressure"].astype(float)
        return PressedSolid(pressure, self.grid, self.layers[body], self.boundary)

    def sliding_of(
        self, body: str = "lower", friction: float | None = None, direction: str | float | None = None
    ) -> dict[str, Any]:
        """Friction and direction of the traction on a body, as arguments of `asperity.stress_planes`.

        Parameters
        ----------
        body : "lower" | "upper"
        friction, direction : float, str or float, optional
            Coefficient, and direction in which the upper body moves over the lower one; by default those of
            the result.
        """
        direction = self.sliding.sliding_direction if direction is None else direction
        return {
            "friction": self.sliding.friction if friction is None else friction,
            "sliding_direction": traction_direction(direction, body),
        }


def sources(results: Any, unit_system: str | None = None) -> list[Source]:
    """Sources of one result, of a sequence of results, or of a mapping from titles to results.

    Parameters
    ----------
    results : dataset, object with ``grid``, sequence or mapping
        Datasets of stage surface or contact, or objects such as `Contact`.
    unit_system : str, optional
        Of results that do not say theirs.

    Raises
    ------
    TypeError
        If a result is of another kind.
    ValueError
        If there is none, or some are dimensionless and others are not.
    """
    if isinstance(results, Mapping) and not isinstance(results, xr.Dataset):
        found = [_source(result, unit_system, str(title)) for title, result in results.items()]
    elif isinstance(results, Sequence) and not isinstance(results, str):
        found = [_source(result, unit_system) for result in results]
    else:
        found = [_source(results, unit_system)]
    if not found:
        raise ValueError("result: at least one result is needed")
    same_system([source.system for source in found])
    return found


def same_system(systems: Sequence[str | None]) -> str | None:
    """The one unit system of several results.

    Raises
    ------
    ValueError
        If they have several.
    """
    if len(set(systems)) > 1:
        raise ValueError("result: results in one unit system are needed, not SI beside dimensionless ones")
    return systems[0]


def system_of(data: xr.Dataset) -> str:
    """Unit system of a dataset; without the attribute it is that of the study."""
    return str(data.attrs.get("unit_system", STUDY))


def title_of(data: xr.Dataset) -> str:
    """Label of the surface of a dataset, or its name; empty if it has neither."""
    if "settings" not in data.attrs:
        return ""
    try:
        return label(data)
    except (KeyError, TypeError):
        return str(settings_of(data).get("name", ""))


def _source(result: Any, unit_system: str | None, title: str | None = None) -> Source:
    if isinstance(result, xr.Dataset):
        return _source_of_dataset(result, title)
    grid = getattr(result, "grid", None)
    fields = {name: getattr(result, name) for name in FIELDS if hasattr(result, name)}
    if not isinstance(grid, Grid) or not fields:
        raise TypeError(
            f"result = {shown(result)}: a result of stage surface or contact, or an object with grid and "
            "height or pressure, such as a Contact, is needed"
        )
    solid = getattr(result, "solid", None)
    if isinstance(solid, TwoBodies):
        layers = {"lower": solid.lower, "upper": solid.upper}
    else:
        layer = getattr(result, "layer", None)
        layers = {"lower": layer} if isinstance(layer, Layer) else {}
    system = getattr(result, "unit_system", unit_system)
    boundary = getattr(result, "boundary", "periodic")
    return Source(title or "", grid, system, fields, layers, boundary)


def _source_of_dataset(data: xr.Dataset, title: str | None) -> Source:
    if not {"y", "x"} <= set(data.sizes):
        raise TypeError("result: a dataset of stage surface or contact, with fields over y and x, is needed")
    fields = {name: data[name].values for name in FIELDS if name in data}
    if {"gap", "displacement", "approach"} <= set(data.variables):
        height = data["gap"] - data["displacement"] + data["approach"]
        fields.setdefault("height", (height - height.mean()).values)
    title = title_of(data) if title is None else title
    layers = _layers_of(data) if "pressure" in data and "solid" in data.attrs else {}
    boundary = str(data.attrs.get("boundary", "periodic"))
    settings = settings_of(data) if "settings" in data.attrs else {}
    sliding = Sliding(settings.get("friction", 0.0), settings.get("sliding_direction", "x"))
    return Source(title, grid_of(data), system_of(data), fields, layers, boundary, sliding)


def _layers_of(contact: xr.Dataset) -> dict[str, Layer]:
    """The elastic bodies of a contact; the stress in each depends on the pressure and not on its modulus."""
    lower, upper = layer_of(contact), settings_of(contact).get("upper")
    if upper is None:
        return {"lower": lower}
    return {
        "lower": lower,
        "upper": Layer(*(upper[name] for name in ("young", "poisson", "height", "bottom"))),
    }
