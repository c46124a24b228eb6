"""Numbers of an answer as records: text, rounding by the error, bounds, and plain values for a file."""

import json
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.engineering.records import (
    CAUSES,
    DISCRETISATION,
    FRACTION,
    INPUTS,
    PLANES,
    POSITIONS,
    POSITIVE,
    Bounds,
    Position,
    Record,
    find,
    fraction,
    frame,
)

SIZES = st.floats(0, 1e30, exclude_min=True)
BOUNDS = st.one_of(
    st.just(FRACTION),
    st.just(POSITIVE),
    st.tuples(st.floats(-1e9, 1e9), st.floats(0, 1e9)).map(
        lambda ends: Bounds(ends[0], ends[0] + ends[1], "a reason")
    ),
    st.just(Bounds()),
)
RECORDS = st.builds(
    Record,
    st.text(max_size=8),
    st.floats(),
    st.sampled_from(["1", "m", "Pa", "1/m^2", "Pa/m", "J"]),
    body=st.sampled_from(["", "lower", "upper"]),
    position=st.builds(Position, st.floats(), st.floats(), st.floats()),
    extrapolated=st.floats(allow_infinity=False),
    errors=st.dictionaries(st.sampled_from(CAUSES), SIZES),
    bounds=BOUNDS,
    words=st.sampled_from(["", "none"]),
    note=st.text(max_size=8),
    varies=st.booleans(),
    better=st.sampled_from(["", "less", "more"]),
)


@given(RECORDS)
def test_plain_values_give_the_record_back(record):
    """Through JSON, to the bit: numbers that are not known, infinite ones and -0 too."""
    again = Record.from_plain(json.loads(json.dumps(record.as_plain())))
    assert repr(again) == repr(record)
    assert again == record


@given(RECORDS)
def test_bounds_hold_whatever_the_error(record):
    low, high, _ = record.bounds
    if math.isfinite(record.extrapolated):
        assert low <= record.best <= high
    if not math.isnan(record.error) and math.isfinite(record.best):
        assert all(low <= end <= high for end in record.interval)
        assert record.interval[0] <= record.interval[1]


def test_digits_follow_from_the_error():
    record = Record("mean gap", 1.23456e-7, "m", errors={DISCRETISATION: 2.34e-9})
    assert record.best_text() == "123.5 ± 2.3 nm"
    assert record.text() == "123.5 nm; ± 2.3 nm by discretisation"
    extrapolated = Record("mean gap", 1.23456e-7, "m", extrapolated=1.2e-7, errors={DISCRETISATION: 4e-9})
    assert extrapolated.text() == "123.5 nm; 120.0 ± 4.0 nm extrapolated to zero pixel size"
    assert Record("force", 0.5, "N").best_text() == "500 mN"
    assert Record("density", 2.5e9, "1/m^2").text() == "2500 per mm²"
    assert Record("stiffness", 3e13, "Pa/m").text() == "30 MPa/µm"
    assert fraction("fraction", 0.0123, errors={PLANES: 0.002}).best_text() == "1.23 ± 0.20 %"


def test_hardness_cuts_the_interval():
    """3.48 ± 0.21 GPa by discretisation under a hardness of 3 GPa: no error beyond it."""
    bounds = Bounds(0.0, 3e9, "the hardness")
    record = Record("maximum pressure", 3e9, "Pa", extrapolated=3.48e9, bounds=bounds)
    record = record.with_error(DISCRETISATION, 0.21e9)
    assert record.best == 3e9
    assert record.interval == (pytest.approx(2.79e9), 3e9)
    assert record.text() == (
        "3 GPa; 3 (2.79 to 3) GPa, limited by the hardness, extrapolated to zero pixel size"
    )
    alone = Record("maximum pressure", 2.9e9, "Pa", bounds=bounds, errors={DISCRETISATION: 0.3e9})
    assert alone.interval == (pytest.approx(2.6e9), 3e9)
    assert alone.best_text() == "2.9 (2.6 to 3) GPa"


def test_fractions_stay_between_0_and_1():
    small = fraction("contact area fraction", 0.001, errors={POSITIONS: 0.002})
    assert small.interval == (0.0, pytest.approx(0.003))
    assert small.best_text() == "0.1 (0 to 0.3) %"
    large = fraction("contact area fraction", 0.999, extrapolated=1.01).with_error(DISCRETISATION, 0.02)
    assert (large.best, large.interval) == (1.0, (pytest.approx(0.98), 1.0))


def test_errors_combine_and_unknown_ones_are_named():
    record = Record("maximum pressure", 2e9, "Pa", varies=True)
    assert (math.isnan(record.error), record.unknown) == (True, [POSITIONS])
    assert record.error_texts() == ["between measurement positions: not known"]
    assert math.isnan(record.interval[0])
    known = record.with_error(DISCRETISATION, 3e8).with_error(INPUTS, 4e8)
    assert known.error == pytest.approx(5e8)
    assert [*known.errors] == [DISCRETISATION, INPUTS]
    assert known.error_texts()[-1] == "between measurement positions: not known"
    assert known.with_error(POSITIONS, 1e8).unknown == []
    assert known.with_error(POSITIONS, 0.0) == known.with_error(POSITIONS, math.nan) == known


def test_position_and_note_are_part_of_the_text():
    place = Position(2e-6, y=1e-5, x=3e-5)
    record = Record("maximum von Mises stress", 1e9, "Pa", position=place, note="on a mirror image")
    assert record.text() == "1 GPa at a depth of 2 µm, x = 30 µm, y = 10 µm, on a mirror image"
    assert Record("shear", 1e9, "Pa", position=Position(0.0)).text() == "1 GPa in the surface"
    assert Record("yield", 0.0, "Pa", words="none", varies=True).number() == "none"


def test_table_has_each_record_with_its_causes():
    records = [
        Record("maximum pressure", 2e9, "Pa", errors={PLANES: 1e8}),
        Record("stress", 1e9, "Pa", "stress", "upper"),
    ]
    table = frame(records)
    assert table["error_discretisation_and_planes"].tolist()[0] == table["error"][0] == 1e8
    assert table[["low", "high"]].iloc[0].tolist() == [1.9e9, 2.1e9]
    assert table["text"][1] == records[1].text()
    assert [*find(records, "stress", "upper")] == [*find(records, "stress")] == records[1:]
    assert not [*find(records, "stress", "lower")]


def test_an_error_beyond_a_bound_is_shown_as_an_interval_within_it():
    size = Record(
        "volume above yield per area", 9.3e-10, "m", errors={DISCRETISATION: 9.9e-10}, bounds=POSITIVE
    )
    assert size.error_texts() == ["0 to 1900 pm by discretisation"]
    assert Record("maximum pressure", 1e9, "Pa", errors={DISCRETISATION: 1e8}).error_texts() == [
        "± 0.10 GPa by discretisation"
    ]


def test_digits_are_those_that_the_error_leaves_or_three():
    stress = Record("stress", 4.3642e9, "Pa")
    assert stress.number() == "4.364 GPa"
    assert replace(stress, varies=True).number() == "4.36 GPa"
    assert replace(stress, varies=True).with_error(DISCRETISATION, 1.1e9).number() == "4.4 GPa"
