"""One map in metres from the contents of a file and the options of the caller.

An option overrides what the file or its heading states, and the map notes it; only the orientation of a
result of asperity cannot be overridden. Everything that is wrong or missing is reported at once.
"""

import math
from typing import NamedTuple

import numpy as np

from asperity.core.errors import one_line, shown
from asperity.core.types import Array
from asperity.core.units import shown_si, to_si
from asperity.surface.reading.formats import UNNAMED, Channel
from asperity.surface.reading.height_map import (
    LOWER_FACE,
    ORIENTATION_NEEDED,
    PEAKS_UP,
    UNIT_NEEDED,
    HeightMap,
    MapOptions,
)

LARGEST_HEIGHT = 1e6
"""Largest height of a map in units of its longer edge; a larger one is a wrong unit or a damaged file."""

REPEATED_SHARE, REPEATED_RATIO, SAMPLED_POINTS, EQUAL_HEIGHTS = 1e-3, 10, 2**16, 1e-9
"""A height marks missing data if more than this fraction of the points has it, and if this many times as many
points have it as any of the neighbouring heights. It is sought in a sample of so many points; heights closer
than this fraction of the interquartile range are equal. Neighbouring steps of a coarse quantisation have
about as many points as each other; a plateau of one exact height is reported too."""

AGREEMENT = 1e-3
"""Relative difference up to which a value of the caller agrees with the file's: one pixel of 1000."""


SAME = "the unit of the heights"
"""Unit of the edges of a file with one unit for all lengths."""

UNITS = "set it to the units of x and y and of z, for example to 'mm um'"

GIB = 2**30

# Units of files that pint reads as something else, or not at all.
_METRES = {"~m": 1e-6, **dict.fromkeys(("A", "Å", "\u212b"), 1e-10)}


def require_size(size: float, limit: float) -> None:
    """Raise `ValueError` if a file holds more bytes of data than `limit` GiB."""
    if size > limit * GIB:
        raise ValueError(
            f"max_memory = {limit:g} GiB: the file holds {size / GIB:.3g} GiB of data or more when it is "
            "unpacked; set it to more if that is right"
        )


class FileContent(NamedTuple):
    """Contents of a file; None for properties that it does not state.

    Parameters
    ----------
    height : (ny, nx) array
        In `unit`; NaN where there are no data.
    channel : str
        The one that the heights are of.
    channels : tuple of Channel
        All of them, if there are others.
    undecided : str
        Reason to doubt that this channel holds the heights; empty if it is sure.
    length : (length_y, length_x), optional
        Edges in `length_unit`.
    length_unit : str, optional
        Unit of the edges; `SAME` stands for `unit`.
    unit : str, optional
        Unit of length.
    factor : float, optional
        Factor from the numbers in the file to `height`.
    periodic : bool
    orientation : "peaks up", "lower face" or None
    is_grey : bool
        True if the numbers are grey levels and not heights.
    instrument : str
        Name of the instrument; empty if the file does not name it.
    mask : str
        Note on the points that a mask in the file marks; empty without a mask.
    """

    height: Array
    channel: str = UNNAMED
    channels: tuple[Channel, ...] = ()
    undecided: str = ""
    length: tuple[float, float] | None = None
    length_unit: str | None = SAME
    unit: str | None = None
    factor: float | None = None
    periodic: bool = False
    orientation: str | None = PEAKS_UP
    is_grey: bool = False
    mask: str = ""
    instrument: str = ""


class MapFile:
    """A file as far as it can be read: its contents, agreed with the options of the caller.

    Parameters
    ----------
    content : FileContent
    name : str
        Name of the file.
    options : MapOptions

    Attributes
    ----------
    map : HeightMap
        In metres if the unit is known. Its edges are numbers of pixels if they are not known.
    channels : tuple of Channel
    problems : list of str
        Everything that is missing or wrong; empty if the map can be used.
    unit_needed : str
        Problem of a calculation in metres if no unit is known.
    overridden : set of str
        Options that override the file.
    options : MapOptions
        The options given; for a file with several channels, with the one that was chosen.
    edges_known, edges_comparable, unit_stated : bool
        True if the edges are known, if they are in the unit of the heights, and if the file states this.
    """

    def __init__(self, content: FileContent, name: str, options: MapOptions) -> None:
        self.problems = [content.undecided] if content.undecided else []
        self._notes: list[tuple[str, str]] = []
        is_bare = content.length is not None and content.length_unit is None and not options.physical_size
        self.unit_needed = f"unit: the file does not say its units; {UNITS}" if is_bare else UNIT_NEEDED
        factor = self._height_factor(content, options)
        unit, metre = self._unit(content, options)
        length = self._length(content, options, metre)
        orientation = options.orientation or content.orientation
        if orientation is None:
            self.problems.append(ORIENTATION_NEEDED)
        elif content.orientation == LOWER_FACE != orientation:
            self.problems.append(
                f"orientation = {orientation!r}: the file holds the lower face of an indenter; leave it out"
            )
        height, scale = content.height, factor * (metre or 1.0)
        if (missing := options.missing) is not None:
            numbers = [missing, missing * (content.factor or 1.0), missing / (options.height_factor or 1.0)]
            found = np.any([np.isclose(height, number, rtol=1e-6, atol=0) for number in numbers], axis=0)
            if not found.any():
                self.problems.append(f"missing = {missing:g}: no point has this height; leave it out")
            height = np.where(found, np.nan, height)
        height = height if scale == 1 else height * scale
        edges = length or (float(height.shape[0]), float(height.shape[1]))
        finite = np.isfinite(height)
        if not finite.any():
            self.problems.append("no point of the map has data")
        elif length and np.abs(height).max(initial=0.0, where=finite) > LARGEST_HEIGHT * max(edges):
            repeated = repeated_height(content.height)
            self.problems.append(
                f"height_factor: heights up to {LARGEST_HEIGHT:g} times the longer edge are accepted; set it "
                "or correct the file"
                if repeated is None
                else f"missing: {repeated[1]} points have the height {repeated[0]:.9g}; set it to this number"
            )
        notes = [note for _, note in self._notes]
        if content.instrument:
            notes.append(f"instrument: {one_line(content.instrument)}")
        if content.mask:
            notes.append(content.mask)
        elif options.mask:
            self.problems.append(f"mask = {options.mask!r}: the file has no mask; leave it out")
        self.edges_known = length is not None
        self.edges_comparable = self.edges_known and not (is_bare and unit is None)
        self.overridden = {option for option, _ in self._notes}
        self.unit_stated = content.unit is not None and "unit" not in self.overridden
        self.map = HeightMap(
            height, edges, content.periodic, orientation, unit, name, content.channel, tuple(notes)
        )
        self.channels = content.channels or (Channel(content.channel, self.map.height.shape),)
        several = len(self.channels) > 1 and options.channel is None
        self.options = options.replaced(channel=content.channel) if several else options

    def _height_factor(self, content: FileContent, options: MapOptions) -> float:
        """Factor that the caller applies to the heights; the file's own is applied by its reader."""
        given, own, unit = options.height_factor, content.factor, content.unit
        if given is None:
            if content.is_grey:
                self.problems.append(
                    "height_factor: the file holds grey levels; set it to the height of one level"
                )
            return 1.0
        if own is not None or unit is not None:
            if math.isclose(given, own or 1.0, rel_tol=AGREEMENT):
                return 1.0
            self._note("height_factor", f"{given:g}", f"heights in {unit}" if own is None else f"{own:g}")
        return float(given) / (own or 1.0)

    def _note(self, option: str, given: str, stated: str) -> None:
        self._notes.append((option, f"{option}: {given} is given, the file says {stated}"))

    def _given_size(self, unit: str | None) -> float | None:
        """Size of a unit of the options in metres; None without one, and for a wrong one, a problem."""
        try:
            return None if unit is None else metres(unit)
        except ValueError as error:
            self.problems.append(str(error))
            return None

    def _unit(self, content: FileContent, options: MapOptions) -> tuple[str | None, float | None]:
        """Unit of the heights and its size in metres, None if neither options nor file state it."""
        own, (_, given) = content.unit, units_of(options.unit)
        stated, size = _stated_size(own), self._given_size(given)
        if given is None and own is not None and stated is None:
            self.problems.append(f"unit: the file says {shown(own)}, which is no unit of length; set it")
        if size is None:
            return (None, None) if stated is None else (own, stated)
        if stated is not None and not math.isclose(size, stated, rel_tol=1e-9):
            self._note("unit", str(given), str(own))
        return given, size

    def _length(
        self, content: FileContent, options: MapOptions, metre: float | None
    ) -> tuple[float, float] | None:
        """Edges in metres, or in the unknown unit of the file; None if neither states them.

        Edges of which the file states the unit keep it if only the unit of the heights is given.
        """
        own, size, (lateral, _) = content.length, options.physical_size, units_of(options.unit)
        own_unit = content.unit if content.length_unit == SAME else content.length_unit
        given, stated = self._given_size(lateral), _stated_size(own_unit)
        if own_unit is None and content.length_unit == SAME:
            stated = metre
        if own is not None and (factor := given or stated):
            if given and stated and not math.isclose(given, stated, rel_tol=1e-9):
                self._note("unit", f"{lateral} of x and y", str(own_unit))
            own = own[0] * factor, own[1] * factor
            if metre is None and own_unit is not None:  # heights without a unit beside edges in metres
                self.problems.append(UNIT_NEEDED)
                return None
        elif own is not None and metre is not None:
            if size is None:
                edges = " x ".join(f"{edge:.6g}" for edge in own)
                self.problems.append(
                    f"unit: the file does not say the unit of its edges, {edges} (y, x); {UNITS}"
                )
                return None
            own = None
        if size is None:
            if own is None:
                self.problems.append(
                    "physical_size: the file does not say the edges (y, x) of the map; set it"
                )
            return own
        if metre is None and any(isinstance(edge, str) for edge in size):
            self.problems.append(UNIT_NEEDED)
            return own
        y, x = (to_si(edge, "length") if isinstance(edge, str) else edge * (metre or 1.0) for edge in size)
        if own is not None and not np.allclose((y, x), own, rtol=AGREEMENT, atol=0):
            given_edges, stated_edges = (
                " x ".join(shown_si(edge, "m") if metre else f"{edge:.6g}" for edge in edges) + " (y, x)"
                for edges in ((y, x), own)
            )
            self._note("physical_size", given_edges, stated_edges)
        return y, x


def units_of(unit: str | None) -> tuple[str | None, str | None]:
    """Unit of x and y, and of z, in the option `unit`, which may state the second alone."""
    words = unit.split() if isinstance(unit, str) else []
    return (words[0], words[1]) if len(words) == 2 else (None, unit)


def _stated_size(unit: str | None) -> float | None:
    """Size of a unit of a file in metres, None if it states none or one that is not of length."""
    try:
        return None if unit is None else metres(unit)
    except ValueError:
        return None


def edges_in_one_unit(
    length: tuple[float, float], units: tuple[str | None, str | None]
) -> tuple[tuple[float, float], str | None]:
    """Edges (y, x) and their unit; in metres if each has a unit of its own, None if one of them has none."""
    if None in units or units[0] == units[1]:
        return length, units[0] and units[1]
    y, x = (edge * metres(unit) for edge, unit in zip(length, units, strict=True) if unit)
    return (y, x), "m"


def repeated_height(height: Array) -> tuple[float, int] | None:
    """A height that so many points share that it may mark missing data, and their number.

    More than `REPEATED_SHARE` of the points have it, and `REPEATED_RATIO` times as many as have any of the
    next heights. It is looked for in a sample of the points, if they are not mostly equal.
    """
    values = height.ravel()
    step = max(1, values.size // SAMPLED_POINTS)
    while math.gcd(step, height.shape[1]) > 1:
        step += 1
    sample = values[::step][np.isfinite(values[::step])].astype(float)
    low, high = np.percentile(sample, (25, 75)) if sample.size else (0.0, 0.0)
    if low == high:
        return None
    bins, first, counts = np.unique(
        np.rint(sample / (EQUAL_HEIGHTS * (high - low))), return_index=True, return_counts=True
    )
    if bins.size < 2:
        return None
    beside = np.pad(counts, 2)
    nearest = np.max([beside[:-4], beside[1:-3], beside[3:-1], beside[4:]], axis=0)
    most = int(np.argmax(np.where(counts > REPEATED_RATIO * nearest, counts, 0)))
    value, is_repeated = sample[first[most]], counts[most] > REPEATED_RATIO * nearest[most]
    count = int(np.count_nonzero(values == value))
    return (float(value), count) if is_repeated and count > REPEATED_SHARE * values.size else None


def metres(unit: str) -> float:
    """Size of a length unit in metres.

    Raises
    ------
    ValueError
        If it is not a unit of length.
    """
    unit = unit.strip() if isinstance(unit, str) else unit
    try:
        return _METRES.get(unit) or to_si(f"1 {unit}", "length")
    except (ValueError, TypeError) as error:
        raise ValueError(f"unit = {unit!r}: a unit of length is needed (nm, um, mm, m)") from error
