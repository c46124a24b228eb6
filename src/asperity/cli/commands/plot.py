"""``asperity plot``: a figure of the paper from result files."""

import argparse
from collections.abc import Mapping
from typing import Any

import xarray as xr

from asperity.cli.files import MAKERS, check_out, read_result, required
from asperity.cli.parser import section
from asperity.core.packages import require
from asperity.paper.figures import draw, known
from asperity.results import dataset
from asperity.results.variables import STUDY_UNITS
from asperity.views.style import require_picture, save, style

_OF_ONE_RATIO = (8, 9, 10, 11, 13, 17, 18)
"""Figures that show one Poisson's ratio."""


def run(options: argparse.Namespace) -> None:
    """Draw the figure and write it to all files."""
    require(("matplotlib",))
    check_out([("--out", path) for path in options.out], options.results)
    require_picture(*options.out)
    figure = f"figure {options.figure}"
    description = known()[f"fig{options.figure:02d}"]
    stages = description.stages
    if "validation" in stages:
        raise ValueError(f"{figure} is drawn from the validation of the study only")
    given: dict[str, dict[str, xr.Dataset]] = {}
    for path in options.results:
        stage, data = read_result(path, MAKERS)
        if (system := dataset.unit_system(data)) != STUDY_UNITS:
            needed = "a result in cell lengths, as of the study, is needed"
            raise ValueError(f"{path}: in {system} units; {needed}")
        results = given.setdefault(stage, {})
        name = dataset.settings_of(data)["name"]
        numbered = (f"{name} {number}" for number in range(2, len(results) + 3))
        results[next(free for free in (name, *numbered) if free not in results)] = data
    for stage in stages:
        if list(required(given, stage, figure)) != list(given[stages[0]]):
            raise ValueError(f"{figure}: the same surfaces are needed from each stage")
    shown: dict[str, Any] = {stage: given[stage] for stage in stages}
    if options.figure in _OF_ONE_RATIO:
        for name, data in shown["statistics"].items():
            data.attrs["poisson_contact"] = _ratio(figure, name, data, section(options, "layer"))
    if description.compares_studies:
        shown = {stage: {"given": results} for stage, results in shown.items()}
    with style():
        save(draw(description, shown), *options.out)


def _ratio(figure: str, name: str, data: xr.Dataset, chosen: Mapping[str, float]) -> float:
    """Poisson's ratio that a figure shows: the chosen one, or the ratio of the contact.

    The stress in a half-space may have been analysed at ratios other than the contact's.
    """
    ratio = chosen.get("poisson", data.attrs["poisson_contact"])
    analysed = data["poisson"].values.tolist()
    if ratio not in analysed:
        raise ValueError(
            f"{figure}: Poisson's ratio {ratio:g} is not in the statistics of {name}; "
            f"set --poisson to one of {', '.join(f'{nu:g}' for nu in analysed)}"
        )
    return ratio
