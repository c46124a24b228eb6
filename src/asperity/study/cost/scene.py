"""Contacts whose cost and errors are measured and planned: from configurations or a spectrum."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from asperity.core.errors import ConfigError, shown
from asperity.study.config.check import check
from asperity.study.config.defaults import complete, imposed_load
from asperity.study.config.presets import AccuracySettings, accuracy_of
from asperity.study.config.reader import is_file, load, merged, parse
from asperity.study.config.schema import schema
from asperity.study.config.study import ALL_SURFACES, with_base
from asperity.study.stages.solid import solid

POISSON = 0.33
"""Poisson's ratio of the solid in contact, and of the stress whose errors are measured."""


@dataclass(frozen=True)
class Scene:
    """A contact to be calculated: random surface of the unit cell, solid, loads and Poisson's ratios.

    Parameters
    ----------
    hurst, wavelength_long, wavelength_short : float
        Power spectrum; wavelengths in cell lengths.
    area_fraction : float
        Contact area over the area of the cell at the load whose stress is analysed.
    seed : int
        Seed of the surface.
    rms_height : float
    layer_height : float
        Height of the elastic layer, which is bonded to a rigid base.
    loads : tuple of float
        Area fractions of further loads at which the contact is solved (load-area curve).
    poisson : tuple of float
        Poisson's ratios for which the stress is analysed; `evaluate` requires `POISSON` among them.
    """

    hurst: float
    wavelength_long: float
    wavelength_short: float
    area_fraction: float
    seed: int = 1
    rms_height: float = 1e-3
    layer_height: float = 1.0
    loads: tuple[float, ...] = ()
    poisson: tuple[float, ...] = (POISSON,)

    @property
    def number_of_loads(self) -> int:
        """Different area fractions at which the contact is solved."""
        return len({*self.loads, self.area_fraction})


def stage_settings(scene: Scene, accuracy: AccuracySettings) -> dict[str, Any]:
    """The sections of a configuration from which the stages calculate a scene."""
    return {
        "name": "tradeoff",
        "seed": scene.seed,
        "surface": {
            "hurst": scene.hurst,
            "wavelength_long": scene.wavelength_long,
            "wavelength_short": scene.wavelength_short,
            "rms_height": scene.rms_height,
            "points": accuracy.points(scene.wavelength_short),
        },
        "layer": {
            "height": scene.layer_height,
            "bottom": "bonded",
            "poisson": POISSON,
            "lateral": "confined",
            "half_space_tolerance": accuracy.half_space_tolerance,
        },
        "contact": {
            "method": "active_set",
            "area_fraction": scene.area_fraction,
            "path_area_fractions": list(scene.loads),
            "tolerance": accuracy.contact_tolerance,
            "precision": accuracy.precision,
        },
        "stress": {
            "poisson": list(scene.poisson),
            "tolerance": accuracy.depth_tolerance,
            "depth_spacing": accuracy.depth_spacing,
        },
    }


def solid_record(scene: Scene, accuracy: AccuracySettings) -> dict[str, Any]:
    """Record of the solid used for a scene, layer or half-space, as in the attributes of its contact file."""
    return solid(stage_settings(scene, accuracy)["layer"])[1]


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
    check(config)
    if not config.get("surfaces"):
        raise ConfigError("surfaces: missing; a plan needs at least one random surface")
    if area_fraction is not None:
        config = merged(config, {"contact": {"area_fraction": area_fraction}})
    whole = complete(config)
    whole.setdefault("studies", {ALL_SURFACES: list(whole["surfaces"])})
    return whole


def scene_of(config: Mapping[str, Any], name: str, load_area: bool) -> Scene:
    """The scene of an entry of ``surfaces`` in a complete configuration.

    With `load_area` its contact is solved at all loads of the load-area curve.
    """
    surface, contact = config["surfaces"][name], config["contact"]
    if "area_fraction" not in contact:
        load, value = imposed_load(contact)
        raise ConfigError(
            f"contact.{load} = {value!r}: area_fraction is needed in its place, for which costs and errors "
            "were measured"
        )
    return Scene(
        hurst=surface["hurst"],
        wavelength_long=surface["wavelength_long"],
        wavelength_short=surface["wavelength_short"],
        area_fraction=contact["area_fraction"],
        layer_height=config["layer"]["height"],
        loads=tuple(contact["path_area_fractions"] if load_area else ()),
        poisson=tuple(config["stress"]["poisson"]),
    )


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
