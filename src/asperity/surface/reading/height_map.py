"""Height maps as measured: heights, edges, unit, and which way is up; and the options of a map.

This module uses two conventions. A **map** of an instrument shows its peaks upward. The height that
`asperity.contact.solve` takes is the **lower face** of an indenter, measured upward: its lowest points touch
first. One is minus the other, so every `HeightMap` states which one it holds; x and y are the same in both.
The files of instruments are maps; results of asperity hold lower faces and say so; a bare array of numbers
(NPY, MATLAB, HDF5, text without a header) can be either, and the user has to state which.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from asperity.core.arguments import choice, finite_array, real_array
from asperity.core.errors import InputError, shown
from asperity.core.markup import picture, table
from asperity.core.types import Array
from asperity.core.units import shown_si, to_si
from asperity.fourier.grid import Grid
from asperity.settings.map import Map, MapOptions

PEAKS_UP, LOWER_FACE = "peaks up", "lower face"
ORIENTATIONS = (PEAKS_UP, LOWER_FACE)
"""Meaning of the heights of a map: peaks upward as measured, or the lower face of an indenter."""

ORIENTATION_NEEDED = (
    f"orientation: the file does not state which way is up; set it to {PEAKS_UP!r} (a map of an instrument) "
    f"or {LOWER_FACE!r} (the height of an indenter as solve takes it)"
)

UNIT_NEEDED = "unit: the file does not say the unit of its heights; set it, for example to um"


class MapError(InputError):
    """Raised for a height map that cannot be read or used as asked; each problem has a line in the message.

    Attributes
    ----------
    problems : tuple of str
        Everything that is wrong or missing, each with the argument or option that it needs.

    Examples
    --------
    >>> flat = asp.HeightMap(np.zeros((8, 8)), length=(1e-3, 1e-3), name="flat")
    >>> try:
    ...     asp.prepare_map(flat)
    ... except asp.MapError as error:
    ...     print(error)
    flat: periodic: the file does not say that the map is one period; set it to declared,
    mirrored or windowed, or press it with a free boundary
    """

    def __init__(self, source: str, problems: Iterable[str | tuple[str, str]]) -> None:
        name = re.compile(rf"(?:({'|'.join(Map.model_fields)})(?=: | = ))?(.*)", re.DOTALL)
        named = (each if isinstance(each, tuple) else name.findall(each)[0] for each in problems)
        super().__init__(source, named)


def is_period(options: MapOptions, surface: HeightMap) -> bool:
    """True if a map is taken as one period: as declared, or as its file states if nothing is given."""
    return options.periodic == "declared" or (options.periodic is None and surface.periodic)


@dataclass(frozen=True, repr=False)
class HeightMap:
    """A rectangular height map as measured.

    Parameters
    ----------
    height : (ny, nx) array
        Heights; NaN, or a mask, where there are no data.
    length : float or (length_y, length_x)
        Edges of the map, in the unit of the heights.
    periodic : bool
        True if the file states that the map is one period.
    orientation : "peaks up", "lower face" or None
        Meaning of the heights; None if it is not known.
    unit : str, optional
        Unit of lengths in the file. If it is named, `height` and `length` are in metres, to which the reader
        has converted them; if it is None, they are in one unit that is not known.
    name : str
        Name of the file.
    channel : str
        Name of the channel in the file.
    notes : tuple of str
        Properties of the file that options replaced.

    Raises
    ------
    MapError
        If the heights are no array of numbers [y, x], or an edge, the orientation or the unit is wrong.

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
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        try:
            measured = self.height
            if np.ma.is_masked(measured) and np.ma.getdata(measured).dtype.kind in "iuf":
                measured = np.ma.filled(np.ma.asarray(measured, dtype=float), np.nan)
            values = real_array("height", measured)
            if values.ndim != 2 or min(values.shape) < 2:
                raise ValueError(f"height has the shape {values.shape}: at least 2 x 2 points are needed")
            finite_array("height", values[np.isfinite(values)])
            object.__setattr__(self, "length", Grid(values.shape, self.length).length)
            if self.orientation is not None:
                choice("orientation", self.orientation, ORIENTATIONS)
            if self.unit is not None and not isinstance(self.unit, str):
                raise TypeError(f"unit = {shown(self.unit)}: the name of a unit of length or None is needed")
        except (TypeError, ValueError) as error:
            raise MapError(self.name, [str(error)]) from error
        object.__setattr__(self, "height", values)

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

    @property
    def missing(self) -> int:
        """Number of non-measured points."""
        return int(self.height.size - np.count_nonzero(np.isfinite(self.height)))

    @property
    def spacing(self) -> tuple[float, float]:
        """Edges (y, x) of a pixel."""
        return self.length[0] / self.height.shape[0], self.length[1] / self.height.shape[1]

    def cropped(
        self,
        edges: float | str | tuple[float | str, float | str],
        middle: tuple[float | str, float | str] | None = None,
    ) -> HeightMap:
        """The part of one edge, or of edges (y, x), around a place, by default the middle.

        An edge that is longer than the map is cut to it.

        Raises
        ------
        MapError
            If the part has fewer than 2 x 2 points, or none at this place.
        """
        y, x = edges if isinstance(edges, tuple) else (edges, edges)
        wanted = self.in_map_unit("crop", y), self.in_map_unit("crop", x)
        parts, shown_place = [], []
        for axis, (points, step) in enumerate(zip(self.height.shape, self.spacing, strict=True)):
            count = points if wanted[axis] >= self.length[axis] else round(wanted[axis] / step)
            place = self.length[axis] / 2 if middle is None else self.in_map_unit("crop_at", middle[axis])
            start = round(place / step - count / 2)
            if not (count >= 2 and start >= 0 and start + count <= points):
                size, whole = self.shown_length(*wanted), self.shown_length(*self.length)
                text = f"crop = {size}: a part of at least 2 x 2 points inside the map, {whole}, is needed"
                raise MapError(self.name, [text])
            parts.append(slice(start, start + count))
            shown_place.append((start + count / 2) * step)
        height = self.height[tuple(parts)]
        length = height.shape[0] * self.spacing[0], height.shape[1] * self.spacing[1]
        note = (
            f"cropped to {self.shown_length(*length)} (y, x) around {self.shown_length(*shown_place)}, of"
            f" {self.shown_length(*self.length)}"
        )
        return replace(self, height=height, length=length, periodic=False, notes=(*self.notes, note))

    def as_indenter(self) -> Array:
        """Heights of the indenter's lower face, as `asperity.contact.solve` takes them.

        Raises
        ------
        MapError
            If the orientation is not known.
        """
        if self.orientation is None:
            raise MapError(self.name, [ORIENTATION_NEEDED])
        return self.height if self.orientation == LOWER_FACE else -self.height

    def shown_length(self, *values: float, digits: int = 3) -> str:
        """One or two lengths in the unit of the map as text."""
        return " x ".join(
            shown_si(value, "m", digits) if self.unit else f"{value:.{digits}g}" for value in values
        )

    def shown_share(self, count: int) -> str:
        """A number of points and their fraction of the map as text."""
        return f"{count} point{'s' * (count != 1)} ({100 * count / self.height.size:.2g} %)"

    def in_map_unit(self, name: str, value: float | str) -> float:
        """An option that is a length, in the unit of the map.

        Raises
        ------
        MapError
            If it has a unit, and the map none.
        """
        if not isinstance(value, str):
            return value
        if self.unit is None:
            raise MapError(self.name, [UNIT_NEEDED])
        return to_si(value, "length", name)
