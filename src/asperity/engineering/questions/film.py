"""Mixed lubrication: a film carries a part of the load, and the asperities the rest.

The film carries the fraction s of the smooth pressure: a uniform pressure s p̄ on the map, or the fraction s
of the Hertz pressure around it. The asperities carry (1 − s) p̄ as a dry contact. The stresses of both parts
are added: s = 0 gives the stress of the dry contact, s → 1 the stress of the smooth bodies.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Literal

import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.face import RoughFace
from asperity.engineering.press import mean_pressure
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import Advice, Record, fraction, per_cent
from asperity.engineering.scene import Scene
from asperity.settings.load import Hertz
from asperity.settings.model import Number, optional, setting

SAME_SHARE = 0.01
"""Relative difference of correlations below which nothing is said about it."""


def _balan(ratio: float) -> float:
    """M. R. D. Bălan, L. Houpert, A. Tufescu, D. N. Olaru, Lubricants 3 (2015) 222, Eq. A2, doi
    10.3390/lubricants3020222; 0 beyond its zero at Λ = 2.012, where it becomes negative.
    """
    return max(0.0, 1 - 1.21 * ratio**0.64 / (1 + 0.37 * ratio**1.26)) if ratio < 2.012 else 0.0


SHARES_OF_ASPERITIES = {"arana": math.erfc, "balan": _balan}
"""Correlation → load fraction of the asperities as a function of Λ.

1 − erf Λ: A. Arana, J. Larranaga, I. Ulacia, Proc. IMechE J 233 (2019) 303, Eq. 14, doi
10.1177/1350650118778655.
"""


LARGEST_RATIO = 2.0
"""Largest Λ of the correlations."""


class Film(Question):
    """Mixed lubrication: the fraction of the load that a film carries.

    Λ is the central film thickness of the smooth contact over the composite rms roughness.
    """

    ASKS = "Does a lubricant film carry a part?"
    TILES = ("load fraction of the film",)

    load_fraction: Number | None = optional("from lambda_ratio", ge=0, lt=1, example=0.7, varied=True)
    """Fraction of the load that the film carries; the asperities carry the rest."""
    lambda_ratio: Number | None = optional(
        "load_fraction is given", ge=0, accepts="a number from 0 to 2", example=1.0, varied=True
    )
    """Central film thickness of the smooth contact over the composite rms roughness of both faces; the
    fraction follows by `correlation`."""
    correlation: Literal["arana", "balan"] = setting("arana")
    """Correlation of the fraction with Λ: `arana` (1 − erf Λ on asperities, doi 10.1177/1350650118778655) or
    `balan` (doi 10.3390/lubricants3020222)."""

    @property
    def share(self) -> float:
        """Fraction of the load that the film carries."""
        if self.load_fraction is not None:
            return self.load_fraction
        assert self.lambda_ratio is not None
        return 1 - SHARES_OF_ASPERITIES[self.correlation](self.lambda_ratio)

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Settings that a film needs, and settings that it excludes."""
        if (self.load_fraction is None) == (self.lambda_ratio is None):
            yield "film", ": exactly one of load_fraction and lambda_ratio is needed"
        elif self.lambda_ratio is not None and self.lambda_ratio > LARGEST_RATIO:
            beyond = f"the asperities carry less than {per_cent(math.erfc(LARGEST_RATIO))} of the load"
            needed = (
                f"a number ≥ 0 and ≤ {LARGEST_RATIO:g} is needed; beyond it {beyond} and the correlations"
            )
            remedy = "no longer hold: leave the map out and take the stress of the smooth bodies, or give"
            text = f" = {self.lambda_ratio:g}: {needed} {remedy} film.load_fraction"
            yield "film.lambda_ratio", text
        elif not self.share < 1:
            whole = "the film carries all of the load by this correlation"
            yield "film.lambda_ratio", f" = {self.lambda_ratio:g}: {whole}"
        if case.load.kind in ("normal_approach", "contact_area_fraction"):
            needed = "a pressure or force is needed with a film, which carries a part of it"
            yield f"load.{case.load.kind}", f": {needed}"
        if "load_curve" in case.questions:
            yield "load_curve", ": not accepted with film"
        if free := case.map.free_edges:
            yield free[0], f" = {free[1]}: not accepted with film"
        yield from ((key, ": half-spaces are needed with film") for key in case.layers_and_coatings)

    def prepare(self, case: Any, rough: RoughFace, progress: Progress) -> tuple[Any, RoughFace, None]:
        """The case in which the asperities carry their fraction of the load.

        Where asperities touch, their pressure and that of the film together reach at most the hardness.
        """
        carried, load, nominal = 1 - self.share, case.load, mean_pressure(case, rough)
        part = {load.kind: carried * load.value}
        if isinstance(load, Hertz):
            part = {"mean_pressure": carried * nominal, **load.place}
        softer = {
            name: body.replaced(hardness=body.hardness - self.share * nominal)
            for name, body in case.groups_of_bodies.items()
            if body.hardness is not None and case.hardness is not None
        }
        if (running_in := case.questions.get("running_in")) is not None and running_in.hardness is not None:
            lower = running_in.hardness - self.share * nominal
            softer["running_in"] = running_in.replaced(hardness=lower)
        return case.replaced(load=part, sensitivity=None, **softer), rough, None

    def loaded(self, loaded: LoadedSolid, contact: Contact, tractions: xr.Dataset | None) -> LoadedSolid:
        """A body under the pressure of the asperities and the pressure of the film."""
        if not self.share:
            return loaded
        smooth, pressure = loaded.background, self.share / (1 - self.share) * contact.mean_pressure
        film = pressure * loaded.layer.uniform_stress()
        return replace(loaded, background=lambda depth: film if smooth is None else smooth(depth) + film)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Fraction of the load on the film, and the pressures of film and asperities."""
        share, carried, topic = self.share, stages.contact.mean_pressure, "film"
        note, warnings = "", list[Advice]()
        if self.lambda_ratio is not None:
            note = f"by the correlation {self.correlation} at Λ = {self.lambda_ratio:g} (central thickness)"
            known = [of(self.lambda_ratio) for of in SHARES_OF_ASPERITIES.values()]
            low, high = min(known), max(known)
            size = high / low - 1 if low else math.inf
            text = f"by the published correlations {', '.join(SHARES_OF_ASPERITIES)} the asperities carry "
            text += f"{per_cent(low)} to {per_cent(high)} of the load at Λ = {self.lambda_ratio:g}; give "
            text += "the load fraction of the film where it is known better (film.load_fraction)."
            short = f"film: asperities carry {per_cent(low)} to {per_cent(high)} of the load by correlations"
            warnings += [Advice(size > 1, "load fraction of the film", text, short, size)] * (
                size >= SAME_SHARE
            )
            thinner = SHARES_OF_ASPERITIES[self.correlation](0.9 * self.lambda_ratio)
            text = "Λ is that of the central film thickness. If it is 10 % lower, the asperities carry "
            text += f"{per_cent(thinner)} of the load in place of {per_cent(1 - share)}."
            warnings.append(Advice(False, "film thickness", text))
        film = share / (1 - share) * carried
        records = [
            fraction("load fraction of the film", share, topic=topic, note=note),
            Record("mean pressure of the film", film, "Pa", topic),
            Record("mean pressure carried by asperities", carried, "Pa", topic),
        ]
        return Findings(
            records=records,
            verdict=f"the asperities carry {per_cent(1 - share)} of the load, and the film the rest",
            warnings=warnings,
            assumption=f"The asperities carry {per_cent(1 - share)} of the load, on which the numbers of the "
            "contact depend; the film carries the rest as the smooth part of the pressure, without shear.",
        )
