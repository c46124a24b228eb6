"""Memory of repeated calculations: it does not grow with their number."""

import gc
import resource
from pathlib import Path

import numpy as np
import pytest

from asperity.contact import solve_path
from asperity.elasticity.layer import Layer
from asperity.surface.self_affine import self_affine

STATUS = Path("/proc/self/statm")
POINTS = 160
FIELD = 8 * POINTS**2
CALLS = 20
TOLERANCE = 1e-3

pytestmark = pytest.mark.skipif(
    not STATUS.exists(), reason="this system does not tell the memory of a process"
)


def resident():
    """Resident memory of this process in bytes."""
    gc.collect()
    return int(STATUS.read_text().split()[1]) * resource.getpagesize()


def test_memory_does_not_grow_with_the_number_of_contacts():
    """If each contact kept half a field, the second half of them would take more."""
    height = self_affine((POINTS, POINTS), 0.8, 0.5, 0.0625, 1e-3, seed=1)
    fractions = np.linspace(0.02, 0.2, 2 * CALLS).tolist()
    contacts = solve_path(height, Layer(1.0, 0.33, height=1.0), area_fractions=fractions, rtol=TOLERANCE)
    for number, contact in enumerate(contacts):
        assert contact.area_fraction > 0
        if number == CALLS - 1:
            before = resident()
    assert resident() - before < CALLS * FIELD / 2
