"""Heading of a text: units of columns, edges, pixels, and numbers of points.

A number in a heading is an edge of the map only if its key names an edge and its unit is one of length.
"""

import re
from collections.abc import Sequence

from asperity.surface.reading.agreement import edges_in_one_unit
from asperity.surface.reading.formats import WORDS, words_of

_UNIT = r"[pnuµμmcdk~]?m|Å|(?i:(?:micro|nano|milli|centi)?met(?:er|re)s?|microns?|inch(?:es)?)"
_COLUMN = re.compile(
    rf"(?P<name>(?!\s*[-+.\d]).*(?:[^\W\d]\s+|[^\w\s]\s*|_))?(?P<unit>{_UNIT})\W*", re.DOTALL
)
"""Name of a column and its unit; a number before the unit makes it the value of something else."""

_HEIGHT_UNIT = re.compile(
    rf"(?P<name>[^\[(,;:\d]*)[\[(]\s*(?P<unit>{_UNIT})\s*[\])](?![\s:=]*[-+.]?\d)"
    rf"|^(?P<before>\D*?)(?:\s+in\s+|[\s:=;,/]+)(?P<after>{_UNIT})\W*$"
)
"""Words and a unit in brackets without a value behind it, or at the end of a line without a number."""

_VALUES = {"value", "values", "data", "daten", "werte", "valeurs", "valori", "valores"}
_OF_HEIGHTS = (_VALUES | WORDS["heights"]) - {"surface"}
_NOT_OF_HEIGHTS = WORDS["others"] | {
    *("width", "breite", "xy", "lateral", "scan", "sample", "stage", "position", "pixel")
}

_PIXEL = re.compile(
    rf"(?P<what>[^\d\[(:=;,]+)[\s:=;,]*(?:[\[(]\s*(?P<before>{_UNIT})\s*[\])])?[\s:=;,]*"
    rf"(?P<number>\d*\.?\d+(?:[eE][-+]?\d+)?)\s*[\[(]?(?P<after>{_UNIT})?[\])]?(?:\s*/\s*(?:pixel|px|pt))?\s*"
)
"""Line with one number and its unit of length, which may be the edge of a pixel."""

_SAMPLING = {"dx", "dy", "resolution", "spacing", "step", "pitch", "increment", "interval", "sampling"}

_STATED_UNIT = re.compile(r"(lateral|value) units?\s*[:=]\s*(\S+)", re.IGNORECASE)

_WIDTH = "width|šířka|breite|anchura|largeur|larghezza|largura|ширина"
_HEIGHT = "height|výška|höhe|altura|hauteur|altezza|высота"
_SIZE = re.compile(
    rf"[#%\s]*(?P<what>[^:=\d]*?)\b(?:(?P<x>{_WIDTH})|{_HEIGHT})\s*[:=]\s*"
    r"(?P<number>[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?)\s*(?P<unit>~?[^\W\d_]*)\s*(?P<rest>.*)",
    re.IGNORECASE,
)
"""Line of a heading with a width or height."""

_POINTS = ("px", "pixel", "pixels", "pt", "pts", "point", "points")
_OF_MAP = ("", "image", "scan", "map", "field", "frame")
"""Words before the width and height of a map, not of a pixel, a pulse or a cursor."""


def column_units(header: Sequence[str], columns: int, separator: str) -> list[str | None]:
    """Unit of each column, None where the lines of the heading state none.

    They are taken from the last line with a field for each column of which one has a unit, such as ``x [mm];
    y [mm]; z``, ``X/mm; Z/um``, ``x_mm z_um`` or ``[mm]; [mm]; [um]``; then ``Lateral units: mm``, ``Value
    units: um``.
    """
    for line in reversed(header):
        plain = re.sub(r"\s+(?=[\[(])|\s+(?=in\s)|(?<=\sin)\s+", "_", line.strip("#% \t\r\n"))
        for mark in (separator, "\t", ";", ",", " "):
            fields = _fields(plain, mark)
            parts = [match and match.groupdict() for match in map(_COLUMN.fullmatch, fields)]
            is_bare = all(part and not part["name"] for part in parts)
            units = [part["unit"] if part and (is_bare or part["name"]) else None for part in parts]
            if len(units) == columns and any(units):
                return [unit.lower() if unit and len(unit) > 2 else unit for unit in units]
    stated = {found[1].lower(): found[2] for line in header if (found := _STATED_UNIT.search(line))}
    return [stated.get("lateral")] * (columns - 1) + [stated.get("value")]


def height_unit(header: Sequence[str], has_pixel: bool = False) -> str | None:
    """Unit of the heights of a matrix: the only one that the heading states of a height, a value or the data.

    Beside the edge of a pixel, and of an image, it may be called the unit alone.
    """
    units = set()
    for line in header:
        words = {*words_of(line)}
        for found in _HEIGHT_UNIT.finditer(line) if words.isdisjoint(_NOT_OF_HEIGHTS) else ():
            own = {*words_of(found["name"] or found["before"] or "")}
            is_bare = {"image", "units"} <= own or (has_pixel and len(own) == 1)
            if is_bare or ("image" not in own and not own.isdisjoint(_OF_HEIGHTS)):
                units.add(found["unit"] or found["after"])
    return units.pop() if len(units) == 1 else None


def names_points(header: Sequence[str], columns: int, separator: str) -> bool:
    """True if a line of the heading names the first of the columns x, y and z."""
    for line in header:
        for mark in (separator, " "):
            fields = _fields(line.strip("#% \t\r\n"), mark)
            fields = fields[len(fields) - columns :] if len(fields) in (columns, columns + 1) else []
            if [words_of(field)[:1] for field in fields[:2]] == [["x"], ["y"]]:
                return True
    return False


def ends_with_validity(header: Sequence[str], columns: int, separator: str) -> bool:
    """True if the heading calls the last column ``valid``, which is 0 for non-measured points."""
    named = [fields for line in header if len(fields := _fields(line.strip("#% \r\n"), separator)) == columns]
    return any(re.match(r"\W*valid", fields[-1], re.IGNORECASE) for fields in named)


def _fields(line: str, separator: str) -> list[str]:
    fields = [field.strip() for field in (line.split() if separator == " " else line.split(separator))]
    while fields and not fields[-1]:
        fields.pop()
    return fields


def stated_pixel(header: Sequence[str]) -> tuple[tuple[float, float], str | None] | None:
    """Edges (y, x) of a pixel that a heading states, and their unit; None if it does not.

    A line states it whose key holds ``pixel`` or ``XY``, or ``X`` or ``Y`` and a word such as ``resolution``.
    """
    sizes, units = dict[str, float](), dict[str, str | None]()
    for stated in filter(None, map(_PIXEL.fullmatch, header)):
        words = {*words_of(stated["what"])}
        of_pixel = "xy" in words or any(word.startswith("pixel") for word in words)
        if of_pixel or not words.isdisjoint(_SAMPLING):
            for axis in {word[-1] for word in words & {"x", "y", "dx", "dy"}} or (
                {"x", "y"} if of_pixel else ()
            ):
                sizes[axis], units[axis] = float(stated["number"]), stated["before"] or stated["after"]
    if len(sizes) < 2 or None in units.values() or not min(sizes.values()) > 0:
        return None
    return edges_in_one_unit((sizes["y"], sizes["x"]), (units["y"], units["x"]))


def zygo_lines(lines: Sequence[str]) -> int:
    """Number of lines of the heading of points that a program of Zygo wrote; 0 for others."""
    is_zygo = bool(lines) and lines[0].startswith("Zygo XYZ Data File")
    return next((number for number, line in enumerate(lines) if line.strip() == "#"), 0) if is_zygo else 0


def zygo_units(header: Sequence[str]) -> tuple[float, str | None, str] | None:
    """Pixel, its unit, and the unit of the heights of points that a program of Zygo wrote; None for others.

    Line 8 of the heading holds the pixel in metres, zero if the lens is not calibrated; heights are in µm
    (MetroPro Reference Guide OMP-0347, ASCII data files).
    """
    if not zygo_lines(header):
        return None
    try:
        pixel = float(header[7].split()[6])
    except (IndexError, ValueError):
        pixel = 0.0
    return (pixel, "m", "um") if pixel > 0 else (1.0, None, "um")


class MatrixSizes:
    """Widths and heights in the heading of a matrix, put so that SurfaceTopography finds the edges only.

    Parameters
    ----------
    rows, columns : int
        Of the matrix, or of all matrices in one text.

    Attributes
    ----------
    bare : dict of "x" | "y" to float
        Edges without a unit.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._count = {"y": rows, "x": columns}
        self.bare: dict[str, float] = {}

    def line(self, line: str) -> str:
        """A line as SurfaceTopography expects it; empty if its width or height is no edge of the map.

        Raises
        ------
        ValueError
            If it states another number of points than the matrix has.
        """
        if line[:1] in "+-.0123456789" or not (found := _SIZE.fullmatch(line)):
            return line
        axis, what, unit = "x" if found["x"] else "y", found["what"].strip().lower(), found["unit"]
        number, count = float(found["number"]), self._count[axis]
        of_pixel = what.removesuffix(" size") in ("pixel", "pixels")
        if found["rest"].strip(" ./") or not (of_pixel or what in _OF_MAP):
            return ""
        if unit.lower() in _POINTS:
            if number <= 0 or count % number:
                raise ValueError(
                    f"{count} {'columns' if found['x'] else 'rows'}, its heading says {line.strip()}"
                )
        elif re.fullmatch(_UNIT, unit):
            scale = f"Scale {axis.upper()} = {number}\n{axis}-unit = {unit}"
            return scale if of_pixel else f"# {'Width' if found['x'] else 'Height'}: {number} {unit}"
        elif not unit and number > 0 and (of_pixel or number != count):
            self.bare[axis] = number * count if of_pixel else number
        return ""
