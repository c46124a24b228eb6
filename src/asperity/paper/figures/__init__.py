"""The figures, one module for each kind of drawing.

A module has a table ``FIGURES``, and two functions with the same arguments, ``draw`` (returns a
`matplotlib.figure.Figure`) and ``caption`` (returns reStructuredText). An entry of the table describes a
figure by the fields of `Description`. The arguments of the functions are the results of the stages that it
needs, and its options.

The tables are read from the sources, without importing the modules: libraries for plotting take a second to
import, and the workflow asks in every job which files its figures need.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Description:
    """A figure and what it needs.

    Parameters
    ----------
    name : str
        Of the figure and its files; with ``_study`` in the supplement.
    module : str
        In which it is drawn.
    title : str
        First line of the caption, by default that of the module's docstring, without the number.
    number : int, optional
        Of the figure in the paper.
    stages : tuple of str
        Stages whose results are drawn.
    studies : tuple of str
        Studies of the configuration that are shown. With one study an argument maps surfaces to datasets,
        with several it maps studies to such mappings.
    supplement : tuple of str
        Further studies of which the figure is drawn; for study ``moments``, ``fig09_moments``.
    own : str
        Name of the figure for a user's own study; of study ``steel`` it is ``peaks_steel``.
    several_ratios : bool
        True for a figure of one surface at several Poisson's ratios.
    datasets : tuple of str
        Datasets of stage validation that are drawn, in place of studies.
    cost : str
        Line of the table of costs from which time and memory are estimated.
    options : mapping
        Arguments of ``draw`` and ``caption``.
    category : str
        Heading under which the report lists the figure.
    """

    name: str
    module: str
    title: str
    number: int | None
    stages: tuple[str, ...]
    studies: tuple[str, ...] = ()
    supplement: tuple[str, ...] = ()
    own: str = ""
    several_ratios: bool = False
    datasets: tuple[str, ...] = ()
    cost: str = "figure"
    options: Mapping[str, Any] = field(default_factory=dict)
    category: str = "Supplement"

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


@cache
def known() -> dict[str, Description]:
    """Descriptions of the figures of all modules by name."""
    found = {}
    for path in sorted(Path(__file__).parent.glob("*.py")):
        module = ast.parse(path.read_text(encoding="utf-8"))
        title = (ast.get_docstring(module) or "").splitlines()[0]
        for node in module.body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "FIGURES":
                for name, entry in ast.literal_eval(node.value).items():
                    text = entry.pop("title", re.sub(r"^Figure \d+: ", "", title))
                    number = re.fullmatch(r"fig(\d+)", name)
                    found[name] = Description(name, path.stem, text, number and int(number[1]), **entry)
    return {name: found[name] for name in sorted(found)}


def figures_of(config: Mapping[str, Any]) -> dict[str, Description]:
    """Figures of a complete configuration by name: of the paper, of the validation, supplement, own studies.

    A study without surfaces has no figures. If ``figures`` is ``own``, studies with the names of the paper's
    have figures of their own, too.
    """
    figures, studies = known().values(), config["studies"]
    datasets = set(config["validation"])
    filled = [study for study, surfaces in studies.items() if surfaces]
    of_paper = {study for one in figures for study in (*one.studies, *one.supplement)}
    if config["figures"] != "paper":
        of_paper = set()
    several_ratios = len(config["stress"]["poisson"]) > 1
    found = []
    for one in figures:
        needed = bool(one.studies or one.datasets)
        if needed and set(one.studies) <= of_paper.intersection(filled) and set(one.datasets) <= datasets:
            found.append(replace(one, category="Figures of the paper" if one.number else "Supplement"))
        for study in filled:
            if study in of_paper:
                if study in one.supplement:
                    found.append(replace(one, name=f"{one.name}_{study}", studies=(study,)))
            elif one.own and (not one.several_ratios or (several_ratios and len(studies[study]) == 1)):
                name = f"{one.own}_{study}"
                found.append(replace(one, name=name, number=None, studies=(study,), category="Figures"))
    return {one.name: one for one in found}


def surfaces_with_contact(config: Mapping[str, Any]) -> set[str]:
    """Surfaces of which a figure shows the contact: these need the load-area curve."""
    figures = [one for one in figures_of(config).values() if "contact" in one.stages]
    return {name for figure in figures for study in figure.studies for name in config["studies"][study]}


def draw(figure: Description, results: Mapping[str, Any]) -> Any:
    """Draw a figure from its results: `Description.results`, with a dataset in place of each path.

    Returns
    -------
    matplotlib.figure.Figure
    """
    return import_module(f"{__name__}.{figure.module}").draw(**results, **figure.options)


def caption(figure: Description, results: Mapping[str, Any]) -> str:
    """Caption of a figure in reStructuredText: its title, and numbers taken from the results."""
    text = import_module(f"{__name__}.{figure.module}").caption(**results, **figure.options)
    title = f"Figure {figure.number}: {figure.title}" if figure.number else figure.title
    return f"{title[0].upper()}{title[1:]}\n\n{text}\n"
