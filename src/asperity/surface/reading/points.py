"""Maps given as a list of points: text with three columns x, y, z on a regular grid.

Points that are not listed, and points with a word such as *No data* for the height, are points of the map
without data. A table of three columns is never taken as a matrix of heights.
"""

from __future__ import annotations

import io
import re
from typing import NamedTuple

import numpy as np

from asperity.core.errors import shown
from asperity.core.types import Array

MERGE_DISTANCE = 1e-6
"""Positions nearer than this, relative to the extent of the points, are one column or row of the grid:
the rounding of single precision and of seven printed digits."""

GRID_TOLERANCE = 0.05
"""Largest distance of a point from its grid node, in units of the spacing; positions printed with three
digits per pixel stay below 0.01."""

FEWEST_PRESENT = 0.05
"""Smallest share of grid nodes that must have a point; below it, the points are not a map but scattered."""

LONGEST_HEADER = 200

_MISSING = re.compile(r"\b(?:no\s+data|bad|nd|none|missing)\b|\*{2,}|---+", re.IGNORECASE)
_MATRIX_HEADER = re.compile(
    r"\b(?:width|breite|largeur|anchura|larghezza|x-pixels|x-length|nx|x\s+size|fileformat)\b\s*[:=]?\s*\d"
    r"|aISO-|aBCR-|Wyko ASCII",
    re.IGNORECASE,
)
_UNIT = re.compile(r"[\[(]\s*([A-Za-zµμÅ]+)\s*[\])]")
_STATED_UNIT = re.compile(r"(lateral|value) units?\s*[:=]\s*(\S+)", re.IGNORECASE)


class PointTable(NamedTuple):
    """Text of three columns, not yet converted to numbers.

    Parameters
    ----------
    text : str
        Lines of three fields separated by blanks.
    first_line : int
        Number of its first line in the file.
    lateral_unit, height_unit : str, optional
        Units that the header states.
    """

    text: str
    first_line: int
    lateral_unit: str | None
    height_unit: str | None

    def points(self) -> Array:
        """The numbers, of shape (points, 3).

        Raises
        ------
        ValueError
            If a line does not have three numbers; the message names it.
        """
        try:
            return np.loadtxt(io.StringIO(self.text), ndmin=2, usecols=(0, 1, 2))
        except ValueError:  # words for missing heights
            text = _MISSING.sub("nan", self.text)
        require_numbers(text, self.first_line)
        return np.loadtxt(io.StringIO(text), ndmin=2, usecols=(0, 1, 2))


def find_points(text: str) -> PointTable | None:
    """The table of three columns in a text; None if the text is anything else."""
    lines = text.splitlines(keepends=True)
    begin = next((n for n, line in enumerate(lines[:LONGEST_HEADER]) if _numbers(line)), None)
    if begin is None or {len(_numbers(line)) for line in lines[begin : begin + 2] if line.strip()} != {3}:
        return None
    header = lines[:begin]
    if any(_MATRIX_HEADER.search(line) for line in header):
        return None
    stated = {found[1].lower(): found[2] for line in header if (found := _STATED_UNIT.search(line))}
    units = [unit for line in header for unit in _UNIT.findall(line)]
    if not stated and len(units) == 3 and units[0] == units[1]:
        stated = {"lateral": units[0], "value": units[2]}
    body = _with_blanks("".join(lines[begin:]))
    return PointTable(body, begin + 1, stated.get("lateral"), stated.get("value"))


def has_numbers(text: str) -> bool:
    """True if a line of a text consists of numbers; its last word may be cut off."""
    complete = text if text[-1:].isspace() else " ".join(text.rsplit(None, 1)[:-1])
    return any(_numbers(line) for line in complete.splitlines())


def require_numbers(text: str, first_line: int = 1) -> None:
    """Raise `ValueError` for the first word in a table of numbers that is none, with its line.

    The table has all lines from the first one of numbers to the last. A line before or after belongs to it
    too if it has as many words, half of them numbers, or only words for missing data. Lines that begin with #
    are comments.
    """
    width = 0
    doubtful: list[tuple[int, list[str]]] = []
    for place, line in enumerate(text.splitlines(), first_line):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if not all(map(_is_number, words)):
            doubtful.append((place, words))
            continue
        _require_no_row(doubtful, 0 if width else len(words))
        width, doubtful = len(words), []
    if width:
        _require_no_row(doubtful, width)


def _require_no_row(lines: list[tuple[int, list[str]]], width: int) -> None:
    """Raise `ValueError` for the first of some lines that is a row of so many numbers; of any if 0."""
    for place, words in lines:
        numbers = sum(map(_is_number, words))
        if (
            width == 0
            or (len(words) == width and 2 * numbers >= width)
            or all(map(_MISSING.fullmatch, words))
        ):
            wrong = next(word for word in words if not _is_number(word))
            raise ValueError(f"line {place}: {shown(wrong)} is no number")


def grid_points(points: Array) -> tuple[Array, tuple[float, float]]:
    """Map of points on a regular grid, with rows along y and columns along x, both increasing.

    Parameters
    ----------
    points : (count, 3) array
        Columns x, y and z; z may be NaN.

    Returns
    -------
    height : (ny, nx) array
        NaN where there is no point.
    length : (length_y, length_x)
        Number of nodes times their spacing.

    Raises
    ------
    ValueError
        If the points are not on a regular grid.
    """
    x, y, z = points.T
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise ValueError("a point has no position")
    column, spacing_x, count_x = _nodes(x, "x")
    row, spacing_y, count_y = _nodes(y, "y")
    if z.size < FEWEST_PRESENT * count_x * count_y:
        raise ValueError(f"{z.size} points are too few for a grid of {count_y} x {count_x} nodes")
    node = row * count_x + column
    if np.bincount(node).max() > 1:
        raise ValueError("two points have the same position")
    height = np.full(count_y * count_x, np.nan)
    height[node] = z
    return height.reshape(count_y, count_x), (count_y * spacing_y, count_x * spacing_x)


def _nodes(position: Array, axis: str) -> tuple[Array, float, int]:
    """Index of the grid line of every point, spacing and number of the lines."""
    ordered = np.sort(position)
    extent = ordered[-1] - ordered[0]
    gaps = np.diff(ordered)
    gaps = gaps[gaps > MERGE_DISTANCE * extent]
    if gaps.size == 0:
        raise ValueError(f"all points have the same {axis}")
    for step in (np.median(gaps), gaps.min()):
        count = round(extent / step) + 1
        spacing = extent / (count - 1)
        index = (position - ordered[0]) / spacing
        nearest = np.rint(index)
        if np.abs(index - nearest).max() <= GRID_TOLERANCE:
            return nearest.astype(np.int64), float(spacing), count
    raise ValueError(f"the positions {axis} are not equally spaced")


def _numbers(line: str) -> list[str]:
    """Fields of a line if all are numbers or missing, else none."""
    words = [] if line.lstrip().startswith("#") else _MISSING.sub("nan", _with_blanks(line)).split()
    return words if all(map(_is_number, words)) else []


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word.lower() in ("bad", "infinite")
    return True


def _with_blanks(text: str) -> str:
    """Text with blanks between the fields and points between the digits."""
    start = text[: 2**12]
    if ";" in start:
        return text.replace(",", ".").replace(";", " ")
    if "," not in start:
        return text
    decimal = re.search(r"\d,\d*\s+[-+\d]", start) and not re.search(r"\d\s*,\s*[-+\d.]+\s*,", start)
    return text.replace(",", "." if decimal else " ")
