"""Control by area: the load is steered to a number of contact nodes while the pressure converges."""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.problem import State

# Contact nodes may miss the area asked for by one half, or by this fraction.
AREA_TOLERANCE = 1e-4

# Loads nearer than this fraction of the pressure's tolerance are not told apart, nor those nearer than this
# fraction of the load of one node.
RESOLUTION = 0.1

# An unconverged pressure steers only if the area misses by more than this many times its estimated error.
# So many times on a grid.
CAUTION = 1.0
EARLY = 8

# Areas nearer than this fraction are reached along a tangent.
NEAR = 0.4


class AreaControl:
    """Steers the load of a state to an area fraction.

    The load follows the guess of the solver, or the area along a power law, whose exponent is learnt from
    the last two loads. Loads whose pressure has converged bracket the one that gives the area. Nodes that
    touch at one load, as on a surface with a symmetry, are gained together: if the area jumps past the one
    asked for, the bracket closes on the jump and the side with the nearer area is taken.

    Parameters
    ----------
    area_fraction : float
    size : int
        Nodes of the grid.
    rtol : float
        Tolerance of the pressure.
    tolerance : float
        Relative to the area asked for.
    """

    def __init__(
        self, area_fraction: float, size: int, rtol: float, tolerance: float = AREA_TOLERANCE
    ) -> None:
        self.target = max(1, round(area_fraction * size))
        self.allowed = max(tolerance * self.target, 0.5)
        self.resolution = RESOLUTION * min(rtol, 1 / self.target)
        self.nearest = False
        self.low = (0.0, 0)
        self.high = (math.inf, size + 1)
        self.width = math.inf
        self.exponent = 1.1
        self.last: tuple[float, int] | None = None
        self.early = EARLY

    def missing(self, state: State) -> float:
        """Logarithm of the area asked for over that of the state."""
        return math.log(self.target / max(1, int(np.count_nonzero(state.pressure))))

    def is_near(self, state: State) -> bool:
        """Whether the area can be reached along a tangent."""
        return abs(self.missing(state)) < NEAR

    def misses(self, state: State, settled: bool) -> bool:
        """Whether the area is certain to differ from the one asked for."""
        if abs(np.count_nonzero(state.pressure) - self.target) <= self.allowed:
            return False
        if settled and self.nearest:
            return False
        # While the pressure is wrong by a fraction, the area may be wrong by as much.
        return settled or (self.early > 0 and abs(self.missing(state)) > CAUTION * state.error)

    def steer(self, state: State, settled: bool, guess: float | None = None) -> bool:
        """Adjust the load of the state; whether that has changed it."""
        if guess is not None and not settled:
            self.early -= 1
            state.load = guess
            return True
        if not self.misses(state, settled):
            return False
        count, missing = int(np.count_nonzero(state.pressure)), self.missing(state)
        if settled:
            self._learn(state.load, max(1, count))
        if guess is None:
            guess = state.load * math.exp(min(max(self.exponent * missing, -0.7), 0.7))
        if not settled:
            self.early -= 1
            state.load = guess
            return True
        if guess == state.load:
            return False
        if missing > 0:
            self.low = max(self.low, (state.load, count))
        else:
            self.high = min(self.high, (state.load, count))
        width = self.high[0] - self.low[0]
        bracketed = self.low[0] > 0 and math.isfinite(width)
        if bracketed and width <= self.resolution * self.high[0]:
            self.nearest = True
            nearest = min((self.low, self.high), key=lambda end: abs(end[1] - self.target))
            if state.load == nearest[0]:
                return False
            state.load = nearest[0]
            return True
        # A guess that does not halve the bracket gives way to the middle.
        if bracketed and not (self.low[0] < guess < self.high[0] and width <= 0.5 * self.width):
            guess = self.low[0] + 0.5 * width
        if bracketed:
            self.width = width
        state.load = guess
        return True

    def _learn(self, load: float, count: int) -> None:
        if self.last is not None and count != self.last[1] and load != self.last[0]:
            slope = math.log(load / self.last[0]) / math.log(count / self.last[1])
            if slope > 0:
                self.exponent = min(max(slope, 0.25), 4.0)
        self.last = (load, count)
