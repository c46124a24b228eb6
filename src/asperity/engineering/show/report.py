"""The report of an answer as one page, its first screen in a notebook, and its pictures as files.

The drawing is imported where a page is made: that of matplotlib takes half a second.
"""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
from markupsafe import Markup

from asperity.core.markup import html_table, rendered
from asperity.engineering.answer_data import REPEATS, AnswerData, by_topic, case_in_words, without_repeats
from asperity.engineering.answer_files import case_of
from asperity.engineering.contact_numbers import certificate_in_words
from asperity.engineering.question import Picture
from asperity.engineering.sample import warnings_by_kind
from asperity.engineering.scene import Scene
from asperity.engineering.show.tables import for_reader, tiles_of, unknown_of
from asperity.results.atomic import write_text


class Drawn(NamedTuple):
    """A picture and its image."""

    picture: Picture
    png: bytes

    @property
    def uri(self) -> str:
        """The image within a page."""
        return f"data:image/png;base64,{b64encode(self.png).decode()}"


def write_report(answer: AnswerData, folder: Path) -> None:
    """Write the pictures of an answer, and the page that holds them, into an empty folder.

    The folder is within the folder of the answer.
    """
    from asperity.engineering.show.pictures import pictures, png_of

    drawn = []
    for picture in pictures(answer):
        drawn.append(Drawn(picture, png_of(picture.figure)))
        (folder / f"{picture.name}.png").write_bytes(drawn[-1].png)
    write_text(folder / "report.html", report(answer, drawn, folder.parent))


def report(answer: AnswerData, drawn: Sequence[Drawn] | None = None, folder: Path | None = None) -> str:
    """The answer as a page that needs no other file.

    Parameters
    ----------
    answer : AnswerData
    drawn : sequence of Drawn, optional
        Its pictures; by default they are drawn here.
    folder : Path, optional
        To which names of files in the case file are relative, by default the working folder.
    """
    from asperity.engineering.show.pictures import lead_of, pictures, png_of

    if drawn is None:
        drawn = [Drawn(picture, png_of(picture.figure)) for picture in pictures(answer)]
    lead = lead_of(answer, [each.picture for each in drawn])
    groups: dict[str, list[Drawn]] = {}
    for each in drawn:
        if each.picture is not lead:
            body = each.picture.body
            groups.setdefault(answer.case.stress_title(body) if body else "contact", []).append(each)
    shown = without_repeats(answer.records)
    listed = dict(for_reader(answer, name) for name in answer.tables)
    return rendered(
        "asperity.engineering.show",
        "report.html.j2",
        title=f"{answer.face.name}: contact and stress",
        answer=answer,
        case=case_in_words(answer.case),
        tiles=tiles_of(answer.tiles),
        unknown=unknown_of(answer.tiles),
        lead=next((each for each in drawn if each.picture is lead), None),
        numbers={heading: list(records) for heading, records in by_topic(answer.case, shown)},
        repeats=REPEATS if len(shown) < len(answer.records) else "",
        tables={heading: Markup(html_table(table)) for heading, table in listed.items()},
        pictures=groups,
        certificate=certificate_in_words(answer.contact.certificate),
        constants=constants_of_table(answer.case),
        case_file=case_of(answer, folder or Path()),
    )


def page_of(
    verdict: Sequence[str],
    tables: Mapping[str, pd.DataFrame],
    answers: Mapping[str, AnswerData],
    shown: Mapping[str, AnswerData],
    **words: Any,
) -> str:
    """Several answers as a page: a sample of maps, or answers and samples beside each other.

    Parameters
    ----------
    verdict : sequence of str
    tables : mapping
        Heading → numbers as texts; without a heading those that decide, on the first screen.
    answers, shown : mapping
        All answers, whose warnings are listed, and the answers of which pictures are drawn in one scale.
    **words
        Heading, case, tiles, notes, names of the folders of reports, and the case file.
    """
    from asperity.engineering.show.pictures import compared_pictures, png_of

    return rendered(
        "asperity.engineering.show",
        "several.html.j2",
        verdicts=verdict,
        warnings=warnings_by_kind(answers),
        tables={title: Markup(html_table(rows)) for title, rows in tables.items()},
        pictures=[Drawn(each, png_of(each.figure)) for each in compared_pictures(shown)],
        **{"tiles": (), "case_file": "", "footnote": "", **words},
    )


def preview(answer: AnswerData) -> str:
    """The first screen of the report, as a notebook shows it."""
    lead = None
    if find_spec("matplotlib"):
        from asperity.engineering.show.pictures import lead_of, png_of

        picture = lead_of(answer)
        lead = None if picture is None else Drawn(picture, png_of(picture.figure))
    return rendered(
        "asperity.engineering.show",
        "preview.html.j2",
        title=answer.title,
        verdict=answer.verdict,
        tiles=tiles_of(answer.tiles),
        lead=lead,
    )


def constants_of_table(case: Scene) -> list[str]:
    """Constants of a case that come from materials, a line for each body and layer."""
    lines = []
    for name, body in case.groups_of_bodies.items():
        for part, group in (
            (name, body),
            *((f"{name}, layer {n + 1}", layer) for n, layer in enumerate(body.layers)),
        ):
            if constants := group.from_material:
                values = [
                    f"{each} {found.value}{found.source and f' ({found.source})'}"
                    for each, found in constants.items()
                ]
                lines.append(f"{part.replace('_', ' ')}, {group.material}: {'; '.join(values)}")
    return lines
