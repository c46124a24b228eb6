"""Stress under pressure and the traction of full sliding, against solutions that share no kernel with it."""

from functools import partial

import numpy as np
import pytest
from samples import HALF_SPACE, invariants, spots

import asperity as asp
from asperity.elasticity.solid import COMPONENTS
from asperity.reference.state_space import StateSpace
from asperity.stress.planes.truncation import envelope_of

HALVES = [(nu, None) for nu in (-0.4, 0.3, 0.5)]
LAYERS = [(nu, height) for nu in (-0.9, 0.3, 0.5) for height in (1e-5, 0.2, 3.0)]


@pytest.mark.parametrize(("poisson", "height"), [*HALVES, *LAYERS])
@pytest.mark.parametrize(("kx", "ky", "degrees"), [(1, 0, 215.0), (0, 2, 90.0), (-2, 3, 23.0)])
def test_mode_solves_equilibrium_and_hookes_law(poisson, height, kx, ky, degrees):
    """Against the state-space solution of a half-space and a bonded layer; rounding."""
    grid, friction = asp.Grid((12, 16), (0.8, 1.3)), 0.7
    y, x = grid.coordinates()
    qx, qy = 2 * np.pi * kx / 1.3, 2 * np.pi * ky / 0.8
    phase = qy * y[:, None] + qx * x[None, :]
    traction = friction * np.cos(np.radians(degrees)), friction * np.sin(np.radians(degrees))
    mode = StateSpace(qx, qy, 1.0, poisson, height, digits=30 if height is None else 60)
    amplitudes = mode.solve([*traction, -1])
    solid = asp.LoadedSolid(np.cos(phase), grid, asp.Solid(1.0, poisson, height))
    depths = np.array([0.0, 0.1, 0.5, 0.97, 1.0]) * min(height or 0.5, 0.5)
    settings = {"friction": friction, "sliding_direction": degrees, "tolerance": 0}
    for ratios in (None, [0.1, poisson])[: 1 + (height is None)]:
        for plane in asp.stress_planes(solid, depths, ratios, COMPONENTS, **settings):
            stress = mode.stress(plane.depth, amplitudes)
            for name, value in zip(COMPONENTS, stress, strict=True):
                expected = (complex(value) * np.exp(1j * phase)).real
                np.testing.assert_allclose(plane.fields[name][-1], expected, atol=1e-12)


@pytest.mark.parametrize("layer", [HALF_SPACE, asp.Solid(1.0, 0.3, 0.1)])
def test_mean_shear_stress_is_the_mean_traction(layer):
    solid = spots((32, 32), layer=layer)
    for plane in asp.stress_planes(solid, [0.0, 0.05, 0.1], None, COMPONENTS, friction=0.3):
        assert plane.fields["xz"].mean() == pytest.approx(0.3 * solid.pressure.mean(), rel=1e-12)
        assert plane.fields["yz"].mean() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize(("shape", "degrees"), [((20, 24), 0.0), ((21, 27), 33.0), ((30, 41), 90.0)])
def test_surface_carries_the_pressure_and_the_traction(shape, degrees, boundary):
    solid = spots(shape, (1.0, 1.4), boundary=boundary)
    settings = {"tolerance": 0, "friction": 0.4, "sliding_direction": degrees}
    plane = next(asp.stress_planes(solid, [0.0], None, ("zz", "xz", "yz"), **settings))
    shares = {"zz": -1, "xz": 0.4 * np.cos(np.radians(degrees)), "yz": 0.4 * np.sin(np.radians(degrees))}
    for name, share in shares.items():
        np.testing.assert_allclose(plane.fields[name][0], share * solid.pressure, atol=1e-12)


def largest_of_every_field(poisson, friction, height, envelope):
    """Largest field of a unit mode over K (1 + q d) e^(−q d), by searching depth, angle and phase."""
    worst, phase = 0.0, np.linspace(0, 2 * np.pi, 73)
    mode = StateSpace(1.0, 0.0, 1.0, poisson, height, digits=20)
    for d in (0.0, 0.3, 1.0, 2.0, 4.0, 12.0) if height is None else height * np.array([0, 0.5, 0.9, 1]):
        for angle in np.radians([0.0, 30.0, 60.0, 90.0]):
            amplitudes = mode.solve([friction * np.cos(angle), friction * np.sin(angle), -1])
            stress = np.array([complex(v) for v in mode.stress(d, amplitudes)])
            fields = invariants(np.real(np.exp(1j * phase)[:, None] * stress))
            worst = max(worst, np.abs(list(fields.values())).max() / (envelope(d) * (1 + d) * np.exp(-d)))
    return worst


@pytest.mark.parametrize("poisson", [-0.95, 0.0, 0.5])
@pytest.mark.parametrize(("friction", "height"), [(0.0, None), (3.0, None), (0.5, 0.3), (0.5, 2.0)])
def test_envelope_bounds_every_field_of_a_mode(poisson, friction, height):
    envelope = partial(envelope_of, asp.Solid(1.0, poisson, height), poisson, friction)
    largest = largest_of_every_field(poisson, friction, height, envelope)
    assert (0.5 if height is None else 0.35) < largest <= 1 + 1e-12
