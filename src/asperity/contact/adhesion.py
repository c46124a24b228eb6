"""Adhesion: attraction across the gap with a work of adhesion and a range, together with a hardness.

The faces attract each other with a traction σ(g) that falls with the gap g ≥ 0 and does the work w in all.
Where they touch a reaction r ≥ 0 acts, too, and the contact pressure is p = r − σ(g), down to −σ₀ = −σ(0).
With a hardness, p ≤ p_H. Two laws:

- ``exponential``: σ = (w/ρ) exp(−g/ρ), with the range ρ;
- ``maugis-dugdale``: σ = w/ρ up to the gap ρ, and 0 beyond (D. Maugis, J. Colloid Interface Sci. 150 (1992)
  243, DOI 10.1016/0021-9797(92)90285-T), with a linear fall within a tenth of ρ: at a sudden fall the edge of
  the attraction sticks to the nodes.

The energy of the solid is convex and the energy of the attraction is concave, so that several contacts may
exist at one approach, and **the path decides**. The method is the concave-convex procedure (A. L. Yuille and
A. Rangarajan, Neural Computation 15 (2003) 915, DOI 10.1162/08997660360581958):

    repeat:
        take the attraction a of the last gap as a given load on both faces            `_step`
        solve the contact without adhesion of the height h − G a, with the hardness    `active_set.solve`
        p_H + σ₀
        evaluate the attraction σ(g) of its gap, and extrapolate it from the last      `_extrapolated`
        steps

Each step minimises an energy that is nowhere below the true one and equals it at the last gap. Without
extrapolation the true energy therefore never rises, and an approach that changes in small steps follows its
branch until that becomes unstable: there the contact jumps to another branch. Without a start the attraction
grows from zero, which leads to the branch of first approach. The extrapolation is due to D. G. Anderson
(J. ACM 12 (1965) 547, DOI 10.1145/321296.321305); one that raises the energy is used only if it halves the
change.

At the edge of a contact the attraction falls over the length d = π E* w / (4 σ₀²), which the grid has to
resolve.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from asperity.contact import active_set
from asperity.contact.contact_nodes import dot, norm
from asperity.contact.problem import Control, ConvergenceProgress, Problem, State
from asperity.core.arguments import choice, magnitude
from asperity.core.errors import ConvergenceError, InputError, shown
from asperity.core.types import Array, Progress
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import Edges, Grid

LAWS = ("exponential", "maugis-dugdale")

# Pixels within the cohesive zone that are needed, and that the shortest range gives.
LEAST_PIXELS, FITTED_PIXELS = 2, 4

# Half the length over which the traction of Maugis and Dugdale falls to zero, over the range.
FALL = 0.1

# Steps from which the attraction is extrapolated: on paths of rough surfaces of 64² nodes eight take as many
# applications of the compliance to 1 %, and two take 1.2 times as many.
DEPTH = 4

# Steps of the procedure, and tolerance of the contacts in them over the tolerance of the whole.
MAX_STEPS, INNER_TOLERANCE = 1000, 0.03

# Part of the reaction's norm to which a change of the attraction is compared.
REACTION_PART = 0.1

# Rounding of the energy over the sum of the magnitudes of its parts.
ENERGY_ROUNDING = 1e-11

# Change of the attraction, over its strength, by which a contact that is stationary but unstable is left, and
# how often.
PUSH, MAX_PUSHES = 0.1, 5

# Directions are independent if the eigenvalue of their normalised products is above this.
LEAST_INDEPENDENT = 1e-6

# Coefficient of Pastewka and Robbins between the area and load / (E* × rms gradient) without adhesion.
REPULSIVE_AREA = 2.0


@dataclass(frozen=True)
class Adhesion:
    """Attraction across the gap of two faces.

    Parameters
    ----------
    work : float
        Work of adhesion w per area, in the unit of Young's modulus times the unit of lengths.
    range : float
        Length ρ over which the attraction acts; its largest traction is w/ρ.
    law : "exponential" | "maugis-dugdale"

    Raises
    ------
    TypeError, ValueError
        If an argument is out of range.

    Examples
    --------
    A ball on a soft half-space sticks: a force of about −1.5 π w R pulls it off.

    >>> height = asp.surface.add_sphere(np.zeros((64, 64)), 0.4, radius=1.0)
    >>> adhesion, solid = asp.Adhesion(work=7e-5, range=1.7e-3), asp.Solid(1.0, 0.0)
    >>> approaches = [0.0, -2e-3, -4e-3, -6e-3, -8e-3]
    >>> path = asp.solve_load_path(
    ...     height, solid, 0.4, approaches=approaches, adhesion=adhesion, boundary="free"
    ... )
    >>> print(f"{min(contact.force for contact in path) / (np.pi * 7e-5):.2f}")
    -1.63
    """

    work: float
    range: float
    law: str = "exponential"

    def __post_init__(self) -> None:
        object.__setattr__(self, "work", magnitude("work", self.work))
        object.__setattr__(self, "range", magnitude("range", self.range))
        choice("law", self.law, LAWS)

    @classmethod
    def fitted(cls, work: float, solid: Solids, grid: Grid, law: str = "exponential") -> Self:
        """The shortest range whose cohesive zone spans four nodes of a grid."""
        step = max(grid.spacing)
        modulus = modulus_of_waves(solid, FITTED_PIXELS * step)
        return cls(work, math.sqrt(4 * FITTED_PIXELS * step * work / (math.pi * modulus)), law)

    def resolved_on(self, solid: Solids, grid: Grid) -> Self:
        """The same adhesion, with a longer range if the cohesive zone spans less than two nodes of a grid."""
        fitted = self.fitted(self.work, solid, grid, self.law)
        least = fitted.range * math.sqrt(LEAST_PIXELS / FITTED_PIXELS)
        return self if self.range >= least else replace(self, range=least)

    @property
    def strength(self) -> float:
        """Largest traction σ₀."""
        return self.work / self.range

    def traction(self, gap: Array) -> Array:
        """Traction σ of the attraction at gaps; where faces overlap as where they touch."""
        if self.law == "exponential":
            return self.strength * np.exp(-np.maximum(gap, 0) / self.range)
        return self.strength * np.clip((1 + FALL - gap / self.range) / (2 * FALL), 0, 1)

    def energy(self, gap: Array) -> Array:
        """Energy per area of the attraction, 0 for faces far apart."""
        traction = self.traction(gap)
        if self.law == "exponential":
            return -self.range * traction
        # Over the triangle of the fall, and over the rectangle before it.
        fall = FALL * self.range * traction**2 / self.strength
        return -fall - self.strength * np.clip((1 - FALL) * self.range - gap, 0, (1 - FALL) * self.range)

    def slope(self, gap: Array) -> Array:
        """Decrease of the traction with the gap, −dσ/dg ≥ 0."""
        traction = self.traction(gap)
        if self.law == "exponential":
            return traction / self.range
        return ((traction > 0) & (traction < self.strength)) * (self.strength / (2 * FALL * self.range))

    def cohesive_zone(self, modulus: float) -> float:
        """Length d = π E* w / (4 σ₀²) at the edge of a contact over which the attraction falls."""
        return math.pi * modulus * self.work / (4 * self.strength**2)

    def in_units(self, length: float, stress: float) -> Self:
        """The same adhesion in other units of gaps and stresses."""
        return replace(self, work=self.work / (length * stress), range=self.range / length)

    def check_resolved(self, solid: Solids, grid: Grid) -> None:
        """Raise `ValueError` if a grid does not resolve the cohesive zone."""
        step = max(grid.spacing)
        zone = self.cohesive_zone(modulus_of_waves(solid, FITTED_PIXELS * step))
        if zone * (1 + 1e-9) < LEAST_PIXELS * step:
            fitted = self.fitted(self.work, solid, grid, self.law).range
            text = (
                f" = {shown(self.range)}: nodes at most d/2 apart are needed in the cohesive zone "
                f"d = π E* work / (4 (work/range)²) = {zone:.4g}, and they are {step:.4g} apart; with a "
                f"range of {fitted:.4g} it spans {FITTED_PIXELS} nodes"
            )
            raise InputError("", [("adhesion.range", text)])


def modulus_of_waves(solid: Solids, wavelength: float) -> float:
    """E* of a solid for waves of a length: of a half-space that is as stiff."""
    wavenumber = 2 * math.pi / wavelength
    return 2 / (wavenumber * float(solid.surface_compliance(wavenumber)))


def stickiness(adhesion: Adhesion, height: Array, solid: Solids, length: Edges = 1.0) -> float:
    """Left side of the criterion of L. Pastewka and M. O. Robbins: rough surfaces stick if it is below 1.

    (h' Δr / (κ l_a)) (h' d / (4 Δr))^⅔ / (π (3/16)^⅔) with rms gradient h' and rms curvature h'', the range
    Δr of the attraction, l_a = w/E*, κ = 2 and d = 4 h'/h'' (PNAS 111 (2014) 3298, Eq. 10, DOI
    10.1073/pnas.1320846111), from differences of neighbouring heights; 0 for a plane.
    """
    grid = Grid(height.shape, length)  # type: ignore[arg-type]
    step_y, step_x = grid.spacing
    along_y, along_x = np.diff(height, axis=0) / step_y, np.diff(height, axis=1) / step_x
    slope = math.sqrt(np.mean(along_y**2) + np.mean(along_x**2))
    bends_y, bends_x = np.diff(along_y, axis=0)[:, 1:-1] / step_y, np.diff(along_x, axis=1)[1:-1] / step_x
    curvature = math.sqrt(np.mean((bends_y + bends_x) ** 2)) if bends_y.size else 0.0
    if not curvature > 0:
        return 0.0
    factor = slope * adhesion.range * solid.effective_modulus / (REPULSIVE_AREA * adhesion.work)
    return factor * (16 / 3 * slope**2 / (curvature * adhesion.range)) ** (2 / 3) / math.pi


@dataclass(frozen=True)
class Step:
    """One step of the procedure, in the units of the problem.

    Attributes
    ----------
    problem : Problem
        The contact without adhesion, under the attraction as a load: its height is h − G a.
    state : State
        Its solution, whose pressure is the reaction of the faces.
    attraction, pulled : (ny, nx) arrays
        The attraction a, and the displacement G a.
    displacement, gap : (ny, nx) arrays
        Displacement under the reaction, and the gap.
    change : (ny, nx) array
        Attraction of the gap less a.
    energy, rounding : float
        Energy at the gap, and its rounding error.
    """

    problem: Problem
    state: State
    attraction: Array
    pulled: Array
    displacement: Array
    gap: Array
    change: Array
    energy: float
    rounding: float


def solve(
    problem: Problem,
    adhesion: Adhesion,
    control: Control,
    rtol: float,
    progress: Progress | None = None,
    initial: tuple[Array, Array] | None = None,
) -> tuple[Step, float]:
    """The last step to a contact with adhesion, and its stability; the module describes the method.

    Parameters
    ----------
    problem : Problem
        In double precision.
    adhesion : Adhesion
        In the units of the problem.
    control : Control
        A mean pressure or an approach.
    rtol : float
        Change of the attraction in a step to be reached, relative to the norm of the attraction and a
        tenth of the norm of the reaction.
    progress : callable, optional
    initial : pair of (ny, nx) arrays, optional
        Reaction and attraction of the contact to start from.

    Raises
    ------
    ConvergenceError
        If the tolerance is not reached.
    """
    report = ConvergenceProgress(progress, rtol)
    reaction, attraction = initial or (None, np.zeros_like(problem.height))
    history: list[Step] = []
    iterations, best, extrapolated, pushes, first = 0, math.inf, False, 0, attraction
    for _ in range(MAX_STEPS):
        step = _step(problem, adhesion, control, rtol, attraction, reaction)
        iterations += step.state.iterations + 2
        # A weak attraction counts more than its part of the pressure.
        scale = REACTION_PART * norm(step.state.pressure.ravel())
        scale += max(norm(attraction.ravel()), norm((attraction + step.change).ravel()))
        error = norm(step.change.ravel()) / scale if scale else 0.0
        report(error)
        if error <= rtol:
            stability, unstable = _stability([*history, step], adhesion)
            if stability < 0 and pushes < MAX_PUSHES:
                # Stationary, but no minimum, which an extrapolation can reach: on towards the start.
                side = 1.0 if dot(unstable.ravel(), (first - attraction).ravel()) >= 0 else -1.0
                size = side * PUSH * adhesion.strength / max(float(np.abs(unstable).max()), math.ulp(0))
                attraction = np.clip(attraction + size * unstable, 0, adhesion.strength)
                history, extrapolated, best, pushes = [], False, math.inf, pushes + 1
                continue
            state = replace(step.state, iterations=iterations, displacement=step.displacement)
            return replace(step, state=state), stability
        rises = history and step.energy > history[-1].energy + step.rounding
        if extrapolated and rises and error > 0.5 * best:
            # The plain step from the last iterate, whose energy is lower.
            history, extrapolated = history[-1:], False
            attraction = history[-1].attraction + history[-1].change
            continue
        best = min(best, error)
        history = [*history[1 - DEPTH :], step]
        reaction = step.state.pressure
        extrapolated = len(history) > 1
        attraction = _extrapolated(history, adhesion.strength) if extrapolated else attraction + step.change
    remedy = "a longer range, or a smaller change of the approach from the initial contact is needed"
    if problem.hardness < math.inf:
        remedy = f"a hardness further above the mean pressure, an elastic contact, or {remedy}"
    raise ConvergenceError(
        f"adhesion on {problem.grid.shape} nodes stopped",
        error,
        rtol,
        iterations,
        float((step.state.pressure - attraction).mean()),
        remedy,
    )


def _step(
    problem: Problem,
    adhesion: Adhesion,
    control: Control,
    rtol: float,
    attraction: Array,
    reaction: Array | None,
) -> Step:
    """The contact under a given attraction, and the attraction of its gap."""
    response, limit = problem.response, problem.hardness
    pulled = response.displacement(attraction)
    under = Problem(problem.height - pulled, response, limit + adhesion.strength, problem.plastic)
    if control.kind == "mean_pressure":
        control = replace(control, value=control.value + float(attraction.mean()))
        is_open = control.value <= 0
        level = under.lowest
    else:
        level = control.value
        is_open = level <= under.lowest
    if is_open:
        zero = np.zeros_like(attraction)
        state = State(zero, level, 0.0, displacement=zero)
    else:
        start = reaction if reaction is not None and reaction.any() else None
        state = active_set.solve(under, control, INNER_TOLERANCE * rtol, None, start)
    displacement = response.displacement(state.pressure)
    gap = under.height + displacement - state.approach
    touches = state.pressure > 0
    change = np.where(touches, adhesion.strength, adhesion.traction(gap)) - attraction
    elastic = 0.5 * dot((state.pressure - attraction).ravel(), (displacement - pulled).ravel())
    attractive = float(adhesion.energy(np.where(touches, 0, gap)).sum())
    plastic = limit * float(np.maximum(-gap, 0).sum(where=touches)) if limit < math.inf else 0.0
    pushed = 0.0
    if control.kind == "mean_pressure":
        pushed = (control.value - float(attraction.mean())) * state.approach * problem.grid.size
    energy = elastic + attractive + plastic - pushed
    rounding = ENERGY_ROUNDING * (abs(elastic) + abs(attractive) + abs(plastic) + abs(pushed))
    parts = attraction, pulled, displacement, gap, change
    return Step(under, state, *parts, energy, rounding)


def _products(fields: list[Array], others: list[Array]) -> Array:
    """Products of each field with each of the others, from [field, other]."""
    return np.array([[dot(first.ravel(), second.ravel()) for second in others] for first in fields])


def _extrapolated(history: list[Step], strength: float) -> Array:
    """Attraction by Anderson's extrapolation from the last steps, within 0 and the strength."""
    *others, last = history
    changes = [last.change - each.change for each in others]
    products, target = _products(changes, changes), _products(changes, [last.change])[:, 0]
    sizes = np.sqrt(np.diag(products))
    sizes[sizes == 0] = 1.0  # two steps with equal changes
    weights = np.linalg.lstsq(products / np.outer(sizes, sizes), target / sizes, rcond=1e-12)[0] / sizes
    found = last.attraction + last.change
    for weight, change, each in zip(weights, changes, others, strict=True):
        found -= weight * (last.attraction - each.attraction + change)
    return np.clip(found, 0, strength)


def _stability(steps: list[Step], adhesion: Adhesion) -> tuple[float, Array]:
    """Smallest second variation of the energy over its elastic part, along the differences of steps.

    It is 1 without attraction, and above 0 for a contact that is stable along these directions. Second, the
    change of the attraction along the direction to which it belongs.
    """
    *others, last = steps
    if not others:
        return 1.0, last.change
    curvature = np.where(last.state.pressure > 0, 0, adhesion.slope(last.gap))
    moved = [last.displacement - last.pulled - each.displacement + each.pulled for each in others]
    gaps = [last.gap - each.gap for each in others]
    pressures = [
        last.state.pressure - last.attraction - each.state.pressure + each.attraction for each in others
    ]
    elastic = _products(pressures, moved)
    attractive = _products([each * curvature for each in gaps], gaps)
    sizes = np.sqrt(np.maximum(np.diag(elastic), 0))
    if not sizes.all():
        return 1.0, last.change
    elastic, attractive = ((each + each.T) / (2 * np.outer(sizes, sizes)) for each in (elastic, attractive))
    values, vectors = np.linalg.eigh(elastic)
    kept = values > LEAST_INDEPENDENT
    basis = vectors[:, kept] / np.sqrt(values[kept])
    ratios, mixtures = np.linalg.eigh(basis.T @ attractive @ basis)
    weights = basis @ mixtures[:, -1] / sizes
    return 1 - float(ratios[-1]), curvature * sum(w * each for w, each in zip(weights, gaps, strict=True))
