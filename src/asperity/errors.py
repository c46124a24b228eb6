"""Exceptions of the package, and messages of one line.

A message names the argument or key, its value, and what is accepted.
"""

from __future__ import annotations

import sys
from typing import Any

_LONGEST_VALUE = 60


class ConvergenceError(RuntimeError):
    """A contact problem that was not solved to its tolerance.

    Attributes
    ----------
    residual, tolerance : float
        Residual reached, and the tolerance asked for.
    iterations : int
        Applications of the compliance, on all grids.
    load : float
        Mean pressure when the solver stopped.
    """

    def __init__(self, reason: str, residual: float, tolerance: float, iterations: int, load: float) -> None:
        super().__init__(
            f"{reason}: residual {residual:.3g}, tolerance {tolerance:.3g}, "
            f"{iterations} iterations, mean pressure {load:.6g}"
        )
        self.residual = residual
        self.tolerance = tolerance
        self.iterations = iterations
        self.load = load


class DatasetError(RuntimeError):
    """A result file that is missing, damaged or changed since it was written."""


class ConfigError(ValueError):
    """A configuration that is not accepted; the message is one line."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class PlanError(ValueError):
    """A target of accuracy or cost that no measured setting reaches."""


class PreflightError(RuntimeError):
    """A study that cannot run on this machine; the message names the cause and the remedy."""


def one_line(message: str) -> str:
    """Escape line breaks and other characters that are not printable."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in message)


def shown(value: Any) -> str:
    """Shorten the representation of a value for a message."""
    text = repr(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def fail(message: str, code: int = 1) -> int:
    """Print one line on stderr that says why a command ends, and return its exit code."""
    print(f"asperity: {one_line(' '.join(message.split()))}", file=sys.stderr)
    return code
