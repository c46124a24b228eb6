"""Wrong input is answered with one line; nothing in it is executed and nothing is written."""

import os
from pathlib import Path

import pytest
import random_input
from bad_input import CALLS, COMMANDS, CONFIGS, MAPS, ROOT, answer_to_command, answer_to_config
from hypothesis import given, settings

import asperity as asp
from asperity.results import dataset

few = settings(max_examples=20)
"""The same examples in every run; `make fuzz` draws new ones."""


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


@pytest.mark.parametrize(("content", "line"), CONFIGS)
def test_wrong_configuration_is_answered(folder, content, line):
    code, said = answer_to_config(content, folder)
    assert code == 1
    assert line in said
    for problem in said.splitlines(keepends=True):
        require_one_line(problem, "config: ", "")
    assert os.listdir(folder) == ["overlay.yaml"]
    assert not (ROOT / "pwned").exists()


@pytest.mark.parametrize(("arguments", "expected", "line"), COMMANDS)
def test_wrong_command_line_is_answered(chain, chain_in_si, folder, arguments, expected, line):
    files = chain | {"contact_in_si": chain_in_si["contact"]}
    before = {path: Path(path).read_bytes() for path in files.values()}
    code, said = answer_to_command(arguments, files, folder)
    assert code == expected
    require_one_line(said, "asperity: ", line.replace("{folder}", str(folder)))
    assert not os.listdir(folder)
    assert {path: Path(path).read_bytes() for path in files.values()} == before


# Its reader leaves files open.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(("name", "content", "options", "line"), MAPS)
def test_wrong_height_map_is_answered(folder, name, content, options, line):
    pytest.importorskip("SurfaceTopography")
    (folder / name).write_bytes(content)
    with pytest.raises(asp.MapError) as error:
        asp.prepare_map(name, **options)
    assert line in str(error.value)
    for problem in error.value.lines:
        require_one_line(f"{problem}\n", name, "")
    assert os.listdir(folder) == [name]


@pytest.mark.parametrize(("call", "line"), CALLS)
def test_wrong_call_is_answered(chain, folder, call, line):
    with pytest.raises((ValueError, TypeError, dataset.DatasetError)) as error:
        call(lambda stage: dataset.read(chain[stage]))
    require_one_line(f"{error.value}\n", "", line)
    assert not os.listdir(folder)


@few
@given(config=random_input.configurations())
def test_random_configuration_is_accepted_or_answered(config):
    random_input.require_checked(config)


@few
@given(config=random_input.unknown_keys())
def test_unknown_key_is_refused_in_every_group(config):
    assert random_input.refusal(config)


@few
@given(content=random_input.overlays)
def test_random_overlay_is_accepted_or_answered(tmp_path_factory, content):
    code, said = answer_to_config(content, tmp_path_factory.mktemp("overlay"))
    assert code in (0, 1)
    assert code == 0 or said[:-1].isprintable()


@few
@given(words=random_input.command_lines())
def test_random_command_line_is_answered(chain, tmp_path_factory, words):
    random_input.require_answered(words, chain, tmp_path_factory.mktemp("commands"))
