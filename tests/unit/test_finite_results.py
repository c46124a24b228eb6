"""Every public function that computes numbers ends with the check that they are finite."""

import sys

import numpy as np
import pytest

import asperity as asp
from asperity import finite
from asperity.engineering import run
from asperity.engineering.case import Body
from asperity.engineering.indenter import MapSettings, read_indenter

GRID = asp.Grid((8, 8))
LAYER = asp.Layer(1.0, 0.3)
HEIGHT = 0.01 * np.random.default_rng(0).standard_normal((8, 8))
PRESSED = asp.PressedSolid(np.random.default_rng(0).random((8, 8)), GRID, LAYER)
SURFACE = asp.HeightMap(HEIGHT, (1.0, 1.0), True)


def own_run():
    height = asp.self_affine((16, 16), 0.8, 1e-4, 5e-5, rms_height=1e-7, seed=1, length=2e-4)
    surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m")
    return run(surface, Body(young=2e11, poisson=0.3), mean_pressure=5e7)


CALLS = {
    "add_cylinder": lambda: asp.add_cylinder(HEIGHT, 1.0, 1.0),
    "add_sphere": lambda: asp.add_sphere(HEIGHT, 1.0, 1.0),
    "analyse_stress": lambda: asp.analyse_stress(PRESSED, [0.0, 0.1, 0.2]),
    "autocorrelation": lambda: asp.autocorrelation(HEIGHT, GRID),
    "depth_grid": lambda: asp.depth_grid(GRID),
    "face_to_face": lambda: asp.face_to_face(SURFACE, SURFACE),
    "find_peaks": lambda: asp.find_peaks(planes(), "zz"),
    "johnson": lambda: asp.johnson(HEIGHT, 1.0, 1.0),
    "make_periodic": lambda: asp.make_periodic(SURFACE, "tilt", "mirrored"),
    "plane_peaks": lambda: asp.plane_peaks(HEIGHT, GRID),
    "pool_peaks": lambda: asp.pool_peaks([analysis()], [0.1], resamples=2),
    "probability_density": lambda: asp.probability_density(HEIGHT),
    "roughness_parameters": lambda: asp.roughness_parameters(HEIGHT),
    "self_affine": lambda: asp.self_affine((16, 16), 0.8, 0.5, 0.25, rms_height=1.0, seed=1),
    "solve": lambda: asp.solve(HEIGHT, LAYER, area_fraction=0.1),
    "solve_path": lambda: next(asp.solve_path(HEIGHT, LAYER, area_fractions=[0.1])),
    "spectrum": lambda: asp.spectrum(HEIGHT),
    "stress_box": lambda: asp.stress_box(PRESSED, [0.0]).dataset(),
    "stress_planes": lambda: next(asp.stress_planes(PRESSED, [0.0])),
    "stress_section": lambda: asp.stress_section(PRESSED, depths=[0.0]),
    "treat_map": lambda: asp.treat_map(SURFACE),
    "with_moments": lambda: asp.with_moments(HEIGHT, 0.0, 4.0),
    "run": own_run,
}
NOT_COMPUTING = {
    "fft_engine",
    "measure_wisdom",
    "peaks",  # selects from a dataset
    "prepare_map",  # reads a file for `treat_map`
    "read_map",
    "read_result",
    "write_result",
    "verify_contact",  # its violations of a pressure that is not one of contact may be infinite
}


def planes():
    return list(asp.stress_planes(PRESSED, [0.0, 0.1], fields=["zz"]))


def analysis():
    return asp.analyse_stress(PRESSED, [0.0, 0.1, 0.2])


def test_every_public_function_is_listed():
    functions = {name for name in asp.__all__ if name[0].islower() and not name.startswith("plot_")}
    assert functions | {"run"} == CALLS.keys() | NOT_COMPUTING


@pytest.mark.parametrize("function", CALLS)
def test_a_public_function_ends_with_the_check(function, monkeypatch):
    """If the check finds fault with its results alone, the function refuses to return them."""
    CALLS[function]()
    checked = {"make_periodic": "treat_map", "solve_path": "solve", "stress_section": "stress_box"}
    of = checked.get(function, function)
    genuine, asked = finite.require_finite, []

    def refuse(name, results, **options):
        asked.append(name)
        genuine(name, {key: np.full(1, np.inf) for key in results} if name == of else results, **options)

    for module in users_of_the_check():
        monkeypatch.setattr(module, "require_finite", refuse)
    with pytest.raises(ValueError, match=rf"^{of}: 1 of 1 values of .* are not finite"):
        CALLS[function]()
    assert of in asked


def users_of_the_check():
    """Modules that have imported the check."""
    return [
        module
        for name, module in sys.modules.items()
        if name.startswith("asperity.") and name != "asperity.finite" and hasattr(module, "require_finite")
    ]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_check_tells_a_large_number_from_an_infinite_one(dtype):
    values = np.full((4, 4), np.finfo(dtype).max, dtype)
    finite.require_finite("sum", {"huge": values, "number": 3, "text": "a", "none": values[:0]})
    values[1, 2] = np.inf
    with pytest.raises(ValueError, match=r"^sum: 1 of 16 values of huge are not finite"):
        finite.require_finite("sum", {"huge": values}, undefined=True)
    values[1, 2] = np.nan
    finite.require_finite("sum", {"huge": values}, undefined=True)
    with pytest.raises(ValueError, match="1 of 16"):
        finite.require_finite("sum", {"huge": values})


@pytest.mark.parametrize("friction", [1e20, 1e200, -0.1])
def test_a_friction_whose_stress_overflows_is_refused(friction):
    for call in (asp.stress_section, asp.analyse_stress):
        with pytest.raises(ValueError, match=r"^friction = .*: a number from 0 to 1000 is needed$"):
            call(PRESSED, friction=friction)


def test_a_form_on_a_mirrored_map_of_an_odd_number_of_points_is_refused():
    surface = asp.HeightMap(HEIGHT, (1.0, 1.0), unit="m", orientation="peaks up")
    with pytest.raises(ValueError, match=r"^radius = 1: even numbers of points are needed on a mirrored map"):
        read_indenter(surface, MapSettings(boundary="periodic", points=15, radius=1.0))
