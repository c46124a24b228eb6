"""Checks of arguments: accepted types, and messages of one line."""

from fractions import Fraction

import numpy as np
import pint
import pytest
import xarray as xr

import asperity as asp
from asperity.core.arguments import choice, magnitude, number, real_array, whole_number
from asperity.core.errors import shown


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.float64(2), np.uint8(2), Fraction(2)])
def test_real_numbers_of_every_type_are_accepted(value):
    for found, expected in (
        (number("n", value, "a number", lambda n: n == 2), float),
        (magnitude("n", value), float),
        (whole_number("n", value, "a number", lambda n: n == 2), int),
    ):
        assert found == 2
        assert type(found) is expected


NO_NUMBERS = ["2", b"2", None, True, np.True_, 2j, [2], np.array(2.0)]
OUT_OF_RANGE = [np.nan, np.inf, np.float32("nan"), 10**400, -(10**6000), 2.5]


@pytest.mark.parametrize(("check", "wrong"), [(number, OUT_OF_RANGE), (whole_number, [*OUT_OF_RANGE, 1.5])])
def test_anything_but_numbers_in_range_is_refused(check, wrong):
    for values, error in ((NO_NUMBERS, TypeError), (wrong, ValueError)):
        for value in values:
            with pytest.raises(error, match=r"^n = .*: a small number is needed$"):
                check("n", value, "a small number", lambda n: abs(n) < 2)


def test_fourth_power_of_a_magnitude_is_finite():
    assert magnitude("n", 1e-75) == 1e-75
    assert magnitude("n", 1e75) == 1e75
    for value in (0, -1.0, 9e-76, 1.1e75):
        with pytest.raises(ValueError, match=r"a number > 0, from 1e-75 to 1e\+75 or none, is needed"):
            magnitude("n", value, " or none")


def test_choice_is_one_of_the_words():
    assert choice("word", "one", ("one", "two")) == "one"
    for value in ("On", None, ["one"]):
        with pytest.raises(ValueError, match=r"word = .*: one of one, two is needed"):
            choice("word", value, ("one", "two"))


def test_units_of_quantities_are_not_dropped():
    """NumPy takes a quantity for its number: 64 µm would become 64."""
    unit = pint.Unit("um")
    noise = 1e-3 * np.random.default_rng(1).normal(size=(8, 8))
    surface = xr.DataArray(noise * unit, dims=("y", "x"))
    for length in (64 * unit, (64 * unit, 64 * unit), np.array([64, 64]) * unit):
        with pytest.raises(TypeError, match=r"^length = .*: real numbers"):
            asp.solve_contact(noise, asp.Solid(1.0, 0.3), length, mean_pressure=1e-4)
    for height in (noise * unit, surface):
        with pytest.raises(TypeError, match=r"^height = .*: real numbers without a unit are needed"):
            asp.solve_contact(height, asp.Solid(1.0, 0.3), mean_pressure=1e-4)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_array_keeps_its_precision(dtype):
    values = np.arange(3, dtype=dtype)
    assert real_array("a", values) is values
    assert real_array("a", values.astype(int)).dtype == np.float64
    assert real_array("a", values.astype("float16")).dtype == np.float64


def test_value_is_shown_on_one_short_line():
    for value in (np.eye(9), "two\nlines", 10**6000, [10**6000], "x" * 200):
        assert shown(value).isprintable()
        assert 0 < len(shown(value)) <= 60
