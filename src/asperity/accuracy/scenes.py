"""Scenes of `asperity plan`, from configurations, overlays or a spectrum."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from asperity.accuracy.evaluation import Scene, scene_of
from asperity.config.check import check
from asperity.config.defaults import complete
from asperity.config.presets import AccuracySettings, accuracy_of
from asperity.config.reader import is_file, load, merged, parse
from asperity.config.schema import schema
from asperity.config.study import ALL_SURFACES, with_base
from asperity.errors import ConfigError, shown

NEEDED = ("surfaces", "hurst", "wavelength_long", "wavelength_short", "skewness", "kurtosis")
"""Keys without a default that a plan needs; a study needs others too, such as labels."""


def read(given: Sequence[str], area_fraction: float | None = None) -> dict[str, Any]:
    """Complete configuration from files and YAML texts, each merged into those before.

    Parameters
    ----------
    given : sequence of str
        Names of YAML files, or YAML text: a configuration, an overlay, or the settings of one surface.
    area_fraction : float, optional
        Replaces that of the configuration.

    Raises
    ------
    ConfigError
        If a file or text is not YAML, or a setting is not accepted.
    """
    config: dict[str, Any] = {}
    for text in given:
        config = merged(config, _tree(text))
    if not config.keys() & {*schema()["properties"], *schema()["renamed"]}:
        config = {"surfaces": {"surface": config}}
    config = with_base(config)
    check(config, NEEDED)
    if not config.get("surfaces"):
        raise ConfigError("surfaces: missing; a plan needs at least one random surface")
    if area_fraction is not None:
        config = merged(config, {"contact": {"area_fraction": area_fraction}})
    whole = complete(config)
    whole.setdefault("studies", {ALL_SURFACES: list(whole["surfaces"])})
    return whole


def scenes(
    config: Mapping[str, Any], load_area: Collection[str]
) -> tuple[dict[str, Scene], AccuracySettings]:
    """Scenes of a complete configuration, and settings of accuracy.

    The scenes are the random surfaces of all studies, or all surfaces if no study names any. The settings are
    those of the surface with the fewest nodes per wavelength. A figure shows the load-area curves of the
    surfaces in `load_area`.
    """
    in_studies = {name for names in config["studies"].values() for name in names}
    names = [name for name in config["surfaces"] if name in in_studies] or list(config["surfaces"])
    settings = min((accuracy_of(config, name) for name in names), key=lambda each: each.points_per_wavelength)
    return {name: scene_of(config, name, name in load_area) for name in names}, settings


def _tree(text: str) -> dict[str, Any]:
    """Settings in a file, or in the text itself if there is no such file."""
    if is_file(text):
        return load(text)
    try:
        return parse(text, shown(text))
    except ConfigError as error:
        if ":" in text:
            raise
        raise ConfigError(
            f"{shown(text)}: a file, or keys and values such as '{{hurst: 0.8, ...}}', is needed"
        ) from error
