"""The form of the page: texts of fields to a case and back, and its command line."""

import shlex

import pytest

from asperity.app import form
from asperity.app.session import _words
from asperity.cli.parser import FLAGS
from asperity.engineering.case import Case
from asperity.settings.model import SettingsError


def test_settings_that_are_switched_off_keep_their_texts_and_are_not_used():
    values = {
        "map.file": "a.x3p",
        "body.layers.0.thickness": "2 um",
        "load.force": "3 N",
        "leak.viscosity": "1",
    }
    assert form.content_of(values) == {"map": {"file": "a.x3p"}}
    values |= {"use.body.layers.0": "yes", "choose.load": "force", "use.leak": "yes"}
    assert form.content_of(values) == {
        "map": {"file": "a.x3p"},
        "body": {"layers": [{"thickness": "2 um"}]},
        "load": {"force": "3 N"},
        "leak": {"viscosity": 1.0},
    }


def test_layers_survive_the_form_and_those_below_an_unused_one_are_left_out():
    layers = [
        {"thickness": "2 um", "strength": {"shear": "300 MPa"}},
        {"thickness": "0.3 um"},
        {"thickness": "1 um"},
    ]
    steel = {"material": "100Cr6"}
    content = {"map": {"file": "a.x3p"}, "load": {"force": "3 N"}}
    content["body"] = steel | {"layers": [{"material": "chromium", **each} for each in layers]}
    values = form.values_of(content)
    assert form.content_of(values) == content
    del values["use.body.layers.1"]
    assert form.content_of(values)["body"]["layers"] == content["body"]["layers"][:1]
    content["body"]["layers"] *= 2
    with pytest.raises(SettingsError, match=r"body\.layers: the page holds at most 4"):
        form.values_of(content)


CONSTANTS = {"counter_body.young", "counter_body.poisson"}


@pytest.mark.parametrize(
    ("values", "missing"),
    [
        ({"choose.counter_body": "flat"}, set()),
        ({"choose.counter_body": "rigid map"}, {"counter_body.map.file"}),
        ({"choose.counter_body": "elastic"}, CONSTANTS),
        ({"choose.counter_body": "elastic map"}, CONSTANTS | {"counter_body.map.file"}),
        ({"choose.counter_body": "elastic map", "counter_body.map.file": "b.x3p"}, CONSTANTS),
        ({"choose.counter_body": "elastic", "counter_body.yield_stress": "1 GPa"}, CONSTANTS),
        ({"use.sliding": "yes", "sliding.direction": "y"}, {"sliding.friction"}),
    ],
)
def test_what_is_chosen_and_left_empty_is_demanded(values, missing):
    given = {"map": {"file": "a.x3p"}, "body": {"material": "100Cr6"}, "load": {"mean_pressure": "50 MPa"}}
    content = form.content_of(form.values_of(given) | values)
    found = []
    try:
        Case.read(content)
    except SettingsError as error:
        found = [each.key for each in error.found]
    assert set(found) == missing
    kind = values.get("choose.counter_body", "flat")
    again = {"choose.counter_body": "flat"} | form.values_of(content)
    assert again["choose.counter_body"] == kind
    assert form.content_of(again) == content


def test_every_setting_of_a_case_has_a_field():
    fields = {each.key for group in groups() for each in form.inputs(group)}
    others = {"map.file", "materials"}
    assert form.settings().keys() - fields - others == set()


def groups():
    """Groups of settings, as their keys name them."""
    return {key.rpartition(".")[0] for key in form.settings()}


def test_the_command_line_is_quoted_for_a_shell():
    name = "a map; rm -rf $HOME 'x'.x3p"
    content = {"map": {"file": name, "despike": 8.0}, "body": {"layers": [{"thickness": "2 um"}]}, "leak": {}}
    words = shlex.split(form.command_of(content, FLAGS))
    assert words[:4] == ["asperity", "run", name, "--despike"]
    assert words[5:] == ["--set", "body.layers.0.thickness=2 um", "--set", "leak={}"]


def test_a_group_of_a_case_file_that_is_none_is_named():
    with pytest.raises(SettingsError, match=r"load = 5: a group with one of .*\n.*leak = \[1\]"):
        form.values_of({"map": {"file": "a.x3p"}, "load": 5, "leak": [1]})


@pytest.mark.parametrize(
    ("message", "shown"),
    [
        ("body.layers.0.young: missing", "body, layer 1, Young's modulus: missing"),
        (
            "partial_slip: needs sliding.friction, above 0",
            "partial slip: needs sliding, friction, above 0",
        ),
        ("map.file = my_map.x3p: no such file", "map, file = my_map.x3p: no such file"),
    ],
)
def test_messages_have_words_in_place_of_keys(message, shown):
    assert _words(message) == shown
