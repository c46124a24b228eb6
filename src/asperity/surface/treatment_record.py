"""Record of everything that was done to a measured map, as attributes of a file and in words."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from asperity.units import shown_si


@dataclass(frozen=True)
class MapTreatment:
    """Record of what was done to a map.

    Parameters
    ----------
    orientation : str
        Meaning of the heights in the file: ``peaks up`` (they were turned upside down) or ``lower face``.
    unit : str
        Unit of the lengths below: ``m``, or ``unknown``.
    missing, spikes : int
        Points without data in the file, and points removed as spikes. Both were filled.
    filled_fraction : float
        Share of the points that were filled.
    despike : float
        Threshold for spikes in robust standard deviations, 0 if none were looked for.
    detrend : str
    tilt : float
        Angle of the mean plane that was removed, in radians.
    bow : float
        Height of the terms of degree two that were removed, from lowest to highest point.
    periodic : str
        ``declared``, ``mirrored``, ``windowed``, ``none``, or ``stated by the file``.
    altered_fraction : float
        Share of the area that a window lowered.
    edge_step_before, edge_step : float
        `asperity.surface.levelling.edge_step` of the levelled map and of the result.
    shape_y, shape_x, points_y, points_x : int
        Points of the file and of the result.
    length_y, length_x : float
        Edges of the result.
    wavelength_short : float
        Shortest wave of the result.
    filtered : int
        1 if shorter waves were removed.
    """

    orientation: str
    unit: str
    missing: int
    spikes: int
    filled_fraction: float
    despike: float
    detrend: str
    tilt: float
    bow: float
    periodic: str
    altered_fraction: float
    edge_step_before: float
    edge_step: float
    shape_y: int
    shape_x: int
    points_y: int
    points_x: int
    length_y: float
    length_x: float
    wavelength_short: float
    filtered: int

    def attributes(self, prefix: str = "map_") -> dict[str, Any]:
        """The record as attributes of a NetCDF file."""
        return {f"{prefix}{name}": value for name, value in asdict(self).items()}

    def lines(self) -> list[str]:
        """The record in words, one sentence a step."""
        lines = [
            "turned upside down: the peaks of the map touch first"
            if self.orientation == "peaks up"
            else "used as it is: the heights are those of an indenter's lower face"
        ]
        points = self.shape_y * self.shape_x
        if self.despike:
            lines.append(
                f"spikes: {_count(self.spikes, points)} beyond {self.despike:g} robust standard deviations "
                "from the local median replaced"
            )
        if self.missing:
            lines.append(f"without data: {_count(self.missing, points)} filled by a harmonic function")
        lines.append(self._levelled())
        lines.append(self._made_periodic())
        if self.filtered:
            lines.append(f"waves shorter than {self._length(self.wavelength_short)} removed")
        if (self.points_y, self.points_x) != self._shape_before_resampling():
            lines.append(f"resampled to {self.points_y} x {self.points_x} points")
        return lines

    def _levelled(self) -> str:
        if self.detrend == "none":
            return "levelled: mean height removed"
        tilt = f"tilt of {math.degrees(self.tilt):.3g}°"
        if self.detrend == "tilt":
            return f"levelled: {tilt} removed"
        return f"levelled: {tilt} and curvature of {self._length(self.bow)} height removed"

    def _made_periodic(self) -> str:
        step = f"edge step {self.edge_step_before:.3g} times that between neighbouring points"
        size = f"{self._length(self.length_y)} x {self._length(self.length_x)}"
        return {
            "mirrored": f"mirrored at two edges: the cell is {size}",
            "windowed": f"windowed: {100 * self.altered_fraction:.3g} % of the area lowered towards the mean",
            "declared": f"taken as one period, as declared: {step}",
            "none": "not made periodic: for a free boundary",
        }.get(self.periodic, f"taken as one period, as the file states: {step}")

    def _shape_before_resampling(self) -> tuple[int, int]:
        factor = 2 if self.periodic == "mirrored" else 1
        return factor * self.shape_y, factor * self.shape_x

    def _length(self, value: float) -> str:
        return shown_si(value, "m", 3) if self.unit == "m" else f"{value:.3g}"


def _count(number: int, of: int) -> str:
    """Number of points with its share in percent."""
    return f"{number} points ({100 * number / of:.2g} %)"
