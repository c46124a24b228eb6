"""Height maps as measured: heights, edges, unit, and which way is up.

Two conventions meet here. A **map** of an instrument shows its peaks upward. The height that
`asperity.contact.solve` takes is the **lower face** of an indenter, measured upward: its lowest points touch
first. One is minus the other, so every `HeightMap` says which of the two it holds, and x and y stay as they
are. The files of instruments are maps; results of asperity hold lower faces and say so; a bare array of
numbers (NPY, MATLAB, HDF5, text without a header) can be either, and its reader has to be told.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import finite_array, magnitude, real_array
from asperity.errors import InputError, shown
from asperity.notebook import picture, table
from asperity.types import Array
from asperity.units import to_si

PEAKS_UP, LOWER_FACE = "peaks up", "lower face"
ORIENTATIONS = (PEAKS_UP, LOWER_FACE)
"""What the heights of a map are: those of a map with its peaks upward, or of an indenter's lower face."""

OptionName = Callable[[str], str]
"""Function from the name of an argument to its name in the user's interface, for messages."""

# Names of length units in files that pint reads as something else, or not at all.
_UNIT_NAMES = {"A": "angstrom", "Å": "angstrom", "\u212b": "angstrom", "~m": "um"}


class MapError(InputError):
    """Raised for a height map that cannot be read or used as asked; the message has a line a problem.

    Attributes
    ----------
    problems : tuple of str
        Everything that is wrong or missing, each with the argument or option that it needs.

    Examples
    --------
    >>> flat = asp.HeightMap(np.zeros((8, 8)), length=(1e-3, 1e-3), name="flat")
    >>> try:
    ...     asp.treat_map(flat)
    ... except asp.MapError as error:
    ...     print(error)
    flat: periodic: the file does not say that the map is one period; set periodic to declared,
    mirrored, windowed or none (for a free boundary)
    """


@dataclass(frozen=True, repr=False)
class HeightMap:
    """A rectangular height map as measured.

    Parameters
    ----------
    height : (ny, nx) array
        Heights; NaN where there are no data.
    length : (length_y, length_x)
        Edges of the map, in the unit of the heights.
    periodic : bool
        True if the file states that the map is one period.
    orientation : "peaks up", "lower face" or None
        Meaning of the heights; None if it is not known.
    unit : str, optional
        Unit of lengths in the file. If it is given, heights and edges are converted to metres; if it is
        None, they are in one unit that is not known.
    name : str
        Name of the file.
    channel : str
        Name of the channel in the file.

    Examples
    --------
    >>> heights = np.array([[0.0, 1.0, 0.5], [0.2, np.nan, 0.1]]) * 1e-6
    >>> surface = asp.HeightMap(heights, length=(2e-6, 3e-6))
    >>> surface.missing, [f"{step:.1e}" for step in surface.spacing]
    (1, ['1.0e-06', '1.0e-06'])
    >>> float(np.nanmin(surface.as_indenter()))  # turned upside down: the highest peak touches first
    -1e-06
    """

    height: Array
    length: tuple[float, float]
    periodic: bool = False
    orientation: str | None = PEAKS_UP
    unit: str | None = None
    name: str = ""
    channel: str = ""

    def __repr__(self) -> str:
        ny, nx = self.height.shape
        edges = f"{self.length[0]:.4g} × {self.length[1]:.4g}{' m' if self.unit else ''}"
        name = self.name or "without a name"
        periodic = ", periodic" if self.periodic else ""
        return f"<HeightMap {name}: {ny} × {nx} points, {edges}, {self.orientation}{periodic}>"

    def _repr_html_(self) -> str:
        ny, nx = self.height.shape
        unit = " m" if self.unit else ""
        rows = [
            ("points", f"{ny} × {nx}, {self.missing} missing"),
            ("edges", f"{self.length[0]:.4g} × {self.length[1]:.4g}{unit}"),
            ("heights", f"{np.nanmin(self.height):.4g} to {np.nanmax(self.height):.4g}{unit}"),
            ("which way is up", self.orientation or "not known"),
            ("periodic", "yes" if self.periodic else "not said"),
        ]
        return table(f"HeightMap {self.name}", rows, picture(self.height, "heights"))

    def check(self) -> None:
        """Raise `MapError` if the heights are no array of numbers [y, x], or an edge or a name is wrong."""
        try:
            values = real_array("height", self.height)
            if values.ndim != 2 or min(values.shape) < 2:
                raise ValueError(f"height has the shape {values.shape}: at least 2 x 2 points are needed")
            finite_array("height", values[np.isfinite(values)])
            if not isinstance(self.length, (tuple, list)) or len(self.length) != 2:
                raise ValueError(f"length = {shown(self.length)}: a pair (length_y, length_x) is needed")
            for edge in self.length:
                magnitude("length", edge)
            if self.orientation not in (None, *ORIENTATIONS):
                accepted = f"{PEAKS_UP!r} or {LOWER_FACE!r}"
                raise ValueError(f"orientation = {shown(self.orientation)}: {accepted} is needed")
            if self.unit is not None and not isinstance(self.unit, str):
                raise TypeError(f"unit = {shown(self.unit)}: the name of a unit of length or None is needed")
        except (TypeError, ValueError) as error:
            raise MapError(self.name, [str(error)]) from error

    @property
    def missing(self) -> int:
        """Number of points without data."""
        return int(self.height.size - np.count_nonzero(np.isfinite(self.height)))

    @property
    def spacing(self) -> tuple[float, float]:
        """Edges (y, x) of a pixel."""
        return self.length[0] / self.height.shape[0], self.length[1] / self.height.shape[1]

    def as_indenter(self) -> Array:
        """Heights of the indenter's lower face, as `asperity.contact.solve` takes them.

        Raises
        ------
        MapError
            If the orientation is not known.
        """
        if self.orientation is None:
            raise MapError(self.name, [orientation_needed("orientation")])
        return self.height if self.orientation == LOWER_FACE else -self.height

    def scaled(self, factor: float) -> HeightMap:
        """The map with all lengths multiplied by a factor; their unit is not known afterwards."""
        length = self.length[0] * factor, self.length[1] * factor
        return replace(self, height=self.height * factor, length=length, unit=None)


def orientation_needed(option: str) -> str:
    """Message that asks which way is up."""
    return (
        f"{option}: the file does not say which way is up; set it to {PEAKS_UP!r} (a map of an instrument) "
        f"or {LOWER_FACE!r} (the height of an indenter as solve takes it)"
    )


def metres(unit: str, option: str = "unit") -> float:
    """Size of a length unit in metres.

    Raises
    ------
    ValueError
        If it is not a unit of length.
    """
    unit = unit.strip() if isinstance(unit, str) else unit
    try:
        return to_si(f"1 {_UNIT_NAMES.get(unit, unit)}", "length")
    except (ValueError, TypeError) as error:
        raise ValueError(f"{option} = {unit!r}: a unit of length is needed (nm, um, mm, m)") from error
