"""Nodes out of contact whose gap a correction of the pressure closes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.contact.inner_response import InnerResponse
from asperity.contact.inner_solve import Correction
from asperity.contact.iterate import Iterate
from asperity.types import Array


@dataclass(frozen=True)
class ClosingNodes:
    """Nodes out of contact that a correction may bring into contact.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    gap : (count,) array
        h + u before the correction.
    overlap : (count,) array
        δ − (h + u) after the correction, in units of `Problem.nodal_compliance`.
    motion : float
        By how much gaps closed at most.
    """

    nodes: Array
    gap: Array
    overlap: Array
    motion: float

    @classmethod
    def after(
        cls,
        iterate: Iterate,
        correction: Correction,
        response: InnerResponse,
        unit: float,
        further: float = 0.0,
    ) -> ClosingNodes:
        """Nodes whose gap closes under a correction, or if the approach then grows further by some amount."""
        approach = iterate.approach + correction.approach
        # No node moves upward by more than the contact nodes do, which the pressure displaces.
        upward = unit * max(0.0, -float(correction.displacement.min(initial=0)))
        nodes, gap = iterate.free_nodes_below(approach + upward + further)
        overlap = np.empty(gap.size, np.float32)
        kernels.residual(gap, approach, unit, overlap)
        overlap -= response.respond_at(nodes, correction.pressure)
        return cls(nodes, gap, overlap, upward + max(correction.approach, 0.0))
