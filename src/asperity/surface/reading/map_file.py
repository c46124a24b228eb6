"""Reading of height maps: what a file says and what the caller says about it, combined and in metres.

What the caller says must not contradict the file. Everything that is wrong or missing is reported at once.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.core.errors import shown
from asperity.core.units import to_si
from asperity.surface.reading.contents import Channel, FileContent, read_content
from asperity.surface.reading.height_map import (
    LOWER_FACE,
    ORIENTATION_NEEDED,
    UNIT_NEEDED,
    HeightMap,
    MapError,
    MapOptions,
    metres,
)

LARGEST_HEIGHT = 1e6
"""Largest height of a map in units of its longer edge; a larger one is a wrong unit or a damaged file."""

AGREEMENT = 1e-3
"""Relative difference up to which what the caller says is what the file says: one pixel of a map of 1000."""


@dataclass(frozen=True)
class MapFile:
    """A file as far as it can be read.

    Parameters
    ----------
    map : HeightMap
        Its edges are numbers of pixels if they are not known.
    channels : tuple of Channel
    problems : list of str
        What is missing or contradicts the file; empty if the map can be used.
    """

    map: HeightMap
    channels: tuple[Channel, ...]
    problems: list[str]


def read_map(path: str | os.PathLike[str], options: MapOptions | None = None, **given: Any) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : path
        In one of the formats that docs/formats.md lists, also packed by gzip.
    options : MapOptions, optional
        What is known of the map beside its file; how it is treated is not used.
    **given
        Fields of `MapOptions`, in place of those of `options`.

    Returns
    -------
    HeightMap
        In metres if the unit is known.

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed, for files of instruments.
    MapError
        If the file is not a rectangular height map, if it does not contain what is needed and no option
        gives it, if an option contradicts it, or if it unpacks to more than `max_memory`. The message names
        all of this at once.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.npy"
    ...     np.save(path, np.random.default_rng(1).normal(size=(40, 60)))
    ...     said = {"unit": "nm", "orientation": "peaks up"}
    ...     surface = asp.read_map(path, physical_size=("80 um", "120 um"), **said)
    >>> surface.height.shape, [round(edge, 9) for edge in surface.length], surface.periodic
    ((40, 60), [8e-05, 0.00012], False)
    """
    found = open_map(path, MapOptions.chosen(options, given))
    if found.problems:
        raise MapError(os.fspath(path), found.problems)
    return found.map


def open_map(path: str | os.PathLike[str], options: MapOptions) -> MapFile:
    """Read a height map as far as possible, and list what is missing.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    content = read_content(path, options)
    problems: list[str] = []
    factor = _height_factor(content, options, problems)
    unit, metre = _unit(content, options, problems)
    length = _length(content, options, metre, problems)
    orientation = _orientation(content, options, problems)
    scale = factor * (metre or 1.0)
    height = content.height if scale == 1 else content.height * scale
    edges = length or (float(height.shape[0]), float(height.shape[1]))
    finite = np.isfinite(height)
    if not finite.any():
        problems.append("no point of the map has data")
    elif length and np.abs(height).max(initial=0.0, where=finite) > LARGEST_HEIGHT * max(edges):
        problems.append(
            f"height_factor: heights up to {LARGEST_HEIGHT:g} times the longer edge are accepted; set it or "
            "correct the file"
        )
    name = os.fspath(path)
    found = HeightMap(height, edges, content.periodic, orientation, unit, name, content.channel)
    return MapFile(found, content.channels, problems)


def _orientation(content: FileContent, options: MapOptions, problems: list[str]) -> str | None:
    own, given = content.orientation, options.orientation
    if own is None and given is None:
        problems.append(ORIENTATION_NEEDED)
    elif own == LOWER_FACE and given not in (None, own):
        problems.append(
            f"orientation = {given!r}: the file holds the lower face of an indenter; leave it out"
        )
    return given or own


def _height_factor(content: FileContent, options: MapOptions, problems: list[str]) -> float:
    """Factor that the caller applies to the heights; the file's own is applied by its reader."""
    factor = options.height_factor
    if factor is None:
        if content.is_grey:
            problems.append("height_factor: the file holds grey levels; set it to the height of one level")
        return 1.0
    if content.factor is not None and not math.isclose(factor, content.factor, rel_tol=AGREEMENT):
        problems.append(f"height_factor = {factor:g}: the file says {content.factor:g}; leave it out")
    elif content.factor is None and content.unit is not None and factor != 1:
        problems.append(f"height_factor = {factor:g}: the file says heights in {content.unit}; leave it out")
    elif content.factor is None:
        return float(factor)
    return 1.0


def _unit(content: FileContent, options: MapOptions, problems: list[str]) -> tuple[str | None, float | None]:
    """Unit of the heights and its size in metres, None if nobody says it."""
    known = {}
    for name, unit in (("unit of the file", content.unit), ("unit", options.unit)):
        try:
            if unit is not None:
                known[unit] = metres(unit, name)
        except ValueError as error:
            problems.append(str(error))
    sizes = list(known.values())
    if len(sizes) == 2 and not math.isclose(*sizes, rel_tol=1e-9):
        problems.append(f"unit = {options.unit!r}: the file says {content.unit}; leave it out")
    return next(iter(known.items()), (None, None))


def _length(
    content: FileContent, options: MapOptions, metre: float | None, problems: list[str]
) -> tuple[float, float] | None:
    """Edges in metres, or in the unknown unit of the file; None if nobody says them."""
    scale = metre or 1.0
    own = None if content.length is None else (content.length[0] * scale, content.length[1] * scale)
    if own is not None and not all(math.isfinite(edge) and edge > 0 for edge in own):
        problems.append(f"edges > 0 are needed, not {own[0]:g} and {own[1]:g}")
        return None
    size = options.physical_size
    if size is None:
        if own is None:
            problems.append("physical_size: the file does not say the edges (y, x) of the map; set it")
        return own
    if metre is None and any(isinstance(edge, str) for edge in size):
        problems.append(UNIT_NEEDED)
        return own
    try:
        y, x = (to_si(e, "length", "physical_size") if isinstance(e, str) else e * scale for e in size)
    except ValueError as error:
        problems.append(str(error))
        return own
    if not (0 < y < math.inf and 0 < x < math.inf):
        problems.append(f"physical_size = {shown(size)}: two lengths > 0 (y, x) are needed")
        return own
    if own is None:
        return y, x
    if not np.allclose((y, x), own, rtol=AGREEMENT, atol=0):
        stated = " x ".join(f"{edge / scale:.6g}" for edge in own) + (
            f" {content.unit}" if content.unit else ""
        )
        problems.append(f"physical_size: the file itself says {stated} (y, x); leave it out")
    return own
