"""Contact with a free boundary against closed forms, a direct solution, and other programs."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact import solve, solve_path, verify_contact
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.fourier.grid import Grid
from asperity.reference.hertz import Hertz
from asperity.reference.pivoting import pivot

HALF_SPACE = Layer(1.0, 0.0)


def rough(shape: tuple[int, int] = (96, 96), seed: int = 1) -> Array:
    return asp.self_affine(shape, 0.8, 0.5, 8 / min(shape), 1e-3, seed)


def load_of(height: Array, fraction: float = 0.05) -> float:
    return fraction * asp.roughness_parameters(height).rms_gradient


def order(points: list[int], errors: list[float]) -> float:
    """Order of convergence: minus the exponent of the number of points in the error."""
    return float(-np.polyfit(np.log(points), np.log(errors), 1)[0])


def centred(grid: Grid) -> tuple[Array, Array]:
    """Positions y, (ny, 1), and x, (nx,), from the middle of the map."""
    y, x = (axis - axis.mean() for axis in grid.coordinates())
    return y[:, None], x


def direct_kernel(grid: Grid) -> Array:
    """Displacement by one node of all others, on twice the nodes, by quadrature alone; E* = 1.

    A Gauss rule integrates 1/ρ over the rectangle of another node, and over a loaded node itself ∫∫ dA/ρ is
    the integral of its radius over the angle, from one corner to the next.
    """
    nodes, weights = np.polynomial.legendre.leggauss(60)
    (spacing_y, spacing_x), (ny, nx) = grid.spacing, (2 * n for n in grid.shape)
    eta, xi = 0.5 * spacing_y * nodes[:, None], 0.5 * spacing_x * nodes
    area = 0.25 * spacing_y * spacing_x * weights[:, None] * weights
    kernel = np.empty((ny, nx))
    for j in range(ny):
        for i in range(nx):
            y, x = min(j, ny - j) * spacing_y, min(i, nx - i) * spacing_x
            kernel[j, i] = np.sum(area / np.hypot(y - eta, x - xi)) if i or j else 0
    corner = np.arctan2(spacing_y, spacing_x)
    for half, span in ((0.5 * spacing_x, corner), (0.5 * spacing_y, np.pi / 2 - corner)):
        angle = 0.5 * span * (nodes + 1)
        kernel[0, 0] += 4 * np.sum(0.5 * span * weights * half / np.cos(angle))
    return kernel / np.pi


def direct_pressure(height: Array, grid: Grid, **imposed: float) -> Array:
    """Pressure by principal pivoting, on a padded map whose added nodes are far above the solid."""
    ny, nx = height.shape
    padded = np.full((2 * ny, 2 * nx), height.max() + 1e3 * np.ptp(height))
    padded[:ny, :nx] = height
    if "mean_pressure" in imposed:
        imposed["mean_pressure"] /= 4
    modes = np.fft.rfft2(direct_kernel(grid)).real
    return pivot(padded, modes, guess=padded < np.median(height), **imposed)[:ny, :nx]


def sphere_errors(points: int) -> tuple[float, ...]:
    """Errors of pressure, contact radius, largest pressure and approach, root mean squares over loads."""
    grid, errors = Grid((points, points)), []
    r = np.hypot(*centred(grid))
    for radius in np.linspace(0.3, 0.4, 6):
        exact = Hertz(contact_radius=radius, curvature_radius=2.0, effective_modulus=3.0)
        contact = solve(r**2 / 4, Layer(3.0, 0.0), force=exact.load, boundary="free", rtol=1e-8)
        pressure = exact.pressure(r)
        errors.append(
            (
                np.linalg.norm(contact.pressure - pressure) / np.linalg.norm(pressure),
                np.sqrt(contact.area_fraction / np.pi) / radius - 1,
                contact.max_pressure / exact.largest_pressure - 1,
                (contact.approach - contact.height.min()) / exact.approach - 1,
            )
        )
    return tuple(np.sqrt(np.mean(np.square(errors), axis=0)))


def test_hertz_without_images_converges_with_the_grid() -> None:
    """Grid error alone: the contact is as wide as 0.8 of the map."""
    points = [32, 64, 128]
    pressure, radius, largest, approach = np.array([sphere_errors(n) for n in points]).T
    assert order(points, pressure) > 0.9
    assert order(points, radius) > 0.7
    assert order(points, largest) > 1.5
    assert order(points, approach) > 1.0
    assert pressure[-1] < 6e-3
    assert radius[-1] < 6e-3
    assert largest[-1] < 3e-4
    # The lowest node is half a spacing from the axis on both axes.
    assert approach[-1] < 2e-4


def test_flat_square_punch() -> None:
    """Load F = π C E* a δ of a rigid square of edge a, with the capacitance C = 0.366787 of the unit square.

    C: C.-O. Hwang, M. Mascagni, J. Appl. Phys. 95 (2004) 3798, DOI 10.1063/1.1664031. The pressure is
    infinite at the edge, and the grid error is halved from grid to grid.
    """
    stiffness = []
    for points in (32, 64, 128):
        contact = solve(np.zeros((points, points)), HALF_SPACE, approach=1e-3, boundary="free")
        assert contact.area_fraction == 1
        stiffness.append(contact.force / 1e-3)
    exact = np.pi * 0.366787
    assert exact - stiffness[2] < 0.55 * (exact - stiffness[1]) < 0.55**2 * (exact - stiffness[0])
    assert 2 * stiffness[2] - stiffness[1] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("shape", "length"), [((16, 16), (1.0, 1.0)), ((12, 21), (0.5, 1.7))])
@pytest.mark.parametrize("fraction", [0.01, 0.1, 0.5])
def test_pressure_agrees_with_the_direct_solution(
    shape: tuple[int, int], length: tuple[float, float], fraction: float
) -> None:
    """Solver error; the kernel of the direct solution is integrated numerically."""
    height = 1e-2 * np.random.default_rng(7).standard_normal(shape)
    contact = solve(height, HALF_SPACE, length, mean_pressure=fraction * 0.1, boundary="free", rtol=1e-11)
    assert 1 < np.count_nonzero(contact.pressure) < height.size
    by_load = direct_pressure(height, contact.grid, mean_pressure=fraction * 0.1)
    np.testing.assert_allclose(contact.pressure, by_load, rtol=0, atol=1e-8 * by_load.max())
    by_approach = direct_pressure(height, contact.grid, approach=contact.approach)
    np.testing.assert_allclose(contact.pressure, by_approach, rtol=0, atol=1e-7 * by_load.max())


def test_controls_agree() -> None:
    """The tolerances are solver errors."""
    height, free = rough(), {"boundary": "free", "rtol": 1e-9}
    by_load = solve(height, HALF_SPACE, mean_pressure=load_of(height), **free)
    by_load.certificate.check(1e-7)
    scale = by_load.max_pressure
    for imposed in ({"approach": by_load.approach}, {"force": by_load.force}):
        contact = solve(height, HALF_SPACE, **imposed, **free)
        np.testing.assert_allclose(contact.pressure, by_load.pressure, rtol=0, atol=1e-6 * scale)
    by_area = solve(height, HALF_SPACE, area_fraction=by_load.area_fraction, **free)
    assert np.count_nonzero(by_area.pressure) == np.count_nonzero(by_load.pressure)
    assert by_area.mean_pressure == pytest.approx(by_load.mean_pressure, rel=0.02)


def test_mirrored_and_turned_maps_give_mirrored_and_turned_pressures() -> None:
    """Solver error."""
    height = rough((96, 96)) + np.linspace(0, 2e-3, 96)
    first = solve(height, HALF_SPACE, mean_pressure=load_of(height), boundary="free", rtol=1e-10)
    for turn in (np.flipud, np.fliplr, np.transpose, np.rot90):
        other = solve(
            np.ascontiguousarray(turn(height)),
            HALF_SPACE,
            mean_pressure=load_of(height),
            boundary="free",
            rtol=1e-10,
        )
        expected = turn(first.pressure)
        np.testing.assert_allclose(other.pressure, expected, rtol=0, atol=1e-8 * expected.max())


def test_nodes_added_around_the_map_change_nothing_out_of_contact() -> None:
    """The free boundary is not a wall: nodes that do not touch may as well be absent."""
    height = rough((64, 64))
    wide = np.full((90, 101), height.max() + 1)
    wide[11:75, 20:84] = height
    force = load_of(height)
    one = solve(height, HALF_SPACE, force=force, boundary="free", rtol=1e-10)
    length = (90 / 64, 101 / 64)
    other = solve(wide, HALF_SPACE, length, force=force, boundary="free", rtol=1e-10)
    np.testing.assert_allclose(
        other.pressure[11:75, 20:84], one.pressure, rtol=0, atol=1e-8 * one.max_pressure
    )
    assert other.approach == pytest.approx(one.approach, rel=1e-8)


@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
def test_true_error_is_below_the_tolerance(rtol: float) -> None:
    height = asp.self_affine((256, 256), 0.8, 1 / 8, 1 / 32, 1e-3, 1)
    truth = solve(height, HALF_SPACE, mean_pressure=load_of(height), boundary="free", rtol=1e-11).pressure
    contact = solve(height, HALF_SPACE, mean_pressure=load_of(height), boundary="free", rtol=rtol)
    assert np.linalg.norm(contact.pressure - truth) < rtol * np.linalg.norm(truth)


@pytest.mark.parametrize("hurst", [0.2, 0.8])
def test_a_free_boundary_takes_about_as_many_applications_as_a_periodic_one(hurst: float) -> None:
    """A pair of transforms of the padded map costs three of the map itself."""
    height = asp.self_affine((256, 256), hurst, 1 / 8, 1 / 32, 1e-3, 1)
    free, periodic = (
        solve(height, HALF_SPACE, mean_pressure=load_of(height), boundary=boundary).certificate.pairs
        for boundary in ("free", "periodic")
    )
    assert free / 3 < 1.4 * periodic


def test_slope_of_the_deformed_surface_is_that_of_the_indenter() -> None:
    """In contact the surface follows the parabola; grid error, away from the edge of contact."""
    grid = Grid((128, 96), (1.0, 0.75))
    y, x = centred(grid)
    r = np.hypot(y, x)
    contact = solve(r**2 / 2, HALF_SPACE, grid.length, approach=0.09, boundary="free", rtol=1e-9)
    # The mean square of r on a disc of radius a is a²/2.
    assert contact.gradient_rms_contact == pytest.approx(0.3 / np.sqrt(2), rel=0.03)


def test_paths_threads_and_single_precision() -> None:
    height = rough((150, 130))
    force = load_of(height)
    steps = list(solve_path(height, HALF_SPACE, forces=[0.5 * force, force], boundary="free", rtol=1e-8))
    single = solve(height, HALF_SPACE, force=force, boundary="free", rtol=1e-8)
    np.testing.assert_allclose(steps[1].pressure, single.pressure, rtol=0, atol=1e-6 * single.max_pressure)
    again = solve(height, HALF_SPACE, force=force, boundary="free", rtol=1e-8, threads=2)
    np.testing.assert_array_equal(again.pressure, single.pressure)
    short = solve(height, HALF_SPACE, force=force, boundary="free", dtype="float32", rtol=1e-4)
    assert short.pressure.dtype == np.float32
    assert np.linalg.norm(short.pressure - single.pressure) < 1e-3 * np.linalg.norm(single.pressure)


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (33, 47), (16, 200)])
def test_small_odd_and_oblong_maps(shape: tuple[int, int]) -> None:
    height = 1e-3 * np.random.default_rng(3).standard_normal(shape)
    for imposed in ({"mean_pressure": 1e-3}, {"approach": height.max() + 0.1}, {"area_fraction": 1.0}):
        contact = solve(height, HALF_SPACE, (0.7, 1.0), boundary="free", **imposed)
        contact.certificate.check(1e-4)
    assert contact.area_fraction == 1


def test_lift_off_and_first_contact() -> None:
    height = rough()
    apart = solve(height, HALF_SPACE, approach=height.min() - 1e-3, boundary="free")
    assert not apart.pressure.any()
    assert apart.gap.min() == pytest.approx(1e-3)
    assert solve(height, HALF_SPACE, force=0.0, boundary="free").approach == height.min()


def test_certificate_exposes_changed_pressures_and_the_wrong_boundary() -> None:
    height = rough()
    contact = solve(height, HALF_SPACE, force=load_of(height), boundary="free", rtol=1e-9)
    claim = {"approach": contact.approach, "mean_pressure": contact.mean_pressure}
    right = verify_contact(height, contact.pressure, HALF_SPACE, boundary="free", **claim)
    assert right.worst < 1e-6
    assert verify_contact(height, 1.001 * contact.pressure, HALF_SPACE, boundary="free", **claim).worst > 1e-4
    assert verify_contact(height, contact.pressure, HALF_SPACE, **claim).worst > 1e-2


@pytest.mark.parametrize(
    ("solid", "arguments", "message"),
    [
        (Layer(1.0, 0.3, 0.1), {}, r"^boundary = 'free': half-spaces are needed, because .* of height 0.1"),
        (asp.TwoBodies(HALF_SPACE, Layer(1.0, 0.3, 0.1)), {}, "half-spaces are needed"),
        (HALF_SPACE, {"method": "gfmd"}, r"^method = 'gfmd': active_set is needed for boundary = 'free'"),
        (HALF_SPACE, {"boundary": "open"}, r"^boundary = 'open': one of periodic, free is needed"),
    ],
)
def test_what_has_no_free_boundary_is_refused(solid: object, arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        solve(rough(), solid, mean_pressure=1e-3, **({"boundary": "free"} | arguments))
    assert "\n" not in str(caught.value)


def test_pressure_agrees_with_tamaas() -> None:
    tamaas = pytest.importorskip("tamaas")
    height = rough((128, 128), 2)
    load = load_of(height)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [128, 128])
    model.E, model.nu = 1.0, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    peer = tamaas.PolonskyKeerRey(model, -height, 1e-11)
    peer.setIntegralOperator("dcfft")
    peer.max_iter = 5000
    peer.solve(load)
    ours = solve(height, HALF_SPACE, mean_pressure=load, boundary="free", rtol=1e-11)
    np.testing.assert_allclose(ours.pressure, np.asarray(model.traction), atol=1e-8 * ours.max_pressure)


def test_pressure_agrees_with_contact_mechanics() -> None:
    peer = pytest.importorskip("ContactMechanics")
    topography = pytest.importorskip("SurfaceTopography").Topography
    height = rough((128, 128), 2)
    load = load_of(height)
    substrate = peer.FreeFFTElasticHalfSpace(height.shape, 1.0, (1.0, 1.0))
    surface = topography(-height, physical_sizes=(1.0, 1.0))
    found = peer.make_system(substrate=substrate, surface=surface).minimize_proxy(
        external_force=load, pentol=1e-13 * height.std(), forcetol=1e-14, thermotol=1e-12, maxiter=5000
    )
    ours = solve(height, HALF_SPACE, mean_pressure=load, boundary="free", rtol=1e-11)
    theirs = np.asarray(found.jac)[:128, :128] * height.size
    np.testing.assert_allclose(ours.pressure, theirs, atol=1e-8 * ours.max_pressure)
