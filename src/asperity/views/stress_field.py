"""A field of the stress in a body under a contact, and how pictures name and colour it."""

from __future__ import annotations

from typing import Any, NamedTuple, TypedDict

import numpy as np

from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.views.maps import largest_magnitude
from asperity.views.scales import SIGNED, STRESS, Look
from asperity.views.source import Source, sources

POSITIVE = ("von_mises", "largest_shear")
"""Fields without a sign."""

_NAMES = {
    "von_mises": "von Mises stress",
    "largest_shear": "largest shear stress",
    "hydrostatic": "hydrostatic stress",
    "principal_1": "largest principal stress",
    "principal_2": "middle principal stress",
    "principal_3": "smallest principal stress",
}


class Stress(NamedTuple):
    """A field of the stress in a body under a contact.

    Parameters
    ----------
    source : Source
    solid : LoadedSolid
    field : str
    settings : dict
        ``poisson``, ``friction`` and ``sliding_direction``, as arguments of `asperity.stress_planes`.
    """

    source: Source
    solid: LoadedSolid
    field: str
    settings: dict[str, Any]


class BodyView(TypedDict, total=False):
    """Arguments of the pictures of the stress in a body; `asperity.plot_section` describes them."""

    body: str
    friction: float | None
    sliding_direction: str | float | None
    unit_system: str | None


def stresses(
    contact: Any, field: str, poisson: float | None, unit_system: str | None = None, **body: Any
) -> list[Stress]:
    """The field in one of the bodies of each result; `body` are arguments of `Source.loaded`."""
    found = []
    for source in sources(contact, unit_system):
        solid, sliding = source.loaded(**body)
        found.append(Stress(source, solid, field, {"poisson": poisson, **sliding}))
    return found


def field_words(field: str) -> str:
    """Name of a field of the stress in plain text."""
    return _NAMES.get(field, f"stress σ_{field}")


def field_name(field: str) -> str:
    """Name of a field of the stress, or of the contact pressure, as pictures show it."""
    if field == "pressure":
        return "contact pressure"
    return _NAMES.get(field, rf"$\sigma_{{{field}}}$")


def field_look(field: str) -> Look:
    """Colours and label of a field of the stress."""
    name = field_name(field)
    if field in POSITIVE:
        return Look(name, "stress", STRESS, "white", np.max, low=0.0)
    return Look(name, "stress", SIGNED, "black", largest_magnitude, signed=True)
