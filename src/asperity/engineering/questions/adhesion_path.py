"""Adhesion: contacts on a path of approaches forward and back, pull-off force, dissipated energy."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from asperity.contact import Contact, solve_contact
from asperity.contact.adhesion import FITTED_PIXELS, modulus_of_waves, stickiness
from asperity.contact.adhesion import Adhesion as Law
from asperity.contact.solve import approach_of_full_contact
from asperity.core.errors import InputError
from asperity.core.types import Progress
from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.face import RoughFace
from asperity.engineering.question import Findings, Picture, Question, Stages, part_of
from asperity.engineering.records import POSITIVE, SEARCH, Advice, Record
from asperity.engineering.scene import Scene
from asperity.settings.load import FIT, Attraction, Hertz
from asperity.settings.model import SettingsError, Whole, setting

TOPIC = "adhesion"

PULL_OFF, DISSIPATED = "pull-off force", "dissipated energy"

LOOP = "∮ F dδ on the path forward and back"

NO_JUMPS = 1e-4
"""Dissipated energy over the work forward below which the path has no jumps."""

REFUSED = ("film", "running_in", "sliding", "partial_slip", "load_curve", "cycles")
"""Questions whose theory holds without adhesion."""

FAR = 4.0
"""Gap over the range at which the path begins: the exponential attraction has fallen to 2 %."""

MOST_STEPS, FINER = 6, 6
"""Contacts of the path beyond its beginning over those forward, at most; steps about the least force in one
of the path."""

CAPTION = (
    "Force against the normal approach: forward to the load (dashed) and back until the faces are separate. "
    "Negative forces pull; where the branches differ, the enclosed energy is dissipated by jumps."
)


class Adhesion(Attraction, Question):
    """Attraction of the faces, and the path of approaches on which a force pulls them off."""

    ASKS = "Do the faces stick?"
    TILES = (PULL_OFF, DISSIPATED)
    LEAD = "adhesion"
    FILES = ("adhesion",)

    steps: Whole = setting(24, ge=4, le=200)
    """Contacts on the path from the first attraction to the load; more follow on the way back."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Loads and questions incompatible with adhesion, and a range that the grid does not resolve."""
        if rough is not None:
            grid = rough.face.grid
            try:
                law = case.adhesion_on(grid)
                assert law is not None
                law.check_resolved(case.solid, grid)
            except InputError as error:
                yield from error.found
            return
        if isinstance(case.load, Hertz):
            yield "load.radius_x", ": not accepted with adhesion"
        if case.load.kind == "contact_area_fraction":
            yield "load.contact_area_fraction", ": a pressure, a force or an approach is needed with adhesion"
        yield from ((name, ": not accepted with adhesion") for name in REFUSED if name in case.questions)
        leak = case.questions.get("leak")
        if leak is not None and getattr(leak, "seal", None):  # contacts of the search would be those without
            yield "leak.seal", ": not accepted with adhesion"

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """The contacts of the path, or of two paths, each of about ten contacts without adhesion."""
        return 0.0, 30.0 * self.steps * (2 if self.range == FIT else 1)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Pull-off force, dissipated energy, the criterion of stickiness, and the path."""
        law, contact, face = stages.contact.adhesion, stages.contact, stages.face
        assert law is not None
        is_fitted, solid, grid = self.range == FIT, stages.case.solid, face.grid
        share = 0.5 if is_fitted else 1.0
        path, force, error, stabilities = self._path(stages, law, partial(part_of, progress, 0.0, share, 1.0))
        note = ""
        if is_fitted:
            longer = replace(law, range=2 * law.range)
            other = self._path(stages, longer, partial(part_of, progress, share, 1.0, 1.0))[1]
            note = f"{shown_si(other, 'N', 3)} at twice the range"
        words = "" if force > 0 else "none"
        forces, approaches = path["force_N"].to_numpy(), path["normal_approach_m"].to_numpy()
        energy = max(float(np.trapezoid(forces, approaches)), 0.0)
        turns = np.trapezoid(np.abs(forces[: self.steps]), approaches[: self.steps])
        jumps = energy > NO_JUMPS * turns
        zone = law.cohesive_zone(modulus_of_waves(solid, FITTED_PIXELS * max(grid.spacing)))
        fitted = f"the shortest whose cohesive zone spans {FITTED_PIXELS} pixels" if is_fitted else ""
        records = [
            Record(PULL_OFF, force, "N", TOPIC, bounds=POSITIVE, words=words, note=note).with_error(
                SEARCH, error
            ),
            Record(DISSIPATED, energy, "J", TOPIC, bounds=POSITIVE, words="" if jumps else "none", note=LOOP),
            Record("range of the attraction", law.range, "m", TOPIC, note=fitted),
            Record("maximum attraction", law.strength, "Pa", TOPIC),
            Record("cohesive zone", zone, "m", TOPIC),
            Record(
                "stability", contact.certificate.stability, topic=TOPIC, note="above 0: stable as computed"
            ),
        ]
        verdict = "no force is needed to pull the faces off"
        if not words:
            verdict = f"the faces stick: a force of {shown_si(force, 'N', 3)} pulls them off"
        if stages.asked.map.radius is None:
            criterion = stickiness(law, face.height, solid, grid)
            sticks = "rough surfaces stick below 1 (Pastewka and Robbins 2014)"
            records.append(Record("criterion of stickiness", criterion, topic=TOPIC, note=sticks))
            says = "sticks" if criterion < 1 else "does not stick"
            verdict += f"; by the criterion of Pastewka and Robbins the roughness {says}"
        return Findings(
            records=records,
            verdict=verdict,
            assumption="Several contacts may exist at one approach: the answer is the one of first approach, "
            "and the path decides on the way back.",
            warnings=[*_instability(contact.certificate.stability, stabilities)],
            tables={"adhesion": path},
        )

    def _path(
        self, stages: Stages, law: Law, progress: Progress
    ) -> tuple[pd.DataFrame, float, float, list[float]]:
        """The path, the pull-off force, its error by the steps of the approach, and all stabilities."""
        contact = stages.contact
        lowest = float(contact.height.min())
        forward = np.linspace(lowest - FAR * law.range, contact.approach, self.steps).tolist()
        if contact.contact_area_fraction == 1 and not contact.solid.uniform_compliance():
            forward[-1] -= 1e-3 * (forward[-1] - forward[-2])  # full contact has no approach of its own
        if forward[-1] >= approach_of_full_contact(contact.height, contact.solid, contact.boundary):
            found = ": the load flattens the map beyond full contact, where approaches are not computed"
            raise SettingsError("", [("adhesion", f"{found}; a lower load or a higher hardness is needed")])
        step, most, rows = forward[1] - forward[0], MOST_STEPS * self.steps, []
        ahead = [*forward, *forward[-2::-1], *(forward[0] - step * np.arange(1, most)).tolist()]
        last, before, least, stabilities = None, None, 0, list[float]()
        for number, approach in enumerate(ahead):
            after = self._after(stages, law, last, approach)
            stabilities.append(after.certificate.stability)
            row = (approach - lowest, after.force, after.contact_area_fraction, number < len(forward))
            rows.append(row)
            if number >= len(forward) and after.force < rows[least][1]:
                least, before = number, last
            last = after
            progress(number + 1, max(2 * len(forward), number + 2))
            if number >= 2 * len(forward) - 2 and not after.contact_area_fraction:
                break
        names = ("normal_approach_m", "force_N", "contact_area_fraction")
        table = pd.DataFrame([row[:3] for row in rows], columns=names)
        table["branch"] = np.where([row[3] for row in rows], "forward", "back")
        forces = [rows[least][1]]
        if before is not None:
            last, forces = before, [before.force]
            for approach in before.approach - step * np.arange(1, 2 * FINER) / FINER:
                last = self._after(stages, law, last, float(approach))
                forces.append(last.force)
                stabilities.append(last.certificate.stability)
        k = int(np.argmin(forces))
        rises = [forces[each] - forces[k] for each in (k - 1, k + 1) if 0 <= each < len(forces)]
        return table, -forces[k], min(rises, default=0.0), stabilities

    def _after(self, stages: Stages, law: Law, last: Contact | None, approach: float) -> Contact:
        """The contact that follows from the last one, pressing the surface that was flattened there."""
        contact = stages.contact
        return solve_contact(
            contact.height if last is None else last.flattened_height(),
            contact.solid,
            contact.grid,
            approach=approach,
            hardness=contact.hardness,
            adhesion=law,
            boundary=contact.boundary,
            initial=last,
        )

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """Force against approach."""
        yield Picture("adhesion", CAPTION, _drawn(answer.tables["adhesion"]))


def _instability(own: float, of_path: Sequence[float]) -> Iterator[Advice]:
    """A warning on contacts that are in equilibrium, but at no minimum of the energy."""
    unstable = [each for each in of_path if each < 0]
    places = ["the contact of the answer"] if own < 0 else []
    places += [f"of the path, {len(unstable)} of {len(of_path)} contacts"] if unstable else []
    if places:
        least = min(each for each in (own, *unstable) if each < 0)
        text = f"in equilibrium but not stable (stability down to {least:.2g}): {'; '.join(places)}. Real "
        text += "faces jump on to another contact there: area, pull-off force and dissipated energy may be "
        text += "wrong. Increase adhesion.steps, or give a longer adhesion.range or a map of more pixels."
        yield Advice(True, "unstable contact", text)


def _drawn(path: pd.DataFrame) -> Any:
    """Force against the normal approach, forward and back."""
    from asperity.views.panels import canvas

    per, of = scaled_unit(path["normal_approach_m"].to_numpy(), "m")
    factor, symbol = scaled_unit(path["force_N"].to_numpy(), "N")
    turn = int((path["branch"] == "forward").sum())
    branches = {"forward": ("--o", path[:turn]), "back": ("-o", path[turn - 1 :])}
    with canvas([0.8], None) as (figure, (axis,), _):
        axis.axhline(0, color="0.6", lw=0.8)
        for branch, (style, part) in branches.items():
            axis.plot(part["normal_approach_m"] / per, part["force_N"] / factor, style, ms=3, label=branch)
        axis.set_xlabel(f"normal approach ({of})")
        axis.set_ylabel(f"force ({symbol})")
        axis.legend()
    return figure
