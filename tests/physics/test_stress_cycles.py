"""Cycles of the stress: smallest spheres, fatigue limits, and shakedown of Hertz's contacts."""

from functools import partial

import numpy as np
import pytest
from samples import refuses
from scipy.optimize import minimize, nnls

import asperity as asp
from asperity.reference.hertz import LineHertz
from asperity.stress.cycles.criteria import LARGEST_FACTOR, Criteria, hydrostatic_factor, reduce_rows
from asperity.stress.cycles.smallest_sphere import smallest_sphere
from asperity.stress.cycles.stress_cycles import Cycles

EDGE, NODES = 1.0, 1024


def sphere(points, free=5):
    centre = np.empty(5)
    return smallest_sphere(np.array(np.transpose(points), dtype=float, order="C"), free, centre), centre


def reduced(states, alpha=0.0):
    """Range, Dang Van and squared radii of one path of stresses (6, n): xx, yy, zz, yz, xz, xy."""
    out = np.empty((5, 1))
    reduce_rows(np.asarray(states, float)[:, None, :], False, True, True, alpha, out)
    return out[:, 0]


def test_sphere_around_a_simplex_and_an_arc():
    radius, centre = sphere(np.eye(5) * 2 + 3)
    assert radius == pytest.approx(4 * 4 / 5, rel=1e-13)  # circumradius² of a regular simplex, edge 2√2
    np.testing.assert_allclose(centre, 3.4, rtol=1e-13)
    angle = np.linspace(0, 2 * np.pi, 101)
    circle = np.outer(np.cos(angle), [1, 0, 0, 0, 0]) + np.outer(np.sin(angle), [0, 0.6, 0, 0, 0.8]) + 0.5
    assert sphere(circle)[0] == pytest.approx(1.0, abs=1e-3)  # the nodes miss both ends of most diameters
    short = circle[:26]  # a quarter: the chord is the diameter
    assert sphere(short)[0] == pytest.approx(0.5, rel=1e-12)
    assert sphere(np.full((9, 5), 2.0))[0] == 0


@pytest.mark.parametrize("free", [1, 3, 5])
@pytest.mark.parametrize("kind", ["scattered", "ties", "plane"])
def test_centre_lies_among_the_farthest_points(free, kind):
    """The condition of Karush, Kuhn and Tucker; it is sufficient, as the problem is convex."""
    points = np.random.default_rng(free).normal(size=(300, 5))
    if kind == "ties":
        points = np.round(points)
    if kind == "plane":
        points[:, 2:] = 0
    radius, centre = sphere(points, free)
    distance = ((points - centre) ** 2).sum(axis=1)
    assert distance.max() == pytest.approx(radius, rel=1e-12)
    assert not centre[free:].any()
    far = points[distance > radius * (1 - 1e-10), :free]
    rest = nnls(np.vstack([far.T, np.ones(len(far))]), np.append(centre[:free], 1.0))[1]
    assert rest < 1e-9


@pytest.mark.parametrize("ratio", [0.5, 0.577, 0.7, 1.0])
def test_reversed_torsion_and_bending_reach_their_limits(ratio):
    phase = np.sin(np.linspace(0, 2 * np.pi, 101))
    torsion, bending = np.zeros((2, 6, phase.size))
    torsion[5], bending[0] = ratio * phase, phase
    alpha = hydrostatic_factor(ratio, 1.0)
    assert reduced(torsion, alpha)[1] == pytest.approx(ratio, rel=1e-12)
    assert reduced(bending, alpha)[1] == pytest.approx(ratio, rel=1e-12)
    # A mean shear stress changes nothing, a mean tension does.
    torsion[4] += 5
    assert reduced(torsion, alpha)[1] == pytest.approx(ratio, rel=1e-12)
    bending[0] += 1
    assert reduced(bending, alpha)[1] == pytest.approx(ratio + alpha / 3, rel=1e-12)


def rough(points, boundary="periodic"):
    height = asp.self_affine((points, points), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    return asp.solve_contact(height, asp.Solid(1.0, 0.3), contact_area_fraction=0.1, boundary=boundary)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_agreement_with_brute_force(boundary):
    """SLSQP for the spheres, eigenvalues for the Tresca stress, on planes of `stress_planes`."""
    contact, depth = rough(32, boundary), 0.02
    limits = {"fatigue_torsion": 0.6, "fatigue_bending": 1.0, "yield_stress": 0.1}
    cycles = asp.stress.stress_cycles(contact, [depth], **limits, friction=0.2, tolerance=0)
    names = ("xx", "yy", "zz", "yz", "xz", "xy")
    (plane,) = asp.stress_planes(contact, [depth], fields=names, friction=0.2, tolerance=0)
    states = np.stack([plane.fields[name][0] for name in names])
    if boundary == "free":
        states = np.concatenate([states, np.zeros((6, 32, 1))], axis=2)
    for row in range(0, 32, 8):
        xx, yy, zz, yz, xz, xy = states[:, row]
        tensor = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), 2, 0)
        mean = np.trace(tensor, axis1=1, axis2=2) / 3
        deviator = tensor - mean[:, None, None] * np.eye(3)
        for name, parts in {"upper": 5, "line": 3, "lower": 1}.items():
            # Residual stresses by components, in place of coordinates of the deviator.
            basis = np.zeros((5, 3, 3))
            for n, (i, j) in enumerate([(0, 0), (1, 1), (0, 1), (0, 2), (1, 2)]):
                basis[n, i, j] = basis[n, j, i] = 1
            basis -= np.trace(basis, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
            size = np.abs(deviator).max()

            def squared(c, basis=basis[:parts], size=size, deviator=deviator):
                rest = deviator / size - np.tensordot(c, basis, 1)
                return 1.5 * (rest**2).sum(axis=(1, 2))

            start = np.append(np.zeros(parts), squared(np.zeros(parts)).max())
            bound = {"type": "ineq", "fun": lambda v: v[-1] - squared(v[:-1])}
            options = {"ftol": 1e-14, "maxiter": 500}
            found = minimize(lambda v: v[-1], start, constraints=bound, method="SLSQP", options=options)
            factor = 0.1 / (size * np.sqrt(found.x[-1]))
            assert float(cycles[f"shakedown_{name}"][0, row]) == pytest.approx(factor, rel=1e-5)
            if parts == 5:
                rest = deviator - size * np.tensordot(found.x[:-1], basis, 1)
                value = np.linalg.eigvalsh(rest)
                stress = (value[:, 2] - value[:, 0]) / 2 + hydrostatic_factor(0.6, 1.0) * mean
                assert float(cycles["dang_van"][0, row]) == pytest.approx(stress.max() / 0.6, rel=1e-3)
        assert float(cycles["shear_range"][0, row]) == pytest.approx(np.ptp(xz), rel=1e-12)


@pytest.fixture(scope="module")
def line():
    """A cylinder along y, 102 nodes wide: the largest pressure and the half-width of the contact."""
    length = (EDGE / 64, EDGE)
    height = asp.surface.add_cylinder(np.zeros((16, NODES)), length, 1.0, axis="y")
    contact = asp.solve_contact(height, asp.Solid(1.0, 0.3), length, contact_area_fraction=0.1)
    return contact, float(contact.pressure.max()), 0.05


def test_line_contact_without_friction(line):
    """Johnson (1985), sections 4.2 and 9.3: τ_xz = ±p₀/4 at the depth b/2, shakedown at 4 k.

    The neighbours of the cell change the stress by (b/L)² = 0.25 %, the depth is the depth of a plane.
    """
    contact, largest, half = line
    depths = half * np.linspace(0.4, 0.6, 21)
    cycles = asp.stress.stress_cycles(contact, depths, yield_stress=np.sqrt(3))
    value, depth, _ = cycles.attrs["worst_shear_range"]
    assert value / largest == pytest.approx(0.5, rel=3e-3)
    assert depth / half == pytest.approx(0.5, abs=0.02)
    for name in ("shakedown_upper", "shakedown_line"):
        assert cycles.attrs[f"worst_{name}"][0] * largest == pytest.approx(4.0, rel=5e-3)
    assert cycles.attrs["worst_shakedown_lower"][0] * largest < 4.0


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.3])
def test_line_contact_with_friction(line, friction):
    """Factors against McEwen's closed form in the same depths; images change 0.25 %."""
    contact, largest, half = line
    depths = half * np.linspace(0.2, 0.6, 9)
    cycles = asp.stress.stress_cycles(contact, depths, yield_stress=np.sqrt(3), friction=friction)
    x = np.linspace(-10, 10, 4001)
    exact = LineHertz(1.0, 1.0)
    radii = [reduced(exact.stress(x, depth / half, 0.3, (friction, 0.0)).T)[2:4] for depth in depths]
    exact = np.sqrt(2 / np.array(radii)).min(axis=0)
    for name, value in zip(("upper", "line"), exact, strict=True):
        assert cycles.attrs[f"worst_shakedown_{name}"][0] * largest == pytest.approx(value, rel=1e-2)


def test_point_contact():
    """Johnson (1985), section 9.4: shakedown near 4.68 k; first yield at 2.8 k by von Mises."""
    nodes, radius = 256, 1.0
    height = asp.surface.add_sphere(np.zeros((nodes, nodes)), EDGE, radius)
    contact = asp.solve_contact(
        height, asp.Solid(1.0, 0.3), EDGE, boundary="free", contact_area_fraction=0.02
    )
    largest, half = float(contact.pressure.max()), np.sqrt(0.02 / np.pi)
    depths = half * np.linspace(0.2, 0.7, 21)
    cycles = asp.stress.stress_cycles(contact, depths, yield_stress=np.sqrt(3), tolerance=1e-4)
    upper = cycles.attrs["worst_shakedown_upper"][0] * largest
    assert upper == pytest.approx(4.68, rel=2e-2)  # 20 nodes across the radius
    assert 2.8 < cycles.attrs["worst_shakedown_lower"][0] * largest <= upper


def test_cycles_of_the_stream_of_the_analysis():
    contact, depths = rough(64), asp.stress.depth_grid(rough(64).grid)[:20]
    limits = (0.3, 0.48, 0.1)
    watch = Cycles(asp.LoadedSolid.of(contact), Criteria(*limits), "x", 0.3)
    asp.analyse_stress(contact, depths, observe=watch.add, tolerance=1e-6)
    names = dict(zip(("fatigue_torsion", "fatigue_bending", "yield_stress"), limits, strict=True))
    alone = asp.stress.stress_cycles(contact, depths, **names, threads=2)
    for name, field in watch.dataset().items():
        np.testing.assert_allclose(field, alone[name], rtol=1e-6, err_msg=name)
        assert field.shape == {"fatigue_volume": (461,), "fatigue_mean": (33,)}.get(name, (20, 64))
    coarse = asp.stress.stress_cycles(contact, depths, **names, tolerance=1e-4)
    assert coarse.attrs["worst_dang_van"][0] == pytest.approx(alone.attrs["worst_dang_van"][0], rel=1e-3)


def test_motion_is_along_x():
    """Twice reversed, as the traction on an upper body is, it is the same."""
    once, twice = (
        asp.stress.stress_cycles(rough(32), [0.01], friction=0.3, sliding_direction=angle)["shear_range"]
        for angle in ("x", 360.0)
    )
    np.testing.assert_allclose(once, twice, rtol=1e-12)


test_wrong_argument_is_refused = refuses(
    (lambda: hydrostatic_factor(1.0, None), "fatigue_bending: missing"),
    (lambda: hydrostatic_factor(None, 1.0), "fatigue_torsion: missing"),
    (lambda: hydrostatic_factor(0.49, 1.0), "fatigue_torsion: 0.5 to 1 times fatigue_bending .* 0.49 times"),
    (lambda: hydrostatic_factor(1.01, 1.0), "fatigue_torsion: .* got 1.01 times"),
    (
        lambda: asp.stress.stress_cycles(rough(32), sliding_direction=30),
        "sliding_direction = 30: x, y or a mul",
    ),
)


def test_cycles_of_a_plastic_contact():
    height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    solve = partial(asp.solve_contact, height, asp.Solid(1.0, 0.3), mean_pressure=2e-3)
    contacts = (solve(hardness=hardness) for hardness in (None, 0.02))
    elastic, plastic = (asp.stress.stress_cycles(each).attrs["worst_shear_range"][0] for each in contacts)
    assert plastic < elastic


def test_constant_stress_shakes_down_under_any_load():
    """In Pa, where a yield stress over the change of the stress overflows."""
    pressed = asp.LoadedSolid(np.full((8, 8), 1e9), asp.Grid((8, 8)), asp.Solid(210e9, 0.3))
    cycles = asp.stress.stress_cycles(pressed, [0.1], yield_stress=1e9)
    assert (cycles["shakedown_upper"] == LARGEST_FACTOR).all()
