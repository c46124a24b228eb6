"""Memory of repeated calculations: it does not grow with their number."""

import gc

import numpy as np
import psutil
from samples import rough

import asperity as asp


def resident():
    """Resident memory of this process in bytes."""
    gc.collect()
    return psutil.Process().memory_info().rss


def test_memory_does_not_grow_with_the_number_of_contacts():
    """If each contact kept half a field, the second half of them would take more."""
    height, fractions = rough((160, 160)), np.linspace(0.02, 0.2, 40)
    contacts = asp.solve_path(height, asp.Layer(1.0, 0.33, height=1.0), area_fractions=fractions, rtol=1e-3)
    for number, contact in enumerate(contacts):
        assert contact.area_fraction > 0
        if number == 19:
            before = resident()
    assert resident() - before < 20 * height.nbytes / 2
