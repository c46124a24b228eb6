"""Progress of a solver, from the error that it has reached."""

from __future__ import annotations

import math

from asperity.types import Progress


class ConvergenceProgress:
    """Reports the decrease of an error to its tolerance as progress, on a logarithmic scale.

    The progress never decreases, although the error may grow.
    """

    def __init__(self, progress: Progress | None, tolerance: float) -> None:
        self._progress = progress
        self._tolerance = tolerance
        self._largest = 0.0
        self._smallest = math.inf

    def __call__(self, error: float) -> None:
        """Report an error."""
        if self._progress is None or not 0 < error < math.inf:
            return
        self._largest = max(self._largest, error, 2 * self._tolerance)
        self._smallest = max(min(self._smallest, error), self._tolerance)
        total = math.log(self._largest / self._tolerance)
        self._progress(math.log(self._largest / self._smallest), total)
