"""Lengths and ranges on the command line: with units for SI results, in cell lengths for others."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from contextlib import suppress

import xarray as xr

from asperity.core.errors import shown
from asperity.core.units import shown_si, to_si

_RANGE = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?\s*[A-Za-zµμ]*)\s*(?:-|\.\.)\s*([+-]?[\d.].*)")
_BARE = re.compile(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?")


def is_si(data: xr.Dataset) -> bool:
    """True for a result in SI."""
    return data.attrs.get("unit_system") == "SI"


def in_words(value: float, unit: str, si: bool) -> str:
    """A number in SI with its unit, or one in the units of the study."""
    if si:
        return shown_si(value, unit)
    return f"{value:.6g} E*" if unit == "Pa" else f"{value:.6g}"


def length(name: str, text: str, si: bool) -> float:
    """Length from text, in m for SI results, else in cell lengths.

    Raises
    ------
    ValueError
        If it has no unit although the result is in SI, or one although it is dimensionless.
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
