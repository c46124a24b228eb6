import numpy as np
import pytest
from numba import njit

from asperity.intrinsics import BITS, every_second, higher, higher_than, lowest_bit


@njit
def position(bits):
    return lowest_bit(bits)


@pytest.mark.parametrize("kind", [np.uint32, np.uint64])
def test_lowest_bit_is_found_below_others(kind):
    count = 8 * np.dtype(kind).itemsize
    for place in range(count):
        assert position(kind(1 << place)) == place
        assert position(kind((1 << count) - (1 << place))) == place


@njit
def compared(values, place, others, other_place):
    return higher(values, place, others, other_place)


@njit
def compared_with(values, place, floor):
    return higher_than(values, place, floor)


@njit
def even_numbers(values, out):
    for i in range(out.size):
        out[i] = every_second(values, i)


def bits_of(truth):
    return sum(1 << i for i, true in enumerate(truth) if true)


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_magnitudes_are_compared_bit_by_bit(real):
    random = np.random.default_rng(1)
    values, others = random.integers(-3, 4, (2, 3 * BITS)).astype(real)
    others[5] = np.nan
    for place, other_place in ((0, 0), (7, 5), (2 * BITS, 1)):
        some, its = values[place : place + BITS], others[other_place : other_place + BITS]
        assert compared(values, place, others, other_place) == bits_of(abs(some) > abs(its))
        assert compared_with(values, place, real(2)) == bits_of(abs(some) > 2)


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_every_second_number_is_taken(real):
    values, out = np.arange(37, dtype=real), np.empty(19, real)
    even_numbers(values, out)
    assert np.array_equal(out, values[::2])
