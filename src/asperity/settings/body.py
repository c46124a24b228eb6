"""Settings of an elastic body: its material, layers and base."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import accumulate, pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import (
    ConfigDict,
    GetPydanticSchema,
    PlainSerializer,
    PlainValidator,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)

from asperity.core.errors import shown
from asperity.core.units import shown_si
from asperity.settings.map import CounterMap
from asperity.settings.materials import Constant, Material, known_materials, material
from asperity.settings.model import (
    Number,
    Settings,
    SettingsError,
    described,
    nested,
    optional,
    setting,
)
from asperity.settings.quantities import STRESS, Hardness, Length, Position, Pressure, Stress

UNUSED = {"young": "1 Pa", "poisson": 0.0}
"""Constants in place of those that a body has not: of a rigid one, and until those of its layer are known."""

HARDNESS_OVER_YIELD = 3.0
"""Indentation hardness over yield stress (D. Tabor, The Hardness of Metals, 1951)."""

OF_LAYER = ("material", "young", "poisson", "yield_stress")
"""Settings that a layer on a rigid base has in place of its body."""


class OfMaterial(Settings):
    """Settings that a material of the table fills where they are not given."""

    material: str | None = optional(
        "constants are given one by one",
        accepts="the name of a material, as `asperity case --materials` lists them",
        example="100Cr6",
    )
    """Material of the table, whose constants hold where none are given."""
    young: Pressure = setting(..., default_text="from the material", example="210 GPa", varied=True)
    """Young's modulus."""
    poisson: Number = setting(..., default_text="from the material", gt=-1, le=0.5, example=0.3)
    """Poisson's ratio."""
    yield_stress: Pressure | None = optional(
        "from the material, else no analysis of yield", example="1.5 GPa", varied=True
    )
    """Yield stress; the volume above it is reported."""
    _material: Material | None = PrivateAttr(None)
    _filled_names: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _filled(cls, value: Any, made: Any) -> Any:
        """The group with the constants of its material."""
        if not isinstance(value, Mapping) or not isinstance(value.get("material"), str):
            return made(value)
        known, is_coated = material(value["material"]), value.get("layers") and value.get("base") is None
        filled = {
            name: constant.value
            for name, constant in known.constants.items()
            if name in cls.model_fields
            and value.get(name) is None
            # The hardness of the material does not hold for a coated body.
            and not (name == "hardness" and is_coated)
        }
        if not {"fatigue_torsion", "fatigue_bending"} <= {**value, **filled}.keys():  # one alone is of no use
            filled = {name: constant for name, constant in filled.items() if not name.startswith("fatigue")}
        found = made({**value, **filled})
        found.model_fields_set.difference_update(filled)
        found._material, found._filled_names = known, tuple(filled)
        return found

    def replaced(self, **changes: Any) -> Self:
        """The settings with other values of some of them; the materials stay as they were read."""
        with known_materials({each.name: each for each in self.materials}):
            return super().replaced(**changes)

    def gives(self, name: str) -> bool:
        """True if the group itself gives a constant, not its material."""
        return name in self.model_fields_set and getattr(self, name) is not None

    @property
    def from_material(self) -> dict[str, Constant]:
        """The constants that were taken from the material, with their sources, by name."""
        return {name: self._material.constants[name] for name in self._filled_names if self._material}

    @property
    def materials(self) -> list[Material]:
        """The materials of the group and of the groups in it."""
        inner = [each for layer in getattr(self, "layers", ()) for each in layer.materials]
        return inner if self._material is None else [self._material, *inner]


class Strength(Settings):
    """Strengths of a layer and of the interface below it."""

    shear: Pressure | None = optional("not judged", example="500 MPa", varied=True)
    """Shear strength of the interface below the layer."""
    tension: Pressure | None = optional("not judged", example="300 MPa", varied=True)
    """Tensile strength of the interface below the layer."""
    energy: Number | None = optional("not judged", unit="J/m^2", gt=0, le=1e9, example=50.0, varied=True)
    """Fracture energy of the layer, for a crack through its thickness."""
    toughness: Number | None = optional(
        "not judged", unit="Pa m^(1/2)", gt=0, le=1e12, example=3e6, varied=True
    )
    """Fracture toughness of the layer, in place of its fracture energy."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """Two values of the same property, or none."""
        if not self.written():
            yield "", ": one of shear, tension, energy and toughness is needed"
        if self.energy is not None and self.toughness is not None:
            yield "toughness", ": not accepted together with energy"


class Layer(OfMaterial):
    """A layer of a body."""

    model_config = ConfigDict(json_schema_extra={"required": ["thickness"]})

    thickness: Length = setting(..., example="2 um", varied=True)
    """Thickness of the layer."""
    residual_stress: Stress | None = optional("none", example="-2 GPa")
    """Equal normal stresses along x and y in the layer, compression negative, added to its stress. For a
    single layer on a rigid base, give the residual stress of the body."""
    strength: Strength | None = optional("not judged", example={"shear": "500 MPa", "tension": "300 MPa"})
    """Strengths with which the stress is compared."""


class ResidualStress(Settings):
    """A table of equal normal stresses along x and y over depth."""

    depth: tuple[Position, ...] = setting(..., example=["0 um", "50 um", "300 um"])
    """Rising depths ≥ 0. The stress is constant above the first and below the last of them."""
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
        return nested(ResidualStress, value, info)
    return value if isinstance(value, ResidualStress) else STRESS(value, info)


Residual = Annotated[
    float | ResidualStress,
    PlainValidator(_residual),
    PlainSerializer(lambda value: value.written() if isinstance(value, Settings) else STRESS.written(value)),
    GetPydanticSchema(
        None,
        lambda *_: {
            "anyOf": [{"type": "string", "format": "pressure"}, described(ResidualStress)],
            "accepts": f"{STRESS.needed()}, or a table {{depth: [0 um, 50 um], stress: [-600 MPa, 0 MPa]}}",
        },
    ),
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
    >>> coating = {"thickness": "2 um", "young": 400e9, "poisson": 0.25}
    >>> coated = asp.Body(material="100Cr6", layers=[coating])
    >>> film = asp.Body(layers=[{"thickness": "5 um", "young": 2e9, "poisson": 0.4}], base="bonded")
    >>> coated.young, coated.layers[0].thickness, film.young
    (210000000000.0, 2e-06, 2000000000.0)
    """

    model_config = ConfigDict(json_schema_extra={"required": []})

    @model_validator(mode="wrap")
    @classmethod
    def _of_solid_or_layer(cls, value: Any, made: Any) -> Any:
        """A solid of the library is a body too; one on a rigid base has the constants of its layer."""
        if hasattr(value, "poisson") and not isinstance(value, (Mapping, Settings)):
            value = _group_of(value)
        layers = value.get("layers") if isinstance(value, Mapping) else None
        if not (isinstance(layers, (list, tuple)) and layers and value.get("base") is not None):
            return made(value)._with_hardness()
        if wrong := [name for name in OF_LAYER if value.get(name) is not None]:
            text = f" = {shown(value['base'])}: {', '.join(wrong)} belong to layers.0 on a rigid base"
            raise SettingsError("", [("base", text)])
        given, top = {**value, **UNUSED}, layers[0]
        name = top.get("material") if isinstance(top, Mapping) else getattr(top, "material", None)
        with suppress(SettingsError):  # of a material that is not known, which the layer reports
            given["material"] = material(name).name if isinstance(name, str) and len(layers) == 1 else None
        found = made(given)
        found.__dict__.update({each: getattr(found.layers[0], each) for each in OF_LAYER})
        found.model_fields_set.difference_update(OF_LAYER)
        found._filled_names = tuple(each for each in found._filled_names if each not in OF_LAYER)
        return found._with_hardness()

    def _with_hardness(self) -> Self:
        """The body with the hardness that its yield stress suggests, where none is given.

        A coated body has none: its hardness is neither that of the coating nor that of the base.
        """
        if self.hardness is None and self.yield_stress is not None and len(self.parts) == 1:
            self.__dict__["hardness"] = HARDNESS_OVER_YIELD * self.yield_stress
            self._hardness_is_estimated = True
        return self

    hardness: Hardness | None = optional(
        "from the material if not coated, else 3 times the yield stress (Tabor), else an elastic contact",
        example="7 GPa",
        varied=True,
    )
    """Hardness, the maximum pressure; `inf`: an elastic contact. The smaller hardness of two bodies holds."""
    conductivity: Number | None = optional("from the material", unit="W/(m K)", gt=0, le=1e5, example=50.0)
    """Thermal conductivity, for the contact conductance."""
    resistivity: Number | None = optional("from the material", unit="Ω m", gt=0, le=1e20, example=1e-7)
    """Electrical resistivity, for the contact conductance."""
    fatigue_torsion: Pressure | None = optional(
        "from the material, else no stress cycles", example="300 MPa", varied=True
    )
    """Fatigue limit in fully reversed torsion, 0.5 to 1 times the limit in bending."""
    fatigue_bending: Pressure | None = optional("from the material, else no stress cycles", example="480 MPa")
    """Fatigue limit in fully reversed bending."""
    residual_stress: Residual | None = optional("none", example="-400 MPa")
    """Equal normal stresses along x and y in the unloaded body, compression negative; part of the mean stress
    in the criterion of Dang Van. A table over depth is linear between its rows and constant beyond."""
    layers: tuple[Layer, ...] = setting(
        (),
        default_text="none",
        accepts="a list of groups of keys",
        example=[{"thickness": "2 um", "young": "400 GPa", "poisson": 0.25}],
    )
    """Layers, the top one first, bonded to each other. On a half-space they are a coating: the hardness is
    measured on the coated body; yield stress and fatigue limits of the body hold below."""
    base: Literal["bonded", "frictionless"] | None = optional("a half-space with the constants of the body")
    """Rigid base, to which the layers are `bonded` or on which they slide (`frictionless`). The body itself
    then has no material and no constants."""
    map: CounterMap | None = optional("the counter body is flat")
    """Height map of the counter body, which is rigid if nothing else is given."""
    _is_rigid: bool = PrivateAttr(False)
    _hardness_is_estimated: bool = PrivateAttr(False)

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """Settings of the body that exclude each other, or need others."""
        if self.base is not None and not self.layers:
            yield "base", ": needs layers"
        elif self.base is not None and len(self.layers) > 1 and self.fatigue_torsion is not None:
            yield "fatigue_torsion", ": not accepted with several layers on a rigid base"
        elif self.base is not None and len(self.layers) == 1 and self.layers[0].residual_stress is not None:
            yield "layers.0.residual_stress", ": not accepted on a rigid base; give that of the body"
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
        found = made({**value, **UNUSED})
        found.model_fields_set.difference_update(UNUSED)
        found._is_rigid = True
        return found

    @property
    def is_rigid(self) -> bool:
        """True for a counter body of which only the map is given; its constants are then not used."""
        return self._is_rigid

    @property
    def hardness_is_estimated(self) -> bool:
        """True if the hardness is neither given nor of the material, but follows from the yield stress."""
        return self._hardness_is_estimated

    @property
    def parts(self) -> dict[str, OfMaterial]:
        """The layers, top first, and the elastic base, by names for sentences; a single part has the name "".

        A coating is the only layer on an elastic base.
        """
        parts: list[OfMaterial] = [*self.layers, *([self] if self.base is None else [])]
        if len(parts) == 1:
            return {"": self}
        names = [f"layer {number + 1}" for number in range(len(self.layers))]
        coated = len(names) == 1
        return dict(zip([*(["the coating"] if coated else names), "the base"], parts, strict=False))

    @property
    def interfaces(self) -> dict[str, float]:
        """Depths of the interfaces between the parts, by their names."""
        depths = [*accumulate(layer.thickness for layer in self.layers)][: len(self.parts) - 1]
        names = ["the interface"] if len(depths) == 1 else [f"interface {n + 1}" for n in range(len(depths))]
        return dict(zip(names, depths, strict=True))

    @property
    def in_words(self) -> str:
        """Materials, elastic constants and thicknesses, the uppermost layer last."""
        words = [f"{shown_si(layer.thickness, 'm')} of {_in_words(layer)}" for layer in reversed(self.layers)]
        own = [] if self.base else [_in_words(self)]
        return " under ".join([*own, *words]) + (f", {self.base} bottom" if self.base else "")

    def is_like(self, other: "Body") -> bool:
        """True if another body has the same constants, layers and base."""
        return self.model_dump(exclude={"map", "material"}) == other.model_dump(exclude={"map", "material"})


def _in_words(part: OfMaterial) -> str:
    """Material and elastic constants."""
    state = part.materials[0].state if part.material else ""
    name = f"{part.material}{', annealed' * state.startswith('annealed')}: " if part.material else ""
    return f"{name}E = {shown_si(part.young, 'Pa')}, ν = {part.poisson:g}"


def _group_of(solid: Any) -> dict[str, Any]:
    """The settings of a body from an `asperity.Solid`."""
    last = solid.parts[-1]
    base = {"young": last.young, "poisson": last.poisson} if last.height is None else {"base": last.bottom}
    layers = [layer._asdict() for layer in solid.layers]
    return base | ({"layers": layers} if layers else {})
