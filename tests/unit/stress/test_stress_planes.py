"""`stress_planes`: components, coarse planes and their bound, ratios, precision, refused arguments."""

from dataclasses import replace

import numpy as np
import pytest
from samples import HALF_SPACE, refuses, spots

import asperity as asp
from asperity.elasticity.solid import COMPONENTS
from asperity.fourier.grid import Fourier, resample
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.planes import depth_grid, stress_planes

BONDED = asp.Solid(young=1.0, poisson=0.4, height=0.3)
FRICTIONLESS = asp.Solid(young=1.0, poisson=0.2, height=0.3, bottom="frictionless")


def both(contact, depths, one, other, **settings):
    """Pairs of planes with two sets of settings."""
    return zip(*(stress_planes(contact, depths, **settings, **each) for each in (one, other)), strict=True)


@pytest.mark.engines
@pytest.mark.parametrize("layer", [HALF_SPACE, replace(HALF_SPACE, lateral="free"), BONDED, FRICTIONLESS])
@pytest.mark.parametrize("shape", [(32, 30), (33, 35)])
def test_components_are_those_of_the_layers_modes(layer, shape):
    """Of a half-space for another ratio than the contact's."""
    contact = spots(shape, (0.7, 1.1), layer)
    layer = layer if layer.height else replace(layer, poisson=0.45)
    grid, fourier = contact.grid, Fourier(contact.grid)
    modes = fourier.forward(contact.pressure)
    for plane in stress_planes(contact, [0.0, 0.01, 0.2], layer.poisson, COMPONENTS, tolerance=0):
        stress = layer.stress(grid.qx[None, :], grid.qy[:, None], plane.depth) * modes[..., None]
        stress[..., [4, 5]] *= (2 * grid.kx != grid.shape[1])[:, None]
        stress[..., [3, 5]] *= (2 * grid.ky != grid.shape[0])[:, None, None]
        stress[0, 0] = layer.uniform_stress() * modes[0, 0]
        for number, name in enumerate(COMPONENTS):
            expected = fourier.inverse(stress[..., number])
            np.testing.assert_allclose(plane.fields[name][0], expected, rtol=0, atol=1e-13)  # rounding


@pytest.mark.parametrize(
    ("layer", "friction"),
    [(HALF_SPACE, 0), (HALF_SPACE, 2.0), (asp.Solid(1.0, -0.95), 0.3), (BONDED, 0), (FRICTIONLESS, 0)],
)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_coarse_planes_agree_within_the_tolerance(layer, friction, tolerance):
    """The trigonometric interpolant of a coarse plane, at every node of the full grid."""
    contact = spots((144, 144), layer=layer)
    fourier, sizes = Fourier(contact.grid), []
    depths = np.array([0.0, 0.01, 0.03, 0.08, 0.2, 0.3])
    settings = {"fields": FIELDS, "friction": friction, "sliding_direction": 20.0}
    for plane, full in both(contact, depths, {"tolerance": tolerance}, {"tolerance": 0}, **settings):
        sizes.append(plane.grid.size)
        allowed = tolerance * np.sqrt(np.mean(full.fields["zz"] ** 2)) + 1e-13
        assert plane.bound <= allowed
        for name in COMPONENTS:
            modes = resample(Fourier(plane.grid).forward(plane.fields[name][0]), plane.grid, contact.grid)
            fine = fourier.inverse(modes) if plane.grid != contact.grid else plane.fields[name][0]
            assert np.abs(fine - full.fields[name][0]).max() <= allowed
    assert sizes[-1] < sizes[0] / 10


@pytest.mark.parametrize("layer", [HALF_SPACE, BONDED])
def test_single_precision_only_above_its_rounding(layer):
    contact, depths = spots(layer=layer), [0.0, 0.01, 0.2]
    for single, double in both(contact, depths, {"tolerance": 1e-4}, {"tolerance": 1e-5}, fields=FIELDS):
        for name in FIELDS:
            assert (single.fields[name].dtype, double.fields[name].dtype) == (np.float32, np.float64)
            if single.grid == double.grid:
                error = np.abs(single.fields[name] - double.fields[name]).max()
                assert error < 5e-6 * np.abs(double.fields["zz"]).max()  # rounding


@pytest.mark.engines
@pytest.mark.parametrize(("shape", "lateral"), [((16, 24), "confined"), ((15, 21), "free")])
def test_ratios_at_once_are_those_one_by_one(shape, lateral):
    """Several ratios share transforms, one alone does not."""
    solid = spots(shape, (1.0, 1.3), replace(HALF_SPACE, lateral=lateral))
    ratios, depths = [0.0, -0.3, 0.5], [0.0, 0.01, 0.2]
    together, *alone = (stress_planes(solid, depths, nu, FIELDS, tolerance=0) for nu in (ratios, *ratios))
    for plane, *others in zip(together, *alone, strict=True):
        for name, field in plane.fields.items():
            expected = np.concatenate([other.fields[name] for other in others])
            np.testing.assert_allclose(field, expected, rtol=0, atol=1e-13, err_msg=name)


def test_progress_grows_and_a_stream_may_be_left():
    calls = []
    planes = stress_planes(spots(), [0.0, 0.1, 0.2], fields=("zz",), progress=lambda *now: calls.append(now))
    for _ in planes:
        pass
    shares = [done / total for done, total in calls]
    assert len(calls) == 3
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1)
    left = stress_planes(spots(), [0.0, 0.1, 0.2])
    next(left)
    left.close()


@pytest.mark.parametrize("scale", [1e-58, 1e-12, 1e17, 1e59])
def test_stress_is_proportional_to_the_pressure(scale):
    """Whatever the modulus; single precision would overflow, or round the small stresses to zero."""
    one = spots()
    other = asp.LoadedSolid(scale * one.pressure, one.grid, asp.Solid(210e9, 0.3))
    planes = stress_planes(one, [0.0, 0.02], fields=FIELDS, tolerance=1e-5)
    others = stress_planes(other, [0.0, 0.02], fields=FIELDS, tolerance=1e-3)
    for plane, scaled in zip(planes, others, strict=True):
        assert scaled.fields["zz"].dtype == np.float64
        largest = np.abs(plane.fields["zz"]).max()
        for name in FIELDS if plane.grid == scaled.grid else ():
            found = scaled.fields[name] / scale
            np.testing.assert_allclose(found, plane.fields[name], rtol=0, atol=1e-13 * largest)


EIGHT = np.ones((8, 8))
SLIDING = asp.Solid(1.0, 0.3, 0.5, "frictionless")


def planes(contact=None, depths=(0.0,), **settings):
    return stress_planes(spots((8, 8)) if contact is None else contact, depths, **settings)


def loaded(pressure=EIGHT, length=1.0, layer=HALF_SPACE, boundary="periodic"):
    return asp.LoadedSolid(pressure, asp.Grid((8, 8), length), layer, boundary)


def grid_of_depths(**settings):
    return depth_grid(asp.Grid((8, 8)), **settings)


test_wrong_argument_is_refused = refuses(
    (lambda: planes(depths=[0.1, 0.1]), r"depths\[1\] = 0.1: more than depths\[0\] = 0.1 is needed"),
    (lambda: planes(depths=np.linspace(0, 1, 10**6)), r"depths has the shape \(1000000,\): 1 to 10000"),
    (lambda: planes(poisson=[0.1, 0.1]), "poisson = 0.1: given 2 times"),
    (lambda: planes(spots(layer=BONDED), poisson=0.3), r"poisson = 0\.3: 0\.4, as in the contact"),
    (lambda: planes(spots(layer=BONDED), [0.31]), r"depths\[0\] = 0\.31: a depth from 0 to 0\.3"),
    (lambda: planes(EIGHT), "contact = array.*: an object with pressure, grid and layer"),
    (lambda: planes(fields=("von mises",)), "fields = 'von mises': names from xx, yy"),
    (lambda: planes(friction=-0.1), r"friction = -0\.1: a number from 0 to 1000 is needed"),
    (lambda: planes(friction=1, sliding_direction="z"), 'sliding_direction = \'z\': "x", "y" or an'),
    (lambda: planes(loaded(layer=SLIDING), friction=0.2), r"friction = 0\.2: 0 is needed in a layer"),
    (lambda: loaded(1e70 * EIGHT), r"pressure: its largest magnitude is 1e\+70; 0 or a value from 1e-60"),
    (lambda: loaded(np.diag([np.nan, np.inf, *range(6)])), "pressure: 2 of 64 nodes are not finite"),
    (lambda: loaded(np.ones((8, 9))), r"pressure has the shape \(8, 9\): \(8, 8\), as of its grid"),
    (lambda: loaded(length=1e70), r"grid\.length = 1e\+70: an edge from"),
    (lambda: loaded(layer=SLIDING, boundary="free"), "boundary = 'free': a half-space is needed"),
    (lambda: grid_of_depths(spacing=0.0), "spacing = 0.0: a positive finite"),
    (lambda: grid_of_depths(spacing=1e-5, growth=1e-5), "spacing = 1e-05, growth = 1e-05: larger values"),
)
