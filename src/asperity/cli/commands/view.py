"""``asperity view``: a picture of results."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from asperity.cli.files import check_out, is_si, length, length_or_span, positions, read_results, span
from asperity.cli.parser import flag, section
from asperity.core.errors import one_line, shown
from asperity.engineering.answer_data import AnswerData
from asperity.stress.analysis import QUANTITIES
from asperity.stress.planes.fields import FIELDS
from asperity.study.progress_and_log import ProgressBar
from asperity.views.maps import plot_gap, plot_height, plot_pressure
from asperity.views.peak_plot import plot_peaks
from asperity.views.source import title_of
from asperity.views.stress_plot import plot_plane, plot_section
from asperity.views.style import plain_text, require_picture, save, style

MAPS = {"height": plot_height, "pressure": plot_pressure, "gap": plot_gap}

POSITIONS: dict[str, tuple[str, ...]] = dict.fromkeys(MAPS, ("y", "x"))
POSITIONS |= {"section": ("y", "x", "depth"), "plane": ("depth", "y", "x"), "peaks": ()}
"""View → positions that it takes."""

HIGHEST = {"plane": ("depth",), "section": ("y", "x")}
"""View → positions that may be ``max``, where the field has its largest magnitude."""

STAGES = {"height": ("surface", "contact"), "peaks": ("stress",)}
"""View → stages whose results it shows, if not only the contact."""


def run(options: argparse.Namespace) -> None:
    """Draw the view, write it, and print where it is."""
    words = options.words
    number = next((number for number, word in enumerate(words) if number and word in POSITIONS), None)
    if number is None:
        raise ValueError(f"{shown(words[-1])}: result files and one of {', '.join(POSITIONS)} are needed")
    paths, view = words[:number], words[number]
    given = positions(view, words[number + 1 :], POSITIONS[view])
    out = options.out or [str(Path(paths[0]).with_name(f"{Path(paths[0]).stem}_{view}.png"))]
    check_out([("--out", path) for path in out], paths)
    require_picture(*out)
    results = _read(paths, view)
    with style():
        save(_draw(view, results, given, options), *out)
    print(one_line(", ".join(out)))


def _read(paths: Sequence[str], view: str) -> dict[str, Any]:
    """Results by title; the name of the file is added to repeated titles."""
    read = {}
    needed = STAGES.get(view, ("contact",))
    for path in paths:
        if path in read:
            raise ValueError(f"{path}: given twice")
        read[path], *_ = read_results(path, needed).values()
    titles = [data.face.name if isinstance(data, AnswerData) else title_of(data) for data in read.values()]
    stems = [plain_text(Path(path).stem) for path in paths]
    named = zip(map(plain_text, paths), stems, strict=True)
    apart = [stem if stems.count(stem) == 1 else path for path, stem in named]
    return {
        title if titles.count(title) == 1 else f"{title} ({name})": data
        for title, name, data in zip(titles, apart, read.values(), strict=True)
    }


def _draw(view: str, results: dict[str, Any], given: dict[str, str], options: argparse.Namespace) -> Figure:
    si = is_si(next(iter(results.values())))
    poisson = section(options, "layer").get("poisson")
    friction = section(options, "sliding")
    if view in MAPS:
        _refuse(view, "section, plane and peaks", field=options.field, poisson=poisson)
    if view not in ("section", "plane"):
        _refuse(view, "section and plane", body=None if options.body == "lower" else options.body, **friction)
    places: dict[str, Any] = {}
    for name, text in given.items():
        if text == "max" and name in HIGHEST.get(view, ()):
            places[name] = text
        elif name == "depth":
            places[name] = length("depth", text, si)
        else:
            places[name] = (length_or_span if view == "section" else span)(name, text, si)
    if view in MAPS:
        return MAPS[view](results, **places)
    field = options.field or "von_mises"
    known = QUANTITIES if view == "peaks" else FIELDS
    if field not in known:
        raise ValueError(f"--field {shown(field)}: one of {', '.join(known)} is needed")
    if view == "peaks":
        return plot_peaks(results, field, poisson)
    plot = plot_section if view == "section" else plot_plane
    chosen = {"field": field, "poisson": poisson, "body": options.body, **friction, **places}
    with ProgressBar(view) as progress:
        return plot(results, **chosen, progress=progress)


def _refuse(view: str, views: str, **given: Any) -> None:
    """Raise `ValueError` for an option that a view does not take."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{flag(name)}: not for {view}, only for {views}")
