"""Overview picture of the claims: each number with its interval, and the region in which its claim holds."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.paper.claims.verdicts import NO_DATA, VERDICTS, Finding, Judgement, tally
from asperity.views.style import MILLIMETRE, PAGE

_COLOUR = dict(zip(VERDICTS, ("C0", "C1", "C2", "0.45", "0.6", "0.75"), strict=True))
_MARKER = dict(zip(VERDICTS, "os^D+x", strict=True))
_ROW = 4.6
"""Height of a row, in millimetres."""

_LOW, _HIGH = 0.4, 2.5
"""Ends of the axis, in units of the edge or the middle of the region."""

_BESIDE = 0.25
"""Distance of other interpretations from the middle of a row, in rows."""

_WIDE = 1.5
"""Ratio of the edges of a region above which its lower edge is the unit, not its middle."""


def draw(findings: Sequence[Finding]) -> Figure:
    """Draw a row for each claim on a common axis: the number over the edge of its region, or its middle.

    A row shows the study's own interpretation, and in pale the others that show the verdict. Numbers beyond
    the axis are drawn at its end as triangles; every number is written at the right.
    """
    count = len(findings)
    figure = Figure(figsize=(PAGE, (count * _ROW + 22) * MILLIMETRE))
    axis = figure.add_subplot()
    for row, finding in enumerate(findings):
        low, high = finding.own.region
        unit = _unit(low, high)
        left, right = np.clip([low / unit, high / unit], _LOW, _HIGH)
        axis.barh(row, right - left, left=left, height=0.8, color="C4", alpha=0.25, lw=0)
        colour, marker = _COLOUR[finding.verdict], _MARKER[finding.verdict]
        if finding.verdict != NO_DATA:
            for other in finding.shown:
                if other is not finding.own:
                    _draw_judgement(axis, row + _BESIDE, other, unit, colour, marker, alpha=0.4)
            _draw_judgement(axis, row, finding.own, unit, colour, marker)
        text = NO_DATA if finding.verdict == NO_DATA else f"{finding.own.value:.3g}"
        beside = axis.get_yaxis_transform()
        axis.text(1.01, row, text, transform=beside, va="center", fontsize=5.5, color=colour)
    axis.axvline(1.0, color="k", lw=0.5)
    axis.set(xscale="log", xlim=(_LOW, _HIGH), ylim=(count - 0.4, -0.6))
    axis.set_xticks([0.5, 0.7, 1, 1.5, 2], ["0.5", "0.7", "1", "1.5", "2"])
    axis.set_xticks([], minor=True)
    sentences = [f"{f.claim.sentence}  ({f.claim.section})" for f in findings]
    axis.set_yticks(range(count), sentences, fontsize=5.5)
    axis.tick_params(axis="y", length=0)
    axis.set_xlabel("measured over the edge or the middle\nof the region wanted (shaded)")
    for verdict, number in tally(findings).items():
        if number:
            look: dict[str, Any] = {"marker": _MARKER[verdict], "color": _COLOUR[verdict], "ls": "none"}
            axis.plot([], [], **look, label=f"{verdict} ({number})")
    figure.legend(loc="outside upper right", ncols=3)
    return figure


def _draw_judgement(
    axis: Axes, row: float, one: Judgement, unit: float, colour: str, marker: str, alpha: float = 1.0
) -> None:
    """Draw the number and the interval under one interpretation."""
    value = one.value / unit
    shown = float(np.clip(value, _LOW * 1.02, _HIGH / 1.02))
    if value != shown:
        marker = ">" if value > shown else "<"
    elif np.isfinite(one.interval_low):
        interval = np.clip([one.interval_low / unit, one.interval_high / unit], _LOW, _HIGH)
        axis.plot(interval, [row, row], color=colour, alpha=alpha)
    axis.plot(shown, row, marker, color=colour, alpha=alpha, clip_on=False)


def _unit(low: float, high: float) -> float:
    """Unit of the number of a row: the edge of its region, or the geometric middle between two edges."""
    if low == 0:
        return 1.0 if np.isinf(high) else high
    return low if high > _WIDE * low else float(np.sqrt(low * high))
