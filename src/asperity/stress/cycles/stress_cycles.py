"""Cycles of the stress: a smooth body under a moving rough one, or a body whose pressure changes.

In steady motion along x the stress moves with the rough body: the history of the stress at the point (y, z)
of the smooth body is the row σ(·, y, z), and for motion along y the column. With a periodic map the
history repeats; along an axis where the map ends the point is also unloaded, σ = 0. This is exact for a
smooth elastic body under a translating rough one, at the nodes of the row. Histories of two rough bodies are
in `asperity.stress.cycles.histories`.

Survival
--------
In the weakest-link model a body survives if each of its volumes does. With a Weibull-distributed limit whose
mean is t₋₁ for specimens of the stressed volume V₀, the expected number of cracks per nominal area is

    n_c = 1/V₀ ∫ (Γ(1 + 1/m) d)^m dz,    averaged over the area,

with the Dang Van stress d over the limit, and no crack starts on an area A with the probability e^(−n_c A)
(W. Weibull, J. Appl. Mech. 18 (1951) 293; the integral over the stressed volume in rolling contact is that
of E. Ioannides, T. A. Harris, J. Tribol. 107 (1985) 367, DOI 10.1115/1.3261081, here without life and
threshold). The exponent m follows from the coefficient of variation, √(Γ(1 + 2/m)/Γ(1 + 1/m)² − 1). The
integral is that of the trapezoidal rule over the planes, of means over all points of each.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import scipy  # submodules are imported at first use
import xarray as xr

from asperity.core.arguments import magnitude, number
from asperity.core.errors import shown
from asperity.core.parallel import run_tasks
from asperity.core.types import Array, ArrayLike, Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.elasticity.solid import COMPONENTS
from asperity.fourier.grid import BOUNDARIES
from asperity.stress.cycles.criteria import Criteria, CycleMaps
from asperity.stress.cycles.histories import Histories, MovingPressure
from asperity.stress.planes.fields import ROW_MARGIN
from asperity.stress.planes.planes import default_depths
from asperity.stress.planes.stream import PLANE_TOLERANCE, LinearPlane, PlaneStream, uniform_part

TURNED = [1, 0, 2, 4, 3, 5]
"""Components of the stress if x and y change places."""

SCATTERS = (0.01, 1.0)
"""Accepted coefficients of variation; fatigue limits of steels have 0.03 to 0.15."""


def axis_of_motion(sliding_direction: str | float) -> str:
    """Axis along which a body moves, ``"x"`` or ``"y"``; `ValueError` for another direction."""
    if sliding_direction in ("x", "y"):
        return str(sliding_direction)
    if isinstance(sliding_direction, str) or sliding_direction % 90:
        raise ValueError(
            f"sliding_direction = {shown(sliding_direction)}: x, y or a multiple of 90 is needed for the "
            "stress cycles of a smooth body; another angle of the grid with shifts"
        )
    return "y" if sliding_direction % 180 else "x"


class Cycles(CycleMaps):
    """Cycles of the stress in a smooth body from planes that are streamed anyway, as by `analyse_stress`.

    Parameters
    ----------
    solid : LoadedSolid
    criteria : Criteria
    sliding_direction : "x", "y" or float
        As of `axis_of_motion`.
    poisson : float
    threads : int
    below : float
        Planes that are not deeper are left out, such as those of a coating.
    passing : callable, optional
        Depth → stress (6, places) of further states of every point, which is also unloaded, such as those on
        its way through a smooth Hertz contact.
    """

    def __init__(
        self,
        solid: LoadedSolid,
        criteria: Criteria,
        sliding_direction: str | float,
        poisson: float,
        threads: int = 1,
        below: float = -1.0,
        passing: Callable[[float], Array] | None = None,
    ) -> None:
        self._turned = axis_of_motion(sliding_direction) == "y"
        super().__init__(solid.grid, criteria, "x" if self._turned else "y")
        self._poisson, self._threads, self._below = poisson, threads, below
        across, along = (1, 0) if self._turned else (0, 1)
        self._is_unloaded, self._passing = BOUNDARIES[solid.boundary][along] or passing is not None, passing
        self._images = solid.grid.images[across]

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        if plane.depth <= self._below:
            return
        count, (ny, nx) = len(COMPONENTS), plane.grid.shape
        uniform = uniform_part(plane.solid.layer, self._poisson, plane.depth)
        fields = plane.fields(COMPONENTS, [self._poisson] * count, [uniform] * count)
        turned = fields.whole()[TURNED].transpose(0, 2, 1) if self._turned else None
        if turned is not None:
            ny, nx = nx, ny
        rows = max(1, 2**13 // nx)
        passing = np.zeros((count, 0)) if self._passing is None else self._passing(plane.depth)
        if self._turned:
            passing = passing[TURNED]

        def reduced(first: int) -> Array:
            last = min(first + rows, ny)
            if turned is not None:
                states = turned[:, first:last]
            else:
                states = fields.rows(first, last)[:, :, ROW_MARGIN : ROW_MARGIN + nx]
            if plane.grid.mirrored:  # then the images pass, in which σ_xz and σ_xy have the other sign
                images = states * np.array([1, 1, 1, 1, -1, -1], states.dtype)[:, None, None]
                states = np.concatenate([states, images], axis=2)
            others = np.broadcast_to(passing[:, None], (count, states.shape[1], passing.shape[1]))
            states = np.concatenate([states, others], axis=2)
            return self.criteria.reduced(states, self._is_unloaded)

        if not plane.grid.mirrored:  # perhaps a plane of the whole cell
            ny //= self._images
        strips = run_tasks([partial(reduced, first) for first in range(0, ny, rows)], self._threads)
        found = np.concatenate(list(strips), axis=1)
        self.take(plane.depth, found, first=0.5 if plane.grid.mirrored else 0.0)


def stress_cycles(
    contact: ContactLike | MovingPressure,
    depths: ArrayLike | None = None,
    poisson: float | None = None,
    *,
    fatigue_torsion: float | None = None,
    fatigue_bending: float | None = None,
    yield_stress: float | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    residual_stress: float | tuple[Sequence[float], Sequence[float]] = 0.0,
    tolerance: float = PLANE_TOLERANCE,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Range, fatigue and shakedown of the stress in a smooth body under a rough one that moves along x or y.

    Fatigue by K. Dang Van, ASTM STP 1191 (1993) 120; bounds of the shakedown by Melan's theorem (K. L.
    Johnson, *Contact Mechanics*, 1985, chapter 9).

    Parameters
    ----------
    contact
        As for `analyse_stress`; or a `MovingPressure`, as of `asperity.engineering.MovingContact`, whose
        friction and direction are used.
    depths, tolerance, threads, progress
        As for `analyse_stress`; the first depth need not be 0.
    poisson : float, optional
        By default the contact's.
    fatigue_torsion, fatigue_bending : float, optional
        Fatigue limits in fully reversed torsion and bending, in the unit of the pressure; both or none.
        Torsion over bending is 0.5 to 1.
    yield_stress : float, optional
        In the unit of the pressure.
    friction, sliding_direction
        As for `stress_planes`; the direction is also the direction of the motion, along x or along y.
    residual_stress : float or (depths, stresses)
        Equal normal stress along x and y in the unloaded body, compression negative, or a table of it over
        depth, which is linear between its rows and constant beyond them. The cycle after
        shakedown does not depend on it; two thirds of it add to the mean stress in the Dang Van stress.

    Returns
    -------
    dataset
        Over ``cycle_depth`` and ``cycle_y`` (``cycle_x`` if a rough body moves along y over a smooth one),
        (depths, rows of the contact): ``shear_range``, the range of the shear stress on planes of constant
        z in the direction of motion, in the unit of the pressure; with fatigue limits ``dang_van``, the
        maximum stress of Dang Van over the limit in torsion; with a yield stress ``shakedown_upper``,
        ``shakedown_line`` and ``shakedown_lower``, the factors of the load up to elastic shakedown: an
        upper bound, the exact one under a contact that does not change along y, and a lower bound. Each
        row of a plane on a coarser grid is repeated at all rows of the contact nearest to it. The
        attribute ``worst_shear_range`` holds the largest value, its depth and y, and likewise ``worst_…``
        of the others; of factors the smallest value. With fatigue limits ``fatigue_volume`` is the volume
        per nominal area whose Dang Van stress is above a ``fatigue_share`` of the limit. Of a
        `MovingPressure` each value is the worst along x, ``worst_…`` names x, too, there is no
        ``shakedown_line``, ``few_shifts_error`` estimates the relative error of the worst values, twice
        their largest change with half of the states, as a mean over both halves, and ``fatigue_volume`` is
        an upper bound below half of the largest value.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    A cylinder along y, in line contact:

    >>> height = asp.surface.add_cylinder(np.zeros((16, 256)), (0.0625, 1.0), 1.0, axis="y")
    >>> solid = asp.Solid(young=1.0, poisson=0.3)
    >>> contact = asp.solve_contact(height, solid, (0.0625, 1.0), contact_area_fraction=0.1)
    >>> cycles = asp.stress.stress_cycles(contact, yield_stress=3**0.5)  # k = 1
    >>> share = cycles.attrs["worst_shear_range"][0] / contact.pressure.max()
    >>> limit = cycles.attrs["worst_shakedown_upper"][0] * contact.pressure.max()
    >>> print(f"range of τ_xz {share:.2f} p₀, shakedown limit {limit:.1f} k")
    range of τ_xz 0.50 p₀, shakedown limit 4.0 k
    """
    criteria = Criteria(fatigue_torsion, fatigue_bending, yield_stress, residual_stress)
    if isinstance(contact, MovingPressure):
        histories = Histories(contact, criteria, depths, tolerance, threads)
        histories.run(progress)
        return histories.dataset()
    solid = LoadedSolid.of(contact)
    if depths is None:
        depths = default_depths(solid)
    settings = tolerance, threads, None, friction, sliding_direction
    stream = PlaneStream(solid, depths, poisson, ("von_mises",), *settings)
    cycles = Cycles(solid, criteria, sliding_direction, stream.ratios[0], threads)
    for plane in stream.planes(progress):
        cycles.add(plane)
    return cycles.dataset()


def weibull_exponent(scatter: float) -> float:
    """Exponent m of the Weibull distribution with a coefficient of variation.

    Examples
    --------
    >>> from asperity.stress.cycles.stress_cycles import weibull_exponent
    >>> print(f"{weibull_exponent(0.1):.2f} {weibull_exponent(1.0):.2f}")
    12.15 1.00
    """
    low, high = SCATTERS
    accepted = f"a number from {low:g} to {high:g}"
    number("scatter", scatter, accepted, lambda value: low <= value <= high)

    def excess(logarithm: float) -> float:
        inverse = np.exp(-logarithm)
        return float(
            np.expm1(scipy.special.gammaln(1 + 2 * inverse) - 2 * scipy.special.gammaln(1 + inverse))
            - scatter**2
        )

    return float(np.exp(scipy.optimize.brentq(excess, -0.1, 6.0, xtol=1e-14)))


def cracks_per_area(cycles: xr.Dataset, scatter: float, volume: float) -> float:
    """Expected number of cracks per nominal area, n_c; none starts on an area A with probability e^(−n_c A).

    n_c = (1/V₀) ∫ (Γ(1 + 1/m) d)^m dz with the Dang Van stress d over the limit and Weibull's exponent m:
    E. Ioannides and T. A. Harris, J. Tribol. 107 (1985) 367.

    Parameters
    ----------
    cycles : dataset
        Of `asperity.stress.stress_cycles` with fatigue limits.
    scatter : float
        Coefficient of variation of the fatigue limit, from 0.01 to 1. The smaller it is, the more the few
        highest points count: at 0.1, 0.05, 0.02 and 0.01 the distance of the planes of
        `asperity.stress.depth_grid`, with 8 nodes on the shortest wave, causes errors of up to 6, 14, 55 and
        95 %. If the highest points lie in the surface, as with much friction, only the order of magnitude is
        known.
    volume : float
        Stressed volume of the specimens on which limits and scatter were measured, in the unit of length of
        the contact cubed.

    Returns
    -------
    float
        Cracks per area, in one over the unit of length of the contact squared.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the cycles have no Dang Van stress.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 2e-4, mean_pressure=20e6)
    >>> cycles = asp.stress.stress_cycles(contact, fatigue_torsion=300e6, fatigue_bending=480e6)
    >>> cracks = asp.stress.cracks_per_area(cycles, scatter=0.1, volume=1e-8)
    >>> bool(0 < np.exp(-cracks * 1e-6) < 1)
    True
    """
    if "fatigue_mean" not in cycles:
        raise ValueError("cycles: a result of stress_cycles with fatigue limits is needed")
    exponent, depths = weibull_exponent(scatter), cycles["cycle_depth"].values
    means = np.maximum(cycles["fatigue_mean"].values, 1e-300)  # nothing is above 0 under enough compression
    log_mean = scipy.interpolate.CubicSpline(np.log(cycles["fatigue_exponent"].values), np.log(means))
    power = np.exp(exponent * (scipy.special.gammaln(1 + 1 / exponent) + log_mean(np.log(exponent))))
    total = power * (depths[-1] - depths[0])
    return float(total / magnitude("volume", volume))
