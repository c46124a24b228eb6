"""Tables of numbers in text: any separator, points or commas as decimal marks, header lines and comments.

A word for missing data such as *No data*, an empty field, signs alone, and numbers at the end of single
precision are a non-measured point. Any other word in a table is refused with its line. Points x, y, z on a
regular grid are a map; nodes not listed have no data. A field in quotation marks may hold the separator, as a
decimal comma or between thousands.
"""

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from itertools import chain
from typing import NamedTuple

import numpy as np

from asperity.core.errors import shown
from asperity.core.types import Array
from asperity.surface.reading import heading
from asperity.surface.reading.heading import MatrixSizes, column_units, zygo_lines

MERGE_DISTANCE = 1e-6
"""Positions nearer than this, relative to the extent of the points, are one column or row of the grid; it
allows for the rounding of single precision and of seven printed digits."""

GRID_TOLERANCE = 0.05
"""Largest distance of a point from its grid node, in units of the spacing; positions printed with three
digits per pixel stay below 0.01."""

ROUNDED_TOLERANCE = 0.55
"""Largest distance of positions printed with few digits from equal steps, in units of their last digit."""

FEWEST_PRESENT = 0.05
"""Smallest fraction of grid nodes that must have a point; below it, the points are no map but scattered."""

SAMPLE = 400
"""Lines by which the dialect of a text is found; more than half of them belong to the table."""

MOST_FIELDS = 20_000
"""Number of fields among which separators of thousands are sought."""

DIALECTS = (
    *(("\t", "."), ("\t", ","), (";", ","), (";", "."), (", ", ","), (",", ","), (",", ".")),
    *((" ", "."), (" ", ",")),
)
"""Separators of fields with their decimal marks; of two that suit a text equally, the first is taken."""

CLOSING_ROWS = 0.9
"""Fraction of the rows that end with as many separators as are no fields: the last lines may have fewer."""

MATRIX_HEADER = re.compile(
    r"\b(?:width|breite|largeur|anchura|larghezza|x-pixels|x-length|nx|x\s+size|pixel\s+size|scale\s+x|z-unit)\b"
    r"\s*[:=]?\s*[\d\w]|Wyko ASCII",
    re.IGNORECASE,
)
"""Header lines of matrices that SurfaceTopography understands."""

_BLOCK_TITLE = re.compile(r"[^\d\s#]\S*(\s+\d+){2}\s*$|[^\d\s][^:=]*[:=]")
"""Line between two matrices under such a header: name, type and length of Wyko, or a key and its value."""

_ERRORS = r"#(?:n/?[adv]|[\w/]+[!?])(?!\w)"  # of spreadsheets in any language
_MISSING = re.compile(
    r"(?<!\S)(no[\s_]*(data|value)|bad|[nk][./_]*[adv]\.?|none|null|empty|missing|infinite|void|masked"
    r"|(un|in|not[\s_]*)(valid|measured|defined)|undef"
    rf"|[-+]?nan\w*(\(\w*\))?|<\w+>|{_ERRORS}|(?:[^\w\s]|_)+|[-+]?1[.,]#\w+)(?!\S)",
    re.IGNORECASE,
)
LARGEST_NUMBER = 1e38
"""Programs mark non-measured points by the largest numbers of single precision, 1.7e38 and 3.4e38."""

STEPS_TO_TELL, ROUGH, ALIKE = 7, 0.3, 0.8
"""A first row or column of so many steps that rises or falls throughout holds positions if its steps are
equal as printed and those beside it are not, or if at least this fraction of the steps of the other lines
rises and falls and it is not correlated with the next one by this factor, as a line of a smooth surface."""

_EXCHANGED = str.maketrans(".,", ",.")  # a number with a point is none where the comma is the decimal mark
_THOUSANDS = re.compile(r"[-+]?\d{1,3}((,\d{3})+\.\d*|(,\d{3}){2,})")
_QUOTED_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_CHANNEL_NAME = re.compile(r"#?\s*(?:channel|kan[aá]l|canale?|канал)\s*[:=]\s*(\S.*)", re.IGNORECASE)


class Dialect(NamedTuple):
    """Separators and decimal mark of a table of numbers.

    Parameters
    ----------
    separator, mark : str
        Between fields, and between the whole part of a number and its fraction.
    closing : int
        Separators at the end of every row.
    columns : int
        Fields in most lines.
    """

    separator: str
    mark: str
    closing: int
    columns: int = 0

    def fields(self, line: str) -> list[str]:
        """The fields of a line, without quotation marks."""
        line = line.strip("\r\n ")
        if self.separator == " ":
            return line.replace('"', "").split()
        if self.separator == ", ":  # a row may end with a comma
            return line.removesuffix(",").split(self.separator)
        for _ in range(self.closing):
            line = line.removesuffix(self.separator)
        if '"' not in line:
            return line.split(self.separator)
        with suppress(csv.Error):  # of a field that is too long
            return next(csv.reader([line], delimiter=self.separator, skipinitialspace=True), [])
        return line.replace('"', "").split(self.separator)

    def heading(self, line: str) -> str:
        """A line that is no row, with blanks between its fields and decimal points."""
        text = line.strip("\r\n ") if _is_comment(line) else " ".join(self.fields(line)).strip()
        return re.sub(r"(?<=\d),(?=\d)", ".", text) if self.mark == "," else text

    def plain(self, line: str) -> str:
        """A row with blanks between its fields and none in them, decimal points, ``nan`` in empty fields."""
        if _is_comment(line.strip("\r\n ")):
            return self.heading(line)
        if self.separator == " " and self.mark == "." and "," not in line:
            return line.strip("\r\n ").replace('"', "")
        words = ["_".join(field.split()) for field in self.fields(line)]
        if self.mark == ",":
            words = [word.translate(_EXCHANGED) for word in words]
        if any("," in word for word in words):
            thousands = _QUOTED_THOUSANDS if (self.separator, self.mark) == (",", ".") else _THOUSANDS
            words = [word.replace(",", "") if thousands.fullmatch(word) else word for word in words]
        return " ".join(word or "nan" for word in words) if any(words) else ""


class NumberTable:
    """The table of numbers in a text.

    Parameters
    ----------
    text : str
    dialect : Dialect

    Attributes
    ----------
    header : list of str
        Lines before the table, with blanks between their fields.
    columns : int
        Columns of numbers, without one that says whether the point of its row has data.
    column_units : list of str or None
        Unit of each column, None where the header states none.
    lines : list of str
        Lines of the table and comments between them, with blanks between numbers.
    rows : list of list of float
        The numbers, NaN where one is missing. Rows on both sides of a comment may differ in length.
    line_numbers : list of int
        Number of the line of each row in the text, from 1.

    Raises
    ------
    ValueError
        For the first line in the table with a word that is no number or with another length, and for a line
        beside it that could be one of its rows; the message names the line.
    """

    def __init__(self, text: str, dialect: Dialect) -> None:
        written, columns = text.splitlines(), dialect.columns
        lines, rows = map(list, zip(*(_row(dialect.plain(line)) for line in written), strict=True))
        of_zygo = zygo_lines(written)
        rows[:of_zygo] = [[] for _ in range(of_zygo)]
        whole = [number for number, row in enumerate(rows) if row and len(row) == columns]
        if not whole:
            raise ValueError(f"a table of {columns} columns of numbers is needed")
        if columns == 3 and math.prod(rows[whole[0]] or ()) == len(whole) - 1 > 1:
            del whole[0]  # numbers of points along x, y and z above a list of them
        begin, end = whole[0], whole[-1] + 1
        self.header = [dialect.heading(line) for line in written[:begin]]
        counts = (len(whole), len(whole) * columns)  # of points, or of rows and columns, maybe line by line
        if math.prod(chain.from_iterable(filter(None, rows[:begin]))) in counts:
            rows[:begin] = [row and [] for row in rows[:begin]]
        for number in range(begin):
            names = dialect.fields(written[number - 1]) if number and rows[number - 1] is None else ()
            if (row := rows[number]) and len(names) == len(row):  # a line of names above one of values
                self.header += [f"{name.strip()} {value:g}" for name, value in zip(names, row, strict=True)]
                rows[number], self.header[number - 1] = [], ""
            elif row and math.prod(row) in counts:
                rows[number] = []
        self._how_read = ", read with decimal commas," if dialect.mark == "," else ""
        self.columns = columns
        self.column_units = column_units(written[:begin], columns, dialect.separator)
        self.names_points = heading.names_points(written[:begin], columns, dialect.separator)
        is_matrix, width = any(map(MATRIX_HEADER.search, self.header)), columns
        for number, written_line in enumerate(written):
            is_inside = begin <= number < end
            if is_inside and not lines[number] and written_line.strip(" "):  # separators alone
                lines[number], rows[number] = " ".join(["nan"] * columns), [math.nan] * columns
            line, row = lines[number], rows[number]
            if row is None and is_inside and is_matrix and _BLOCK_TITLE.match(dialect.heading(written_line)):
                lines[number], rows[number], width = dialect.heading(written_line), [], 0
            elif row is None:
                wrong = [word for word in line.split() if not _row(word)[1]]
                places = np.array(_row(line.partition(" ")[2])[1] or [])
                if not is_inside and 2 < places.size == columns - 1 and np.all(np.diff(places) > 0):
                    raise ValueError(f"line {number + 1}: positions; delete them, in the first column too")
                if is_inside or (len(line.split()) == columns and 2 * len(wrong) < columns):
                    raise ValueError(f"line {number + 1}: {shown(wrong[0])} is no number")
            elif row and len(row) != (width or len(row)):
                raise ValueError(f"line {number + 1}: {width} numbers are needed, not {len(row)}")
            elif is_inside:
                width = 0 if _is_comment(line) else len(row) or width
        self.lines = lines[begin:end]
        self.rows = [row for row in rows[begin:end] if row]
        self.line_numbers = [begin + number + 1 for number, row in enumerate(rows[begin:end]) if row]
        if columns > 2 and heading.ends_with_validity(written[:begin], columns, dialect.separator):
            self.rows = [[*row[:-2], row[-2] if row[-1] else math.nan] for row in self.rows]
            self.columns, self.column_units = columns - 1, self.column_units[:-1]

    def numbers(self) -> Array:
        """The numbers as an array, if all rows have the same number of them.

        Raises
        ------
        ValueError
            If they have not.
        """
        if len({len(row) for row in self.rows}) > 1:
            raise ValueError(f"{len(self.rows[0])} numbers in each line are needed")
        numbers = np.array(self.rows)
        return np.where(np.abs(numbers) > LARGEST_NUMBER, np.nan, numbers)

    def heights(self, may_be_numbered: bool = False) -> Array:
        """The numbers as a matrix of heights, without a first column of numbers of rows if there may be one.

        Raises
        ------
        ValueError
            As for `numbers`, and if only the first or last row or column has the steps of positions.
        """
        heights = self.numbers()
        if may_be_numbered and heights[0, 0] in (0, 1) and np.all(np.diff(heights[:, 0]) == 1):
            heights = heights[:, 1:]
        for name, values in (("row", heights), ("column", heights.T)):
            ends = [("first", values[:, corner:]) for corner in (0, 1)] + [("last", values[::-1])]
            if side := next((end for end, lines in ends if len(lines) > 1 and _are_positions(lines)), None):
                raise ValueError(
                    f"its {side} {name}{self._how_read} holds numbers or positions of points; delete it"
                )
        return heights

    def with_headings(self) -> tuple[list[str], dict[str, float]]:
        """Header and lines as SurfaceTopography expects them, and edges along x and y without a unit.

        A width or height that is no edge is left out, and a repeated name of a channel gets a number.
        """
        sizes, names = MatrixSizes(len(self.rows), self.columns), Counter[str]()
        lines = [sizes.line(line) for line in (*self.header, *self.lines)]
        for number, line in enumerate(lines):
            if (found := _CHANNEL_NAME.match(line)) and (names := names + Counter([found[1]]))[found[1]] > 1:
                lines[number] = f"{line} {names[found[1]]}"
        return lines, sizes.bare


def find_dialect(text: str) -> Dialect | None:
    """The dialect in which most lines of a text are numbers; None if it has no table of numbers."""
    sample = text.splitlines()[:SAMPLE]
    best, most = None, (False, 1)
    for separator, mark in DIALECTS:
        given = Dialect(separator, mark, 0)
        if (separator, mark) == (",", ",") and ('"' not in text or _has_thousands(sample, given)):
            continue
        if separator == ", " and '"' in text:  # which the csv module splits
            continue
        lined = [line.strip("\r\n ") for line in sample if separator in line or separator == " "]
        rows = ((line, _row(given.plain(line))[1]) for line in lined)
        whole = [(line, row) for line, row in rows if row and not all(map(math.isnan, row))]
        last = "" if " " in separator else separator
        ends = [len(line) - len(line.rstrip(last)) if last else 0 for line, _ in whole]
        closing = sorted(ends)[int((1 - CLOSING_ROWS) * len(ends))] if ends else 0
        widths = Counter(len(row) - min(closing, end) for (_, row), end in zip(whole, ends, strict=True))
        columns, count = widths.most_common(1)[0] if widths else (0, 0)
        if (columns > 1, count) > most:
            best, most = Dialect(separator, mark, closing, columns), (columns > 1, count)
    if best and best.separator != "," and _has_thousands(sample, best):
        raise ValueError(f"{best.mark!r} may separate thousands or decimals; write all with a decimal point")
    return best


def _has_thousands(lines: list[str], dialect: Dialect) -> bool:
    """True if all marks of numbers may separate thousands, and some numbers of a column have none."""
    marks, padded = dict[int, set[bool]](), dialect.mark == ","
    for line in lines[: max(20, MOST_FIELDS // (dialect.columns or 1))]:
        for number, field in enumerate(dialect.fields(line)):
            word = field.strip() if dialect.mark == "," else field.strip().translate(_EXCHANGED)
            if not re.fullmatch(r"[-+]?[\d.,]*\d[\d.,]*", word):
                if re.fullmatch(r"[-+\d.,]+e[-+\d]+", word, re.IGNORECASE):
                    return False
                continue
            if "," in word and not _QUOTED_THOUSANDS.fullmatch(word):
                return False
            padded |= "," in word and word.endswith("0")
            marks.setdefault(number, set()).add("," in word)
    return padded and any(len(found) == 2 for found in marks.values())


def _row(line: str) -> tuple[str, list[float] | None]:
    """A line with ``nan`` for missing numbers, and its numbers: [] of a comment, None if one is no number."""
    if _is_comment(line):
        return line, []
    for text in (line, _MISSING.sub("nan", line)):
        if "_" not in text:  # which Python accepts in numbers
            with suppress(ValueError):
                return text, list(map(float, text.split()))
    return text, None


def _has_equal_steps(values: Array) -> bool:
    steps = np.diff(values[np.isfinite(values)])
    return steps.size > 2 and steps[0] != 0 and np.allclose(steps, steps[0], rtol=1e-6, atol=0)


def _are_positions(lines: Array) -> bool:
    """True if the first of some lines has the steps of positions, as printed, and the others have not."""
    first, second = lines[:2]
    steps = np.diff(first)
    if _has_equal_steps(first):
        return not _has_equal_steps(second)
    if steps.size < STEPS_TO_TELL or not (np.all(steps > 0) or np.all(steps < 0)):
        return False
    tolerance = max(GRID_TOLERANCE * abs(steps.mean()), _rounding(first))
    falling = np.mean(np.diff(lines[1:]) < 0, axis=1)
    is_rough = np.median(np.minimum(falling, 1 - falling)) >= ROUGH
    known = np.isfinite(second)
    is_alike = is_rough and np.corrcoef(first[known], second[known])[0, 1] > ALIKE
    return bool((is_rough and not is_alike) or _unevenness(first) <= tolerance < _unevenness(second) / 3)


def _unevenness(line: Array) -> float:
    """Largest distance of numbers from the line through them with equal steps."""
    order = np.flatnonzero(np.isfinite(line))
    return float(np.abs(line[order] - np.polyval(np.polyfit(order, line[order], 1), order)).max())


def _rounding(line: Array) -> float:
    """Largest distance from equal steps that the printed digits of positions explain; 0 beyond six."""
    digits = (d for d in range(7) if np.allclose(line, np.round(line, d), rtol=0, atol=1e-9))
    return ROUNDED_TOLERANCE * next((10.0**-d for d in digits), 0.0)


def _is_comment(line: str) -> bool:
    return line.startswith(("#", "%")) and not re.match(_ERRORS, line, re.IGNORECASE)


def grid_points(points: Array, lines: Sequence[int] = ()) -> tuple[Array, tuple[float, float]]:
    """Map of points on a regular grid, with rows along y and columns along x, both increasing.

    Parameters
    ----------
    points : (count, 3) array
        Columns x, y and z; z may be NaN.
    lines : sequence of int
        Number of the line of each point, for messages; by default points are counted.

    Returns
    -------
    height : (ny, nx) array
        NaN where there is no point.
    length : (length_y, length_x)
        Number of nodes times their spacing.

    Raises
    ------
    ValueError
        If the points are not on a regular grid, or lie on one line.
    """
    x, y, z = points.T
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise ValueError("a point has no position")
    column, spacing_x, count_x = nodes(x, "x")
    row, spacing_y, count_y = nodes(y, "y")
    if z.size <= max(count_x, count_y):
        raise ValueError("its points lie on one line")
    if z.size < FEWEST_PRESENT * count_x * count_y:
        raise ValueError(f"{z.size} points are too few for a grid of {count_y} x {count_x} nodes")
    node = row * count_x + column
    refuse_repeated(node, lines)
    height = np.full(count_y * count_x, np.nan)
    height[node] = z
    return height.reshape(count_y, count_x), (count_y * spacing_y, count_x * spacing_x)


def refuse_repeated(node: Array, lines: Sequence[int] = ()) -> None:
    """Refuse a list of points of which two belong to the same node."""
    first = np.unique(node, return_index=True)[1]
    if first.size < node.size:
        later = int(np.setdiff1d(np.arange(node.size), first)[0])
        earlier = int(np.flatnonzero(node == node[later])[0])
        earlier, later = (lines[each] if lines else each + 1 for each in (earlier, later))
        what = "points in lines" if lines else "points"
        raise ValueError(f"{what} {earlier} and {later} have the same position; delete one of them")


def nodes(position: Array, axis: str) -> tuple[Array, float, int]:
    """Index of the grid line of every point, spacing and number of the lines.

    Lines without a point are allowed, and positions rounded to few digits if no line lacks points.
    """
    ordered = np.sort(position)
    extent = ordered[-1] - ordered[0]
    lines = ordered[np.diff(ordered, prepend=-np.inf) > MERGE_DISTANCE * extent]
    if lines.size < 2:
        raise ValueError(f"all points have the same {axis}")
    gaps, fitted = np.diff(lines), np.polyfit(np.arange(lines.size), lines, 1)[0]
    is_rounded = _unevenness(lines) <= min(max(GRID_TOLERANCE * fitted, _rounding(lines)), fitted / 2)
    for step in (np.median(gaps), gaps.min()):
        count = round(extent / step) + 1
        spacing = extent / (count - 1)
        index = (position - ordered[0]) / spacing
        nearest = np.rint(index)
        if np.abs(index - nearest).max() <= GRID_TOLERANCE:
            return nearest.astype(np.int64), float(spacing), count
        if is_rounded:
            return np.searchsorted(lines, position, side="right") - 1, float(fitted), lines.size
    raise ValueError(f"the positions {axis} are not equally spaced")
