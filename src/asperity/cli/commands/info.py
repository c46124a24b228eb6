"""``asperity info``: what a height map is, before anything is computed with it."""

from __future__ import annotations

import argparse

from asperity.cli.arguments import flag, section
from asperity.surface.description import describe_map
from asperity.surface.reading import Reading


def run(options: argparse.Namespace) -> None:
    """Print the description of a height map."""
    given = Reading(**section(options, "measured.NAME"))
    print("\n".join(describe_map(options.map, given, option=flag).lines()))
