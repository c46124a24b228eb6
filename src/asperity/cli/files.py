"""Result files that the commands read and write, and positions in them on the command line."""

import math
import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import netCDF4

from asperity.core.errors import shown
from asperity.core.units import to_si
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.answer_files import read_data
from asperity.engineering.folder import DATA, names_in
from asperity.results import dataset
from asperity.results.atomic import write_problem

OWN_BEGIN = {
    ".csv": rb"quantity,|[yx]_(um|cell_length),",
    ".vti": rb'<\?xml version="1.0" encoding="UTF-8"\?><VTKFile type="ImageData"',
    ".png": rb"\x89PNG.{20}\x08\x06",  # 8-bit RGBA, never a height map
    ".pdf": rb"%PDF",
    ".svg": rb"<\?xml",
}
"""Suffix → pattern of the first bytes of files that the commands write."""

MAKERS = {"contact": "asp.solve_contact", "stress": "asp.analyse_stress"}
"""Stage → function of the library that makes its results, besides `asperity run` and the study."""


def read_results(path: str | Path, stages: Collection[str]) -> dict[str, Any]:
    """Stage → result of a file, or of the folder of an answer, of the accepted stages.

    The contact of an answer is the answer itself: film, slip, coating and residual stress load its bodies.

    Raises
    ------
    ValueError
        If it is a result of another stage.
    DatasetError
        If it is missing or damaged.
    """
    path = Path(path)
    folder = path if path.is_dir() else path.parent
    is_answer = DATA in names_in(folder)
    if path.is_dir():
        answer = read_data(folder, AnswerData)
        surface = dataset.read(folder / "surface.nc") if "surface" in stages else None
        known = {"surface": surface, "contact": answer, "stress": answer.stress["lower"]}
        return {stage: known[stage] for stage in stages}
    data = dataset.read(path)
    stage = dataset.stage_of(data)
    if stage is None or stage not in stages:
        known_stages = " or ".join(stages)
        raise ValueError(f"{path}: a result of {stage or 'no stage'}, one of {known_stages} is needed")
    return {stage: read_data(folder, AnswerData) if is_answer and path.name == "contact.nc" else data}


def required(given: Mapping[str, Any], stage: str, what: str) -> Any:
    """The result of a stage, which an option or a figure needs; `ValueError` if none is given."""
    if stage not in given:
        maker = f" (of asperity run or {MAKERS[stage]})" if stage in MAKERS else ""
        raise ValueError(f"{what}: a {stage} file{maker} is needed, none is given")
    return given[stage]


def is_result(path: str | Path) -> bool:
    """True for a result of this package, False for a height map in another format."""
    try:
        with netCDF4.Dataset(path) as opened:
            return "settings" in opened.ncattrs()
    except (OSError, RuntimeError, ValueError):
        return False


def check_out(outs: Iterable[tuple[str, str]], inputs: Iterable[str] = ()) -> None:
    """Raise `ValueError` for the first file that cannot be written, or would destroy another one.

    Commands call it before they compute anything.

    Parameters
    ----------
    outs : iterable of (option, path)
        Files to write.
    inputs : iterable of str
        Files that are read.
    """
    read, written = [Path(path) for path in inputs if os.path.isfile(path)], set()
    for option, out in outs:
        if not out:
            raise ValueError(f"{option} = '': the name of a file is needed")
        if problem := write_problem(out):
            raise ValueError(f"{option} {out}: {problem}")
        path = Path(os.path.realpath(out))
        if path in written:
            raise ValueError(f"{option} {out}: named twice, each file needs its own name")
        written.add(path)
        if os.path.isfile(path):
            if any(path.samefile(each) for each in read):
                raise ValueError(f"{option} {out}: is read too, another name is needed")
            with open(path, "rb") as file:
                begin = file.read(100)
            own = OWN_BEGIN.get(path.suffix)
            # Only an empty file, or one in the format that a command writes, may be replaced.
            if begin and not (is_result(path) if own is None else re.match(own, begin, re.DOTALL)):
                raise ValueError(
                    f"{option} {out}: asperity has not written this file; another name is needed"
                )


_RANGE = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?\s*[A-Za-zµμ]*)\s*(?:-|\.\.)\s*([+-]?[\d.].*)")
_BARE = re.compile(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?")


def is_si(data: Any) -> bool:
    """True for a result in SI."""
    return isinstance(data, AnswerData) or data.attrs.get("unit_system") == "SI"


def length(name: str, text: str, si: bool) -> float:
    """Length from text, in m for SI results, else in cell lengths.

    Raises
    ------
    ValueError
        If it has no unit and the result is in SI, or has one and the result is dimensionless.
    """
    if si:
        return to_si(text, "length", name)
    with suppress(ValueError):
        if math.isfinite(value := float(text)):
            return value
    raise ValueError(
        f"{name} = {shown(text)}: a number in cell lengths is needed, because the result is dimensionless"
    )


def length_or_span(name: str, text: str, si: bool) -> float | tuple[float, float]:
    """A length, or two from text such as ``0-40um``; `ValueError` if it is neither."""
    try:
        return length(name, text, si)
    except ValueError:
        if not _RANGE.fullmatch(text.strip()):
            raise
        return span(name, text, si)


def span(name: str, text: str, si: bool) -> tuple[float, float]:
    """Two lengths from text such as ``0-40um``; a unit may be given once.

    Raises
    ------
    ValueError
        If the text is no range, or a length in it is not accepted.
    """
    found = _RANGE.fullmatch(text.strip())
    if found is None:
        example = "0-40um" if si else "0-0.1"
        raise ValueError(f"{name} = {shown(text)}: a range such as {example} is needed")
    first, last = found[1], found[2]
    if si and _BARE.fullmatch(first.strip()):
        first += "".join(re.findall(r"[A-Za-zµμ]+$", last)) or ""
    return length(name, first, si), length(name, last, si)


def positions(view: str, words: Sequence[str], known: Sequence[str]) -> dict[str, str]:
    """Values by name from words such as ``y=205um`` after the name of a view.

    Raises
    ------
    ValueError
        If a word is of another form, or its name is unknown or given twice.
    """
    found: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not known:
            raise ValueError(f"{shown(word)}: {view} takes no position")
        if not equals or name not in known or not value:
            accepted = ", ".join(f"{name}=..." for name in known)
            raise ValueError(f"{shown(word)}: one of {accepted} is needed")
        if name in found:
            raise ValueError(f"{shown(word)}: {name} is given twice")
        found[name] = value
    return found
