"""Compliance of the solid: exact on all nodes, approximate on the contact nodes, and its inverse."""

from __future__ import annotations

from numpy.typing import DTypeLike

from asperity.contact.compliance.free_response import FreeResponse
from asperity.contact.compliance.response import Response
from asperity.core.arguments import choice
from asperity.elasticity.two_bodies import Solid
from asperity.fourier.grid import Grid

RESPONSES: dict[str, type[Response]] = {"periodic": Response, "free": FreeResponse}


def response_on(
    boundary: str,
    solid: Solid,
    grid: Grid,
    dtype: DTypeLike = "float64",
    threads: int = 1,
    omits_mean: bool = False,
) -> Response:
    """Response of a solid on a grid, with a condition at the edge of the map.

    Raises
    ------
    ValueError
        If the condition is unknown, or is not known for this solid.
    """
    choice("boundary", boundary, tuple(RESPONSES))
    if boundary == "free" and solid.height is not None:
        raise ValueError(
            f"boundary = 'free': half-spaces are needed, because the displacement of a layer, here of height "
            f"{solid.height:g}, under an isolated load has no closed form"
        )
    kind = RESPONSES[boundary]
    return kind(solid, kind.transforms(grid, dtype, threads), omits_mean)
