"""``asperity view``: a picture of results."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from asperity.cli.arguments import flag, section, sliding
from asperity.cli.compiling import compile_visibly, planes_small
from asperity.cli.files import check_out, stage_of
from asperity.cli.parser import VIEWS
from asperity.cli.places import is_si, length, places, span
from asperity.errors import shown
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar
from asperity.stress.analysis import QUANTITIES
from asperity.stress.arguments import FIELDS
from asperity.views.maps import plot_gap, plot_height, plot_pressure
from asperity.views.peaks import plot_peaks
from asperity.views.plane import plot_plane
from asperity.views.section import plot_section
from asperity.views.source import sources, title_of
from asperity.views.style import save, style

_STAGES = {
    "height": ("surface", "contact"),
    "pressure": ("contact",),
    "gap": ("contact",),
    "section": ("contact",),
    "plane": ("contact",),
    "peaks": ("stress",),
}
"""View → stages whose results have what it shows."""

_PLACES = {"section": ("y", "x", "depth"), "plane": ("depth", "y", "x"), "peaks": ()}
"""View → places that it takes; the maps take a part along y and x."""

_MAPS = {"height": plot_height, "pressure": plot_pressure, "gap": plot_gap}


def run(options: argparse.Namespace) -> None:
    """Draw the view, write it, and print where it is."""
    paths, view, words = _split(options.words)
    results = _read(paths, view)
    out = options.out or [str(_beside(paths[0], view))]
    check_out(out, paths)
    with style():
        save(_draw(view, results, words, options), *out)
    print(", ".join(out))


def _split(words: Sequence[str]) -> tuple[list[str], str, list[str]]:
    """Result files, view and places."""
    number = next((number for number, word in enumerate(words) if number and word in VIEWS), None)
    if number is None:
        raise ValueError(f"{shown(words[-1])}: result files and one of {', '.join(VIEWS)} are needed")
    return list(words[:number]), words[number], list(words[number + 1 :])


def _read(paths: Sequence[str], view: str) -> dict[str, xr.Dataset]:
    """Results by title; titles that occur twice are told apart by their files."""
    for path in paths:
        if paths.count(path) > 1:
            raise ValueError(f"{path}: given twice")
    read = {path: dataset.read(path) for path in paths}
    for path, data in read.items():
        if (stage := stage_of(data)) not in _STAGES[view]:
            needed = " or ".join(_STAGES[view])
            raise ValueError(
                f"{path}: a result of {stage or 'no stage'}, one of {needed} is needed for {view}"
            )
    titles = {path: title_of(data) for path, data in read.items()}
    stems = [Path(path).stem for path in paths]
    apart = {path: stem if stems.count(stem) == 1 else path for path, stem in zip(paths, stems, strict=True)}
    return {
        title if list(titles.values()).count(title) == 1 else f"{title} ({apart[path]})": read[path]
        for path, title in titles.items()
    }


def _beside(path: str, view: str) -> Path:
    """Name of the picture of a view beside its first result."""
    return Path(path).with_name(f"{Path(path).stem}_{view}.png")


def _draw(
    view: str, results: dict[str, xr.Dataset], words: Sequence[str], options: argparse.Namespace
) -> Figure:
    given = places(view, words, _PLACES.get(view, ("y", "x")))
    si = is_si(next(iter(results.values())))
    poisson = section(options, "layer").get("poisson")
    if view in _MAPS:
        _refuse(view, field=options.field, poisson=poisson)
        _refuse_sliding(view, options)
        parts: dict[str, Any] = {name: span(name, text, si) for name, text in given.items()}
        return _MAPS[view](results, **parts)
    field = options.field or "von_mises"
    known = QUANTITIES if view == "peaks" else FIELDS
    if field not in known:
        raise ValueError(f"--field {shown(field)}: one of {', '.join(known)} is needed")
    if view == "peaks":
        _refuse_sliding(view, options)
        return plot_peaks(results, field, poisson)
    chosen: dict[str, Any] = {"field": field, "poisson": poisson, "body": options.body, **sliding(options)}
    if view == "section":
        for name, text in given.items():
            chosen[name] = _place(name, text, si)
    else:
        for name, text in given.items():
            chosen[name] = span(name, text, si) if name != "depth" else _depth(text, si)
    for source in sources(list(results.values())):
        compile_visibly("planes", partial(planes_small, source.pressed(), [field], poisson))
    plot = plot_section if view == "section" else plot_plane
    with ProgressBar(view) as progress:
        return plot(results, **chosen, progress=progress)


def _refuse(view: str, **given: Any) -> None:
    """Raise `ValueError` for an option that a view does not take."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"--{name}: not for {view}, only for section, plane and peaks")


def _refuse_sliding(view: str, options: argparse.Namespace) -> None:
    """Raise `ValueError` for a body or friction with a view that shows no stress computed here."""
    if options.body != "lower":
        raise ValueError(f"--body: not for {view}, only for section and plane")
    for name in sliding(options):
        raise ValueError(f"{flag(name)}: not for {view}, only for section and plane")


def _place(name: str, text: str, si: bool) -> float | tuple[float, float]:
    """Place or part of a section."""
    try:
        return length(name, text, si)
    except ValueError:
        if name == "depth" or not ("-" in text.lstrip("-") or ".." in text):
            raise
        return span(name, text, si)


def _depth(text: str, si: bool) -> float | str:
    return text if text == "max" else length("depth", text, si)
