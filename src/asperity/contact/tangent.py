"""Tangent of the contact: its change per change of the approach, and the load it predicts for a contact area.

On a fixed set of contact nodes pressure and gap are linear in the approach. From the tangent follows the
approach at which each node leaves the contact, because its pressure becomes zero, or enters it, because its
gap closes, and so the number of contact nodes as a function of the load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact.area_control import AreaControl
from asperity.contact.inner_response import InnerResponse
from asperity.contact.iterate import Iterate
from asperity.types import Array

# The load changes by at most this fraction of itself along a tangent. Half and twice the value take the same
# number of transforms.
MAX_LOAD_CHANGE = 0.5

# Contact nodes are counted down to the load that is this fraction below the present one, just above lift-off.
MAX_LOAD_DECREASE = 0.999


@dataclass(frozen=True)
class Tangent:
    """Change of the contact per change of the approach, all displacements in units of `unit`.

    Attributes
    ----------
    pressure : (count,) array
        Change of the pressure of the contact nodes.
    load : float
        Change of the mean pressure.
    unit : float
        `Problem.nodal_compliance`.
    response : InnerResponse
        Restricted to the contact nodes.
    displaces : bool
        False for full contact of a solid without uniform displacement, where the approach stays.
    """

    pressure: Array
    load: float
    unit: float
    response: InnerResponse
    displaces: bool = True

    def displacement_at(self, nodes: Array) -> Array:
        """Change of the displacement of other nodes."""
        return self.response.respond_at(nodes, self.pressure) if self.displaces else np.zeros(nodes.size)

    def change_to_area(self, iterate: Iterate, area: AreaControl) -> float | None:
        """Change of the approach that gives the number of contact nodes asked for, or the nearest number.

        The pressure of the iterate has converged. None if no other load within reach gives a better number.
        """
        unit = iterate.load / self.load
        longest = MAX_LOAD_CHANGE * unit
        first, edges = self._edges(iterate, -MAX_LOAD_DECREASE * unit, longest)
        best = self._best(first, edges, iterate, area)
        in_reach = best < edges.size - 2 or best + first > area.target
        if in_reach and edges[best] < 0 < edges[best + 1]:
            return None
        change = 0.5 * (edges[best] + edges[best + 1])
        if best == 0 and edges[1] >= 0 and first > area.target:
            # No lower load has fewer contact nodes.
            change = 0.0
        elif best == edges.size - 2:
            # The number asked for needs a load beyond reach.
            change = longest
        return float(max(change, -longest))

    def _best(self, first: int, edges: Array, iterate: Iterate, area: AreaControl) -> int:
        """Index k for which first + k, the number of contact nodes from edges[k] to edges[k + 1], is best.

        Only numbers of nodes that last while the load changes can be asked for, unless there is none.
        """
        lasting = np.flatnonzero(np.diff(edges) >= area.load_resolution * iterate.load / self.load)
        lasting = lasting if lasting.size else np.arange(edges.size - 1)
        return int(lasting[np.argmin(np.abs(lasting + (first - area.target)))])

    def _edges(self, iterate: Iterate, least: float, longest: float) -> tuple[int, Array]:
        """Number of contact nodes at the change `least`, and the changes up to `longest` where it grows."""
        release = np.full(iterate.pressure.size, -np.inf)
        np.divide(-iterate.pressure, self.pressure, out=release, where=self.pressure > 0)
        # A gap closes by at most the change of the approach.
        nodes, gap = iterate.free_nodes_below(iterate.approach + self.unit * longest)
        closing = np.full(nodes.size, np.inf)
        rate = self.unit * (1 - self.displacement_at(nodes).astype(float))
        np.divide(gap - iterate.approach, rate, out=closing, where=rate > 0)
        changes = np.concatenate((release, closing))
        first = int(np.count_nonzero(changes <= least))
        within = np.sort(changes[(changes > least) & (changes < longest)])
        return first, np.concatenate(([least], within, [longest]))
