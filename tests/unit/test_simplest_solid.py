"""The half-space in place of a layer: bounds of the difference, and the choice."""

import numpy as np
import pytest

from asperity.elasticity.layer import Layer
from asperity.elasticity.simplest_solid import simplest_solid


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-0.95, 0.33, 0.5])
def test_bound_of_the_half_space_is_tight(bottom, poisson):
    q = np.geomspace(1.0, 30.0, 25)
    half_space = Layer(1.0, poisson)
    for reach in (1.0, 2.0, 4.0, 2 * np.pi, 12.0):
        layer = Layer(1.0, poisson, reach, bottom)
        chosen = simplest_solid(layer, q_min=1.0, tolerance=0.0)
        assert chosen.layer is layer
        depth = np.linspace(0, reach, 101)[:, None, None]
        angle = np.array([0.0, 0.3, np.pi / 4])[:, None]
        direction = q * np.cos(angle), q * np.sin(angle)
        stress = np.abs(layer.stress(*direction, depth) - half_space.stress(*direction, depth)).max()
        compliance = np.abs(layer.surface_compliance(q) / half_space.surface_compliance(q) - 1).max()
        assert stress <= chosen.stress_bound
        assert compliance <= chosen.compliance_bound + 1e-15  # rounding of the ratio
        assert chosen.bound == max(chosen.stress_bound, chosen.compliance_bound)
        if reach > 3:
            assert chosen.stress_bound < 2 * stress
            assert chosen.compliance_bound < (1.01 if bottom == "frictionless" else 1.25) * compliance


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_bounds_fall_with_the_wavenumber(bottom):
    """The bound for the smallest wavenumber therefore holds for all larger ones."""
    for poisson in (-0.99, 0.0, 0.5):
        layer = Layer(1.0, poisson, 1.0, bottom)
        choices = [simplest_solid(layer, q, 0.0) for q in np.geomspace(0.05, 60, 50)]
        assert np.all(np.diff([c.stress_bound for c in choices]) <= 0)
        assert np.all(np.diff([c.compliance_bound for c in choices]) <= 0)


def test_half_space_is_chosen_within_the_tolerance():
    layer = Layer(1.0, 0.33, 1.0, lateral="free")
    chosen, kept = (simplest_solid(layer, 2 * np.pi, tolerance) for tolerance in (0.05, 1e-3))
    assert chosen.layer == Layer(1.0, 0.33, None, lateral="free")
    assert "half-space" in chosen.reason
    assert kept.layer is layer
    assert kept.bound > 1e-3
    assert "layer" in kept.reason
    half_space, sheet = Layer(1.0, 0.33), Layer(1.0, 0.33, 100.0, "free")
    assert simplest_solid(half_space, 1.0, 0.0).layer is half_space
    assert simplest_solid(half_space, 1.0, 0.0).bound == 0
    assert simplest_solid(sheet, 1.0, 0.5).layer is sheet


@pytest.mark.parametrize(
    ("q_min", "tolerance", "words"),
    [
        (0.0, 0.1, "q_min = 0.0: a number > 0"),
        (1.0, -0.1, "tolerance = -0.1: a finite number ≥ 0"),
    ],
)
def test_wrong_argument_is_refused(q_min, tolerance, words):
    with pytest.raises(ValueError, match=words):
        simplest_solid(Layer(1.0, 0.3, 0.4), q_min, tolerance)
