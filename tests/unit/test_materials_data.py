"""The data file of materials by itself: units, sources, ranges, names."""

import pint
import pytest

from asperity import Body
from asperity.core.data import packaged_yaml
from asperity.core.units import KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE

DATA = packaged_yaml("asperity.settings", "materials.yaml")
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


def si(value, quantity):
    """A value in SI; a bare number is in the unit of its setting."""
    if not isinstance(value, str):
        return float(value)
    return pint.Quantity(value).to(UNITS[quantity]).magnitude


def sources_of(entry):
    of_range = entry.get("range_source", [])
    return {entry["source"], *([of_range] if isinstance(of_range, str) else of_range)}


@pytest.mark.parametrize("quantity", sorted(UNITS))
def test_values_have_unit_source_place_and_range(quantity):
    for place, entry in VALUES.items():
        if place[1] != quantity:
            continue
        assert set(entry) <= {"value", "range", "scale", "source", "place", "range_source"}, place
        value = si(entry["value"], quantity)
        lowest, highest = (si(bound, quantity) for bound in entry.get("range", (0.5 * value, 2 * value)))
        assert 0 < lowest <= value <= highest > lowest, place
        assert sources_of(entry) <= set(SOURCES), place
        assert entry["place"].strip(), place
        assert ("scale" in entry) == (quantity == "hardness"), place


def test_hardness_is_the_number_of_its_scale():
    """ISO 6507-1, 6506-1 and 4545-1: a number of hardness is in kgf/mm²."""
    for place, entry in VALUES.items():
        scale, *number = entry.get("scale", "none").split()
        if number:  # else the source gives a pressure
            assert scale[:2] in {"HV", "HB", "HK"}, place
            expected = float(*number) * KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE
            found = si(entry["value"], "hardness")
            assert found == pytest.approx(expected, rel=1e-3), place  # four digits in the file


def test_numbers_of_materials_are_physical():
    """An isotropic solid is stable for -1 < nu < 1/2; solids yield and are indented below a tenth of E."""
    for name, material in MATERIALS.items():
        assert 0 < material["poisson"]["value"] < 0.5, name
        for quantity in STRENGTHS & material.keys():
            assert si(material[quantity]["value"], quantity) < si(material["young"]["value"], "young") / 10


def test_body_of_every_material_has_its_constants():
    """All but the fatigue limits: one of them alone says nothing."""
    for name, given in MATERIALS.items():
        body = Body(material=name)
        for quantity in UNITS.keys() & given.keys() - {"fatigue_bending", "fatigue_torsion"}:
            expected = si(given[quantity]["value"], quantity)
            assert getattr(body, quantity) == pytest.approx(expected, rel=1e-12), name


def test_names_are_unique_and_many():
    names = [name.casefold() for key in MATERIALS for name in [key, *MATERIALS[key].get("also", [])]]
    assert sorted(names) == sorted(set(names))
    assert len(MATERIALS) >= 30


def test_every_source_is_used():
    assert set(SOURCES) == set().union(*map(sources_of, VALUES.values()))
