"""Safeguards of the outer loop: the energy of its iterates does not grow, and it ends when it stagnates.

Adding nodes to the contact and releasing nodes in tension can raise the energy, which a correction on a fixed
set of contact nodes cannot. The iterates before and after are both admissible (no tension), and so are those
between them: the step is shortened to the fraction at which the energy is least (compare the projected
searches of Moré & Toraldo 1991, 10.1137/0801008). Without that the iteration diverges on grids of 2048²
nodes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain

import numpy as np

from asperity.contact import kernels
from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.closing import ClosingNodes
from asperity.contact.inner_response import InnerResponse
from asperity.contact.inner_solve import Correction
from asperity.contact.iterate import Iterate
from asperity.contact.places import places_in_union
from asperity.contact.problem import Problem
from asperity.parallel import SMALLEST_PART, apply, in_parts, total
from asperity.types import Array

# On rough surfaces of 512² nodes steps are rarely shortened: halving or doubling any of the factors below
# changes the number of transforms by less than 1 %. They matter on large grids and on thin layers.

# A step is taken whole unless the energy is least at less than this fraction of it.
WHOLE_STEP = 0.9

# If the energy is least at less than this fraction of a step, the next corrections are shortened by the first
# factor before nodes are released; otherwise they are lengthened again by the second, up to their full
# length.
SHORT_STEP = 0.1
SHORTENING = 4
LENGTHENING = 2

# The outer loop gives up after so many steps without an error below a fraction of the smallest before. Of the
# problems of `asperity.validation.extremes` that are solved, none takes more than 6 such steps.
MAX_STEPS_WITHOUT_PROGRESS = 40
PROGRESS_FACTOR = 0.9


class SafeguardedStep:
    """The step from one admissible pressure to the next, shortened so that the energy does not grow.

    Parameters
    ----------
    problem : Problem
    response : InnerResponse
        Restricted to the contact nodes of each system.
    """

    def __init__(self, problem: Problem, response: InnerResponse) -> None:
        self._unit, self._threads = problem.nodal_compliance, problem.fourier.threads
        self._response = response
        self._last: _Step | None = None
        self._fraction = 1.0

    def take(self, iterate: Iterate, correction: Correction) -> float:
        """Add a correction; nodes that it would make penetrate join the contact, nodes in tension leave it.

        Joining nodes are chosen by the gap that the correction leads to, before nodes are released:
        afterwards the pressure is out of equilibrium, and nodes around every patch that lost tension seem to
        penetrate.

        Returns
        -------
        float
            By how much gaps closed at most.
        """
        closing = ClosingNodes.after(iterate, correction, self._response, self._unit)
        joins = closing.overlap > 0
        joining, real = closing.nodes[joins], iterate.pressure.dtype
        places = places_in_union(iterate.nodes, joining)
        joined = np.zeros(iterate.nodes.size + joining.size, np.bool_)
        joined[places] = True
        pairs = (
            (iterate.nodes, joining),
            (iterate.pressure, np.zeros(joining.size, real)),
            (iterate.gap, closing.gap[joins]),
            (correction.pressure.astype(real), (JOIN_STIFFNESS * closing.overlap[joins]).astype(real)),
        )
        inserted = in_parts(
            lambda some: [kernels.inserted(places, *pair) for pair in pairs[some]],
            len(pairs),
            self._threads if joined.size > SMALLEST_PART else 1,
            smallest=1,
        )
        nodes, pressure, gap_before, change = chain.from_iterable(inserted)
        self._last = _Step(pressure, gap_before, change, joined, self._threads)
        iterate.set_pressure(nodes, self._last.pressure_after(self._fraction))
        return closing.motion

    def best_fraction(self, iterate: Iterate) -> float:
        """Fraction of the last step at which the energy is least; 1 if there was none."""
        if self._last is None:
            return 1.0
        step = self._last
        before = step.pressure_before, iterate.gap, step.gap_before
        slope, curvature = total(
            kernels.energy_along, self._threads, iterate.pressure, *before, iterate.approach
        )
        return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0

    def shorten(self, iterate: Iterate, fraction: float) -> None:
        """Shorten the last step; the gap has to be evaluated anew if that is noticeable."""
        if self._last is None:
            return
        if fraction < WHOLE_STEP:
            before = self._last.pressure_before
            iterate.set_pressure(iterate.nodes, before + fraction * (iterate.pressure - before))
        self._last = None
        if fraction < SHORT_STEP:
            self._fraction /= SHORTENING
        else:
            self._fraction = min(LENGTHENING * self._fraction, 1.0)

    def repeat_shorter(self, iterate: Iterate) -> None:
        """Add the last correction again, shortened before nodes are released."""
        assert self._last is not None
        self._fraction /= SHORTENING
        iterate.set_pressure(iterate.nodes, self._last.pressure_after(self._fraction, joins=False))

    def forget(self) -> None:
        """Forget the last step, because the iterate has been changed otherwise since."""
        self._last = None


@dataclass(frozen=True)
class _Step:
    """A step on the nodes in contact before it, and on those that joined the contact."""

    pressure_before: Array
    gap_before: Array
    change: Array
    joined: Array
    threads: int

    def pressure_after(self, fraction: float, joins: bool = True) -> Array:
        """Pressure after a fraction of the correction, with nodes that join or without."""
        out = np.empty_like(self.pressure_before)
        fields = self.pressure_before, self.change, self.joined
        factors = out.dtype.type(fraction), out.dtype.type(joins)
        apply(kernels.add_and_release, self.threads, *fields, *factors, out)
        return out


class Stagnation:
    """Counts the steps since the error last decreased noticeably."""

    def __init__(self) -> None:
        self._steps = 0
        self._smallest = math.inf

    @property
    def allows_more(self) -> bool:
        """True if a step without progress may follow."""
        return self._steps < MAX_STEPS_WITHOUT_PROGRESS

    @property
    def gives_up(self) -> bool:
        """True if there were too many steps without progress."""
        return self._steps > MAX_STEPS_WITHOUT_PROGRESS

    def record(self, error: float) -> None:
        """Record the error after a step."""
        if error < PROGRESS_FACTOR * self._smallest:
            self._steps, self._smallest = 0, error
        else:
            self._steps += 1

    def record_repetition(self) -> None:
        """Record a step that is repeated."""
        self._steps += 1

    def forget_error(self) -> None:
        """Accept any error as progress, because the load has changed."""
        self._smallest = math.inf
