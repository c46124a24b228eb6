"""Control by area: chooses the load that gives a number of contact nodes, while the pressure converges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact.iterate import Iterate
from asperity.contact.problem import State

# Contact nodes may differ from the number asked for by one half, or by this fraction of it.
AREA_TOLERANCE = 1e-4

# Loads that differ by less than this fraction of the pressure's tolerance, or of the load of one node, count
# as equal. With 10 instead of 0.1 area control takes twice the transforms on 1024² nodes.
LOAD_RESOLUTION = 0.1

# Before the pressure has converged the load is changed only if the relative error of the area exceeds this
# many times the estimated error of the pressure, and at most so many times on a grid. Most solutions take
# three.
AREA_ERROR_FACTOR = 1.0
MAX_EARLY_CHANGES = 8

# The load follows the tangent of the present contact if the logarithm of its area is within this distance of
# the logarithm of the area asked for, and a power law otherwise.
TANGENT_RANGE = 0.4

# Exponent d(log load)/d(log area) of the power law along which corrections are extended. That of rough
# surfaces of 1024² nodes with H = 0.2 and 0.8 is 1.05 to 1.07 for areas below 20 %, and 1.2 at 50 %. With
# 1.0, area control takes 6 % more transforms. In steps of their own the exponent is learnt, within limits.
ROUGH_EXPONENT = 1.07
FIRST_EXPONENT = 1.1
EXPONENT_LIMITS = (0.25, 4.0)

# Largest change of the logarithm of the load along the power law: a factor of two.
MAX_LOG_CHANGE = 0.7

# A correction is extended to another load if the estimated error of the pressure is below the first limit,
# and if the relative change of the load is above a fraction of that error. The other limit bounds the change.
MAX_STEERED_ERROR = 0.5
LEAST_STEERED_CHANGE = 0.02
MAX_STEERED_CHANGE = 0.3

# Of the nodes that remain after a correction the next one releases some: this fraction of the number that the
# present one releases if the error is large, and in proportion to the error below that. On rough surfaces of
# 1024² nodes it is 0.08 to 0.12 at errors of 3e-2 to 2e-1, and 0.01 to 0.02 at 1e-2.
RELEASED_LATER = 0.1
LARGE_ERROR = 0.05

# Fewer missing nodes than these, and than this fraction of the area, enter the contact one by one, at loads
# that the power law does not know. Those along the tangent are used in so many steps on a grid if the error
# of the pressure is below the limit.
FEW_NODES = 20
FEW_OF_AREA = 0.02
MAX_STEPS_OF_FEW = 2
MAX_ERROR_OF_FEW = 2e-3


@dataclass(frozen=True)
class LoadStep:
    """Change of the load that goes with a correction of the pressure.

    Attributes
    ----------
    load_change : float
        By the power law.
    last_nodes : bool
        True if so few nodes are missing that the loads at which they enter or leave have to be known.
    """

    load_change: float
    last_nodes: bool


class AreaControl:
    """Chooses loads that bring the number of contact nodes to the one asked for.

    A load is proposed by the solver, or extrapolated along a power law load ~ area^exponent, whose exponent
    is learnt from the last two loads at which the pressure converged. These loads also bracket the one that
    gives the area, and the bracket shrinks like that of a bisection. Several nodes may touch at the same
    load, as on a surface with a symmetry. If for that reason the area jumps past the one asked for, the
    bracket closes on the jump, and the side with the nearer area is taken.

    Parameters
    ----------
    area_fraction : float
    size : int
        Number of nodes of the grid.
    rtol : float
        Tolerance of the pressure.
    tolerance : float
        Tolerance of the area, relative to the area asked for.

    Attributes
    ----------
    target : int
        Number of contact nodes asked for.
    load_resolution : float
        Relative difference below which two loads count as equal.
    """

    def __init__(
        self, area_fraction: float, size: int, rtol: float, tolerance: float = AREA_TOLERANCE
    ) -> None:
        self.target = max(1, round(area_fraction * size))
        self.load_resolution = LOAD_RESOLUTION * min(rtol, 1 / self.target)
        self._allowed = max(tolerance * self.target, 0.5)
        self._steered_within = max(AREA_TOLERANCE * self.target, 0.5)
        self._early_changes = self._steps_of_few = 0
        self._exponent = FIRST_EXPONENT
        self._last: tuple[float, int] | None = None
        # Bracket of (load, contact nodes), its width when it was last used, and whether it has closed.
        self._low = (0.0, 0)
        self._high = (math.inf, size + 1)
        self._width = math.inf
        self._closed = False

    def is_near(self, state: State | Iterate) -> bool:
        """True if the area can be extrapolated along the tangent of the present contact."""
        return abs(self._log_ratio(state)) < TANGENT_RANGE

    def may_steer(self, state: State | Iterate) -> bool:
        """True if a correction of the state may be extended to another load."""
        early = self._early_changes < MAX_EARLY_CHANGES
        return early and state.error < MAX_STEERED_ERROR and self.is_near(state)

    def next_step(self, state: State | Iterate, count: int, released: int) -> LoadStep | None:
        """Change of the load that goes with a correction, or None if the load of the state stays.

        Parameters
        ----------
        state : State or Iterate
        count, released : int
            Number of contact nodes to which the correction leads, and of those that it releases.
        """
        later = RELEASED_LATER * released * min(1.0, state.error / LARGE_ERROR)
        expected = max(1.0, count - later)
        missing = abs(expected - self.target)
        if missing <= self._steered_within:
            return None
        few = missing < min(FEW_NODES, FEW_OF_AREA * self.target) and self._steered_within < FEW_NODES / 4
        if few and (state.error > MAX_ERROR_OF_FEW or self._steps_of_few == MAX_STEPS_OF_FEW):
            return None
        change = ROUGH_EXPONENT * math.log(self.target / expected)
        if abs(change) < LEAST_STEERED_CHANGE * state.error:
            return None
        self._early_changes += 1
        self._steps_of_few += few
        change = min(max(change, -MAX_STEERED_CHANGE), MAX_STEERED_CHANGE)
        return LoadStep(state.load * change, few)

    def misses(self, state: State | Iterate, converged: bool) -> bool:
        """True if the area differs from the one asked for by more than the error of the pressure explains."""
        if abs(np.count_nonzero(state.pressure) - self.target) <= self._allowed:
            return False
        if converged:
            return not self._closed
        early = self._early_changes < MAX_EARLY_CHANGES
        return early and abs(self._log_ratio(state)) > AREA_ERROR_FACTOR * state.error

    def next_load(self, state: State | Iterate, converged: bool, guess: float | None = None) -> float | None:
        """Load to go on with, or None if the load of the state stays. It is recorded for the loads to come.

        Parameters
        ----------
        state : State or Iterate
        converged : bool
            True if the pressure has converged at the load of the state.
        guess : float, optional
            Load proposed by the solver. It is taken as it is before the pressure has converged.
        """
        if not converged:
            if guess is None and not self.misses(state, converged):
                return None
            self._early_changes += 1
            return self._extrapolated_load(state) if guess is None else guess
        if not self.misses(state, converged):
            return None
        count = int(np.count_nonzero(state.pressure))
        self._learn_exponent(state.load, max(1, count))
        if guess is None:
            guess = self._extrapolated_load(state)
        return None if guess == state.load else self._bracketed_load(state.load, count, guess)

    def _bracketed_load(self, load: float, count: int, guess: float) -> float | None:
        """The guess, if it lies within the bracket and the bracket shrinks fast, or the bracket's middle.

        Once the bracket has closed, the end with the nearer area, or None if that is the present load.
        """
        if count < self.target:
            self._low = max(self._low, (load, count))
        else:
            self._high = min(self._high, (load, count))
        width = self._high[0] - self._low[0]
        if not (self._low[0] > 0 and math.isfinite(width)):
            return guess
        if width <= self.load_resolution * self._high[0]:
            self._closed = True
            nearest, _ = min((self._low, self._high), key=lambda end: abs(end[1] - self.target))
            return None if load == nearest else nearest
        shrinks = width <= 0.5 * self._width
        self._width = width
        return guess if self._low[0] < guess < self._high[0] and shrinks else self._low[0] + 0.5 * width

    def _extrapolated_load(self, state: State | Iterate) -> float:
        """Load by the power law."""
        change = self._exponent * self._log_ratio(state)
        return state.load * math.exp(min(max(change, -MAX_LOG_CHANGE), MAX_LOG_CHANGE))

    def _log_ratio(self, state: State | Iterate) -> float:
        """Logarithm of the area asked for over that of the state."""
        return math.log(self.target / max(1, int(np.count_nonzero(state.pressure))))

    def _learn_exponent(self, load: float, count: int) -> None:
        if self._last is not None and count != self._last[1] and load != self._last[0]:
            slope = math.log(load / self._last[0]) / math.log(count / self._last[1])
            if slope > 0:
                low, high = EXPONENT_LIMITS
                self._exponent = min(max(slope, low), high)
        self._last = (load, count)
