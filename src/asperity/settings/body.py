"""Settings of an elastic body: its material, coating or layer."""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    GetPydanticSchema,
    PlainSerializer,
    PlainValidator,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)

from asperity.core.units import shown_si
from asperity.settings.map import CounterMap
from asperity.settings.materials import material
from asperity.settings.model import NeededError, Number, Settings, described, optional, setting
from asperity.settings.quantities import STRESS, Hardness, Length, Position, Pressure, Stress


def _filled_by_material(schema: dict[str, Any]) -> None:
    """Take the constants of a material from the keys that a file has to have."""
    schema["required"] = [name for name in schema["required"] if name not in ("young", "poisson")]


class OfMaterial(Settings):
    """Settings that a material of the table fills where they are not given."""

    model_config = ConfigDict(json_schema_extra=_filled_by_material)

    material: str | None = optional(
        "constants are given one by one",
        accepts="the name of a material, as `asperity case --materials` lists them",
        example="100Cr6",
    )
    """Name of a material of the table; its constants hold where the group gives none."""
    young: Pressure = setting(..., default_text="from the material", example="210 GPa", varied=True)
    """Young's modulus."""
    poisson: Number = setting(..., default_text="from the material", gt=-1, le=0.5, example=0.3)
    """Poisson's ratio."""
    yield_stress: Pressure | None = optional(
        "from the material; without a value yielding is not analysed", example="1.5 GPa", varied=True
    )
    """Yield stress; the volume above it is reported."""
    _of_table: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _filled(cls, value: Any, made: Any) -> Any:
        """The group with the constants of its material."""
        if not isinstance(value, Mapping) or not isinstance(value.get("material"), str):
            return made(value)
        filled = {
            name: constant.value
            for name, constant in material(value["material"]).constants.items()
            if name in cls.model_fields
            and value.get(name) is None
            # The hardness of the material does not hold for a coated body.
            and not (name == "hardness" and value.get("coating") is not None)
        }
        if not {"fatigue_torsion", "fatigue_bending"} <= {**value, **filled}.keys():  # one alone is of no use
            filled = {name: constant for name, constant in filled.items() if not name.startswith("fatigue")}
        found = made({**value, **filled})
        found.model_fields_set.difference_update(filled)
        found._of_table = tuple(filled)
        return found

    def gives(self, name: str) -> bool:
        """True if the group itself gives a constant, not its material."""
        return name in self.model_fields_set and getattr(self, name) is not None

    @property
    def of_table(self) -> tuple[str, ...]:
        """Names of the constants that come from the table of materials."""
        return self._of_table


class Coating(OfMaterial):
    """A coating that is bonded to the body, a half-space."""

    thickness: Length = setting(..., example="2 um", varied=True)
    """Thickness of the coating."""
    residual_stress: Stress | None = optional("none", example="-2 GPa")
    """Equal normal stresses along x and y in the coating of the unloaded body, compression negative. They are
    added to the stress in the coating."""


class Layer(Settings):
    """A body that is a layer on a rigid base."""

    height: Length = setting(..., example="5 um")
    """Height of the layer."""
    bottom: Literal["bonded", "frictionless"] = setting("bonded")
    """Lower face of the layer: `bonded` to a rigid base, or on a `frictionless` one."""


class ResidualStress(Settings):
    """A table of equal normal stresses along x and y over depth."""

    depth: tuple[Position, ...] = setting(..., example=["0 um", "50 um", "300 um"])
    """Depths, rising from 0."""
    stress: tuple[Stress, ...] = setting(..., example=["-600 MPa", "-400 MPa", "0 MPa"])
    """Stress at each depth, compression negative."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """Lists that do not belong together."""
        rises = all(first < second for first, second in pairwise(self.depth))
        if len(self.depth) < 2 or len(self.depth) != len(self.stress) or not rises or self.depth[0] < 0:
            yield "depth", ": two or more rising depths ≥ 0 are needed, as many as stresses"


def _residual(value: Any, info: ValidationInfo) -> float | ResidualStress:
    """A stress, or a table of it."""
    if isinstance(value, Mapping):
        return ResidualStress.model_validate(value, context=info.context)
    return value if isinstance(value, ResidualStress) else STRESS(value, info)


def _of_residual(*_: Any) -> dict[str, Any]:
    """Description of a stress or a table of it, in the words of a JSON Schema."""
    return {
        "anyOf": [{"type": "string", "format": "pressure"}, described(ResidualStress)],
        "accepts": f"{STRESS.needed()}, or a group of two lists, depth and stress",
    }


Residual = Annotated[
    float | ResidualStress,
    PlainValidator(_residual),
    PlainSerializer(lambda value: value.written() if isinstance(value, Settings) else STRESS.written(value)),
    GetPydanticSchema(None, _of_residual),
]
"""A stress in Pa, or a table of it over depth."""


class Body(OfMaterial):
    """An elastic body, by default a half-space.

    Numbers are in SI units; texts have their units.

    Raises
    ------
    SettingsError
        With everything that is not accepted.

    Examples
    --------
    >>> steel = asp.Body(young="210 GPa", poisson=0.3, yield_stress=1.5e9)
    >>> film = asp.Body(young=2e9, poisson=0.4, layer={"height": "5 um"})  # on a rigid base
    >>> coated = asp.Body(material="100Cr6", coating={"thickness": "2 um", "young": 400e9, "poisson": 0.25})
    >>> steel.young, coated.young, coated.coating.thickness
    (210000000000.0, 210000000000.0, 2e-06)
    """

    @model_validator(mode="before")
    @classmethod
    def _of_solid(cls, value: Any) -> Any:
        """A half-space or layer of the library, `asperity.Solid`, is a body too."""
        if isinstance(value, Layer):
            raise NeededError("a Body with this layer, such as Body(young=2e9, poisson=0.4, layer=…),")
        if isinstance(value, (Mapping, Settings)) or not hasattr(value, "poisson"):
            return value
        if getattr(value, "base", None) is not None:
            raise NeededError("a Body with a coating, such as Body(young=…, poisson=…, coating={…}),")
        layer = {} if value.height is None else {"layer": {"height": value.height, "bottom": value.bottom}}
        return {"young": value.young, "poisson": value.poisson, **layer}

    hardness: Hardness | None = optional(
        "from the material, if the body has no coating; without a value an elastic contact",
        example="7 GPa",
        varied=True,
    )
    """Hardness, the largest pressure that the body bears; `inf` for an elastic contact. Of the hardnesses
    of two bodies the smaller one is used."""
    conductivity: Number | None = optional("from the material", unit="W/(m K)", gt=0, le=1e5, example=50.0)
    """Thermal conductivity. If one body gives it here, and the other one here or by its material, the contact
    conductance is reported."""
    resistivity: Number | None = optional("from the material", unit="Ω m", gt=0, le=1e20, example=1e-7)
    """Electrical resistivity. If one body gives it here, and the other one here or by its material, the
    contact conductance is reported."""
    fatigue_torsion: Pressure | None = optional(
        "from the material; without a value no stress cycles are reported", example="300 MPa", varied=True
    )
    """Fatigue limit in fully reversed torsion, 0.5 to 1 times the limit in bending."""
    fatigue_bending: Pressure | None = optional(
        "from the material; without a value no stress cycles are reported", example="480 MPa"
    )
    """Fatigue limit in fully reversed bending."""
    residual_stress: Residual | None = optional("none", example="-400 MPa")
    """Equal normal stresses along x and y in the unloaded body, compression negative. They are added to
    the mean stress in the criterion of Dang Van. A group of two lists, `depth` and `stress`, is a table over
    depth, linear between its rows and constant beyond them."""
    coating: Coating | None = optional("no coating")
    """Coating of the body. The hardness is measured on the coated body; yield stress and fatigue limits hold
    below the coating."""
    layer: Layer | None = optional("a half-space")
    """A layer on a rigid base."""
    map: CounterMap | None = optional("the counter body is flat")
    """Height map of the counter body, which is rigid if nothing else is given."""
    _is_rigid: bool = PrivateAttr(False)

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """Settings of the body that exclude each other, or need others."""
        if self.coating is not None and self.layer is not None:
            yield "coating", ": not accepted together with layer"
        if (self.fatigue_torsion is None) != (self.fatigue_bending is None):
            limits = ("fatigue_torsion", "fatigue_bending")
            name, other = limits if self.fatigue_bending is None else reversed(limits)
            yield name, f": needs {other}"
        elif self.residual_stress is not None and self.fatigue_torsion is None:
            yield "residual_stress", ": needs fatigue_torsion and fatigue_bending"

    @classmethod
    def or_rigid(cls, value: Any, made: Any) -> Any:
        """A counter body, which is rigid if its map alone is given."""
        if not (isinstance(value, Mapping) and value.keys() == {"map"} and value["map"] is not None):
            return made(value)
        unused = {"young": "1 Pa", "poisson": 0.0}
        found = made({**value, **unused})
        found.model_fields_set.difference_update(unused)
        found._is_rigid = True
        return found

    @property
    def is_rigid(self) -> bool:
        """True for a counter body of which only the map is given; its constants are then not used."""
        return self._is_rigid

    @property
    def in_words(self) -> str:
        """Material, elastic constants, and coating or layer."""
        layer = ""
        if self.layer is not None:
            layer = f", {shown_si(self.layer.height, 'm')} thick, {self.layer.bottom} bottom"
        if (coating := self.coating) is not None:
            young, poisson = shown_si(coating.young, "Pa"), coating.poisson
            layer = f" under {shown_si(coating.thickness, 'm')} of E = {young}, ν = {poisson:g}"
        name = f"{self.material}: " if self.material else ""
        return f"{name}E = {shown_si(self.young, 'Pa')}, ν = {self.poisson:g}{layer}"

    def is_like(self, other: "Body") -> bool:
        """True if another body has the same constants, coating and layer."""
        return self.model_dump(exclude={"map", "material"}) == other.model_dump(exclude={"map", "material"})
