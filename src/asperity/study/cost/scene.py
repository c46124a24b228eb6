"""Contacts that are planned: from configurations, or from a spectrum."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from asperity.core.errors import ConfigError, shown
from asperity.study.config.check import check
from asperity.study.config.defaults import complete, contact_of, imposed_load
from asperity.study.config.presets import AccuracySettings, accuracy_of
from asperity.study.config.reader import is_file, load, merged, parse
from asperity.study.config.schema import schema
from asperity.study.config.study import ALL_SURFACES, with_base, with_loads


@dataclass(frozen=True)
class Scene:
    """A contact to be calculated.

    Parameters
    ----------
    hurst, wavelength_long, wavelength_short : float
        Power spectrum of the random surface; wavelengths in cell lengths.
    area_fraction : float
        Contact area over the area of the cell at the load whose stress is analysed.
    loads, ratios : int
        Number of loads at which the contact is solved, and of Poisson's ratios of its stress.
    """

    hurst: float
    wavelength_long: float
    wavelength_short: float
    area_fraction: float
    loads: int = 1
    ratios: int = 1


OF_NO_PLAN = {"label": "surface", "rms_height": 1e-3}
"""Settings of a random surface that a study needs and on which no plan depends."""


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
    surfaces = config.get("surfaces")
    if isinstance(surfaces, dict):
        both = {name: OF_NO_PLAN | given for name, given in surfaces.items() if isinstance(given, dict)}
        config["surfaces"] = surfaces | both
    config = with_loads(config)
    check(config)
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

    Raises
    ------
    ConfigError
        If another load than the area is imposed.
    """
    in_studies = {name for names in config["studies"].values() for name in names}
    names = [name for name in config["surfaces"] if name in in_studies] or list(config["surfaces"])
    found = {}
    for name in names:
        surface, contact = config["surfaces"][name], contact_of(config, name)
        kind, area = imposed_load(contact)
        if kind != "area_fraction":
            raise ConfigError(
                f"contact.{kind} = {area!r}: area_fraction is needed in its place, for which costs and "
                "errors were measured"
            )
        found[name] = Scene(
            hurst=surface["hurst"],
            wavelength_long=surface["wavelength_long"],
            wavelength_short=surface["wavelength_short"],
            area_fraction=area,
            loads=len({*contact["path_area_fractions"], area}) if name in load_area else 1,
            ratios=len(config["stress"]["poisson"]),
        )
    settings = min((accuracy_of(config, name) for name in names), key=lambda each: each.points_per_wavelength)
    return found, settings


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
