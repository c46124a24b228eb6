"""Layer: shapes, types, the mean (q = 0) mode, and refused arguments."""

import dataclasses

import numpy as np
import pytest

from asperity.elasticity.layer import Layer, mirror_rows
from asperity.fourier.grid import Grid

SUPPORTED = [Layer(1.3, 0.3), Layer(1.3, 0.3, 0.4), Layer(1.3, 0.3, 0.4, "frictionless")]


@pytest.mark.parametrize("layer", SUPPORTED)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fields_broadcast_and_keep_their_precision(layer, dtype):
    q = np.linspace(0, 5, 4, dtype=dtype)[:, None]
    depth = np.linspace(0, 0.4, 3, dtype=dtype)
    kernels = layer.kernels(q, depth)
    assert all(k.shape == (4, 3) and k.dtype == dtype for k in kernels)
    compliance = layer.surface_compliance(q)
    assert compliance.shape == q.shape
    assert compliance.dtype == dtype
    kind = np.result_type(dtype, np.complex64)
    for values, shape in (
        (layer.stress(q, q, depth), (4, 3, 6)),
        (layer.displacement(q, q, depth), (4, 3, 3)),
        (layer.compliance(q, q), (4, 1, 6, 6)),
    ):
        assert values.shape == shape
        assert values.dtype == kind
    np.testing.assert_array_equal(layer.kernels(q[2], depth).shear, kernels.shear[2])


@pytest.mark.parametrize("layer", SUPPORTED)
def test_single_precision_is_double_precision_rounded(layer):
    q = np.linspace(0, 20, 50, dtype=np.float32)
    for single, double in zip(layer.kernels(q, 0.25), layer.kernels(q.astype(float), 0.25), strict=True):
        np.testing.assert_array_equal(single, double.astype(np.float32))


@pytest.mark.parametrize("lateral", ["confined", "free"])
@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_mean_mode_obeys_hooke(lateral, bottom):
    layer = Layer(2.0, 0.3, 0.5, bottom, lateral)
    xx, yy, zz, *shear = layer.uniform_stress()
    assert zz == -1
    assert shear == [0, 0, 0]
    assert xx == yy == (pytest.approx(-0.3 / 0.7) if lateral == "confined" else 0)
    modulus = 2.0 * 0.7 / (1.3 * 0.4) if lateral == "confined" else 2.0
    assert layer.surface_compliance(0.0) == pytest.approx(0.5 / modulus)
    np.testing.assert_array_equal(layer.stress(0.0, 0.0, [0.0, 0.2])[1], layer.uniform_stress())
    displacement = layer.displacement(0.0, 0.0, [0.0, 0.2, 0.5])
    np.testing.assert_allclose(displacement[:, 2], -np.array([0.5, 0.3, 0.0]) / modulus)
    np.testing.assert_array_equal(displacement[:, :2], 0)
    assert (zz - 0.3 * (xx + yy)) / 2.0 == pytest.approx(-1 / modulus)
    assert [float(kernel) for kernel in layer.kernels(0.0, 0.3)] == [1, 0, 0, 0, 0]


@pytest.mark.parametrize("layer", [Layer(1.0, 0.3), Layer(1.0, 0.3, 1.0, "free")])
def test_mean_displacement_without_a_support_is_zero(layer):
    assert layer.uniform_compliance() == 0
    assert layer.surface_compliance(0.0) == 0
    assert np.all(layer.compliance(0.0, 0.0) == 0)
    if layer.height is None:
        assert np.all(layer.displacement(0.0, 0.0, [0.0, 3.0]) == 0)
        assert np.all(layer.stress(0.0, 0.0, 3.0)[:2] == -0.3 / 0.7)


def test_incompressible_confined_layer_has_no_mean_compliance():
    assert Layer(1.0, 0.5, 1.0).surface_compliance(0.0) == 0


@pytest.mark.parametrize("shape", [(8, 6), (7, 5)])
def test_mirrored_rows_are_those_of_all_wavenumbers(shape):
    grid, layer = Grid(shape), Layer(1.0, 0.3, 0.2)
    compliance = mirror_rows(layer.half_grid_surface_compliance(grid), grid)
    np.testing.assert_array_equal(compliance, layer.surface_compliance(grid.wavenumber()))


@pytest.mark.parametrize("layer", [SUPPORTED[0], SUPPORTED[2]])
def test_stress_is_linear_in_poisson_unless_bonded(layer):
    def curvature(solid):
        stress = [dataclasses.replace(solid, poisson=nu).stress(3.0, -2.0, 0.17) for nu in (0.0, 0.25, 0.5)]
        return np.abs(stress[0] - 2 * stress[1] + stress[2]).max()

    assert curvature(layer) < 1e-15
    assert curvature(SUPPORTED[1]) > 1e-2


def test_half_space_compliance_is_that_of_separate_faces():
    tall, limit = (Layer(1.0, 0.2, height).compliance(3.0, 1.0) for height in (50.0, None))
    np.testing.assert_allclose(tall, limit, atol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"poisson": 0.5 + 1e-12}, "poisson = .* > -1 and ≤ 0.5"),
        ({"poisson": -1}, "poisson = -1"),
        ({"young": 0}, "young = 0: .* > 0"),
        ({"height": np.inf}, "height = inf: .* > 0, .* or None for the half-space"),
        ({"bottom": "glued"}, "bottom = 'glued': one of bonded, frictionless, free"),
        ({"lateral": "loose"}, "lateral = 'loose': one of confined, free"),
    ],
)
def test_an_argument_out_of_range_is_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        Layer(**{"young": 1.0, "poisson": 0.3, "height": 1.0, **arguments})


@pytest.mark.parametrize("arguments", [{"young": "1"}, {"poisson": 1j}, {"height": [1.0]}])
def test_an_argument_that_is_no_number_is_refused(arguments):
    with pytest.raises(TypeError, match=f"{next(iter(arguments))} = "):
        Layer(**{"young": 1.0, "poisson": 0.3, **arguments})


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda s: s.surface_compliance(-1.0), "q = -1.0: wavenumbers of 0 or from 1e-75 to 1e"),
        (lambda s: s.compliance(1e-320, 0.0), "q = "),
        (lambda s: s.kernels(1.0, -0.1), "depth = .*-0.1.*from 0 to 0.4"),
        (lambda s: s.kernels(1.0, 0.41), "depth = .*0.41.*from 0 to 0.4"),
        (lambda s: s.kernels(np.ones(3), np.zeros(2)), r"shapes q \(3,\), depth \(2,\)"),
        (lambda s: s.stress(np.ones(3), np.ones(2), 0.0), r"shapes qx \(3,\), qy \(2,\)"),
        (lambda s: s.displacement(1.0, np.inf, 0.0), "qy = .*inf"),
        (lambda s: s.half_grid_surface_compliance(Grid((4, 4)), "float16"), "dtype = 'float16': float64 or"),
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
        (lambda s: s.kernels(1j, 0.0), "q"),
        (lambda s: s.kernels([[1.0], [2.0, 3.0]], 0.0), "q"),
        (lambda s: s.kernels(1.0, "0.1"), "depth"),
        (lambda s: s.stress(1.0, "a", 0.0), "qy"),
        (lambda s: s.shear_kernels(1.0, [0.1, 0.2]), "depth"),
    ],
)
def test_an_array_that_is_not_real_is_refused(call, name):
    with pytest.raises(TypeError, match=f"{name} = .* needed$"):
        call(Layer(1.0, 0.3, 0.4))


EXTREMES = (1e-75, 1e-40, 1.0, 1e40, 1e75)


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-1 + 2**-53, 0.3, 0.5])
@pytest.mark.parametrize("height", [*EXTREMES, None])
def test_every_accepted_height_gives_finite_numbers(height, poisson, bottom):
    q = np.array([0.0, *EXTREMES])
    for young in EXTREMES:
        layer = Layer(young, poisson, height, bottom)
        depth = np.array([0.0, 0.3, 1.0])[:, None] * (height or 1.0)
        assert np.isfinite(layer.stress(q, 0.0, depth)).all()
        assert np.isfinite(layer.displacement(q, 0.0, depth)).all()
        assert np.isfinite(layer.surface_compliance(q)).all()


@pytest.mark.parametrize(
    "call",
    [
        lambda: Layer(1.0, 0.3, 1e-40, "free").surface_compliance(1e-75),
        lambda: Layer(1.0, 0.3, 1e-40).compliance(1e-75, 0.0),
        lambda: Layer(1e-40, 0.3, 1.0).displacement(np.float32(1), np.float32(1), 0.0),
    ],
)
def test_a_result_that_its_type_cannot_hold_is_refused(call):
    with pytest.raises(ValueError, match=r"too large for (float|complex)\d+"):
        call()


def test_depth_of_the_bottom_may_be_rounded():
    layer = Layer(1.0, 0.3, 0.1)
    assert float(np.float32(0.1)) > 0.1
    np.testing.assert_array_equal(layer.displacement(2.0, 1.0, np.float32(0.1)), 0)
    with pytest.raises(ValueError, match="depth"):
        layer.displacement(2.0, 1.0, float(np.float32(0.1)))
