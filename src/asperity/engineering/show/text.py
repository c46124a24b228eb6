"""The answer as text for the terminal."""

from __future__ import annotations

from textwrap import fill

from asperity.engineering.answer_data import ONE_POSITION, REPEATS, AnswerData, by_topic, without_repeats
from asperity.engineering.show.tables import WIDEST, for_reader


def text(answer: AnswerData) -> str:
    """The answer as a block of text, warnings last."""
    width = max(len(each.quantity) for each in answer.records)
    lines = [fill(answer.title, WIDEST), "", *(fill(each, WIDEST) for each in answer.verdict)]
    if answer.uncertainties:
        lines += ["", "largest uncertainties", *(f"  {each.short}" for each in answer.uncertainties)]
    shown = without_repeats(answer.records)
    for heading, records in by_topic(answer.case, shown):
        lines += ["", heading, *(f"  {each.quantity:<{width}}  {each.text()}" for each in records)]
    if "sweep" in answer.tables:
        _, rows = for_reader("sweep", answer.tables["sweep"])
        lines += ["", rows.set_index("sweep").T.to_string(line_width=WIDEST)]
    lines += ["", ONE_POSITION]
    lines += ["", REPEATS] if len(shown) < len(answer.records) else []
    lines += ["", "what was done to the map", *(f"  {step}" for step in answer.face.done)]
    for each in answer.warnings:
        lines += ["", fill(f"{each.level}: {each.text}", WIDEST)]
    return "\n".join(lines)
