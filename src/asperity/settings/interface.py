"""Settings of the interface of the bodies: their adhesion."""

from typing import Annotated, Literal

from asperity.settings.model import Settings, setting
from asperity.settings.quantities import Quantity

FIT = "fit"
"""Range that follows from the grid."""


class Attraction(Settings):
    """Attraction of the faces across the gap."""

    work: Annotated[float, Quantity("work of adhesion")] = setting(..., example="50 mJ/m^2", varied=True)
    """Work of adhesion: energy per area that separates the faces."""
    range: Annotated[float | str, Quantity("length", word=FIT)] = setting(FIT, example="20 nm")
    """Length over which the attraction acts; its maximum is work over range. With `fit` the shortest range
    whose cohesive zone spans four pixels."""
    law: Literal["exponential", "maugis-dugdale"] = setting("exponential")
    """Attraction as a function of the gap: `exponential`, or constant up to the range (`maugis-dugdale`)."""
