"""Plans against what really happens, on scenes that were not used to make them."""

import runpy
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from asperity.accuracy.measurement import EXACT, OUTPUTS, Scene, errors, evaluate
from asperity.accuracy.model import describe_presets, load
from asperity.accuracy.plan import MARGIN, announce, assess, candidates, predict_cost, predict_errors, propose
from asperity.accuracy.resources import need
from asperity.cli.main import main
from asperity.config.check import check
from asperity.config.presets import PRESETS
from asperity.errors import PlanError

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())
UNSEEN = Scene(hurst=0.5, wavelength_long=1 / 6, wavelength_short=1 / 24, area_fraction=0.06, seed=7)
SPECTRUM = "{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}"


@pytest.fixture(scope="module")
def reference():
    return evaluate(UNSEEN, replace(EXACT, points_per_wavelength=24.0))


def tried():
    """Presets, and what is proposed for a target."""
    yield PRESETS["draft"]
    yield PRESETS["paper"]
    yield propose([UNSEEN], ["von_mises_p99"], error=0.1, one_surface=True).knobs


@pytest.mark.parametrize("number", range(3), ids=["draft", "paper", "proposed"])
def test_errors_stay_within_their_bounds_on_another_scene(reference, number):
    knobs = list(tried())[number]
    load_of_reference = reference.summary["contact.mean_pressure"]
    found = errors(evaluate(UNSEEN, knobs, mean_pressure=load_of_reference), reference)
    bounds = predict_errors(UNSEEN, knobs, one_surface=True)
    beyond = {name: found[name] for name in OUTPUTS if abs(found[name]) > sum(bounds[name].values())}
    assert not beyond


@pytest.mark.parametrize(("short", "points"), [(1 / 24, 8.0), (1 / 48, 8.0), (1 / 48, 16.0)])
def test_time_and_memory_are_within_a_factor_of_two_on_another_scene(short, points):
    scene = replace(UNSEEN, wavelength_short=short)
    knobs = replace(PRESETS["paper"], points_per_wavelength=points)
    expected = predict_cost(scene, knobs, ratios=2)
    taken = []
    for _ in range(2):
        costs = evaluate(scene, knobs, ratios=(0.2, 0.33)).costs
        taken.append(costs["surface_seconds"] + costs["contact_seconds"] + costs["stress_seconds"])
    assert expected.seconds / 2 < min(taken) < 2 * expected.seconds
    assert expected.memory / 2 < costs["peak_memory"] < 2 * expected.memory


def test_the_cheapest_settings_are_within_the_error_and_none_cheaper_is():
    found = propose([UNSEEN], ["von_mises_p90"], error=0.15, one_surface=True)
    assert found.error(["von_mises_p90"]) <= 0.15
    for knobs in candidates(load())[::17]:
        other = assess([UNSEEN], knobs, one_surface=True)
        assert other.error(["von_mises_p90"]) > 0.15 or other.cost.seconds > 0.7 * found.cost.seconds


def test_more_time_never_means_a_larger_error():
    found = [propose([UNSEEN], seconds=seconds) for seconds in (1.0, 10.0, 100.0)]
    wrong = [proposal.error(["von_mises_p99"]) for proposal in found]
    assert wrong == sorted(wrong, reverse=True)
    assert all(
        proposal.cost.seconds <= seconds for proposal, seconds in zip(found, (1, 10, 100), strict=True)
    )


def test_less_memory_means_a_coarser_grid():
    scene = replace(UNSEEN, wavelength_short=1 / 256)
    free = propose([scene], seconds=1e5, one_surface=True)
    held = propose([scene], seconds=1e5, memory=0.8 * free.cost.memory, one_surface=True)
    assert held.cost.memory <= 0.8 * free.cost.memory
    assert held.knobs.points_per_wavelength < free.knobs.points_per_wavelength


def test_four_times_the_seeds_halve_their_error_and_take_four_times_as_long():
    one = assess([UNSEEN], PRESETS["paper"], factor=1.0)
    four = assess([UNSEEN], replace(PRESETS["paper"], seeds=4), factor=1.0)
    assert four.errors["peak_depth"]["seeds"] == pytest.approx(one.errors["peak_depth"]["seeds"] / 2)
    assert four.cost.seconds == pytest.approx(4 * one.cost.seconds)


def test_a_margin_is_kept_to_every_measured_error():
    known = load().errors["0.02"]["points_per_wavelength"]["8"]
    bounds = predict_errors(UNSEEN, PRESETS["paper"])
    assert all(bounds[name]["discretisation"] >= MARGIN * known[name] for name in OUTPUTS)


def test_what_was_not_measured_has_no_bound():
    coarser = replace(PRESETS["paper"], points_per_wavelength=2.0)
    assert predict_errors(UNSEEN, coarser)["peak_depth"]["discretisation"] == float("inf")


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
        propose([UNSEEN], **target)


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


def test_the_study_announces_its_jobs():
    nodes = 1024**2
    jobs = [
        ("contact", need("contact", nodes)),
        ("contact", need("contact", nodes)),
        ("claims", need("claims")),
    ]
    lines = announce(jobs, cores=2).splitlines()
    assert lines[0].startswith("plan: 3 jobs, about ")
    assert "on 2 cores" in lines[0]
    assert any(line.split()[1:3] == ["contact", "2"] for line in lines[1:])


def test_the_readme_has_the_presets_as_they_were_measured():
    text = (ROOT / "config/README.md").read_text()
    table = text.split("<!-- presets: python -m asperity.accuracy.plan -->\n")[1].split("\n\n")[0]
    assert table == describe_presets(load())
    assert set(load().presets) == set(PRESETS)


def test_a_new_measurement_changes_the_presets_in_the_readme_and_nothing_else():
    with_table = runpy.run_path(str(ROOT / "workflow/tradeoff.py"))["with_table"]
    text = (ROOT / "config/README.md").read_text()
    assert with_table(text, load()) == text
    presets = {name: {**found, "seconds": 9.75} for name, found in load().presets.items()}
    changed = with_table(text, replace(load(), presets=presets))
    different = [line for line in changed.splitlines() if line not in text.splitlines()]
    assert different == ["| processor time of one surface (s) | 9.75 | 9.75 | 9.75 |"]
