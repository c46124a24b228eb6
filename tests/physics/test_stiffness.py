"""Stiffness, conductance, and the loads between which the same nodes touch."""

import numpy as np
import pytest
from samples import HALF_SPACE, LAYER, every_solid, hardened, load_of, rough

import asperity as asp
from asperity.reference.hertz import Hertz


def test_sphere_has_the_stiffness_of_hertz():
    """dF/dδ = 2 E* a and, between half-spaces, the conductance 4 a / ρ of a circle; grid error, a/h = 20."""
    points = 64
    x = (np.arange(points) - points / 2 + 0.5) / points
    exact = Hertz(contact_radius=0.32, curvature_radius=2.0, effective_modulus=HALF_SPACE.effective_modulus)
    height = (x[:, None] ** 2 + x**2) / (2 * exact.curvature_radius)
    contact = asp.solve_contact(height, HALF_SPACE, force=exact.load, boundary="free")
    hertz = 2 * exact.effective_modulus * exact.contact_radius
    assert contact.stiffness * contact.grid.area == pytest.approx(hertz, rel=5e-3)
    circle = 4 * exact.contact_radius / 0.3
    assert contact.conductance(0.3) * contact.grid.area == pytest.approx(circle, rel=5e-3)


@pytest.mark.parametrize("share", [None, 0.4])
@every_solid
def test_stiffness_is_that_of_a_difference_quotient(solid, boundary, share):
    """Within the loads under which the same nodes touch pressure and approach are linear; solver error."""
    height = rough((64, 48))
    load = 0.3 * load_of(height)
    settings = {"boundary": boundary, "rtol": 1e-12}
    if share:
        largest = asp.solve_contact(height, solid, mean_pressure=load, boundary=boundary).maximum_pressure
        settings["hardness"] = share * largest
    contact = asp.solve_contact(height, solid, mean_pressure=load, **settings)
    assert bool(contact.plastic_area) == bool(share)
    low, high = contact.load_interval
    step = 0.2 * min(load - low, high - load)
    one, other = (
        asp.solve_contact(height, solid, mean_pressure=load + sign * step, **settings) for sign in (-1, 1)
    )
    quotient = (other.mean_pressure - one.mean_pressure) / (other.approach - one.approach)
    assert contact.stiffness == pytest.approx(quotient, rel=1e-5)


@pytest.mark.parametrize("nodes", [31, 32])  # the mean mode of rounding errors is 0 on even grids alone
def test_full_contact_has_that_of_the_solid(nodes):
    height = 1e-3 * np.random.default_rng(0).normal(size=(nodes, nodes))
    contact = asp.solve_contact(height, HALF_SPACE, contact_area_fraction=1.0)
    assert contact.stiffness == contact.conductance(1.0) == contact.load_interval[1] == np.inf
    uniform = float(LAYER.uniform_compliance())
    assert asp.solve_contact(height, LAYER, contact_area_fraction=1.0).stiffness == pytest.approx(1 / uniform)
    assert asp.solve_contact(height, LAYER, mean_pressure=0.0).stiffness == 0.0


def test_conductance_is_that_of_all_touching_nodes():
    """Unloading moves plastic nodes, too: the flattened surface has the same conductance; solver error."""
    contact = hardened(rough(), 0.3, rtol=1e-10)
    flattened = contact.flattened_height()
    again = asp.solve_contact(flattened, HALF_SPACE, mean_pressure=contact.mean_pressure, rtol=1e-10)
    assert contact.conductance(2.0) == pytest.approx(again.conductance(2.0), rel=1e-6)
    assert contact.stiffness < again.stiffness
    with pytest.raises(ValueError, match="half-spaces are needed"):
        asp.solve_contact(rough(), LAYER, mean_pressure=1e-3).conductance(1.0)
    with pytest.raises(ValueError, match="resistivity = 0"):
        contact.conductance(0.0)


HEIGHT = 1e-3 * np.random.default_rng(0).normal(size=(32, 32))


@pytest.mark.parametrize("nodes", [1, 102, 1020, 1024])
@every_solid
def test_other_nodes_touch_beyond_the_interval(solid, boundary, nodes):
    """One node fewer below it, one more above it, or two that touch at nearly the same load."""

    def touching(load):
        contact = asp.solve_contact(HEIGHT, solid, mean_pressure=load, boundary=boundary, rtol=1e-10)
        return np.count_nonzero(contact.pressure)

    contact = asp.solve_contact(HEIGHT, solid, contact_area_fraction=nodes / HEIGHT.size, boundary=boundary)
    low, high = contact.load_interval
    assert low <= contact.mean_pressure <= high
    assert touching((1 + 1e-4) * low) == nodes or low == 0
    assert touching((1 - 1e-4) * low) < nodes
    if nodes < HEIGHT.size:
        assert touching((1 - 1e-4) * high) == nodes
        assert touching((1 + 1e-4) * high) > nodes
    else:
        assert high == np.inf


def test_a_node_yields_beyond_the_interval():
    """With this hardness; under others a node comes into contact first."""
    height = rough((64, 48))
    contact = hardened(height, 0.6, rtol=1e-10)
    low, high = contact.load_interval
    step, plastic = 0.05 * (high - low), []
    for load in (low - step, low + step, high - step, high + step):
        settings = {"mean_pressure": load, "hardness": contact.hardness, "rtol": 1e-10}
        plastic.append(np.count_nonzero(asp.solve_contact(height, HALF_SPACE, **settings).plastic_depth))
    assert np.diff(plastic).tolist() == [1, 0, 1]


def test_loads_of_both_methods_are_within_one_interval():
    """They may differ by as much as the interval is wide, here 15 %."""
    settings = {"contact_area_fraction": 3 / HEIGHT.size}
    one, other = (
        asp.solve_contact(HEIGHT, HALF_SPACE, method=name, **settings) for name in ("active_set", "gfmd")
    )
    assert one.load_interval == pytest.approx(other.load_interval, rel=1e-4)
    low, high = one.load_interval
    assert low < other.mean_pressure < high


def test_nothing_in_contact_has_no_load():
    assert asp.solve_contact(HEIGHT, LAYER, mean_pressure=0.0).load_interval == (0.0, 0.0)
