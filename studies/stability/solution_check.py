"""Check of a contact solution that does not trust the solver: certificate, direct solution, energy bound.

A solution holds if

* its pressure is between zero and the hardness,
* no load has a number of contact nodes nearer to an imposed one,
* its certificate, recomputed in double precision from the pressure, violates the conditions of contact at no
  node by more than `ALLOWED_AT_NODE` times the tolerance, or by what a pressure error of that size can do to
  the gap, and the load is met to `ALLOWED` tolerances, and
* its pressure differs from the exact solution by at most `ALLOWED` times the tolerance, relative to the norm
  of the pressure. The exact solution is the direct one of `asperity.reference.pivoting` with up to
  `DIRECT_NODES` contact nodes; otherwise the difference is bounded in the norm of the elastic energy.

The certificate is computed for heights that are cut off above the reach of the displaced surface, for which
the pressure is the same: otherwise nodes that nothing touches would set the scale of its lengths. Heights are
measured from the lowest one.

The bound follows from two facts: a pressure is the exact one for heights that are reduced by the error of
its gap, and a change of the heights changes the exact pressure by at most the inverse of the compliance
times that change, in the norm of the energy. The inverse of a compliance restricted to some nodes is at
most the same restriction of the inverse. With a free boundary it is the inverse of a dense matrix, up to
`FREE_NODES`.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from asperity.contact import Contact, solve_contact, verify_contact
from asperity.core.types import Array
from asperity.elasticity.loaded_rectangle import surface_influence
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import BOUNDARIES, Grid
from asperity.reference.pivoting import PivotingError, pivot

ALLOWED = 10.0
"""Allowed error of the pressure, by its norm, and of the load, in units of the tolerance."""

ALLOWED_AT_NODE = 100.0
"""Allowed violation of the conditions of contact at a single node, in units of the tolerance."""

AREA_ERROR = 1e-4
"""Relative error of the number of contact nodes to which `asperity.solve_contact` meets an imposed area."""

DIRECT_NODES = 700
"""Limit on the contact nodes of a solution that is compared with the direct one, whose matrix is dense."""

FREE_NODES = 1100
"""Limit on the nodes of a map with a free boundary whose error is bounded."""


@dataclass(frozen=True)
class SolutionCheck:
    """Result of a check: violation of the conditions and error of the pressure, in units of the tolerance.

    `error` is a bound unless the solution was compared with a direct one (`direct`). It is NaN if the
    violation is too large already, and on a free map of many nodes. `reason` says why the solution does not
    hold, or why it was not compared.
    """

    violation: float
    error: float = math.nan
    direct: bool = False
    holds: bool = False
    reason: str = ""


def check_solution(
    contact: Contact, imposed: dict[str, Any], tolerance: float, given: Array | None = None
) -> SolutionCheck:
    """Check of a solution by its certificate and by the direct solution or the energy bound.

    `imposed` is the imposed quantity as a keyword of `asperity.solve_contact`. A solution in single precision
    may also hold for the heights `given` to the solver, instead of for its rounded ones.
    """
    found = _checked(contact, contact.height.astype(float), imposed, tolerance)
    if found.holds or given is None or contact.height.dtype == np.float64:
        return found
    return _checked(contact, given, imposed, tolerance)


def _checked(contact: Contact, height: Array, imposed: dict[str, Any], tolerance: float) -> SolutionCheck:
    """Check of a solution as a solution for some heights."""
    pressure = contact.pressure.astype(float)
    if not 0 <= pressure.min() <= pressure.max() <= contact.hardness:
        return SolutionCheck(math.inf, reason="a pressure is not between zero and the hardness")
    precision = float(np.finfo(contact.pressure.dtype).eps)
    whole, lowest = height, float(height.min())
    height = whole - lowest
    known = dict(imposed)
    if "approach" in known:
        known["approach"] -= lowest
    if "force" in known:
        known = {"mean_pressure": known["force"] / contact.grid.area}
    known.pop("contact_area_fraction", None)
    touching = pressure > 0
    if touching.any():
        displacement = contact.displacement.astype(float)
        elastic = touching & (pressure < contact.hardness)
        found = (height + displacement)[elastic].max(initial=-math.inf)
        level = known.get("approach", float(found) if elastic.any() else contact.approach - lowest)
        height = np.minimum(height, 2 * (level - float(displacement.min())))
    # In single precision the heights within reach are rounded.
    rounding = precision * float(height.max()) if precision > 1e-10 else 0.0
    certificate = verify_contact(
        height,
        pressure,
        contact.solid,
        contact.grid.length,
        hardness=None if math.isinf(contact.hardness) else contact.hardness,
        boundary=contact.boundary,
        **{"approach": contact.approach - lowest} | known,
    )
    spacing = min(contact.grid.spacing)
    scale = float(np.std(height)) or float(pressure.max()) * spacing / contact.solid.effective_modulus or 1.0
    change = gap_change_per_tolerance(contact) / scale
    unsure = rounding + 4 * precision * abs(contact.approach)
    violation = certificate.worst / (tolerance * max(1.0, change) + unsure / scale)
    violation = max(violation, ALLOWED_AT_NODE / ALLOWED * certificate.load_imbalance / tolerance)
    if not violation <= ALLOWED_AT_NODE:
        return SolutionCheck(violation, reason=str(certificate))
    # On a solid that bends, a larger load may close fewer nodes.
    bends = contact.solid.height is not None and contact.solid.height < 0.1 * min(contact.grid.length)
    if (
        "contact_area_fraction" in imposed
        and not bends
        and not area_is_nearest(contact, imposed["contact_area_fraction"], whole)
    ):
        return SolutionCheck(violation, reason="another load has a number of contact nodes that is nearer")
    error, noise = energy_error(contact, height, pressure, rounding, **known)
    direct, reason = False, ""
    is_pivoted = contact.boundary == "periodic" and math.isinf(contact.hardness)
    if is_pivoted and np.count_nonzero(touching) <= DIRECT_NODES:
        compliance = mode_compliance(contact.solid, contact.grid)
        loaded = known or {"mean_pressure": contact.mean_pressure}
        try:
            exact = pivot(height, compliance, guess=touching, **loaded)
            error, direct = _relative_difference(pressure, exact), True
        except PivotingError as failure:
            reason = str(failure)
    error /= tolerance + noise
    holds = not error > ALLOWED
    reason = reason if holds else f"pressure off by {error:.3g} times the tolerance"
    return SolutionCheck(violation, error, direct, holds, reason)


def energy_error(
    contact: Contact,
    height: Array,
    pressure: Array,
    rounding: float,
    *,
    approach: float | None = None,
    mean_pressure: float | None = None,
) -> tuple[float, float]:
    """Relative bound of the error of a pressure in the norm of the elastic energy, and its part by rounding.

    A uniform pressure that has no energy is counted by its size relative to the varying part. The bound is
    NaN on a free map of more than `FREE_NODES`.
    """
    if contact.boundary == "periodic":
        response: _PeriodicResponse | _FreeResponse = _PeriodicResponse(
            contact.solid, contact.grid, mean_pressure is not None
        )
    elif contact.grid.size <= FREE_NODES:
        response = _FreeResponse(contact.solid, contact.grid, contact.boundary)
    else:
        return math.nan, 0.0
    energy = response.energy(pressure)
    if not energy > 0:
        return 0.0, 0.0
    displacement = response.displacement(pressure)
    gap = height + displacement
    plastic = pressure >= contact.hardness
    elastic = (pressure > 0) & ~plastic
    level = approach
    if level is None:
        level = float(np.mean(gap[elastic]) if elastic.any() else gap[plastic].max())
    gap -= level
    wrong = np.where(elastic, gap, np.where(plastic, np.maximum(gap, 0), np.minimum(gap, 0)))
    rounding += 4 * float(np.finfo(float).eps) * (float(np.abs(displacement).max()) + abs(level))
    counted = response.counted(pressure)
    missing = response.stiffness_energy(wrong) / energy * counted
    return math.sqrt(missing), rounding * math.sqrt(response.stiffness_trace / energy * counted)


class _PeriodicResponse:
    """Energies of a periodic cell, by its modes; without the uniform one if the load is known."""

    def __init__(self, solid: Solids, grid: Grid, load_is_known: bool) -> None:
        self._grid, self._compliance = grid, mode_compliance(solid, grid)
        if load_is_known:
            # At a given load the mean mode changes only the approach.
            self._compliance[0, 0] = 0
        compliance = self._compliance
        self._stiffness = np.divide(1, compliance, out=np.zeros_like(compliance), where=compliance > 0)
        self.stiffness_trace = float(np.sum(self._stiffness * grid.multiplicity[1]))

    def displacement(self, pressure: Array) -> Array:
        return np.fft.irfft2(self._compliance * np.fft.rfft2(pressure), self._grid.shape)

    def energy(self, pressure: Array) -> float:
        return self._sum(self._compliance, pressure)

    def stiffness_energy(self, displacement: Array) -> float:
        return self._sum(self._stiffness, displacement)

    def counted(self, pressure: Array) -> float:
        """Part of the square of the pressure that has energy."""
        return self._sum(self._compliance > 0, pressure) / self._sum(1.0, pressure)

    def _sum(self, factor: Any, field: Array) -> float:
        power = np.abs(np.fft.rfft2(field)) ** 2 * self._grid.multiplicity[1]
        return float(np.sum(factor * power)) / self._grid.size


class _FreeResponse:
    """Energies of a map that ends along one axis or both, by the inverse of its dense compliance."""

    def __init__(self, solid: Solids, grid: Grid, boundary: str) -> None:
        self._matrix, self._factor, trace = free_compliance(grid, boundary)
        self._modulus = solid.effective_modulus
        self.stiffness_trace = trace * self._modulus

    def displacement(self, pressure: Array) -> Array:
        return (self._matrix @ pressure.ravel()).reshape(pressure.shape) / self._modulus

    def energy(self, pressure: Array) -> float:
        return float(np.vdot(pressure, self.displacement(pressure)))

    def stiffness_energy(self, displacement: Array) -> float:
        flat = displacement.ravel()
        return float(flat @ cho_solve(self._factor, flat)) * self._modulus

    def counted(self, pressure: Array) -> float:
        return 1.0


@lru_cache(maxsize=16)
def free_compliance(grid: Grid, boundary: str) -> tuple[Array, Any, float]:
    """Compliance of the nodes of a map for E* = 1, its Cholesky factor, and the trace of its inverse."""
    kernel = surface_influence(*grid.coordinates(), grid, 1.0, BOUNDARIES[boundary])
    row, column = (index.ravel() for index in np.indices(grid.shape))
    matrix = kernel[abs(row[:, None] - row), abs(column[:, None] - column)]
    factor = cho_factor(matrix)
    return matrix, factor, float(np.trace(cho_solve(factor, np.eye(row.size))))


def area_is_nearest(contact: Contact, contact_area_fraction: float, height: Array) -> bool:
    """True if no other load has a number of contact nodes nearer to the imposed one, on these heights.

    The contact is solved under loads farther and farther in the direction of the imposed number, until the
    number changes.
    """
    size, pressure = contact.grid.size, contact.pressure
    wanted, nodes = max(1, round(contact_area_fraction * size)), int(np.count_nonzero(pressure))
    together = int(np.count_nonzero(height == height.min()))
    if nodes == 0 or abs(nodes - wanted) <= max(1, AREA_ERROR * wanted) or wanted < nodes == together:
        return nodes > 0
    found, change = nodes, 1e-3
    while found == nodes and change < 1e3:
        load = contact.mean_pressure * (1 + change) ** (1 if nodes < wanted else -1)
        if load >= contact.hardness:
            break
        other = solve_contact(
            height,
            contact.solid,
            contact.grid.length,
            mean_pressure=load,
            hardness=None if math.isinf(contact.hardness) else contact.hardness,
            boundary=contact.boundary,
            rtol=contact.rtol,
            dtype=pressure.dtype,
        )
        found, change = int(np.count_nonzero(other.pressure)), 4 * change
    return abs(found - wanted) >= abs(nodes - wanted)


def gap_change_per_tolerance(contact: Contact) -> float:
    """Largest change of the gap by a pressure error of the size of the tolerance, in units of the tolerance.

    It is large far beyond full contact.
    """
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    return norm * float(contact.solid.surface_compliance(2 * np.pi / max(contact.grid.length)))


def mode_compliance(solid: Solids, grid: Grid) -> Array:
    """Surface compliance of every stored mode, (ny, nx // 2 + 1)."""
    return solid.surface_compliance(grid.wavenumber())


def _relative_difference(pressure: Array, exact: Array) -> float:
    """Norm of the difference over the exact pressure's, scaled first so that no square underflows."""
    scale = float(exact.max()) or 1.0
    size, difference = (float(np.linalg.norm(p / scale)) for p in (exact, pressure - exact))
    return difference / (size or 1.0)
