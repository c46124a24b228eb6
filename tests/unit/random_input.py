"""Random configurations, plans and command lines for hypothesis, and what every answer to them must fulfil.

Strategies make inputs, most of them wrong. A `require_…` function asserts that such an input is accepted or
answered with one line.
"""

import copy
import re
from pathlib import Path

import yaml
from bad_input import PAPER, answer, answer_to_config
from hypothesis import strategies as st

from asperity.cli import main as cli
from asperity.config.check import check
from asperity.errors import ConfigError

MAX_MESSAGE = 500
"""Characters of a message."""

CONFIGURATION = yaml.safe_load(Path(PAPER).read_text(encoding="utf-8"))
SPECTRUM = {"hurst": 0.8, "wavelength_long": 0.125, "wavelength_short": 0.03125}
PLAN = {
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
WORDS = (
    "solve stress peaks plot plan --contact --path --poisson --points --periodic --help --version mirrored"
    " nan -1 0.1 9 -- - = { % {surface} {contact} {stress} {statistics} {folder} {folder}/none.nc"
)

values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.binary(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8) | st.integers(), inner, max_size=3)
    ),
    max_leaves=8,
)
"""Any value that YAML can express."""

targets = st.sampled_from(re.findall(r"--\S+(?: [^-\s]\S*| -1)?", TARGETS))
overlays = st.binary(max_size=60) | st.text(max_size=60).map(str.encode)
command_lines = st.lists(st.sampled_from(WORDS.split()) | st.text(max_size=6), max_size=7)
"""Words of the command line in any order, among others; ``{surface}`` and the like stand for files."""


@st.composite
def configurations(draw):
    """The paper's configuration with a random value at a random place, under its key or a new one."""
    config = copy.deepcopy(CONFIGURATION)
    group, key = draw(st.sampled_from(list(_places(config))))
    group[draw(st.just(key) | st.text(max_size=8))] = draw(values)
    return config


@st.composite
def unknown_keys(draw):
    """The paper's configuration with a key that does not exist, in a random group."""
    config = copy.deepcopy(CONFIGURATION)
    groups = [config, *(group[key] for group, key in _places(config) if isinstance(group[key], dict))]
    closed = [group for group in groups if group not in (config["surfaces"], config["measured"])]
    group = draw(st.sampled_from(closed))
    group[draw(st.text(min_size=1, max_size=12).filter(lambda key: key not in group))] = 1
    return config


@st.composite
def plans(draw):
    """A spectrum or a configuration with a random value somewhere, or without one of its keys."""
    config = copy.deepcopy(draw(st.sampled_from([SPECTRUM, PLAN])))
    group, key = draw(st.sampled_from(list(_places(config))))
    if draw(st.booleans()):
        group[key] = draw(values)
    else:
        del group[key]
    return yaml.safe_dump(config, allow_unicode=True)


def _places(tree):
    """Every group of keys in a configuration, with each of its keys."""
    for key, value in tree.items():
        yield tree, key
        if isinstance(value, dict):
            yield from _places(value)


def refusal(config):
    """Message for a configuration that is refused; empty if it is accepted."""
    try:
        check(config)
    except ConfigError as error:
        return str(error)
    return ""


def require_checked(config):
    """The configuration is accepted or refused with one line."""
    message = refusal(config)
    assert message.isprintable()
    assert len(message) < MAX_MESSAGE


def require_overlay_checked(content, folder):
    """The content of an overlay is accepted or refused with one line."""
    code, said = answer_to_config(content, folder)
    assert code in (0, 1)
    assert code == 0 or said[:-1].isprintable()


def require_planned(text, options):
    """``asperity plan`` makes a plan or answers with one line."""
    _require_answer(*answer(cli.main, ["plan", text, *" ".join(options).split()]))


def require_answered(words, files, folder):
    """The command line is carried out or answered with one line; nothing is written without ``--out``."""
    names = {f"{{{name}}}": path for name, path in {**files, "folder": str(folder)}.items()}
    names["{folder}/none.nc"] = f"{folder}/none.nc"
    arguments = [names.get(word, word) for word in words if word != "--out"]
    _require_answer(*answer(cli.main, arguments))


def _require_answer(code, said):
    assert code in (0, 1, 2)
    if code:
        assert said.startswith("asperity: "), said
        assert said[:-1].isprintable()
        assert len(said) < MAX_MESSAGE
