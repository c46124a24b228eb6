"""Case files: YAML with the groups of a case, which ``asperity run`` takes in place of a map.

It writes one beside every answer. Besides the groups of `asperity.Case` a file may have ``out``, the folder
of the answer, and ``checksums`` of the maps, with which a case is refused once they have changed. Names of
files are relative to the folder of the file. ``map.file`` may be a list of several maps, or a pattern such as
``ring_*.x3p``; then the map of the counter body may be a list, too.
"""

import copy
import glob
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import yaml

from asperity.core.errors import InputError, shown
from asperity.core.system import sha256_of
from asperity.core.version import __version__
from asperity.engineering.case import Case
from asperity.engineering.face import ReadFile
from asperity.engineering.folder import CASE_FILE, checksums_in
from asperity.engineering.scene import MATERIALS
from asperity.results.atomic import write_text
from asperity.settings.reader import load
from asperity.surface.reading.height_map import HeightMap

SUFFIXES = (".yaml", ".yml")
"""Ends of the names of case files."""

CHECKSUMS, OUT = "checksums", "out"
"""Keys of a case file that are no groups of a case."""

MAP_FILES = (("map", "file"), ("counter_body", "map", "file"))
"""Keys of the maps."""


def load_case(path: str | Path) -> dict[str, Any]:
    """The content of a case file, with names of files relative to the working folder.

    Raises
    ------
    InputError
        If it cannot be read, or lists of maps differ in length.
    """
    path, content = Path(path), copy.deepcopy(load(path))
    if isinstance(content.get("map"), (str, list)):
        content["map"] = {"file": content["map"]}
    if (path.parent / MATERIALS).is_file():
        content.setdefault("materials", MATERIALS)
    maps = at(content, MAP_FILES[0])
    for keys in (*MAP_FILES, (OUT,), ("materials",)):
        given = at(content, keys)
        if isinstance(given, str):
            file = str(path.parent / given)
            put(content, keys, matches(file) if keys in MAP_FILES else file)
        elif isinstance(given, list):
            if not (given and isinstance(maps, list) and len(given) == len(maps)) or not all(
                isinstance(each, str) and each for each in given
            ):
                needed = f"a list of {len(maps) if isinstance(maps, list) else 1} names is needed"
                raise InputError(str(path), [f"{'.'.join(keys)} = {shown(given)}: {needed}"])
            put(content, keys, [str(path.parent / each) for each in given])
    return content


def case_of_answer(folder: Path) -> dict[str, Any]:
    """The groups of the case file in the folder of an answer; errors as of `load_case`."""
    content = load_case(folder / CASE_FILE)
    return {name: group for name, group in content.items() if name not in (OUT, CHECKSUMS)}


def matches(name: str) -> str | list[str]:
    """Files that match a pattern such as ``ring_*.x3p``, in order; the name itself if less than two match."""
    if glob.has_magic(name) and not os.path.exists(name):
        found = sorted(glob.glob(name))
        return found if len(found) > 1 else (found or [name])[0]
    return name


def case_of_map(content: Mapping[str, Any], number: int) -> dict[str, Any]:
    """The content of a case file for one of its maps."""
    found = copy.deepcopy(dict(content))
    for keys in (*MAP_FILES, (CHECKSUMS, "map"), (CHECKSUMS, "counter_map")):
        if isinstance(given := at(found, keys), list):
            put(found, keys, given[number])
    return found


def at(content: Any, keys: Sequence[str]) -> Any:
    """The value at nested keys; None if there is none."""
    for key in keys:
        content = content.get(key) if isinstance(content, Mapping) else None
    return content


def put(content: dict[str, Any], keys: Sequence[str], value: Any) -> None:
    """Set the value at nested keys; groups on the way are made."""
    *groups, last = keys
    for key in groups:
        if not isinstance(content.get(key), dict):
            content[key] = {}
        content = content[key]
    content[last] = value


def names_of_maps(paths: Sequence[str]) -> list[str]:
    """Names of folders for several answers: stems of the files, equal ones after the folder's name."""
    stems = [Path(path).stem for path in paths]
    count = Counter(stems)
    return [
        stem if count[stem] == 1 else f"{Path(path).resolve().parent.name}_{stem}"
        for path, stem in zip(paths, stems, strict=True)
    ]


def save_case(case: Case, path: Path, out: Path | None = None, files: Sequence[ReadFile] = ()) -> None:
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


def case_text(case: Case, folder: Path, out: Path | None = None, files: Sequence[ReadFile] = ()) -> str:
    """The content of a case file in a folder; see `save_case`."""
    return _text(_content(case, folder, out, files))


def _content(case: Case, folder: Path, out: Path | None, files: Sequence[ReadFile]) -> dict[str, Any]:
    """The groups of a case, with names of files relative to a folder."""
    content = case.written() | ({} if out is None else {OUT: os.fspath(out)})
    maps = {"map": case.map, "counter_map": case.counter_map}
    named = [name for name, each in maps.items() if each is not None and not isinstance(each.file, HeightMap)]
    if files:
        content[CHECKSUMS] = {name: file.sha256 for name, file in zip(named, files, strict=False)}
    for keys in (*MAP_FILES, (OUT,), ("materials",)):
        given = at(content, keys)
        if given is not None and not os.path.isabs(given):
            put(content, keys, Path(os.path.relpath(given, folder)).as_posix())
    return content


def pool_text(cases: Sequence[tuple[Case, Sequence[ReadFile]]], folder: Path) -> str:
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


def same_case(text: str, case: Case, files: Sequence[ReadFile]) -> bool:
    """True if the text of a case file describes a case; its maps may be elsewhere, with equal checksums."""
    try:
        there = yaml.safe_load(text)
    except yaml.YAMLError:
        return False
    here = yaml.safe_load(case_text(case, Path(), files=files))
    if not isinstance(there, dict):
        return False
    for content in (there, here):
        for keys in (*MAP_FILES, ("materials",)):
            if at(content, keys) is not None:
                put(content, keys, "")
        content.pop("sample", None)
    return there == here


def holds_answer(folder: Path, case: Case, files: Sequence[ReadFile]) -> bool:
    """True if a folder has the complete answer of a case, of this version, with all files unchanged."""
    checksums = checksums_in(folder)
    if not {"report.html", "contact.nc", CASE_FILE} <= checksums.keys():
        return False
    for name, checksum in checksums.items():
        if not (folder / name).is_file() or sha256_of(folder / name) != checksum:
            return False
    if version_of(folder / "contact.nc") != __version__:
        return False
    return same_case((folder / CASE_FILE).read_text(encoding="utf-8"), case, files)


def version_of(path: Path) -> str:
    """Version of asperity that wrote a result."""
    with netCDF4.Dataset(path) as opened:
        return str(getattr(opened, "source", "")).removeprefix("asperity ")
