"""The schema of the settings of a study, and what is made from it: check, defaults, presets, README."""

import copy
from pathlib import Path

import pytest
import yaml
from project import ROOT
from random_input import places, refusal

from asperity.settings.__main__ import main
from asperity.settings.accuracy import PRESETS, accuracy_of
from asperity.settings.check import check, complete
from asperity.settings.reader import merged, parse
from asperity.settings.sections import imposed_load
from asperity.settings.study import read_study

PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())


@pytest.mark.parametrize(
    "name",
    [
        "config.yaml",
        "decide.yaml",
        "decide_nodes.yaml",
        "mine.yaml",
        "quick.yaml",
        "../.test/config/config.yaml",
    ],
)
def test_the_configurations_of_the_repository_are_accepted(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    read_study([ROOT / "config" / name], {"results": "any"})


def test_missing_or_empty_settings_are_accepted_or_named():
    """One key at a time of one surface of each kind: no other error than the line that names a setting."""
    kinds = ("hurst_08", "skew_positive", "kurtosis_low", "cutoff_512")
    config = PAPER | {"surfaces": {name: PAPER["surfaces"][name] | {"label": "A"} for name in kinds}}
    config = copy.deepcopy(config | {"studies": {name: ["hurst_08"] for name in PAPER["studies"]}})
    assert not refusal(config)
    for group, key in list(places(config)):
        kept = group.copy()
        without = {name: value for name, value in kept.items() if name != key}
        messages = []
        for changed in (without, kept | {key: {}}, kept | {key: "text"}):
            group.clear()
            group.update(changed)
            messages.append(refusal(config))
        group.update(kept)
        assert any(messages), key


def test_all_problems_are_named_at_once():
    """Wrong values; then, where each value is accepted alone, those that do not fit together."""
    name = next(iter(PAPER["surfaces"]))
    wrong = {"seeds": [-1], "stres": {}, "layer": {"poisson": "0.3", "lateral": None}, "figures": "none"}
    lines = refusal(merged(PAPER, wrong | {"surfaces": {name: {"hurst": 2}, "A": {}}}))
    keys = {line.split(" = ")[0].split(":")[0] for line in lines}
    parts = ("label", "hurst", "wavelength_long", "wavelength_short", "rms_height")
    assert keys == {
        *("seeds.0", "stres", "layer.poisson", "layer.lateral", "figures", f"surfaces.{name}.hurst"),
        *("surfaces.'A'", *(f"surfaces.A.{part}" for part in parts)),
    }
    assert "stres: unknown key; did you mean stress?" in lines
    both = {"stress": {"poisson": [0.1]}, "studies": {"mine": ["none"]}, "figures": "own"}
    lines = refusal(merged(PAPER, both | {"accuracy": "reference", "contact": {"precision": "float32"}}))
    found = [line.split(" ")[0] for line in lines]
    assert found == ["studies.mine", "claims", "contact.tolerance", "stress.poisson"]


@pytest.mark.parametrize("load", [{"mean_pressure": 0.002}, {"normal_approach": 0.001}])
def test_a_load_replaces_that_beneath(load):
    """An overlay of the paper imposes another quantity, and needs not take back the paper's area."""
    config = merged(PAPER, {"contact": load})
    check(config)
    contact = complete(config)["contact"]
    assert imposed_load(contact) == next(iter(load.items()))
    assert complete(complete(config))["contact"] == contact
    alone = complete({"surfaces": PAPER["surfaces"], "contact": load})["contact"]
    assert imposed_load(alone) == imposed_load(contact)
    assert "path_contact_area_fractions" not in alone


def test_settings_that_are_left_out_get_their_defaults():
    config = copy.deepcopy(PAPER)
    del (
        config["layer"],
        config["measured"]["fault"]["detrend"],
        config["contact"]["path_contact_area_fractions"],
    )
    del config["stress"]["poisson"], config["measured"]["fault"]["wavelength_short"]
    check(config)
    whole = complete(config)
    assert whole["layer"] == {**PAPER["layer"], "half_space_tolerance": 0.05}
    assert not {"detrend", "points"} & whole["measured"]["fault"].keys()  # by the map
    assert whole["contact"]["path_contact_area_fractions"] == [whole["contact"]["contact_area_fraction"]]
    assert whole["stress"]["poisson"] == [whole["layer"]["poisson"]]


def test_the_command_checks_and_names_the_folder(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    overlay = tmp_path / "overlay.yaml"
    overlay.write_text("contact: {contact_area_fraction: 0.05}")
    assert main(["check", "config/config.yaml", str(overlay)]) == 0
    assert main(["results", "config/quick.yaml"]) == 0
    assert main(["results", "config/quick.yaml", "--results", "~//x/"]) == 0
    assert capsys.readouterr() == (f"results/quick\n{Path.home()}/x\n", "")


def test_plain_scalars_are_those_of_yaml_1_2():
    found = parse("a: [010, 1:20, 1e-6, no, 1_000, 2026-11-21, +3, -.5, true, ~]", "text")["a"]
    assert found == [10, "1:20", 1e-6, "no", "1_000", "2026-11-21", 3, -0.5, True, None]
    assert [type(value) for value in found[:3]] == [int, str, float]


FREE = copy.deepcopy(PAPER)
"""The paper's configuration without what it gives itself of the presets."""
del FREE["seeds"], FREE["surfaces"]["cutoff_512"]["points"]


@pytest.mark.parametrize("name", PRESETS)
def test_configuration_of_every_preset_is_accepted(name):
    before = FREE | {"accuracy": name}
    whole = complete(before)
    check(whole)
    assert complete(whole) == whole
    assert accuracy_of(whole, "gaussian") == PRESETS[name]
    assert "tolerance" not in before["contact"]


def test_a_setting_that_is_given_overrides_the_preset():
    config = copy.deepcopy(PAPER) | {"accuracy": "draft", "seeds": [7]}
    config["contact"]["precision"] = "float32"
    config["surfaces"]["gaussian"]["points"] = 300
    whole = complete(config)
    assert whole["seeds"] == [7]
    assert (whole["contact"]["precision"], whole["contact"]["tolerance"]) == ("float32", 1e-4)
    assert whole["surfaces"]["gaussian"]["points"] == 300
    assert whole["surfaces"]["hurst_02"]["points"] == 1024
