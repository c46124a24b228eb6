"""``asperity compare``: the comparison of answers and samples that exist, from their folders."""

import argparse
import os
import sys
from pathlib import Path

from asperity.cli.parser import WRONG_USAGE
from asperity.core.errors import fail, one_line


def run(options: argparse.Namespace) -> None:
    """Compare the answers or samples of folders, print the comparison, and write it."""
    from asperity.engineering.answer import opened
    from asperity.engineering.show.comparison import compared

    names = [os.path.normpath(path) for path in options.answers]
    if len(names) < 2:
        needed = "a folder; maps, case files or two or more folders are needed"
        sys.exit(fail(f"{options.answers[0]}: {needed}", WRONG_USAGE))
    comparison = compared(dict(zip(names, map(opened, names), strict=True)))
    folder = Path(options.out or "comparison")
    comparison.write(folder)
    print(comparison.text())
    print(f"\nreport  {one_line(str(folder / 'comparison.html'))}")
