"""Check of a contact solution that does not trust the solver: certificate, direct solution, energy bound.

A solution holds if

* its certificate, recomputed in double precision from the pressure, violates the conditions of contact by at
most
  `ALLOWED` times the tolerance, or by what a pressure error of that size can do to the gap, and
* its pressure differs from the exact solution by at most `ALLOWED` times the tolerance, relative to the norm
of the
  pressure. The exact solution is the direct one of `asperity.reference.pivoting` with up to `DIRECT_NODES`
  contact nodes; otherwise the difference is bounded in the norm of the elastic energy.

The bound rests on this: the inverse of the compliance restricted to the contact nodes is at most the same
restriction of the inverse of the whole compliance. The remaining gap in contact, multiplied by the stiffness
of the whole layer, therefore bounds the energy of the error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact import Contact, verify_contact
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.fourier.grid import Grid
from asperity.reference.pivoting import PivotingError, pivot

ALLOWED = 10.0
"""Allowed violation of the conditions of contact and error of the pressure, in units of the tolerance."""

DIRECT_NODES = 700
"""Limit on the contact nodes of a solution that is compared with the direct one, whose matrix is dense."""


@dataclass(frozen=True)
class SolutionCheck:
    """Result of a check.

    Attributes
    ----------
    violation : float
        Violation of the conditions of contact, in units of the tolerance.
    error : float
        Error of the pressure or its bound, in units of the tolerance; NaN if the violation is too large
        already.
    direct : bool
        True if the error is that against the direct solution.
    holds : bool
        True if violation and error are allowed.
    reason : str
        Why the solution does not hold or was not compared with the direct one.
    """

    violation: float
    error: float = math.nan
    direct: bool = False
    holds: bool = False
    reason: str = ""


def check_solution(contact: Contact, imposed: dict[str, Any], tolerance: float) -> SolutionCheck:
    """Check of a solution by its certificate and by the direct solution or the energy bound.

    Parameters
    ----------
    contact : Contact
    imposed : dict
        The imposed quantity as a keyword of `asperity.solve`.
    tolerance : float
        Tolerance of the solution.
    """
    given = {kind: amount for kind, amount in imposed.items() if kind != "area_fraction"}
    certificate = verify_contact(
        contact.height, contact.pressure, contact.layer, **({"approach": contact.approach} | given)
    )
    violation = certificate.worst / tolerance / max(1.0, gap_change_per_tolerance(contact))
    if not violation <= ALLOWED:
        return SolutionCheck(violation, reason=str(certificate))
    error, direct, reason = energy_error(contact, **given), False, ""
    touching = contact.pressure > 0
    if np.count_nonzero(touching) <= DIRECT_NODES:
        known = given or {"mean_pressure": contact.mean_pressure}
        compliance = mode_compliance(contact.layer, contact.grid)
        try:
            exact = pivot(contact.height, compliance, guess=touching, **known)
            error, direct = _relative_difference(contact.pressure, exact), True
        except PivotingError as failure:
            reason = str(failure)
    error /= tolerance
    holds = error <= ALLOWED
    reason = reason if holds else f"pressure off by {error:.3g} times the tolerance"
    return SolutionCheck(violation, error, direct, holds, reason)


def energy_error(
    contact: Contact, *, approach: float | None = None, mean_pressure: float | None = None
) -> float:
    """Bound of the error of a pressure in the norm of the elastic energy, relative to that of the pressure.

    A uniform pressure that has no energy is counted by its size relative to the varying part.
    """
    grid = contact.grid
    compliance = mode_compliance(contact.layer, grid)
    if mean_pressure is not None:
        # At a given load the mean mode changes only the approach.
        compliance[0, 0] = 0
    stiffness = np.divide(1, compliance, out=np.zeros_like(compliance), where=compliance > 0)
    spectrum = np.fft.rfft2(contact.pressure.astype(float))
    gap = contact.height + np.fft.irfft2(compliance * spectrum, grid.shape)
    touching = contact.pressure > 0
    gap -= np.mean(gap[touching]) if approach is None and touching.any() else (approach or gap.min())
    remaining = np.fft.rfft2(np.where(touching, gap, np.minimum(gap, 0)))
    power = np.abs(spectrum) ** 2 * grid.multiplicity
    missing_energy = float(np.sum(stiffness * np.abs(remaining) ** 2 * grid.multiplicity))
    energy = float(np.sum(compliance * power))
    counted = float(np.sum(power[compliance > 0]) / np.sum(power)) if energy else 0.0
    return math.sqrt(missing_energy / energy * counted) if energy else 0.0


def gap_change_per_tolerance(contact: Contact) -> float:
    """Largest change of the gap by a pressure error of the size of the tolerance.

    In units of the tolerance and of the rms height. It is large far beyond full contact.
    """
    compliance = mode_compliance(contact.layer, contact.grid)
    compliance[0, 0] = 0
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    return norm * float(compliance.max()) / float(np.std(contact.height, dtype=float))


def mode_compliance(layer: Layer, grid: Grid) -> Array:
    """Surface compliance of every stored mode, (ny, nx // 2 + 1)."""
    return layer.surface_compliance(grid.wavenumber())


def _relative_difference(pressure: Array, exact: Array) -> float:
    """Norm of the difference over that of the exact pressure, scaled first so that no square underflows."""
    scale = float(exact.max()) or 1.0
    size, difference = (float(np.linalg.norm(p / scale)) for p in (exact, pressure - exact))
    return difference / (size or 1.0)
