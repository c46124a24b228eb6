"""Options for the engine of the Fourier transforms, which the commands that transform share."""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext

from asperity.cli.arguments import add_setting
from asperity.engines.choice import DEFAULT, VARIABLE, default_engine, engine_of, use

COMMANDS = ("run", "surface", "solve", "stress", "peaks", "view", "export")
"""Commands that compute Fourier transforms."""


def add_engine(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    group = parser.add_argument_group("Fourier transforms")
    add_setting(
        group,
        "--fft-engine",
        "fft_engine",
        left_out=f"the environment variable {VARIABLE}, else {DEFAULT}",
    )
    group.add_argument(
        "--fft-wisdom",
        metavar="FILE",
        help="measured plans of the engine pyfftw, made by asperity wisdom (default: estimated plans)",
    )


def chosen_engine(options: argparse.Namespace) -> AbstractContextManager[object]:
    """Block in which the engine of the options transforms."""
    name, wisdom = (getattr(options, option, None) for option in ("fft_engine", "fft_wisdom"))
    if not (name or wisdom):
        return nullcontext()
    return use(engine_of(name or default_engine(), wisdom, "--fft-wisdom"))
