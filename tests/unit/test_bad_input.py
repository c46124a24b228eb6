"""Whatever is asked for wrongly is answered with one line, nothing is run from it, and nothing is written."""

import copy
import os
import re
from pathlib import Path

import pytest
import yaml
from bad_input import (
    BASE,
    COMMANDS,
    CONFIGS,
    MAPS,
    ROOT,
    SCHEMA,
    answer,
    answer_to_command,
    answer_to_config,
    answer_to_map,
    make_chain,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.cli import main as cli
from asperity.config.check import check, load_schema
from asperity.errors import ConfigError

TREE = load_schema(SCHEMA)
PAPER = yaml.safe_load(Path(BASE).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return make_chain(tmp_path_factory.mktemp("chain"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder in which nothing is to appear."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def require_one_line(said, begin, line):
    assert said.startswith(begin)
    assert line in said
    assert said.endswith("\n")
    assert said[:-1].isprintable()
    assert len(said) < 500


def short(case):
    return repr(case)[:60]


@pytest.mark.parametrize(("content", "line"), CONFIGS, ids=short)
def test_a_bad_configuration_is_answered_with_key_value_and_range(folder, content, line):
    code, said = answer_to_config(content, folder)
    assert code == 1
    require_one_line(said, "config: ", line)
    assert os.listdir(folder) == ["overlay.yaml"]
    assert not (ROOT / "pwned").exists()


@pytest.mark.parametrize(("arguments", "expected", "line"), COMMANDS, ids=short)
def test_a_bad_command_line_is_answered_with_argument_and_range(files, folder, arguments, expected, line):
    before = {path: Path(path).read_bytes() for path in files.values()}
    code, said = answer_to_command(arguments, files, folder)
    assert code == expected
    require_one_line(said, "asperity: ", line)
    assert not os.listdir(folder)
    assert {path: Path(path).read_bytes() for path in files.values()} == before


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # files left open by the reader
@pytest.mark.parametrize(("name", "content", "options", "line"), MAPS, ids=short)
def test_a_bad_height_map_is_named(folder, name, content, options, line):
    pytest.importorskip("SurfaceTopography")
    code, said = answer_to_map(name, content, options, folder)
    assert code == 1
    require_one_line(said, "asperity: ", line)
    assert os.listdir(folder) == [name]


def test_there_are_many():
    assert len({*CONFIGS, *COMMANDS, *MAPS}) == len(CONFIGS) + len(COMMANDS) + len(MAPS) >= 180


plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.binary(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8) | st.integers(), inner, max_size=3)
    ),
    max_leaves=8,
)


def places(tree):
    """Every mapping of a configuration with each of its keys."""
    for key, value in tree.items():
        yield tree, key
        if isinstance(value, dict):
            yield from places(value)


def refusal(config):
    """What is said to a configuration; nothing if it is accepted."""
    try:
        check(config, TREE)
    except ConfigError as error:
        return str(error)
    return ""


@settings(max_examples=300, deadline=None)
@given(data=st.data(), value=plain)
def test_whatever_is_in_a_configuration_it_is_accepted_or_named(data, value):
    """Fuzz: a random value in place of a value anywhere, or under a new key beside it."""
    config = copy.deepcopy(PAPER)
    tree, key = data.draw(st.sampled_from(list(places(config))))
    tree[data.draw(st.just(key) | st.text(max_size=8))] = value
    found = refusal(config)
    assert found.isprintable()
    assert len(found) < 500


@settings(max_examples=150, deadline=None)
@given(data=st.data(), key=st.text(min_size=1, max_size=12))
def test_no_unknown_key_is_passed_over(data, key):
    config = copy.deepcopy(PAPER)
    tree, known = data.draw(st.sampled_from([*places(config), (config, "contact")]))
    where = tree[known] if isinstance(tree[known], dict) else tree
    new = key not in where
    where[key] = 1
    if new:
        assert refusal(config)


SPECTRUM = {"hurst": 0.8, "wavelength_long": 0.125, "wavelength_short": 0.03125}
SMALL_PLAN = {
    "accuracy": "draft",
    "surfaces": {"one": {**SPECTRUM, "rms_height": 1e-3, "points": 128}, "other": {**SPECTRUM}},
    "measured": {"map": {"file": "map.asc", "wavelength_short": 0.1}},
    "studies": {"hurst": ["one"], "kurtosis": ["one", "other"]},
    "seeds": [1, 2],
    "layer": {"height": 1.0, "poisson": 0.33, "half_space_tolerance": 0.05},
    "contact": {
        "area_fraction": 0.1,
        "path_area_fractions": [0.05, 0.1],
        "tolerance": 1e-6,
        "precision": "float64",
    },
    "stress": {"poisson": [0.0, 0.33], "tolerance": 1e-4, "depth_spacing": 0.5},
}
TARGETS = (
    "--error 0.1 --error 1e-9 --error -1 --error nan --seconds 10 --seconds 1e-300 --memory 1 --memory 1e300"
    " --area-fraction 0.1 --area-fraction 1e-300 --one-surface --output peak_depth --output none --output"
)
targets = st.sampled_from(re.findall(r"--\S+(?: [^-\s]\S*| -1)?", TARGETS))


def answer_to_plan(config, options):
    """What is said to ``asperity plan`` of a configuration and options."""
    text = config if isinstance(config, str) else yaml.safe_dump(config, allow_unicode=True)
    return answer(cli.main, ["plan", text, *" ".join(options).split()])


@settings(max_examples=300, deadline=None)
@given(data=st.data(), value=plain, options=st.lists(targets, max_size=3))
def test_whatever_is_to_be_planned_it_is_done_or_named(data, value, options):
    """Fuzz: a random value in place of one anywhere, in a spectrum or a configuration, or as the whole."""
    config = copy.deepcopy(data.draw(st.sampled_from([SPECTRUM, SMALL_PLAN])))
    tree, key = data.draw(st.sampled_from(list(places(config))))
    if data.draw(st.booleans()):
        tree[key] = value
    else:
        del tree[key]
    code, said = answer_to_plan(config, options)
    require_plan_or_line(code, said)


@settings(max_examples=100, deadline=None)
@given(text=st.text(max_size=12), options=st.lists(targets | st.text(max_size=4), max_size=3))
def test_whatever_is_given_as_a_plan_it_is_named(text, options):
    require_plan_or_line(*answer_to_plan(text, options))


def require_plan_or_line(code, said):
    assert code in (0, 1, 2)
    assert code == 0 or (said.startswith("asperity: ") and said[:-1].isprintable() and len(said) < 500), said


@settings(max_examples=60, deadline=None)
@given(content=st.binary(max_size=60) | st.text(max_size=60).map(str.encode))
def test_whatever_is_in_an_overlay_it_is_accepted_or_named(tmp_path_factory, content):
    code, said = answer_to_config(content, tmp_path_factory.mktemp("overlay"))
    assert code in (0, 1)
    assert code == 0 or said[:-1].isprintable()


WORDS = (
    "solve stress peaks plot plan --contact --path --poisson --points --periodic --help --version mirrored nan"
    " -1 0.1 9 -- - = {surface} {contact} {stress} {statistics} {folder} {folder}/none.nc"
)
words = st.sampled_from(WORDS.split()) | st.text(max_size=6)


@settings(max_examples=200, deadline=None)
@given(arguments=st.lists(words, max_size=7))
def test_whatever_is_on_the_command_line_it_is_done_or_named(files, tmp_path_factory, arguments):
    """Fuzz: the words of the command line in any order, among others; no command is carried out."""
    folder = tmp_path_factory.mktemp("commands")
    filled = [part.format(folder=folder, **files) if part.startswith("{") else part for part in arguments]
    code, said = answer(cli.main, [part for part in filled if part != "--out"])
    assert code in (0, 1, 2)
    assert code == 0 or (said.startswith("asperity: ") and said[:-1].isprintable())
