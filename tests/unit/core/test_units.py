"""Units of the interfaces: text to SI and back."""

import pint
import pytest

from asperity.core.units import scaled_unit, shown_si, to_si


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("210 GPa", "pressure", 210e9),
        ("210e9Pa", "pressure", 210e9),
        ("50 N/mm^2", "pressure", 50e6),
        ("50 N/mm2", "pressure", 50e6),
        ("50 N/mm²", "pressure", 50e6),
        ("3 mm³", "volume", 3e-9),
        ("1 um", "length", 1e-6),
        ("1 µm", "length", 1e-6),
        ("-.5 mm", "length", -5e-4),
        ("12 kN", "force", 12e3),
        (pint.Quantity(2, "um"), "length", 2e-6),
    ],
)
def test_number_with_a_unit_becomes_si(text, dimension, expected):
    assert to_si(text, dimension) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    "value", ["50", 50.0, True, None, "50 Pa", "inf m", "1e999 m", "5 %s {", "9**9**9 m", "", "x" * 1000]
)
def test_anything_else_is_refused_with_the_units(value):
    with pytest.raises(ValueError, match=r"^--name = .*: a number with a unit of length \(") as error:
        to_si(value, "length", name="--name")
    assert len(str(error.value)) < 220
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("value", "hint"),
    [
        ("1,2 GPa", "with a decimal point, not a comma"),
        ("700 HV", "700 HV is 6.865 GPa"),  # kgf/mm², 700 · 9.80665 MPa
        ("200HBW10/3000", ""),
        ("200 HB", "200 HB is 1.961 GPa"),
        ("50 mPa", "did you mean 50 MPa?"),
    ],
)
def test_comma_and_hardness_number_get_a_hint(value, hint):
    with pytest.raises(ValueError, match=r"N/mm\^2(; )?") as error:
        to_si(value, "pressure")
    assert hint in str(error.value)


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (2.1e11, "Pa", "210 GPa"),
        (999.99999e6, "Pa", "1 GPa"),
        (3.2e-7, "m", "320 nm"),
        (-512e-6, "m", "-512 µm"),
        (1.2e-9, "m^2", "1200 µm²"),
        (2.62144e-7, "m^2", "0.2621 mm²"),
        (0.0, "Pa", "0 Pa"),
        (0.123456, "1", "0.1235"),
    ],
)
def test_numbers_are_shown_with_a_sensible_prefix(value, unit, expected):
    assert shown_si(value, unit) == expected


def test_one_prefix_serves_all_values_of_a_picture():
    assert scaled_unit([0.0, 2e6, 5e8, float("nan")], "Pa") == (1e6, "MPa")
