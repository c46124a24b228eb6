"""``asperity info``: description of a height map before a calculation."""

import argparse

from asperity.cli.commands.run import FLAGS
from asperity.cli.parser import flag, section
from asperity.core.errors import one_line
from asperity.settings.map import MapOptions
from asperity.surface.description import describe_map
from asperity.surface.reading.height_map import MapError


def run(options: argparse.Namespace) -> None:
    """Print the description of a height map, and the options that a calculation needs."""
    try:
        found = describe_map(options.map, MapOptions(**section(options, "measured.NAME")))
    except MapError as error:
        raise error.renamed(flag) from error
    width = max(map(len, found.properties)) + 2
    for name, text in found.properties.items():
        print(f"{name + ':':<{width}}{one_line(text)}")
    chosen = "asperity run takes peaks as upward, fills points without data and mirrors the map by itself; "
    chosen += "asperity solve and a study need"
    lists = {"look at": found.warnings, "every calculation needs": found.needed, chosen: found.choices}
    for heading, texts in lists.items():
        if texts:
            named = flag if texts is found.choices else _of_run
            print(heading, *(f"  {text}" for text in MapError("", texts).renamed(named).problems), sep="\n")
    if not found.needed and not found.choices:
        print("A calculation needs nothing else.")


def _of_run(name: str) -> str:
    """Option of ``asperity run`` for an option of a map; those without a flag are set by their key."""
    return flag(name) if f"map.{name}" in FLAGS else f"--set map.{name}=…"
