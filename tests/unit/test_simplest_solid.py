"""The half-space in place of a layer: their difference, and the choice."""

import numpy as np
import pytest

from asperity.elasticity.layer import Layer
from asperity.elasticity.simplest_solid import simplest_solid


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-0.95, 0.33, 0.5])
def test_no_mode_differs_by_more(bottom, poisson):
    """On finer samples and in all directions; 1 %: the samples miss the largest value by that."""
    q, half_space = np.geomspace(1.0, 30.0, 60), Layer(1.0, poisson)
    for reach in (2.0, 2 * np.pi, 12.0):
        layer = Layer(1.0, poisson, reach, bottom)
        chosen = simplest_solid(layer, q_min=1.0, tolerance=0.0)
        assert chosen.layer is layer
        depth = np.linspace(0, reach, 201)[:, None, None]
        angle = np.array([0.0, 0.3, np.pi / 4])[:, None]
        direction = q * np.cos(angle), q * np.sin(angle)
        stress = np.abs(layer.stress(*direction, depth) - half_space.stress(*direction, depth)).max()
        compliance = np.abs(layer.surface_compliance(q) / half_space.surface_compliance(q) - 1).max()
        assert chosen.difference == pytest.approx(max(stress, compliance), rel=0.01)


def test_half_space_is_chosen_within_the_tolerance():
    layer = Layer(1.0, 0.33, 1.0, lateral="free")
    chosen, kept = (simplest_solid(layer, 2 * np.pi, tolerance) for tolerance in (0.05, 1e-3))
    assert chosen.layer == Layer(1.0, 0.33, None, lateral="free")
    assert "half-space" in chosen.reason
    assert kept.layer is layer
    assert kept.difference == chosen.difference > 1e-3
    assert "layer" in kept.reason
    half_space, sheet = Layer(1.0, 0.33), Layer(1.0, 0.33, 100.0, "free")
    assert simplest_solid(half_space, 1.0, 0.0).layer is half_space
    assert simplest_solid(half_space, 1.0, 0.0).difference == 0
    assert simplest_solid(sheet, 1.0, 0.5).layer is sheet
