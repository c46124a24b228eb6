"""Kinds of peaks that are counted: at a contact, below the surface, or both.

A module of its own, because figures need it without the compiled functions of the peaks.
"""

from __future__ import annotations

SELECTIONS = ("all", "at_contact", "interior", "under_contact")
"""Names of the selections of `peaks`."""

LARGEST_AT_SURFACE = (
    "pressure",
    "xx",
    "yy",
    "zz",
    "hydrostatic",
    "principal_1",
    "principal_2",
    "principal_3",
)
"""Quantities whose magnitude is largest in the surface."""


def selection_for(quantity: str) -> str:
    """The selection of `peaks` that figures and claims count for a quantity.

    They count peaks under a contact, and those in the surface only of quantities that are largest there.
    """
    return "at_contact" if quantity in LARGEST_AT_SURFACE else "under_contact"
