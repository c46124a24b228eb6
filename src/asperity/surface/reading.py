"""Reading of height maps: every file format of the package SurfaceTopography, point lists, and own results.

Lengths are converted to metres if the file or the caller says their unit. What the caller says must not
contradict the file. Everything that is wrong or missing is reported at once, in one line.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace

import numpy as np

from asperity.errors import shown
from asperity.surface.height_map import (
    LOWER_FACE,
    ORIENTATIONS,
    HeightMap,
    MapError,
    OptionName,
    metres,
    orientation_needed,
)
from asperity.surface.map_files import Channel, FileContent, Reading, read_content
from asperity.surface.unpacked_size import DEFAULT_LIMIT
from asperity.units import to_si

LARGEST_HEIGHT = 1e6
"""Largest height of a map in units of its longer edge; a larger one is a wrong unit or a damaged file."""

AGREEMENT = 1e-3
"""Relative difference up to which what the caller says is what the file says: one pixel of a map of 1000."""


@dataclass(frozen=True)
class Inspected:
    """A file as far as it can be read.

    Parameters
    ----------
    map : HeightMap
        Its edges are numbers of pixels if they are not known.
    channels : list of Channel
    problems : list of str
        What is missing or contradicts the file; empty if the map can be used.
    """

    map: HeightMap
    channels: list[Channel]
    problems: list[str]


def read_map(
    path: str | os.PathLike[str],
    physical_size: tuple[float | str, float | str] | None = None,
    height_factor: float | None = None,
    unit: str | None = None,
    channel: str | int | None = None,
    orientation: str | None = None,
    max_memory: float = DEFAULT_LIMIT,
) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : path
        In any format that SurfaceTopography reads, a text of three columns x, y, z on a regular grid, or a
        surface of asperity; also packed by gzip.
    physical_size, height_factor, unit, channel, orientation, max_memory
        As in `Reading`.

    Returns
    -------
    HeightMap
        In metres if the unit is known.

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed.
    MapError
        If the file is not a rectangular height map, if it does not contain what is needed and no argument
        gives it, if an argument contradicts it, or if it unpacks to more than `max_memory`. The message names
        all of this at once.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.npy"
    ...     np.save(path, np.random.default_rng(1).normal(size=(40, 60)))
    ...     surface = asp.read_map(path, ("80 um", "120 um"), unit="nm", orientation="peaks up")
    >>> surface.height.shape, [round(edge, 9) for edge in surface.length], surface.periodic
    ((40, 60), [8e-05, 0.00012], False)
    """
    given = Reading(physical_size, height_factor, unit, channel, orientation, max_memory)
    found = inspect_map(path, given)
    if found.problems:
        raise MapError(os.fspath(path), found.problems)
    return found.map


def inspect_map(
    path: str | os.PathLike[str], given: Reading | None = None, option: OptionName = str
) -> Inspected:
    """Read a height map as far as possible, and list what is missing.

    Parameters
    ----------
    path : path
    given : Reading, optional
    option : callable
        Gives the name of an argument in the interface of the user, for messages.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    given = given or Reading()
    content, channels = read_content(path, given, option)
    problems: list[str] = []
    found = _combined(content, given, option, problems)
    return Inspected(replace(found, name=os.fspath(path)), channels, problems)


def _combined(content: FileContent, given: Reading, option: OptionName, problems: list[str]) -> HeightMap:
    """The map in metres, from what the file and the caller say; contradictions are added to `problems`."""
    factor = _height_factor(content, given, option("height_factor"), problems)
    unit, size_of_unit = _unit(content, given, option, problems)
    length = _length(content, given, size_of_unit, option, problems)
    if given.orientation is not None and given.orientation not in ORIENTATIONS:
        accepted = " or ".join(map(repr, ORIENTATIONS))
        problems.append(f"{option('orientation')} = {shown(given.orientation)}: {accepted} is needed")
    elif given.orientation is not None and content.orientation not in (None, given.orientation):
        if content.orientation == LOWER_FACE:
            problems.append(
                f"{option('orientation')} = {given.orientation!r}: the file holds the lower face of an "
                "indenter; leave it out"
            )
    elif given.orientation is None and content.orientation is None:
        problems.append(orientation_needed(option("orientation")))
    scale = size_of_unit if size_of_unit is not None else 1.0
    height = content.height if factor * scale == 1 else content.height * (factor * scale)
    known = length is not None and all(math.isfinite(edge) and edge > 0 for edge in length)
    edges = length or tuple(map(float, height.shape))
    if length is not None and not known:
        problems.append(f"edges > 0 are needed, not {edges[0]:g} and {edges[1]:g}")
    finite = np.isfinite(height)
    if not finite.any():
        problems.append("no point of the map has data")
    elif known and np.abs(height).max(initial=0.0, where=finite) > LARGEST_HEIGHT * max(edges):
        problems.append(
            f"heights up to {LARGEST_HEIGHT:g} times the longer edge are accepted; set "
            f"{option('height_factor')} or correct the file"
        )
    return HeightMap(
        height=height,
        length=(float(edges[0]), float(edges[1])),
        periodic=content.periodic,
        orientation=given.orientation or content.orientation,
        unit=unit,
        channel=content.channel,
    )


def _height_factor(content: FileContent, given: Reading, option: str, problems: list[str]) -> float:
    """Factor that the caller applies to the heights; the file's own is applied by its reader."""
    factor = given.height_factor
    if factor is None:
        return 1.0
    if not (isinstance(factor, (int, float)) and math.isfinite(factor) and factor > 0):
        problems.append(f"{option} = {shown(factor)}: a number > 0 is needed")
    elif content.factor is not None and not math.isclose(factor, content.factor, rel_tol=AGREEMENT):
        problems.append(f"{option} = {factor:g}: the file says {content.factor:g}; leave it out")
    elif content.factor is None and content.unit is not None and factor != 1:
        problems.append(f"{option} = {factor:g}: the file says heights in {content.unit}; leave it out")
    elif content.factor is None:
        return float(factor)
    return 1.0


def _unit(
    content: FileContent, given: Reading, option: OptionName, problems: list[str]
) -> tuple[str | None, float | None]:
    """Unit of the heights and its size in metres, None if nobody says it."""
    sizes: list[float | None] = []
    for unit, source in ((content.unit, "unit of the file"), (given.unit, option("unit"))):
        try:
            sizes.append(None if unit is None else metres(unit, source))
        except ValueError as error:
            sizes.append(None)
            problems.append(str(error))
    own, said = sizes
    if own is not None and said is not None and not math.isclose(own, said, rel_tol=1e-9):
        problems.append(f"{option('unit')} = {given.unit!r}: the file says {content.unit}; leave it out")
    if own is not None:
        return content.unit, own
    return (given.unit, said) if said is not None else (None, None)


def _length(
    content: FileContent, given: Reading, size_of_unit: float | None, option: OptionName, problems: list[str]
) -> tuple[float, float] | None:
    """Edges in metres, or in the unknown unit of the file; None if nobody says them."""
    scale = size_of_unit or 1.0
    own = None if content.length is None else (content.length[0] * scale, content.length[1] * scale)
    name = option("physical_size")
    if given.physical_size is None:
        if own is None:
            problems.append(f"{name}: the file does not say the edges (y, x) of the map; set {name}")
        return own
    said: list[float] = []
    for edge in given.physical_size:
        if not isinstance(edge, str):
            said.append(float(edge) * scale)
            continue
        if size_of_unit is None:
            problems.append(unit_missing(option("unit")))
            return own
        try:
            said.append(to_si(edge, "length", name))
        except ValueError as error:
            problems.append(str(error))
            return own
    if len(said) != 2 or not all(math.isfinite(edge) and edge > 0 for edge in said):
        problems.append(f"{name} = {shown(given.physical_size)}: two lengths > 0 (y, x) are needed")
        return own
    if own is None:
        return said[0], said[1]
    if not np.allclose(said, own, rtol=AGREEMENT, atol=0):
        unit = f" {content.unit}" if content.unit else ""
        size = " x ".join(f"{edge / scale:.6g}" for edge in own)
        problems.append(f"{name}: the file itself says {size}{unit} (y, x); leave it out")
    return own


def unit_missing(option: str) -> str:
    """Message that asks for the unit of the heights."""
    return f"{option}: the file does not say the unit of its heights; set {option}, for example to um"
