"""Loads under which the same nodes touch: what an imposed area fixes."""

import numpy as np
import pytest
from samples import HALF_SPACE, LAYER, every_solid

import asperity as asp

HEIGHT = 1e-3 * np.random.default_rng(0).normal(size=(32, 32))


@pytest.mark.parametrize("nodes", [1, 102, 1020, 1024])
@every_solid
def test_other_nodes_touch_beyond_the_interval(solid, boundary, nodes):
    """One node fewer below it, one more above it, or two that touch at nearly the same load."""

    def touching(load):
        contact = asp.solve(HEIGHT, solid, mean_pressure=load, boundary=boundary, rtol=1e-10)
        return np.count_nonzero(contact.pressure)

    contact = asp.solve(HEIGHT, solid, area_fraction=nodes / HEIGHT.size, boundary=boundary)
    low, high = contact.load_interval
    assert low <= contact.mean_pressure <= high
    assert touching((1 + 1e-4) * low) == nodes or low == 0
    assert touching((1 - 1e-4) * low) < nodes
    if nodes < HEIGHT.size:
        assert touching((1 - 1e-4) * high) == nodes
        assert touching((1 + 1e-4) * high) > nodes
    else:
        assert high == np.inf


def test_loads_of_both_methods_are_within_one_interval():
    """They may differ by as much as the interval is wide, here 15 %."""
    settings = {"area_fraction": 3 / HEIGHT.size}
    one, other = (asp.solve(HEIGHT, HALF_SPACE, method=name, **settings) for name in ("active_set", "gfmd"))
    assert one.load_interval == pytest.approx(other.load_interval, rel=1e-4)
    low, high = one.load_interval
    assert low < other.mean_pressure < high


def test_nothing_in_contact_has_no_load():
    assert asp.solve(HEIGHT, LAYER, mean_pressure=0.0).load_interval == (0.0, 0.0)
