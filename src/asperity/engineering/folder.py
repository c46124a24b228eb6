"""The folder of an answer: complete files, which replace only the files of an earlier answer."""

import json
import os
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from asperity.core.errors import DatasetError
from asperity.core.system import flush, sha256_of
from asperity.engineering.scene import Scene
from asperity.results.atomic import LOCK as LOCK
from asperity.results.atomic import locked as locked
from asperity.results.atomic import name_problem, write_text

MANIFEST = ".asperity-run.json"
"""File with the names and checksums of all files of an answer in its folder; no other file is replaced."""

UNFINISHED = ".unfinished-"
"""Prefix of the name of the folder in which files are written before they are moved to their places."""

COMPLETE = ".complete"
"""Name of that folder when it is complete; its files then replace the files of an earlier answer."""

KEPT = ".rows"
"""Name of the folder with the finished rows of a sweep until the answer is written."""

COMPARISON_DATA = "comparison.json"
"""Name of the file with the folders of the answers that a comparison is made of."""

COMPARISON = ("comparison.csv", "comparison.html", COMPARISON_DATA)
"""Names of the files that compare several answers."""

SAMPLE_DATA = "sample.json"
"""Name of the file of pooled answers with the checksum of the manifest of each."""

SAMPLE = (
    *("sample.csv", "peaks_per_area.csv", "maximum.csv"),
    *("sample.html", "sample.xlsx", "case.yaml", SAMPLE_DATA),
)
"""Names of the files of pooled answers."""

CASE_FILE = "case.yaml"
"""Name of the case file of an answer."""

DATA = "answer.json"
"""Name of the file with the records of an answer."""

REPORT = "report.html"
"""Name of the page of an answer, which is written last."""

KINDS = {DATA: "an answer", SAMPLE_DATA: "a sample", COMPARISON_DATA: "a comparison"}
"""Name of the file that only one kind of folder has → the kind."""

STEMS = (
    *("case", "answer", "surface", "contact", "stress", "peaks", "contact_spots", "gaps"),
    *("warnings", "report"),
    *("height", "pressure", "plastic_depth", "plane", "section", "interface", "map"),
)
"""First words of the names of the files that every answer may have."""

SUFFIXES = (".yaml", ".json", ".nc", ".npy", ".csv", ".xlsx", ".png", ".html")
"""Ends of the names of the files of answers."""


def stems_of(case: Scene) -> tuple[str, ...]:
    """First words of the names of the files that the answer of a case may have."""
    of_questions = (name for question in case.questions.values() for name in question.FILES)
    return tuple(dict.fromkeys((*STEMS, *of_questions)))


def folder_problem(
    folder: str | os.PathLike[str], names: Iterable[str] = (), stems: tuple[str, ...] = ()
) -> str:
    """Reason why files cannot be written into a folder, empty if they can.

    Parameters
    ----------
    folder : path
    names : iterable of str
        Names of the files.
    stems : tuple of str
        First words of the names of further files that an answer may have.
    """
    folder = Path(folder)
    if problem := name_problem(folder):
        return problem
    try:
        existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        there = [*folder.iterdir()] if existing == folder and folder.is_dir() else []
    except OSError as error:
        return f"cannot be written ({error.strerror})"
    if not existing.is_dir():
        return "a file, the name of a folder is needed" if existing == folder else f"{existing} is a file"
    own, names = names_in(folder), set(names)
    kinds = {DATA} if stems else KINDS.keys() & names
    if kinds and (others := (KINDS.keys() & own) - kinds):
        return f"holds {KINDS[others.pop()]}; another folder is needed"
    for path in sorted(there):
        is_like = path.suffix in SUFFIXES and path.stem.startswith(stems or ("\0",))
        if not (path.name in names or is_like) or path.is_dir():
            continue
        if path.name not in own:
            return f"holds {path.name}, which asperity run has not written; another folder is needed"
        if not path.stat().st_mode & stat.S_IWUSR:
            return f"holds {path.name}, which is read-only; another folder is needed"
    return ""


def remove_unfinished(folder: Path) -> None:
    """Remove what a killed process has written into a folder that no process writes into now.

    Raises
    ------
    DatasetError
        If another process writes into it.
    """
    with locked(folder):
        for abandoned in folder.glob(f"{UNFINISHED}*"):
            shutil.rmtree(abandoned, ignore_errors=True)


@contextmanager
def replacing(folder: Path, kept: set[str]) -> Iterator[Path]:
    """Folder whose files replace an earlier answer's, except for `kept`, when the block succeeds.

    What a killed process has left is removed first, or moved to its places if it is complete. The folder is
    locked.
    """
    remove_unfinished(folder)
    move_complete(folder)
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


def manifests_of_sample(folder: Path) -> dict[str, str]:
    """Name of each pooled map → checksum of the manifest of its answer.

    Raises
    ------
    DatasetError
        If the file of the sample is damaged.
    """
    path = folder / SAMPLE_DATA
    try:
        found = {str(name): str(text) for name, text in json.loads(path.read_text("utf-8"))["maps"].items()}
        if found and all(Path(name).name == name for name in found):
            return found
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        pass
    raise DatasetError(f"{path}: damaged; run {folder / CASE_FILE} again")


def checksums_in(folder: Path) -> dict[str, str]:
    """Name → SHA-256 checksum of the files of the answer in a folder; empty if there is none."""
    for manifest in (folder / MANIFEST, folder / COMPLETE / MANIFEST):
        if not manifest.is_file():  # a pipe would be waited for
            continue
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
            return {name: text for name, text in found.items() if Path(name).name == name}
        except (OSError, ValueError, TypeError, AttributeError):
            continue
    return {}
