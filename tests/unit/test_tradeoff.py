"""The measurement of speed and accuracy, on a scene as small as it can be."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from asperity.accuracy.measurement import (
    DISTRIBUTIONS,
    EXACT,
    OUTPUTS,
    Scene,
    distance,
    errors,
    evaluate,
    measure,
)
from asperity.accuracy.model import (
    Measured,
    as_json,
    describe_errors,
    describe_presets,
    features,
    fit,
    seconds_of,
)
from asperity.accuracy.plan import predict_errors
from asperity.config.presets import PRESETS
from asperity.paper.figures import tradeoff as figures
from asperity.paper.figures.style import style
from asperity.results import dataset

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


def error(runs, knob, setting, output):
    rows = (runs["run_knob"] == knob) & (runs["run_setting"] == setting)
    return np.abs(runs["output_error"].sel(output=output).values[rows.values])


def test_a_run_has_no_error_against_itself():
    outcome = evaluate(Scene(0.8, 1 / 2, 1 / 4, 0.1), PRESETS["paper"])
    assert set(errors(outcome, outcome).values()) == {0.0}


def test_the_distance_of_distributions_is_their_shift_over_the_mean():
    quantiles = np.linspace(1.0, 3.0, 110)
    assert distance(1.1 * quantiles, quantiles) == pytest.approx(0.1)
    assert distance(quantiles, quantiles) == 0.0


def test_the_area_is_that_at_the_load_of_the_reference():
    """A tenth more load makes nearly a tenth more area."""
    scene = Scene(0.8, 1 / 2, 1 / 8, 0.1)
    first = evaluate(scene, PRESETS["paper"])
    more = 1.1 * first.mean_pressure
    again = evaluate(scene, PRESETS["paper"], mean_pressure=more)
    assert again.area_fraction / first.area_fraction == pytest.approx(1.09, abs=0.02)
    assert again.statistics.identical(first.statistics)


def test_a_knob_of_the_depths_leaves_the_contact_exactly_as_it_was(runs):
    for knob, setting in (("depth_spacing", "2.0"), ("depth_tolerance", "0.1")):
        for output in ("area_fraction", "proportionality", "pressure_p99", "pressure_distribution"):
            assert error(runs, knob, setting, output) == 0.0


def test_errors_fall_with_their_knobs(runs):
    for output in ("pressure_p90", "von_mises_distribution"):
        assert error(runs, "points_per_wavelength", "4", output) > error(
            runs, "points_per_wavelength", "8", output
        )
    assert error(runs, "depth_spacing", "4.0", "von_mises_p90") > error(
        runs, "depth_spacing", "0.25", "von_mises_p90"
    )
    assert error(runs, "contact_tolerance", "1e-06", "proportionality") < 1e-5


def test_a_half_space_errs_less_for_a_higher_layer(runs):
    bounds = [
        str(s) for s in dict.fromkeys(runs["run_setting"].values[runs["run_knob"] == "half_space_tolerance"])
    ]
    assert [float(bound) for bound in bounds] == sorted(map(float, bounds), reverse=True)
    wrong = [float(error(runs, "half_space_tolerance", bound, "von_mises_p90")[0]) for bound in bounds]
    assert wrong[-1] < 0.1 * wrong[0]


def test_the_measurement_is_a_file_and_comes_back_from_text(runs, tmp_path):
    dataset.write(runs, tmp_path / "runs.nc", title="runs", settings={"tradeoff": SETTINGS})
    assert dataset.read(tmp_path / "runs.nc").sizes == runs.sizes
    measured = fit(runs)
    assert asdict(Measured(**json.loads(as_json(measured)))) == json.loads(as_json(measured))
    assert set(measured.presets) == {"draft", "paper"}  # the finest grid is coarser than the third needs
    for text in (describe_presets(measured), describe_errors(measured)):
        assert len({line.count("|") for line in text.splitlines()}) == 1


def test_the_law_of_time_gives_back_the_times_it_was_made_from(runs):
    law = fit(runs).laws["stress_seconds"]
    names = ("depth_digits", "spacing", "ratios")
    for row in range(runs.sizes["run"]):
        run = runs.isel(run=row)
        settings = {
            "depth_tolerance": float(run["depth_tolerance"]),
            "depth_spacing": float(run["depth_spacing"]),
            "ratios": int(run["run_ratios"]),
        }
        powers = [law[name] for name in ("start", "node", *names)]
        expected = float(seconds_of(powers, float(run["run_points"]), features(names, settings)))
        assert 1 / 3 < float(run["stress_seconds"]) / expected < 3  # some take a hundredth of a second


def test_bounds_lie_above_what_was_measured(runs):
    measured = fit(runs)
    bounds = predict_errors(Scene(0.8, 0.5, 0.125, 0.1), PRESETS["paper"], measured=measured)
    for output in set(OUTPUTS) - set(DISTRIBUTIONS):
        assert sum(bounds[output].values()) > float(error(runs, "accuracy", "paper", output)[0])


def test_the_figures_are_drawn(runs):
    with style():
        drawn = figures.draw(runs, fit(runs))
    assert set(drawn) == {"front", "budget", "growth"}
    assert all(figure.axes for figure in drawn.values())


def test_the_reference_is_finer_than_any_preset_but_in_its_grid():
    for knobs in PRESETS.values():
        assert EXACT.contact_tolerance < knobs.contact_tolerance
        assert EXACT.depth_tolerance < knobs.depth_tolerance
        assert EXACT.depth_spacing < knobs.depth_spacing
