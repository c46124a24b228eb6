"""The folder of an answer: result files, pictures, tables and the report, written whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from asperity.engineering.answer import Answer
from asperity.engineering.datasets import result_datasets, settings_of
from asperity.engineering.pictures import pictures
from asperity.engineering.report import report_page
from asperity.errors import DatasetError
from asperity.results import dataset

REPORT = "report.html"
_OWN_FILES = re.compile(
    r"(surface|contact|stress(_lower|_upper)?)\.nc|(height|pressure|(von_mises|depth)(_lower|_upper)?)\.png"
    r"|(peaks|answer)\.csv|report\.html"
)
"""Names of files that a folder of an answer holds; a folder with any other is not written over."""


def write_answer(answer: Answer, folder: str | os.PathLike[str]) -> list[Path]:
    """Write an answer into a folder.

    Parameters
    ----------
    answer : Answer
    folder : path
        Made if it is not there. An earlier answer in it is replaced.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    ValueError
        If the folder holds other files.
    DatasetError
        If it cannot be written; an earlier answer is still there then.
    """
    with atomic_folder(folder) as unfinished:
        settings = settings_of(answer)
        for name, (title, data) in result_datasets(answer).items():
            dataset.write(data, unfinished / name, title, settings)
        answer.peaks().to_csv(unfinished / "peaks.csv", index=False, float_format="%.8g")
        answer.frame().to_csv(unfinished / "answer.csv", index=False, float_format="%.8g")
        shown = []
        for picture in pictures(answer):
            path = unfinished / f"{picture.name}.png"
            picture.figure.savefig(path, metadata={"Software": None})
            shown.append((picture.caption, path.read_bytes()))
        (unfinished / REPORT).write_text(report_page(answer, shown), encoding="utf-8")
        names = sorted(path.name for path in unfinished.iterdir())
    return [Path(folder) / name for name in names]


def folder_problem(folder: str | os.PathLike[str]) -> str:
    """Reason why an answer cannot be written into a folder, empty if it can."""
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        return "a file, the name of a folder is needed"
    if folder.is_dir():
        other = sorted(path.name for path in folder.iterdir() if not _OWN_FILES.fullmatch(path.name))
        if other:
            return f"holds files that are no result of asperity run ({other[0]}); another folder is needed"
    return ""


@contextmanager
def atomic_folder(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary folder beside `folder`: renamed to it when the block succeeds, deleted when it fails.

    Temporary folders of the same name that killed processes have left are deleted too.
    """
    if problem := folder_problem(folder):
        raise ValueError(f"{folder}: {problem}")
    path = Path(folder).absolute()
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _delete_abandoned(path)
        unfinished.mkdir()
        yield unfinished
        _replace(path, unfinished)
    except OSError as error:
        raise DatasetError(f"{folder}: cannot be written ({error.strerror or error})") from error
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _replace(path: Path, new: Path) -> None:
    """Put a folder in the place of another."""
    if path.is_dir():
        earlier = path.with_name(f".{path.name}.{os.getpid()}.earlier")
        os.rename(path, earlier)
        os.rename(new, path)
        shutil.rmtree(earlier, ignore_errors=True)
    else:
        os.rename(new, path)


def _delete_abandoned(path: Path) -> None:
    """Delete temporary folders of `path` whose processes have ended."""
    pattern = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.(unfinished|earlier)")
    for left in path.parent.iterdir():
        found = pattern.fullmatch(left.name)
        if found and left.is_dir() and not dataset.is_running(int(found[1])):
            shutil.rmtree(left, ignore_errors=True)
