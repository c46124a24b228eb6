"""The figures, a module for each kind of results; `figures.yaml` lists them and the results that each needs.

A drawing is two functions of a module with the same arguments: ``draw_…`` returns a
`matplotlib.figure.Figure`, ``caption_…`` reStructuredText, or the items of a list in it. The arguments are
the results of the stages that the figure needs, and its options. A module is imported when its figure is
drawn: libraries for plotting take a second to import, and every job of the workflow imports this module
for the names of the files that figures need.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import import_module
from typing import Any

from asperity.core.data import packaged_yaml


@dataclass(frozen=True)
class Description:
    """A figure and the results that it needs.

    Parameters
    ----------
    name : str
        Of the figure and its files; with ``_study`` in the supplement.
    title : str
        First line of the caption, without the number.
    drawing : str
        Module and name of its two functions: ``peaks.decay`` names ``draw_decay`` and ``caption_decay``.
    stages : sequence of str
        Stages whose results are drawn.
    number : int, optional
        Of the figure in the paper.
    studies : sequence of str
        Studies of the configuration that are shown. With one study an argument maps surfaces to datasets,
        with several it maps studies to such mappings.
    supplement : sequence of str
        Further studies for which the figure is drawn; for study ``moments``, ``fig09_moments``.
    own : str
        Name of the figure for a user's own study; of study ``steel`` it is ``peaks_steel``.
    datasets : sequence of str
        Datasets of stage validation that are drawn, in place of studies.
    options : mapping
        Arguments of ``draw`` and ``caption``.
    category : str
        Heading under which the report lists the figure.
    """

    name: str
    title: str
    drawing: str
    stages: Sequence[str]
    number: int | None = None
    studies: Sequence[str] = ()
    supplement: Sequence[str] = ()
    own: str = ""
    datasets: Sequence[str] = ()
    options: Mapping[str, Any] = field(default_factory=dict)
    category: str = "Supplement"

    @property
    def several_ratios(self) -> bool:
        """True for a figure of one surface at several Poisson's ratios."""
        return "ratios" in self.options.get("cases", "")

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
            Stage and surface, or ``validation`` and dataset → path of the result.
        """

        def of(stage: str, names: Sequence[str]) -> dict[str, Any]:
            return {name: path(stage, name) for name in names}

        if self.compares_studies:
            names_of = {study: studies[study] for study in self.studies}
            return {stage: {study: of(stage, names_of[study]) for study in names_of} for stage in self.stages}
        names = self.datasets or studies[self.studies[0]]
        return {stage: of(stage, names) for stage in self.stages}


@cache
def known() -> dict[str, Description]:
    """Descriptions of all figures by name."""
    found = {}
    for name, entry in packaged_yaml(__name__, "figures.yaml").items():
        number = re.fullmatch(r"fig(\d+)", name)
        found[name] = Description(name, **entry, number=number and int(number[1]))
    return found


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


def surfaces_with_load_area(config: Mapping[str, Any]) -> set[str]:
    """Surfaces of which a figure shows the load-area curve."""
    return _shown(config, lambda figure: figure.drawing == "peaks.load_area")


def surfaces_with_ratios(config: Mapping[str, Any]) -> set[str]:
    """Surfaces analysed at all Poisson's ratios; the paper's surfaces only if their ratios are compared."""
    return _shown(config, lambda figure: figure.several_ratios or config["figures"] != "paper")


def _shown(config: Mapping[str, Any], wanted: Callable[[Description], bool]) -> set[str]:
    """Surfaces that some figures show."""
    figures = [figure for figure in figures_of(config).values() if wanted(figure)]
    return {name for figure in figures for study in figure.studies for name in config["studies"][study]}


def draw(figure: Description, results: Mapping[str, Any]) -> Any:
    """Draw a figure from its results: `Description.results`, with a dataset in place of each path.

    Returns
    -------
    matplotlib.figure.Figure
    """
    drawn = _function("draw", figure)(**results, **figure.options)
    text = import_module(f"{__name__}.cases").settings_in_words(results, figure.several_ratios)
    drawn.supxlabel(text, x=0.995, ha="right", fontsize=5, color="0.4")
    return drawn


def caption(figure: Description, results: Mapping[str, Any]) -> str:
    """Caption of a figure in reStructuredText: its title, and numbers taken from the results."""
    found = _function("caption", figure)(**results, **figure.options)
    text = found if isinstance(found, str) else "\n".join(f"- {item}" for item in found)
    title = f"Figure {figure.number}: {figure.title}" if figure.number else figure.title
    return f"{title[0].upper()}{title[1:]}\n\n{text}\n"


def _function(kind: str, figure: Description) -> Callable[..., Any]:
    """The function ``draw_…`` or ``caption_…`` of a figure."""
    module, _, name = figure.drawing.partition(".")
    return getattr(import_module(f"{__name__}.{module}"), f"{kind}_{name}")
