"""A solid under a contact pressure: everything on which the stress inside it depends."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from asperity.core.arguments import number
from asperity.core.errors import shown
from asperity.core.markup import picture, table
from asperity.core.types import Array
from asperity.core.units import to_si
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import Solids, TwoBodies
from asperity.fourier.grid import Grid, boundary_on, grid_of, with_mirror_images

if TYPE_CHECKING:
    import xarray as xr


class ContactLike(Protocol):
    """Pressure, grid and solid, from which the stress is computed: a `Contact` or a `LoadedSolid`."""

    @property
    def pressure(self) -> Array:
        """Contact pressure [y, x], compression positive, in the unit of Young's modulus."""

    @property
    def grid(self) -> Grid:
        """Grid of the pressure."""

    @property
    def layer(self) -> Solid:
        """The solid."""


SMALLEST, LARGEST = 1e-60, 1e60
"""Accepted edges of the cell and maximum pressures: squares of wavenumbers and third powers of stresses stay
within double precision."""

RANGE = f"from {SMALLEST:g} to {LARGEST:g}"


@dataclass(frozen=True, eq=False, repr=False)
class LoadedSolid:
    """A solid under any given pressure, for which no contact has to be solved.

    Parameters
    ----------
    pressure : (ny, nx) array
        Compression positive, in the unit of Young's modulus.
    grid : Grid
    layer : Solid
    boundary : "periodic" | "free" | (str, str)
        The cell, or a mirrored map with its images, repeats sideways, or the cell lies alone on a half-space,
        with a uniform pressure on every pixel. ("periodic", "free"): it repeats along y and ends along x.
    hardness : float
        Hardness in the contact. A pressure that reaches it has plateaus: peaks of the stress are then sought
        at the nodes alone, because quadratics through the nodes overshoot.
    background : callable, optional
        Depth → stress (6,) that is added there, uniform over a plane of a periodic cell, such as the stress
        of a contact far wider than the cell.
    deepest : float
        Depth down to which the background has its maximum stresses; planes reach it by default.
    sticking_pressure : (ny, nx) array, optional
        Part of the pressure that causes no shear traction: the traction is μ times the rest of the pressure.
        `asperity.contact.partial_slip` finds it; by default none, gross sliding.

    Examples
    --------
    Hertz's pressure on a circle of radius 0.3, for which the maximum von Mises stress is 0.620 of the maximum
    pressure, 0.48 radii deep:

    >>> grid = asp.Grid((64, 64))
    >>> y, x = grid.coordinates()
    >>> pressure = np.sqrt(np.maximum(1 - ((x - 0.5) ** 2 + (y[:, None] - 0.5) ** 2) / 0.3**2, 0))
    >>> pressed = asp.LoadedSolid(pressure, grid, asp.Solid(young=1.0, poisson=0.3), boundary="free")
    >>> (plane,) = asp.stress_planes(pressed, [0.48 * 0.3])
    >>> round(float(plane.fields["von_mises"].max()), 2)
    0.62
    """

    pressure: Array
    grid: Grid
    layer: Solid
    boundary: str = "periodic"
    hardness: float = np.inf
    background: Callable[[float], Array] | None = None
    sticking_pressure: Array | None = None
    deepest: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.grid, Grid) or not isinstance(self.layer, Solid):
            raise TypeError(
                f"grid = {shown(self.grid)}, layer = {shown(self.layer)}: a Grid and a Solid are needed"
            )
        boundary, grid = boundary_on(self.boundary, self.grid)
        object.__setattr__(self, "boundary", boundary)
        object.__setattr__(self, "grid", grid)
        if boundary != "periodic" and self.layer.height is not None:
            raise ValueError(f"boundary = {boundary!r}: a half-space is needed, the solid is a layer")
        if self.background is not None and boundary != "periodic":
            raise ValueError(f"background: a periodic boundary is needed, it is {boundary}")
        for edge in self.grid.length:
            number("grid.length", edge, f"an edge {RANGE}", lambda size: SMALLEST <= size <= LARGEST)
        pressure = self.grid.field("pressure", self.pressure)
        highest = float(np.abs(pressure).max())
        if highest and not SMALLEST <= highest <= LARGEST:
            raise ValueError(
                f"pressure: its largest magnitude is {highest:g}; 0 or a value {RANGE} is needed"
            )
        object.__setattr__(self, "pressure", pressure)
        if self.sticking_pressure is not None:
            sticking = self.grid.field("sticking_pressure", self.sticking_pressure)
            object.__setattr__(self, "sticking_pressure", sticking)

    @classmethod
    def of(cls, contact: ContactLike) -> LoadedSolid:
        """The solid of a contact under its pressure.

        Raises
        ------
        TypeError, ValueError
            If it has no pressure, grid or layer, or the stress under the pressure would not be finite.
        """
        if isinstance(contact, cls):
            return contact
        if not all(hasattr(contact, name) for name in ("pressure", "grid", "layer")):
            raise TypeError(
                f"contact = {shown(contact)}: an object with pressure, grid and layer is needed, such as a "
                "Contact or a LoadedSolid"
            )
        boundary, hardness = getattr(contact, "boundary", "periodic"), getattr(contact, "hardness", np.inf)
        sticking = getattr(contact, "sticking_pressure", None)
        return cls(
            *(contact.pressure, contact.grid, contact.layer, boundary, hardness), sticking_pressure=sticking
        )

    @classmethod
    def from_dataset(cls, contact: xr.Dataset) -> LoadedSolid:
        """The solid of a dataset of stage contact, under its pressure.

        Raises
        ------
        ValueError
            If the dataset is no contact, or does not describe its solid.
        """
        if "pressure" not in contact or "solid" not in contact.attrs:
            raise ValueError("contact: the result of a contact, with its pressure and its solid, is needed")
        pressure = contact["pressure"].transpose("y", "x").values.astype(float)
        boundary = str(contact.attrs.get("boundary", "periodic"))
        hardness, sticking = float(contact.get("hardness", np.inf)), None
        if "sticking_pressure" in contact:
            sticking = contact["sticking_pressure"].transpose("y", "x").values.astype(float)
        return cls(
            *(pressure, grid_of(contact), layer_of(contact), boundary, hardness), sticking_pressure=sticking
        )

    def with_mirror_images(self) -> LoadedSolid:
        """The solid under the pressure of a whole period: itself, unless its grid is mirrored."""
        if not self.grid.mirrored:
            return self
        sticking = self.sticking_pressure
        return replace(
            self,
            pressure=with_mirror_images(self.pressure, self.grid),
            sticking_pressure=None if sticking is None else with_mirror_images(sticking, self.grid),
            grid=self.grid.whole_cell,
        )

    @property
    def sliding_pressure(self) -> Array:
        """The shear traction over the friction."""
        return self.pressure if self.sticking_pressure is None else self.pressure - self.sticking_pressure

    @property
    def is_plastic(self) -> bool:
        """True if the pressure reaches the hardness."""
        return bool(self.pressure.max() >= self.hardness)

    def __repr__(self) -> str:
        ny, nx = self.grid.shape
        return (
            f"<LoadedSolid of {ny} × {nx} nodes, {self.boundary}: "
            f"maximum pressure {self.pressure.max():.4g}, {self.layer!r}>"
        )

    def _repr_html_(self) -> str:
        ny, nx = self.grid.shape
        rows = [
            ("nodes", f"{ny} × {nx}, {self.boundary}"),
            ("solid", repr(self.layer)),
            ("mean, maximum pressure", f"{self.pressure.mean():.4g}, {self.pressure.max():.4g}"),
        ]
        return table("LoadedSolid", rows, picture(self.pressure, "pressure"))


def layer_from(settings: Mapping[str, Any]) -> Solid:
    """Make a solid from the constants that the settings of a result hold."""
    known = {item.name: settings[item.name] for item in fields(Solid) if item.name in settings}
    return Solid(**known | {"base": layer_from(base) if (base := settings.get("base")) else None})


def _stiffened(layer: Solid, factor: float) -> Solid:
    """The solid with all moduli multiplied by a factor."""
    base = layer.base and _stiffened(layer.base, factor)
    return replace(layer, young=layer.young * factor, base=base)


def layer_of(contact: xr.Dataset) -> Solid:
    """The solid of a dataset of stage contact, with E* = 1.

    The stress depends on the pressure, and under layers on the ratios of the moduli.
    """
    poisson = float(contact.attrs["poisson_contact"])
    lateral = str(contact.attrs["uniform_mode"]).removeprefix("laterally ")
    young = (1 - poisson) * (1 + poisson)
    solid = str(contact.attrs["solid"])
    if solid == "half-space":
        return Solid(young, poisson, lateral=lateral)
    settings = json.loads(contact.attrs["settings"])["layer"]
    height = settings["height"]
    if isinstance(height, str):
        height = to_si(height, "length", "layer.height")
    if base := settings.get("base"):  # of a study, or of a `Solid`
        if "modulus_ratio" in base:
            below = Solid(young * base["modulus_ratio"], base["poisson"])
        else:
            below = _stiffened(layer_from(base), young / settings["young"])
        return Solid(young, poisson, height, lateral=lateral, base=below)
    bottom = solid.removeprefix("layer, ").removesuffix(" bottom")
    return Solid(young, poisson, height, bottom, lateral)


def solid_of(contact: xr.Dataset) -> Solids:
    """The solid of a dataset of stage contact with its moduli: one body, or two."""
    lower, modulus = layer_of(contact), float(contact.attrs.get("effective_modulus", 1.0))
    upper = json.loads(contact.attrs["settings"]).get("upper")
    if upper:
        modulus = float(contact.attrs["young"]) / lower.young
    lower = _stiffened(lower, modulus)
    return TwoBodies(lower, layer_from(upper)) if upper else lower


@dataclass(frozen=True)
class Sliding:
    """Gross sliding of a body: friction, and the direction of the traction on it; see `stress_planes`."""

    friction: float = 0.0
    sliding_direction: str | float = "x"


def degrees_of(sliding_direction: Any) -> float:
    """Angle in degrees of "x", "y" or a number, which is an angle already."""
    accepted = '"x", "y" or an angle in degrees from x towards y'
    degrees = {"x": 0.0, "y": 90.0}.get(sliding_direction) if isinstance(sliding_direction, str) else None
    if degrees is None:
        degrees = number("sliding_direction", sliding_direction, accepted, lambda angle: True)
    return degrees


def direction_cosines(sliding_direction: Any) -> tuple[float, float]:
    """Unit vector (x, y) of "x", "y" or an angle in degrees; its zeros are exact."""
    degrees = degrees_of(sliding_direction)
    if degrees % 90 == 0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(degrees % 360) // 90]
    return float(np.cos(np.radians(degrees))), float(np.sin(np.radians(degrees)))


def traction_direction(sliding_direction: str | float, body: str = "lower") -> str | float:
    """Direction of the shear traction on a body, as `asperity.stress_planes` takes it.

    Parameters
    ----------
    sliding_direction : "x", "y" or float
        Direction in which the upper body moves over the lower one; a number is an angle in degrees.
    body : "lower" | "upper"
        The traction on the upper body has the opposite direction.
    """
    if body == "lower":
        return sliding_direction
    return degrees_of(sliding_direction) + 180.0
