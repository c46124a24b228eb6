"""Description of a height map before a calculation, and its preparation with the doubts about it."""

import math
import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from asperity.core.arguments import own_errors
from asperity.core.types import Array, FilePath
from asperity.fourier.grid import Grid
from asperity.settings.map import MapOptions
from asperity.surface import roughness
from asperity.surface.reading.agreement import MapFile, metres, repeated_height
from asperity.surface.reading.formats import PROFILE
from asperity.surface.reading.height_map import (
    LOWER_FACE,
    ORIENTATION_NEEDED,
    PEAKS_UP,
    HeightMap,
    is_period,
)
from asperity.surface.reading.map_file import open_map
from asperity.surface.treatment.levelling import edge_step, fill_harmonic, find_spikes, subtract_trend
from asperity.surface.treatment.treatment import (
    DESPIKE,
    FLAT_VARIATION,
    Doubt,
    TreatedMap,
    missing_options,
    treat_map,
    usable_map,
)

SHORT_WAVE_PIXELS = 8
"""Waves shorter than this number of pixels are called not resolved: the slopes of a contact on fewer nodes a
wave depend on the grid."""

PERIODIC_STEP = 3.0
"""Largest edge step, over the step between neighbouring points, of a map that is called periodic."""

SMALLEST_RMS, LARGEST_RMS = 1e-9, 1e-3
"""Rms heights in m beyond which the unit of a map is doubtful: a polished wafer has 0.2 nm, a cast surface
50 µm."""

LARGEST_EDGE, LARGEST_ASPECT, SLOPES = 1.0, 1.9, (1e-5, 3.0)
"""Edge in m, ratio of the edges of a pixel, and rms gradients, beyond which the size of a map is doubtful: no
instrument scans a metre, and a superpolished mirror has gradients of 1e-5."""

CHOSEN = MapOptions(periodic="mirrored", undefined="harmonic")
"""Treatment that asperity run chooses for a map that is not periodic and has non-measured points."""

NARROWEST_SLOPE = 4.0
"""Smallest ratio of wavenumbers over which a slope of the spectrum is given."""

DIRECTED = 0.5
"""Texture aspect ratio below which a surface has a lay; ISO 25178-2 calls ratios below 0.3 strong."""

NOT_IN_FILE = "not in the file"

PARAMETERS = {
    "Sq": "root mean square height",
    "Sa": "mean absolute height",
    "Sz": "from lowest to highest point",
    "Ssk": "skewness",
    "Sku": "kurtosis",
    "Sdq": "root mean square gradient between neighbouring points",
    "Sk": "height of the core of the material ratio curve",
    "Spk": "reduced height of the peaks above it",
    "Svk": "reduced depth of the valleys below it",
}
"""Parameters of ISO 25178-2 that spikes and form change, in words."""

NEED_EDGES = ("tilt", "Sdq", "plasticity", "Sal", "Str", "tip", "waves")
"""Properties that depend on the edges of a map."""

ORIENTATION_WORDS = {
    PEAKS_UP: "peaks up, as instruments show them",
    LOWER_FACE: "lower face of an indenter, the lowest points touch first",
    None: "the file does not state which way is up; asperity run takes the peaks as upward",
}


class MapDescription(NamedTuple):
    """Description of a height map.

    Parameters
    ----------
    properties : dict
        Name of a property → the property in words.
    needed : list of str
        Options that every calculation needs besides the file; each text begins with a field of `MapOptions`.
    choices : list of str
        Options that `asperity.prepare_map` and a study need too, and that asperity run chooses by itself.
    doubts : list of Doubt
        As of `map_doubts`.
    """

    properties: dict[str, str]
    needed: list[str]
    choices: list[str]
    doubts: list[Doubt]


def describe_map(path: FilePath, options: MapOptions) -> MapDescription:
    """Description of the map in a file.

    Roughness is computed from the points that have data, without the mean plane (of a map that is one period,
    without the mean) and without a filter, as `asperity.run` presses the map by default: with its spikes and
    its form. If spikes or form matter (`bow_counts`), the roughness without them is given beside it.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    found = open_map(path, options)
    needed = [text for text in missing_options(found, CHOSEN) if text != ORIENTATION_NEEDED]
    choices = [text for text in missing_options(found, MapOptions()) if text not in needed]
    surface, size, pixel = found.map, NOT_IN_FILE, NOT_IN_FILE
    if found.edges_known:
        size = f"{surface.shown_length(*surface.length, digits=4)} (y, x)"
        pixel = surface.shown_length(*surface.spacing, digits=4)
    stated = " in the file" if found.unit_stated else ", as given"
    properties = {
        "file": surface.name,
        **({"overridden" if found.overridden else "mask": "; ".join(surface.notes)} if surface.notes else {}),
        "channels": _channels(found),
        "heights": ORIENTATION_WORDS[surface.orientation],
        "unit": surface.unit + stated if surface.unit else NOT_IN_FILE,
        "points": f"{surface.height.shape[0]} x {surface.height.shape[1]} (y, x)",
        "size": size,
        "pixel": pixel,
        "non-measured": surface.shown_share(surface.missing) if surface.missing else "no points",
    }
    doubts: list[Doubt] = []
    if np.isfinite(surface.height).any():
        measures = MapMeasures(surface, options)
        comparable, is_profile = found.edges_comparable, options.format == PROFILE
        of_heights = {
            **_defects(surface, measures),
            **_roughness_words(surface, measures),
            **_wave_words(surface, measures),
        }
        unknown = () if comparable else NEED_EDGES
        for name, text in of_heights.items():
            if name not in unknown and not (is_profile and name in ("Sal", "Str")):
                properties[name.replace("S", "R", 1) if is_profile else name] = text
        doubts = map_doubts(surface, options, measures, comparable)
    return MapDescription(properties, needed, choices, doubts)


@own_errors
def prepare_map(source: FilePath | HeightMap, options: MapOptions | None = None, **given: Any) -> TreatedMap:
    """The lower face of an indenter, in metres, from a measured map.

    Parameters
    ----------
    source : path or HeightMap
        File of a map, whose unit has to be known, or a map.
    options : MapOptions, optional
    **given
        Fields of `MapOptions`, which override `options`.

    Warns
    -----
    UserWarning
        Of each doubt about the map that the options do not answer, such as spikes, as `asperity info` lists
        them; they are the `doubts` of the result.

    Returns
    -------
    TreatedMap
        With `height`, (ny, nx) in m, its `grid`, the steps of the treatment in `done`, and `doubts`.

    Raises
    ------
    MapError
        If the file cannot be used; the message names everything that is wrong or missing, also that its unit
        is not known.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> heights = asp.self_affine((40, 40), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=80e-6)
    >>> what = asp.MapOptions(physical_size=("80 um", "80 um"), unit="nm", orientation="peaks up")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder) / "map.npy", heights * 1e9)
    ...     made = asp.prepare_map(Path(folder) / "map.npy", what, periodic="windowed")
    >>> made.height.shape, [round(edge, 9) for edge in made.grid.length]
    ((40, 40), [8e-05, 8e-05])
    """
    options = (options or MapOptions()).replaced(**given)
    surface = source if isinstance(source, HeightMap) else usable_map(source, options)
    treated = treat_map(surface, options)
    doubts = tuple(map_doubts(surface, options))
    for doubt in doubts:
        warnings.warn(f"{surface.name or 'map'}: {doubt}", stacklevel=3)  # own_errors is one level
    return replace(treated, doubts=doubts)


class MapMeasures:
    """Spikes, tilt and form of a height map, and its rms height without them; lengths in the unit of the map.

    Parameters
    ----------
    surface : HeightMap
        With at least one point that has data.
    options : MapOptions
        A map that is taken as one period has no tilt and no form.

    Attributes
    ----------
    is_period : bool
    measured : (ny, nx) array of bool
        Points that have data and are no spikes.
    spikes : (ny, nx) array of bool
        Points beyond `DESPIKE` robust standard deviations from the local median.
    spike_count : int
        Connected groups of these points.
    highest_spike : float
        Largest distance of a spike from the heights that fill its place.
    level : (ny, nx) array
        Heights without spikes and tilt, filled where there are no data.
    spiky : (ny, nx) array
        Heights without tilt, with the spikes, NaN where there are no data.
    flat : (ny, nx) array
        Heights without spikes, tilt and form, filled where there are no data.
    tilt : float
        Angle of the mean plane, in radians.
    bow : float
        Form: height of the terms of degree two, from lowest to highest point.
    bow_counts : bool
        True if the form changes the rms height by more than the error of a sample of this size.
    rms_height, rms_height_without_bow : float
        Of the measured points, without tilt and spikes.
    """

    def __init__(self, surface: HeightMap, options: MapOptions) -> None:
        from scipy.ndimage import label

        height = surface.height
        self.spikes = find_spikes(height, DESPIKE)
        self.spike_count = int(label(self.spikes, np.ones((3, 3)))[1])
        self.measured, self.is_period = np.isfinite(height) & ~self.spikes, is_period(options, surface)
        trends = ("none", "none") if self.is_period else ("tilt", "curvature")
        (self.spiky, slope, _), (flat, _, self.bow) = (
            subtract_trend(height, trend, surface.length, self.measured) for trend in trends
        )
        self.tilt = math.atan(math.hypot(*slope))
        self.level, self.flat = (fill_harmonic(each, ~self.measured) for each in (self.spiky, flat))
        self.highest_spike = float(np.abs(self.spiky - self.level).max(initial=0.0, where=self.spikes))
        self.rms_height, self.rms_height_without_bow = (
            float(np.std(each[self.measured])) for each in (self.spiky, flat)
        )
        added, grid = self.rms_height - self.rms_height_without_bow, Grid(height.shape, surface.length)
        self.bow_counts = added > FLAT_VARIATION * float(np.abs(height[self.measured]).max()) and (
            not self.rms_height_without_bow
            or added > roughness.sampling_error(self.flat, grid) * self.rms_height_without_bow
        )


def map_doubts(
    surface: HeightMap,
    options: MapOptions,
    measures: MapMeasures | None = None,
    edges_known: bool = True,
) -> list[Doubt]:
    """Doubts about a map that the options do not answer: its unit, edges, missing points, spikes and form."""
    found = measures or MapMeasures(surface, options)
    rms, length = found.rms_height_without_bow, surface.shown_length
    doubts: list[Doubt] = []
    if rms <= FLAT_VARIATION * np.abs(surface.height[found.measured]).max(initial=0.0):
        rms = 0.0  # of a flat map, except for rounding
    if repeated := repeated_height(surface.height):
        number = repeated[0] / (metres(surface.unit) if surface.unit else 1.0)
        text = f"{surface.shown_share(repeated[1])} have the height {number:.9g} exactly"
        doubts.append(Doubt("missing", text, f"{number:.9g}", "if they are non-measured"))
    elif surface.unit is not None and rms and not SMALLEST_RMS <= rms <= LARGEST_RMS:
        doubts.append(Doubt("unit", f"Sq of {length(rms)}; is {surface.unit} the unit of the heights?"))
    if edges_known and not repeated:
        aspect = max(surface.spacing) / min(surface.spacing)
        slope = roughness.rms_step(np.where(found.measured, found.level, np.nan), surface.spacing)
        if surface.unit is not None and max(surface.length) >= LARGEST_EDGE:
            doubts.append(Doubt("physical_size", f"an edge of {length(max(surface.length))}; is this right?"))
        if aspect >= LARGEST_ASPECT:
            pixel = length(*surface.spacing)
            doubts.append(
                Doubt("physical_size", f"pixels of {pixel} (y, x), {aspect:.3g} to 1; is this right?")
            )
        if slope and not SLOPES[0] <= slope <= SLOPES[1]:
            text = (
                f"Sdq of {slope:.2g} between neighbouring points; are the units of edges and heights right?"
            )
            doubts.append(Doubt("physical_size", text))
    if found.spike_count and options.despike is None:
        text = f"{_spikes(found.spike_count)} of up to {length(found.highest_spike)}"
        doubts.append(Doubt("despike", text, f"{DESPIKE:g}", "to replace them"))
    if found.bow_counts and options.detrend != "curvature":
        change = f"Sq from {length(rms)} to {length(found.rms_height)}"
        text = f"a form of {length(found.bow)} height changes {change}"
        doubts.append(Doubt("detrend", text, "curvature", "to subtract it"))
    return doubts


def _spikes(count: int) -> str:
    return f"{count} spike{'s' * (count > 1)}"


def _defects(surface: HeightMap, measures: MapMeasures) -> dict[str, str]:
    """Spikes, tilt and form."""
    spikes = "no points"
    beyond = f", beyond {DESPIKE:g} robust standard deviations from the local median"
    if measures.spike_count:
        share = surface.shown_share(int(np.count_nonzero(measures.spikes)))
        highest = surface.shown_length(measures.highest_spike, digits=4)
        spikes = f"{share} in {_spikes(measures.spike_count)} of up to {highest}"
        beyond += "; plasticity, Sal, Str, tip and waves are without them"
    tilt = bow = "not subtracted: the map is one period"
    if not measures.is_period:
        tilt = f"{math.degrees(measures.tilt):.3g}°"
        bow = f"{surface.shown_length(measures.bow, digits=4)} from lowest to highest point"
    return {"spikes": f"{spikes}{beyond}", "tilt": tilt, "form": bow}


def _parameters(surface: HeightMap, height: Array) -> dict[str, str]:
    """Parameters of the points that have data, in words."""

    def length(value: float) -> str:
        return surface.shown_length(value, digits=4)

    values = height[np.isfinite(height)]
    _, skewness, kurtosis = roughness.moments(values, np.full(values.size, 1 / values.size))
    up = values if surface.orientation != LOWER_FACE else -values
    core, peaks, valleys = roughness.core_roughness(up)
    return {
        "Sq": length(float(np.std(values))),
        "Sa": length(float(np.mean(np.abs(values - values.mean())))),
        "Sz": length(float(np.ptp(values))),
        "Ssk": f"{skewness:.3g}",
        "Sku": f"{kurtosis:.3g}",
        "Sdq": f"{roughness.rms_step(height, surface.spacing):.3g}",
        "Sk": length(core),
        "Spk": length(peaks),
        "Svk": length(valleys),
    }


def _roughness_words(surface: HeightMap, measures: MapMeasures) -> dict[str, str]:
    """Parameters that spikes and form change, with and without them, and the index of plasticity."""
    shown, measured = _parameters(surface, measures.spiky), measures.measured
    level = np.where(measured, measures.level, np.nan)
    without = []
    if measures.spike_count:
        without.append((", without spikes", level))
    if measures.bow_counts:
        words = f", without {'spikes and ' if measures.spike_count else ''}form"
        without.append((words, np.where(measured, measures.flat, np.nan)))
    for words, height in without:
        texts = _parameters(surface, height)
        shown = {name: f"{shown[name]}{words} {text}" for name, text in texts.items()}
    slope = roughness.rms_step(level, surface.spacing)
    return {
        **{name: f"{shown[name]}, {words}" for name, words in PARAMETERS.items()},
        "plasticity": f"index {slope:.3g} × E*/p_H, modulus over hardness p_H; far below 1 the contact is "
        "elastic",
    }


def _wave_words(surface: HeightMap, measures: MapMeasures) -> dict[str, str]:
    """Length and direction of the texture, waves that a tip rounds, longest and shortest waves, period."""

    def length(value: float) -> str:
        return surface.shown_length(value, digits=4)

    shortest, ratio, direction = roughness.texture(measures.level, surface.spacing)
    lay = f", lay at {direction:.0f}° from x towards y" if ratio < DIRECTED else ""
    sal, str_ = surface.shown_length(shortest, digits=4), f"{ratio:.2g}"
    if measures.bow_counts:
        shortest, ratio, direction = roughness.texture(measures.flat, surface.spacing)
        sal += f", without form {surface.shown_length(shortest, digits=4)}"
        str_ += f", without form {ratio:.2g}" + (f" and lay at {direction:.0f}°" if ratio < DIRECTED else "")
    level = measures.level
    tip = roughness.finest_tip(level if surface.orientation != LOWER_FACE else -level, surface.spacing)
    long_waves, short_waves, unresolved, hurst = spectrum_summary(level, surface)
    # A lay lowers the exponent of self-affine maps by 0.06 or more, a form by 0.2 or more.
    is_sure = not (math.isnan(hurst) or measures.bow_counts or ratio < DIRECTED)
    exponent = f", slope as for a Hurst exponent of {hurst:.2f}" * is_sure
    step = edge_step(level)
    stated = "says" if surface.periodic else "does not say"
    verdict = "" if surface.periodic or step <= PERIODIC_STEP else ": not one period"
    return {
        "Sal": f"{sal}, shortest length over which the autocorrelation falls to 0.2",
        "Str": f"{str_}, shortest over longest such length{lay}",
        "tip": f"the sharpest peaks fit a tip of radius up to {length(tip)}; a blunter one has rounded them",
        "waves": f"half of the mean square height is in waves longer than {length(long_waves)}, half of the "
        f"mean square gradient in waves shorter than {length(short_waves)}{exponent}",
        "resolution": f"{100 * unresolved:.3g} % of the mean square gradient in waves shorter than "
        f"{SHORT_WAVE_PIXELS} pixels, which they do not resolve",
        "periodic": f"the file {stated} so; rms step across the edges {step:.3g} times the step between "
        f"neighbouring points{verdict}",
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
    """Wavelengths that halve the mean square height and gradient, unresolved gradient, Hurst exponent.

    Half of the mean square height is in waves longer than the first, half of the mean square gradient in
    waves shorter than the second. The Hurst exponent is from the slope −2(H + 1) of the spectrum between
    twice the wavenumber of the first and half of the largest, NaN if these are less than `NARROWEST_SLOPE`
    apart. The map is multiplied with a Hann window, so that its edges add no short waves.
    """
    window = np.outer(*(np.hanning(n + 2)[1:-1] for n in level.shape))
    wavenumber, power = roughness.spectrum(level * window, surface.length)
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
