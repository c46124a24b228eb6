"""The configuration: what is accepted, and the one line for what is not."""

import contextlib
import copy
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.config import ConfigError, check, describe, load_schema

ROOT = Path(__file__).parents[2]
SCHEMA = load_schema(ROOT / "workflow/schemas/config.schema.yaml")
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())


def merged(base, overlay):
    """What Snakemake makes of two configuration files."""
    if not (isinstance(base, dict) and isinstance(overlay, dict)):
        return copy.deepcopy(overlay)
    return {
        key: merged(base.get(key), overlay[key]) if key in overlay else base[key]
        for key in {**base, **overlay}
    }


@pytest.mark.parametrize("overlay", sorted((ROOT / "config").glob("*.yaml")), ids=lambda path: path.name)
def test_the_committed_configurations_are_accepted(overlay):
    check(merged(PAPER, yaml.safe_load(overlay.read_text())), SCHEMA)


def test_the_readme_lists_the_keys_of_the_schema():
    table = (ROOT / "config/README.md").read_text().split("<!-- keys: ")[1].split("-->\n")[1]
    assert table.strip() == describe(SCHEMA)


BAD = [
    ("contact: {tolerance: 1e-6}", "contact.tolerance = '1e-6': a number ≥ 1e-14 and ≤ 0.01 is needed (YAML"),
    ("contact: {tolerance: 0}", "contact.tolerance = 0: a number ≥ 1e-14 and ≤ 0.01"),
    ("contact: {tolerance: .nan}", "contact.tolerance = nan: a finite number"),
    ("contact: {area_fraction: .inf}", "contact.area_fraction = inf: a finite number"),
    ("contact: {area_fraction: 10}", "contact.area_fraction = 10: a number > 0 and ≤ 1"),
    ("contact: {area_fraction: ten percent}", "contact.area_fraction = 'ten percent': a number"),
    ("contact: {area: 0.1}", "contact.area: unknown key; known here are method, area_fraction"),
    ("contact: {method: magic}", "contact.method = 'magic': gfmd or active_set"),
    ("contact: {precision: 64}", "contact.precision = 64: float64 or float32"),
    ("contact: {path_area_fractions: []}", "contact.path_area_fractions = []: a list of ≥ 1"),
    ("contact: {path_area_fractions: [0.1, 0.05]}", "contact.path_area_fractions = [0.1, 0.05]: rising"),
    ("contact: {path_area_fractions: [0.1, 2]}", "contact.path_area_fractions.1 = 2"),
    ("contact: null", "contact = None: a group of keys"),
    ("contact: 3", "contact = 3: a group of keys"),
    ("seeds: []", "seeds = []: a list of ≥ 1"),
    ("seeds: [1, 1]", "seeds = [1, 1]: a list of ≥ 1 distinct items"),
    ("seeds: [-1]", "seeds.0 = -1: a whole number"),
    ("seeds: [1.5]", "seeds.0 = 1.5: a whole number"),
    ("seeds: 1", "seeds = 1: a list"),
    ("sedes: [1]", "sedes: unknown key"),
    ("results: ../elsewhere", "results = '../elsewhere': `results` or a folder below it"),
    ("results: /etc", "results = '/etc'"),
    ("results: results/../..", "results = 'results/../..'"),
    ("surfaces: {hurst_02: {hurst: -0.1}}", "surfaces.hurst_02.hurst = -0.1: a number ≥ 0 and ≤ 1"),
    ("surfaces: {hurst_02: {hurst: true}}", "surfaces.hurst_02.hurst = True: a number"),
    ("surfaces: {hurst_02: {points: 2048.5}}", "surfaces.hurst_02.points = 2048.5: a whole number"),
    ("surfaces: {hurst_02: {points: 256}}", "surfaces.hurst_02.points = 256: at least 512 are needed"),
    ("surfaces: {hurst_02: {points: 1000000}}", "surfaces.hurst_02.points = 1000000"),
    (
        "surfaces: {hurst_02: {wavelength_short: 0.5}}",
        "wavelength_short = 0.5: at most wavelength_long = 0.125",
    ),
    ("surfaces: {hurst_02: {rms_height: 0}}", "surfaces.hurst_02.rms_height = 0: a number > 0"),
    ("surfaces: {hurst_02: {label: ''}}", "surfaces.hurst_02.label = ''"),
    ("surfaces: {'H=0.2': {hurst: 0.2}}", "'H=0.2' as a name"),
    ("surfaces: {new: {hurst: 0.2}}", "surfaces.new.label: missing; text of 1 to 60 characters is needed"),
    ("surfaces: {1: {hurst: 0.2}}", "surfaces.1: a key that is text"),
    ("surfaces: {hurst_02: {johnson: {gamma: 1}}}", "surfaces.hurst_02.johnson.delta: missing; a number > 0"),
    ("studies: {hurst: [unknown]}", "studies.hurst = 'unknown': the name of a surface is needed (hurst_02"),
    (
        "surfaces: {skew_positive: {moments: {skewness: 0, kurtosis: 3}}}",
        "surfaces.skew_positive.moments: only one of moments and johnson is accepted",
    ),
    (
        "surfaces: {kurtosis_low: {moments: {skewness: 2}}}",
        "surfaces.kurtosis_low.moments.kurtosis = 2.4: a number > 5, 1 + skewness², is needed",
    ),
    (
        "measured: {fault: {periodic: maybe}}",
        "measured.fault.periodic = 'maybe': declared or mirrored or windowed",
    ),
    ("measured: {mine: {label: mine, detrend: tilt}}", "measured.mine.file: missing; text"),
    ("measured: {hurst_02: {label: a, file: b, detrend: none}}", "measured.hurst_02: another name is needed"),
    (
        "studies: {compressibility: [hurst_02, hurst_08]}",
        "studies.compressibility = ['hurst_02', 'hurst_08']: a",
    ),
    ("studies: {kurtosis: []}", "studies.kurtosis = []: a list of ≥ 1"),
    ("layer: {poisson: 0.51}", "layer.poisson = 0.51: a number > -1 and ≤ 0.5"),
    ("layer: {poisson: 0.4}", "layer.poisson = 0.4 must be one of them"),
    ("layer: {height: 0}", "layer.height = 0: a number > 0"),
    ("layer: {bottom: glued}", "layer.bottom = 'glued': bonded or frictionless"),
    ("body: {poisson: [0.33, 0.33]}", "body.poisson = [0.33, 0.33]: a list of ≥ 1 and ≤ 16 distinct items"),
    ("body: {depth_spacing: 100}", "body.depth_spacing = 100"),
    ("statistics: {bins: 1}", "statistics.bins = 1: a whole number ≥ 2"),
    ("statistics: {confidence: 95}", "statistics.confidence = 95: a number > 0 and < 1"),
]


@pytest.mark.parametrize(("overlay", "line"), BAD, ids=[overlay for overlay, _ in BAD])
def test_a_bad_configuration_gives_one_line_with_key_value_and_range(overlay, line):
    with pytest.raises(ConfigError) as caught:
        check(merged(PAPER, yaml.safe_load(overlay)), SCHEMA)
    message = str(caught.value)
    assert line in message
    assert "\n" not in message
    assert len(message) < 300


plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8) | st.integers(), inner, max_size=3)
    ),
    max_leaves=8,
)


@settings(max_examples=200, deadline=None)
@given(section=st.sampled_from(sorted(PAPER)), value=plain, data=st.data())
def test_whatever_is_in_a_configuration_it_is_accepted_or_named(section, value, data):
    """Fuzz: a random value in place of a section or of one of its keys."""
    config = copy.deepcopy(PAPER)
    if isinstance(config[section], dict) and data.draw(st.booleans()):
        config[section][data.draw(st.sampled_from(sorted(config[section])))] = value
    else:
        config[section] = value
    with contextlib.suppress(ConfigError):
        check(config, SCHEMA)
