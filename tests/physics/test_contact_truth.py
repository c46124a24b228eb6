"""Contact against closed forms, with the order of convergence on the grid, and against other programs."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact import gfmd, solve
from asperity.contact.compliance import response_on
from asperity.contact.problem import Control, Problem
from asperity.elasticity.layer import Layer
from asperity.fourier.grid import Grid
from asperity.reference.hertz import Hertz
from asperity.reference.westergaard import Westergaard

HALF_SPACE = Layer(1.0, 0.0)
AMPLITUDE = 1e-3


def order(points: list[int], errors: list[float]) -> float:
    """Order of convergence: minus the exponent of the number of points in the error."""
    return float(-np.polyfit(np.log(points), np.log(errors), 1)[0])


def wave_errors(points: int) -> tuple[float, float, float]:
    """Errors of pressure, area and approach, root mean squares over loads: the edge falls between nodes."""
    errors = []
    for part in np.linspace(0.2, 0.7, 6):
        exact = Westergaard(part * np.pi * AMPLITUDE, AMPLITUDE)
        grid = Grid((4, points), (4 / points, 1.0))
        x = grid.coordinates()[1] - 0.5
        height = np.tile(exact.height(x), (4, 1))
        contact = solve(height, HALF_SPACE, grid.length, mean_pressure=exact.mean_pressure, rtol=1e-8)
        pressure = exact.pressure(x)
        errors.append(
            (
                np.linalg.norm(contact.pressure[0] - pressure) / np.linalg.norm(pressure),
                contact.area_fraction / exact.area_fraction - 1,
                (contact.approach - exact.approach) / AMPLITUDE,
            )
        )
    pressure, area, approach = np.sqrt(np.mean(np.square(errors), axis=0))
    return float(pressure), float(area), float(approach)


def test_westergaard_partial_contact_converges_with_first_order() -> None:
    """Grid error: a pressure that ends like a square root converges with order 1 in the mean square."""
    points = [64, 128, 256]
    pressure, area, approach = np.array([wave_errors(n) for n in points]).T
    assert order(points, pressure) > 0.8
    assert order(points, area) > 0.7
    assert order(points, approach) > 1.5
    assert pressure[-1] < 1e-2
    assert approach[-1] < 3e-4


def test_westergaard_complete_contact_is_exact() -> None:
    """Rounding: the grid represents one Fourier mode exactly."""
    exact = Westergaard(1.2 * np.pi * AMPLITUDE, AMPLITUDE)
    grid = Grid((4, 64), (1 / 16, 1.0))
    x = grid.coordinates()[1] - 0.5
    contact = solve(
        np.tile(exact.height(x), (4, 1)),
        HALF_SPACE,
        grid.length,
        mean_pressure=exact.mean_pressure,
        rtol=1e-12,
    )
    np.testing.assert_allclose(contact.pressure[0], exact.pressure(x), rtol=1e-9)


def test_hertz_converges_with_first_order() -> None:
    """Grid error of the pressure; the periodic images change it by 1.9 (a/L)³, 2e-4 at these radii."""
    points, errors = [64, 128, 256], []
    for n in points:
        y, x = (axis - 0.5 for axis in Grid((n, n)).coordinates())
        r = np.hypot(y[:, None], x[None, :])
        squares = []
        for radius in np.linspace(0.045, 0.06, 6):
            exact = Hertz(contact_radius=radius, curvature_radius=1.0)
            contact = solve(r**2 / 2, HALF_SPACE, mean_pressure=exact.load, rtol=1e-8)
            pressure = exact.pressure(r)
            squares.append(np.sum((contact.pressure - pressure) ** 2) / np.sum(pressure**2))
        errors.append(float(np.sqrt(np.mean(squares))))
    assert order(points, errors) > 0.8
    assert errors[-1] < 0.02


def test_hertz_of_two_materials() -> None:
    """Grid error; the periodic images change the pressure by 1.9 (a/L)³, 2e-4."""
    steel, bronze = Layer(210e9, 0.3), Layer(110e9, 0.34)
    modulus = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.34**2) / 110e9)
    length, radius = 2e-3, 10e-3
    exact = Hertz(contact_radius=0.05 * length, curvature_radius=radius, effective_modulus=modulus)
    y, x = (axis - length / 2 for axis in Grid((256, 256), length).coordinates())
    r = np.hypot(y[:, None], x[None, :])
    contact = solve(r**2 / (2 * radius), asp.TwoBodies(steel, bronze), length, force=exact.load, rtol=1e-8)
    assert contact.force == pytest.approx(exact.load, rel=1e-7)
    assert contact.max_pressure == pytest.approx(exact.largest_pressure, rel=1e-3)
    error = np.linalg.norm(contact.pressure - exact.pressure(r)) / np.linalg.norm(exact.pressure(r))
    assert error < 0.02


def test_gfmd_steps_grow_as_the_square_root_of_the_points() -> None:
    """With the slowest mode near critical damping the steps grow as √N once the contact is resolved."""
    points = [64, 128, 256, 512]
    steps = []
    for n in points:
        x = Grid((n, n)).coordinates()[1] - 0.5
        height = (x[:, None] ** 2 + x[None, :] ** 2) / 2
        contact = solve(height, HALF_SPACE, mean_pressure=0.02, method="gfmd", dtype="float32", rtol=1e-3)
        steps.append(contact.certificate.iterations)
    assert -order(points, steps) < 0.6


def test_pressure_agrees_with_tamaas() -> None:
    tamaas = pytest.importorskip("tamaas")
    height = asp.self_affine((128, 128), 0.8, 0.25, 1 / 16, 1e-3, 2)
    load = 0.05 * asp.roughness_parameters(height).rms_gradient
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [128, 128])
    model.E, model.nu = 1.0, 0.0
    peer = tamaas.PolonskyKeerRey(model, -height, 1e-13)
    peer.max_iter = 5000
    peer.solve(load)
    ours = solve(height, HALF_SPACE, mean_pressure=load, rtol=1e-11)
    np.testing.assert_allclose(ours.pressure, np.asarray(model.traction), atol=1e-8 * ours.pressure.max())


def test_pressure_agrees_with_contact_mechanics() -> None:
    peer = pytest.importorskip("ContactMechanics")
    topography = pytest.importorskip("SurfaceTopography").Topography
    height = asp.self_affine((128, 128), 0.8, 0.25, 1 / 16, 1e-3, 2)
    load = 0.05 * asp.roughness_parameters(height).rms_gradient
    substrate = peer.PeriodicFFTElasticHalfSpace(height.shape, 1.0, (1.0, 1.0))
    surface = topography(-height, physical_sizes=(1.0, 1.0), periodic=True)
    found = peer.make_system(substrate=substrate, surface=surface).minimize_proxy(
        external_force=load, pentol=1e-13 * height.std(), forcetol=1e-14, thermotol=1e-12, maxiter=5000
    )
    ours = solve(height, HALF_SPACE, mean_pressure=load, rtol=1e-11)
    theirs = np.asarray(found.jac) * height.size
    np.testing.assert_allclose(ours.pressure, theirs, atol=1e-8 * ours.pressure.max())


def test_gfmd_relaxes_before_the_load_changes_again() -> None:
    """A load that changes before the slowest mode has followed takes five times the steps here."""
    height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    by_area = solve(height, HALF_SPACE, area_fraction=0.05, method="gfmd")
    by_load = solve(height, HALF_SPACE, mean_pressure=by_area.mean_pressure, method="gfmd")
    assert by_area.certificate.iterations < 3 * by_load.certificate.iterations


@pytest.mark.parametrize("fraction", [0.005, 0.05])
def test_gfmd_is_fastest_near_the_critical_damping_of_the_slowest_mode(fraction: float) -> None:
    """The surface takes longer to come to rest with much less and with much more damping."""
    height = asp.self_affine((64, 64), 0.8, 1 / 4, 1 / 8, 1e-3, 1)
    control = Control("mean_pressure", fraction * asp.roughness_parameters(height).rms_gradient)

    def steps(damping_fraction: float) -> int:
        problem = Problem(height, response_on("periodic", HALF_SPACE, Grid(height.shape)))
        return gfmd.solve(problem, control, 1e-6, None, None, damping_fraction).iterations

    critical = steps(gfmd.DAMPING_FRACTION)
    assert steps(0.3) > 1.5 * critical
    assert steps(2.0) > 1.5 * critical


ROUGH = {"hurst": 0.8, "wavelength_long": 1 / 4, "wavelength_short": 8 / 128, "rms_height": 1e-3}


def error_against_a_tight_tolerance(height: np.ndarray, layer: Layer, **arguments: object) -> float:
    """Relative error of the pressure, in units of the tolerance, against the same load at 1e-11."""
    contact = solve(height, layer, **arguments)  # type: ignore[arg-type]
    converged = solve(height, layer, mean_pressure=contact.mean_pressure, rtol=1e-11)
    difference = np.linalg.norm(contact.pressure - converged.pressure) / np.linalg.norm(converged.pressure)
    return float(difference) / contact.rtol


@pytest.mark.parametrize(("load", "rtol"), [(1e-7, 1e-6), (1e-3, 1e-4), (1e-3, 1e-6), (1e-1, 1e-6)])
def test_gfmd_reaches_its_tolerance_at_small_loads(load: float, rtol: float) -> None:
    # The load is in units of E* × rms gradient. The tolerance bounds the solver's error alone.
    height = asp.self_affine((128, 128), seed=1, **ROUGH)
    gradient = float(np.hypot(*np.gradient(height, 1 / 128)).std())
    error = error_against_a_tight_tolerance(
        height, Layer(1.0, 0.0), mean_pressure=load * gradient, method="gfmd", rtol=rtol
    )
    assert error < 1


@pytest.mark.parametrize("method", ["active_set", "gfmd"])
@pytest.mark.parametrize("area_fraction", [0.1, 0.97, 0.999, 0.9995])
def test_an_approach_near_full_contact_gives_the_load_of_its_area(area_fraction: float, method: str) -> None:
    # Ten open nodes are a thousand times stiffer than the rest; the bound is that of the solver's tolerance.
    height = asp.self_affine((128, 128), seed=1, **ROUGH)
    layer = Layer(1.0, 0.3)
    near = solve(height, layer, area_fraction=area_fraction)
    expected = solve(height, layer, mean_pressure=near.mean_pressure, rtol=1e-11)
    contact = solve(height, layer, approach=expected.approach, method=method)
    difference = np.linalg.norm(contact.pressure - expected.pressure) / np.linalg.norm(expected.pressure)
    assert difference < 1.5 * contact.rtol
    assert contact.certificate.iterations < 1000
