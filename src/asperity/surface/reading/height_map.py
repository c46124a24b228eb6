"""Height maps as measured: heights, edges, unit, and which way is up; and the options of a map.

This module uses two conventions. A **map** of an instrument shows its peaks upward. The height that
`asperity.contact.solve` takes is the **lower face** of an indenter, measured upward: its lowest points touch
first. One is minus the other, so every `HeightMap` states which of the two it holds; x and y are the same
in both. The files of instruments are maps; results of asperity hold lower faces and say so; a bare array of
numbers (NPY, MATLAB, HDF5, text without a header) can be either, and the user has to state which.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import numpy as np

from asperity.core.arguments import choice, finite_array, magnitude, number, pair, real_array, whole_number
from asperity.core.errors import InputError, shown
from asperity.core.markup import picture, table
from asperity.core.types import Array
from asperity.core.units import shown_si, to_si
from asperity.fourier.grid import Grid
from asperity.surface.form import AXES

PEAKS_UP, LOWER_FACE = "peaks up", "lower face"
ORIENTATIONS = (PEAKS_UP, LOWER_FACE)
"""Meaning of the heights of a map: peaks upward as measured, or the lower face of an indenter."""

DETRENDS = ("none", "tilt", "curvature")
"""Trends that can be removed, of the degrees 0, 1 and 2."""

PERIODICITIES = ("declared", "mirrored", "windowed", "none")
"""Ways in which a map is made periodic; with ``none`` it is not, for a contact with a free boundary."""

LINES = ("median", "matched")
"""Ways in which scan lines are levelled."""

FORMS = ("sphere", "cylinder")
"""Forms that can be added to the roughness."""

MOST_POINTS = 2**16
"""Most nodes on the longer edge of a map that is resampled: 34 GB."""

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
    ...     asp.treat_map(flat)
    ... except asp.MapError as error:
    ...     print(error)
    flat: periodic: the file does not say that the map is one period; set it to declared,
    mirrored or windowed, or press it with a free boundary
    """

    def renamed(self, name_of: Callable[[str], str]) -> MapError:
        """The error with the names that the fields of `MapOptions` have in another interface."""
        options = "|".join(field.name for field in fields(MapOptions))
        name = re.compile(rf"^({options})(?=: | = )")
        return MapError(self.source, [name.sub(lambda found: name_of(found[0]), p) for p in self.problems])


@dataclass(frozen=True)
class MapOptions:
    """Properties of a height map that its file does not state, and options of its treatment.

    A property that is given replaces that of the file, and the map notes it; for several maps that share
    options the file takes precedence.

    Lengths are numbers in the unit of the map, which is metres if a unit is known, or texts with a unit such
    as ``"8 um"``.

    Parameters
    ----------
    physical_size : (length_y, length_x), optional
        Edges of the map; numbers are in the unit of the heights in the file.
    height_factor : float, optional
        Factor from the numbers in the file to heights.
    unit : str, optional
        Unit of the heights, and of edges given as numbers; or that of x and y and that of z, such as
        ``"mm um"``, for a list of points that states neither.
    channel : str or int, optional
        Name or number of the channel; by default the one whose name says that it holds heights.
    missing : float, optional
        Number in the file, or height in its unit, that marks points without data.
    orientation : "peaks up" or "lower face", optional
        Meaning of the heights, for files that do not say it.
    format : str, optional
        Format as ``docs/formats.md`` names it. Needed for formats without a signature (``hgt``), as which
        any file could be read, and for a line scan (``profile``); other formats are recognised.
    max_memory : float
        Largest size of the unpacked file in GiB.
    detrend : "none", "tilt" or "curvature", optional
        Trend that is removed by least squares of the points that have data: the mean, the mean plane, or a
        polynomial of degree two. By default the mean plane, and the mean of a map that is taken as one
        period: a period has no tilt, and subtracting one makes a step at its edges. It is refused for a map
        that its file states to be periodic.
    periodic : "declared", "mirrored", "windowed" or "none", optional
        Declared: the map is taken as one period. Mirrored: the map and its mirror images at two edges form a
        cell of twice the edges. Windowed: the map is multiplied with a Tukey window (F. J. Harris, Proc. IEEE
        66 (1978) 51, doi 10.1109/PROC.1978.10837), which falls to zero over a tenth at each end of an edge.
        None: the map is not made periodic, for ``boundary="free"``. By default only a map that its file
        states to be periodic is accepted; `asperity.engineering.run` mirrors others.
    undefined : "harmonic", optional
        Points without data are filled by a harmonic function. By default a map with such points is refused;
        `asperity.engineering.run` fills them.
    scan_lines : "median" or "matched", optional
        Offsets between scan lines along x are removed, by the median of each line or of its differences from
        the line before; see `asperity.surface.treatment.levelling.level_lines`.
    s_filter, l_filter : float or str, optional
        Nesting indices of areal Gaussian filters (ISO 16610-61): shorter waves are attenuated by the
        S-filter, longer ones by the L-filter, which is the longer of the two.
    despike : float, optional
        Spikes beyond this number of robust standard deviations from the local median, at least 3, are
        replaced by a harmonic function; see `asperity.surface.treatment.levelling.find_spikes`. By default
        no point is replaced.
    wavelength_short : float or str, optional
        Waves shorter than this are removed, from two nodes to the longer edge.
    points : int, optional
        Number of nodes on the longer edge of the map, at least 2, or of the cell if it is mirrored, then an
        even number. By default that of the map.
    radius : float or str, optional
        Radius of a sphere or cylinder whose form is added to the roughness, its lowest point or line in the
        middle of the map.
    form : "sphere" or "cylinder"
        Form to which the radius belongs.
    cylinder_axis : "y" or "x"
        Direction of the axis of a cylinder.

    Examples
    --------
    For an array of numpy, which contains neither size nor unit nor orientation:

    >>> asp.MapOptions(physical_size=("80 um", "80 um"), unit="nm", orientation="peaks up").unit
    'nm'
    >>> asp.MapOptions(periodic="mirrored", despike=8, wavelength_short="16 um").wavelength_short
    '16 um'
    """

    physical_size: tuple[float | str, float | str] | None = None
    height_factor: float | None = None
    unit: str | None = None
    channel: str | int | None = None
    missing: float | None = None
    orientation: str | None = None
    format: str | None = None
    max_memory: float = 2.0
    detrend: str | None = None
    periodic: str | None = None
    undefined: str | None = None
    scan_lines: str | None = None
    s_filter: float | str | None = None
    l_filter: float | str | None = None
    despike: float | None = None
    wavelength_short: float | str | None = None
    points: int | None = None
    radius: float | str | None = None
    form: str = "sphere"
    cylinder_axis: str = "y"

    def __post_init__(self) -> None:
        words = {
            "orientation": ORIENTATIONS,
            "detrend": DETRENDS,
            "periodic": PERIODICITIES,
            "undefined": ("harmonic",),
            "form": FORMS,
            "scan_lines": LINES,
            "cylinder_axis": AXES,
        }
        checks: dict[str, Callable[[str, Any], Any]] = {
            **{name: partial(choice, known=known) for name, known in words.items()},
            **dict.fromkeys(("wavelength_short", "radius", "s_filter", "l_filter"), _length),
            "physical_size": _edges,
            **dict.fromkeys(("height_factor", "max_memory"), magnitude),
            "despike": partial(number, accepted="a number ≥ 3", accepts=lambda n: n >= 3),
            "missing": partial(number, accepted="a finite number", accepts=lambda _: True),
            "points": partial(
                whole_number,
                accepted=f"a whole number from 2 to {MOST_POINTS}",
                accepts=lambda n: 2 <= n <= MOST_POINTS,
            ),
        }
        problems, optional = [], {entry.name for entry in fields(self) if entry.default is None}
        for name, check in checks.items():
            if (value := getattr(self, name)) is not None or name not in optional:
                try:
                    check(name, value)
                except (TypeError, ValueError) as error:
                    problems.append(str(error))
        if problems:
            raise MapError("", problems)

    def is_period(self, surface: HeightMap) -> bool:
        """True if a map is taken as one period: as declared, or as its file states if nothing is given."""
        return self.periodic == "declared" or (self.periodic is None and surface.periodic)


def _length(name: str, value: Any) -> None:
    magnitude(name, to_si(value, "length", name) if isinstance(value, str) else value)


def _edges(name: str, value: Any) -> None:
    for edge in pair(name, value, "a pair of lengths > 0 (y, x)"):
        _length(name, edge)


@dataclass(frozen=True, repr=False)
class HeightMap:
    """A rectangular height map as measured.

    Parameters
    ----------
    height : (ny, nx) array
        Heights; NaN where there are no data.
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
        Properties that options gave in place of those of the file.

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
            values = real_array("height", self.height)
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
            raise MapError(self.name, [ORIENTATION_NEEDED])
        return self.height if self.orientation == LOWER_FACE else -self.height

    def shown_length(self, *values: float, digits: int = 3) -> str:
        """One or two lengths in the unit of the map as text."""
        return " x ".join(
            shown_si(value, "m", digits) if self.unit else f"{value:.{digits}g}" for value in values
        )

    def shown_share(self, count: int) -> str:
        """A number of points and their share of the map as text."""
        return f"{count} points ({100 * count / self.height.size:.2g} %)"

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
