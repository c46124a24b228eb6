"""Search for the peaks of fields in a stream of planes."""

from __future__ import annotations

import numpy as np

from asperity.spectral import Grid
from asperity.stress.facing import facing_pairs
from asperity.stress.plane_maxima import Maxima, SearchedPlane, plane_maxima
from asperity.stress.refinement import Neighbourhoods, Peaks, peaks_of
from asperity.types import Array


class PeakFinder:
    """Finds the peaks of one or several fields as their planes are added one by one.

    Parameters
    ----------
    boundary : "periodic" | "free"
        That of the contact.

    Attributes
    ----------
    candidates : Maxima or None
        The maxima in the last plane that may be peaks; None before the first plane.
    """

    def __init__(self, boundary: str = "periodic") -> None:
        self._periodic = boundary == "periodic"
        self._found: list[Neighbourhoods] = []
        self._last: SearchedPlane | None = None
        self._depth_above: float | None = None
        self.candidates: Maxima | None = None

    def peaks(self) -> Peaks:
        """All peaks found so far: those of every plane but the last."""
        return peaks_of(self._found, self._periodic)

    def peaks_of_fields(self, fields: int) -> list[Peaks]:
        """The same for each of the fields."""
        every = self.peaks()
        field = np.concatenate([np.empty(0, np.int64), *(found.field for found in self._found)])
        return [every.select(np.flatnonzero(field == number)) for number in range(fields)]

    def add(self, depth: float, grid: Grid, field: Array, floor: float = 0.0) -> None:
        """Add the next plane downward, of one field.

        Parameters
        ----------
        depth : float
        grid : Grid
            With at least three nodes on each axis.
        field : (ny, nx) array
            Of finite numbers in single or double precision; this is not checked. It is kept until the next
            plane.
        floor : float
            Maxima of a magnitude at or below it are left out.
        """
        plane = SearchedPlane.of_field(float(depth), grid, field, self._periodic)
        self.add_maxima(plane, plane_maxima(plane, floor))

    def add_maxima(
        self, plane: SearchedPlane, maxima: Maxima, lower: tuple[Array, Array] | None = None
    ) -> None:
        """Add the next plane downward.

        Parameters
        ----------
        plane : SearchedPlane
            Its arrays must last until the plane after the next is computed.
        maxima : Maxima
            The maxima in it or those of them that exceed the plane above.
        lower : (kept, values), optional
            For the `candidates`: which of them exceed this plane, and the nine values in it; by default they
            are compared here.
        """
        last, upper = self._last, self.candidates
        if last is None:
            # Of the planes that may come first, the surface alone has no neighbour above.
            kept = np.full(maxima.size, plane.depth == 0)
        else:
            if not plane.depth > last.depth:
                raise ValueError(
                    f"depth = {plane.depth!r}: planes rising in depth are needed, below {last.depth}"
                )
            assert upper is not None
            if maxima.above is None:
                kept, maxima.above = last.compare(maxima, plane.grid)
            else:
                kept = np.ones(maxima.size, bool)
            self._finish(last, plane, upper, maxima, kept, lower or plane.compare(upper, last.grid))
            self._depth_above = last.depth
        self.candidates = maxima if kept.all() else maxima.select(np.flatnonzero(kept))
        self._last = plane

    def _finish(
        self,
        last: SearchedPlane,
        plane: SearchedPlane,
        upper: Maxima,
        lower: Maxima,
        lower_kept: Array,
        compared: tuple[Array, Array],
    ) -> None:
        """Decide on the candidates of the last plane, and on those of this plane that face them."""
        kept, below = compared
        if last.grid.shape != plane.grid.shape and upper.size and lower.size:
            pair, partner, wins = facing_pairs(upper, last, lower, plane)
            kept[pair], lower_kept[partner] = wins, ~wins
            # Maxima that win have not been compared with all nine values.
            won, won_below = pair[wins], partner[~wins]
            assert lower.above is not None
            below[won] = plane.values_around(upper.select(won), last.grid)
            lower.above[won_below] = last.values_around(lower.select(won_below), plane.grid)
        depths = None if self._depth_above is None else (self._depth_above, last.depth, plane.depth)
        every = np.flatnonzero(kept)
        if every.size:
            some, under = upper.select(every), below[every]
            above = under if some.above is None else some.above
            found = Neighbourhoods(
                some.field, some.nodes, some.here, above, under, depths, last.depth, last.grid
            )
            self._found.append(found)
