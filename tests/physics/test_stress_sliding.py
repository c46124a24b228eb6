"""Stress under pressure and the traction of full sliding, against solutions that share no kernel with it."""

import tracemalloc

import numpy as np
import pytest

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Grid
from asperity.reference.state_space import StateSpace
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.planes import stress_planes
from asperity.stress.planes.truncation import envelope_of

HALF_SPACE = Layer(young=1.0, poisson=0.3)


def spots(shape, length=(1.0, 1.0), layer=HALF_SPACE):
    """Sharp random spots."""
    grid = Grid(shape, length)
    y, x = grid.coordinates()
    draw = np.random.default_rng(6)
    pressure = np.zeros(grid.shape)
    for cy, cx, radius in zip(*draw.uniform(0.2, 0.8, (2, 9)), draw.uniform(0.03, 0.1, 9), strict=True):
        square = (y[:, None] / length[0] - cy) ** 2 + (x[None, :] / length[1] - cx) ** 2
        pressure += np.sqrt(np.maximum(1 - square / radius**2, 0))
    return LoadedSolid(pressure, grid, layer)


@pytest.mark.parametrize("poisson", [-0.4, 0.3, 0.5])
@pytest.mark.parametrize(("kx", "ky", "degrees"), [(1, 0, 215.0), (0, 2, 90.0), (3, 2, 0.0), (-2, 3, 215.0)])
def test_one_mode_against_the_system_of_equilibrium_and_hookes_law(poisson, kx, ky, degrees):
    grid, friction = Grid((12, 16), (0.8, 1.3)), 0.7
    y, x = grid.coordinates()
    qx, qy = 2 * np.pi * kx / 1.3, 2 * np.pi * ky / 0.8
    phase = qy * y[:, None] + qx * x[None, :]
    traction = friction * np.cos(np.radians(degrees)), friction * np.sin(np.radians(degrees))
    mode = StateSpace(qx, qy, 1.0, poisson, digits=30)
    amplitudes = mode.solve([*traction, -1])
    solid = LoadedSolid(np.cos(phase), grid, Layer(young=1.0, poisson=poisson))
    settings = {"friction": friction, "sliding_direction": degrees, "tolerance": 0}
    for ratios in (None, [0.1, poisson]):
        for plane in stress_planes(solid, [0.0, 0.04, 0.3], ratios, COMPONENTS, **settings):
            state = mode.state(plane.depth, amplitudes)
            for name, value in zip(COMPONENTS, mode.stress_of(state), strict=True):
                expected = (complex(value) * np.exp(1j * phase)).real
                np.testing.assert_allclose(plane.fields[name][-1], expected, atol=1e-13)  # rounding


@pytest.mark.parametrize("poisson", [-0.9, 0.3, 0.5])
@pytest.mark.parametrize("height", [1e-5, 0.2, 3.0])
def test_one_mode_of_a_bonded_layer_against_the_same_system(poisson, height):
    grid, traction = Grid((12, 16), (0.8, 1.3)), (0.7 * np.cos(0.4), 0.7 * np.sin(0.4))
    y, x = grid.coordinates()
    qx, qy = 2 * np.pi * 2 / 1.3, 2 * np.pi * 3 / 0.8
    phase = qy * y[:, None] + qx * x[None, :]
    mode = StateSpace(qx, qy, 1.0, poisson, height, digits=60)
    amplitudes = mode.solve([*traction, -1])
    solid = LoadedSolid(np.cos(phase), grid, Layer(1.0, poisson, height))
    depths = np.array([0.0, 0.1, 0.5, 0.97, 1.0]) * min(height, 0.5)
    settings = {"friction": 0.7, "sliding_direction": np.degrees(0.4), "tolerance": 0}
    for plane in stress_planes(solid, depths, None, COMPONENTS, **settings):
        state = mode.state(plane.depth, amplitudes)
        for name, value in zip(COMPONENTS, mode.stress_of(state), strict=True):
            expected = (complex(value) * np.exp(1j * phase)).real
            np.testing.assert_allclose(plane.fields[name][0], expected, atol=1e-12)  # rounding


def test_mean_traction_on_a_bonded_layer_is_passed_to_its_base():
    solid = spots((16, 16), layer=Layer(1.0, 0.3, 0.1))
    for plane in stress_planes(solid, [0.0, 0.1], None, ("xz",), friction=0.3):
        assert plane.fields["xz"].mean() == pytest.approx(0.3 * solid.pressure.mean(), rel=1e-12)


@pytest.mark.parametrize("shape", [(20, 24), (21, 27)])
@pytest.mark.parametrize("degrees", [0.0, 33.0])
def test_surface_carries_the_pressure_and_the_traction(shape, degrees):
    solid = spots(shape, (1.0, 1.4))
    plane = next(
        stress_planes(solid, [0.0], None, ("zz", "xz", "yz"), 0, friction=0.4, sliding_direction=degrees)
    )
    x, y = 0.4 * np.cos(np.radians(degrees)), 0.4 * np.sin(np.radians(degrees))
    np.testing.assert_allclose(plane.fields["zz"][0], -solid.pressure, atol=1e-13)
    np.testing.assert_allclose(plane.fields["xz"][0], x * solid.pressure, atol=1e-13)
    np.testing.assert_allclose(plane.fields["yz"][0], y * solid.pressure, atol=1e-13)


def test_mean_shear_stress_is_the_mean_traction_at_every_depth():
    solid = spots((32, 32))
    for plane in stress_planes(solid, [0.0, 0.2, 1.0], [0.0, 0.5], COMPONENTS, friction=0.3):
        mean = solid.pressure.mean()
        assert plane.fields["xz"].mean(axis=(1, 2)) == pytest.approx(0.3 * mean, rel=1e-12)
        assert plane.fields["yz"].mean(axis=(1, 2)) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_memory_of_sliding_and_principal_stresses_does_not_grow_with_planes_or_ratios(boundary):
    """Planes are streamed, and a further ratio adds the named fields of one plane only."""
    solid = spots((64, 64))
    solid = LoadedSolid(solid.pressure, solid.grid, solid.layer, boundary)

    def largest(planes, ratios):
        depths = np.linspace(0, 0.05, planes)
        stream = stress_planes(
            solid,
            depths,
            ratios,
            ("principal_1", "largest_shear"),
            1e-4,
            friction=0.4,
            sliding_direction=20.0,
        )
        tracemalloc.start()
        for _ in stream:
            pass
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return found

    few, many = [0.0, 0.5], list(np.linspace(0, 0.5, 10))
    largest(2, few)
    assert largest(12, few) < 1.2 * largest(4, few)
    one_field = 8 * solid.pressure.size
    assert largest(4, many) - largest(4, few) < 2 * 2 * 8 * one_field


@pytest.mark.parametrize(("poisson", "friction"), [(-0.95, 0.0), (-0.95, 0.3), (0.3, 2.0), (0.5, 0.3)])
def test_error_of_coarse_planes_is_within_the_bound_for_every_field(poisson, friction):
    """The components of the coarse plane, interpolated to the full grid by their modes."""
    solid = spots((120, 120), layer=Layer(young=1.0, poisson=poisson))
    settings = {"friction": friction, "sliding_direction": 20.0}
    depths = [0.01, 0.04, 0.15, 0.4]
    share = []
    for plane, full in zip(
        stress_planes(solid, depths, fields=FIELDS, tolerance=1e-3, **settings),
        stress_planes(solid, depths, fields=FIELDS, tolerance=0, **settings),
        strict=True,
    ):
        step = solid.grid.shape[0] // plane.grid.shape[0]
        share.append(plane.grid.size / solid.grid.size)
        if step * plane.grid.shape[0] != solid.grid.shape[0]:
            continue  # the nodes of this plane are not all nodes of the full grid
        for name in FIELDS:
            error = np.abs(plane.fields[name] - full.fields[name][:, ::step, ::step]).max()
            # Rounding in single precision.
            assert error <= plane.bound + 1e-6 * np.abs(full.fields["zz"]).max()
    assert share[-1] < 0.1


def largest_of_every_field(poisson, friction, height=None):
    """Largest field of a unit mode over (1 + q d) e^(−q d), by searching depth, angle and phase."""
    worst = 0.0
    phase = np.linspace(0, 2 * np.pi, 73)
    for d in (0.0, 0.3, 1.0, 2.0, 4.0, 12.0) if height is None else height * np.array([0, 0.5, 0.9, 1]):
        for degrees in (0.0, 30.0, 60.0, 90.0):
            angle = np.radians(degrees)
            along, across = friction * np.cos(angle), friction * np.sin(angle)
            mode = StateSpace(1.0, 0.0, 1.0, poisson, height, digits=20)
            stress = [complex(v) for v in mode.stress_of(mode.state(d, mode.solve([along, across, -1])))]
            xx, yy, zz, yz, xz, xy = (np.real(v * np.exp(1j * phase)) for v in stress)
            tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(-1, 3, 3)
            principal = np.linalg.eigvalsh(tensor)
            mises = np.sqrt(0.5 * sum((principal[:, i] - principal[:, i - 1]) ** 2 for i in range(3)))
            worst = max(worst, max(np.abs(principal).max(), mises.max()) / ((1 + d) * np.exp(-d)))
    return worst


@pytest.mark.parametrize("poisson", [-0.95, 0.0, 0.5])
@pytest.mark.parametrize("friction", [0.0, 3.0])
def test_envelope_bounds_every_field_of_a_mode(poisson, friction):
    envelope = envelope_of(Layer(1.0, poisson), poisson, friction)
    largest = largest_of_every_field(poisson, friction)
    assert 0.5 * envelope < largest <= envelope * (1 + 1e-12)


@pytest.mark.parametrize("poisson", [-0.9, 0.5])
@pytest.mark.parametrize("height", [0.3, 2.0])
def test_envelope_bounds_every_field_of_a_mode_in_a_bonded_layer(poisson, height):
    largest = largest_of_every_field(poisson, 0.5, height)
    assert largest <= envelope_of(Layer(1.0, poisson, height), poisson, 0.5)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"friction": -0.1}, r"friction = -0\.1: a number from 0 to 1000 is needed"),
        ({"friction": "0.1"}, r"friction = '0\.1': a number from 0 to 1000"),
        ({"sliding_direction": "z"}, 'sliding_direction = \'z\': "x", "y" or an angle in degrees'),
        ({"sliding_direction": None}, 'sliding_direction = None: "x", "y" or an angle in degrees'),
        (
            {"contact": spots((8, 8), layer=Layer(1.0, 0.3, 0.5, "frictionless"))},
            r"friction = 0\.2: 0 is needed in a layer with a frictionless bottom",
        ),
    ],
)
def test_bad_input_names_argument_value_and_range(changes, message):
    arguments = {"contact": spots((8, 8)), "depths": [0.0], "friction": 0.2} | changes
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        stress_planes(**arguments)
