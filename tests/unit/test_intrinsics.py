import numpy as np
import pytest
from numba import njit

from asperity.intrinsics import lowest_bit


@njit
def position(bits):
    return lowest_bit(bits)


@pytest.mark.parametrize("kind", [np.uint32, np.uint64])
def test_lowest_bit_is_found_below_others(kind):
    count = 8 * np.dtype(kind).itemsize
    for place in range(count):
        assert position(kind(1 << place)) == place
        assert position(kind((1 << count) - (1 << place))) == place
