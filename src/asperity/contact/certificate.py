"""Certificate of a solution: violations of the conditions of contact, evaluated from the pressure alone.

A solution has p ≥ 0, g = h + u − δ ≥ 0 and p g = 0 at every node, where u is the displacement of the solid
under p. With a hardness p_H, p ≤ p_H, and the bodies overlap, g ≤ 0, only where p = p_H. With adhesion this
holds for the reaction p + σ(g) of the faces in place of p, with p_H + σ₀: the contact is then stationary, and
need not be the only one. `verify_contact`
evaluates u anew in double precision, so that the certificate does not depend on any intermediate result of
a solver.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.contact.adhesion import Adhesion
from asperity.contact.contact_nodes import added
from asperity.contact.problem import Problem, State
from asperity.contact.response import checked_boundary, response_on
from asperity.core.arguments import number, real_array
from asperity.core.compiled import compiled, vectorised_sums
from asperity.core.errors import ConvergenceError
from asperity.core.markup import table
from asperity.core.parallel import map_parts, sum_parts
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import Boundary, Edges, Grid, with_mirror_images

# The error estimate of a method may be too small by this factor, and a gap wrong by so many roundings.
MAX_UNDERESTIMATE = 10.0
MAX_ROUNDINGS = 10.0

# The tolerance of the pressure may change no length by more than this fraction of the rms height: a stiff
# solid that is pressed far beyond full contact has one that exceeds all differences of the heights.
MAX_VIOLATION = 1e-2

# Nodes that are examined together: most of them are open, and change no measure.
_BLOCK = 64


@dataclass(frozen=True, repr=False)
class Certificate:
    """Violations of the conditions of contact, and the work spent on the solution.

    Lengths are relative to the rms height of the surface, which no pressure changes; for a flat surface
    they are relative to the maximum pressure × grid spacing / E*, about the displacement of a single node.

    Attributes
    ----------
    penetration : float
        Largest overlap, max(−g), where p is below the hardness.
    contact_gap : float
        Maximum gap |g| where p > 0, and g > 0 where p is at the hardness.
    tension : float
        Maximum tension max(−p), or excess over the hardness, relative to the maximum pressure.
    load_imbalance : float
        Relative difference between the mean pressure and the imposed one; 0 if the load is not imposed.
    complementarity : float
        Σ p |g| / Σ p, without the overlap of nodes at the hardness.
    attraction : float
        Largest difference between the attraction and that of the gap by the law of adhesion, over the largest
        pressure or attraction; 0 without adhesion.
    stability : float
        Smallest second variation of the energy along the last steps of the solver, over its elastic part:
        above 0 for a contact with adhesion that is stable along these directions; NaN where it is not known.
    iterations : int
        Applications of the compliance, on all grids.
    pairs : float
        Pairs of a forward and an inverse Fourier transform on the finest grid. Transforms on coarser grids
        are weighted by their numbers of nodes.
    seconds : float
        Wall time of the solution.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> contact.certificate.worst < 1e-4  # of the rms height, the pressure and the load
    True
    """

    penetration: float
    contact_gap: float
    tension: float
    load_imbalance: float
    complementarity: float
    iterations: int = 0
    pairs: float = 0.0
    seconds: float = 0.0
    attraction: float = 0.0
    stability: float = math.nan

    @property
    def violations(self) -> dict[str, float]:
        """Condition → its violation."""
        names = ("penetration", "contact_gap", "tension", "load_imbalance", "complementarity", "attraction")
        return {name: getattr(self, name) for name in names}

    @property
    def worst(self) -> float:
        """The maximum violation, infinite if one is not a finite number."""
        violations = list(self.violations.values())
        return max(violations) if np.all(np.isfinite(violations)) else np.inf

    @property
    def error_bound(self) -> float:
        """Upper bound of the error of a pressure 0 ≤ p ≤ p_H, (p − p*)·G (p − p*) / (Σ p × rms height).

        p* is the exact pressure of the same load and hardness p_H, and G the compliance: the energy of the
        error over the load times the length to which the violations are relative. The proof is in
        ``paper/supplement/method.md``. Infinite with adhesion, where several contacts may exist.
        """
        is_convex = self.tension == 0 and self.attraction == 0 and math.isnan(self.stability)
        return self.penetration + self.complementarity if is_convex else math.inf

    def __repr__(self) -> str:
        found = ", ".join(f"{name} {value:.2g}" for name, value in self.violations.items())
        return f"<Certificate: {found}; {self.iterations} iterations, {self.seconds:.3g} s>"

    def _repr_html_(self) -> str:
        rows = [(name.replace("_", " "), f"{value:.2g}") for name, value in self.violations.items()]
        rows += [
            ("iterations", str(self.iterations)),
            ("transform pairs", f"{self.pairs:.4g}"),
            ("seconds", f"{self.seconds:.3g}"),
        ]
        return table("Certificate", rows)

    def check(self, tolerance: float) -> None:
        """Raise `ConvergenceError` if a violation exceeds the tolerance or is not a number."""
        if not self.worst <= tolerance:
            raise ConvergenceError(
                f"certificate not fulfilled, {self}", self.worst, tolerance, self.iterations, np.nan
            )


def verify_contact(
    height: Array,
    pressure: Array,
    solid: Solids,
    length: Edges = 1.0,
    *,
    approach: float | None = None,
    mean_pressure: float | None = None,
    hardness: float | None = None,
    adhesion: Adhesion | None = None,
    boundary: Boundary = "periodic",
    threads: int = 1,
) -> Certificate:
    """Certificate of a pressure, computed from the surface and the solid alone.

    The conditions are those of Karush, Kuhn and Tucker; ``paper/supplement/method.md`` proves the bound of
    the error.

    Parameters
    ----------
    height, pressure : (ny, nx) arrays
    solid : Solid or TwoBodies
    length : float, (length_y, length_x) or Grid
        Edges of the map.
    approach : float, optional
        The approach claimed; without it the mean of h + u over the contact below the hardness.
    mean_pressure : float, optional
        The load imposed, if it was.
    hardness : float, optional
        Maximum pressure, see `asperity.contact.solve`.
    adhesion : Adhesion, optional
        Attraction of the faces; the approach is then needed.
    boundary : "periodic" | "free" | (str, str)
        As for `asperity.contact.solve`.
    threads : int
        The certificate does not depend on it.

    Returns
    -------
    Certificate
        Without iterations, pairs and seconds; infinite if a number overflows.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> solid = asp.Solid(young=1.0, poisson=0.3)
    >>> contact = asp.solve_contact(height, solid, mean_pressure=1e-3)
    >>> asp.contact.verify_contact(height, contact.pressure, solid, mean_pressure=1e-3).worst < 1e-5
    True
    >>> asp.contact.verify_contact(height, 1.01 * contact.pressure, solid, mean_pressure=1e-3).worst < 1e-5
    False
    """
    height = field_in_double("height", real_array("height", height))
    pressure = field_in_double("pressure", real_array("pressure", pressure))
    if height.shape != pressure.shape:
        raise ValueError(f"pressure has the shape {pressure.shape}: {height.shape}, as of height, is needed")
    grid = Grid(pressure.shape, length)  # type: ignore[arg-type]
    if approach is not None:
        approach = number("approach", approach, "a finite number", np.isfinite)
    if mean_pressure is not None:
        mean_pressure = number("mean_pressure", mean_pressure, "a finite number", np.isfinite)
    boundary, grid = checked_boundary(boundary, solid, grid)
    if isinstance(grid.mirrored, tuple):
        height, pressure = (with_mirror_images(field, grid) for field in (height, pressure))
        grid = grid.whole_cell
    gap = response_on(boundary, solid, grid, "float64", threads).displacement(pressure)
    # Differences of heights are exact where their level is far from zero.
    datum = float(height.min())
    gap += height - datum
    approach = None if approach is None else approach - datum
    limit = math.inf
    if hardness is not None:
        limit = number("hardness", hardness, "a number > 0", lambda value: value > 0)
    if approach is None and adhesion is not None:
        raise ValueError("approach: needed with adhesion, where no pressure shows which nodes are in contact")
    if approach is None:
        elastic, plastic = (pressure > 0) & (pressure < limit), pressure >= limit
        approach = float(gap[elastic].mean() if elastic.any() else gap.max(where=plastic, initial=gap.min()))
    gap -= approach
    nodal_compliance = min(grid.spacing) / solid.effective_modulus
    rms_height = rms_deviation(height, threads)
    if adhesion is None:
        return certificate_of_fields(
            pressure, gap, rms_height, nodal_compliance, mean_pressure, threads, limit
        )
    return certificate_with_adhesion(
        pressure, gap, adhesion, rms_height, nodal_compliance, mean_pressure, limit
    )


def checked_certificate(
    problem: Problem,
    state: State,
    gap: Array,
    load: float | None,
    rms_height: float,
    norm: float,
    largest: float,
    rtol: float,
) -> Certificate:
    """The certificate of a state, in the units of its problem.

    An error of the pressure, relative to its norm, changes no gap by more than that fraction of the norm of
    the pressure × √(displacement of a node per unit of its own pressure × displacement of the softest wave
    per unit of its pressure): for each pressure x, (G x)ᵢ² ≤ Gᵢᵢ x·G x.

    Parameters
    ----------
    problem, state
    gap : (ny, nx) array
        In double precision.
    load : float, optional
        Mean pressure, if it is imposed.
    rms_height : float
        Scale of lengths.
    norm : float
        Of the pressure.
    largest : float
        Largest sum of height and displacement of a contact node, which sets the rounding error of gaps.
    rtol : float

    Raises
    ------
    ConvergenceError
        If a field is not finite, or the certificate exceeds the allowance for tolerance and rounding.
    """
    response, pressure = problem.response, state.pressure.astype(float, copy=False)
    rounding = MAX_ROUNDINGS * float(np.finfo(problem.fourier.real).eps)
    found = certificate_of_fields(
        pressure, gap, rms_height, problem.nodal_compliance, load, problem.fourier.threads, problem.hardness
    )
    caused = norm * math.sqrt(response.largest_own_compliance * response.largest_compliance)
    scale = rms_height or float(pressure.max()) * problem.nodal_compliance or 1.0
    tolerance = min(MAX_UNDERESTIMATE * rtol * caused / scale, max(MAX_VIOLATION, MAX_UNDERESTIMATE * rtol))
    lengths = tolerance + rounding * (caused + largest) / scale  # of which heights may consist
    allowed = {"tension": rounding, "load_imbalance": rtol + rounding}
    excess = max(
        value / (allowed.get(name, lengths) or math.ulp(0)) for name, value in found.violations.items()
    )
    if not excess <= 1:
        is_finite = math.isfinite(found.worst)
        fault = "violates the conditions of contact" if is_finite else "is not finite"
        raise ConvergenceError(
            f"solution on {problem.grid.shape} nodes ended with a pressure that {fault}",
            found.worst,
            rtol,
            state.iterations,
            float(pressure.mean(dtype=float)),
        )
    return replace(found, iterations=state.iterations)


def certificate_of_fields(
    pressure: Array,
    gap: Array,
    rms_height: float,
    nodal_compliance: float,
    mean_pressure: float | None,
    threads: int = 1,
    hardness: float = math.inf,
) -> Certificate:
    """Certificate of a pressure whose gap is known.

    Parameters
    ----------
    pressure, gap : (ny, nx) arrays
        In double precision.
    rms_height : float
    nodal_compliance : float
        Grid spacing / E*.
    mean_pressure : float, optional
        The load imposed, if it was.
    threads : int
    hardness : float
    """
    fields = pressure.reshape(-1), gap.reshape(-1)
    found = np.array(map_parts(_measures_of_contact, threads, *fields, hardness))
    least, least_gap = found[:, :2].min(axis=0).tolist()
    largest, contact_gap = found[:, 2:4].max(axis=0).tolist()
    total_pressure, total_gap, work, support = found[:, 4:].sum(axis=0).tolist()
    load = total_pressure / pressure.size
    if not math.isfinite(total_pressure) or not math.isfinite(total_gap):
        least_gap = -math.inf
    largest = max(largest, -least)
    scale = rms_height or largest * nodal_compliance or 1.0
    imbalance = 0.0
    if mean_pressure is not None and mean_pressure != load:
        imbalance = abs(load - mean_pressure) / max(abs(mean_pressure), abs(load))
    return Certificate(
        penetration=max(0.0, -least_gap) / scale,
        contact_gap=contact_gap / scale,
        tension=max(0.0, -least, largest - hardness) / (largest or 1.0),
        load_imbalance=imbalance,
        complementarity=work / (support or 1.0) / scale,
    )


def certificate_with_adhesion(
    pressure: Array,
    gap: Array,
    adhesion: Adhesion,
    rms_height: float,
    nodal_compliance: float,
    mean_pressure: float | None,
    hardness: float = math.inf,
) -> Certificate:
    """Certificate of a pressure with adhesion, as of `certificate_of_fields` for the reaction of the faces.

    A node touches if its reaction over the largest attraction exceeds its gap over the range.
    """
    reaction = pressure + adhesion.traction(gap)
    is_open = reaction / adhesion.strength < gap / adhesion.range
    largest = max(adhesion.strength, float(pressure.max()))
    mismatch = float(np.abs(reaction).max(where=is_open, initial=0.0)) / largest
    reaction[is_open] = 0
    limit = hardness + adhesion.strength
    found = certificate_of_fields(reaction, gap, rms_height, nodal_compliance, None, 1, limit)
    load = float(pressure.mean())
    wanted = load if mean_pressure is None else mean_pressure
    imbalance = abs(load - wanted) / max(abs(load), abs(wanted), math.ulp(0))
    return replace(found, attraction=mismatch, load_imbalance=imbalance)


def rms_deviation(values: Array, threads: int = 1) -> float:
    """Root mean square of the deviations from the mean."""
    flat = values.reshape(-1).astype(float, copy=False)
    mean = sum_parts(added, threads, flat) / flat.size
    return math.sqrt(sum_parts(_squared_deviation, threads, flat, mean) / flat.size)


def field_in_double(name: str, array: Array) -> Array:
    """A field [y, x] in double precision; `ValueError` if it has not two dimensions."""
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} has the shape {array.shape}: a two-dimensional array [y, x] is needed")
    return array.astype(float, copy=False)


@vectorised_sums
def _squared_deviation(values: Any, mean: float) -> float:
    """Σ (value − mean)²."""
    total = 0.0
    for i in range(values.size):
        total += (values[i] - mean) ** 2
    return total


@compiled
def _measures_of_contact(pressure: Any, gap: Any, hardness: float) -> tuple[float, ...]:
    """Least p, least g, largest p, largest |g| of the contact, Σ p, Σ g, and Σ p |g| and Σ p of the contact.

    A NaN in the fields makes Σ p or Σ g NaN; Σ g is without nodes that are open. Where p is at the hardness
    an overlap is no gap.
    """
    least, largest = pressure[0], pressure[0]
    least_gap, contact_gap = np.inf, 0.0
    total, total_gap, work, support = 0.0, 0.0, 0.0, 0.0
    for start in range(0, pressure.size, _BLOCK):
        some, gaps = pressure[start : start + _BLOCK], gap[start : start + _BLOCK]
        is_open = True
        for i in range(some.size):
            is_open &= (some[i] == 0) & (gaps[i] >= least_gap) & (gaps[i] < np.inf)
        for i in range(0 if is_open else some.size):
            p, g = some[i], gaps[i]
            total += p
            total_gap += g
            least, largest = min(least, p), max(largest, p)
            if p >= hardness:
                g = max(g, 0.0)
            least_gap = min(least_gap, g)
            if p > 0:
                contact_gap = max(contact_gap, abs(g))
                work += p * abs(g)
                support += p
    return least, least_gap, largest, contact_gap, total, total_gap, work, support
