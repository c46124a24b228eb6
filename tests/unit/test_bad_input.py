"""Wrong input is answered with one line; nothing in it is executed and nothing is written."""

import os
from pathlib import Path

import pytest
import random_input
from bad_input import (
    COMMANDS,
    CONFIGS,
    MAPS,
    ROOT,
    answer_to_command,
    answer_to_config,
    answer_to_map,
    make_chain,
)
from hypothesis import given, settings
from hypothesis import strategies as st

deterministic = settings(derandomize=True, database=None, deadline=None, max_examples=25)
"""The same examples in every run; `make fuzz` draws new ones."""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return make_chain(tmp_path_factory.mktemp("chain"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Working directory in which no file may appear."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def require_one_line(said, begin, line):
    assert said.startswith(begin)
    assert line in said
    assert said.endswith("\n")
    assert said[:-1].isprintable()
    assert len(said) < random_input.MAX_MESSAGE


def short(case):
    return ascii(case)[:60]


@pytest.mark.parametrize(("content", "line"), CONFIGS, ids=short)
def test_a_wrong_configuration_is_answered_with_key_value_and_range(folder, content, line):
    code, said = answer_to_config(content, folder)
    assert code == 1
    require_one_line(said, "config: ", line)
    assert os.listdir(folder) == ["overlay.yaml"]
    assert not (ROOT / "pwned").exists()


@pytest.mark.parametrize(("arguments", "expected", "line"), COMMANDS, ids=short)
def test_a_wrong_command_line_is_answered_with_argument_and_range(files, folder, arguments, expected, line):
    before = {path: Path(path).read_bytes() for path in files.values()}
    code, said = answer_to_command(arguments, files, folder)
    assert code == expected
    require_one_line(said, "asperity: ", line)
    assert not os.listdir(folder)
    assert {path: Path(path).read_bytes() for path in files.values()} == before


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # files that its reader leaves open
@pytest.mark.parametrize(("name", "content", "options", "line"), MAPS, ids=short)
def test_a_wrong_height_map_is_answered_with_its_name(folder, name, content, options, line):
    pytest.importorskip("SurfaceTopography")
    code, said = answer_to_map(name, content, options, folder)
    assert code == 1
    assert line in said
    for problem in said.splitlines(keepends=True):
        require_one_line(problem, "asperity: ", "")
        assert name in problem
    assert os.listdir(folder) == [name]


@deterministic
@given(config=random_input.configurations())
def test_a_random_value_in_a_configuration_is_accepted_or_answered(config):
    random_input.require_checked(config)


@deterministic
@given(config=random_input.unknown_keys())
def test_an_unknown_key_is_refused_in_every_group(config):
    assert random_input.refusal(config)


@deterministic
@given(content=random_input.overlays)
def test_a_random_overlay_is_accepted_or_answered(tmp_path_factory, content):
    random_input.require_overlay_checked(content, tmp_path_factory.mktemp("overlay"))


@deterministic
@given(
    text=random_input.plans() | st.text(max_size=12),
    options=st.lists(random_input.targets | st.text(max_size=4), max_size=3),
)
def test_a_random_plan_is_made_or_answered(text, options):
    random_input.require_planned(text, options)


@deterministic
@given(words=random_input.command_lines())
def test_a_random_command_line_is_answered(files, tmp_path_factory, words):
    random_input.require_answered(words, files, tmp_path_factory.mktemp("commands"))
