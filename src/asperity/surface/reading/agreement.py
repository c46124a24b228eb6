"""One map in metres from the contents of a file and the options of the caller.

The options must not contradict the file. Everything that is wrong or missing is reported at once.
"""

import math
from typing import NamedTuple

import numpy as np

from asperity.core.errors import shown
from asperity.core.types import Array
from asperity.core.units import to_si
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
"""A height marks missing data if more than this share of the points has it, and if this many times as many
points have it as have any of the neighbouring heights. It is sought in a sample of so many points; heights
closer than this fraction of the interquartile range are equal. Neighbouring steps of a coarse quantisation
have about as many points as each other; a plateau of one exact height is reported too."""

AGREEMENT = 1e-3
"""Relative difference up to which a value of the caller agrees with that of the file: one pixel of 1000."""


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
    """Contents of a file; None for what it does not state.

    Parameters
    ----------
    height : (ny, nx) array
        In `unit`; NaN where there are no data.
    channel : str
        The one that the heights are of.
    channels : tuple of Channel
        All of them, if there are others.
    undecided : str
        Why it is doubtful that this channel holds the heights; empty if it is sure.
    length : (length_y, length_x), optional
        Edges in `length_unit`.
    length_unit : str, optional
        Unit of the edges, if it is not `unit`.
    unit : str, optional
        Unit of length.
    factor : float, optional
        Factor from the numbers in the file to `height`.
    periodic : bool
    orientation : "peaks up", "lower face" or None
    is_grey : bool
        True if the numbers are grey levels and not heights.
    """

    height: Array
    channel: str = UNNAMED
    channels: tuple[Channel, ...] = ()
    undecided: str = ""
    length: tuple[float, float] | None = None
    length_unit: str | None = None
    unit: str | None = None
    factor: float | None = None
    periodic: bool = False
    orientation: str | None = PEAKS_UP
    is_grey: bool = False


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
        What is missing or contradicts the file; empty if the map can be used.
    options : MapOptions
        The options given; for a file with several channels, with the one that was chosen.
    edges_known, unit_stated : bool
        True if the edges are known, and if the file states its unit.
    """

    def __init__(self, content: FileContent, name: str, options: MapOptions) -> None:
        self.problems = [content.undecided] if content.undecided else []
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
        self.edges_known = length is not None
        self.unit_stated = content.unit is not None
        self.map = HeightMap(height, edges, content.periodic, orientation, unit, name, content.channel)
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
        elif own is None and unit is None:
            return float(given)
        elif not math.isclose(given, own or 1.0, rel_tol=AGREEMENT):
            said = f"heights in {unit}" if own is None else f"{own:g}"
            self.problems.append(f"height_factor = {given:g}: the file says {said}; leave it out")
        return 1.0

    def _unit(self, content: FileContent, options: MapOptions) -> tuple[str | None, float | None]:
        """Unit of the heights and its size in metres, None if neither file nor options state it."""
        known, own, given = {}, content.unit, options.unit
        for name, unit in (("unit of the file", own), ("unit", given)):
            try:
                if unit is not None:
                    known[unit] = metres(unit, name)
            except ValueError as error:
                if unit is given:
                    self.problems.append(str(error))
                elif given is None:
                    self.problems.append(
                        f"unit: the file says {shown(unit)}, which is no unit of length; set it"
                    )
        sizes = list(known.values())
        if len(sizes) == 2 and not math.isclose(*sizes, rel_tol=1e-9):
            self.problems.append(f"unit = {given!r}: the file says {own}; leave it out")
        return next(iter(known.items()), (None, None))

    def _length(
        self, content: FileContent, options: MapOptions, metre: float | None
    ) -> tuple[float, float] | None:
        """Edges in metres, or in the unknown unit of the file; None if neither states them."""
        scale, own, size = metre or 1.0, content.length, options.physical_size
        if own is not None and content.length_unit is not None:
            if metre is None:  # the unit of the heights is asked for
                return None
            lateral = metres(content.length_unit, "unit of the file")
            own = own[0] * lateral, own[1] * lateral
        elif own is not None:
            own = own[0] * scale, own[1] * scale
        if size is None:
            if own is None:
                self.problems.append(
                    "physical_size: the file does not say the edges (y, x) of the map; set it"
                )
            return own
        if metre is None and any(isinstance(edge, str) for edge in size):
            self.problems.append(UNIT_NEEDED)
            return own
        y, x = (to_si(edge, "length") if isinstance(edge, str) else edge * scale for edge in size)
        if own is None:
            return y, x
        if not np.allclose((y, x), own, rtol=AGREEMENT, atol=0):
            stated = " x ".join(f"{edge / scale:.6g}" for edge in own)
            stated += f" {next(filter(None, (content.unit, options.unit)), '')}".rstrip()
            self.problems.append(f"physical_size: the file itself says {stated} (y, x); leave it out")
        return own


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


def metres(unit: str, name: str = "unit") -> float:
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
        raise ValueError(f"{name} = {unit!r}: a unit of length is needed (nm, um, mm, m)") from error
