"""The measurement of speed and accuracy, on a very small scene."""

import numpy as np
import pytest
import xarray as xr

from asperity.paper.figures import tradeoff as figures
from asperity.results import dataset
from asperity.results.tables import check_columns
from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import DISTRIBUTIONS, NUMBERS, OUTPUTS, as_json, from_json
from asperity.study.cost.measurement import (
    difference,
    evaluate,
    measure,
    output_errors,
    reduce_runs,
    runs_at,
    settings_of,
)
from asperity.study.cost.model import law_seconds
from asperity.study.cost.plan import error_bounds
from asperity.study.cost.scene import Scene
from asperity.study.cost.tables import errors_for_reader, errors_frame, presets_for_reader, presets_frame
from asperity.views.style import style

SETTINGS = {
    "hurst": [0.8],
    "area_fractions": [0.1],
    "seeds": [1],
    "wavelength_long": 0.5,
    "wavelength_short": 0.125,
    "points_per_wavelength": [4, 8, 12],
    "sizes": [64, 128],
}


@pytest.fixture(scope="module")
def runs():
    return measure(**SETTINGS)


def error(runs, parameter, setting, output):
    """Largest magnitude of the error of an output at one setting."""
    return float(np.abs(runs_at(runs, parameter, setting)["output_error"].sel(output=output)).max())


def test_a_run_has_no_error_against_itself():
    evaluation = evaluate(Scene(0.8, 1 / 2, 1 / 4, 0.1), PRESETS["paper"])
    assert set(output_errors(evaluation, evaluation).values()) == {0.0}


def test_a_difference_is_relative_to_the_second():
    quantiles = np.linspace(1.0, 3.0, 110)
    assert difference(1.1 * quantiles, quantiles) == pytest.approx(0.1)
    assert difference(1.1, 1.0) == pytest.approx(0.1)
    assert difference(0.8, 1.0) == pytest.approx(-0.2)


def test_surfaces_of_one_kind_scatter_about_their_mean(runs):
    errors = runs_at(runs, "seeds", "1")["output_error"]
    mean = errors.mean("run")
    assert float(abs(mean.sel(output=list(NUMBERS))).max()) < 1e-12
    assert abs(float(mean.sel(output="area_fraction"))) < 0.05  # of an inverse, not of the load itself


def test_the_largest_error_of_all_scenes_is_kept(runs):
    worse = xr.concat([runs, runs.assign(output_error=2 * runs["output_error"])], "run")
    one, two = (reduce_runs(each).errors["0.1"]["precision"]["float32"] for each in (runs, worse))
    assert two["peak_depth"] == pytest.approx(2 * one["peak_depth"], rel=1e-2)


def test_the_area_is_that_at_the_load_of_the_reference():
    """A tenth more load makes nearly a tenth more area."""
    scene = Scene(0.8, 1 / 2, 1 / 8, 0.1)
    first = evaluate(scene, PRESETS["paper"])
    more = 1.1 * first.mean_pressure
    again = evaluate(scene, PRESETS["paper"], mean_pressure=more)
    assert again.area_fraction / first.area_fraction == pytest.approx(1.09, abs=0.02)
    assert again.statistics.identical(first.statistics)


def test_parameters_of_the_planes_do_not_change_the_contact(runs):
    for parameter, setting in (("depth_spacing", "2.0"), ("depth_tolerance", "0.1")):
        for output in ("area_fraction", "proportionality", "pressure_p99", "pressure_distribution"):
            assert error(runs, parameter, setting, output) == 0.0


def test_errors_fall_with_finer_settings(runs):
    for output in ("pressure_p90", "von_mises_distribution"):
        assert error(runs, "points_per_wavelength", "4", output) > error(
            runs, "points_per_wavelength", "8", output
        )
    assert error(runs, "depth_spacing", "4.0", "von_mises_p90") > error(
        runs, "depth_spacing", "0.25", "von_mises_p90"
    )
    assert error(runs, "contact_tolerance", "1e-06", "proportionality") < 1e-5


def test_the_error_of_the_half_space_falls_with_the_height_of_the_layer(runs):
    bounds = settings_of(runs, "half_space_tolerance")
    assert [float(bound) for bound in bounds] == sorted(map(float, bounds), reverse=True)
    errors = [error(runs, "half_space_tolerance", bound, "von_mises_p90") for bound in bounds]
    assert errors[-1] < 0.1 * errors[0]


def test_the_measurement_is_a_file_and_comes_back_from_text(runs, tmp_path):
    dataset.write(runs, tmp_path / "runs.nc", title="runs", settings={"tradeoff": SETTINGS})
    assert dataset.read(tmp_path / "runs.nc").sizes == runs.sizes
    measured = reduce_runs(runs)
    assert as_json(from_json(as_json(measured))) == as_json(measured)
    assert set(measured.presets) == {"draft", "paper"}  # the finest grid is coarser than the third needs
    presets, errors = presets_frame(measured), errors_frame(measured)
    check_columns(presets, "presets")
    check_columns(errors, "tradeoff")
    assert list(presets_for_reader(presets).columns) == ["", "`draft`", "`paper`"]
    assert len(errors_for_reader(errors)) * len(OUTPUTS) == len(errors)


def test_the_law_of_a_time_is_found_again_in_times_made_from_it(runs):
    """Powers of settings that were varied, within what the rounding and the weak pull to zero allow."""
    law = {"log_constant": -9.0, "log_per_node": -15.0, "depth_digits": 0.4, "spacing": -0.7, "ratios": 0.3}
    settings = {name: runs[name].values for name in ("depth_tolerance", "depth_spacing")}
    settings["ratios"] = runs["run_ratios"].values
    seconds = law_seconds(law, runs["run_points"].values.astype(float) ** 2, settings)
    found = reduce_runs(runs.assign(stress_seconds=("run", seconds))).time_laws["stress"]
    for name in ("log_per_node", "depth_digits", "spacing", "ratios"):
        assert found[name] == pytest.approx(law[name], abs=0.02)


def test_bounds_lie_above_what_was_measured(runs):
    measured = reduce_runs(runs)
    bounds = error_bounds(Scene(0.8, 0.5, 0.125, 0.1), PRESETS["paper"], measured=measured)
    for output, bound in zip(OUTPUTS, sum(bounds.values()), strict=True):
        if output not in DISTRIBUTIONS:
            assert bound > error(runs, "accuracy", "paper", output)


def test_the_figures_are_drawn(runs):
    with style():
        drawn = figures.draw(runs, reduce_runs(runs))
    assert set(drawn) == {"front", "budget", "growth"}
    assert all(figure.axes for figure in drawn.values())
