"""Safeguards of the outer loop: the energy of its iterates does not grow, and it ends when it stagnates.

Adding nodes to the contact and releasing nodes in tension can raise the energy, which a correction on a fixed
set of contact nodes cannot. The iterates before and after are both admissible (no tension), and so are those
between them: the step is shortened to the fraction at which the energy is least (compare the projected
searches of Moré & Toraldo 1991, 10.1137/0801008). Without that the iteration diverges on grids of 2048²
nodes.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact import kernels
from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.inner_solve import ContactSystem, Correction
from asperity.contact.problem import Problem, State
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
    """

    def __init__(self, problem: Problem) -> None:
        self._unit = problem.nodal_compliance
        self._pressure_before = np.empty(problem.grid.size, problem.fourier.real)
        self._gap_before = np.empty(problem.grid.shape, problem.fourier.real)
        self._correction: tuple[Array, Array] | None = None
        self._fraction = 1.0

    def take(self, state: State, system: ContactSystem, correction: Correction) -> None:
        """Add a correction; nodes that it would make penetrate join the contact, nodes in tension leave it.

        Joining nodes are chosen by the gap that the correction leads to, before nodes are released:
        afterwards the pressure is out of equilibrium, and nodes around every patch that lost tension seem to
        penetrate.
        """
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        self._pressure_before[:] = pressure
        self._correction = system.contact_nodes, correction.pressure
        kernels.add_penetrating_nodes(
            pressure,
            gap,
            correction.displacement,
            state.approach + correction.approach,
            self._unit,
            JOIN_STIFFNESS,
        )
        kernels.add_and_release(pressure, *self._correction, np.float32(self._fraction))
        state.gap, self._gap_before = self._gap_before, state.gap

    def shorten(self, state: State, may_repeat: bool) -> bool:
        """Shorten the last step to where the energy is least; True if the state is the one to go on from.

        If the energy is least where the step began and `may_repeat`, the same correction is added again,
        shortened before nodes are released. Then the gap has to be evaluated anew.
        """
        if self._correction is None:
            return True
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        gap_before = self._gap_before.reshape(-1)
        fraction = kernels.line_search(pressure, self._pressure_before, gap, gap_before, state.approach)
        if fraction < WHOLE_STEP:
            kernels.interpolate(pressure, self._pressure_before, fraction)
            kernels.interpolate(gap, gap_before, fraction)
        if fraction == 0 and may_repeat:
            self._fraction /= SHORTENING
            kernels.add_and_release(pressure, *self._correction, np.float32(self._fraction))
            return False
        if fraction < SHORT_STEP:
            self._fraction /= SHORTENING
        else:
            self._fraction = min(LENGTHENING * self._fraction, 1.0)
        return True

    def forget(self) -> None:
        """Forget the last step, because the state has been changed otherwise since."""
        self._correction = None


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
