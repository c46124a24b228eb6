"""Maps given as a list of points: text with three columns x, y, z on a regular grid.

Points that are not listed, and points without a number for the height, are points of the map without data.
A table of three columns is never taken as a matrix of heights.
"""

from __future__ import annotations

import io
import os
import re
from dataclasses import dataclass

import numpy as np

from asperity.types import Array

MERGE_DISTANCE = 1e-6
"""Positions nearer than this, relative to the extent of the points, are one column or row of the grid:
the rounding of single precision and of seven printed digits."""

GRID_TOLERANCE = 0.05
"""Largest distance of a point from its grid node, in units of the spacing; positions printed with three
digits per pixel stay below 0.01."""

FEWEST_PRESENT = 0.05
"""Smallest share of grid nodes that must have a point; below it, the points are not a map but scattered."""

_SNIFFED_LINES = 30
_LONGEST_HEADER = 200

_MISSING = re.compile(r"\b(?:no\s+data|bad|nd|none|missing)\b|\*{2,}|---+", re.IGNORECASE)
_MATRIX_HEADER = re.compile(
    r"\b(?:width|breite|largeur|anchura|larghezza|x-pixels|x-length|nx|x\s+size|fileformat)\b\s*[:=]?\s*\d"
    r"|aISO-|aBCR-|Wyko ASCII",
    re.IGNORECASE,
)
_UNIT = re.compile(r"[\[(]\s*([A-Za-zµμÅ]+)\s*[\])]")
_LATERAL_UNIT = re.compile(r"lateral units?\s*[:=]\s*(\S+)", re.IGNORECASE)
_VALUE_UNIT = re.compile(r"value units?\s*[:=]\s*(\S+)", re.IGNORECASE)


@dataclass(frozen=True)
class PointTable:
    """Text of three columns, not yet converted to numbers.

    Parameters
    ----------
    text : str
        Lines of three fields separated by blanks.
    lateral_unit, height_unit : str, optional
        Units that the header states.
    """

    text: str
    lateral_unit: str | None
    height_unit: str | None

    def points(self) -> Array:
        """The numbers, of shape (points, 3).

        Raises
        ------
        ValueError
            If a line does not have three numbers.
        """
        try:
            return np.loadtxt(io.StringIO(self.text), ndmin=2, usecols=(0, 1, 2))
        except ValueError:  # words for missing heights
            text = _MISSING.sub("nan", self.text)
            return np.loadtxt(io.StringIO(text), ndmin=2, usecols=(0, 1, 2))


def find_points(path: str | os.PathLike[str]) -> PointTable | None:
    """The table of three columns in a text file; None if the file is anything else."""
    with open(path, "rb") as file:
        start = file.read(2**16)
        if _decoded(start) is None:
            return None
        header, first = _header(_decoded(start) or "")
        if first is None or any(_MATRIX_HEADER.search(line) for line in header):
            return None
        text = _decoded(start + file.read())
    if text is None:
        return None
    begin = sum(map(len, text.splitlines(keepends=True)[: len(header)])) if header else 0
    units = [unit for line in header for unit in _UNIT.findall(line)]
    lateral, value = (_stated(pattern, header) for pattern in (_LATERAL_UNIT, _VALUE_UNIT))
    if lateral is None and value is None and len(units) == 3 and units[0] == units[1]:
        lateral, value = units[0], units[2]
    return PointTable(_fields(text[begin:]), lateral, value)


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


def _decoded(content: bytes) -> str | None:
    """The text, None if the content is binary."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        return None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _header(text: str) -> tuple[list[str], str | None]:
    """The lines before the table, and its first line; None if there is no table of three columns."""
    lines = text.splitlines()[: _LONGEST_HEADER + _SNIFFED_LINES]
    for begin, line in enumerate(lines[:_LONGEST_HEADER]):
        if not _is_point(line):
            if line.strip() and not line.lstrip().startswith("#") and _is_numeric(line):
                return lines[:begin], None
            continue
        table = [row for row in lines[begin : begin + _SNIFFED_LINES] if row.strip()]
        complete = table if len(table) < _SNIFFED_LINES else table[:-1]
        return lines[:begin], line if all(map(_is_point, complete)) else None
    return lines, None


def _fields(text: str) -> str:
    """Text with blanks between the fields and points between the digits."""
    start = text[: 2**12]
    if ";" in start:
        return text.replace(",", ".").replace(";", " ")
    if "," not in start:
        return text
    decimal = re.search(r"\d,\d*\s+[-+\d]", start) and not re.search(r"\d\s*,\s*[-+\d.]+\s*,", start)
    return text.replace(",", "." if decimal else " ")


def _is_point(line: str) -> bool:
    return not line.lstrip().startswith("#") and _is_numeric(line) and len(_split(line)) == 3


def _is_numeric(line: str) -> bool:
    fields = _split(line)
    try:
        [float(field) for field in fields]
    except ValueError:
        return False
    return bool(fields)


def _split(line: str) -> list[str]:
    return _MISSING.sub("nan", _fields(line)).split()


def _stated(pattern: re.Pattern[str], header: list[str]) -> str | None:
    return next((found[1] for line in header if (found := pattern.search(line))), None)
