"""Case files: YAML with the groups of a case, which ``asperity run`` takes in place of a map.

It writes one beside every answer. Besides the groups of `asperity.Case` a file may have ``out``, the folder
of the answer, and ``checksums`` of the maps, with which a case is refused once they have changed. Names of
files are relative to the folder of the file. ``map`` and ``counter_body.map`` may be the name of the map
alone. ``map.file`` may be a list of several maps, or a pattern such as ``ring_*.x3p``; then the map of the
counter body may be a list, too.
"""

import copy
import glob
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import yaml

from asperity.core.errors import InputError, one_line, shown
from asperity.core.system import sha256_of
from asperity.core.version import __version__
from asperity.engineering.case import Case
from asperity.engineering.face import ReadFile
from asperity.engineering.folder import CASE_FILE, DATA, checksums_in
from asperity.engineering.scene import MATERIALS, Scene
from asperity.results.atomic import write_text
from asperity.settings.map import file_name, with_file
from asperity.settings.model import (
    Entry,
    Problem,
    Settings,
    SettingsError,
    described,
    entry_of,
    inside,
    item_of,
    optional,
)
from asperity.settings.reader import load
from asperity.surface.reading.container import maps_in
from asperity.surface.reading.height_map import HeightMap

SUFFIXES = (".yaml", ".yml")
"""Ends of the names of case files."""

CHECKSUMS, OUT = "checksums", "out"
"""Keys of a case file that are no groups of a case."""

MAP_FILES = (("map", "file"), ("counter_body", "map", "file"))
"""Keys of the maps."""

STAND_INS: tuple[Mapping[str, Any], ...] = (
    {
        "map": {"file": "map"},
        "body": {"material": "100Cr6"},
        "load": {"mean_pressure": "1 MPa"},
        "material": "100Cr6",
        "young": "200 GPa",
        "poisson": 0.3,
    },
    {
        "map": {"file": "map"},
        "body": {},
        "load": {"hertz_pressure": "1 kPa", "radius_x": "1 m"},
        "material": None,
        "young": "1 MPa",
        "poisson": 0.4,
    },
)
"""Two values of each group or setting in place of those with problems, to check the others."""


class Checksums(Settings):
    """SHA-256 checksums of the maps; of several maps a list."""

    map: str | list[str] | None = optional("not compared", accepts="a checksum, or a list of them")
    counter_map: str | list[str] | None = optional("not compared", accepts="a checksum, or a list of them")


class FileKeys(Settings):
    """Keys of a case file that are no groups of a case."""

    out: str | None = optional("after the map", accepts="the name of a folder")
    checksums: Checksums | None = optional("files are not compared")


def load_case(path: str | Path) -> dict[str, Any]:
    """The content of a case file, with names of files relative to the working folder.

    Raises
    ------
    InputError
        If it cannot be read, names of files are none, or lists of maps differ in length.
    """
    path, content = Path(path), copy.deepcopy(load(path))
    own = {key: content.pop(key) for key in (OUT, CHECKSUMS) if key in content}
    content |= FileKeys.read(own, str(path)).written()
    for *groups, name in (keys[:-1] for keys in MAP_FILES):
        if isinstance(group := at(content, groups), dict) and name in group:
            group[name] = with_file(group[name])
    if (path.parent / MATERIALS).is_file():
        content.setdefault("materials", MATERIALS)
    maps = at(content, MAP_FILES[0])
    for keys in _names_in(content):
        given = at(content, keys)
        try:
            if isinstance(given, list) and keys in MAP_FILES:
                if not (given and isinstance(maps, list) and len(given) == len(maps)):
                    raise ValueError(f"a list of {len(maps) if isinstance(maps, list) else 1} names")
                put(content, keys, [str(path.parent / file_name(each)) for each in given])
            else:
                file = path.parent / file_name(given)
                put(content, keys, matches(given, path.parent) if keys in MAP_FILES else str(file))
        except ValueError as error:
            raise InputError(str(path), [f"{'.'.join(keys)} = {shown(given)}: {error} is needed"]) from None
    return content


def read_case(content: Mapping[str, Any]) -> Case:
    """The case of the content of a case file.

    Raises
    ------
    SettingsError
        With all problems, also those that `Case.read` finds only after others are solved.
    """
    try:
        return Case.read(content)
    except SettingsError as error:
        first, second = (_hidden(content, error.found, number) for number in range(len(STAND_INS)))
        hidden = [each for each in first if each in second]  # others come from the stand-ins
        raise SettingsError("", dict.fromkeys([*error.found, *hidden])) from None


def _hidden(content: Mapping[str, Any], found: Sequence[Problem], number: int) -> list[Problem]:
    """Problems that show with a stand-in in place of each setting with a problem, apart from its groups."""
    content, changed, hidden = copy.deepcopy(dict(content)), list[str](), list[Problem]()
    while new := [each.key for each in found if changed.count(f"{each.key}.") < len(STAND_INS)]:
        for key in dict.fromkeys(new):
            _replace(content, key, number, changed.count(f"{key}.") != number)
            changed.append(f"{key}.")
        found = ()
        try:
            Case.read(content)
        except SettingsError as error:
            found = error.found
        for each in found:
            key = f"{each.key}."
            if not any(key.startswith(other) or other.startswith(key) for other in changed):
                hidden.append(each)
    return hidden


def _replace(content: Any, key: str, number: int, has_example: bool) -> None:
    """Put a stand-in, or an example, in place of a setting, or leave it out if it is given, once of twice."""
    keys = ["load"] if key.startswith("load.") else key.split(".")
    while keys[-1].isdecimal() or (keys[:-1] and not isinstance(at(content, keys[:-1]), (dict, list))):
        keys.pop()
    value, given = STAND_INS[number].get(keys[-1]), at(content, keys)
    if keys[-1] not in STAND_INS[number]:
        entry = entry_of(Case, ".".join(keys))
        if has_example or given is None:
            value = entry.get("example")
        if value is None and given is not None and entry and number:
            return  # other settings may need it, and would have a problem with both stand-ins
    put(content, keys, value)
    if value is None:
        del at(content, keys[:-1])[keys[-1]]


def _names_in(content: Mapping[str, Any]) -> list[Sequence[str]]:
    """Keys of all names of files in the content of a case file."""
    own = at(content, ["materials"])
    of_materials = (
        [("materials", name, "file") for name in own] if isinstance(own, Mapping) else [("materials",)]
    )
    return [keys for keys in (*MAP_FILES, (OUT,), *of_materials) if at(content, keys) is not None]


def files_with_checksums(content: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Key, name and checksum of each file from which a case was computed: maps, and materials of the user."""
    for name, keys in zip(("map", "counter_map"), MAP_FILES, strict=True):
        given = at(content, keys), at(content, (CHECKSUMS, name))
        files, checksums = (each if isinstance(each, list) else [each] for each in given)
        pairs = zip(files, checksums, strict=False)
        yield from ((f"{CHECKSUMS}.{name}", *pair) for pair in pairs if None not in pair)
    own = content.get("materials")
    for name, entry in own.items() if isinstance(own, Mapping) else ():
        file, checksum = at(entry, ["file"]), at(entry, ["sha256"])
        if None not in (file, checksum):
            yield f"materials.{name}.sha256", str(file), checksum


def changed_files(content: Mapping[str, Any]) -> Iterator[Problem]:
    """A problem for each file of a case that has another checksum now."""
    for key, file, checksum in files_with_checksums(content):
        if os.path.isfile(file) and sha256_of(file) != checksum:
            kept = (
                "use the file as it is now" if key.startswith(CHECKSUMS) else "keep the constants in the case"
            )
            changed = f"{one_line(file)} has changed since the case was written"
            yield Problem(key, f": {changed}; delete `{key}` in the case file to {kept}")


def case_of_answer(folder: Path) -> dict[str, Any]:
    """The groups of the case file in the folder of an answer; errors as of `load_case`."""
    content = load_case(folder / CASE_FILE)
    return {name: group for name, group in content.items() if name not in (OUT, CHECKSUMS)}


def matches(name: str, folder: Path) -> str | list[str]:
    """Files of a folder that match a pattern such as ``ring_*.x3p``, in order, or the maps in a container.

    One name if there is only one.
    """
    if glob.has_magic(name) and not (folder / name).exists():
        found = [str(folder / each) for each in sorted(glob.glob(name, root_dir=folder))]
        return found if len(found) > 1 else (found or [str(folder / name)])[0]
    found = maps_in(str(folder / name))
    return found if len(found) > 1 else found[0]


def case_of_map(content: Mapping[str, Any], number: int) -> dict[str, Any]:
    """The content of a case file for one of its maps."""
    found = copy.deepcopy(dict(content))
    for keys in (*MAP_FILES, (CHECKSUMS, "map"), (CHECKSUMS, "counter_map")):
        if isinstance(given := at(found, keys), list):
            put(found, keys, at(given, [str(number)]))
    return found


def at(content: Any, keys: Sequence[str]) -> Any:
    """The value at nested keys, of which a number is a place in a list; None if there is none."""
    for key in keys:
        if isinstance(content, list):
            content = content[int(key)] if key.isdecimal() and int(key) < len(content) else None
        else:
            content = content.get(key) if isinstance(content, Mapping) else None
    return content


def put(content: Any, keys: Sequence[str], value: Any) -> None:
    """Set the value at nested keys; groups on the way are made, and a list where the next key is a number."""
    key, *rest = keys
    if rest:
        below = at(content, [key])
        if not isinstance(below, dict) and not (isinstance(below, list) and str(rest[0]).isdecimal()):
            below = [] if str(rest[0]).isdecimal() else {}
        put(below, rest, value)
        value = below
    if isinstance(content, list):
        content += [None] * (int(key) > len(content))  # a list with a gap is refused
        content[int(key) : int(key) + 1] = [value]
    else:
        content[key] = value


def leaves(content: Any, known: Entry | None = None, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted key and value of every setting of a case; an empty group is one too."""
    known = described(Case) if known is None else known
    for name, value in enumerate(content) if isinstance(content, list) else content.items():
        below = inside(known, name) or {}
        if value and isinstance(value, (Mapping, list)) and "properties" in item_of(below):
            yield from leaves(value, below, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def names_of_maps(paths: Sequence[str]) -> list[str]:
    """Names of folders for several answers: stems of the files, with their folders if equal, else whole."""
    files = [Path(path) for path in paths]
    choices = [
        [file.stem for file in files],
        [f"{file.absolute().parent.name}_{file.stem}" for file in files],
        [file.name for file in files],
    ]
    counts = [Counter(names) for names in choices]
    return [
        next((name for name, count in zip(names, counts, strict=True) if count[name] == 1), names[-1])
        for names in zip(*choices, strict=True)
    ]


def save_case(case: Scene, path: Path, out: Path | None = None, files: Sequence[ReadFile] = ()) -> None:
    """Write a case as the YAML file that ``asperity run`` takes in place of a map.

    Names of files in it are relative to its folder, or absolute as they were given.

    Parameters
    ----------
    case : Case
        With a map from a file.
    path : Path
    out : Path, optional
        Folder of the answer.
    files : sequence of ReadFile, optional
        Files of the maps as they were read, in their order: with their checksums ``asperity run`` refuses the
        case once they have changed.

    Raises
    ------
    ValueError
        If the path names a map of the case.
    """
    maps = [each.file for each in (case.map, case.counter_map) if each is not None]
    for source in (each for each in maps if not isinstance(each, HeightMap) and path.exists()):
        if path.samefile(source):
            raise ValueError(f"path = {path}: the map of the case, another name is needed")
    write_text(path, case_text(case, path.parent, out, files))


def case_text(case: Scene, folder: Path, out: Path | None = None, files: Sequence[ReadFile] = ()) -> str:
    """The content of a case file in a folder; see `save_case`."""
    return _text(_content(case, folder, out, files))


def _content(case: Scene, folder: Path, out: Path | None, files: Sequence[ReadFile]) -> dict[str, Any]:
    """The groups of a case, with names of files relative to a folder."""
    content = case.written() | ({} if out is None else {OUT: os.fspath(out)})
    maps = {"map": case.map, "counter_map": case.counter_map}
    named = [name for name, each in maps.items() if each is not None and not isinstance(each.file, HeightMap)]
    if files:
        content[CHECKSUMS] = {name: file.sha256 for name, file in zip(named, files, strict=False)}
    for keys in _names_in(content):
        given = at(content, keys)
        if not os.path.isabs(given):
            put(content, keys, Path(os.path.relpath(given, folder)).as_posix())
    return content


def pool_text(cases: Sequence[tuple[Scene, Sequence[ReadFile]]], folder: Path) -> str:
    """The content of the case file of pooled maps, with the checksums of all their files."""
    each = [_content(case, folder, None, files) for case, files in cases]
    content = copy.deepcopy(each[0])
    for keys in (*MAP_FILES, (CHECKSUMS, "map"), (CHECKSUMS, "counter_map")):
        if at(content, keys) is not None:
            put(content, keys, [at(one, keys) for one in each])
    content.setdefault("sample", {})
    return _text(content)


def _text(content: Mapping[str, Any]) -> str:
    return yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True)


def same_case(text: str, case: Scene, files: Sequence[ReadFile]) -> bool:
    """True if the text of a case file describes a case; its maps may be elsewhere, with equal checksums."""
    try:
        there = yaml.safe_load(text)
    except yaml.YAMLError:
        return False
    here = yaml.safe_load(case_text(case, Path(), files=files))
    if not isinstance(there, dict):
        return False
    for content in (there, here):
        for keys in _names_in(content):
            put(content, keys, "")
        content.pop("sample", None)
    return there == here


def holds_answer(folder: Path, case: Scene, files: Sequence[ReadFile]) -> bool:
    """True if a folder has the results of a case, of this version, with all files unchanged."""
    checksums = checksums_in(folder)
    if not {DATA, "contact.nc", CASE_FILE} <= checksums.keys():
        return False
    for name, checksum in checksums.items():
        if not (folder / name).is_file() or sha256_of(folder / name) != checksum:
            return False
    with netCDF4.Dataset(folder / "contact.nc") as opened:
        if getattr(opened, "source", "") != f"asperity {__version__}":
            return False
    return same_case((folder / CASE_FILE).read_text(encoding="utf-8"), case, files)
