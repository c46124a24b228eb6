"""What a plan is made for: configurations, overlays or a spectrum, as `asperity plan` is given them.

The schema of the study stays with its workflow; here is checked what a plan reads, and that nothing is
given that has no meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from asperity.accuracy.evaluation import Scene, scene_of
from asperity.config.presets import PRESETS, Knobs, complete, knobs_of
from asperity.config.reader import load, merged, parse
from asperity.errors import ConfigError, shown

MOST_POINTS = 32768


class _Rule(NamedTuple):
    """What a key accepts, in words and as a test."""

    accepted: str
    holds: Callable[[Any], bool]


def _number(accepted: str, holds: Callable[[float], bool]) -> _Rule:
    return _Rule(
        f"a number {accepted}",
        lambda value: isinstance(value, (int, float)) and not isinstance(value, bool) and holds(value),
    )


def _whole(low: int, high: int) -> _Rule:
    return _Rule(
        f"a whole number ≥ {low} and ≤ {high}",
        lambda value: isinstance(value, int) and not isinstance(value, bool) and low <= value <= high,
    )


def _one_of(*words: str) -> _Rule:
    return _Rule(" or ".join(words), lambda value: isinstance(value, str) and value in words)


def _list(rule: _Rule, fewest: int, most: int) -> _Rule:
    return _Rule(
        f"a list of {fewest} to {most} different values, each {rule.accepted},",
        lambda value: (
            isinstance(value, list)
            and fewest <= len(value) <= most
            and all(map(rule.holds, value))
            and len(set(value)) == len(value)
        ),
    )


_ANYTHING = _Rule("anything", lambda value: True)
_FRACTION = _number("> 0 and ≤ 1", lambda value: 0 < value <= 1)
_WAVELENGTH = _number("≥ 6e-05 and ≤ 1", lambda value: 6e-5 <= value <= 1)
_RATIO = _number("> -1 and ≤ 0.5", lambda value: -1 < value <= 0.5)

_SURFACE = {
    "label": _ANYTHING,
    "hurst": _number("≥ 0 and ≤ 1", lambda value: 0 <= value <= 1),
    "wavelength_long": _WAVELENGTH,
    "wavelength_short": _WAVELENGTH,
    "rms_height": _ANYTHING,
    "points": _whole(8, MOST_POINTS),
    "johnson": _ANYTHING,
    "moments": _ANYTHING,
}
_SECTIONS: dict[str, dict[str, _Rule]] = {
    "layer": {
        "height": _number("> 0 and ≤ 1000", lambda value: 0 < value <= 1000),
        "bottom": _one_of("bonded", "frictionless"),
        "poisson": _RATIO,
        "lateral": _one_of("confined", "free"),
        "half_space_tolerance": _number("≥ 0 and ≤ 1", lambda value: 0 <= value <= 1),
    },
    "contact": {
        "method": _one_of("active_set", "gfmd"),
        "area_fraction": _FRACTION,
        "path_area_fractions": _list(_FRACTION, 0, 1000),
        "tolerance": _number("≥ 1e-14 and ≤ 0.01", lambda value: 1e-14 <= value <= 1e-2),
        "precision": _one_of("float64", "float32"),
    },
    "stress": {
        "poisson": _list(_RATIO, 1, 16),
        "tolerance": _number("≥ 0 and ≤ 0.1", lambda value: 0 <= value <= 0.1),
        "depth_spacing": _number("≥ 0.05 and ≤ 4", lambda value: 0.05 <= value <= 4),
    },
}
_TOP = {
    "accuracy": _one_of(*PRESETS),
    "seeds": _list(_whole(0, 2**32 - 1), 1, 10**6),
    **dict.fromkeys(("results", "measured", "statistics", "validation", "tradeoff"), _ANYTHING),
}
_GROUPS = ("surfaces", "studies", *_SECTIONS)
_NEEDED = ("hurst", "wavelength_long", "wavelength_short")


def read(given: Sequence[str], area_fraction: float | None = None) -> dict[str, Any]:
    """The complete configuration that files or texts amount to, each laid over those before.

    Parameters
    ----------
    given : sequence of str
        Names of YAML files, or YAML itself: a configuration, or the keys of one surface.
    area_fraction : float, optional
        In place of that of the configuration.

    Raises
    ------
    ConfigError
        For the first that is no YAML, and the first key or value that is not accepted.
    """
    config: dict[str, Any] = {}
    for text in given:
        config = merged(config, _tree(text))
    if "surfaces" not in config:
        config = {"surfaces": {"surface": config}}
    config = {"accuracy": "paper", **config, "measured": {}}
    for group in _GROUPS:
        if not isinstance(config.setdefault(group, {}), Mapping):
            raise ConfigError(f"{group} = {shown(config[group])}: a group of keys is needed")
    config["contact"] = {"area_fraction": 0.1, "path_area_fractions": [], **config["contact"]}
    config["layer"] = {"height": 1.0, **config["layer"]}
    config["stress"] = {"poisson": [0.33], **config["stress"]}
    config["studies"] = {"hurst": [], **config["studies"]}
    if area_fraction is not None:
        config["contact"]["area_fraction"] = area_fraction
    _check(config)
    whole = complete(config)
    for name, surface in whole["surfaces"].items():
        _check_grid(f"surfaces.{name}", surface)
    return whole


def scenes(config: Mapping[str, Any]) -> tuple[dict[str, Scene], Knobs]:
    """The scenes of a complete configuration, and their settings.

    They are those that a study shows, or all if there is none; the settings are those of the coarsest.
    """
    shown_names = {name for names in config["studies"].values() for name in names}
    names = [name for name in config["surfaces"] if name in shown_names] or list(config["surfaces"])
    knobs = min((knobs_of(config, name) for name in names), key=lambda each: each.points_per_wavelength)
    return {name: scene_of(config, name) for name in names}, knobs


def _tree(text: str) -> dict[str, Any]:
    """The tree in a file, or in the text itself."""
    try:
        is_file = Path(text).is_file()
    except (OSError, ValueError):  # no name that a file could have
        is_file = False
    if is_file:
        return load(text)
    try:
        return parse(text, shown(text))
    except ConfigError as error:
        if ":" in text:
            raise
        raise ConfigError(
            f"{shown(text)}: a file, or keys and values such as '{{hurst: 0.8, ...}}', is needed"
        ) from error


def _check(config: Mapping[str, Any]) -> None:
    """Raise `ConfigError` for the first key or value that is not accepted."""
    _check_keys("", {key: value for key, value in config.items() if key not in _GROUPS}, _TOP)
    for section, rules in _SECTIONS.items():
        _check_keys(f"{section}.", config[section], rules)
    if not config["surfaces"]:
        raise ConfigError("surfaces = {}: at least one surface is needed")
    for name, surface in config["surfaces"].items():
        key = f"surfaces.{name if isinstance(name, str) else shown(name)}"
        if not isinstance(surface, Mapping):
            raise ConfigError(f"{key} = {shown(surface)}: a group of keys is needed")
        _check_keys(f"{key}.", {**dict.fromkeys(_NEEDED), **surface}, _SURFACE)
    for study, names in config["studies"].items():
        if not (isinstance(names, list) and all(isinstance(name, str) for name in names)):
            raise ConfigError(f"studies.{shown(study)} = {shown(names)}: a list of names is needed")


def _check_keys(group: str, given: Mapping[Any, Any], rules: Mapping[str, _Rule]) -> None:
    for key, value in given.items():
        if key not in rules:
            raise ConfigError(f"{group}{shown(key)}: unknown key; known here are {', '.join(rules)}")
        if not rules[key].holds(value):
            raise ConfigError(f"{group}{key} = {shown(value)}: {rules[key].accepted} is needed")


def _check_grid(key: str, surface: Mapping[str, Any]) -> None:
    short, long, points = (surface[name] for name in ("wavelength_short", "wavelength_long", "points"))
    if short > long:
        raise ConfigError(f"{key}.wavelength_short = {short!r}: at most wavelength_long = {long!r} is needed")
    if short * points < 2 - 1e-9 or points > MOST_POINTS:
        raise ConfigError(
            f"{key}.points = {points}: at least two on wavelength_short = {short!r} are needed, and at most "
            f"{MOST_POINTS} in all"
        )
