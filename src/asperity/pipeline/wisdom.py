"""Stage wisdom: measured plans of FFTW for the grids of a study."""

from __future__ import annotations

from collections.abc import Iterable

from asperity.engines.wisdom import measure_wisdom
from asperity.spectral import Grid
from asperity.stress.truncation import coarser_grids
from asperity.types import Progress

SHORTEST = 128
"""Lines of fewer nodes are transformed as fast by estimated plans."""


def measure_plans(points: Iterable[int], progress: Progress | None = None) -> str:
    """Text of a wisdom file for contacts and stresses on square grids of these numbers of nodes.

    Parameters
    ----------
    points : iterable of int
        Nodes on an edge. The solver of the contact and the deep planes of the stress use coarser grids too.
    progress : callable, optional

    Raises
    ------
    MissingPackageError
        If pyFFTW is not installed.
    """
    return measure_wisdom({length for edge in points for length in lengths(edge)}, progress)


def lengths(points: int) -> set[int]:
    """Lengths of lines on the grids of a calculation on this number of nodes, but the shortest ones."""
    grids = coarser_grids(Grid((points, points)))
    return {points} | {grid.shape[0] for grid in grids if grid.shape[0] >= SHORTEST}
