"""Cycles of the stress in a smooth body over which a rough one slides or rolls along x.

In steady motion the stress moves with the rough body: the point at (y, z) of the smooth body sees the row
σ(·, y, z) as its history. A periodic map repeats it; with a free boundary the point is also unloaded, σ = 0.
This is exact for a smooth elastic body under a translating rough one, at the nodes of the row.

Deviators are points of a space of five dimensions whose squared norm is s : s, two thirds of the square of
the von Mises stress; coordinates that a residual stress can change come first.

Dang Van
--------
The elastic cycle is shaken down to one around the centre c of the smallest sphere that encloses its
deviators. The largest τ_a(t) + α σ_H(t), with the Tresca shear stress τ_a of s(t) − c and the mean σ_H of the
normal stresses, stays below the fatigue limit in reversed torsion; α makes that in reversed bending a limit,
too (K. Dang Van, ASTM STP 1191 (1993) 120).

Shakedown
---------
By Melan's theorem a body shakes down to elastic cycles if some residual stress in equilibrium keeps every
stress below yield (K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 9). The yield stress over the
smallest radius is the factor by which the load can rise. Residual stresses that do not change along x are
restricted by equilibrium: ρ_xx(y, z) is free, which gives a lower bound, and nothing else is free at every
point, so that a centre without restriction gives an upper bound. Under a contact that does not change along
y, ρ_xx, ρ_yy and ρ_xy are free, and no other component: the factor with these is exact there.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from asperity.core.arguments import magnitude, require_finite
from asperity.core.compiled import compiled, makes_arrays
from asperity.core.errors import shown
from asperity.core.parallel import results_of
from asperity.core.types import Array, Progress
from asperity.elasticity.layer import COMPONENTS
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.fourier.grid import Grid
from asperity.stress.cycles.smallest_sphere import DIMENSIONS, smallest_sphere
from asperity.stress.planes.fields import MARGIN, principal_stresses
from asperity.stress.planes.planes import depth_grid
from asperity.stress.planes.stream import PLANE_TOLERANCE, LinearPlane, PlaneStream, uniform_part

FATIGUE_RATIOS = (0.5, 1.0)
"""Accepted fatigue limits in torsion over bending: at 1/2 (α = 0) the hydrostatic stress has no effect, and
at 1 (α = 3/2) that of a tensile stress is as large as that of its shear stress; ductile metals have 0.55 to
0.75."""

LARGEST_FACTOR = 1e12
"""Factor of shakedown of a row whose stress hardly changes, where it would be infinite."""

RESIDUALS = {"shakedown_upper": 5, "shakedown_line": 3, "shakedown_lower": 1}
"""Shakedown factor → number of coordinates that the residual stress can change."""


def stress_cycles(
    contact: ContactLike,
    depths: ArrayLike | None = None,
    poisson: float | None = None,
    *,
    fatigue_torsion: float | None = None,
    fatigue_bending: float | None = None,
    yield_stress: float | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    tolerance: float = PLANE_TOLERANCE,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Range, fatigue and shakedown of the stress in a smooth body under a rough one that moves along x.

    Parameters
    ----------
    contact, depths, tolerance, threads, progress
        As for `analyse_stress`; the first depth need not be 0.
    poisson : float, optional
        By default that of the contact.
    fatigue_torsion, fatigue_bending : float, optional
        Fatigue limits in fully reversed torsion and bending, in the unit of the pressure; both or none.
        Torsion over bending is 0.5 to 1.
    yield_stress : float, optional
        In the unit of the pressure.
    friction, sliding_direction
        As for `stress_planes`; the direction is ``"x"``, 0 or 180.

    Returns
    -------
    dataset
        Over ``cycle_depth`` and ``cycle_y``, (depths, rows of the contact): ``shear_range``, the range of
        σ_xz, in the unit of the pressure; with fatigue limits ``dang_van``, the largest stress of Dang Van
        over the limit in torsion; with a yield stress ``shakedown_upper``, ``shakedown_line`` and
        ``shakedown_lower``, the factors of the load up to elastic shakedown: an upper bound, the exact one
        under a contact that does not change along y, and a lower bound. Rows of a plane on a coarser grid
        stand at all rows of the contact to which they are nearest, so that none is lost. The attribute
        ``worst_shear_range`` is the largest value, its depth and y; so are the others, of the factors the
        smallest.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    A cylinder along y, in line contact:

    >>> height = asp.add_cylinder(np.zeros((16, 256)), (0.0625, 1.0), 1.0, axis="y")
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), (0.0625, 1.0), area_fraction=0.1)
    >>> cycles = asp.stress_cycles(contact, yield_stress=3**0.5)  # k = 1
    >>> share = cycles.attrs["worst_shear_range"][0] / contact.pressure.max()
    >>> limit = cycles.attrs["worst_shakedown_upper"][0] * contact.pressure.max()
    >>> print(f"range of τ_xz {share:.2f} p₀, shakedown limit {limit:.1f} k")
    range of τ_xz 0.50 p₀, shakedown limit 4.0 k
    """
    solid = LoadedSolid.of(contact)
    if depths is None:
        depths = depth_grid(solid.grid, solid.layer.extent, interface=solid.layer.interface)
    settings = tolerance, threads, None, friction, sliding_direction
    stream = PlaneStream(solid, depths, poisson, ("von_mises",), *settings)
    limits = fatigue_torsion, fatigue_bending, yield_stress
    cycles = Cycles(solid, *limits, sliding_direction, stream.ratios[0], threads)
    for plane in stream.planes(progress):
        cycles.add(plane)
    return cycles.dataset()


def hydrostatic_factor(fatigue_torsion: float | None, fatigue_bending: float | None) -> float:
    """The factor α of the hydrostatic stress, which makes reversed bending reach its own limit.

    Raises
    ------
    ValueError
        If one of the limits is missing or their ratio is not in `FATIGUE_RATIOS`.

    Examples
    --------
    >>> from asperity.stress.cycles.smooth_body import hydrostatic_factor
    >>> print(f"{hydrostatic_factor(300e6, 480e6):.3f}")
    0.375
    """
    given = {"fatigue_torsion": fatigue_torsion, "fatigue_bending": fatigue_bending}
    for name, value in given.items():
        if value is None:
            raise ValueError(f"{name}: missing; both fatigue limits are needed, of torsion and of bending")
        magnitude(name, value)
    torsion, bending = map(float, given.values())  # type: ignore[arg-type]
    low, high = FATIGUE_RATIOS
    if not low * (1 - 1e-12) <= torsion / bending <= high * (1 + 1e-12):
        share = torsion / bending
        raise ValueError(
            f"fatigue_torsion: {low:g} to {high:g} times fatigue_bending is needed, got {share:.4g} times"
        )
    return 3 * (torsion / bending - 0.5)


def check_motion(sliding_direction: Any) -> None:
    """Raise `ValueError` for a direction of sliding that is not along x."""
    along = sliding_direction == "x" or (
        not isinstance(sliding_direction, str) and sliding_direction % 180 == 0
    )
    if not along:
        raise ValueError(
            f"sliding_direction = {shown(sliding_direction)}: x, 0 or 180 is needed for stress cycles, whose "
            "motion is along x"
        )


class Cycles:
    """Cycles of the stress from planes that are streamed anyway, as those of `analyse_stress`.

    Parameters
    ----------
    solid : LoadedSolid
    fatigue_torsion, fatigue_bending, yield_stress, sliding_direction, threads
        As for `stress_cycles`.
    poisson : float
    """

    def __init__(
        self,
        solid: LoadedSolid,
        fatigue_torsion: float | None,
        fatigue_bending: float | None,
        yield_stress: float | None,
        sliding_direction: str | float,
        poisson: float,
        threads: int = 1,
    ) -> None:
        check_motion(sliding_direction)
        self._names, self._alpha, self._torsion = ["shear_range"], 0.0, 1.0
        if fatigue_torsion is not None or fatigue_bending is not None:
            self._alpha = hydrostatic_factor(fatigue_torsion, fatigue_bending)
            self._torsion = float(fatigue_torsion or 1.0)
            self._names.append("dang_van")
        self._yield = 1.0
        if yield_stress is not None:
            self._yield = magnitude("yield_stress", yield_stress)
            self._names += RESIDUALS
        self._grid: Grid = solid.grid
        self._poisson, self._threads = poisson, threads
        self._is_unloaded = solid.boundary == "free"
        self._depths: list[float] = []
        self._values: list[Array] = []

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        count = len(COMPONENTS)
        uniform = uniform_part(plane.solid.layer, self._poisson, plane.depth)
        fields = plane.fields(COMPONENTS, [self._poisson] * count, [uniform] * count)
        ny, nx = plane.grid.shape
        rows = max(1, 2**13 // nx)
        fatigue, shakedown = "dang_van" in self._names, "shakedown_upper" in self._names

        def reduced(first: int) -> Array:
            states = fields.rows(first, min(first + rows, ny))[:, :, MARGIN : MARGIN + nx]
            out = np.empty((5, states.shape[1]))
            _reduce_rows(states, self._is_unloaded, fatigue, shakedown, self._alpha, out)
            return out

        strips = results_of([partial(reduced, first) for first in range(0, ny, rows)], self._threads)
        found = np.concatenate(list(strips), axis=1)
        found[1] /= self._torsion
        found[2:] = self._yield / np.maximum(np.sqrt(1.5 * found[2:]), self._yield / LARGEST_FACTOR)
        nodes = self._grid.shape[0]
        nearest = np.rint(np.arange(nodes) * (ny / nodes)).astype(int) % ny
        self._depths.append(plane.depth)
        self._values.append(found[:, nearest])

    def dataset(self) -> xr.Dataset:
        """The result of `stress_cycles` from the planes so far."""
        values = np.stack(self._values, axis=1)
        y = np.arange(self._grid.shape[0]) * self._grid.spacing[0]
        every = dict(zip(("shear_range", "dang_van", *RESIDUALS), values, strict=True))
        found = {name: every[name] for name in self._names}
        require_finite("stress_cycles", found)
        worst = {}
        for name, field in found.items():
            place = (field.argmin if name in RESIDUALS else field.argmax)()
            plane, row = np.unravel_index(place, field.shape)
            worst[f"worst_{name}"] = [float(field[plane, row]), self._depths[plane], float(y[row])]
        return xr.Dataset(
            {name: (("cycle_depth", "cycle_y"), field) for name, field in found.items()},
            {"cycle_depth": self._depths, "cycle_y": y},
            worst,
        )


@makes_arrays
def _reduce_rows(states: Any, unloaded: bool, fatigue: bool, shakedown: bool, alpha: float, out: Any) -> None:
    """Fill `out`, (5, rows), from stresses (6, rows, nodes): range of σ_xz, Dang Van, squared radii."""
    nodes = states.shape[2]
    points = np.zeros((DIMENSIONS, nodes + (1 if unloaded else 0)))
    centre = np.empty(DIMENSIONS)
    for row in range(states.shape[1]):
        low = high = 0.0 if unloaded else states[4, row, 0]
        for n in range(nodes):
            xx, yy, zz = float(states[0, row, n]), float(states[1, row, n]), float(states[2, row, n])
            points[0, n] = np.sqrt(1.5) * (xx - (xx + yy + zz) / 3)
            points[1, n] = np.sqrt(0.5) * (yy - zz)
            points[2, n] = np.sqrt(2.0) * states[5, row, n]
            points[3, n] = np.sqrt(2.0) * states[4, row, n]
            points[4, n] = np.sqrt(2.0) * states[3, row, n]
            low, high = min(low, states[4, row, n]), max(high, states[4, row, n])
        out[:, row] = 0.0
        out[0, row] = high - low
        if shakedown:
            out[4, row] = smallest_sphere(points, 1, centre)
            out[3, row] = smallest_sphere(points, 3, centre)
        if shakedown or fatigue:
            out[2, row] = smallest_sphere(points, 5, centre)
        if fatigue:
            out[1, row] = _dang_van(states, row, points, centre, alpha)


@makes_arrays
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
    """Whether the Tresca shear stress of a deviator less the centre, with J₂ `second`, exceeds `limit`."""
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
