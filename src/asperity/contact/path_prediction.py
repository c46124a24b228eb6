"""Pressure to start from on a load path, extrapolated from the last two solutions.

Neither pressure nor gap is smooth in the load at a node that enters or leaves the contact. The difference of
the pressure and a stiffness times the gap, which is negative out of contact, is smooth enough to be
extrapolated over the logarithm of the load. It is shifted, like a pressure by a change of the approach, so
that its positive part has the load that is predicted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from asperity.arguments import LARGEST
from asperity.compiled import compiled
from asperity.contact.solution import Contact
from asperity.types import Array

# The logarithm of what is imposed changes by at most this, and by at most so many times its last change.
# Beyond, the coarse grids give a better start. A path of 14 areas from 0.2 to 12 % takes 2 to 6 % more
# transforms with 0.5.
MAX_LOG_CHANGE = 0.75
MAX_RATIO = 2.5

# Stiffness of the gap, in units of 1 / nodal compliance. With 0.3 and with 1, the error of the start is up to
# 1.4 and 1.8 times larger on rough surfaces of 1024² nodes.
GAP_STIFFNESS = 0.6

# Gaps that correspond to more than so many times the mean pressure are cut off: their nodes stay free.
LARGEST_GAP = 1e6

# The shift is found by so many steps of Newton's method at most, to this relative accuracy of the load.
MAX_SHIFT_STEPS = 20
SHIFT_TOLERANCE = 1e-4


@dataclass(frozen=True)
class _Solved:
    """A solution: logarithms of what was imposed and of the load, and the field that is extrapolated."""

    imposed: float
    load: float
    field: Array


class PathPrediction:
    """Predicts the pressure at the next load of a path. It holds two fields in single precision.

    Parameters
    ----------
    kind : str
        What is imposed: "area_fraction", "mean_pressure", "force" or "approach".
    """

    def __init__(self, kind: str) -> None:
        self._measured_from_contact = kind == "approach"
        self._origin = 0.0
        self._solved: list[_Solved] = []

    def record(self, value: float, contact: Contact) -> None:
        """Take in the solution at a value of what is imposed."""
        if self._measured_from_contact:
            self._origin = float(contact.height.min())
        if not (contact.mean_pressure > 0 and value > self._origin):
            self._solved.clear()
            return
        stiffness = GAP_STIFFNESS * contact.solid.effective_modulus / min(contact.grid.spacing)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            gap = np.fmin(contact.gap * (stiffness / contact.mean_pressure), LARGEST_GAP)
            field = np.where(contact.pressure > 0, contact.pressure * (1 / contact.mean_pressure), -gap)
        solved = _Solved(
            math.log(value - self._origin), math.log(contact.mean_pressure), field.astype(np.float32)
        )
        self._solved = [*self._solved[-1:], solved]

    def pressure(self, value: float) -> Array | None:
        """Pressure to start from at a value of what is imposed; None if it is too far from the last ones."""
        if len(self._solved) < 2 or not isinstance(value, Real) or not self._origin < value <= LARGEST:
            return None
        before, last = self._solved
        step, change = last.imposed - before.imposed, math.log(value - self._origin) - last.imposed
        if step == 0 or not -1 <= (ratio := change / step) <= MAX_RATIO or abs(change) > MAX_LOG_CHANGE:
            return None
        load = math.exp(ratio * (last.load - before.load))
        # Each field is in units of the load of its solution.
        field = last.field * np.float32(1 + ratio)
        field -= np.float32(ratio * math.exp(before.load - last.load)) * before.field
        level = _level_of_mean(field.reshape(-1), load)
        if level is None:
            return None
        field -= np.float32(level)
        np.maximum(field, 0, out=field)
        return field.astype(float) * math.exp(last.load)


def _level_of_mean(values: Array, mean: float) -> float | None:
    """Level above which the values have a given mean over all nodes, by Newton's method; None on failure."""
    level = 0.0
    for _ in range(MAX_SHIFT_STEPS):
        total, count = _excess(values, level)
        if not (count and math.isfinite(total)):
            return None
        error = total / values.size - mean
        if abs(error) <= SHIFT_TOLERANCE * mean:
            return level
        level += error * values.size / count
    return None


@compiled
def _excess(values: Any, level: float) -> tuple[float, int]:
    """Sum of what exceeds a level, and number of values that do."""
    total, count = 0.0, 0
    for i in range(values.size):
        if values[i] > level:
            total += values[i] - level
            count += 1
    return total, count
