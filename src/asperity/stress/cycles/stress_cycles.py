"""Cycles of the stress: a smooth body under a moving rough one, or a body whose pressure changes."""

from __future__ import annotations

import xarray as xr

from asperity.core.types import ArrayLike, Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.stress.cycles.criteria import Criteria
from asperity.stress.cycles.histories import Histories, MovingPressure
from asperity.stress.cycles.smooth_body import Cycles
from asperity.stress.planes.planes import depth_grid
from asperity.stress.planes.stream import PLANE_TOLERANCE, PlaneStream


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
    residual_stress: float = 0.0,
    tolerance: float = PLANE_TOLERANCE,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Range, fatigue and shakedown of the stress in a smooth body under a rough one that moves along x or y.

    Parameters
    ----------
    contact
        As for `analyse_stress`; or a `MovingPressure`, as of `asperity.MovingContact`, whose friction and
        direction count.
    depths, tolerance, threads, progress
        As for `analyse_stress`; the first depth need not be 0.
    poisson : float, optional
        By default that of the contact.
    fatigue_torsion, fatigue_bending : float, optional
        Fatigue limits in fully reversed torsion and bending, in the unit of the pressure; both or none.
        Torsion over bending is 0.5 to 1.
    yield_stress : float, optional
        In the unit of the pressure.
    friction, sliding_direction
        As for `stress_planes`; the direction is also that of the motion, along x or along y.
    residual_stress : float
        Equal normal stress along x and y in the unloaded body, compression negative. The cycle after
        shakedown does not depend on it; two thirds of it add to the mean stress in the Dang Van stress.

    Returns
    -------
    dataset
        Over ``cycle_depth`` and ``cycle_y`` (``cycle_x`` if a rough body moves along y over a smooth one),
        (depths, rows of the contact): ``shear_range``, the range of the shear stress across z in the
        direction of motion, in the unit of the pressure; with fatigue limits ``dang_van``, the largest stress
        of Dang Van over the limit in torsion; with a yield stress ``shakedown_upper``, ``shakedown_line`` and
        ``shakedown_lower``, the factors of the load up to elastic shakedown: an upper bound, the exact one
        under a contact that does not change along y, and a lower bound. Each row of a plane on a coarser grid
        is repeated at all rows of the contact nearest to it. The attribute ``worst_shear_range`` holds the
        largest value, its depth and y, and likewise ``worst_…`` of the others; of factors the smallest value.
        With fatigue limits ``fatigue_volume`` is the volume per nominal area whose Dang Van stress is above a
        ``fatigue_share`` of the limit. Of a `MovingPressure` each value is the worst along x, ``worst_…``
        names x, too, there is no ``shakedown_line``, ``few_shifts_error`` estimates the relative error of the
        worst values, twice their largest change with half of the states, as a mean over both halves, and
        ``fatigue_volume`` is an upper bound below half of the largest value.

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
    criteria = Criteria(fatigue_torsion, fatigue_bending, yield_stress, residual_stress)
    if isinstance(contact, MovingPressure):
        histories = Histories(contact, criteria, depths, tolerance, threads)
        histories.run(progress)
        return histories.dataset()
    solid = LoadedSolid.of(contact)
    if depths is None:
        depths = depth_grid(solid.grid, solid.layer.extent, interface=solid.layer.interface)
    settings = tolerance, threads, None, friction, sliding_direction
    stream = PlaneStream(solid, depths, poisson, ("von_mises",), *settings)
    cycles = Cycles(solid, criteria, sliding_direction, stream.ratios[0], threads)
    for plane in stream.planes(progress):
        cycles.add(plane)
    return cycles.dataset()
