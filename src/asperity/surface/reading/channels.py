"""The channel of a file that holds the heights, found by its name and the kind of its data."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from asperity.core.data import packaged_yaml
from asperity.core.errors import one_line, shown

UNNAMED = "Default"
"""Name of the only channel of a file that does not name it, as SurfaceTopography has it."""

WORDS = {
    kind: frozenset(words.split())
    for kind, words in packaged_yaml("asperity.surface.reading", "formats.yaml")["channels"].items()
}
"""Words in names of channels that hold heights, and of those that do not, even beside one of the first."""

_BACK = frozenset(("backward", "backwards", "bwd", "retrace", "reverse"))
_DIRECTIONS = _BACK | {"forward", "forwards", "fwd", "trace", "scan"}


class Channel(NamedTuple):
    """A channel of a file.

    Parameters
    ----------
    name : str
    shape : (ny, nx), optional
        None for line scans and lists of points.
    kind : str
        Kind of its data, such as ``height`` or ``phase``.
    """

    name: str
    shape: tuple[int, int] | None
    kind: str = "height"


def choose_channel(channels: Sequence[Channel], wanted: str | int | None) -> tuple[int, str]:
    """Number of the channel that is wanted, or that holds the heights; and why that is in doubt, if it is.

    Heights are in a channel whose data are of this kind and whose name has a word of them and none of others;
    if there is no such name, in one without a word of others. Of two directions of a scan the forward one is
    taken.

    Raises
    ------
    ValueError
        If there is none, or not the one that is wanted.
    """
    names = [str(channel.name) for channel in channels]
    if wanted is not None:
        if names.count(str(wanted)) == 1:
            return names.index(str(wanted)), ""
        if str(wanted).isdecimal() and int(wanted) < len(names):
            return int(wanted), ""
        raise ValueError(f"channel = {shown(wanted)}: one of {_listed(names, range(len(names)))} is needed")
    # 2 for a channel that is a height by its name, 1 for one that may be, 0 for one that is not.
    ranks = [
        0
        if channel.kind != "height" or not WORDS["others"].isdisjoint(_words(channel.name))
        else 2 - WORDS["heights"].isdisjoint(_words(channel.name))
        for channel in channels
    ]
    best = [number for number, rank in enumerate(ranks) if rank == max(ranks)]
    if max(ranks) == 0:
        return best[0], f"channel: by name or unit none of {_listed(names, best)} holds heights; set it"
    same = {tuple(word for word in _words(names[number]) if word not in _DIRECTIONS) for number in best}
    forward = [number for number in best if _BACK.isdisjoint(_words(names[number]))]
    if len(best) > 1 and not (len(same) == 1 and len(forward) == 1):
        return best[0], f"channel: {_listed(names, best)} may hold the heights; set it"
    return (forward if len(best) > 1 else best)[0], ""


def _words(name: str) -> list[str]:
    """The words of a name such as ``vDeflection``, ``height_map`` or ``Scan forward (Z-Axis)``."""
    return [
        word.lower() for word in re.findall(r"[A-ZÄÖÜ]?[^\W\d_A-ZÄÖÜ]+|[A-ZÄÖÜ]+(?![^\W\d_A-ZÄÖÜ])", name)
    ]


def _listed(names: Sequence[str], numbers: Sequence[int]) -> str:
    return ", ".join(f"{number} ({one_line(names[number])})" for number in numbers)
