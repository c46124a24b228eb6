"""The data file of materials by itself: units, sources, ranges, names, plausible numbers."""

import numpy as np
import pint
import pytest

from asperity import Body
from asperity.core.data import packaged_yaml
from asperity.core.units import KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE

DATA = packaged_yaml("asperity.settings", "materials.yaml")
MATERIALS, SOURCES = DATA["materials"], DATA["sources"]
STRENGTHS = {"yield_stress", "hardness", "fatigue_bending", "fatigue_torsion"}
LORENZ_NUMBER = 2.44e-8  # in W Ω/K²; Sommerfeld's value
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


ELASTIC = {
    **dict.fromkeys(("bearing steels", "stainless steels"), ((185, 220), (0.26, 0.31))),
    "gear, engineering and tool steels": ((185, 220), (0.26, 0.31)),
    "cast irons": ((90, 180), (0.2, 0.31)),
    "copper alloys": ((90, 130), (0.3, 0.36)),
    "light alloys": ((65, 120), (0.32, 0.36)),
    "nickel alloys": ((190, 220), (0.28, 0.33)),
    "pure metals": ((45, 420), (0.2, 0.45)),
    "ceramics and hard metals": ((150, 1220), (0.06, 0.32)),
    "coatings": ((50, 800), (0.1, 0.37)),
    "glasses": ((60, 75), (0.15, 0.25)),
    "carbon": ((5, 20), (0.1, 0.25)),
    "polymers": ((0.4, 4.5), (0.32, 0.47)),
    "elastomers": ((0.0005, 0.1), (0.49, 0.5)),
}
"""Kind of material → its ranges of Young's modulus in GPa and of Poisson's ratio."""

METALS = {kind for kind in ELASTIC if kind.endswith(("steels", "irons", "alloys", "metals"))} - {
    "ceramics and hard metals"
}


def number(name, quantity):
    """A constant of a material in SI; None if it has none."""
    entry = MATERIALS[name].get(quantity)
    return None if entry is None else si(entry["value"], quantity)


@pytest.mark.parametrize("name", MATERIALS)
def test_elastic_constants_are_in_the_range_of_their_kind(name):
    modulus, ratio = ELASTIC[MATERIALS[name]["group"]]
    assert modulus[0] <= number(name, "young") / 1e9 <= modulus[1]
    assert ratio[0] <= number(name, "poisson") <= ratio[1]


@pytest.mark.parametrize("name", [name for name in MATERIALS if STRENGTHS & MATERIALS[name].keys()])
def test_strengths_are_plausible(name):
    """A solid yields below E/20, and is indented by 2.5 times its yield stress or more (Tabor: about 3).

    Work hardening in the indentation, and graphite flakes that open in tension, make it up to 11 times; of
    case-hardening steels the yield stress is that of the core. The
    hardness is below E/8: it is 0.115 E for amorphous carbon, the hardest for its modulus.
    """
    young, hardness, yielding = (number(name, each) for each in ("young", "hardness", "yield_stress"))
    if yielding is not None:
        assert young / 30_000 < yielding < young / 20
    if hardness is not None:
        assert young / 2000 < hardness < young / 8
    if None not in (yielding, hardness):
        assert (
            2.5 < hardness / yielding < (15 if "case-hardening" in MATERIALS[name].get("state", "") else 11)
        )
    for limit in {"fatigue_bending", "fatigue_torsion"} & MATERIALS[name].keys():
        assert 0.25 < number(name, limit) / yielding < 1


def test_metals_follow_wiedemann_and_franz():
    """k ρ = L T within a factor of two: phonons add to it in alloys, electrons scatter inelastically."""
    found = 0
    for name, material in MATERIALS.items():
        if material["group"] in METALS | {"coatings"} and {"conductivity", "resistivity"} <= material.keys():
            ratio = number(name, "conductivity") * number(name, "resistivity") / (LORENZ_NUMBER * 293)
            assert 0.5 < ratio < 2, name
            found += 1
    assert found >= 15


def test_conductivities_of_graphite_belong_together():
    """Of graphites, the better conductor of heat is that of current: from the ends of the ranges of a source
    (25 to 470 W/(m K), 30 to 5 µΩ m) k ρ is 0.75e-3 to 2.35e-3 W Ω/K.
    """
    product = number("graphite", "conductivity") * number("graphite", "resistivity")
    assert 25 * 30e-6 < product < 470 * 5e-6


@pytest.mark.parametrize(
    ("name", "stiffness"),
    {
        "silicon": (165.8, 63.9, 79.6),
        "diamond": (1076, 125, 577),
        "copper": (168.3, 122.1, 75.7),
        "silver": (124.0, 93.4, 46.1),
        "gold": (192.4, 163.0, 42.0),
        "nickel": (248.1, 154.9, 124.2),
        "tungsten": (522.4, 204.4, 160.6),
        "sapphire": (496.8, 163.6, 147.4, 498.1, 110.9, -23.5),
    }.items(),
)
def test_isotropic_constants_are_between_the_averages_over_orientations(name, stiffness):
    """Voigt's and Reuss's averages of the constants of a crystal (c11, c12, c44 of cubic ones, then c33, c13,
    c14 of trigonal ones, in GPa) bound those of a polycrystal. Measured ones scatter by some per cent more.
    """
    c11, c12, c44, c33, c13, c14 = [*stiffness, stiffness[0], stiffness[1], 0.0][:6]
    matrix = np.diag([c11, c11, c33, c44, c44, c44 if len(stiffness) == 3 else (c11 - c12) / 2])
    for row, column, value in ((0, 1, c12), (0, 2, c13), (1, 2, c13), (0, 3, c14), (1, 3, -c14), (4, 5, c14)):
        matrix[row, column] = matrix[column, row] = value
    young, poisson = [], []
    for stiff, inverse in ((matrix, False), (np.linalg.inv(matrix), True)):
        normal, shear = stiff[:3, :3], np.trace(stiff[3:, 3:])
        across = (normal.sum() - np.trace(normal)) / 2
        bulk = 1 / normal.sum() if inverse else normal.sum() / 9
        if inverse:
            rigidity = 15 / (4 * np.trace(normal) - 4 * across + 3 * shear)
        else:
            rigidity = (np.trace(normal) - across + 3 * shear) / 15
        young.append(9 * bulk * rigidity / (3 * bulk + rigidity))
        poisson.append((3 * bulk - 2 * rigidity) / (6 * bulk + 2 * rigidity))
    assert 0.95 * min(young) < number(name, "young") / 1e9 < 1.05 * max(young)
    assert 0.95 * min(poisson) < number(name, "poisson") < 1.05 * max(poisson)


@pytest.mark.parametrize("name", [name for name in MATERIALS if MATERIALS[name]["group"] == "coatings"])
def test_coatings_are_materials_of_layers(name):
    body = Body(material="100Cr6", layers=[{"material": name, "thickness": "2 um"}])
    assert body.layers[0].young == pytest.approx(number(name, "young"))
    assert body.layers[0].poisson == number(name, "poisson")
    assert "range" in MATERIALS[name]["young"]


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
