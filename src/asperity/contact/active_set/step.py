"""One step of the outer loop: nodes enter and leave the contact or yield, and the energy does not grow.

Nodes that enter the contact are chosen by the gap to which a correction leads, before nodes in tension are
released: afterwards the pressure is out of equilibrium, and nodes around every patch that lost tension seem
to penetrate. Plastic nodes whose gap the correction opens are chosen likewise: their pressure falls.

Adding nodes to the contact and releasing nodes in tension can raise the energy, which a correction on a fixed
set of contact nodes cannot. The iterates before and after are both admissible (no tension), and so are those
between them: the step is shortened to the fraction at which the energy is least (compare the projected
searches of Moré & Toraldo 1991, 10.1137/0801008). Without that the iteration diverges on grids of 2048²
nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact.active_set.assembly import ContactSystem, overlap_of
from asperity.contact.active_set.inner_solve import Correction
from asperity.contact.active_set.iterate import HeldNodes, Iterate, Pressure, evaluate
from asperity.contact.compliance.vectors import inserted
from asperity.contact.problem import Control, Problem
from asperity.core.compiled import sums
from asperity.core.parallel import total
from asperity.core.types import Array

# A step is taken whole unless the energy is least at less than this fraction of it.
WHOLE_STEP = 0.9

# With a hardness a shortened step leaves no node plastic: whole steps are taken as long as the energy falls.
WHOLE_STEP_BOUNDED = 0.5

# A step that raises the energy from its start is tried again without nodes that enter, shortened by this
# factor before nodes are released, so many times. Later steps are shortened too, and lengthened step by step.
SHORTENING = 4
MAX_TRIALS = 10


@dataclass(frozen=True)
class EntryCandidates:
    """Nodes out of contact whose gap a correction may close, and plastic ones whose gap it may open.

    Attributes
    ----------
    held : HeldNodes
        Their levels are those before the correction.
    overlap : (count,) array
        δ − (h + u) after the correction, in units of `Problem.unit`.
    """

    held: HeldNodes
    overlap: Array

    @property
    def enter(self) -> Array:
        """True where a node enters the contact."""
        return (self.overlap > 0) & (self.held.side > 0)

    @classmethod
    def after(
        cls, iterate: Iterate, system: ContactSystem, correction: Correction, further: float = 0.0
    ) -> EntryCandidates:
        """Nodes whose gap closes under a correction, or if the approach then grows further by some amount."""
        unit, approach = iterate.problem.unit, system.approach + correction.approach
        # No node moves upward by more than the contact nodes do, which the pressure displaces.
        bound = approach + unit * max(0.0, -float(correction.displacement.min(initial=0))) + further
        held = system.held if bound <= system.bound else iterate.held_nodes(bound, system.plastic)
        overlap = overlap_of(held.level, approach, unit)
        overlap -= system.linear.operators.displacement(correction.pressure, held.nodes)
        return cls(held, overlap)


@dataclass(frozen=True)
class Step:
    """A step on the nodes in contact before it, and on those that enter the contact.

    Attributes
    ----------
    nodes, pressure, level : (count,) arrays
        Before the step.
    change : (count,) array
        Change of the pressure; that of a node that enters, or is plastic no longer, is overlap / nodal
        compliance.
    changes_state : (count,) array
        True for these nodes.
    excess : (count,) or (1,) array
        Overlap / nodal compliance of the nodes that stay plastic.
    approach : float
    reached_hardness : bool
        As in `Pressure`.
    """

    nodes: Array
    pressure: Array
    level: Array
    change: Array
    changes_state: Array
    excess: Array
    approach: float
    reached_hardness: bool

    @classmethod
    def of(
        cls, iterate: Iterate, system: ContactSystem, correction: Correction, entering: EntryCandidates
    ) -> Step:
        """The step that a correction leads to."""
        enter, real, held = entering.enter, iterate.pressure.dtype, entering.held
        new = held.nodes[enter]
        at = np.searchsorted(iterate.nodes, new)
        nodes = inserted(iterate.nodes, at, new)
        changes_state = np.zeros(nodes.size, np.bool_)
        changes_state[at + np.arange(new.size)] = True
        change, excess = correction.pressure.astype(real), np.zeros(1, real)
        if system.plastic.size:
            change, excess = np.zeros(iterate.nodes.size, real), np.zeros(nodes.size, real)
            change[system.elastic] = correction.pressure
            at_hardness = held.side < 0
            overlap, plastic = entering.overlap[at_hardness], np.searchsorted(nodes, held.nodes[at_hardness])
            change[system.plastic] = np.minimum(overlap, 0)
            excess[plastic] = np.maximum(overlap, 0)
            changes_state[plastic] = overlap < 0
        return cls(
            nodes,
            inserted(iterate.pressure, at, np.zeros(new.size, real)),
            inserted(iterate.level, at, held.level[enter]),
            inserted(change, at, entering.overlap[enter]),
            changes_state,
            excess,
            system.approach,
            iterate.reached_hardness,
        )

    def pressure_after(self, fraction: float, load: float, change_state: bool = True) -> Pressure:
        """Pressure after a fraction of the correction, with nodes that change their state or without.

        Nodes in tension are released, to zero pressure.
        """
        real = self.pressure.dtype.type
        pressure = np.where(self.changes_state, real(change_state), real(fraction))
        pressure *= self.change
        pressure += self.pressure
        np.maximum(pressure, 0, out=pressure)
        pressure += self.excess
        return Pressure(self.nodes, pressure, load, self.reached_hardness)

    def fraction_of_least_energy(self, after: Iterate) -> float:
        """Fraction of the step to an iterate at which the energy is least."""
        threads = after.problem.fourier.threads
        fields = after.pressure, self.pressure, after.level, self.level
        slope, curvature = total(_energy_along, threads, *fields, self.approach)
        return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0


def taken(
    step: Step, problem: Problem, control: Control, load: float, length: float
) -> tuple[Iterate, float, int]:
    """Iterate after a step, whose energy is not above that before, the length of the next, and the work.

    Parameters
    ----------
    step : Step
    problem, control
    load : float
    length : float
        Fraction of the correction that is added before nodes are released.

    Returns
    -------
    iterate : Iterate
    length : float
        Fraction to begin the next step with.
    evaluations : int
    """
    iterate = evaluate(problem, control, step.pressure_after(length, load))
    fraction, evaluations = step.fraction_of_least_energy(iterate), 1
    while fraction == 0 and evaluations <= MAX_TRIALS:
        length /= SHORTENING
        iterate = evaluate(problem, control, step.pressure_after(length, load, change_state=False))
        fraction, evaluations = step.fraction_of_least_energy(iterate), evaluations + 1
    if fraction < (WHOLE_STEP_BOUNDED if iterate.reached_hardness else WHOLE_STEP):
        between = step.pressure + fraction * (iterate.pressure - step.pressure)
        iterate = evaluate(problem, control, Pressure(step.nodes, between, load, iterate.reached_hardness))
        evaluations += 1
    if fraction < 0.1:
        return iterate, length / SHORTENING, evaluations
    return iterate, min(2 * length, 1.0), evaluations


@sums
def _energy_along(
    pressure: Any, pressure_before: Any, level: Any, level_before: Any, approach: float
) -> tuple[float, float]:
    """Minus the slope of the energy at the start of a step of the pressure, and the curvature along it."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = np.float64(pressure[i]) - np.float64(pressure_before[i])
        slope -= change * (level_before[i] - approach)
        curvature += change * (np.float64(level[i]) - np.float64(level_before[i]))
    return slope, curvature
