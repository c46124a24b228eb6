"""Materials by name: elastic constants, strengths and conductivities, each with its source.

The table is the data file ``materials.yaml`` beside this module. A user's own materials are in a file of the
same form, in which sources may be left out; they override the table.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from asperity.core.data import packaged_yaml
from asperity.core.errors import did_you_mean, shown
from asperity.settings.model import ContradictionError, Problem, SettingsError
from asperity.settings.reader import load

CONSTANTS = (
    *("young", "poisson", "yield_stress", "hardness", "fatigue_torsion", "fatigue_bending"),
    *("conductivity", "resistivity"),
)
"""Constants that a material may have, by their names in the groups of a body."""


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
    """

    name: str
    also: tuple[str, ...]
    group: str
    state: str
    constants: dict[str, Constant]


@cache
def table() -> dict[str, Material]:
    """The materials of the table by name."""
    return _materials(packaged_yaml("asperity.settings", "materials.yaml"), "materials.yaml")


_own: ContextVar[Mapping[str, Material]] = ContextVar("own materials", default=MappingProxyType({}))
"""Materials of the user that are known while the groups of a case are checked."""


@contextmanager
def own_materials(path: str | Path) -> Iterator[None]:
    """Add the materials in a user's file, which override the table, while the block runs.

    Raises
    ------
    InputError
        If it cannot be read, or an entry has another form.
    """
    token = _own.set(_materials(load(path), str(path)))
    try:
        yield
    finally:
        _own.reset(token)


def material(name: str) -> Material:
    """A material by its name or one of its other names; case, blanks and hyphens are ignored.

    Raises
    ------
    ContradictionError
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
    words = f"known are {', '.join(dict.fromkeys(found.name for found in names.values()))}"
    if near:
        words = f"did you mean {names[near.split()[-1].rstrip('?')].name}?"
    raise ContradictionError(("material", f" = {shown(name)}: the name of a material is needed; {words}"))


def _materials(content: Mapping[str, Any], file: str) -> dict[str, Material]:
    """The materials in the content of a file, with or without their sources."""
    sources, entries = content.get("sources", {}), content.get("materials", content)
    found, wrong = {}, []
    for name, entry in entries.items():
        if not isinstance(entry, Mapping):
            wrong.append(Problem(str(name), f" = {shown(entry)}: a group with young and poisson is needed"))
            continue
        constants = {}
        for key, given in entry.items():
            if key in CONSTANTS:
                group = given if isinstance(given, Mapping) else {"value": given}
                source = sources.get(group.get("source"), str(group.get("source", "")))
                place = ", ".join(filter(None, [source, str(group.get("place", ""))]))
                constants[key] = Constant(group.get("value"), group.get("range"), place)
            elif key not in ("also", "group", "state"):
                wrong.append(Problem(f"{name}.{key}", f": unknown key{did_you_mean(str(key), CONSTANTS)}"))
        also, kind = tuple(map(str, entry.get("also", ()))), (entry.get("group", ""), entry.get("state", ""))
        found[str(name)] = Material(str(name), also, *kind, constants)
    if wrong:
        raise SettingsError(file, wrong)
    return found


def _plain(name: str) -> str:
    return "".join(character for character in name.lower() if character.isalnum())
