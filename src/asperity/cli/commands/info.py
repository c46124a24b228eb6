"""``asperity info``: description of a height map before a calculation."""

import argparse
from typing import Any

from asperity.cli.parser import FLAGS, flag
from asperity.core.errors import one_line
from asperity.settings.map import FileOptions, MapOptions
from asperity.settings.model import SettingsError, entry_of, scalar
from asperity.surface.description import describe_map
from asperity.surface.reading.container import maps_in
from asperity.surface.reading.height_map import MapError


def run(options: argparse.Namespace) -> None:
    """Print the description of a height map, or of each map of a container, and the options that it needs."""
    given: dict[str, Any] = {}
    for name in FileOptions.model_fields.keys() & vars(options).keys():
        if (text := getattr(options, name)) is not None:
            given[name] = scalar(text, entry_of(FileOptions, name))
    maps = maps_in(options.map)
    for path in maps:
        if len(maps) > 1:
            print(f"{one_line(path)}\n")
        _describe(path, given)
        if len(maps) > 1:
            print()


def _describe(path: str, given: dict[str, Any]) -> None:
    """Print the description of a map."""
    try:
        found = describe_map(path, MapOptions.read(given))
    except (MapError, SettingsError) as error:
        raise error.renamed(flag) from error
    width = max(map(len, found.properties)) + 2
    for name, text in found.properties.items():
        print(f"{name + ':':<{width}}{one_line(text)}")
    chosen = "asperity run takes peaks as upward, fills non-measured points and mirrors the map by itself; "
    chosen += "asp.prepare_map and a study need"
    lists = {
        "look at": [*map(str, found.doubts)],
        "every calculation needs": found.needed,
        chosen: found.choices,
    }

    def of_run(name: str) -> str:  # those without a flag are set by their key
        return flag(name) if f"map.{name}" in FLAGS else f"--set map.{name}=…"

    for heading, texts in lists.items():
        if texts:
            named = texts if texts is found.choices else MapError("", texts).renamed(of_run).problems
            print(heading, *(f"  {text}" for text in named), sep="\n")
    if not found.needed and not found.choices:
        print("A calculation needs nothing else.")
