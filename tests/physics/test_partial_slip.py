"""Partial slip against Cattaneo and Mindlin, stress in closed form, and dense contacts by Coulomb's law."""

import numpy as np
import pytest
from samples import HALF_SPACE, LAYER, difference, hardened, refuses, rough
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import lsq_linear

import asperity as asp
from asperity.elasticity.loaded_solid import traction_direction
from asperity.elasticity.solid import COMPONENTS
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.reference.state_space import StateSpace

FRICTION, RADIUS = 0.4, 0.3
EQUAL = asp.TwoBodies(HALF_SPACE, HALF_SPACE)


def sphere(points, share, solid=HALF_SPACE, **settings):
    """A sphere whose contact radius is 0.3 of the edge of the map, under a share of its friction limit."""
    exact = Hertz(RADIUS, curvature_radius=20.0, effective_modulus=solid.effective_modulus)
    x = (np.arange(points) - points // 2) / points
    ball = (x[:, None] ** 2 + x**2) / (2 * exact.curvature_radius)
    contact = asp.solve_contact(ball, solid, force=exact.load, boundary="free", rtol=1e-9)
    settings = settings or {"tangential_force": share * FRICTION * exact.load}
    return asp.contact.partial_slip(contact, FRICTION, sliding_direction=30.0, **settings), exact


@pytest.mark.parametrize("share", [0.4, 0.6, 0.9])
def test_sphere_slips_as_cattaneo_and_mindlin_say(share):
    """K. L. Johnson, Contact Mechanics, sections 7.2 and 7.4; grid error at a/h = 29."""
    (slip, exact), left = sphere(96, share), 1 - share
    compliance = (2 - 0.3) * 2 * (1 + 0.3) / HALF_SPACE.young / RADIUS
    displacement = 3 / 16 * FRICTION * exact.load * compliance * (1 - left ** (2 / 3))
    lost = 0.9 * (FRICTION * exact.load) ** 2 * compliance
    lost *= 1 - left ** (5 / 3) - 5 / 6 * share * (1 + left ** (2 / 3))
    assert slip.sticking_area == pytest.approx(left ** (2 / 3), rel=0.03)
    assert slip.compliance_ratio == pytest.approx((2 - 0.3) / (2 - 0.6), rel=1e-6)  # Mindlin's
    assert slip.displacement == pytest.approx(displacement, rel=1e-3)
    assert slip.lost_energy == pytest.approx(lost, rel=0.02)
    assert slip.stiffness * slip.contact.grid.area == pytest.approx(
        8 / compliance * left ** (1 / 3), rel=0.01
    )
    assert slip.deviation < 1e-3
    again, _ = sphere(96, share, tangential_displacement=slip.displacement)
    assert again.tangential_force == pytest.approx(share * FRICTION * exact.load, rel=1e-6)  # solver


def test_cycle_encloses_the_energy_that_is_lost():
    """Area of the loop of many contacts against the integral of pressure times gap; chords err as 1/n²."""
    (slip, _), errors = sphere(48, 0.6), []
    for steps in (8, 16):
        loop = slip.cycle(steps)
        force, displacement = loop["tangential_force"].values, loop["tangential_displacement"].values
        errors.append(1 - abs(np.trapezoid(force, displacement)) / slip.lost_energy)
    assert force[0] == force[-1] == -force[steps]
    assert errors[0] == pytest.approx(4 * errors[1], rel=0.15)
    assert 0 < errors[1] < 5e-3


@pytest.mark.parametrize(("body", "tolerance"), [("lower", 1e-3), ("upper", 0)])
def test_stress_is_that_of_two_sliding_spheres(body, tolerance):
    """The traction is the difference of two ellipsoids (Hamilton and Goodman); discretisation error."""
    slip, exact = sphere(96, 0.5, EQUAL)
    solid, inner = slip.in_body(body), 0.5 ** (1 / 3)
    outer, stuck = (SlidingSphere(Hertz(a * RADIUS, a * RADIUS * 2 / np.pi), FRICTION) for a in (1, inner))
    settings = {"friction": FRICTION, "sliding_direction": traction_direction("x", body)}
    sign = 1 if body == "lower" else -1
    for plane in asp.stress_planes(solid, [0.06, 0.15, 0.3], None, COMPONENTS, tolerance, **settings):
        y, x = (axis - 0.5 for axis in plane.grid.coordinates())
        place = y[:, None], x[None, :], plane.depth, 0.3
        sheared = outer.traction_stress(*place) - inner * stuck.traction_stress(*place)
        expected = SlidingSphere(outer.contact, 0.0).stress(*place) + sign * sheared
        found = np.stack([plane.fields[name][0] for name in COMPONENTS], axis=-1) / exact.maximum_pressure
        assert np.abs(found - expected).max() < 4e-3


@pytest.mark.parametrize("solid", [HALF_SPACE, LAYER])
def test_stress_over_a_periodic_boundary_is_superposed(solid):
    """Stress of p in full sliding less that of p* and its shear; rounding, and the bound of coarse planes."""
    contact = asp.solve_contact(rough(), solid, mean_pressure=2e-3)
    slip = asp.contact.partial_slip(contact, FRICTION, tangential_force=0.5 * FRICTION * contact.force)
    settings = {"friction": FRICTION, "sliding_direction": 20.0}
    depths = [0.0, 0.01, 0.1]
    for tolerance, error in ((0, 1e-12), (1e-4, 1e-4)):
        found = asp.stress_planes(slip.in_body("lower"), depths, None, COMPONENTS, tolerance, **settings)
        parts = [
            asp.stress_planes(pressed, depths, None, COMPONENTS, 0, friction=friction, sliding_direction=20.0)
            for pressed, friction in ((contact, FRICTION), (slip.sticking, FRICTION), (slip.sticking, 0.0))
        ]
        for plane, both, stuck, normal in zip(found, *parts, strict=True):
            step = both.grid.shape[0] // plane.grid.shape[0]
            if both.grid.shape[0] % plane.grid.shape[0]:
                continue
            for name in COMPONENTS:
                expected = both.fields[name] - stuck.fields[name] + normal.fields[name]
                scale = np.sqrt(np.mean(both.fields["zz"] ** 2))
                within = np.abs(plane.fields[name] - expected[:, ::step, ::step]).max()
                assert within <= 2 * error * scale + 1e-12 * contact.maximum_pressure


def cerruti(y, x, step, poisson):
    """Displacement along x per unit traction on a square at the origin, E = 1, written with logarithms."""
    along = alike = 0.0
    for sign_y in (-1, 1):
        for sign_x in (-1, 1):
            dy, dx = y + sign_y * step / 2, x + sign_x * step / 2
            distance = np.sqrt(dy**2 + dx**2)
            along = along + sign_y * sign_x * dy * np.log(dx + distance)
            alike = alike + sign_y * sign_x * (dy * np.log(dx + distance) + dx * np.log(dy + distance))
    return (1 + poisson) / np.pi * ((1 - poisson) * alike + poisson * along)


@pytest.mark.parametrize(("poisson", "error"), [(0.0, 1e-5), (0.3, 0.06)])
def test_rough_contact_slips_as_a_dense_one(poisson, error):
    """Coulomb's law on all nodes as least squares with bounds; exact for ν = 0, else twice the deviation."""
    points, solid = 32, asp.Solid(1.0, poisson)
    contact = asp.solve_contact(
        rough((points, points)), solid, mean_pressure=5e-3, boundary="free", rtol=1e-10
    )
    slip = asp.contact.partial_slip(contact, FRICTION, tangential_force=0.6 * FRICTION * contact.force)
    row, column = np.nonzero(contact.pressure)
    y, x = row / points, column / points
    compliance = cerruti(y[:, None] - y, x[:, None] - x, 1 / points, poisson)
    factor, limit = cholesky(compliance, lower=True), FRICTION * contact.pressure[row, column]
    load = solve_triangular(factor, np.full(limit.size, slip.displacement), lower=True)
    dense = lsq_linear(factor.T, load, (-limit, limit), tol=1e-14).x
    assert 20 < (dense < 0.999 * limit).sum() < limit.size - 20
    assert difference(slip.traction[row, column], dense) < error
    assert abs(slip.traction.sum() / dense.sum() - 1) < error
    assert slip.deviation < error
    if poisson:
        assert slip.deviation > 1e-3


def test_limits_of_the_force():
    """All of it sticks at first, and all of it slips in the end."""
    contact = asp.solve_contact(rough(), HALF_SPACE, mean_pressure=2e-3)
    none = asp.contact.partial_slip(contact, FRICTION, tangential_force=0.0)
    assert (none.sticking_area, none.displacement, none.lost_energy) == (1.0, 0.0, 0.0)
    assert not none.traction.any()
    assert none.stiffness == none.initial_stiffness
    small = asp.contact.partial_slip(contact, FRICTION, tangential_force=1e-3 * FRICTION * contact.force)
    mean_traction = small.tangential_force / contact.grid.area
    assert mean_traction / small.displacement == pytest.approx(none.initial_stiffness, rel=2e-3)
    full = asp.contact.partial_slip(contact, FRICTION, tangential_force=FRICTION * contact.force)
    assert (full.sticking_area, full.stiffness) == (0.0, 0.0)
    np.testing.assert_array_equal(full.traction, FRICTION * contact.pressure)
    settings = {"friction": FRICTION, "fields": COMPONENTS}
    for one, other in zip(
        asp.stress_planes(full.in_body("lower"), [0.0, 0.1], **settings),
        asp.stress_planes(contact, [0.0, 0.1], **settings),
        strict=True,
    ):
        for name in COMPONENTS:
            np.testing.assert_allclose(one.fields[name], other.fields[name], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("poisson", "height"), [(0.3, None), (-0.5, None), (0.0, 0.1), (0.5, 0.02), (0.3, 3.0)]
)
def test_tangential_compliance_solves_equilibrium(poisson, height):
    """Against the state-space solution along and across a wave, and at q = 0 against long waves; rounding."""
    layer = asp.Solid(2.0, poisson, height)
    for q in (0.1, 1.0, 30.0):
        mode = StateSpace(q, 0.0, 2.0, poisson, height)
        expected = [mode.state(0, mode.solve(top))[n].real for n, top in enumerate(([1, 0, 0], [0, 1, 0]))]
        np.testing.assert_allclose(layer.tangential_compliance(q), np.array(expected, float), rtol=1e-13)
    if height:
        np.testing.assert_allclose(
            layer.tangential_compliance(1e-7), layer.tangential_compliance(0.0), rtol=1e-12
        )


def slipped(solid=HALF_SPACE, share=None, friction=FRICTION, **settings):
    contact = asp.solve_contact(rough((32, 32)), solid, mean_pressure=1e-3)
    if share is not None:
        settings["tangential_force"] = share * FRICTION * contact.force
    return asp.contact.partial_slip(contact, friction, **settings)


SLIPPERY, DISPLACED = asp.Solid(1.0, 0.3, 0.2, "frictionless"), {"tangential_displacement": 1e-5}
test_bad_arguments = refuses(
    (lambda: slipped(share=0.5, friction=0.0), "friction = 0"),
    (lambda: slipped(share=1.1), "tangential_force = 0.00044"),
    (lambda: slipped(tangential_force=-1e-5), "tangential_force = -1e-05"),
    (lambda: slipped(tangential_displacement=1.0), "tangential_displacement = 1: at mo"),
    (lambda: slipped(), "exactly one of tangential_force and tangential_displacem"),
    (lambda: asp.contact.partial_slip(rough(), FRICTION, tangential_force=0.0), "contact = "),
    (lambda: asp.contact.partial_slip(hardened(rough(), 0.5), FRICTION, tangential_force=0.0), "hardness = "),
    (lambda: slipped(share=0.0, sliding_direction="z"), "sliding_direction ="),
    (lambda: slipped(LAYER, **DISPLACED), "tangential_displacement = 1e-05: half-spaces"),
    (lambda: slipped(SLIPPERY, share=0.0), "bottom = 'frictionless'"),
)
