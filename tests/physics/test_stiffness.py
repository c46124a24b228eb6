"""Stiffness and conductance of contacts against closed forms and difference quotients."""

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
    contact = asp.solve(height, HALF_SPACE, force=exact.load, boundary="free")
    hertz = 2 * exact.effective_modulus * exact.contact_radius
    assert contact.stiffness * contact.grid.area == pytest.approx(hertz, rel=5e-3)
    circle = 4 * exact.contact_radius / 0.3
    assert contact.conductance(0.3) * contact.grid.area == pytest.approx(circle, rel=5e-3)


def test_square_punch_has_the_capacitance_of_a_square():
    """dF/dδ = π C E* of the unit square, C as in `test_load_of_flat_square_punch`; grid error."""
    found = []
    for points in (32, 64):
        contact = asp.solve(np.zeros((points, points)), asp.Layer(1.0, 0.0), approach=1e-3, boundary="free")
        found.append(contact.stiffness)
        assert contact.stiffness == pytest.approx(contact.force / 1e-3, rel=1e-6)  # linear: solver error
    assert 2 * found[1] - found[0] == pytest.approx(np.pi * 0.366787, rel=2e-3)


@pytest.mark.parametrize("share", [None, 0.4])
@every_solid
def test_stiffness_is_that_of_a_difference_quotient(solid, boundary, share):
    """Within the loads under which the same nodes touch pressure and approach are linear; solver error."""
    height = rough((64, 48))
    load = 0.3 * load_of(height)
    settings = {"boundary": boundary, "rtol": 1e-12}
    if share:
        largest = asp.solve(height, solid, mean_pressure=load, boundary=boundary).max_pressure
        settings["hardness"] = share * largest
    contact = asp.solve(height, solid, mean_pressure=load, **settings)
    assert bool(contact.plastic_area) == bool(share)
    low, high = contact.load_interval
    step = 0.2 * min(load - low, high - load)
    one, other = (asp.solve(height, solid, mean_pressure=load + sign * step, **settings) for sign in (-1, 1))
    quotient = (other.mean_pressure - one.mean_pressure) / (other.approach - one.approach)
    assert contact.stiffness == pytest.approx(quotient, rel=1e-5)


def test_full_contact_has_that_of_the_solid():
    height = rough((32, 32))
    assert asp.solve(height, HALF_SPACE, area_fraction=1.0).stiffness == np.inf
    uniform = float(LAYER.uniform_compliance())
    assert asp.solve(height, LAYER, area_fraction=1.0).stiffness == pytest.approx(1 / uniform)
    assert asp.solve(height, LAYER, mean_pressure=0.0).stiffness == 0.0


def test_conductance_is_that_of_all_touching_nodes():
    """Unloading moves plastic nodes, too: the conductance is that of the flattened surface; solver error."""
    contact = hardened(rough(), 0.3, rtol=1e-10)
    flattened = contact.flattened_height()
    again = asp.solve(flattened, HALF_SPACE, mean_pressure=contact.mean_pressure, rtol=1e-10)
    assert contact.conductance(2.0) == pytest.approx(again.conductance(2.0), rel=1e-6)
    assert contact.stiffness < again.stiffness
    with pytest.raises(ValueError, match="half-spaces are needed"):
        asp.solve(rough(), LAYER, mean_pressure=1e-3).conductance(1.0)
    with pytest.raises(ValueError, match="resistivity = 0"):
        contact.conductance(0.0)
