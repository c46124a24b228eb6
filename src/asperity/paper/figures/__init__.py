"""The figures, one module each: its drawing, its caption, and the results it needs.

The module of a figure has a title in the first line of its docstring, two functions with the same
arguments, ``draw`` (returns a `matplotlib.figure.Figure`) and ``caption`` (returns reStructuredText), and
these constants:

``STAGES``
    Stages whose results are drawn: the arguments of the two functions.
``STUDIES``
    Studies of the configuration that are shown. With one study an argument maps surfaces to datasets, with
    several it maps studies to such mappings.
``SUPPLEMENT``
    Further studies of which the figure is drawn; for study ``moments`` ``fig09`` becomes ``fig09_moments``.
``OWN``
    Name of the figure for a user's own study; of study ``steel`` it is ``peaks_steel``.
``SEVERAL_RATIOS``
    True for a figure of one surface at several Poisson's ratios.
``DATASETS``
    Datasets of stage validation that are drawn, in place of studies.
``COST``
    Line of `asperity.accuracy.resources` from which time and memory are estimated, if not ``figure``.

This module reads the constants from the sources, without importing them: libraries for plotting take a second
to import, and the workflow asks in every job which files its figures need.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).parent
_CONSTANTS = ("STAGES", "STUDIES", "SUPPLEMENT", "OWN", "SEVERAL_RATIOS", "DATASETS", "COST")


@dataclass(frozen=True)
class Description:
    """A figure and what it needs; see the constants of the modules.

    Parameters
    ----------
    name : str
        Of the figure and its files: that of the module, with ``_study`` in the supplement.
    module : str
    stages, studies, datasets : tuples of str
    cost : str
    own : bool
        True for a figure of a user's own study, which has no number.
    """

    name: str
    module: str
    stages: tuple[str, ...]
    studies: tuple[str, ...] = ()
    datasets: tuple[str, ...] = ()
    cost: str = "figure"
    own: bool = False

    @property
    def number(self) -> str:
        """Number of the figure in the paper, with two digits; empty if the paper does not have it."""
        return self.module.removeprefix("fig") if self.module.startswith("fig") and not self.own else ""

    @property
    def in_paper(self) -> bool:
        """True if the paper has this figure, of the same study."""
        return bool(self.number) and self.name == self.module

    @property
    def category(self) -> str:
        """Heading under which the report lists the figure."""
        if self.own:
            return "Figures"
        return "Figures of the paper" if self.in_paper else "Supplement"

    def surfaces(self, studies: Mapping[str, Sequence[str]], stage: str) -> set[str]:
        """Surfaces of which the figure shows the result of a stage."""
        if stage not in self.stages:
            return set()
        return {name for study in self.studies for name in studies[study]}

    @property
    def compares_studies(self) -> bool:
        """True if the results are given by study and surface, instead of by surface alone."""
        return len(self.studies) > 1

    def results(
        self, studies: Mapping[str, Sequence[str]], path: Callable[[str, str], Any]
    ) -> dict[str, dict[str, Any]]:
        """The results that the figure is drawn from: stage → (study →) surface or dataset → path.

        Parameters
        ----------
        studies : mapping
            Section ``studies`` of the configuration: study → names of its surfaces.
        path : callable
            Stage and surface, or ``validation`` and dataset → what stands for the result.
        """
        if self.datasets:
            return {stage: {name: path(stage, name) for name in self.datasets} for stage in self.stages}
        tree = {
            stage: {study: {name: path(stage, name) for name in studies[study]} for study in self.studies}
            for stage in self.stages
        }
        if self.compares_studies:
            return tree
        return {stage: of_study for stage, by_study in tree.items() for of_study in by_study.values()}


def describe(module: str) -> Description:
    """Description of the figure of one module, such as ``fig09``."""
    found = _constants(module)
    return Description(
        module,
        module,
        found["STAGES"],
        found.get("STUDIES", ()),
        found.get("DATASETS", ()),
        found.get("COST", "figure"),
    )


def describe_all(
    studies: Mapping[str, Sequence[str]],
    datasets: Collection[str] | None = None,
    *,
    paper: bool = True,
    several_ratios: bool = True,
) -> dict[str, Description]:
    """Descriptions of all figures by name: of the paper, of the validation, of the supplement, and own ones.

    Parameters
    ----------
    studies : mapping
        Section ``studies`` of the configuration. A study without surfaces has no figures.
    datasets : collection of str, optional
        Datasets of the validation that there are; by default all.
    paper : bool
        True if studies with the names of the paper's have the figures of the paper. Other studies have
        figures of their own.
    several_ratios : bool
        True if the stress is analysed at several Poisson's ratios.
    """
    known = [describe(module) for module in modules()]
    filled = [study for study, names in studies.items() if names]
    of_paper = paper_studies() if paper else set()

    def has_results(one: Description) -> bool:
        if one.datasets:
            return datasets is None or set(one.datasets) <= set(datasets)
        return bool(one.studies) and set(one.studies) <= of_paper.intersection(filled)

    numbered = [one for one in known if has_results(one)]
    supplement = [
        replace(one, name=f"{one.module}_{study}", studies=(study,))
        for one in known
        for study in _constants(one.module).get("SUPPLEMENT", ())
        if study in of_paper.intersection(filled)
    ]
    own = [
        replace(one, name=f"{constants['OWN']}_{study}", studies=(study,), own=True)
        for one in known
        if "OWN" in (constants := _constants(one.module))
        for study in filled
        if study not in of_paper
        and (not constants.get("SEVERAL_RATIOS") or (several_ratios and len(studies[study]) == 1))
    ]
    return {one.name: one for one in (*numbered, *supplement, *own)}


def figures_of(config: Mapping[str, Any]) -> dict[str, Description]:
    """Descriptions of the figures of a complete configuration, by name."""
    return describe_all(
        config["studies"],
        config["validation"],
        paper=config["figures"] == "paper",
        several_ratios=len(config["stress"]["poisson"]) > 1,
    )


def surfaces_with_contact(config: Mapping[str, Any]) -> set[str]:
    """Surfaces of which a figure shows the contact: these need the load-area curve."""
    figures = figures_of(config).values()
    return {name for figure in figures for name in figure.surfaces(config["studies"], "contact")}


@cache
def paper_studies() -> set[str]:
    """Names of the studies of the paper and its supplement."""
    found = [_constants(module) for module in modules()]
    return {study for one in found for key in ("STUDIES", "SUPPLEMENT") for study in one.get(key, ())}


def modules() -> list[str]:
    """Names of the modules that hold a figure."""
    return sorted(path.stem for path in _FOLDER.glob("*.py") if "STAGES" in _constants(path.stem))


def numbers() -> list[int]:
    """Numbers of the figures of the paper, rising."""
    return sorted(int(number) for number in (describe(module).number for module in modules()) if number)


def draw(module: str, results: Mapping[str, Any]) -> Any:
    """Draw the figure of a module.

    Parameters
    ----------
    module : str
    results : mapping
        As of `Description.results`, with a dataset in place of each path.

    Returns
    -------
    matplotlib.figure.Figure
    """
    return import_module(f"{__name__}.{module}").draw(**results)


def caption(module: str, results: Mapping[str, Any], *, numbered: bool = True) -> str:
    """Caption of the figure of a module in reStructuredText: its title, and numbers taken from the results.

    Parameters
    ----------
    module : str
    results : mapping
        As of `draw`.
    numbered : bool
        True if the title begins with the number of the figure in the paper.
    """
    figure = import_module(f"{__name__}.{module}")
    assert figure.__doc__ is not None
    title = figure.__doc__.splitlines()[0]
    if not numbered:
        title = re.sub(r"^Figure \d+: (\w)", lambda found: found[1].upper(), title)
    return f"{title}\n\n{figure.caption(**results)}\n"


@cache
def _constants(module: str) -> dict[str, Any]:
    """The constants of a module, from its source."""
    source = (_FOLDER / f"{module}.py").read_text(encoding="utf-8")
    return {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and node.targets[0].id in _CONSTANTS
    }
