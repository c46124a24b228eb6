"""The data file of materials by itself: units, sources, ranges, names."""

from importlib.resources import files

import pint
import pytest
import yaml

from asperity import Body
from asperity.core.units import KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE

DATA = yaml.safe_load(files("asperity").joinpath("settings/materials.yaml").read_text(encoding="utf-8"))
MATERIALS, SOURCES = DATA["materials"], DATA["sources"]
STRENGTHS = {"yield_stress", "hardness", "fatigue_bending", "fatigue_torsion"}
UNITS = dict.fromkeys({"young", *STRENGTHS}, "Pa") | {
    "poisson": "",
    "conductivity": "W/(m K)",
    "resistivity": "ohm m",
}
VALUES = {
    (name, quantity): entry
    for name, material in MATERIALS.items()
    for quantity, entry in material.items()
    if quantity not in {"also", "group", "state"}
}
REGISTRY = pint.UnitRegistry()


def si(value, quantity):
    """A value in SI; a bare number is in the unit of its setting."""
    if not isinstance(value, str):
        return float(value)
    return REGISTRY.Quantity(value).to(UNITS[quantity]).magnitude


def sources_of(entry):
    of_range = entry.get("range_source", [])
    return {entry["source"], *([of_range] if isinstance(of_range, str) else of_range)}


def entries(key="value"):
    """Parameters of a test: quantity and entry of every value that has the key."""
    with_key = {place: entry for place, entry in VALUES.items() if key in entry}
    return [pytest.param(place[1], entry, id="-".join(place)) for place, entry in with_key.items()]


@pytest.mark.parametrize(("quantity", "entry"), entries())
def test_value_has_unit_source_and_place(quantity, entry):
    assert set(entry) <= {"value", "range", "scale", "source", "place", "range_source"}
    assert si(entry["value"], quantity) > 0
    assert sources_of(entry) <= set(SOURCES)
    assert entry["place"].strip()
    assert ("scale" in entry) == (quantity == "hardness")


@pytest.mark.parametrize(("quantity", "entry"), entries("range"))
def test_range_contains_the_value(quantity, entry):
    lowest, highest = (si(bound, quantity) for bound in entry["range"])
    assert lowest < highest
    assert lowest <= si(entry["value"], quantity) <= highest


@pytest.mark.parametrize(("quantity", "entry"), entries("scale"))
def test_hardness_is_the_number_of_its_scale(quantity, entry):
    """ISO 6507-1, 6506-1 and 4545-1: a number of hardness is in kgf/mm²."""
    scale, *number = entry["scale"].split()
    if number:  # else the source gives a pressure
        assert scale[:2] in {"HV", "HB", "HK"}
        expected = float(*number) * KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE
        assert si(entry["value"], quantity) == pytest.approx(expected, rel=1e-3)  # four digits in the file


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
def test_numbers_of_a_material_are_physical(material):
    """An isotropic solid is stable for -1 < nu < 1/2; solids yield and are indented below a tenth of E."""
    assert 0 < material["poisson"]["value"] < 0.5
    for quantity in STRENGTHS & material.keys():
        assert si(material[quantity]["value"], quantity) < si(material["young"]["value"], "young") / 10


@pytest.mark.parametrize("name", MATERIALS)
def test_body_of_every_material_has_its_constants(name):
    """All but the fatigue limits: one of them alone says nothing."""
    body, given = Body(material=name), MATERIALS[name]
    for quantity in UNITS.keys() & given.keys() - {"fatigue_bending", "fatigue_torsion"}:
        assert getattr(body, quantity) == pytest.approx(si(given[quantity]["value"], quantity), rel=1e-12)


def test_names_are_unique_and_many():
    names = [name.casefold() for key in MATERIALS for name in [key, *MATERIALS[key].get("also", [])]]
    assert sorted(names) == sorted(set(names))
    assert len(MATERIALS) >= 30


def test_every_source_is_used():
    assert set(SOURCES) == set().union(*map(sources_of, VALUES.values()))
