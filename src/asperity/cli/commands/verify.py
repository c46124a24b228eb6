"""``asperity verify``: whether results are unchanged, and their contacts fulfil the conditions of contact."""

import argparse
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.core.errors import DatasetError, fail, one_line
from asperity.core.system import sha256_of
from asperity.core.types import Array
from asperity.core.version import __version__
from asperity.engineering.case_file import files_with_checksums, load_case
from asperity.engineering.contact_numbers import certificate_in_words, stored_certificate
from asperity.engineering.folder import (
    CASE_FILE,
    MANIFEST,
    SAMPLE,
    SAMPLE_DATA,
    checksums_in,
    manifests_of_sample,
)
from asperity.engineering.sample import SampleData
from asperity.results import dataset
from asperity.results.tables import read_table

WRITTEN = ("report.html", "answer.csv", "sample.csv", "comparison.csv")
"""Files that show that a folder holds an answer or several, also without its manifest."""


class Check(NamedTuple):
    """Text of one check, and whether it holds."""

    text: str
    holds: bool = True


def run(options: argparse.Namespace) -> None:
    """Print the checks that hold, and end with a line for each failure."""
    status = 0
    for path in map(Path, options.results):
        try:
            for check in _of_folder(path) if path.is_dir() else _of_file(path, dataset.read(path)):
                if check.holds:
                    print(one_line(check.text), flush=True)
                else:
                    status = fail(check.text)
        except DatasetError as error:
            status = fail(str(error))
    if status:
        sys.exit(status)


def _of_folder(path: Path) -> Iterator[Check]:
    """Checks of the folder of one answer, or of a folder with several."""
    inside = [folder for folder in (path, *sorted(path.iterdir())) if folder.is_dir()]
    folders = [folder for folder in inside if checksums_in(folder)]
    for folder in (each for each in inside if each not in folders):
        if found := next((name for name in WRITTEN if (folder / name).exists()), ""):
            yield Check(f"{folder}: holds {found}, but no readable {MANIFEST}; run again", False)
    if not folders:
        text = f"{path}: no answer of asperity run; a result file or the folder of an answer is needed"
        yield Check(text, False)
    for folder in folders:
        yield from _of_answer(folder)


def _of_answer(folder: Path) -> Iterator[Check]:
    """Checks of the folder of an answer, or of the tables and pages of several."""
    results: dict[str, xr.Dataset] = {}
    checksums = checksums_in(folder)
    unchanged = []
    for name, checksum in sorted(checksums.items()):
        path = folder / name
        if not path.is_file():
            yield Check(f"{path}: missing; run again", False)
        elif sha256_of(path) != checksum:
            yield Check(f"{path}: changed since it was written; run again", False)
        else:
            unchanged.append(name)
            if path.suffix == ".nc":
                results[name] = dataset.read(path)
    if len(unchanged) == len(checksums):
        yield Check(f"{folder}: {len(unchanged)} files unchanged")
    for name, values in {"version": "source", "settings": "settings_digest"}.items():
        if len(found := {result.attrs[values] for result in results.values()}) > 1:
            text = f"results of one {name} are needed, found {', '.join(sorted(found))}"
            yield Check(f"{folder}: {text}", False)
    if SAMPLE_DATA in unchanged:
        yield from _of_sample(folder)
    if "contact.nc" not in checksums:
        return
    if "report.html" not in checksums:
        yield Check(f"{folder}: no report, the run was interrupted; run again", False)
    if {"contact.nc", "surface.nc"} <= results.keys():
        height = results["surface.nc"]["height"].transpose("y", "x").values
        yield from _of_file(folder / "contact.nc", results["contact.nc"], height)
    path = folder / CASE_FILE
    for _, named, checksum in files_with_checksums(load_case(path)) if path.is_file() else ():
        file = Path(os.path.normpath(named))  # maps and materials since they were read
        if not file.is_file():
            yield Check(f"{file}: no such file; the file of {path} is needed to compare it", False)
        elif sha256_of(file) != checksum:
            yield Check(f"{file}: changed since {folder} was computed from it; run again", False)
        else:
            yield Check(f"{file}: unchanged since {folder} was computed from it")


def _of_sample(folder: Path) -> Iterator[Check]:
    """Checks that the answers of a sample are unchanged, and that the means follow from them."""
    manifests = manifests_of_sample(folder)
    same = True
    for name, checksum in manifests.items():
        manifest = folder / name / MANIFEST
        if not manifest.is_file():
            same = False
            yield Check(f"{folder / name}: missing, but its answer is pooled in {folder}; run again", False)
        elif sha256_of(manifest) != checksum:
            same = False
            yield Check(f"{folder / name}: not the answer that is pooled in {folder}; run again", False)
    if same:
        means = SampleData.read(folder).frame()
        stored = read_table("answer_sample", folder / SAMPLE[0])
        agrees = list(means.columns) == list(stored.columns) and len(means) == len(stored)
        numbers = means.select_dtypes("number").columns
        agrees = agrees and np.allclose(means[numbers], stored[numbers], rtol=1e-6, atol=0, equal_nan=True)
        text = f"the means follow from {len(manifests)} answers"
        wrong = "not the means of the answers; run again"
        yield Check(f"{folder / SAMPLE[0]}: {text if agrees else wrong}", agrees)


def _of_file(path: Path, result: xr.Dataset, height: Array | None = None) -> Iterator[Check]:
    """Version of a result that was read, and the certificate of a contact from its height."""
    other = f"; this is asperity {__version__}" if result.attrs["source"] != f"asperity {__version__}" else ""
    written = f"{result.attrs['source']}, {result.attrs['fft_engine']}"
    yield Check(f"{path}: unchanged, written by {written}{other}")
    if dataset.stage_of(result) != "contact":
        return
    found, allowed = stored_certificate(result, height)
    yield Check(f"{path}: certificate computed anew: {certificate_in_words(found)}")
    for name, value in found.violations.items():
        if not value <= allowed[name]:
            yield Check(
                f"{path}: {name.replace('_', ' ')} = {value:.2g}: at most {allowed[name]:.2g} is needed, "
                "as in its own certificate but for rounding; the pressure is not the solution",
                False,
            )
