"""Lengths and ranges on the command line: with units for SI results, in cell lengths for others."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import xarray as xr

from asperity.core.errors import shown
from asperity.core.units import to_si

_RANGE = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?\s*[A-Za-zµμ]*)\s*(?:-|\.\.)\s*([+-]?[\d.].*)")
_BARE = re.compile(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?")


def is_si(data: xr.Dataset) -> bool:
    """True for a result in SI."""
    return data.attrs.get("unit_system") == "SI"


def length(name: str, text: str, si: bool) -> float:
    """Length from text, in m for SI results, else in cell lengths.

    Raises
    ------
    ValueError
        If it has no unit although the result is in SI, or one although it is dimensionless.
    """
    if si:
        return to_si(text, "length", name)
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(
            f"{name} = {shown(text)}: a number in cell lengths is needed, because the result is dimensionless"
        )
    return value


def is_span(text: str) -> bool:
    """True for text such as ``0-40um``."""
    return _RANGE.fullmatch(text.strip()) is not None


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
