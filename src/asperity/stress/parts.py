"""A linear part of one stress component."""

from __future__ import annotations

from typing import NamedTuple


class Part(NamedTuple):
    """A linear part of the stress: `constant` times A plus `slope` times B of one component."""

    component: str
    constant: float
    slope: float
