"""A solid under a contact pressure: all that the stress inside it depends on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.types import Array


class ContactLike(Protocol):
    """What the stress in a solid needs from a contact: a `Contact` and a `PressedSolid` have it."""

    @property
    def pressure(self) -> Array:
        """Contact pressure [y, x], compression positive, in the unit of Young's modulus."""

    @property
    def grid(self) -> Grid:
        """Grid of the pressure."""

    @property
    def layer(self) -> Layer:
        """The solid."""


@dataclass(frozen=True, eq=False)
class PressedSolid:
    """A solid under any given pressure, for which no contact has to be solved.

    Parameters
    ----------
    pressure : (ny, nx) array
        Compression positive, in the unit of Young's modulus.
    grid : Grid
    layer : Layer
    boundary : "periodic" | "free"
        The cell repeats sideways, or lies alone on a half-space, with a uniform pressure on every pixel.

    Examples
    --------
    Hertz's pressure on a circle of radius 0.3, for which the largest von Mises stress is 0.620 of the largest
    pressure, 0.48 radii deep:

    >>> grid = asp.Grid((64, 64))
    >>> y, x = grid.coordinates()
    >>> pressure = np.sqrt(np.maximum(1 - ((x - 0.5) ** 2 + (y[:, None] - 0.5) ** 2) / 0.3**2, 0))
    >>> pressed = asp.PressedSolid(pressure, grid, asp.Layer(young=1.0, poisson=0.3), boundary="free")
    >>> (plane,) = asp.stress_planes(pressed, [0.48 * 0.3])
    >>> round(float(plane.fields["von_mises"].max()), 2)
    0.62
    """

    pressure: Array
    grid: Grid
    layer: Layer
    boundary: str = "periodic"


@dataclass(frozen=True)
class Sliding:
    """Full sliding of a body: friction, and the direction of the traction on it; see `stress_planes`."""

    friction: float = 0.0
    sliding_direction: str | float = "x"


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
    return {"x": 0.0, "y": 90.0}.get(sliding_direction, sliding_direction) + 180.0  # type: ignore
