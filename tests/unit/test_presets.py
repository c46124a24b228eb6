"""Presets of accuracy: the settings that they fill in, and those that a configuration gives itself."""

import copy
from pathlib import Path

import pytest
import yaml

from asperity.study.config.check import check
from asperity.study.config.defaults import PRESETS, accuracy_of, complete, overlay
from asperity.study.config.reader import merged
from asperity.study.config.schema import setting

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())
FREE = copy.deepcopy(PAPER)
"""The paper's configuration without what it gives itself of the presets."""
del FREE["seeds"], FREE["surfaces"]["cutoff_512"]["points"]


def test_the_schema_knows_the_presets():
    assert setting("accuracy")["enum"] == list(PRESETS)


def test_the_paper_has_the_settings_its_figures_were_made_with():
    whole = complete(PAPER)
    points = {name: surface["points"] for name, surface in whole["surfaces"].items()}
    assert points["hurst_02"] == points["hurst_08"] == 2048
    assert (points["cutoff_64"], points["gaussian"], points["cutoff_512"]) == (512, 1024, 2048)
    assert whole["measured"]["fault"]["points"] == 512
    assert whole["seeds"] == [1, 2, 3, 4]
    assert (whole["contact"]["tolerance"], whole["contact"]["precision"]) == (1e-6, "float64")
    assert (whole["stress"]["tolerance"], whole["stress"]["depth_spacing"]) == (1e-4, 0.5)
    assert whole["layer"]["half_space_tolerance"] == 0.05


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_gives_a_configuration_that_is_accepted_and_stays_as_it_is(name):
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


def test_a_map_without_a_shortest_wavelength_keeps_its_points():
    config = copy.deepcopy(PAPER)
    del config["measured"]["fault"]["wavelength_short"]
    assert "points" not in complete(config)["measured"]["fault"]


def test_the_overlay_of_a_preset_gives_what_the_preset_gives():
    wavelengths = {name: surface["wavelength_short"] for name, surface in PAPER["surfaces"].items()}
    config = merged(FREE, overlay(PRESETS["reference"], wavelengths))
    expected = complete(FREE | {"accuracy": "reference"})
    assert complete(config) | {"accuracy": "reference", "measured": expected["measured"]} == expected


def test_points_are_fast_to_transform():
    assert PRESETS["paper"].points(0.03) == 270
