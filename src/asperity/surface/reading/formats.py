"""Formats of height maps by the first bytes of a file, and the channel that holds the heights.

`formats.yaml` lists the formats, and the words in the names of channels.
"""

import os
import re
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import BinaryIO, NamedTuple

import numpy as np

from asperity.core.data import packaged_yaml
from asperity.core.errors import one_line, shown
from asperity.core.types import Array

PROFILE = "profile"
"""Format by which the user declares a line scan, in text or in an instrument's format, to be a map."""

TEXT_FORMATS = ("asc", "xyz", PROFILE)

ASKED_FOR = ("asc", "hgt", PROFILE)
"""Formats read only on request: any file of a suitable size could be ``hgt``, any table a line scan."""

BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""First bytes of a text in UTF-16."""

BLOCK = 2**20
"""Bytes at the beginning of a file by which it is recognised."""


FEW_VALUES = 16
"""A channel beside others with no more values than this is a mask, or has numbers of regions."""

UNNAMED = "Default"
"""Name of the only channel of a file that does not name it, as SurfaceTopography has it."""

WORDS = {
    kind: frozenset(words.split())
    for kind, words in packaged_yaml("asperity.surface.reading", "formats.yaml")["channels"].items()
}
"""Words in names of channels that hold heights, and of channels that do not, even beside one of the first."""

_BACK = frozenset(("backward", "backwards", "bwd", "retrace", "reverse"))
_DIRECTIONS = _BACK | {"forward", "forwards", "fwd", "trace", "scan"}


@dataclass(frozen=True)
class Format:
    """A format of height maps.

    Parameters
    ----------
    name : str
    program : str
        Makers of such files.
    extensions : list of str
    begins : str
        Regular expression for the first bytes; empty if they are not characteristic.
    holds : str
        Regular expression for a member of a ZIP archive.
    reader : str
        Module of SurfaceTopography.IO that reads it; empty for formats that asperity reads itself. Of ``asc``
        it reads matrices with a header that it understands, `number_table` all others.
    """

    name: str
    program: str
    extensions: list[str]
    begins: str = ""
    holds: str = ""
    reader: str = ""


@cache
def known_formats() -> dict[str, Format]:
    """Name → format."""
    table = packaged_yaml("asperity.surface.reading", "formats.yaml")["formats"]
    return {name: Format(name, **entry) for name, entry in table.items()}


def possible_formats(begin: bytes, file: BinaryIO, name: str, wanted: str | None) -> list[Format]:
    """Formats in which a file may be read, in the order in which they are tried; text is named ``asc``.

    Raises
    ------
    ValueError, BadZipFile
        If the wanted format is not known, or an archive is damaged.
    """
    known = known_formats()
    if wanted is not None:
        if wanted not in known:
            raise ValueError(f"format = {shown(wanted)}: one of {', '.join(known)} is needed")
        return [known[wanted]]
    narrow = re.sub(b"^\xff\xfe|^\xfe\xff|\0", b"", begin[:256])  # text in UTF-16, one byte a character
    members: list[str] = []
    if re.match(b"PK", begin):
        with zipfile.ZipFile(file) as archive:
            members = archive.namelist()
    found = [
        form
        for form in known.values()
        if form.begins
        and (_match(form.begins, begin) or _match(form.begins, narrow))
        and (not form.holds or any(re.match(form.holds, member) for member in members))
    ]
    is_text = begin and (begin.startswith(BYTE_ORDER_MARKS) or b"\0" not in begin)
    if not found and is_text:
        return [known["asc"]]
    named = [form for form in known.values() if extension_of(name) in form.extensions]
    found += [form for form in named if form.reader and not form.begins and form.name not in ASKED_FOR]
    return sorted(found, key=lambda form: (not form.reader, form not in named))


def _match(begins: str, begin: bytes) -> bool:
    return re.match(begins.encode("latin-1"), begin) is not None


def extension_of(name: str) -> str:
    """Extension of a file name in small letters, without ``.gz``; also of ``...txt``."""
    stem, _, extension = os.path.basename(name).lower().removesuffix(".gz").rpartition(".")
    return extension if stem else ""


def unread_look(begin: bytes) -> str:
    """Description in words, with the remedy, of a file that only looks like one of a known format."""
    unread = packaged_yaml("asperity.surface.reading", "formats.yaml")["unread"]
    return next((words for words, begins in unread.items() if _match(begins, begin)), "")


def look_of(begin: bytes) -> str:
    """Description in words of the first bytes of a file that is not a map."""
    looks = packaged_yaml("asperity.surface.reading", "formats.yaml")["looks"]
    if found := next((words for words, begins in looks.items() if _match(begins, begin)), ""):
        return found
    if b"\0" in begin[2:] and not begin.startswith(BYTE_ORDER_MARKS):
        return "binary data without a known signature"
    return "text without a table of numbers" if begin else "an empty file"


def known_extensions() -> str:
    """Extensions of all formats as text."""
    return ", ".join(sorted({each for form in known_formats().values() for each in form.extensions}))


def formats_in_words() -> str:
    """The formats in one sentence, for the help of a command."""
    return "Formats: " + "; ".join(
        f"{name} ({form.program}: {' '.join(form.extensions)})" for name, form in known_formats().items()
    )


def require_agreement(name: str, found: Format) -> None:
    """Raise `ValueError` if the extension of a file belongs to other formats than its content."""
    extension = extension_of(name)
    named = [form.name for form in known_formats().values() if extension in form.extensions]
    both_text = found.name in TEXT_FORMATS and not {*named}.isdisjoint(TEXT_FORMATS)
    if named and found.name not in named and not both_text and found.name != "h5":  # which others contain
        raise ValueError(
            f"its name is of format {' or '.join(named)}, its content of {found.name}; rename it, or "
            f"set format to {found.name}"
        )


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


def choose_channel(
    channels: Sequence[Channel], wanted: str | int | None, values: Callable[[int], Array] | None = None
) -> tuple[int, str]:
    """Index of the requested channel, or of the one that holds the heights; and why the choice is in doubt.

    A channel holds heights if its data are of the kind ``height`` and its name has one of the words for
    heights and none of the words for other quantities. If no name has such a word, a channel without a word
    for another quantity is taken, unless its `values` are few: those of a mask, or labels of grains. Of the
    two directions of a scan the forward one is taken.

    Returns
    -------
    index : int
    doubt : str
        Empty if the choice is sure.

    Raises
    ------
    ValueError
        If the requested channel does not exist.
    """
    names = [str(channel.name) for channel in channels]
    if wanted is not None:
        if names.count(str(wanted)) == 1:
            return names.index(str(wanted)), ""
        if str(wanted).isdecimal() and int(wanted) < len(names):
            return int(wanted), ""
        raise ValueError(f"channel = {shown(wanted)}: one of {_listed(names, range(len(names)))} is needed")
    # 2 for a channel that holds heights by its name, 1 for one that may, 0 for one that does not.
    ranks = []
    for channel in channels:
        words = {*words_of(channel.name)}
        words |= {word.removesuffix("s") for word in words}
        is_height, is_picture = (not WORDS[kind].isdisjoint(words) for kind in ("heights", "pictures"))
        is_other = channel.kind != "height" or not WORDS["others"].isdisjoint(words)
        ranks.append(0 if is_other or (is_picture and not is_height) else 1 + is_height)
    best = [number for number, rank in enumerate(ranks) if rank == max(ranks)]
    if values is not None and max(ranks) == 1 < len(channels):
        best = [number for number in best if np.unique(values(number)).size > FEW_VALUES]
    if max(ranks) == 0 or not best:
        known = _listed(names, range(len(names)))
        return ranks.index(max(ranks)), f"channel: by name or unit none of {known} holds heights; set it"
    same = {tuple(word for word in words_of(names[number]) if word not in _DIRECTIONS) for number in best}
    forward = [number for number in best if _BACK.isdisjoint(words_of(names[number]))]
    if len(best) > 1 and not (len(same) == 1 and len(forward) == 1):
        return best[0], f"channel: {_listed(names, best)} may hold the heights; set it"
    return (forward if len(best) > 1 else best)[0], ""


def words_of(name: str) -> list[str]:
    """The words of a name such as ``vDeflection``, ``height_map`` or ``Scan forward (Z-Axis)``."""
    return [
        word.lower() for word in re.findall(r"[A-ZÄÖÜ]?[^\W\d_A-ZÄÖÜ]+|[A-ZÄÖÜ]+(?![^\W\d_A-ZÄÖÜ])", name)
    ]


def _listed(names: Sequence[str], numbers: Sequence[int]) -> str:
    return ", ".join(f"{number} ({one_line(names[number])})" for number in numbers)
