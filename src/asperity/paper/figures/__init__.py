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
``DATASETS``
    Datasets of stage validation that are drawn, in place of studies.
``COST``
    Line of `asperity.accuracy.resources` from which time and memory are estimated, if not ``figure``.

This module reads the constants from the sources, without importing them: libraries for plotting take a second
to import, and the workflow asks in every job which files its figures need.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).parent
_CONSTANTS = ("STAGES", "STUDIES", "SUPPLEMENT", "DATASETS", "COST")


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
    """

    name: str
    module: str
    stages: tuple[str, ...]
    studies: tuple[str, ...] = ()
    datasets: tuple[str, ...] = ()
    cost: str = "figure"

    @property
    def number(self) -> str:
        """Number of the figure in the paper, with two digits; empty if the paper does not have it."""
        return self.module.removeprefix("fig") if self.module.startswith("fig") else ""

    @property
    def in_paper(self) -> bool:
        """True if the paper has this figure, of the same study."""
        return bool(self.number) and self.name == self.module

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


def describe_all(studies: Mapping[str, Sequence[str]]) -> dict[str, Description]:
    """Descriptions of all figures by name: those of the paper, of the validation, and the supplement.

    Parameters
    ----------
    studies : mapping
        Section ``studies`` of the configuration. A study without surfaces has no supplement.
    """
    found = [describe(module) for module in modules()]
    supplement = [
        replace(one, name=f"{one.module}_{study}", studies=(study,))
        for one in found
        for study in _constants(one.module).get("SUPPLEMENT", ())
        if studies[study]
    ]
    return {one.name: one for one in (*found, *supplement)}


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


def caption(module: str, results: Mapping[str, Any]) -> str:
    """Caption of the figure of a module in reStructuredText: its title, and numbers taken from the results.

    The arguments are those of `draw`.
    """
    figure = import_module(f"{__name__}.{module}")
    assert figure.__doc__ is not None
    return f"{figure.__doc__.splitlines()[0]}\n\n{figure.caption(**results)}\n"


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
