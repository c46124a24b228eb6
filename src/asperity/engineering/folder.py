"""The folder of an answer: complete files, which replace only the files of an earlier answer."""

import json
import os
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from asperity.core.system import flush, sha256_of
from asperity.results.atomic import LOCK as LOCK
from asperity.results.atomic import locked as locked
from asperity.results.atomic import write_text

if TYPE_CHECKING:
    from asperity.engineering.case import Case

MANIFEST = ".asperity-run.json"
"""File with the names and checksums of all files of an answer in its folder; no other file is replaced."""

UNFINISHED = ".unfinished-"
"""Prefix of the name of the folder in which files are written before they are moved to their places."""

COMPLETE = ".complete"
"""Name of that folder when it is complete; its files then replace the files of an earlier answer."""

COMPARISON = ("comparison.csv", "comparison.html")
"""Names of the files that compare several answers."""

ANSWERS = "answers.json"
"""Name of the file of pooled answers with the checksum of the manifest of each."""

SAMPLE = (
    *("sample.csv", "peaks_per_area.csv", "largest.csv"),
    *("sample.html", "sample.xlsx", "case.yaml", ANSWERS),
)
"""Names of the files of pooled answers."""

CASE_FILE = "case.yaml"
"""Name of the case file of an answer."""


def names_of(case: "Case | None") -> list[str]:
    """Names of the files that the answer of a case may have; without a case, the names for all answers."""
    tables = (f"{name}.csv" for name in ("peaks", "spots", "gaps", "answer", "advice"))
    names = [CASE_FILE, "surface.nc", "contact.nc", *tables, "answer.xlsx"]
    names += ["height.png", "pressure.png", "report.html"]
    if case is None:
        return names
    names += ["plastic_depth.png"] if case.hardness else []
    for question in case.questions.values():
        names += question.files(case)
    for body, constants in case.different_bodies.items():
        suffix = f"_{body}" if len(case.different_bodies) > 1 else ""
        names += [f"stress{suffix}.nc"]
        if constants.coating is not None:
            names += [f"interface_{name}{suffix}.png" for name in ("shear", "tension")]
        for field in case.fields:
            end = ("" if field == "von_mises" else f"_{field}") + suffix
            names += [f"{view}{end}.png" for view in ("plane", "section", "peaks")]
    return names


def folder_problem(folder: str | os.PathLike[str], names: Iterable[str] | None = None) -> str:
    """Reason why an answer with files of these names cannot be written into a folder, empty if it can."""
    folder, names = Path(folder), names_of(None) if names is None else names
    try:
        existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    except OSError as error:
        return f"cannot be written ({error.strerror})"
    if not existing.is_dir():
        return "a file, the name of a folder is needed" if existing == folder else f"{existing} is a file"
    for path in (folder / name for name in names if (folder / name).exists()):
        if path.name not in names_in(folder):
            return f"holds {path.name}, which asperity run has not written; another folder is needed"
        if not path.stat().st_mode & stat.S_IWUSR:
            return f"holds {path.name}, which is read-only; another folder is needed"
    return ""


@contextmanager
def replacing(folder: Path, kept: set[str]) -> Iterator[Path]:
    """Folder whose files replace an earlier answer's, except for `kept`, when the block succeeds."""
    with TemporaryDirectory(prefix=UNFINISHED, dir=folder, ignore_cleanup_errors=True) as name:
        unfinished = Path(name)
        yield unfinished
        names = {path.name for path in unfinished.iterdir()}
        if problem := folder_problem(folder, names):
            raise ValueError(f"{folder}: {problem}")

        checksums = {name: found for name, found in checksums_in(folder).items() if name in kept}
        for name in names:
            flush(unfinished / name)
            checksums[name] = sha256_of(unfinished / name)
        write_text(unfinished / MANIFEST, json.dumps(checksums, sort_keys=True))
        unfinished.rename(folder / COMPLETE)
        flush(folder)
    move_complete(folder)


def move_complete(folder: Path) -> None:
    """Delete the files of the earlier answer, and move the complete ones to their places.

    The folder never holds files of two answers. Its manifest is deleted before the first file is moved, and
    moved last, so that the steps can be continued wherever they were interrupted.
    """
    complete = folder / COMPLETE
    if not complete.is_dir():
        return
    new = {path.name for path in complete.iterdir()}
    if (folder / MANIFEST).exists():
        kept = names_in(complete) - new
        for path in (folder / name for name in names_in(folder) - kept):
            if path.exists() and path.name in new:
                shutil.copymode(path, complete / path.name)
            path.unlink(missing_ok=True)
        (folder / MANIFEST).unlink()
    for name in sorted(new, key=MANIFEST.__eq__):
        os.replace(complete / name, folder / name)
    complete.rmdir()
    flush(folder)


def names_in(folder: Path) -> set[str]:
    """Names of the files of the answer in a folder."""
    return set(checksums_in(folder))


def checksums_in(folder: Path) -> dict[str, str]:
    """Name → SHA-256 checksum of the files of the answer in a folder; empty if there is none.

    A checksum is empty in a folder that was written when only names were kept.
    """
    for manifest in (folder / MANIFEST, folder / COMPLETE / MANIFEST):
        if not manifest.is_file():  # a pipe would be waited for
            continue
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
            named = found if isinstance(found, dict) else dict.fromkeys(found, "")
            return {name: text for name, text in named.items() if Path(name).name == name}
        except (OSError, ValueError, TypeError):
            continue
    return {}
