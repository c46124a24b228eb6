"""Laws of mechanics and limits that the layer obeys, independent of its formulas."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.elasticity.layer import Layer

# No deadline, because the first example may compile.
unhurried = settings(deadline=None)

ratios = st.one_of(st.floats(-0.95, 0.5), st.just(0.5))
heights = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
angles = st.floats(0, 2 * np.pi)
supports = st.sampled_from(["bonded", "frictionless"])


@st.composite
def solids(draw):
    height = draw(st.one_of(st.none(), heights))
    return Layer(draw(st.floats(0.1, 10)), draw(ratios), height, draw(supports))


@unhurried
@given(ratios, heights, angles)
def test_compliance_is_hermitian_and_positive(poisson, height, angle):
    layer = Layer(1.0, poisson, height)
    qx, qy = np.cos(angle), np.sin(angle)
    g = layer.compliance(qx, qy)
    size = np.sqrt(np.diag(g).real)
    scaled = g / np.outer(size, size)
    # Rounding.
    np.testing.assert_allclose(scaled, scaled.conj().T, atol=4e-15)
    # A thin layer bends and stretches almost freely: its smallest eigenvalue is rounding.
    assert np.linalg.eigvalsh(scaled).min() > -1e-14
    if height > 0.1:
        assert np.linalg.eigvalsh(scaled).min() > 0
    swap = np.kron([[0, 1], [1, 0]], np.diag([1, 1, -1]))
    np.testing.assert_allclose(swap @ g @ swap / np.outer(size, size), scaled, atol=4e-15)
    # Opposite wavevectors have conjugate compliances: real fields.
    np.testing.assert_allclose(layer.compliance(-qx, -qy), g.conj(), rtol=1e-14, atol=0)


@unhurried
@given(ratios, heights)
def test_free_layer_is_the_softest_and_bonded_the_stiffest(poisson, height):
    q = np.geomspace(0.01, 50, 30) / height
    bonded, slides, free = (
        Layer(1.0, poisson, height, bottom).surface_compliance(q)
        for bottom in ("bonded", "frictionless", "free")
    )
    rounding = 1 + 4e-15
    assert np.all(bonded <= slides * rounding)
    assert np.all(slides <= free * rounding)
    assert np.all(bonded > 0)
    corner = Layer(1.0, poisson, height).compliance(q, 0 * q)[:, 2, 2]
    np.testing.assert_allclose(corner.real, free, rtol=4e-15)


@unhurried
@given(solids(), angles)
def test_tractions_at_the_top_are_the_pressure(layer, angle):
    q = np.geomspace(1e-3, 1e3, 13)
    stress = layer.stress(q * np.cos(angle), q * np.sin(angle), 0.0)
    # Rounding.
    np.testing.assert_allclose(stress[:, 2], -1, atol=4e-15)
    np.testing.assert_allclose(stress[:, 3:5], 0, atol=4e-15)
    sunk = -layer.displacement(q * np.cos(angle), q * np.sin(angle), 0.0)[:, 2]
    np.testing.assert_allclose(sunk, layer.surface_compliance(q), rtol=1e-14)


def profiles(layer, qx, qy, depth, step):
    """Displacement, stress and their derivatives along z by an eighth-order central difference."""
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    depths = depth - step * np.arange(-4, 5)
    u, s = layer.displacement(qx, qy, depths), layer.stress(qx, qy, depths)
    return u[4], s[4], weights @ u / step, weights @ s / step


@unhurried
@given(solids(), angles, st.floats(0.2, 0.8), st.floats(-1, 1))
def test_fields_are_in_equilibrium_and_obey_hooke(layer, angle, fraction, exponent):
    reach = layer.height or 1.0
    q = 10.0**exponent / reach
    qx, qy = q * np.cos(angle), q * np.sin(angle)
    step = 0.02 * reach / max(1.0, q * reach)
    u, s, u_z, s_z = profiles(layer, qx, qy, fraction * reach, step)
    xx, yy, zz, yz, xz, xy = s
    # Truncation of the difference, (q step)^8, and rounding over the step.
    small = 1e-11 * np.abs(s).max()
    assert abs(1j * qx * xx + 1j * qy * xy + s_z[4]) < small / step
    assert abs(1j * qx * xy + 1j * qy * yy + s_z[3]) < small / step
    assert abs(1j * qx * xz + 1j * qy * yz + s_z[2]) < small / step
    e, nu = layer.young, layer.poisson
    strain = [1j * qx * u[0], 1j * qy * u[1], u_z[2]]
    shear = [u_z[1] + 1j * qy * u[2], u_z[0] + 1j * qx * u[2], 1j * (qy * u[0] + qx * u[1])]
    small = (1e-11 * np.abs(s).max() / e + 1e-13 * np.abs(u).max() / step) * 10
    for i, normal in enumerate((xx, yy, zz)):
        others = xx + yy + zz - normal
        assert abs(strain[i] - (normal - nu * others) / e) < small
    for i, stress in enumerate((yz, xz, xy)):
        assert abs(shear[i] - 2 * (1 + nu) / e * stress) < small


@unhurried
@given(ratios, supports, st.floats(0, 0.5))
def test_a_tall_layer_is_the_half_space(poisson, bottom, depth):
    tall, half_space = Layer(1.0, poisson, 60.0, bottom), Layer(1.0, poisson)
    # e^(−60) and rounding
    np.testing.assert_allclose(tall.stress(1.0, 0.4, depth), half_space.stress(1.0, 0.4, depth), atol=4e-15)
    assert tall.surface_compliance(1.0) == pytest.approx(half_space.surface_compliance(1.0), rel=4e-15)


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_fields_are_continuous_at_the_incompressible_limit(bottom):
    """The fields approach those at ν = 1/2 linearly in 1/2 − ν."""
    limit = Layer(1.0, 0.5, 0.8, bottom)
    q = np.array([0.03, 0.5, 2.0, 20.0])
    steps = np.array([1e-3, 1e-4, 1e-5])
    errors = []
    for step in steps:
        near = dataclasses.replace(limit, poisson=0.5 - step)
        errors.append(np.abs(near.stress(q, q, 0.3) - limit.stress(q, q, 0.3)).max())
    rate = np.diff(np.log(errors)) / np.diff(np.log(steps))
    if bottom == "frictionless":
        np.testing.assert_allclose(rate, 1, atol=0.01)
    else:
        # Thin and almost incompressible: the limit begins where 1 − 2ν is small against (q height)².
        np.testing.assert_allclose(rate[-1], 1, atol=0.1)


def test_long_waves_on_a_bonded_layer_are_uniform_compression():
    """G → height/C11, quadratically in q; at ν = 1/2, G → q² height³/E instead."""
    layer = Layer(2.0, 0.3, 0.5)
    q = np.array([1e-1, 1e-2, 1e-3])
    difference = np.abs(layer.surface_compliance(q) / layer.uniform_compliance() - 1)
    np.testing.assert_allclose(np.diff(np.log10(difference)), -2, atol=0.01)
    stress = layer.stress(1e-7, 0.0, 0.2)
    # Terms of first order in q height.
    np.testing.assert_allclose(stress, layer.uniform_stress(), atol=1e-6)
    rubber = Layer(2.0, 0.5, 0.5)
    assert rubber.surface_compliance(1e-5) == pytest.approx(1e-10 * 0.5**3 / 2.0, rel=1e-8)


def test_long_waves_on_a_frictionless_layer_stretch_it():
    """G → (1 − ν²) height/E: the layer spreads along q but not across; this is not the mean (q = 0) mode."""
    layer = Layer(2.0, 0.3, 0.5, "frictionless")
    assert layer.surface_compliance(1e-6) == pytest.approx((1 - 0.3**2) * 0.5 / 2.0, rel=1e-10)
    assert layer.surface_compliance(1e-6) > 1.1 * layer.surface_compliance(0.0)


def test_long_waves_bend_a_free_layer():
    """G → 12 (1 − ν²)/(E q⁴ height³), the bending compliance of a plate."""
    assert Layer(2.0, 0.3, 0.5, "free").surface_compliance(1e-4) == pytest.approx(
        12 * (1 - 0.3**2) / (2.0 * 1e-16 * 0.5**3), rel=1e-7
    )


@unhurried
@given(solids(), st.floats(-4, 4))
def test_kernels_stay_below_their_envelope(layer, exponent):
    """The bound used to drop modes at a depth: (1 + d) e^(−d), twice that in a layer."""
    reach = layer.height or 1.0
    q = 10.0**exponent / reach
    depth = np.linspace(0, reach, 41)
    envelope = (1 + q * depth) * np.exp(-q * depth)
    limit = (1.0 if layer.height is None else 2.0) * (1 + 1e-13) * envelope + 1e-290
    kernels = layer.kernels(q, depth)
    for kernel in kernels[:3]:
        assert np.all(np.abs(kernel) <= limit)
    for kernel in kernels[3:]:
        assert np.all(np.abs(kernel) <= 2 * (1 - layer.poisson) * limit)


@unhurried
@given(solids(), st.floats(0.01, 10), angles)
def test_turning_the_wavevector_turns_the_fields(layer, q, angle):
    depth = 0.3 * (layer.height or 1.0)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    along, turned = (layer.stress(*w, depth) for w in ((q, 0.0), (q * c, q * s)))

    def tensor(v):
        xx, yy, zz, yz, xz, xy = v
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    # Rounding of q and of the rotation.
    np.testing.assert_allclose(turn @ tensor(along) @ turn.T, tensor(turned), atol=1e-13)
    u, v = layer.displacement(q, 0.0, depth), layer.displacement(q * c, q * s, depth)
    np.testing.assert_allclose(turn @ u, v, atol=1e-13 * np.abs(u).max() + 1e-300)
