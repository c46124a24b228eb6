"""Numbers of claims that do not depend on random surfaces: from closed forms and finite elements.

The number of a statement of `paper.yaml` has the name of the statement.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asperity.elasticity.layer import Layer
from asperity.paper.claims.numbers import Evidence, Fixed, Measure, MissingEvidenceError

RESOLVED = 10
"""Smallest radius of a circle of contact that counts as resolved, in grid spacings."""

COARSE_GRID = 32
"""Nodes on an edge of the grid that the paper says to suffice."""


def hertz_area(evidence: Evidence) -> Fixed:
    """Largest relative error of the contact radius at given load, where the contact is resolved."""
    found = evidence.dataset("load_area")
    resolved = found.hertz_contact_radius * found.attrs["grid_points"] >= RESOLVED
    error = np.abs(found.solved_contact_radius / found.hertz_contact_radius - 1)
    return Fixed(float(error.where(resolved).max()))


def stiffness_of_poisson(evidence: Evidence) -> Fixed:
    """Load over area at the largest Poisson's ratio over that at the smallest, the smallest of all loads."""
    found = evidence.dataset("load_area").sortby("poisson")
    slope = found.imposed_mean_pressure_young / found.solved_area_fraction
    return Fixed(float((slope[-1] / slope[0]).min()))


def tractions_of_poisson(evidence: Evidence) -> Fixed:
    """Largest relative change of the area with Poisson's ratio at given load over E*."""
    area = evidence.dataset("load_area").solved_area_fraction
    return Fixed(float((area.max("poisson") / area.min("poisson") - 1).max()))


def slab_stiffer_at_depth(evidence: Evidence) -> Fixed:
    """Load of a slab over that of the half-space at the same approach, the smallest over heights."""
    return Fixed(float(evidence.dataset("slab_load_area").slab_stiffening.min()))


def slab_stiffer_at_area(evidence: Evidence) -> Fixed:
    """Load of the cubic slab over that of the half-space at the same, largest, area of contact.

    The load is proportional to the cube of the radius, whose relative error is that on the half-space.
    """
    found = evidence.dataset("slab_load_area")
    cubic = found.isel(slab=int(np.abs(found.slab_height.values - 1).argmin()), step=-1)
    area = np.pi * float(cubic.slab_contact_radius) ** 2
    half_space = float(np.interp(area, found.curve_area_fraction, found.curve_mean_pressure))
    value = float(cubic.slab_mean_pressure) / half_space
    return Fixed(value, 3 * value * hertz_area(evidence).value)


def slab_tractions_of_poisson(evidence: Evidence) -> Fixed:
    """Largest change with ν of E* × compliance of a bonded cubic slab, over waves that fit in the cell."""
    q = 2 * np.pi * np.sqrt(np.arange(1.0, 4096.0))
    ratios = (0.0, 0.25, 0.33, 0.5)
    layers = [Layer(1 - nu**2, nu, height=1.0, bottom="bonded") for nu in ratios]
    compliance = np.array([layer.surface_compliance(q) for layer in layers])
    return Fixed(float((compliance.max(axis=0) / compliance.min(axis=0) - 1).max()))


def coarse_grid(evidence: Evidence) -> Fixed:
    """Relative error of the load at given approach on a grid of 32 × 32 nodes."""
    found = evidence.dataset("grid_convergence")
    if COARSE_GRID not in found.grid_points:
        raise MissingEvidenceError(f"no grid of {COARSE_GRID} × {COARSE_GRID}")
    return Fixed(float(found.slab_load_error.sel(grid_points=COARSE_GRID)))


def punch_of_poisson(evidence: Evidence) -> Fixed:
    """Largest von Mises stress under a punch at the smallest ν over that at the largest.

    Uncertain by the difference to the closed form.
    """
    found = evidence.dataset("punch").sortby("poisson")
    peak, exact = found.peak_von_mises_array.values, found.peak_von_mises_closed_form.values
    return Fixed(float(peak[0] / peak[-1]), float(abs(peak[0] / peak[-1] - exact[0] / exact[-1])))


def _element_difference(fields: Sequence[str], where: Sequence[str]) -> Measure:
    """Largest difference of fields to the finite elements; uncertain by the change over the last two meshes.

    Parameters
    ----------
    fields : names
    where : names
        ``"edge"``: near the edge of contact; ``"away"``: farther away.
    """

    def measure(evidence: Evidence) -> Fixed:
        found = evidence.dataset("elements").sel(field=[*fields])
        coarser, value = np.max([found[f"difference_{part}"].max("field") for part in where], axis=0)[-2:]
        return Fixed(float(value), float(abs(value - coarser)))

    return measure


def elements_at_edge(evidence: Evidence) -> Fixed:
    """Largest difference to the finite elements near the edge of contact over the largest farther away."""
    found = evidence.dataset("elements").isel(mesh=-1)
    return Fixed(float(found.difference_edge.max() / found.difference_away.max()))


_NORMAL, _LATERAL = ("displacement_z", "stress_zz"), ("stress_xx", "stress_xz")

elements_normal = _element_difference(_NORMAL, ("away", "edge"))
elements_lateral = _element_difference(_LATERAL, ("away", "edge"))
elements_away = _element_difference((*_NORMAL, *_LATERAL), ("away",))
