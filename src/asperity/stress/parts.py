"""Linear parts of the stress components."""

from __future__ import annotations

from typing import NamedTuple

from asperity.elasticity.layer import COMPONENTS


class Part(NamedTuple):
    """A linear part of the stress: `constant` times A plus `slope` times B of one component."""

    component: str
    constant: float
    slope: float


ALL_PARTS = (
    *(Part(component, 1.0, 0.0) for component in COMPONENTS),
    Part("xx", 0.0, 1.0),
    Part("xy", 0.0, 1.0),
)
"""Parts A and B of all components, without B_yy, which follows from the others."""
