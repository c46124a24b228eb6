"""Case files of ``asperity run``: the maps that they name."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity.core.errors import InputError, shown
from asperity.settings.reader import load

PATHS = ("map", "counter_map", "out")
"""Settings that are names of files, relative to the folder of the case file that gives them."""

CHECKSUMS = {f"{name}_sha256": name for name in PATHS[:2]}
"""Key of a case file with the checksum of a map → setting that names the map."""

CASE_SUFFIXES = (".yaml", ".yml")
"""Ends of the names of case files."""


def pool_of(paths: Sequence[str]) -> dict[str, Any]:
    """Settings of a case file that names several maps, or pools them; empty for any other file.

    Raises
    ------
    InputError
        If the file cannot be read, or the lists that belong to its maps differ in length.
    """
    if len(paths) > 1 or Path(paths[0]).suffix not in CASE_SUFFIXES:
        return {}
    path, content = Path(paths[0]), load(Path(paths[0]))
    pool = content.get("engineering", content)
    if not isinstance(pool, Mapping) or not (isinstance(pool.get("map"), list) or "pooled" in pool):
        return {}
    named = pool.get("map")
    maps: list[Any] = named if isinstance(named, list) else [named]
    for name in (*PATHS[:2], *CHECKSUMS):
        given = pool.get(name, maps)
        if isinstance(given, list) and not (
            0 < len(given) == len(maps) and all(isinstance(each, str) and each for each in given)
        ):
            raise InputError(str(path), [f"{name} = {shown(given)}: a list of {len(maps)} names is needed"])
    if not isinstance(pool.get("pooled", False), bool):
        raise InputError(str(path), [f"pooled = {shown(pool['pooled'])}: true or false is needed"])
    found = {"map": [str(path.parent / each) for each in maps], "pooled": pool.get("pooled", False)}
    return found | ({"out": str(path.parent / pool["out"])} if "out" in pool else {})


def names_of_maps(paths: Sequence[str]) -> list[str]:
    """Names of folders for several answers: those of the files; equal ones get the folder's name in front."""
    stems = [Path(path).stem for path in paths]
    count = Counter(stems)
    return [
        stem if count[stem] == 1 else f"{Path(path).resolve().parent.name}_{stem}"
        for path, stem in zip(paths, stems, strict=True)
    ]
