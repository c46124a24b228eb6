"""Layer: shapes, types, special modes, and refused arguments."""

import dataclasses

import numpy as np
import pytest

from asperity.elasticity.layer import COMPONENTS, Kernels, Layer, mirror_rows
from asperity.spectral import Fourier, Grid

SUPPORTED = [
    Layer(1.3, 0.3),
    Layer(1.3, 0.3, 0.4),
    Layer(1.3, 0.3, 0.4, "frictionless"),
]


@pytest.mark.parametrize("layer", [*SUPPORTED, Layer(1.3, 0.3, 0.4, "free")])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_surface_compliance_keeps_shape_and_type(layer, dtype):
    q = np.arange(6, dtype=dtype).reshape(2, 3)
    compliance = layer.surface_compliance(q)
    assert compliance.shape == q.shape
    assert compliance.dtype == dtype
    assert layer.surface_compliance(2).dtype == np.float64
    assert layer.surface_compliance(2).shape == ()


@pytest.mark.parametrize("layer", SUPPORTED)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fields_broadcast_and_keep_their_precision(layer, dtype):
    q = np.linspace(0, 5, 4, dtype=dtype)[:, None]
    depth = np.linspace(0, 0.4, 3, dtype=dtype)
    kernels = layer.kernels(q, depth)
    assert isinstance(kernels, Kernels)
    assert all(k.shape == (4, 3) and k.dtype == dtype for k in kernels)
    kind = np.result_type(dtype, np.complex64)
    stress = layer.stress(q, q, depth)
    assert stress.shape == (4, 3, 6)
    assert stress.dtype == kind
    displacement = layer.displacement(q, q, depth)
    assert displacement.shape == (4, 3, 3)
    assert displacement.dtype == kind
    assert layer.compliance(q, q).shape == (4, 1, 6, 6)
    np.testing.assert_array_equal(layer.kernels(q[2], depth).shear, kernels.shear[2])


@pytest.mark.parametrize("layer", SUPPORTED)
def test_single_precision_is_double_precision_rounded(layer):
    q = np.linspace(0, 20, 50, dtype=np.float32)
    for single, double in zip(layer.kernels(q, 0.25), layer.kernels(q.astype(float), 0.25), strict=True):
        np.testing.assert_array_equal(single, double.astype(np.float32))


@pytest.mark.parametrize("lateral", ["confined", "free"])
@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_uniform_mode(lateral, bottom):
    layer = Layer(2.0, 0.3, 0.5, bottom, lateral)
    xx, yy, zz, *shear = layer.uniform_stress()
    c11 = 2.0 * 0.7 / (1.3 * 0.4)
    assert zz == -1
    assert shear == [0, 0, 0]
    assert xx == yy == (pytest.approx(-0.3 / 0.7) if lateral == "confined" else 0)
    modulus = c11 if lateral == "confined" else 2.0
    assert layer.surface_compliance(0.0) == pytest.approx(0.5 / modulus)
    np.testing.assert_array_equal(layer.stress(0.0, 0.0, [0.0, 0.2])[1], layer.uniform_stress())
    displacement = layer.displacement(0.0, 0.0, [0.0, 0.2, 0.5])
    np.testing.assert_allclose(displacement[:, 2], -np.array([0.5, 0.3, 0.0]) / modulus)
    np.testing.assert_array_equal(displacement[:, :2], 0)
    # Hooke: the vertical strain of the uniform stress
    assert (zz - 0.3 * (xx + yy)) / 2.0 == pytest.approx(-1 / modulus)


@pytest.mark.parametrize("layer", [Layer(1.0, 0.3), Layer(1.0, 0.3, 1.0, "free")])
def test_uniform_displacement_without_a_support_is_set_to_zero(layer):
    assert layer.uniform_compliance() == 0
    assert layer.surface_compliance(0.0) == 0
    assert np.all(layer.compliance(0.0, 0.0) == 0)
    if layer.height is None:
        assert np.all(layer.displacement(0.0, 0.0, [0.0, 3.0]) == 0)
        assert np.all(layer.stress(0.0, 0.0, 3.0)[:2] == -0.3 / 0.7)


def test_incompressible_confined_layer_has_no_uniform_compliance():
    assert Layer(1.0, 0.5, 1.0).surface_compliance(0.0) == 0


def test_kernels_of_the_uniform_mode():
    for kernel, value in zip(Layer(1.0, 0.3, 1.0).kernels(0.0, 0.3), (1, 0, 0, 0, 0), strict=True):
        assert kernel == value


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_modes_evaluated_together_are_those_evaluated_one_by_one(bottom, dtype):
    """Blocks of thin modes, of thick ones and of both, with and without the uniform mode; bound: rounding."""
    layer = Layer(1.0, 0.4, 0.01, bottom)
    q = np.concatenate([[0], np.linspace(0.1, 99, 700), np.linspace(90, 300, 500)]).astype(dtype)
    together = np.array(layer.kernels(q, 0.004))
    one_by_one = np.array(layer.kernels(q, np.full(q.shape, 0.004)))
    np.testing.assert_allclose(together, one_by_one, rtol=0, atol=10 * np.finfo(dtype).eps)
    np.testing.assert_array_equal(together[:, 0], [1, 0, 0, 0, 0])


@pytest.mark.parametrize("layer", SUPPORTED)
@pytest.mark.parametrize("shape", [(8, 6), (7, 5), (6, 9), (1, 4)])
def test_fields_of_a_grid_are_real_and_follow_the_nyquist_rule(layer, shape):
    """Components odd in a Nyquist wavevector are zero there; everything else is the field of the mode."""
    grid = Grid(shape, (1.5, 2.0))
    stress, displacement = layer.grid_stress(grid, 0.1), layer.grid_displacement(grid, 0.1)
    assert stress.shape == (*grid.half_shape, 6)
    x, y = np.broadcast_arrays(grid.qx, grid.qy[:, None])
    expected, moved = layer.stress(x, y, 0.1), layer.displacement(x, y, 0.1)
    nyquist_x = 2 * grid.kx == shape[1]
    nyquist_y = 2 * grid.ky == shape[0]
    for name, odd_x, odd_y in (("yz", 0, 1), ("xz", 1, 0), ("xy", 1, 1)):
        component = COMPONENTS.index(name)
        zero = (odd_x & nyquist_x[None, :]) | (odd_y & nyquist_y[:, None])
        expected[..., component][zero.astype(bool)] = 0
    moved[:, nyquist_x, 0] = 0
    moved[nyquist_y, :, 1] = 0
    np.testing.assert_array_equal(stress, expected)
    np.testing.assert_array_equal(displacement, moved)
    # A real field: its transform has the coefficients that went in.
    fourier = Fourier(grid)
    for component in range(6):
        field = fourier.inverse(np.ascontiguousarray(stress[..., component]))
        # Rounding of a pair of transforms.
        np.testing.assert_allclose(fourier.forward(field), stress[..., component], atol=1e-15)


@pytest.mark.parametrize("shape", [(8, 6), (7, 5)])
def test_rows_of_equal_wavenumber_are_evaluated_once(shape):
    grid = Grid(shape)
    layer = Layer(1.0, 0.3, 0.2)
    kernels = layer.grid_kernels(grid, 0.05)
    assert kernels.normal.shape == (shape[0] // 2 + 1, shape[1] // 2 + 1)
    whole = layer.kernels(grid.wavenumber(), 0.05)
    for half, full in zip(kernels, whole, strict=True):
        np.testing.assert_array_equal(mirror_rows(half, grid), full)
    compliance = layer.grid_surface_compliance(grid)
    np.testing.assert_array_equal(compliance, layer.surface_compliance(grid.wavenumber()))
    assert layer.grid_surface_compliance(grid, "float32").dtype == np.float32


@pytest.mark.parametrize("layer", [SUPPORTED[0], SUPPORTED[2]])
def test_stress_split_serves_every_poisson_ratio(layer):
    qx, qy, depth = 3.0, -2.0, 0.17
    constant, slope = layer.stress_split(qx, qy, depth)
    np.testing.assert_array_equal(slope[2:5], 0)
    # Rounding of the sum.
    assert constant[0] + constant[1] + constant[2] == pytest.approx(slope[0] + slope[1], abs=1e-15)
    for nu in (-0.9, 0.0, 0.25, 0.5):
        stress = dataclasses.replace(layer, poisson=nu).stress(qx, qy, depth)
        np.testing.assert_allclose(constant + nu * slope, stress, atol=1e-15)


def test_bonded_stress_is_not_linear_in_poisson():
    stress = [Layer(1.0, nu, 0.4).stress(3.0, -2.0, 0.17) for nu in (0.0, 0.25, 0.5)]
    assert np.abs(stress[0] - 2 * stress[1] + stress[2]).max() > 1e-2


def test_half_space_compliance_is_that_of_two_separate_faces():
    tall, limit = (Layer(1.0, 0.2, height).compliance(3.0, 1.0) for height in (50.0, None))
    np.testing.assert_allclose(tall, limit, atol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"poisson": 0.5 + 1e-12}, "poisson = .* > -1 and ≤ 0.5"),
        ({"poisson": -1}, "poisson = -1"),
        ({"poisson": np.nan}, "poisson = nan"),
        ({"young": 0}, "young = 0: .* > 0"),
        ({"young": np.inf}, "young = inf"),
        ({"young": 10**400}, "young = 1000"),
        ({"young": 5e-324}, "young = 5e-324: a number > 0, from 1e-75 to 1e"),
        ({"height": 0.0}, "height = 0.0: .* > 0, .* or None for the half-space"),
        ({"height": np.inf}, "height = inf"),
        ({"height": 10**400}, "height = 1000"),
        ({"height": 1e-300}, "height = 1e-300: a number > 0, from 1e-75 to 1e"),
        ({"height": 5e-324}, "height = 5e-324"),
        ({"height": 1e300}, r"height = 1e\+300"),
        ({"bottom": "glued"}, "bottom = 'glued': one of bonded, frictionless, free"),
        ({"lateral": "loose"}, "lateral = 'loose': one of confined, free"),
    ],
)
def test_an_argument_out_of_range_is_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        Layer(**{"young": 1.0, "poisson": 0.3, "height": 1.0, **arguments})


@pytest.mark.parametrize(
    "arguments",
    [
        {"young": "1"},
        {"young": b"1"},
        {"young": True},
        {"young": np.True_},
        {"poisson": None},
        {"poisson": 1j},
        {"height": [1.0]},
        {"height": False},
    ],
)
def test_an_argument_that_is_not_a_number_is_refused(arguments):
    with pytest.raises(TypeError, match=f"{next(iter(arguments))} = "):
        Layer(**{"young": 1.0, "poisson": 0.3, **arguments})


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda s: s.surface_compliance(-1.0), "q = -1.0: wavenumbers of 0 or from 1e-75 to 1e"),
        (lambda s: s.surface_compliance(1e-80), "q = 1e-80"),
        (lambda s: s.kernels(1e80, 0.0), r"q = 1e\+80"),
        (lambda s: s.compliance(1e-320, 0.0), "q = "),
        (lambda s: s.surface_compliance([1.0, np.nan]), "q = .*nan"),
        (lambda s: s.kernels(np.inf, 0.0), "q = .*inf"),
        (lambda s: s.kernels(1.0, -0.1), "depth = .*-0.1.*from 0 to 0.4"),
        (lambda s: s.kernels(1.0, 0.41), "depth = .*0.41.*from 0 to 0.4"),
        (lambda s: s.kernels(1.0, np.nan), "depth = .*nan"),
        (lambda s: s.kernels(np.ones(3), np.zeros(2)), r"shapes q \(3,\), depth \(2,\)"),
        (lambda s: s.stress(np.ones(3), np.ones(2), 0.0), r"shapes qx \(3,\), qy \(2,\)"),
        (lambda s: s.stress(np.nan, 1.0, 0.0), "qx = .*nan"),
        (lambda s: s.displacement(1.0, np.inf, 0.0), "qy = .*inf"),
        (lambda s: s.grid_stress(Grid((4, 4)), np.nan), "depth = nan"),
        (
            lambda s: s.grid_surface_compliance(Grid((4, 4)), "float16"),
            "dtype = 'float16': float64 or float32",
        ),
        (lambda s: s.kernels(np.ma.masked_less([1.0, 2.0], 1.5), 0.0), "q: an array without masked elements"),
        (lambda s: dataclasses.replace(s, bottom="free").kernels(1.0, 0.1), "bottom = 'free'"),
    ],
)
def test_a_wavenumber_or_depth_out_of_range_is_named(call, words):
    with pytest.raises(ValueError, match=words):
        call(Layer(1.0, 0.3, 0.4))


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda s: s.kernels("a", 0.0), "q"),
        (lambda s: s.kernels(1j, 0.0), "q"),
        (lambda s: s.kernels(True, 0.0), "q"),
        (lambda s: s.kernels([[1.0], [2.0, 3.0]], 0.0), "q"),
        (lambda s: s.kernels(10**400, 0.0), "q"),
        (lambda s: s.kernels(1.0, "0.1"), "depth"),
        (lambda s: s.kernels(1.0, 0.1j), "depth"),
        (lambda s: s.kernels(1.0, False), "depth"),
        (lambda s: s.stress(1.0, "a", 0.0), "qy"),
        (lambda s: s.grid_kernels(Grid((4, 4)), [0.1, 0.2]), "depth"),
    ],
)
def test_an_array_that_is_not_of_real_numbers_is_refused(call, name):
    with pytest.raises(TypeError, match=f"{name} = .* needed$"):
        call(Layer(1.0, 0.3, 0.4))


EXTREMES = (1e-75, 1e-40, 1.0, 1e40, 1e75)


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-1 + 2**-53, 0.3, 0.5])
@pytest.mark.parametrize("height", [*EXTREMES, None])
def test_every_accepted_height_and_wavenumber_gives_finite_numbers(height, poisson, bottom):
    q = np.array([0.0, *EXTREMES])
    for young in EXTREMES:
        layer = Layer(young, poisson, height, bottom)
        depth = np.array([0.0, 0.3, 1.0])[:, None] * (height or 1.0)
        assert all(np.isfinite(kernel).all() for kernel in layer.kernels(q, depth))
        assert np.isfinite(layer.stress(q, 0.0, depth)).all()
        assert np.isfinite(layer.displacement(q, 0.0, depth)).all()
        assert np.isfinite(layer.surface_compliance(q)).all()


@pytest.mark.parametrize(
    "call",
    [
        lambda: Layer(1.0, 0.3, 1e-40, "free").surface_compliance(1e-75),
        lambda: Layer(1.0, 0.3, 1e-40).compliance(1e-75, 0.0),
        lambda: Layer(1.0, 0.3, 1e40).surface_compliance(np.float32(0)),
        lambda: Layer(1e-40, 0.3, 1.0).displacement(np.float32(1), np.float32(1), 0.0),
    ],
)
def test_a_result_that_its_type_cannot_hold_is_refused(call):
    with pytest.raises(ValueError, match=r"too large for (float|complex)\d+"):
        call()


def test_depth_of_the_bottom_may_be_rounded_in_its_own_precision():
    layer = Layer(1.0, 0.3, 0.1)
    assert float(np.float32(0.1)) > 0.1
    np.testing.assert_array_equal(layer.displacement(2.0, 1.0, np.float32(0.1)), 0)
    with pytest.raises(ValueError, match="depth"):
        layer.displacement(2.0, 1.0, float(np.float32(0.1)))
