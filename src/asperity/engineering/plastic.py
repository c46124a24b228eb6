"""Plastic contact of an answer: the hardness that was given, or the one that the yield stress suggests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from asperity.contact import Contact
from asperity.engineering.case import Case

HARDNESS_OVER_YIELD = 3.0
"""Indentation hardness over yield stress (D. Tabor, The Hardness of Metals, 1951)."""


@dataclass(frozen=True)
class PlasticContact:
    """What a hardness makes of a contact.

    Parameters
    ----------
    hardness : float
        In Pa.
    is_given : bool
        False if it follows from the yield stress, and the answer is that of the elastic contact.
    plasticity_index : float
        E* ḡ / H, with the rms gradient ḡ of the surface that was pressed.
    area_fraction, plastic_area : float
        Real contact and area at the hardness over the nominal area.
    plastic_load : float
        Share of the load at the hardness.
    plastic_depth : float
        Largest depth by which the surface is flattened, in m.
    """

    hardness: float
    is_given: bool
    plasticity_index: float
    area_fraction: float
    plastic_area: float
    plastic_load: float
    plastic_depth: float


def suggested_hardness(case: Case) -> float | None:
    """Hardness that the yield stresses of a case without hardness suggest; None without a yield stress."""
    limits = [body.yield_stress for body in case.bodies.values() if body.yield_stress is not None]
    return HARDNESS_OVER_YIELD * min(limits) if limits and case.hardness is None else None


def plastic_contact(
    case: Case, contact: Contact, rms_gradient: float, press: Callable[[float, float], Contact]
) -> PlasticContact | None:
    """What the hardness of a case, or the suggested one, makes of its contact.

    Parameters
    ----------
    case : Case
    contact : Contact
        Of the case, with its hardness if it has one.
    rms_gradient : float
    press : callable
        Contact under a mean pressure with a hardness.

    Returns
    -------
    PlasticContact or None
        None without a hardness and if the elastic pressure stays below the suggested one, or no contact bears
        the load.
    """
    hardness = case.hardness or suggested_hardness(case)
    if hardness is None:
        return None
    if case.hardness is None:
        if not contact.mean_pressure < hardness < contact.max_pressure:
            return None
        contact = press(contact.mean_pressure, hardness)
    depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
    index = contact.solid.effective_modulus * rms_gradient / hardness
    areas = contact.area_fraction, contact.plastic_area, contact.plastic_load
    return PlasticContact(hardness, case.hardness is not None, index, *areas, depth)
