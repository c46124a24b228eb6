"""The folder of an answer: results, pictures, tables and the report, written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from asperity.engineering.answer import Answer
from asperity.engineering.datasets import result_datasets, settings_of
from asperity.engineering.folder import atomic_folder
from asperity.engineering.pictures import pictures
from asperity.engineering.report import ReportPicture, report_page
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table

REPORT = "report.html"


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

    Examples
    --------
    >>> import tempfile
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> answer = run(surface, Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     names = {path.name for path in write_answer(answer, f"{folder}/ground")}
    >>> names >= {"report.html", "answer.csv", "peaks.csv", "contact.nc"}
    True
    """
    with atomic_folder(folder) as unfinished:
        settings = settings_of(answer)
        for name, (title, data) in result_datasets(answer).items():
            dataset.write(data, unfinished / name, title, settings)
        write_table(answer.peaks(), "answer_peaks", unfinished / "peaks.csv", float_format="%.8g")
        write_table(answer.frame(), "answer", unfinished / "answer.csv", float_format="%.8g")
        shown = []
        for picture in pictures(answer):
            path = unfinished / f"{picture.name}.png"
            picture.figure.savefig(path, metadata={"Software": None})
            wide = picture.name.startswith("section")
            shown.append(ReportPicture(picture.body, wide, picture.caption, path.read_bytes()))
        write_text(unfinished / REPORT, report_page(answer, shown))
        names = sorted(path.name for path in unfinished.iterdir())
    return [Path(folder) / name for name in names]
