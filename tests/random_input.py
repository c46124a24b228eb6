"""Random configurations and command lines for hypothesis, and what every answer to them must fulfil.

Strategies make inputs, most of them wrong. A `require_…` function asserts that such an input is accepted or
answered with one line for each problem.
"""

import contextlib
import copy
from pathlib import Path

import yaml
from bad_input import PAPER, answer
from hypothesis import strategies as st

from asperity.cli import main as cli
from asperity.core.errors import InputError
from asperity.settings.check import check

MAX_MESSAGE = 500
"""Characters of a message."""

CONFIGURATION = yaml.safe_load(Path(PAPER).read_text(encoding="utf-8"))
for surface in CONFIGURATION["surfaces"].values():
    surface["label"] = "plain"  # mathematics takes long to parse
COMMANDS = (
    "view {contact} plane depth=max --poisson 0.33 --out {folder}/x.png",
    "export {contact} {stress} --peaks {folder}/new.csv --field xx:0-0.1 {folder}/new.vti",
    "verify {contact}",
    "info {surface} --unit um",
    "run {surface} --young 70GPa --mean-pressure 1MPa --set map.points=8 --out {folder}/answer",
    "view --help",
    'plan {"hurst":0.8,"wavelength_long":0.125,"wavelength_short":0.01}',
)
VOCABULARY = """
    plan run info verify view export gap section plane peaks y=0.5 depth=max --young --set --periodic
    map.radius=1mm body.hardness= 1e-300 1e300 1e400 --material 100Cr6 --mean-pressure --case
    load_curve.loads=[1] --friction --counter-young 70GPa --physical-size --field --peaks --surface --profile
    --poisson --detrend --unit --help --version --out --contact-area-fraction --spacing --channel --missing
    --body upper --error --seconds --output mirrored declared windowed tilt none nan inf -1 0 0.1 0.33 0.5 1 3
    --hardness --save --counter-material --counter-map --sliding-direction 1GPa s.yaml
    9 16 24 -- - = % %s { float32 bonded von_mises {surface} {contact} {stress} {statistics} {folder}/none.nc
"""

values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.binary(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8) | st.integers(), inner, max_size=3)
    ),
    max_leaves=8,
)
"""Any value that YAML can express."""

overlays = st.binary(max_size=60) | st.text(max_size=60).map(str.encode)
# A word may become the name of a file that is written: none may lead out of the temporary folder.
inside = st.characters(exclude_characters="/\\~", exclude_categories=["Cs"])
edits = st.tuples(
    st.sampled_from(["insert", "replace", "delete"]),
    st.integers(0, 8),
    st.sampled_from(VOCABULARY.split()) | st.text(inside, max_size=6),
)


@st.composite
def command_lines(draw):
    """A command with some words inserted, replaced or deleted; ``{surface}`` and the like stand for files."""
    words = draw(st.sampled_from(COMMANDS)).split()
    for kind, position, word in draw(st.lists(edits, max_size=4)):
        end = position if kind == "insert" else position + 1
        words[position:end] = [] if kind == "delete" else [word]
    return words


@st.composite
def configurations(draw):
    """The paper's configuration with a random value at a random place, under its key or a new one."""
    config = copy.deepcopy(CONFIGURATION)
    group, key = draw(st.sampled_from(list(places(config))))
    group[draw(st.just(key) | st.text(max_size=8))] = draw(values)
    return config


@st.composite
def unknown_keys(draw):
    """The paper's configuration with a key that does not exist, in a random group."""
    config = copy.deepcopy(CONFIGURATION)
    groups = [config, *(group[key] for group, key in places(config) if isinstance(group[key], dict))]
    closed = [group for group in groups if group not in (config["surfaces"], config["measured"])]
    group = draw(st.sampled_from(closed))
    group[draw(st.text(min_size=1, max_size=12).filter(lambda key: key not in group))] = 1
    return config


def places(tree):
    """Every group of keys in a configuration, with each of its keys."""
    for key, value in tree.items():
        yield tree, key
        if isinstance(value, dict):
            yield from places(value)


def refusal(config):
    """Lines for a configuration that is refused; empty if it is accepted."""
    try:
        check(config)
    except InputError as error:
        return error.lines
    return ()


def require_checked(config):
    """The configuration is accepted, or refused with a line for each problem."""
    for line in refusal(config):
        assert line.isprintable()
        assert len(line) < MAX_MESSAGE


def require_answered(words, files, folder):
    """The command line is carried out or answered with one line."""
    for name, path in {**files, "folder": str(folder)}.items():
        words = [word.replace(f"{{{name}}}", path) for word in words]
    with contextlib.chdir(folder):
        code, said = answer(cli.main, words)
    assert code in (0, 1, 2)
    for line in said.splitlines() if code else ():
        assert line.startswith("asperity: "), said
        assert line.isprintable()
        assert len(line) < MAX_MESSAGE
