"""Options of ``asperity run`` and the settings that they are."""

from __future__ import annotations

from typing import Any, NamedTuple


class Option(NamedTuple):
    """An option of the command.

    Parameters
    ----------
    flag : str
        Such as ``--young``.
    key : str
        Dotted key of the setting.
    group : "body", "load", "map", "counter" or "stress"
        Heading of the help under which it stands.
    shown : dict
        Arguments of `argparse` in place of what the schema says.
    left_out : str, optional
        What holds without the option, if the schema does not say it.
    """

    flag: str
    key: str
    group: str
    shown: dict[str, Any]
    left_out: str | None = None


def _option(name: str, group: str, placeholder: str | tuple[str, str] | None = None, **more: Any) -> Option:
    shown = {} if placeholder is None else {"metavar": placeholder}
    return Option(f"--{name.replace('_', '-')}", f"engineering.{name}", group, shown | more)


def _map_option(name: str, left_out: str | None = None) -> Option:
    return Option(f"--{name.replace('_', '-')}", f"measured.NAME.{name}", "map", {}, left_out)


RUN_OPTIONS = (
    _option("young", "body", "PRESSURE"),
    _option("poisson", "body"),
    _option("yield", "body", "PRESSURE"),
    _option("layer_height", "body", "LENGTH"),
    _option("bottom", "body"),
    _option("counter_young", "body", "PRESSURE"),
    _option("counter_poisson", "body"),
    _option("counter_yield", "body", "PRESSURE"),
    _option("counter_layer_height", "body", "LENGTH"),
    _option("counter_bottom", "body"),
    _option("pressure", "load", "PRESSURE"),
    _option("force", "load", "FORCE"),
    _option("approach", "load", "LENGTH"),
    _option("area_fraction", "load"),
    _option("friction", "load"),
    _option("sliding_direction", "load", "DIRECTION"),
    _option("boundary", "map"),
    _option("radius", "map", "LENGTH"),
    _option("form", "map"),
    _option("cylinder_axis", "map"),
    _option("counter_map", "counter", "FILE"),
    _option("counter_turned_about", "counter"),
    _option("counter_shift", "counter", ("Y", "X"), nargs=2),
    _option("fields", "stress", "FIELD", nargs="+"),
    _option("physical_size", "map", ("Y", "X"), nargs=2),
    _option("wavelength_short", "map", "LENGTH"),
)
"""Options that are settings of section ``engineering``."""

RUN_MAP_OPTIONS = (
    _map_option("unit"),
    _map_option("channel"),
    _map_option("orientation"),
    _map_option("height_factor"),
    _map_option("despike"),
    _map_option("detrend", "tilt"),
    _map_option("periodic", "mirrored, unless the file calls itself periodic or the boundary is free"),
    _map_option("points", "those of the map"),
    _map_option("max_memory"),
)
"""Options that are settings of a measured map of the study."""
