"""The rough face that is pressed: one map, or the composite roughness of two, read, treated and measured."""

import os
from collections.abc import Callable, Sequence, Set
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from asperity.core.errors import one_line
from asperity.core.system import available_memory, sha256_of
from asperity.core.types import Array
from asperity.settings.map import MOST_POINTS, CounterMap, Map
from asperity.surface.description import MapMeasures, map_doubts
from asperity.surface.reading.height_map import ORIENTATION_NEEDED, PEAKS_UP, HeightMap, MapError, is_period
from asperity.surface.reading.map_file import open_shared_map
from asperity.surface.treatment.face_to_face import face_to_face
from asperity.surface.treatment.treatment import (
    ANSWER_MEMORY,
    BYTES_PER_NODE,
    Doubt,
    TreatedMap,
    missing_options,
    treat_map,
)

SMALLEST_PARALLEL = 65_536
"""Least nodes of the largest map for which processes save time: one takes about two seconds to start."""

LONGEST_NAME = 60
"""Most characters of the name of a map in titles."""

SPIKE_REACH = 1.5
"""Pixels beside a spike that belong to it, after the map is levelled and resampled."""

ASSUMED = Doubt(
    "orientation", f"the file does not say which way is up; taken as {PEAKS_UP}, as instruments show them"
)


class ReadFile(NamedTuple):
    """Path, size in bytes and SHA-256 checksum of a file when it was read."""

    path: str
    size: int
    sha256: str

    def __str__(self) -> str:
        return one_line(f"{self.path}, {self.size:,} bytes, SHA-256 {self.sha256}")


class RoughFace(NamedTuple):
    """The rough face that is pressed, and doubts about its map.

    Parameters
    ----------
    face : TreatedMap
    doubts : tuple of Doubt
        As of `asperity.surface.description.map_doubts`.
    spikes : (spikes, 2) array
        Places (y, x) on the map of the spikes that were not removed.
    reach : (y, x)
        Distance from its place up to which a spike reaches.
    files : tuple of ReadFile
        The files that were read.
    options : Map, optional
        The map with the options that its file needs, and the channel that was read.
    upper : array, optional
        The lower face of the upper body, if both are rough: its part of the composite roughness.
    counter : CounterMap, optional
        The counter map, with the options of the map that only the counter map needs.
    unfiltered : TreatedMap, optional
        The surface without the Gaussian filters, if there are any.
    """

    face: TreatedMap
    doubts: tuple[Doubt, ...]
    spikes: Array
    reach: tuple[float, float] = (0.0, 0.0)
    files: tuple[ReadFile, ...] = ()
    options: Map | None = None
    upper: Array | None = None
    counter: CounterMap | None = None
    unfiltered: TreatedMap | None = None


def read_face(
    options: Map,
    counter: CounterMap | None = None,
    shared: bool = False,
    check: Callable[[Sequence[float]], None] | None = None,
) -> RoughFace:
    """Read a map and prepare it, with the map of the counter body if that is rough too.

    The counter map takes options that it does not give itself from the map. The file overrides options that
    are shared with other maps. `check` is called with the edges (y, x) of a map alone, before its treatment.

    Raises
    ------
    MapError, TypeError, ValueError
        If a map cannot be read, has no unit, or needs an option that is not given, or if the two do not go
        together.
    """
    given = options.model_fields_set - {"file"}
    inherited = set() if counter is None else given - counter.model_fields_set
    of_map = {each: getattr(options, each) for each in inherited}
    name, surface, doubts, spikes, options = _read(
        options, given if shared else inherited, None if counter else check
    )
    files = _read_file(options.file)
    if counter is None:
        whole = _completed(options, surface)
        treated, unfiltered = treat_map(surface, whole, joins=True), _unfiltered(surface, whole)
        y, x = surface.spacing
        reach, face = (SPIKE_REACH * y, SPIKE_REACH * x), replace(treated, name=name)
        return RoughFace(face, doubts, spikes, reach, files, options, unfiltered=unfiltered)
    counter_name, counter_surface, counter_doubts, _, own = _read(counter.replaced(**of_map), inherited)
    overridden = {each for each in inherited if getattr(options, each) is None}
    counter = counter.replaced(**{each: getattr(own, each) for each in overridden})
    files += _read_file(counter.file)
    level, filled, done = _levelled(surface, options)
    counter_level, counter_filled, counter_done = _levelled(counter_surface, own)
    pair = face_to_face(level, counter_level, counter.turned_about, counter.shift)
    later = _completed(options, pair.map).replaced(despike=None, scan_lines=None)
    treated = treat_map(pair.map, later, joins=True)
    upper = treat_map(pair.upper, later.replaced(radius=None)).height
    record = replace(treated.treatment, filled_fraction=filled + counter_filled)
    lines = [
        *(f"map: {line}" for line in done),
        *(f"counter map: {line}" for line in counter_done),
        *pair.done,
        *(line for line in treated.done[1:] if not (pair.whole and line.startswith("levelled"))),
    ]
    face = replace(treated, name=f"{name} on {counter_name}", treatment=record, done=tuple(lines))
    of_both = *doubts, *(each._replace(text=f"{each.text} (counter map)") for each in counter_doubts)
    return RoughFace(
        face, of_both, spikes[:0], (0.0, 0.0), files, options, upper, counter, _unfiltered(pair.map, later)
    )


def _unfiltered(surface: HeightMap, options: Map) -> TreatedMap | None:
    """The face without the Gaussian filters; None if there are none."""
    if options.s_filter is None and options.l_filter is None:
        return None
    return treat_map(surface, options.replaced(s_filter=None, l_filter=None), joins=True)


def _read_file(source: Any) -> tuple[ReadFile, ...]:
    """The file of a map; empty for a map that is given as an array."""
    if isinstance(source, HeightMap):
        return ()
    return (ReadFile(os.path.abspath(source), os.path.getsize(source), sha256_of(source)),)


def _read(
    options: Map, shared: Set[str], check: Callable[[Sequence[float]], None] | None = None
) -> tuple[str, HeightMap, tuple[Doubt, ...], Array, Map]:
    """Name and heights of a map, its doubts, places of spikes, and options; checks that none is missing.

    The file overrides the options that are `shared` with other maps.
    """
    source = options.file
    if isinstance(source, HeightMap):
        name, surface = source.name or "map", replace(source, unit=source.unit or "m")
    else:
        found = open_shared_map(source, options, shared)
        problems = missing_options(found, _completed(options))
        if problems := [text for text in problems if text != ORIENTATION_NEEDED]:
            raise MapError(os.fspath(source), problems)
        name, surface, options = Path(source).stem, found.map, found.options  # type: ignore[assignment]
    if options.crop is not None:
        surface = surface.cropped(options.crop, options.crop_at)
    if check is not None:
        check(surface.length)
    measured = MapMeasures(surface, options)
    doubts = map_doubts(surface, options, measured)
    if surface.orientation is None:
        surface = replace(surface, orientation=PEAKS_UP)
        doubts.append(ASSUMED)
    spikes = np.argwhere(measured.spikes if options.despike is None else np.zeros((0, 0)))
    name = one_line(name)
    name = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 3]}..."
    return name, surface, tuple(doubts), spikes * surface.spacing, options


def _completed(options: Map, surface: HeightMap | None = None) -> Map:
    """The options; by default points are filled, and a map that is not declared periodic is mirrored.

    `points` is the number of points of the map, also if it is mirrored.
    """
    periodic = options.periodic or (None if surface and surface.periodic else "mirrored")
    points = options.points
    if points is not None and periodic == "mirrored":
        if 2 * points > MOST_POINTS:
            needed = f"points = {points}: at most {MOST_POINTS // 2} are accepted on a map that is mirrored"
            raise MapError(str(options.file), [needed])
        points *= 2
    return options.replaced(periodic=periodic, undefined="harmonic", points=points)


def _levelled(surface: HeightMap, options: Map) -> tuple[HeightMap, float, list[str]]:
    """A map without spikes, missing points and trend; the fraction filled, and the steps in words."""
    later: dict[str, Any] = dict.fromkeys(
        ("wavelength_short", "points", "radius", "s_filter", "l_filter", "ends")
    )
    whole = _completed(options, surface)
    trend = options.detrend or ("none" if is_period(whole, surface) else "tilt")
    bounded = whole.replaced(periodic="none", detrend=trend, **later)
    treated = treat_map(surface, bounded)
    height = -treated.height if surface.orientation == PEAKS_UP else treated.height
    done = [line for line in treated.done[1:] if not line.startswith("not made periodic")]
    return replace(surface, height=height), treated.treatment.filled_fraction, done


def memory_on(face: TreatedMap) -> float:
    """Bytes that an answer on a map takes."""
    return ANSWER_MEMORY + BYTES_PER_NODE[face.boundary] * face.height.size


def processes_on(faces: Sequence[TreatedMap], count: int, cores: int | None = None) -> int:
    """Number of processes for some tasks on the largest of some maps, within the memory that is available.

    All cores are used by default.
    """
    nodes = max((face.height.size for face in faces), default=0)
    if count < 2 or cores == 1 or nodes < SMALLEST_PARALLEL:
        return 1
    available = 1e6 * available_memory()  # from MB to bytes
    return max(1, min(count, cores or os.cpu_count() or 1, int(available / max(map(memory_on, faces)))))
