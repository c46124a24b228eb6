"""Plans: bounds hold on scenes that were not measured, and proposals reach their targets.

Times are those of the machine of the measurement (factor 1), so that no test depends on the clock.
"""

import runpy
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from asperity.cli.main import main
from asperity.core.errors import PlanError
from asperity.paper.figures import surfaces_with_load_area
from asperity.study.config.check import check
from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import OUTPUTS, load
from asperity.study.cost.measurement import CONVERGED, evaluate, output_errors
from asperity.study.cost.plan import SAFETY_FACTOR, Target, assess, candidates, error_bounds, propose
from asperity.study.cost.scene import Scene, read, scenes
from asperity.study.cost.tables import describe_presets

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())
UNSEEN = Scene(hurst=0.5, wavelength_long=1 / 4, wavelength_short=1 / 16, area_fraction=0.06, seed=7)
SPECTRUM = "{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}"


@pytest.fixture(scope="module")
def reference():
    return evaluate(UNSEEN, replace(CONVERGED, points_per_wavelength=24.0))


def settings_of(name):
    """Settings of a preset, or those proposed for an error of 10 %."""
    if name in PRESETS:
        return PRESETS[name]
    return propose([UNSEEN], Target(["von_mises_p99"], error=0.1, one_surface=True), factor=1.0).accuracy


@pytest.mark.parametrize("name", ["draft", "paper", "proposed"])
def test_errors_stay_within_their_bounds_on_another_scene(reference, name):
    accuracy = settings_of(name)
    evaluation = evaluate(UNSEEN, accuracy, reference.mean_pressure)
    errors = output_errors(evaluation, reference)
    bounds = error_bounds(UNSEEN, accuracy, one_surface=True)
    largest = dict(zip(OUTPUTS, sum(bounds.values()), strict=True))
    assert not {name: errors[name] for name in OUTPUTS if abs(errors[name]) > largest[name]}


def test_the_proposed_settings_are_the_cheapest_within_the_error():
    target = Target(["von_mises_p90"], error=0.15, one_surface=True)
    found = propose([UNSEEN], target, factor=1.0)
    assert found.error(target.outputs) <= target.error
    for accuracy in candidates()[::17]:
        other = assess([UNSEEN], accuracy, one_surface=True, factor=1.0)
        assert other.error(target.outputs) > target.error or other.seconds >= found.seconds


def test_a_slower_machine_takes_longer_and_a_time_then_buys_less():
    target = Target(seconds=10.0)
    fast, slow = (propose([UNSEEN], target, factor=factor) for factor in (1.0, 10.0))
    assert max(fast.seconds, slow.seconds) <= target.seconds
    assert slow.error(target.outputs) > fast.error(target.outputs)
    assert assess([UNSEEN], slow.accuracy, factor=1.0).seconds == pytest.approx(slow.seconds / 10)


def test_less_memory_means_a_coarser_grid():
    scene = replace(UNSEEN, wavelength_short=1 / 256)
    free = propose([scene], Target(seconds=1e5, one_surface=True), factor=1.0)
    memory = 0.8 * free.memory
    limited = propose([scene], Target(seconds=1e5, memory=memory, one_surface=True), factor=1.0)
    assert limited.memory <= memory
    assert limited.accuracy.points_per_wavelength < free.accuracy.points_per_wavelength


def test_four_times_the_seeds_halve_their_error_and_take_four_times_as_long():
    one = assess([UNSEEN], PRESETS["paper"], factor=1.0)
    four = assess([UNSEEN], replace(PRESETS["paper"], seeds=4), factor=1.0)
    assert four.errors["seeds"] == pytest.approx(one.errors["seeds"] / 2)
    assert four.seconds == pytest.approx(4 * one.seconds)


def test_a_proposal_of_several_seeds_has_their_cost_and_error():
    found = propose([UNSEEN], Target(["peak_depth"], error=0.15), factor=1.0)
    assert found.accuracy.seeds > 1
    expected = assess([UNSEEN], found.accuracy, factor=1.0)
    assert found.seconds == pytest.approx(expected.seconds)
    assert found.errors["seeds"] == pytest.approx(expected.errors["seeds"])


def test_bounds_are_above_every_measured_error_by_the_safety_factor():
    known = load().errors["0.02"]
    bounds = error_bounds(UNSEEN, PRESETS["paper"])
    grid, contact = known["points_per_wavelength"]["8"], known["contact_tolerance"]["1e-06"]
    assert (bounds["discretisation"] >= [SAFETY_FACTOR * grid[name] for name in OUTPUTS]).all()
    assert bounds["contact"] == pytest.approx([SAFETY_FACTOR * contact[name] for name in OUTPUTS])


def test_what_was_not_measured_has_no_bound():
    coarser = replace(PRESETS["paper"], points_per_wavelength=2.0)
    assert (error_bounds(UNSEEN, coarser)["discretisation"] == float("inf")).all()


@pytest.mark.parametrize(
    ("target", "kind", "line"),
    [
        ({"error": 1e-9}, PlanError, "is the least that measured settings reach in pressure_p90"),
        ({"seconds": 1e-9}, PlanError, "not within this time and memory"),
        ({"memory": 1.0}, PlanError, "not within this time and memory"),
        ({}, ValueError, "a target is needed"),
        ({"error": 0.1, "outputs": ["peak"]}, ValueError, "output = 'peak': one of area_fraction"),
    ],
)
def test_a_target_that_cannot_be_met_is_named(target, kind, line):
    with pytest.raises(kind, match=line):
        propose([UNSEEN], Target(**target), factor=1.0)


def test_the_command_proposes_settings_that_a_configuration_accepts(capsys):
    assert main(["plan", SPECTRUM, "--error", "0.1", "--output", "von_mises_p99", "--one-surface"]) == 0
    printed = capsys.readouterr().out
    assert "this very surface" in printed
    keys = yaml.safe_load(printed.split("configuration:\n")[1])
    keys["surfaces"] = {"surface": PAPER["surfaces"]["gaussian"] | keys["surfaces"]["surface"]}
    config = {**PAPER, "seeds": keys["seeds"], "surfaces": {**PAPER["surfaces"], **keys["surfaces"]}}
    for section in ("contact", "stress", "layer"):
        config[section] = PAPER[section] | keys[section]
    check(config)


def test_the_command_tells_what_a_configuration_costs(capsys):
    files = [str(ROOT / "config" / name) for name in ("config.yaml", "quick.yaml")]
    assert main(["plan", *files]) == 0
    printed = capsys.readouterr().out
    assert "5 surfaces, 1 seed, at most 256 x 256 nodes" in printed
    assert "pressure_p99" in printed


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("{hurst: 0.8}", "surfaces.surface.wavelength_long: missing; a number"),
        ("none.yaml", "'none.yaml': a file, or keys and values such as"),
        ("{hurst: [", "YAML is needed; "),
    ],
)
def test_a_spectrum_that_is_none_is_one_line(capsys, text, line):
    assert main(["plan", text]) == 1
    error = capsys.readouterr().err
    assert line in error
    assert error.count("\n") == 1


def test_the_readme_has_the_presets_as_they_were_measured():
    text = (ROOT / "config/README.md").read_text()
    table = text.split("<!-- presets: python -m asperity.study.cost.tables -->\n")[1].split("\n\n")[0]
    assert table == describe_presets(load())
    assert set(load().presets) == set(PRESETS)


def test_a_new_measurement_changes_the_presets_in_the_readme_and_nothing_else():
    with_table = runpy.run_path(str(ROOT / "workflow/store_tradeoff.py"))["with_table"]
    text = (ROOT / "config/README.md").read_text()
    assert with_table(text, load()) == text
    presets = {name: {**found, "seconds": 9.75} for name, found in load().presets.items()}
    changed = with_table(text, replace(load(), presets=presets))
    different = [line for line in changed.splitlines() if line not in text.splitlines()]
    assert different == ["| processor time of one surface (s) | 9.75 | 9.75 | 9.75 |"]


def test_loads_are_counted_for_every_surface_whose_contact_a_figure_shows():
    band = "hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125, rms_height: 0.001"
    text = f"surfaces: {{ground: {{label: a, {band}}}, lapped: {{label: b, {band}}}}}"
    contact = "contact: {path_area_fractions: [0.02, 0.05, 0.1]}"
    whole = read([text, contact])
    found, _ = scenes(whole, surfaces_with_load_area(whole))
    assert {name: scene.number_of_loads for name, scene in found.items()} == {"ground": 3, "lapped": 3}
