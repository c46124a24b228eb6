"""Mixed lubrication: a film carries a part of the load, and the asperities the rest.

The film carries the share s of the smooth pressure: a uniform pressure s p̄ on the map, or the share s of the
Hertz pressure around it. The asperities carry (1 − s) p̄ as a dry contact. The stresses of both parts are
added: s = 0 gives the stress of the dry contact, s → 1 the stress of the smooth bodies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from asperity.engineering.question import Advice, Question, Row, per_cent, row
from asperity.settings.load import Hertz
from asperity.settings.model import Number, optional, setting

if TYPE_CHECKING:
    from asperity.engineering.question import Answer, Case, Contact, LoadedSolid, Progress, RoughFace

GROUP = "film"

SPREAD = 1.6
"""Ratio of the largest to the smallest share of asperities by published correlations, for λ from 0.5 to 1."""


def _balan(ratio: float) -> float:
    """M. R. D. Balan, L. Houpert, A. Tufescu, S. Cretu, Lubricants 3 (2015) 222, Eq. A2, doi
    10.3390/lubricants3020222; 0 beyond its zero at λ = 2.012, where it becomes negative.
    """
    return max(0.0, 1 - 1.21 * ratio**0.64 / (1 + 0.37 * ratio**1.26)) if ratio < 2.012 else 0.0


SHARES_OF_ASPERITIES = {"arana": math.erfc, "balan": _balan}
"""Correlation → share of the load on asperities as a function of λ.

1 − erf λ: A. Arana, J. Larranaga, I. Ulacia, Proc. IMechE J 233 (2019) 303, Eq. 14, doi
10.1177/1350650118778655.
"""


class Film(Question):
    """Mixed lubrication: the share of the load that a film carries.

    λ is the central film thickness of the smooth contact over the composite rms roughness.
    """

    load_share: Number | None = optional("from lambda_ratio", ge=0, lt=1, example=0.7)
    """Share of the load that the film carries; the asperities carry the rest."""
    lambda_ratio: Number | None = optional("load_share is given", ge=0, le=2, example=1.0)
    """Central film thickness of the smooth contact over the composite rms roughness of both faces; the
    share follows by `correlation`."""
    correlation: Literal["arana", "balan"] = setting("arana")
    """Correlation of the share with λ: `arana` (1 − erf λ on asperities, doi 10.1177/1350650118778655) or
    `balan` (doi 10.3390/lubricants3020222)."""

    @property
    def share(self) -> float:
        """Share of the load that the film carries."""
        if self.load_share is not None:
            return self.load_share
        assert self.lambda_ratio is not None
        return 1 - SHARES_OF_ASPERITIES[self.correlation](self.lambda_ratio)

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Settings that a film needs, and settings that it excludes."""
        if (self.load_share is None) == (self.lambda_ratio is None):
            yield "film", ": exactly one of load_share and lambda_ratio is needed"
        elif not self.share < 1:
            whole = "the film carries all of the load by this correlation"
            yield "film.lambda_ratio", f" = {self.lambda_ratio:g}: {whole}"
        if case.load.kind in ("approach", "area_fraction"):
            needed = "a pressure or force is needed with a film, which carries a part of it"
            yield f"load.{case.load.kind}", f": {needed}"
        if case.load_curve is not None:
            yield "load_curve", ": not accepted with film"
        if case.map.periodic == "none":
            yield "map.periodic", " = none: not accepted with film"
        yield from ((key, ": half-spaces are needed with film") for key in case.layers_and_coatings)

    def before_contact(self, case: Case, rough: RoughFace, progress: Progress) -> tuple[Case, RoughFace, Any]:
        """The case in which the asperities carry their share of the load."""
        carried, load = 1 - self.share, case.load
        if isinstance(load, Hertz):
            part = {"mean_pressure": carried * case.cell_pressure}
            part |= {name: getattr(load, name) for name in ("radius_x", "radius_y", "at")}
        else:
            part = {load.kind: carried * load.value}
        return case.replaced(load=part), rough, self.share

    def loaded(self, answer: Answer, contact: Contact, body: str) -> LoadedSolid | None:
        """A body under the pressure of the asperities and the pressure of the film."""
        share = self.share
        if not share:
            return None
        loaded = answer.case.loaded_body(contact, body, 1 - share)
        smooth, pressure = loaded.background, share / (1 - share) * contact.mean_pressure
        film = pressure * loaded.layer.uniform_stress()
        return replace(loaded, background=lambda depth: film if smooth is None else smooth(depth) + film)

    def verdict(self, answer: Answer) -> str:
        """Share of the load on the asperities."""
        return f"the film carries {per_cent(self.share)} of the load, and the asperities the rest"

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Share of the film, and the pressures of film and asperities."""
        share, carried = self.share, answer.contact.mean_pressure
        words = per_cent(share)
        if self.lambda_ratio is not None:
            words += f", by the correlation {self.correlation} at λ = {self.lambda_ratio:g}"
        yield Row(GROUP, "load carried by the film", share, "1", words)
        film = share / (1 - share) * carried
        yield row(GROUP, "mean pressure of the film", film, "Pa")
        yield row(GROUP, "mean pressure carried by asperities", carried, "Pa")

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Spread of published correlations of the share."""
        if self.lambda_ratio is not None:
            low, high = (1 - self.share) / SPREAD, min(1.0, (1 - self.share) * SPREAD)
            text = f"published correlations of the share with λ differ by a factor of {SPREAD:g}: the "
            text += f"asperities carry {per_cent(low)} to {per_cent(high)} of the load at λ = "
            text += f"{self.lambda_ratio:g}."
            short = f"film: the load on asperities is known to a factor of {SPREAD:g}"
            yield Advice(False, "share of the film", text, short, SPREAD - 1)

    def assumption(self, answer: Answer) -> str:
        """The film carries a smooth pressure and no shear traction."""
        return (
            f"A film carries {per_cent(self.share)} of the load as the smooth part of the pressure, without a"
            " shear traction; numbers of the contact hold for the asperities under the rest."
        )
