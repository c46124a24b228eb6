"""A case: the map, the bodies, the load and the questions that are asked.

A group of settings is a class; a case has a field for each. A question is a file in `questions` and a field
here; CONTRIBUTING.md lists its examples and pages. The physics is imported where it is needed: forms, help
and schemas are made without it.
"""

from collections.abc import Mapping
from contextlib import suppress
from functools import cached_property
from typing import Any, Self, get_args

from pydantic import model_validator

from asperity.core.units import shown_si
from asperity.engineering.face import RoughFace
from asperity.engineering.question import Question
from asperity.engineering.questions.adhesion_path import Adhesion
from asperity.engineering.questions.conduction import Conduction
from asperity.engineering.questions.cycles import Cycles
from asperity.engineering.questions.film import Film
from asperity.engineering.questions.leak import Leak
from asperity.engineering.questions.load_curve import LoadCurve
from asperity.engineering.questions.partial_slip import PartialSlip
from asperity.engineering.questions.running_in import RunningIn
from asperity.engineering.questions.sample import SampleOfMaps
from asperity.engineering.questions.sensitivity import Sensitivity
from asperity.engineering.questions.sliding import Sliding
from asperity.engineering.questions.strength import LayerStrength
from asperity.engineering.questions.sweep import Sweep
from asperity.engineering.questions.yielding import Yielding
from asperity.engineering.scene import Scene
from asperity.settings.load import UNITS
from asperity.settings.materials import known_materials, own_materials, table
from asperity.settings.model import SettingsError, optional
from asperity.settings.quantities import split_tolerances


class Case(Scene):
    """Map, bodies, load and questions: everything on which an answer depends. Numbers are in SI units.

    Raises
    ------
    SettingsError
        With everything that is not accepted, or that excludes each other.

    Examples
    --------
    >>> case = asp.Case(map="steel.x3p", body={"material": "100Cr6"}, load={"mean_pressure": "50 MPa"})
    >>> case.load.value, case.body.poisson
    (50000000.0, 0.3)
    """

    adhesion: Adhesion | None = optional("no adhesion")
    """Adhesion: the faces attract each other, and a force pulls them off."""
    film: Film | None = optional("not computed")
    """A film carries a part of the load."""
    running_in: RunningIn | None = optional("not computed")
    """Running-in: first loads flatten the map."""
    sliding: Sliding | None = optional("no friction")
    """Gross sliding."""
    conduction: Conduction | None = optional(
        "computed if both bodies give a conductivity or resistivity themselves"
    )
    """Contact conductance."""
    leak: Leak | None = optional("not computed")
    """Percolation and leakage through the gap."""
    partial_slip: PartialSlip | None = optional("not computed")
    """Partial slip."""
    load_curve: LoadCurve | None = optional("not computed")
    """Load curve."""
    yielding: Yielding | None = optional("computed if a body or its material has a yield stress")
    """Yield."""
    strength: LayerStrength | None = optional("computed if a layer has a strength")
    """Strength of the layers and of their interfaces, by `strength` of each layer."""
    cycles: Cycles | None = optional("computed if a body gives fatigue limits or a residual stress itself")
    """Stress cycles: rolling, sliding, fatigue and shakedown."""
    sensitivity: Sensitivity | None = optional(
        "computed if an input has a tolerance, such as `210 GPa ± 5 %`"
    )
    """Change of the main numbers with each input."""
    sweep: Sweep | None = optional("not computed")
    """Sweep of one or two settings."""
    sample: SampleOfMaps | None = optional("one map, or several that are compared")
    """Several maps of one surface are pooled."""

    @model_validator(mode="wrap")
    @classmethod
    def _expanded(cls, value: Any, made: Any) -> Any:
        """The case, whose inputs may have tolerances, and whose bodies may be of materials of the user."""
        if not isinstance(value, Mapping):
            return made(value)
        value, own = split_tolerances(value), {}
        with suppress(ValueError):  # reported by the check of the field
            own = own_materials(value.get("materials") or {})
            value = {**value, "materials": own}
        with known_materials(own):
            found = made(value)
        bodies = [body for body in (found.body, found.counter_body) if body is not None]
        used = {each.name: each for body in bodies for each in body.materials}
        own = {name: each for name, each in used.items() if table().get(name) != each}
        found.__dict__["materials"] = own or None
        found.model_fields_set.update(["materials"] if own else [])
        return found

    @model_validator(mode="after")
    def _check(self) -> Self:
        found = [*self._problems()]
        if self.map.crop == "fit" and self.hertz_contact is None:
            found += [("map.crop", " = fit: needs a Hertz contact, load.hertz_pressure and load.radius_x")]
        elif self.map.crop == "fit":
            self.__dict__["map"] = self.map.replaced(crop=self.part_in_hertz_contact)
        for question in self.questions.values():
            found += question.problems(self)
        if found:
            raise SettingsError("", dict.fromkeys(found))
        return self

    @classmethod
    def kinds(cls) -> dict[str, type[Question]]:
        """All questions, by the names of their groups."""
        return {
            name: kind
            for name, field in cls.model_fields.items()
            for kind in get_args(field.annotation)
            if isinstance(kind, type) and issubclass(kind, Question)
        }

    @cached_property
    def questions(self) -> dict[str, Question]:
        """The questions that are asked, by the names of their groups."""
        asked = {}
        for name, kind in self.kinds().items():
            if (group := getattr(self, name)) is not None or kind.is_implied(self):
                asked[name] = kind() if group is None else group
        return asked

    def on_face(self, rough: RoughFace) -> Self:
        """The case with the options of the file of its map, and with sliding along the lay."""
        sliding = None if self.sliding is None else self.sliding.along_lay(rough.face)
        return self.with_maps(rough.options or self.map, rough.counter).replaced(sliding=sliding)

    def written(self) -> dict[str, Any]:
        """The settings that are given, as a file holds them: loads of a curve with their unit, too."""
        found, kind = super().written(), self.load.kind
        if self.load_curve is not None and kind != "contact_area_fraction":
            loads = self.load_curve.loads
            written = [each if isinstance(each, str) else shown_si(each, UNITS[kind], 15) for each in loads]
            found["load_curve"]["loads"] = written
        if self.sweep is not None:
            found["sweep"]["values"] = self.sweep.written_values(self)
        return found
