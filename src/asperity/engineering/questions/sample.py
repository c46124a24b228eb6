"""Sample of maps: several maps of one surface are pooled to means with intervals."""

from asperity.engineering.question import Question
from asperity.settings.model import optional
from asperity.settings.quantities import Area


class SampleOfMaps(Question):
    """Several maps, from different places of one surface, are pooled; see `asperity.pool`.

    The group asks for means with 95 % intervals; `map.file` lists the maps.
    """

    area: Area | None = optional("no prediction for a larger area", example="10 mm2")
    """Nominal area on which the maximum pressure and stresses are predicted, from the peaks of the maps."""
