"""Description of a height map before anything is computed: size, gaps, spikes, roughness, spectrum."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import numpy as np

from asperity.surface.height_map import HeightMap, OptionName
from asperity.surface.levelling import edge_step, fill_harmonic, find_spikes, subtract_trend
from asperity.surface.measured import missing_settings
from asperity.surface.reading import Channel, Reading, inspect_map
from asperity.surface.roughness import spectrum
from asperity.surface.treatment import DESPIKE, Treatment
from asperity.types import Array
from asperity.units import shown_si

SHORT_WAVE_PIXELS = 8
"""Waves shorter than this number of pixels are called not resolved: the slopes of a contact on fewer nodes a
wave depend on the grid."""

PERIODIC_STEP = 3.0
"""Largest edge step, in units of that between neighbouring points, of a map that is called periodic."""

CHOSEN = Treatment(periodic="mirrored", undefined="harmonic")
"""What asperity run does to a map that is not periodic and lacks points."""

NARROWEST_SLOPE = 4.0
"""Smallest ratio of wavenumbers over which a slope of the spectrum is given."""


@dataclass(frozen=True)
class MapDescription:
    """Properties of a height map; lengths are in the unit of the map.

    Parameters
    ----------
    map : HeightMap
    channels : list of Channel
        All channels of the file.
    missing, spikes : int
        Points without data, and points that `asperity.surface.levelling.find_spikes` finds with `DESPIKE`.
    tilt : float
        Angle of the mean plane in radians.
    rms_height, rms_gradient, peak_to_valley : float
        Of the map without its mean plane and its spikes. The gradient is that between neighbouring points.
    edge_step : float
        `asperity.surface.levelling.edge_step` of the map without its mean plane.
    long_waves, short_waves : float
        Half of the mean square height is in waves longer than the first; half of the mean square gradient is
        in waves shorter than the second.
    unresolved_gradient : float
        Share of the mean square gradient in waves shorter than `SHORT_WAVE_PIXELS` pixels.
    hurst : float
        Hurst exponent from the slope −2(H + 1) of the spectrum between twice the wavenumber of `long_waves`
        and half of the largest; NaN if these are less than `NARROWEST_SLOPE` apart.
    needed : list of str
        What every calculation needs to be told besides the file.
    choices : list of str
        What asperity solve and a study need too, and asperity run chooses by itself.
    """

    map: HeightMap
    channels: list[Channel]
    missing: int
    spikes: int
    tilt: float
    rms_height: float
    rms_gradient: float
    peak_to_valley: float
    edge_step: float
    long_waves: float
    short_waves: float
    unresolved_gradient: float
    hurst: float
    needed: list[str]
    choices: list[str]

    def lines(self) -> list[str]:
        """The description as text, one property a line."""
        table = {
            "file": self.map.name,
            "channels": self._channels(),
            "heights": {
                "peaks up": "peaks up, as instruments show them",
                "lower face": "lower face of an indenter, the lowest points touch first",
                None: "the file does not say which way is up",
            }[self.map.orientation],
            "unit": f"{self.map.unit} in the file" if self.map.unit else "not in the file",
            "points": f"{self.map.height.shape[0]} x {self.map.height.shape[1]} (y, x)",
            "size": self._size(),
            "pixel": " x ".join(map(self._length, self.map.spacing)),
            "without data": self._share(self.missing),
            "spikes": f"{self._share(self.spikes)} beyond {DESPIKE:g} robust standard deviations from the "
            "local median",
            "tilt": f"{math.degrees(self.tilt):.3g}°",
            "rms height": f"{self._length(self.rms_height)}, from lowest to highest point "
            f"{self._length(self.peak_to_valley)}, without tilt and spikes",
            "rms gradient": f"{self.rms_gradient:.3g} between neighbouring points",
            "spectrum": self._spectrum(),
            "periodic": self._periodic(),
        }
        if self._edges_unknown():
            table |= {"size": "not in the file", "pixel": "not in the file"}
            for name in ("tilt", "rms gradient"):
                del table[name]
        width = max(map(len, table)) + 2
        lines = [f"{name + ':':<{width}}{text}" for name, text in table.items()]
        if self.needed:
            lines += ["every calculation needs", *(f"  {text}" for text in self.needed)]
        if self.choices:
            lines += [
                "asperity run fills points without data and mirrors the map by itself; "
                "asperity solve and a study need",
                *(f"  {text}" for text in self.choices),
            ]
        return lines if self.needed or self.choices else [*lines, "A calculation needs nothing else."]

    def _channels(self) -> str:
        known = [
            f"{number} {channel.name}"
            + (f" ({channel.shape[0]} x {channel.shape[1]})" if channel.shape else " (not a map)")
            + ("" if channel.kind == "height" else f", {channel.kind}")
            for number, channel in enumerate(self.channels)
        ]
        return "; ".join(known) + (f"; shown: {self.map.channel}" if len(known) > 1 else "")

    def _edges_unknown(self) -> bool:
        return any("does not say the edges" in text for text in self.needed)

    def _size(self) -> str:
        return " x ".join(map(self._length, self.map.length)) + " (y, x)"

    def _spectrum(self) -> str:
        resolved = (
            f"{100 * self.unresolved_gradient:.2g} % of the mean square gradient in waves shorter than "
            f"{SHORT_WAVE_PIXELS} pixels"
        )
        if self._edges_unknown():
            return resolved
        hurst = "" if math.isnan(self.hurst) else f", slope as for a Hurst exponent of {self.hurst:.2f}"
        return (
            f"half of the mean square height in waves longer than {self._length(self.long_waves)}, half of "
            f"the mean square gradient in waves shorter than {self._length(self.short_waves)}{hurst}; "
            f"{resolved}"
        )

    def _periodic(self) -> str:
        step = f"rms step across the edges {self.edge_step:.3g} times that between neighbouring points"
        if self.map.periodic:
            return f"the file says so; {step}"
        return f"the file does not say so; {step}{'' if self.edge_step <= PERIODIC_STEP else ': it is not'}"

    def _share(self, number: int) -> str:
        return f"{number} points ({100 * number / self.map.height.size:.2g} %)" if number else "no points"

    def _length(self, value: float) -> str:
        return shown_si(value, "m", 4) if self.map.unit else f"{value:.4g}"


def describe_map(
    path: str | os.PathLike[str], given: Reading | None = None, option: OptionName = str
) -> MapDescription:
    """Description of the map in a file.

    Parameters
    ----------
    path : path
    given : Reading, optional
        What the caller says about the file.
    option : callable
        Gives the name of an argument in the interface of the user, for what is needed.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    found = inspect_map(path, given, option)
    surface = found.map
    needed = missing_settings(found, CHOSEN, option)
    choices = [text for text in missing_settings(found, Treatment(), option) if text not in needed]
    missing = ~np.isfinite(surface.height)
    if missing.all():
        level, spikes, tilt = np.zeros(surface.height.shape), np.zeros_like(missing), 0.0
    else:
        spikes = find_spikes(surface.height, DESPIKE)
        filled = fill_harmonic(surface.height, missing | spikes)
        level, trend = subtract_trend(filled, "tilt", surface.length)
        tilt = math.atan(math.hypot(*trend.slope))
    steps = [np.diff(level, axis=axis) / surface.spacing[axis] for axis in (0, 1)]
    long_waves, short_waves, unresolved, hurst = _spectrum_summary(level, surface)
    return MapDescription(
        map=surface,
        channels=found.channels,
        missing=surface.missing,
        spikes=int(np.count_nonzero(spikes)),
        tilt=tilt,
        rms_height=float(np.sqrt(np.mean(np.square(level)))),
        rms_gradient=float(np.sqrt(sum(np.mean(np.square(step)) for step in steps))),
        peak_to_valley=float(np.ptp(level)),
        edge_step=edge_step(level),
        long_waves=long_waves,
        short_waves=short_waves,
        unresolved_gradient=unresolved,
        hurst=hurst,
        needed=needed,
        choices=choices,
    )


def _spectrum_summary(level: Array, surface: HeightMap) -> tuple[float, float, float, float]:
    """Longest half of the heights, shortest half and unresolved share of the gradient, Hurst exponent.

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
