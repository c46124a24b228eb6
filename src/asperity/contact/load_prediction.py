"""Loads of the nested grids at an imposed area, predicted from the solutions on coarser grids."""

from __future__ import annotations

from asperity.contact.area_control import ROUGH_EXPONENT
from asperity.contact.problem import Control

# Change of the logarithm of the load from one grid to the next over the change before, on the finest grid and
# on coarser ones. On rough surfaces with H = 0.2 and 0.8, eight nodes on the shortest wave and areas from 0.2
# to 50 % it is 0.38 to 0.51 on the finest grid.
FINEST_RATIO = 0.46
COARSE_RATIO = 0.4
MAX_GROWTH = 1.5

# A coarse grid is solved at a given load if so many of its nodes shall touch: among fewer, the area does not
# follow the load smoothly.
NODES_AT_GIVEN_LOAD = 300


class LoadPrediction:
    """Predicts the load that gives an area on a grid from the solutions on coarser grids.

    The area at a given load converges with about the first power of the spacing, so that the logarithm of the
    load changes from grid to grid by a little less than half of its last change.

    Parameters
    ----------
    area_fraction : float
    """

    def __init__(self, area_fraction: float) -> None:
        self._area_fraction = area_fraction
        self._loads: list[float] = []

    def next_control(self, load: float, touching: float, size: int, is_finest: bool) -> tuple[Control, float]:
        """What to impose on the next finer grid, and its load, given the solution on the present one.

        If more grids follow, it is the load of the grid after the next one: so the pressure that starts the
        finest grid has been solved at nearly the load of that grid. With few contact nodes the area is
        imposed instead.

        Parameters
        ----------
        load, touching : float
            Mean pressure and area fraction of the solution on the present grid.
        size : int
            Nodes of the next grid.
        is_finest : bool
            True if the next grid is the last one.
        """
        ratio = min(max(self._area_fraction / touching, 0.5), 2.0)
        self._loads.append(load * ratio**ROUGH_EXPONENT)
        imposes_load = (
            not is_finest and len(self._loads) > 1 and self._area_fraction * size >= NODES_AT_GIVEN_LOAD
        )
        power = COARSE_RATIO * (1 + COARSE_RATIO) if imposes_load else FINEST_RATIO
        growth = self._loads[-1] / self._loads[-2] if len(self._loads) > 1 else 1.0
        load = self._loads[-1] * min(max(growth**power, 1 / MAX_GROWTH), MAX_GROWTH)
        imposed = ("mean_pressure", load) if imposes_load else ("area_fraction", self._area_fraction)
        return Control(*imposed), load
