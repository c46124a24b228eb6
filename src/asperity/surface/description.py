"""Description of a height map before anything is computed: size, gaps, spikes, roughness, spectrum."""

from __future__ import annotations

import math
import os
from typing import NamedTuple

import numpy as np

from asperity.core.types import Array
from asperity.surface.reading.height_map import LOWER_FACE, PEAKS_UP, HeightMap, MapOptions
from asperity.surface.reading.map_file import MapFile, open_map
from asperity.surface.roughness import spectrum
from asperity.surface.treatment.levelling import edge_step, fill_harmonic, find_spikes, subtract_trend
from asperity.surface.treatment.treatment import DESPIKE, missing_options

SHORT_WAVE_PIXELS = 8
"""Waves shorter than this number of pixels are called not resolved: the slopes of a contact on fewer nodes a
wave depend on the grid."""

PERIODIC_STEP = 3.0
"""Largest edge step, in units of that between neighbouring points, of a map that is called periodic."""

SMALLEST_RMS, LARGEST_RMS = 1e-9, 1e-3
"""Rms heights in m beyond which the unit of a map is doubtful: a polished wafer has 0.2 nm, a cast surface
50 µm."""

LARGE_BOW = 0.5
"""Rms height without bow, relative to that with it, below which the bow is called a form of its own: below
that of self-affine surfaces."""

CHOSEN = MapOptions(periodic="mirrored", undefined="harmonic")
"""What asperity run does to a map that is not periodic and lacks points."""

NARROWEST_SLOPE = 4.0
"""Smallest ratio of wavenumbers over which a slope of the spectrum is given."""

ORIENTATION_WORDS = {
    PEAKS_UP: "peaks up, as instruments show them",
    LOWER_FACE: "lower face of an indenter, the lowest points touch first",
    None: "the file does not say which way is up",
}


class MapDescription(NamedTuple):
    """Description of a height map.

    Parameters
    ----------
    properties : dict
        Name of a property → the property in words.
    needed : list of str
        What every calculation needs to be told besides the file; each begins with a field of `MapOptions`.
    choices : list of str
        What asperity solve and a study need too, and asperity run chooses by itself.
    """

    properties: dict[str, str]
    needed: list[str]
    choices: list[str]


def describe_map(path: str | os.PathLike[str], options: MapOptions) -> MapDescription:
    """Description of the map in a file.

    Roughness is that of the map without its mean plane and its spikes; the gradient is that between
    neighbouring points.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    found = open_map(path, options)
    needed = missing_options(found, CHOSEN)
    choices = [text for text in missing_options(found, MapOptions()) if text not in needed]
    return MapDescription(_properties(found), needed, choices)


class MapMeasures(NamedTuple):
    """Spikes, tilt and bow of a height map, and its rms height without them; lengths in the unit of the map.

    Parameters
    ----------
    spikes : (ny, nx) array of bool
        Points beyond `DESPIKE` robust standard deviations from the local median.
    spike_count : int
        Connected groups of these points.
    highest_spike : float
        Largest distance of a spike from the heights that fill its place.
    level : (ny, nx) array
        Heights without spikes and tilt, filled where there are no data.
    tilt : float
        Angle of the mean plane, in radians.
    bow : float
        Height of the terms of degree two, from lowest to highest point.
    rms_height, rms_height_without_bow : float
        Without tilt and spikes.
    """

    spikes: Array
    spike_count: int
    highest_spike: float
    level: Array
    tilt: float
    bow: float
    rms_height: float
    rms_height_without_bow: float


def measure_map(surface: HeightMap) -> MapMeasures:
    """Spikes, tilt, bow and rms height of a height map with at least one point that has data."""
    from scipy.ndimage import label

    height = surface.height
    spikes = find_spikes(height, DESPIKE)
    filled = fill_harmonic(height, spikes | ~np.isfinite(height))
    level, slope, _ = subtract_trend(filled, "tilt", surface.length)
    flat, _, bow = subtract_trend(level, "curvature", surface.length)
    return MapMeasures(
        spikes=spikes,
        spike_count=int(label(spikes, np.ones((3, 3)))[1]),
        highest_spike=float(np.abs(height - filled).max(initial=0.0, where=spikes)),
        level=level,
        tilt=math.atan(math.hypot(*slope)),
        bow=bow,
        rms_height=float(np.std(level)),
        rms_height_without_bow=float(np.std(flat)),
    )


def map_warnings(surface: HeightMap, options: MapOptions, measures: MapMeasures | None = None) -> list[str]:
    """Doubts about a map that the options do not answer: its unit, spikes and bow.

    Each begins with the field of `MapOptions` that answers it.
    """
    found = measures or measure_map(surface)
    rms, length, warnings = found.rms_height_without_bow, surface.shown_length, []
    if surface.unit is not None and rms and not SMALLEST_RMS <= rms <= LARGEST_RMS:
        warnings.append(f"unit: an rms height of {length(rms)}; is {surface.unit} the unit of the heights?")
    if found.spike_count and options.despike is None:
        warnings.append(
            f"despike: {found.spike_count} spikes of up to {length(found.highest_spike)}; set it to "
            f"{DESPIKE:g} to replace them"
        )
    if rms < LARGE_BOW * found.rms_height and options.detrend != "curvature":
        warnings.append(
            f"detrend: a bow of {length(found.bow)}, with it an rms height of {length(found.rms_height)}, "
            f"without it {length(rms)}; set it to curvature"
        )
    return warnings


def _properties(found: MapFile) -> dict[str, str]:
    surface, height = found.map, found.map.height
    missing = ~np.isfinite(height)
    level, spikes, slope = np.zeros(height.shape), np.zeros_like(missing), (0.0, 0.0)
    if not missing.all():
        spikes = find_spikes(height, DESPIKE)
        level, slope, _ = subtract_trend(fill_harmonic(height, missing | spikes), "tilt", surface.length)
    rms_height = float(np.sqrt(np.mean(np.square(level))))
    squares = [np.mean(np.square(np.diff(level, axis=n) / surface.spacing[n])) for n in (0, 1)]

    def length(value: float) -> str:
        return surface.shown_length(value, digits=4)

    def share(points: Array) -> str:
        count = int(np.count_nonzero(points))
        return f"{count} points ({100 * count / height.size:.2g} %)" if count else "no points"

    table = {
        "file": surface.name,
        "channels": _channels(found),
        "heights": ORIENTATION_WORDS[surface.orientation],
        "unit": f"{surface.unit} in the file" if surface.unit else "not in the file",
        "points": f"{height.shape[0]} x {height.shape[1]} (y, x)",
        "size": " x ".join(map(length, surface.length)) + " (y, x)",
        "pixel": " x ".join(map(length, surface.spacing)),
        "without data": share(missing),
        "spikes": f"{share(spikes)} beyond {DESPIKE:g} robust standard deviations from the local median",
        "tilt": f"{math.degrees(math.atan(math.hypot(*slope))):.3g}°",
        "rms height": f"{length(rms_height)}, from lowest to highest point {length(float(np.ptp(level)))}, "
        "without tilt and spikes",
        "rms gradient": f"{np.sqrt(sum(squares)):.3g} between neighbouring points",
    }
    edges_known = not any("does not say the edges" in problem for problem in found.problems)
    if not edges_known:
        table |= {"size": "not in the file", "pixel": "not in the file"}
        del table["tilt"], table["rms gradient"]
    long_waves, short_waves, unresolved, hurst = spectrum_summary(level, surface)
    share_short = f"{100 * unresolved:.2g} % of the mean square gradient"
    resolved = f"{share_short} in waves shorter than {SHORT_WAVE_PIXELS} pixels"
    exponent = "" if math.isnan(hurst) else f", slope as for a Hurst exponent of {hurst:.2f}"
    waves = (
        f"half of the mean square height in waves longer than {length(long_waves)}, half of the mean square "
        f"gradient in waves shorter than {length(short_waves)}{exponent}; "
    )
    step = edge_step(level)
    stated = "" if surface.periodic else "does not "
    verdict = "" if surface.periodic or step <= PERIODIC_STEP else ": it is not"
    return table | {
        "spectrum": (waves if edges_known else "") + resolved,
        "periodic": f"the file {stated}say{'s' if surface.periodic else ''} so; rms step across the edges "
        f"{step:.3g} times that between neighbouring points{verdict}",
    }


def _channels(found: MapFile) -> str:
    known = [
        f"{number} {channel.name}"
        + (f" ({channel.shape[0]} x {channel.shape[1]})" if channel.shape else " (not a map)")
        + ("" if channel.kind == "height" else f", {channel.kind}")
        for number, channel in enumerate(found.channels)
    ]
    return "; ".join(known) + (f"; shown: {found.map.channel}" if len(known) > 1 else "")


def spectrum_summary(level: Array, surface: HeightMap) -> tuple[float, float, float, float]:
    """Longest half of the heights, shortest half and unresolved share of the gradient, Hurst exponent.

    Half of the mean square height is in waves longer than the first, half of the mean square gradient in
    waves shorter than the second. The Hurst exponent is from the slope −2(H + 1) of the spectrum between
    twice the wavenumber of the first and half of the largest, NaN if these are less than `NARROWEST_SLOPE`
    apart.
    The map is multiplied with a Hann window, so that its edges add no short waves.
    """
    window = np.outer(*(np.hanning(n + 2)[1:-1] for n in level.shape))
    wavenumber, power = spectrum(level * window, surface.length)
    height = power * wavenumber
    gradient = height * wavenumber**2
    if not height.sum() > 0:
        return math.nan, math.nan, math.nan, math.nan
    half_height = wavenumber[np.searchsorted(np.cumsum(height), 0.5 * height.sum())]
    half_gradient = wavenumber[np.searchsorted(np.cumsum(gradient), 0.5 * gradient.sum())]
    short = wavenumber > 2 * np.pi / (SHORT_WAVE_PIXELS * max(surface.spacing))
    low, high = 2 * half_height, np.pi / (2 * max(surface.spacing))
    sloped = (wavenumber > low) & (wavenumber < high) & (power > 0)
    hurst = math.nan
    if high > NARROWEST_SLOPE * low:
        slope = np.polyfit(np.log(wavenumber[sloped]), np.log(power[sloped]), 1)[0]
        hurst = float(-slope / 2 - 1)
    unresolved = float(gradient[short].sum() / gradient.sum())
    return float(2 * np.pi / half_height), float(2 * np.pi / half_gradient), unresolved, hurst
