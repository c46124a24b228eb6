"""Formats of height maps as `formats.yaml` lists them, and how a file is recognised by its first bytes."""

from __future__ import annotations

import os
import re
import zipfile
from dataclasses import dataclass
from functools import cache
from typing import BinaryIO

from asperity.core.data import packaged_yaml
from asperity.core.errors import shown

PROFILE = "profile"
"""Format that declares a line scan, in text or in the format of an instrument, as a map."""

TEXT_FORMATS = ("asc", "xyz", PROFILE)

ASKED_FOR = ("asc", "hgt", PROFILE)
"""Formats that no name stands for: any file of a suitable size could be ``hgt``, and a table a line scan."""

BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""First bytes of a text in UTF-16."""

BLOCK = 2**20
"""Bytes at the begin of a file by which it is recognised."""


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
        Regular expression for the first bytes; empty if they tell nothing.
    holds : str
        Regular expression for a member of a ZIP archive.
    reader : str
        Module of SurfaceTopography.IO that reads it; empty for those that asperity reads itself. Of ``asc``
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
    """Extension of a file name in small letters, that below ``.gz`` of a packed file."""
    return os.path.splitext(name.lower().removesuffix(".gz"))[1].removeprefix(".")


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


def formats_table() -> str:
    """The formats as a table in Markdown, for `docs/formats.md`."""
    rows = (
        f"| `{name}` | {form.program} | {', '.join(form.extensions)} |"
        for name, form in sorted(known_formats().items())
    )
    return "\n".join(["| format | files of | extensions |", "|---|---|---|", *rows])


def formats_in_words() -> str:
    """The formats in one sentence, for the help of a command."""
    return "Formats: " + "; ".join(
        f"{name} ({form.program}: {' '.join(form.extensions)})" for name, form in known_formats().items()
    )


def require_agreement(name: str, found: Format) -> None:
    """Raise `ValueError` if the extension of a file is that of other formats than its content."""
    extension = extension_of(name)
    named = [form.name for form in known_formats().values() if extension in form.extensions]
    both_text = found.name in TEXT_FORMATS and not {*named}.isdisjoint(TEXT_FORMATS)
    if named and found.name not in named and not both_text:
        raise ValueError(
            f"its name is that of format {' or '.join(named)}, its content of {found.name}; rename it, or "
            f"set format to {found.name}"
        )
