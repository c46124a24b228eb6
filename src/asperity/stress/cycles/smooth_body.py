"""Cycles of the stress in a smooth body over which a rough one slides or rolls along x or y.

In steady motion along x the stress moves with the rough body: the point at (y, z) of the smooth body sees the
row σ(·, y, z) as its history, and likewise the column along y. With a periodic map the history repeats; with
a free boundary the point is also unloaded, σ = 0. This is exact for a smooth elastic body under a translating
rough one, at the nodes of the row. Histories of two rough bodies are in `asperity.stress.cycles.histories`.
"""

from functools import partial
from typing import Any

import numpy as np

from asperity.core.errors import shown
from asperity.core.parallel import run_tasks
from asperity.core.types import Array
from asperity.elasticity.layer import COMPONENTS
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.stress.cycles.criteria import Criteria, CycleMaps
from asperity.stress.planes.fields import ROW_MARGIN
from asperity.stress.planes.stream import LinearPlane, uniform_part

TURNED = [1, 0, 2, 4, 3, 5]
"""Components of the stress if x and y change places."""


def axis_of_motion(sliding_direction: Any) -> str:
    """Axis along which a body moves, ``"x"`` or ``"y"``; `ValueError` for another direction."""
    if sliding_direction in ("x", "y"):
        return str(sliding_direction)
    if isinstance(sliding_direction, str) or sliding_direction % 90:
        raise ValueError(
            f"sliding_direction = {shown(sliding_direction)}: x, y or a multiple of 90 is needed for the "
            "stress cycles of a smooth body; another angle of the grid with shifts"
        )
    return "y" if sliding_direction % 180 else "x"


class Cycles(CycleMaps):
    """Cycles of the stress in a smooth body from planes that are streamed anyway, as by `analyse_stress`.

    Parameters
    ----------
    solid : LoadedSolid
    criteria : Criteria
    sliding_direction : "x", "y" or float
        As of `axis_of_motion`.
    poisson : float
    threads : int
    """

    def __init__(
        self,
        solid: LoadedSolid,
        criteria: Criteria,
        sliding_direction: str | float,
        poisson: float,
        threads: int = 1,
    ) -> None:
        self._turned = axis_of_motion(sliding_direction) == "y"
        super().__init__(solid.grid, criteria, "x" if self._turned else "y")
        self._poisson, self._threads = poisson, threads
        self._is_unloaded = solid.boundary == "free"

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        count, (ny, nx) = len(COMPONENTS), plane.grid.shape
        uniform = uniform_part(plane.solid.layer, self._poisson, plane.depth)
        fields = plane.fields(COMPONENTS, [self._poisson] * count, [uniform] * count)
        turned = fields.whole()[TURNED].transpose(0, 2, 1) if self._turned else None
        if turned is not None:
            ny, nx = nx, ny
        rows = max(1, 2**13 // nx)

        def reduced(first: int) -> Array:
            last = min(first + rows, ny)
            if turned is not None:
                return self.criteria.reduced(turned[:, first:last], self._is_unloaded)
            states = fields.rows(first, last)[:, :, ROW_MARGIN : ROW_MARGIN + nx]
            return self.criteria.reduced(states, self._is_unloaded)

        strips = run_tasks([partial(reduced, first) for first in range(0, ny, rows)], self._threads)
        self.take(plane.depth, np.concatenate(list(strips), axis=1))
