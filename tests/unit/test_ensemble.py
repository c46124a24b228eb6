"""Ensembles: samples equal the stages, plans reach their targets, every claim knows its surfaces."""

import shutil
import subprocess
from itertools import pairwise

import numpy as np
import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.cli.commands.ensemble import error_of
from asperity.cli.main import main
from asperity.paper.claims.sources import roles
from asperity.paper.claims.statements import CLAIMS
from asperity.paper.ensemble.documents import PAGE, keep
from asperity.paper.ensemble.figure import draw
from asperity.paper.ensemble.gains import gain_frame, known_numbers
from asperity.paper.ensemble.numbers import SINGLE, full_name, number, numbers, surfaces_of, values
from asperity.paper.ensemble.planning import MOST_ROUNDS, Plan, next_plan, pilot
from asperity.paper.ensemble.result import gain_text, level_frame, result, sentences, summary_frame
from asperity.paper.ensemble.samples import Samples
from asperity.pipeline.blocks import BLOCK_NODES, SURFACE_ALONE, block_size, grid_points
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.ensemble import sample
from asperity.pipeline.statistics import seed_statistics
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import make_surface
from asperity.results import dataset

SURFACE = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 0.125, "rms_height": 0.004}
READINGS = {"lateral": ["free"], "shear": ["xz"], "patch_nodes": 30}
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
    times = {float(nodes): max(nodes, 0.1) ** 2 for nodes in (0, *settings["nodes"])}
    while not plans[-1].done:
        plans.append(next_plan(plans[-1], synthetic(plans[-1]), times, error, settings, [1 / 64]))
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
    frame = summary_frame({"number": again})
    assert float(again["gain_low"]) < float(again["gain"]) < float(again["gain_high"])
    assert float(again["gain_low_fine"]) < float(again["gain_fine"]) < float(again["gain_high_fine"])
    assert frame["gain"][0] == gain_text(again, "")
    assert float(again["gain"]) > 2
    assert "times as long" in sentences("number", "quantity", again)
    figure = draw({"number": again, "other": again, "third": again})
    assert [axis.get_xscale() for axis in figure.axes] == ["log"] * 3


def test_samples_equal_the_stages():
    """Bit by bit, on two seeds; the surface alone has the gradient of the surface with contact."""
    contact_settings = {**CONTACT, "path_area_fractions": []}
    found = sample(SURFACE, 4, [3, 5], LAYER, contact_settings, STRESS, READINGS)
    alone = sample(SURFACE, SURFACE_ALONE, [3, 5], LAYER, contact_settings, STRESS, READINGS)
    for seed in (3, 5):
        surface = make_surface({**SURFACE, "points": 32}, seed)
        contact = solve_contact(surface, LAYER, contact_settings)
        for lateral in ("confined", "free"):
            stress = compute_stress(contact, {**LAYER, "lateral": lateral}, STRESS)
            one = found.sel(seed=seed, lateral=lateral, drop=True).drop_vars("seed_seconds")
            assert one.equals(seed_statistics(surface, contact, stress))
        gradient = float(alone["seed_rms_gradient"].sel(seed=seed))
        assert gradient == pytest.approx(float(surface["rms_gradient"]), rel=1e-12)
    value = values("gradient_large_hurst", {"large_hurst": found})
    assert value.tolist() == found["seed_gradient_rms_contact"].sel(lateral="confined").values.tolist()
    high = found["seed_counted_quantile"].sel(lateral="free", counted="with_surface", poisson=0.33, level=0.9)
    name = "von_mises_p99_large_hurst,lateral=free,peaks=with_surface,tail=0.9"
    assert values(name, {"large_hurst": found}).tolist() == high.values.tolist()


def test_grids_hold_the_waves_of_the_surface():
    for wavelength in (1 / 8, 1 / 64, 1 / 100, 1 / 256):
        assert grid_points(wavelength, SURFACE_ALONE) > 2 / wavelength
        for nodes in (4, 8, 32):
            points = grid_points(wavelength, nodes)
            assert points * wavelength == nodes
            size = block_size(wavelength, nodes)
            assert size == 1 or size * points**2 <= BLOCK_NODES


def test_every_claim_about_random_surfaces_is_a_number():
    """Closed forms and finite elements have nothing to sample."""
    known = numbers()
    random = {claim.identifier for claim in CLAIMS} & known.keys()
    assert len(random) > 35
    assert not {"hertz_area", "punch_of_poisson", "coarse_grid"} & known.keys()
    assert known.keys() >= SINGLE.keys()


def test_numbers_find_their_surfaces():
    found = {"small_hurst": "rough", "large_hurst": "smooth", "compressibility": "smooth"}
    asked = surfaces_of("high_von_mises_small_hurst", found, {})
    assert asked == {"small_hurst": "rough", "large_hurst": "smooth"}
    assert surfaces_of("same_traction_peaks", found, {}) == asked
    assert surfaces_of("one_and_a_half", found, {}) == {"compressibility": "smooth"}
    with pytest.raises(ValueError, match="a surface as skew_positive is needed"):
        surfaces_of("skew_normalised", found, {})
    with pytest.raises(ValueError, match=r"claim = 'nonsense': one of .*one_and_a_half"):
        surfaces_of("nonsense", roles({}, {}), {})


def test_a_number_under_a_reading_finds_its_surfaces():
    found = {"compressibility": "smooth", "skew_positive, delta 2": "own", "skew_negative, delta 2": "other"}
    name = full_name("one_and_a_half", ["tail=0.9", "lateral=free"])
    assert number(name).options == {"lateral": "free", "tail": 0.9}
    assert surfaces_of(name, found, {"lateral": ["confined", "free"]}) == {"compressibility": "smooth"}
    twins = surfaces_of("skew_gradient,delta=2", found, {})
    assert twins == {"skew_positive, delta 2": "own", "skew_negative, delta 2": "other"}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("one_and_a_half,lateral=free", r"readings\.lateral = \['confined'\]: .* lists free there"),
        ("one_and_a_half,lateral=bent", "'lateral=bent': confined or free is needed"),
        ("one_and_a_half,decay=half", "reading 'decay=half': .* depends on lateral, peaks, tail"),
        ("one_and_a_half,free", "reading 'free': .* depends on lateral"),
        ("skew_gradient,delta=large", "'delta=large': a number > 0"),
    ],
)
def test_a_reading_that_cannot_be_taken_is_refused(name, message):
    with pytest.raises(ValueError, match=message):
        surfaces_of(name, {"compressibility": "smooth"}, {"lateral": ["confined"]})


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
    assert main([*given, "one_and_a_half", "--reading", "lateral=free"]) == 1
    assert "a configuration that lists free there is needed" in capsys.readouterr().err
    assert main([*given, "one_and_a_half", "--error", "3"]) == 1
    assert "--error '3': a share such as 0.5%" in capsys.readouterr().err


def test_the_command_makes_the_plan_then_the_result(tmp_path, monkeypatch, capsys):
    """Snakemake is asked for both files, with the options given; with --plan for the first alone."""
    config, folder = tmp_path / "own.yaml", tmp_path / "out/ensemble/one_and_a_half,tail=0.9/error0.01"
    config.write_text(
        "surfaces: {one: {label: one, " + str(SURFACE)[1:].replace("'", "") + "}\n"
        "studies: {compressibility: [one]}\n"
    )
    (tmp_path / "Snakefile").touch()
    monkeypatch.chdir(tmp_path)
    asked = []

    def made(command):
        asked.append(command)
        folder.mkdir(parents=True, exist_ok=True)
        Plan(1, (0.0, 4.0), (256, 32), (True, True), text=("round 1",)).write(folder / "plan1.json")
        (folder / "result.md").write_text("the result\n")
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", made)
    given = ["ensemble", "--config", str(config), "--claim", "one_and_a_half", "--reading", "tail=0.9"]
    given += ["--error", "1%", "--results", "out"]
    assert main([*given, "--plan"]) == 0
    assert main([*given, "--", "--cores", "3"]) == 0
    plan, result = (
        f"out/ensemble/one_and_a_half,tail=0.9/error0.01/{name}" for name in ("plan1.json", "result.nc")
    )
    assert [command[-1] for command in asked] == [plan, plan, result]
    assert "results=out" in asked[0]
    assert asked[2][asked[2].index("--cores") + 1] == "3"
    assert "round 1\nround 1\nthe result\n" in capsys.readouterr().out


def test_gains_of_all_numbers_that_the_samples_know(tmp_path):
    """Of one surface: the numbers of that surface alone, under both conditions of the uniform mode."""
    stages = {**LAYER}, {**CONTACT, "path_area_fractions": []}, STRESS, READINGS
    files = {}
    for nodes, seeds in ((SURFACE_ALONE, 40), (4, 16), (8, 5)):
        path = tmp_path / f"{nodes}.nc"
        dataset.write(
            sample(SURFACE, nodes, range(1, seeds + 1), *stages), path, title="Samples", settings={}
        )
        files[float(nodes)] = {"smooth": [str(path)]}
    found = {"compressibility": "smooth", "large_hurst": "smooth", "small_hurst": "rough"}
    known = known_numbers(found, files, ["free"])
    assert known["gradient_large_hurst"] == {"large_hurst": "smooth"}
    assert "one_and_a_half,lateral=free" in known
    assert "gradient_large_hurst,lateral=free" not in known
    assert not {"high_von_mises_small_hurst", "skewness_sign"} & known.keys()
    few = {name: known[name] for name in ("gradient_large_hurst", "one_and_a_half,lateral=free")}
    frame = gain_frame(few, files, 0.01, 4).set_index("number")
    assert sorted(frame.index) == sorted(few)
    row = frame.loc["gradient_large_hurst"]
    fine = dataset.read(files[8.0]["smooth"][0])["seed_gradient_rms_contact"].sel(lateral="confined")
    assert row["value"] == pytest.approx(float(fine.mean()), rel=0.2)
    assert row["gain"] == pytest.approx(row["plain seconds"] / row["seconds"])
    assert min(int(number) for number in row["seeds"].split(", ") if number != "–") >= 4


def test_tables_and_figure_go_to_the_page(tmp_path):
    made, docs = tmp_path / "results/ensemble", tmp_path / "docs"
    made.mkdir(parents=True)
    docs.mkdir()
    shutil.copy(PAGE, docs)
    for name in ("table", "gains"):
        (made / f"{name}.md").write_text(f"the {name}\n")
    (made / "cost.png").write_bytes(b"picture")
    keep(made.parent, tmp_path)
    keep(made.parent, tmp_path)
    text = (docs / "multilevel.md").read_text(encoding="utf-8")
    assert text.count("the table\n") == text.count("the gains\n") == 1
    assert (docs / "multilevel.png").read_bytes() == b"picture"
