"""Ensembles: samples equal the stages, plans reach their targets, every claim knows its surfaces."""

from itertools import pairwise

import numpy as np
import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.cli.commands.ensemble import error_of
from asperity.cli.main import main
from asperity.paper.claims.sources import roles
from asperity.paper.claims.statements import CLAIMS
from asperity.paper.ensemble.figure import draw
from asperity.paper.ensemble.numbers import SINGLE, numbers, surfaces_of, values
from asperity.paper.ensemble.planning import MOST_ROUNDS, Plan, next_plan, pilot
from asperity.paper.ensemble.result import level_frame, result, sentences, summary_frame
from asperity.paper.ensemble.samples import Samples
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.ensemble import BLOCK_NODES, SURFACE_ALONE, block_size, grid_points, sample
from asperity.pipeline.statistics import seed_statistics
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import make_surface
from asperity.results import dataset

SURFACE = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 0.125, "rms_height": 0.004}
SETTINGS = {"nodes": [4, 8, 16, 32, 64], "pilot": 6}
LIMIT, SLOPE, SPREAD = 2.0, 0.2, 0.1


def synthetic(plan):
    """Samples of a number with mean LIMIT + SLOPE/nodes on a grid, correlated from grid to grid.

    The noise of a seed and a grid is the same in every plan. The time of a seed is that number squared.
    """
    rng = np.random.default_rng(4)
    noise = rng.normal(size=(20000, 1 + len(SETTINGS["nodes"])))
    levels = [noise[: plan.seeds[0], :1]]
    for nodes, seeds in zip(plan.nodes[1:], plan.seeds[1:], strict=True):
        own = noise[:seeds, 1 + SETTINGS["nodes"].index(nodes)]
        random = 0.5 * noise[:seeds, 0] + noise[:seeds, -1] + own * 0.4 / nodes
        levels.append(LIMIT + SLOPE / nodes + SPREAD * random)
    times = [
        np.full(len(level), max(nodes, 0.1) ** 2) for nodes, level in zip(plan.nodes, levels, strict=True)
    ]
    return Samples(plan.nodes, tuple(levels), tuple(times))


def planned(error, settings=SETTINGS):
    """All plans of a target, from the pilot to the last round."""
    plans = [pilot(settings["nodes"], settings["pilot"], [1 / 64])]
    while not plans[-1].done:
        plans.append(next_plan(plans[-1], synthetic(plans[-1]), error, settings, [1 / 64]))
    return plans


@pytest.mark.parametrize("error", [0.02, 0.006])
def test_plans_reach_their_target(error):
    plans = planned(error)
    data = result(plans[-1], synthetic(plans[-1]))
    assert float(data["estimate_total_error"]) <= 1.02 * error * abs(float(data["estimate"]))
    assert abs(float(data["estimate"]) - LIMIT) < 3 * error * LIMIT
    assert plans[-1].text[-1] == "target reached"


def test_a_smaller_error_takes_finer_grids_and_more_seeds():
    loose, tight = planned(0.02)[-1], planned(0.006)[-1]
    assert loose.nodes == tight.nodes[: len(loose.nodes)]
    assert len(tight.nodes) > len(loose.nodes)
    assert all(few <= many for few, many in zip(loose.seeds, tight.seeds, strict=False))


def test_rounds_only_add_seeds_and_come_to_an_end():
    plans = planned(0.006)
    assert len(plans) <= MOST_ROUNDS + 1
    for before, after in pairwise(plans):
        assert all(few <= many for few, many in zip(before.seeds, after.seeds, strict=False))
        assert list(after.seeds) == sorted(after.seeds, reverse=True)
        assert after.done == (before.seeds == after.seeds)


def test_a_bias_that_no_grid_removes_is_told():
    plans = planned(0.002, {**SETTINGS, "nodes": [4, 8, 16]})
    assert plans[-1].nodes[-1] == 16
    assert plans[-1].text[-1] == "target not reached on the finest grid allowed"


def test_a_plan_is_the_same_after_writing(tmp_path):
    for plan in planned(0.02):
        plan.write(tmp_path / "plan.json")
        assert repr(Plan.read(tmp_path / "plan.json")) == repr(plan)


def test_blocks_are_whole_in_every_plan():
    for plan in planned(0.006):
        for nodes, seeds in zip(plan.nodes, plan.seeds, strict=True):
            assert seeds % block_size(1 / 64, nodes) == 0


def test_a_result_is_written_and_shown(tmp_path):
    plan = planned(0.004)[-1]
    data = result(plan, synthetic(plan))
    dataset.write(data, tmp_path / "result.nc", title="Ensemble", settings={})
    again = dataset.read(tmp_path / "result.nc")
    assert float(again["estimate"]) == float(data["estimate"])
    frame = level_frame(again)
    assert frame["seeds"].tolist() == list(plan.seeds)
    assert frame["correlation"].iloc[-1] > 0.9
    assert summary_frame({"number": again})["plain over multilevel"][0] > 2
    assert "times as long" in sentences("number", "quantity", again)
    figure = draw({"number": again, "other": again, "third": again})
    assert [axis.get_xscale() for axis in figure.axes] == ["log"] * 3


def test_samples_equal_the_stages():
    """Bit by bit, on two seeds; the surface alone has the gradient of the surface with contact."""
    contact_settings = {**CONTACT, "path_area_fractions": []}
    found = sample(SURFACE, 4, [3, 5], LAYER, contact_settings, STRESS)
    alone = sample(SURFACE, SURFACE_ALONE, [3, 5], LAYER, contact_settings, STRESS)
    for seed in (3, 5):
        surface = make_surface({**SURFACE, "points": 32}, seed)
        contact = solve_contact(surface, LAYER, contact_settings)
        expected = seed_statistics(surface, contact, compute_stress(contact, LAYER, STRESS))
        one = found.sel(seed=seed, drop=True).drop_vars("seed_seconds")
        assert one.equals(expected)
        gradient = float(alone["seed_rms_gradient"].sel(seed=seed))
        assert gradient == pytest.approx(float(surface["rms_gradient"]), rel=1e-12)
    value = values("gradient_large_hurst", {"large_hurst": found})
    assert value.tolist() == found["seed_gradient_rms_contact"].values.tolist()


def test_grids_hold_the_waves_of_the_surface():
    for wavelength in (1 / 8, 1 / 64, 1 / 100, 1 / 256):
        assert grid_points(wavelength, SURFACE_ALONE) > 2 / wavelength
        for nodes in (4, 8, 32):
            points = grid_points(wavelength, nodes)
            assert points * wavelength == nodes
            size = block_size(wavelength, nodes)
            assert size == 1 or size * points**2 <= BLOCK_NODES


def test_every_claim_about_random_surfaces_is_a_number():
    """A claim that names a role in its measure is asked for just the surfaces of its roles."""
    known = numbers()
    random = {claim.identifier for claim in CLAIMS} & known.keys()
    assert len(random) > 35
    assert not {"hertz_area", "punch_of_poisson", "coarse_grid"} & known.keys()
    assert known.keys() >= SINGLE.keys()


def test_numbers_find_their_surfaces():
    found = {"small_hurst": "rough", "large_hurst": "smooth", "compressibility": "smooth"}
    asked = surfaces_of("high_von_mises_small_hurst", found)
    assert asked == {"small_hurst": "rough", "large_hurst": "smooth"}
    assert surfaces_of("same_traction_peaks", found) == asked
    assert surfaces_of("one_and_a_half", found) == {"compressibility": "smooth"}
    with pytest.raises(ValueError, match="a surface as skew_positive is needed"):
        surfaces_of("skew_normalised", found)
    with pytest.raises(ValueError, match=r"claim = 'nonsense': one of .*one_and_a_half"):
        surfaces_of("nonsense", roles({}, {}))


@pytest.mark.parametrize(
    ("text", "error"), [("0.5%", 0.005), ("0.005", 0.005), (" 20 % ", 0.2), ("1e-3", 1e-3)]
)
def test_an_error_is_a_share(text, error):
    assert error_of(text) == error


@pytest.mark.parametrize("text", ["0", "-1%", "200%", "half", "nan%", ""])
def test_an_error_that_is_no_share_is_refused(text):
    with pytest.raises(ValueError, match=r"a share such as 0\.5% or 0\.005 is needed"):
        error_of(text)


def test_the_command_needs_the_folder_of_the_project(tmp_path, monkeypatch, capsys):
    config = tmp_path / "own.yaml"
    config.write_text("surfaces: {one: {label: one, " + str(SURFACE)[1:].replace("'", "") + "}\n")
    monkeypatch.chdir(tmp_path)
    given = ["ensemble", "--config", str(config), "--claim"]
    assert main([*given, "one_and_a_half"]) == 1
    assert "a configuration with a surface as compressibility is needed" in capsys.readouterr().err
    config.write_text(config.read_text() + "studies: {compressibility: [one]}\n")
    assert main([*given, "one_and_a_half"]) == 1
    assert "no such file; the command runs in the folder of the study" in capsys.readouterr().err
    assert main([*given, "one_and_a_half", "--error", "3"]) == 1
    assert "--error '3': a share such as 0.5%" in capsys.readouterr().err
