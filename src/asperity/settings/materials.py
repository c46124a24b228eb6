"""Materials by name: elastic constants, strengths and conductivities, each with its source.

The table is the data file ``materials.yaml`` beside this module. A user's own materials are in a file of the
same form, in which sources may be left out; they override the table, and are part of the case that uses them.
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple

from pydantic import PlainSerializer, PlainValidator, WithJsonSchema

from asperity.core.data import packaged_yaml
from asperity.core.errors import InputError, did_you_mean, shown
from asperity.core.system import sha256_of
from asperity.settings.model import NeededError, SettingsError
from asperity.settings.reader import load

CONSTANTS = (
    *("young", "poisson", "yield_stress", "hardness", "fatigue_torsion", "fatigue_bending"),
    *("conductivity", "resistivity"),
)
"""Constants that a material may have, by their names in the groups of a body."""

ABOUT = ("also", "group", "state", "file", "sha256")
"""Other keys of a material. A case names with the last two the file of a user's own material."""


class Constant(NamedTuple):
    """A constant of a material: its value as a setting takes it, its range, and where both are from."""

    value: Any
    range: tuple[Any, Any] | None = None
    source: str = ""


class Material(NamedTuple):
    """A material of the table.

    Attributes
    ----------
    name : str
    also : tuple of str
        Other names.
    group, state : str
        Kind of material, and its heat treatment or form.
    constants : dict
        Name of a constant → `Constant`.
    file, sha256 : str
        Of a user's own material: its file, and the checksum of the file when it was read.
    """

    name: str
    also: tuple[str, ...]
    group: str
    state: str
    constants: dict[str, Constant]
    file: str = ""
    sha256: str = ""

    def written(self) -> dict[str, Any]:
        """The material as an entry of a table in a case file."""
        about = {"also": list(self.also)} | {name: getattr(self, name) for name in ABOUT[1:]}
        constants = {
            name: {key: each for key, each in found._asdict().items() if each}
            for name, found in self.constants.items()
        }
        return {name: each for name, each in about.items() if each} | constants


@cache
def table() -> dict[str, Material]:
    """The materials of the table by name."""
    return _materials(packaged_yaml("asperity.settings", "materials.yaml"))


_own: ContextVar[Mapping[str, Material]] = ContextVar("own materials", default=MappingProxyType({}))
"""Materials of the user that are known while the groups of a case are checked."""


@contextmanager
def known_materials(materials: Mapping[str, Material]) -> Iterator[None]:
    """Add materials of the user, which override the table, while the block runs."""
    token = _own.set({**_own.get(), **materials})
    try:
        yield
    finally:
        _own.reset(token)


def material(name: str) -> Material:
    """A material by its name or one of its other names; case, blanks and hyphens are ignored.

    Parameters
    ----------
    name : str

    Returns
    -------
    Material
        With its `constants`, each with value, range and source.

    Raises
    ------
    SettingsError
        If there is none; the message suggests the nearest name. It is a `ValueError`.

    Examples
    --------
    >>> asp.material("100Cr6").constants["young"].value
    '210 GPa'
    """
    known = {**table(), **_own.get()}.values()
    names = {_plain(each): found for found in known for each in (found.name, *found.also)}
    if _plain(name) in names:
        return names[_plain(name)]
    near = did_you_mean(_plain(name), names)
    of_group = [each.name for each in known if _plain(name) in _plain(each.group)]
    words = "asperity case --materials lists them"
    if of_group:
        words = f"did you mean one of {', '.join(of_group)}?"
    elif near:
        words = f"did you mean {names[near.split()[-1].rstrip('?')].name}?"
    raise SettingsError("", [("material", f" = {shown(name)}: the name of a material is needed; {words}")])


def own_materials(given: Any) -> dict[str, Material]:
    """The materials in a user's file or in a table of the same form, by name.

    Raises
    ------
    SettingsError
        If the file cannot be read, or an entry has another form.
    """
    if isinstance(given, Mapping):
        return _materials(given)
    if not isinstance(given, (str, os.PathLike)):
        raise NeededError("the name of a file, or a group of materials")
    file = os.fspath(given)
    try:
        return _materials(load(file), file, sha256_of(file))
    except SettingsError:
        raise
    except InputError as error:
        raise SettingsError("", [f" = {shown(file)}: {each}" for each in error.problems]) from None


OwnMaterials = Annotated[
    Any,
    PlainValidator(own_materials),
    PlainSerializer(lambda materials: {name: each.written() for name, each in materials.items()}),
    WithJsonSchema(
        {
            "anyOf": [{"type": "string", "format": "path"}, {"type": "object"}],
            "accepts": "the name of a file, or a group of materials as in such a file",
        }
    ),
]
"""Materials of the user by name, read from a file or a table."""


def _materials(content: Mapping[str, Any], file: str = "", sha256: str = "") -> dict[str, Material]:
    """The materials in the content of a file, with or without their sources."""
    sources, entries = content.get("sources", {}), content.get("materials", content)
    if not isinstance(sources, Mapping) or not isinstance(entries, Mapping):
        raise SettingsError("", [": groups of keys `materials` and `sources` are needed"])
    found, wrong = {}, []
    for name, entry in entries.items():
        if isinstance(entry, Material):
            found[name] = entry
            continue
        if not isinstance(entry, Mapping):
            wrong.append((str(name), f" = {shown(entry)}: a group with young and poisson is needed"))
            continue
        constants, about = {}, {"group": "", "state": "", "file": file, "sha256": sha256}
        for key, given in entry.items():
            if key in CONSTANTS:
                group = given if isinstance(given, Mapping) else {"value": given}
                source, span = str(group.get("source", os.path.basename(file))), group.get("range")
                place = ", ".join(
                    filter(None, [str(sources.get(source, source)), str(group.get("place", ""))])
                )
                constants[key] = Constant(
                    group.get("value"), tuple(span) if isinstance(span, (list, tuple)) else None, place
                )
            elif key not in ABOUT:
                wrong.append((f"{name}.{key}", f": unknown key{did_you_mean(str(key), CONSTANTS)}"))
            elif key != "also":
                about[key] = str(given)
        also = entry.get("also", ())
        also = also if isinstance(also, (list, tuple)) else [also]
        found[str(name)] = Material(str(name), tuple(map(str, also)), constants=constants, **about)
    if wrong:
        raise SettingsError("", wrong)
    return found


def _plain(name: str) -> str:
    return "".join(character for character in name.lower() if character.isalnum())
