"""Criteria of a stress history: range of a shear stress, fatigue after Dang Van, bounds of elastic shakedown.

Deviators are points of a space of five dimensions whose squared norm is s : s, two thirds of the square of
the von Mises stress; coordinates that a residual stress can change come first.

Dang Van
--------
After elastic shakedown the deviators of the cycle lie around the centre c of the smallest sphere that
encloses them. The largest τ_a(t) + α σ_H(t), with the Tresca shear stress τ_a of s(t) − c and the mean σ_H
of the normal stresses, stays below the fatigue limit in reversed torsion; α follows from the limit in
reversed bending (K. Dang Van, ASTM STP 1191 (1993) 120).

Shakedown
---------
By Melan's theorem a body shakes down to elastic cycles if some residual stress in equilibrium keeps every
stress below yield (K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 9). The yield stress over the
smallest radius is the factor by which the load can rise. Residual stresses that do not change along x are
restricted by equilibrium: only ρ_xx(y, z) can be chosen freely at every point. The factor is a lower bound
with the centre free along xx alone, and an upper bound with an unrestricted centre. Under a contact that does
not change along y, exactly ρ_xx, ρ_yy and ρ_xy are free: the factor with these is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.arguments import finite_array, magnitude, number, require_finite
from asperity.core.compiled import compiled, compiled_with_arrays
from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.cycles.smallest_sphere import DIMENSIONS, smallest_sphere
from asperity.stress.planes.fields import principal_stresses

FATIGUE_RATIOS = (0.5, 1.0)
"""Accepted fatigue limits in torsion over bending: at 1/2 (α = 0) the hydrostatic stress has no effect, and
at 1 (α = 3/2) it contributes as much under a tensile stress as the shear stress does; ductile metals have
0.55 to 0.75."""

LARGEST_FACTOR = 1e12
"""Largest shakedown factor; it replaces an infinite one where the stress does not change."""

RESIDUALS = {"shakedown_upper": 5, "shakedown_line": 3, "shakedown_lower": 1}
"""Shakedown factor → number of coordinates that the residual stress can change."""

FATIGUE_SHARES = np.geomspace(0.1, 10, 461)
"""Fractions of the fatigue limit above which the volume is known, 1 % apart."""

FATIGUE_EXPONENTS = np.geomspace(1, 130, 33)
"""Exponents of the power means of the Dang Van stress: between them interpolation is exact to 1e-4."""

NUMBERS = ("shear_range", "dang_van", *RESIDUALS)
"""Numbers of a history, in the order of `Criteria.numbers`."""


def hydrostatic_factor(fatigue_torsion: float | None, fatigue_bending: float | None) -> float:
    """The factor α of the hydrostatic stress, which makes reversed bending reach its own limit.

    Raises
    ------
    ValueError
        If one of the limits is missing or their ratio is not in `FATIGUE_RATIOS`.

    Examples
    --------
    >>> from asperity.stress.cycles.criteria import hydrostatic_factor
    >>> print(f"{hydrostatic_factor(300e6, 480e6):.3f}")
    0.375
    """
    given = {"fatigue_torsion": fatigue_torsion, "fatigue_bending": fatigue_bending}
    for name, value in given.items():
        if value is None:
            text = ": missing; both fatigue limits are needed, of torsion and of bending"
            raise InputError("", [(name, text)])
        magnitude(name, value)
    torsion, bending = map(float, given.values())  # type: ignore[arg-type]
    low, high = FATIGUE_RATIOS
    if not low * (1 - 1e-12) <= torsion / bending <= high * (1 + 1e-12):
        text = f": {low:g} to {high:g} times fatigue_bending is needed, got {torsion / bending:.4g} times"
        raise InputError("", [("fatigue_torsion", text)])
    return 3 * (torsion / bending - 0.5)


@dataclass(frozen=True)
class Criteria:
    """Limits with which histories are compared; arguments and errors as for `stress_cycles`."""

    fatigue_torsion: float | None = None
    fatigue_bending: float | None = None
    yield_stress: float | None = None
    residual_stress: float | tuple[Sequence[float], Sequence[float]] = 0.0

    def __post_init__(self) -> None:
        if self.has_fatigue:
            hydrostatic_factor(self.fatigue_torsion, self.fatigue_bending)
        if self.yield_stress is not None:
            magnitude("yield_stress", self.yield_stress)
        if isinstance(self.residual_stress, tuple):
            finite_array("residual_stress", np.array(self.residual_stress, dtype=float))
        else:
            number("residual_stress", self.residual_stress, "a finite number", lambda value: True)

    def at(self, depth: float) -> Criteria:
        """The limits with the residual stress at a depth; beyond its table it is constant."""
        if not isinstance(self.residual_stress, tuple):
            return self
        return replace(self, residual_stress=float(np.interp(depth, *self.residual_stress)))

    @property
    def has_fatigue(self) -> bool:
        """True if a fatigue limit is given."""
        return self.fatigue_torsion is not None or self.fatigue_bending is not None

    @property
    def names(self) -> list[str]:
        """Names of the computed numbers, from `NUMBERS`."""
        shakedown = [] if self.yield_stress is None else [*RESIDUALS]
        return ["shear_range", *(["dang_van"] if self.has_fatigue else []), *shakedown]

    @property
    def alpha(self) -> float:
        """Factor of the hydrostatic stress; 0 without fatigue limits."""
        return hydrostatic_factor(self.fatigue_torsion, self.fatigue_bending) if self.has_fatigue else 0.0

    def reduced(self, states: Array, unloaded: bool) -> Array:
        """Range of σ_xz, Dang Van stress and squared radii, (5, points), of stresses (6, points, states)."""
        out, states = np.empty((5, states.shape[1])), in_double_precision(states)
        reduce_rows(states, unloaded, self.has_fatigue, self.yield_stress is not None, self.alpha, out)
        return out

    def over_limit(self, dang_van: Array) -> Array:
        """Dang Van stress including the residual stress, over the limit in torsion."""
        assert not isinstance(self.residual_stress, tuple)
        return (dang_van + self.alpha * 2 / 3 * self.residual_stress) / (self.fatigue_torsion or 1.0)

    def above(self, dang_van: Array) -> Array:
        """Fraction of points whose Dang Van stress is above each of `FATIGUE_SHARES`."""
        rank = np.searchsorted(np.sort(self.over_limit(dang_van)), FATIGUE_SHARES, side="right")
        return 1 - rank / dang_van.size

    def power_means(self, dang_van: Array) -> Array:
        """Power means, (exponents,), of the Dang Van stress over the limit; negative ones are set to 0."""
        share = np.maximum(self.over_limit(dang_van), 0.0)
        return power_means(np.broadcast_to(share[:, None], (share.size, FATIGUE_EXPONENTS.size)))

    def numbers(self, reduced: Array) -> Array:
        """The numbers of `NUMBERS` from the result of `reduced`; meaningless without their limits."""
        limit, found = self.yield_stress or 1.0, reduced.copy()
        found[1] = self.over_limit(reduced[1])
        found[2:] = limit / np.maximum(np.sqrt(1.5 * found[2:]), limit / LARGEST_FACTOR)
        return found


def power_means(values: Array, weights: Array | None = None) -> Array:
    """Power mean along the first axis, (exponents,), of values ≥ 0, (places, exponents)."""
    largest = np.maximum(values.max(axis=0), 1e-300)
    weights = weights if weights is not None and weights.any() else None  # a single plane has none
    mean = np.average((values / largest) ** FATIGUE_EXPONENTS, axis=0, weights=weights)
    return largest * mean ** (1 / FATIGUE_EXPONENTS)


class CycleMaps:
    """Numbers of the histories of a body over the depth and one axis, added plane by plane.

    Parameters
    ----------
    grid : Grid
        Of the contact.
    criteria : Criteria
    across : "y" | "x"
        Axis of the numbers.
    """

    def __init__(self, grid: Grid, criteria: Criteria, across: str = "y") -> None:
        self.criteria, self._across, self.names = criteria, across, criteria.names
        self._positions = grid.coordinates()["yx".index(across)]
        self._depths: list[float] = []
        self._values: list[Array] = []
        self._along: list[Array] = []
        self._above: list[Array] = []
        self._means: list[Array] = []

    def take(
        self,
        depth: float,
        reduced: Array,
        along: Array | None = None,
        dang_van: Array | None = None,
        first: float = 0.0,
    ) -> None:
        """Add a plane.

        Parameters
        ----------
        depth : float
        reduced : (5, rows) array
            As of `Criteria.reduced`.
        along : (5, rows) array, optional
            Places of the points along the rows.
        dang_van : (points,) array, optional
            Dang Van stress of all points; by default of the rows.
        first : float
            Distance of the first row from the edge of the plane, in rows.
        """
        rows, nodes, criteria = reduced.shape[1], self._positions.size, self.criteria.at(depth)
        nearest = np.rint((np.arange(nodes) + first) * (rows / nodes) - first).astype(int) % rows
        self._depths.append(depth)
        self._values.append(criteria.numbers(reduced)[:, nearest])
        if along is not None:
            self._along.append(along[:, nearest])
        if "dang_van" in self.names:
            points = reduced[1] if dang_van is None else dang_van
            self._above.append(criteria.above(points))
            self._means.append(criteria.power_means(points))

    def dataset(self) -> xr.Dataset:
        """The result of `asperity.stress.stress_cycles` from the planes so far."""
        values = dict(zip(NUMBERS, np.stack(self._values, axis=1), strict=True))
        found = {name: values[name] for name in self.names}
        require_finite("stress_cycles", found)
        worst = {}
        for name, field in found.items():
            plane, row = np.unravel_index(
                (field.argmin if name in RESIDUALS else field.argmax)(), field.shape
            )
            worst[f"worst_{name}"] = [
                float(field[plane, row]),
                self._depths[plane],
                float(self._positions[row]),
                *(float(along[NUMBERS.index(name), row]) for along in self._along[plane : plane + 1]),
            ]
        across = f"cycle_{self._across}"
        volume = {}
        coordinates = {"cycle_depth": self._depths, across: self._positions}
        if self._above:
            per_area = np.trapezoid(np.array(self._above), self._depths, axis=0)
            half = np.pad(np.diff(self._depths) / 2, 1)
            mean = power_means(np.array(self._means), half[:-1] + half[1:])
            volume = {
                "fatigue_volume": ("fatigue_share", per_area),
                "fatigue_mean": ("fatigue_exponent", mean),
            }
            coordinates |= {"fatigue_share": FATIGUE_SHARES, "fatigue_exponent": FATIGUE_EXPONENTS}
        maps: dict[str, Any] = {name: (("cycle_depth", across), field) for name, field in found.items()}
        return xr.Dataset(maps | volume, coordinates, worst)


def in_double_precision(states: Array) -> Array:
    """Contiguous stresses in double precision: `reduce_rows` takes ten seconds to compile for each type."""
    return np.ascontiguousarray(states, dtype=float)


@compiled_with_arrays
def reduce_rows(states: Any, unloaded: bool, fatigue: bool, shakedown: bool, alpha: float, out: Any) -> None:
    """Fill `out`, (5, rows), from stresses (6, rows, nodes): range of σ_xz, Dang Van, squared radii.

    The stresses come from `in_double_precision`.
    """
    nodes = states.shape[2]
    points = np.zeros((DIMENSIONS, nodes + (1 if unloaded else 0)))
    centre = np.empty(DIMENSIONS)
    for row in range(states.shape[1]):
        out[:, row] = 0.0
        out[0, row] = fill_points(states, row, unloaded, points)
        # Not literals, for each of which numba would compile the sphere once more.
        if shakedown:
            out[4, row] = smallest_sphere(points, np.int64(1), centre)
            out[3, row] = smallest_sphere(points, np.int64(3), centre)
        if shakedown or fatigue:
            out[2, row] = smallest_sphere(points, np.int64(5), centre)
        if fatigue:
            out[1, row] = _dang_van(states, row, points, centre, alpha)


@compiled
def fill_points(states: Any, row: int, unloaded: bool, points: Any) -> float:
    """Fill the deviators of a history, and return its range of σ_xz."""
    low = high = 0.0 if unloaded else float(states[4, row, 0])
    for n in range(states.shape[2]):
        xx, yy, zz = float(states[0, row, n]), float(states[1, row, n]), float(states[2, row, n])
        points[0, n] = np.sqrt(1.5) * (xx - (xx + yy + zz) / 3)
        points[1, n] = np.sqrt(0.5) * (yy - zz)
        points[2, n] = np.sqrt(2.0) * states[5, row, n]
        points[3, n] = np.sqrt(2.0) * states[4, row, n]
        points[4, n] = np.sqrt(2.0) * states[3, row, n]
        shear = float(states[4, row, n])
        low, high = min(low, shear), max(high, shear)
    return high - low


@compiled_with_arrays
def _dang_van(states: Any, row: int, points: Any, centre: Any, alpha: float) -> float:
    """Largest τ_a + α σ_H of a row.

    A shear stress is √3/2 to 1 of the root of J₂. In between it is above t where the polynomial of Tresca's
    criterion, the product of (σ_i − σ_j)² − 4t² over the three pairs, is positive: principal stresses are
    needed only where the largest value rises.
    """
    count = points.shape[1]
    mean = np.zeros(count)
    second = np.empty(count)
    bound = np.empty(count)
    for n in range(count):
        squared = 0.0
        for k in range(DIMENSIONS):
            squared += (points[k, n] - centre[k]) ** 2
        for k in range(3 if n < states.shape[2] else 0):
            mean[n] += states[k, row, n] / 3.0
        second[n] = 0.5 * squared
        bound[n] = np.sqrt(second[n]) + alpha * mean[n]
    first = int(bound.argmax())
    largest = _shear(points, first, centre) + alpha * mean[first]
    for n in range(count):
        if bound[n] > largest and _may_exceed(points, n, centre, second[n], largest - alpha * mean[n]):
            largest = max(largest, _shear(points, n, centre) + alpha * mean[n])
    return largest


@compiled
def _may_exceed(points: Any, n: int, centre: Any, second: float, limit: float) -> bool:
    """True if the Tresca shear stress of a deviator less the centre, with J₂ `second`, may exceed `limit`."""
    share = limit * limit / second
    if limit < 0 or share <= 0.75:
        return True
    xx, yy, zz, xy, xz, yz = _deviator(points, n, centre)
    third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    criterion = 4.0 - 27.0 * third * third / second**3 - share * (36.0 - share * (96.0 - 64.0 * share))
    return criterion > -1e-12


@compiled
def _deviator(points: Any, n: int, centre: Any) -> Any:
    """Components xx, yy, zz, xy, xz, yz of a deviator less the centre."""
    along = np.sqrt(2 / 3) * (points[0, n] - centre[0])
    across = np.sqrt(0.5) * (points[1, n] - centre[1])
    half = np.sqrt(0.5)
    xy, xz, yz = points[2, n] - centre[2], points[3, n] - centre[3], points[4, n] - centre[4]
    return along, across - along / 2, -across - along / 2, half * xy, half * xz, half * yz


@compiled
def _shear(points: Any, n: int, centre: Any) -> float:
    """Tresca shear stress of a deviator less the centre."""
    xx, yy, zz, xy, xz, yz = _deviator(points, n, centre)
    first, _, third = principal_stresses(xx, yy, zz, yz, xz, xy)
    return 0.5 * (first - third)
