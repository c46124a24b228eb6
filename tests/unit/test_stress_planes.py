import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.planes import depth_grid, stress_planes
from asperity.stress.planes.truncation import Truncation

pytestmark = pytest.mark.engines

HALF_SPACE = Layer(young=1.0, poisson=0.3)
BONDED = Layer(young=1.0, poisson=0.4, height=0.3)
FRICTIONLESS = Layer(young=1.0, poisson=0.2, height=0.3, bottom="frictionless")


def pressed(shape=(64, 64), layer=HALF_SPACE, length=1.0, seed=1, spots=12):
    """Sharp random spots: any non-negative pressure is a possible one."""
    grid = Grid(shape, length)
    y, x = grid.coordinates()
    draw = np.random.default_rng(seed)
    pressure = np.zeros(shape)
    for _ in range(spots):
        centre, radius = draw.random(2) * grid.length, draw.uniform(0.02, 0.08)
        dy = (y - centre[0] + grid.length[0] / 2) % grid.length[0] - grid.length[0] / 2
        dx = (x - centre[1] + grid.length[1] / 2) % grid.length[1] - grid.length[1] / 2
        pressure += np.sqrt(np.maximum(1 - (dy[:, None] ** 2 + dx[None, :] ** 2) / radius**2, 0))
    return LoadedSolid(0.1 * pressure, grid, layer)


@pytest.mark.parametrize("layer", [HALF_SPACE, BONDED, FRICTIONLESS])
@pytest.mark.parametrize("shape", [(32, 30), (33, 35)])
def test_components_are_those_of_the_layer_mode_by_mode(layer, shape):
    contact = pressed(shape, layer, (0.7, 1.1))
    grid, fourier = contact.grid, Fourier(contact.grid)
    modes = fourier.forward(contact.pressure)
    for plane in stress_planes(contact, [0.0, 0.01, 0.2], fields=COMPONENTS, tolerance=0):
        stress = layer.stress(grid.qx[None, :], grid.qy[:, None], plane.depth) * modes[..., None]
        stress[..., [4, 5]] *= (2 * grid.kx != grid.shape[1])[:, None]
        stress[..., [3, 5]] *= (2 * grid.ky != grid.shape[0])[:, None, None]
        stress[0, 0] = layer.uniform_stress() * modes[0, 0]
        for number, name in enumerate(COMPONENTS):
            expected = fourier.inverse(stress[..., number])
            rounding = 1e-13 * np.abs(contact.pressure).max()
            np.testing.assert_allclose(plane.fields[name][0], expected, rtol=0, atol=rounding)


@pytest.mark.parametrize("lateral", ["confined", "free"])
def test_uniform_mode_follows_the_choice_of_the_layer(lateral):
    layer = Layer(young=1.0, poisson=0.25, lateral=lateral)
    contact = pressed(layer=layer)
    mean = contact.pressure.mean()
    for plane in stress_planes(contact, [0.05, 1.0], [0.25, 0.4], ("xx", "zz")):
        for number, nu in enumerate((0.25, 0.4)):
            expected = -nu / (1 - nu) * mean if lateral == "confined" else 0.0
            assert plane.fields["xx"][number].mean() == pytest.approx(expected, abs=1e-14)
        assert plane.fields["zz"].mean() == pytest.approx(-mean, rel=1e-12)


@pytest.mark.parametrize("layer", [HALF_SPACE, BONDED, FRICTIONLESS])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_coarse_planes_agree_with_the_full_grid_within_the_tolerance(layer, tolerance):
    """The trigonometric interpolant of a coarse plane, at every node of the full grid."""
    contact = pressed((144, 144), layer)
    fourier = Fourier(contact.grid)
    depths = np.array([0.0, 0.01, 0.03, 0.08, 0.2, 0.3])
    sizes = []
    for plane, full in zip(
        stress_planes(contact, depths, fields=FIELDS, tolerance=tolerance),
        stress_planes(contact, depths, fields=FIELDS, tolerance=0),
        strict=True,
    ):
        sizes.append(plane.grid.size)
        allowed = tolerance * np.sqrt(np.mean(full.fields["zz"] ** 2)) + 1e-13
        assert plane.bound <= allowed
        for name in COMPONENTS:
            modes = resample(Fourier(plane.grid).forward(plane.fields[name][0]), plane.grid, contact.grid)
            fine = fourier.inverse(modes) if plane.grid != contact.grid else plane.fields[name][0]
            assert np.abs(fine - full.fields[name][0]).max() <= allowed
    assert sizes[-1] < sizes[0] / 10


@pytest.mark.parametrize("layer", [HALF_SPACE, BONDED])
def test_single_precision_only_where_the_tolerance_is_above_its_rounding(layer):
    contact = pressed(layer=layer)
    depths = [0.0, 0.01, 0.2]
    for single, double in zip(
        stress_planes(contact, depths, fields=FIELDS, tolerance=1e-4),
        stress_planes(contact, depths, fields=FIELDS, tolerance=1e-5),
        strict=True,
    ):
        scale = double.fields["zz"].std()
        for name in FIELDS:
            assert single.fields[name].dtype == np.float32
            assert double.fields[name].dtype == np.float64
        if single.grid == double.grid:
            for name in FIELDS:
                error = np.abs(single.fields[name] - double.fields[name]).max()
                assert error < 5e-6 * scale  # rounding


def test_grid_never_becomes_finer_with_depth_nor_coarser_with_accuracy():
    contact = pressed((128, 128))
    depths = depth_grid(contact.grid)
    sizes = [
        [plane.grid.size for plane in stress_planes(contact, depths, fields=("zz",), tolerance=t)]
        for t in (1e-2, 1e-4, 1e-8)
    ]
    assert all(np.all(np.diff(s) <= 0) for s in sizes)
    assert np.all(np.diff(sizes, axis=0) >= 0)


def test_oblong_cell_keeps_the_bound_on_both_axes():
    contact = pressed((60, 240), length=(0.25, 1.0))
    grid = contact.grid
    modes = Fourier(grid).forward(contact.pressure)
    truncation = Truncation(modes, grid, HALF_SPACE, 1e-4, np.sqrt(3))
    chosen, bound, *_ = truncation.choose(0.05)
    assert chosen.shape[0] < 60
    assert chosen.shape[1] < 240
    lost = modes - resample(resample(modes, grid, chosen), chosen, grid)
    decay = grid.wavenumber() * 0.05
    largest = np.sum(np.abs(lost) * (1 + decay) * np.exp(-decay) * grid.multiplicity)
    assert np.sqrt(3) * largest <= bound <= 1e-4 * truncation.scale(0.05)


@pytest.mark.parametrize(
    ("fields", "poisson", "transforms"),
    [
        (("zz",), [0.3], 1),
        (("zz", "xz"), [0.0, 0.5], 2),
        (("xx",), [0.3], 1),
        (("xx",), [0.0, 0.1, 0.2, 0.3], 2),
        (("von_mises",), [0.3], 6),
        (("von_mises", "xx"), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5], 8),
    ],
)
def test_no_more_transforms_than_the_fields_need(fields, poisson, transforms):
    work = Work()
    contact = pressed()
    list(stress_planes(contact, [0.001], poisson, fields, tolerance=0, work=work))
    assert work.transforms(contact.grid) == transforms + 1  # the one is that of the pressure


@pytest.mark.parametrize("shape", [(16, 24), (15, 21)])
def test_all_ratios_at_once_are_those_one_by_one(shape):
    """Several ratios share transforms, one alone does not."""
    pressure = np.random.default_rng(3).random(shape)
    solid = LoadedSolid(pressure, Grid(shape, (1.0, 1.3)), Layer(young=1.0, poisson=0.3))
    ratios, depths = [0.0, -0.3, 0.5], [0.0, 0.01, 0.2]
    for both in zip(
        stress_planes(solid, depths, ratios, FIELDS, tolerance=0),
        *(stress_planes(solid, depths, nu, FIELDS, tolerance=0) for nu in ratios),
        strict=True,
    ):
        for name, field in both[0].fields.items():
            alone = np.concatenate([plane.fields[name] for plane in both[1:]])
            np.testing.assert_allclose(field, alone, rtol=0, atol=1e-13, err_msg=name)


def test_same_bits_on_any_number_of_threads():
    contact = pressed((150, 140))
    for one, two in zip(
        *(stress_planes(contact, [0.0, 0.01, 0.1], [0.0, 0.4], FIELDS, threads=t) for t in (1, 2)),
        strict=True,
    ):
        for name in FIELDS:
            np.testing.assert_array_equal(one.fields[name], two.fields[name])


def test_progress_grows_to_its_total_and_a_stream_may_be_left():
    calls = []
    planes = stress_planes(
        pressed(), [0.0, 0.1, 0.2], fields=("zz",), progress=lambda *done: calls.append(done)
    )
    for _ in planes:
        pass
    assert len(calls) == 3
    assert [done / total for done, total in calls] == sorted(done / total for done, total in calls)
    assert calls[-1][0] == pytest.approx(calls[-1][1])
    left = stress_planes(pressed(), [0.0, 0.1, 0.2])
    next(left)
    left.close()


def test_stress_is_in_the_unit_of_the_pressure_whatever_the_modulus():
    soft, stiff = (pressed(layer=Layer(young=young, poisson=0.3)) for young in (1.0, 210e9))
    one, other = (next(stress_planes(c, [0.02])).fields["von_mises"] for c in (soft, stiff))
    np.testing.assert_allclose(one, other, rtol=1e-14)
    pascals = LoadedSolid(1e9 * soft.pressure, soft.grid, stiff.layer)
    scaled = next(stress_planes(pascals, [0.02])).fields["von_mises"]
    np.testing.assert_allclose(scaled, 1e9 * one, rtol=1e-12)  # rounding


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"depths": [0.1, 0.1]}, r"depths\[1\] = 0.1: more than depths\[0\] = 0.1 is needed"),
        ({"depths": [0.0, 1e308]}, r"depths\[1\] = 1e\+308: a depth from 0"),
        ({"depths": np.linspace(0, 1, 10**6)}, r"depths has the shape \(1000000,\): 1 to 10000"),
        ({"poisson": 0.6}, r"poisson = 0.6: a number > -1 and ≤ 0.5"),
        ({"poisson": [0.1, 0.1]}, "poisson = 0.1: given 2 times"),
        ({"poisson": np.linspace(0, 0.5, 10**6)}, ".*one number or a list of 1 to 1000"),
        ({"contact": pressed(layer=BONDED), "poisson": 0.3}, r"poisson = 0\.3: 0\.4, that of the contact"),
        (
            {"contact": pressed(layer=BONDED), "depths": [0.31]},
            r"depths\[0\] = 0\.31: a depth from 0 to 0\.3",
        ),
        ({"contact": np.ones((8, 8))}, "contact = array.*: an object with pressure, grid and layer"),
        ({"fields": ("von mises",)}, "fields = 'von mises': names from xx, yy"),
        ({"tolerance": 1.0}, "tolerance = 1.0: a number"),
        ({"threads": 10**9}, r"threads = 1000000000: a whole number from 1"),
    ],
)
def test_a_wrong_argument_is_named(changes, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        stress_planes(**({"contact": pressed(), "depths": [0.0]} | changes))


@pytest.mark.parametrize(
    ("pressure", "length", "message"),
    [
        (np.full((8, 8), 1e70), 1, r"pressure: its largest magnitude is 1e\+70; 0 or a value from 1e-60"),
        (np.full((8, 8), 1e-200), 1, "pressure: its largest magnitude is 1e-200"),
        (np.diag([np.nan, np.inf, *range(6)]), 1, "pressure: 2 of 64 nodes are not finite"),
        (np.ones((8, 9)), 1, r"pressure has the shape \(8, 9\): that of its grid, \(8, 8\)"),
        (np.ones((8, 8), complex), 1, "pressure = .*: real numbers"),
        (np.ones((8, 8)), 1e70, r"grid\.length = 1e\+70: an edge from"),
    ],
)
def test_a_load_without_a_finite_stress_is_refused(pressure, length, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        LoadedSolid(pressure, Grid((8, 8), length), HALF_SPACE)


@pytest.mark.parametrize("scale", [1e-58, 1e-12, 1e17, 1e59])
def test_stress_is_proportional_to_the_pressure_up_to_the_ends_of_its_range(scale):
    """Single precision would overflow, or round the small stresses to zero."""
    one, other = pressed(), pressed()
    other = LoadedSolid(scale * other.pressure, other.grid, other.layer)
    for plane, scaled in zip(
        stress_planes(one, [0.0, 0.02], fields=FIELDS, tolerance=1e-5),
        stress_planes(other, [0.0, 0.02], fields=FIELDS, tolerance=1e-3),
        strict=True,
    ):
        assert scaled.fields["zz"].dtype == np.float64
        if plane.grid == scaled.grid:
            largest = np.abs(plane.fields["zz"]).max()
            for name in FIELDS:
                np.testing.assert_allclose(
                    scaled.fields[name] / scale, plane.fields[name], rtol=0, atol=1e-13 * largest
                )


def test_no_pressure_has_no_stress():
    contact = LoadedSolid(np.zeros((32, 32)), Grid((32, 32)), HALF_SPACE)
    for plane in stress_planes(contact, [0.0, 0.1], fields=FIELDS):
        assert all(not field.any() for field in plane.fields.values())


@settings(max_examples=25, deadline=None)
@given(
    st.integers(8, 4096),
    st.floats(0.01, 10.0),
    st.floats(0.1, 2.0),
    st.floats(0.02, 0.5),
)
def test_depth_grid_covers_the_solid_with_the_spacing_promised(points, height, spacing, growth):
    grid = Grid((points, points))
    depths = depth_grid(grid, height, spacing, growth)
    steps = np.diff(depths)
    assert depths[0] == 0
    assert depths[-1] == height
    assert np.all(steps > 0)
    # The last step may take up half of another.
    assert np.all(steps <= 1.5 * np.maximum(spacing / points, growth * depths[:-1]) * (1 + 1e-12))


@pytest.mark.parametrize("name", ["spacing", "growth", "height"])
@pytest.mark.parametrize("value", [0.0, np.nan, "1"])
def test_depth_grid_refuses_what_is_not_positive(name, value):
    with pytest.raises((ValueError, TypeError), match=f"^{name} = {value!r}: a positive finite"):
        depth_grid(Grid((8, 8)), **{name: value})


def test_depth_grid_refuses_to_make_more_planes_than_are_accepted():
    with pytest.raises(ValueError, match=r"^spacing = 1e-05, growth = 1e-05: larger values are needed"):
        depth_grid(Grid((8, 8)), spacing=1e-5, growth=1e-5)
