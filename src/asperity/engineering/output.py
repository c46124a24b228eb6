"""The folder of an answer: results in SI units, pictures, tables and the report."""

import base64
import json
import os
import platform
import shutil
from dataclasses import asdict
from datetime import datetime
from importlib.metadata import version
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from typing import Any
from zlib import Z_RLE

import numpy as np
import pandas as pd
import xarray as xr
from markupsafe import Markup

from asperity.core.errors import DatasetError
from asperity.core.markup import rendered
from asperity.core.version import __version__
from asperity.engineering.answer import ONE_PLACE, REPEATS, Answer, case_in_words, without_repeats
from asperity.engineering.case import Case, solid_of
from asperity.engineering.case_file import case_text
from asperity.engineering.contact_numbers import certificate_in_words
from asperity.engineering.folder import CASE_FILE, UNFINISHED, locked, move_complete, names_in, replacing
from asperity.engineering.pictures import pictures
from asperity.engineering.question import Picture
from asperity.engineering.values import slider_of, values_of
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table, write_workbook
from asperity.results.variables import SI_UNITS
from asperity.surface.reading.height_map import HeightMap
from asperity.surface.roughness import surface_dataset

SPOTS = 10
"""Patches of contact in the report."""

Shown = tuple[Picture, str, list[dict[str, Any]]]
"""A picture of the report, as an image in base64, and its values."""

PACKAGES = ("numpy", "numba", "xarray", "SurfaceTopography")
"""Packages whose versions the report names; it also names the library of the Fourier transforms."""


def write_answer(answer: Answer, folder: str | os.PathLike[str]) -> list[Path]:
    """Write an answer into a folder: first the results and tables, then the pictures and the report.

    A killed process leaves the earlier answer or the results of the new one. If it is killed while files are
    moved to their places, the next call moves the rest.

    Parameters
    ----------
    answer : Answer
    folder : path
        Made if it is not there; a symbolic link is followed. An earlier answer in it is replaced, other files
        stay.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    ValueError
        If a file would replace one that no earlier answer wrote, or that is read-only.
    DatasetError
        If it cannot be written, or another process writes into it; the earlier answer is still there then, or
        the results of the new one without pictures and report.

    Examples
    --------
    >>> import tempfile
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> answer = asp.run(surface, asp.Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     names = {path.name for path in asp.write_answer(answer, f"{folder}/ground")}
    >>> names >= {"report.html", "answer.csv", "peaks.csv", "contact.nc"}
    True
    """
    folder = Path(folder)
    try:
        with locked(folder):
            for abandoned in folder.glob(f"{UNFINISHED}*"):  # by a process that was killed
                shutil.rmtree(abandoned, ignore_errors=True)
            move_complete(folder)
            with replacing(folder, kept=set()) as unfinished:
                _write_results(answer, unfinished)
                if not isinstance(answer.case.map.file, HeightMap):
                    text = case_text(answer.case, folder, files=answer.rough.files)
                    write_text(unfinished / CASE_FILE, text)
            results = names_in(folder)
            try:
                with replacing(folder, kept=results) as unfinished:
                    _write_report(answer, unfinished)
            except Exception as error:  # drawing may raise errors of any type
                message = f"{folder}: results are written, pictures and report not ({error})"
                raise DatasetError(message) from error
            return [folder / name for name in sorted(names_in(folder))]
    except OSError as error:
        raise DatasetError(f"{folder}: cannot be written ({error.strerror or error})") from error


def _write_results(answer: Answer, folder: Path) -> None:
    """Write the results and tables of an answer into an empty folder."""
    settings, surface = settings_of(answer), f"rough surface {answer.face.name}"
    dataset.write(surface_of(answer), folder / "surface.nc", f"R{surface[1:]}", settings)
    dataset.write(contact_dataset(answer), folder / "contact.nc", f"Contact with {surface}", settings)
    for body in answer.case.different_bodies:
        suffix = answer.suffix_of(body)
        title = f"Stress under {surface}{suffix.replace('_', ', ')}"
        dataset.write(stress_dataset(answer, body), folder / f"stress{suffix}.nc", title, settings)
    tables: dict[str, pd.DataFrame] = {
        "advice": answer.advice_table(),
        "peaks": answer.peaks(),
        "spots": answer.spots,
        "gaps": answer.gaps(),
    }
    for question in answer.case.questions.values():
        tables |= question.tables(answer)
        for name, data, title in question.datasets(answer):
            dataset.write(data.assign_attrs(unit_system=SI_UNITS), folder / f"{name}.nc", title, settings)
    for name, table in tables.items():
        write_table(table, f"answer_{name}", folder / f"{name}.csv", float_format="%.8g")
    write_table(answer.frame(), "answer", folder / "answer.csv", float_format="%.8g")
    write_workbook({"answer": answer.frame()} | tables, folder / "answer.xlsx")


def _write_report(answer: Answer, folder: Path) -> None:
    """Write the pictures of an answer, and the report as one page that holds them, into an empty folder."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    groups: dict[str, list[Shown]] = {}
    bodies = answer.case.different_bodies
    same = len(bodies) > 1 and bodies["lower"].is_like(bodies["upper"])
    for picture in pictures(answer):
        canvas = FigureCanvasAgg(picture.figure)
        canvas.draw()  # once, where savefig draws twice
        pixels = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        # Takes a third of the default's time, for files of the same size.
        options: dict[str, Any] = {"compress_level": 1, "compress_type": Z_RLE}
        path = folder / f"{picture.name}.png"
        pixels.save(path, dpi=(picture.figure.dpi,) * 2, **options)
        if same and picture.body == "upper" and "cycles" not in picture.name:  # like the lower body's
            continue
        title = answer.case.stress_title(picture.body) if picture.body and len(answer.bodies) > 1 else ""
        shown = picture, base64.b64encode(path.read_bytes()).decode(), values_of(picture.figure)
        groups.setdefault(title, []).append(shown)
    lead = _taken_lead(answer, groups)
    versions = {"asperity": __version__, "Python": platform.python_version()}
    versions |= {package: version(package) for package in PACKAGES if find_spec(package)}
    engine, _, number = answer.contact.fft_engine.partition(" ")
    versions[engine] = number
    rows = without_repeats(answer.rows)
    page = rendered(
        "asperity.engineering",
        "report.html.j2",
        title=f"{answer.face.name}: contact and stress",
        answer=answer,
        case=case_in_words(answer.case),
        of_table=constants_of_table(answer.case),
        questions=reports_of_questions(answer),
        assumptions=[question.assumption(answer) for question in answer.case.questions.values()],
        certificate=certificate_in_words(answer.contact.certificate),
        headline=headline(answer),
        lead=lead,
        one_place=f"{ONE_PLACE[0].upper()}{ONE_PLACE[1:]}.",
        groups=groupby(rows, key=lambda row: row.group),
        repeats=REPEATS if len(rows) < len(answer.rows) else "",
        picture_groups=groups,
        sliders=[
            (answer.case.stress_title(body), slider_of(answer, body))
            for body in (["lower"] if same else bodies)
        ],
        case_file=case_text(answer.case, folder.parent, files=answer.rough.files),
        date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        spots=answer.spots.head(SPOTS),
        gaps=answer.gaps().set_index("share")["gap_m"],
        versions=versions,
    )
    write_text(folder / "report.html", page)


def _taken_lead(answer: Answer, groups: dict[str, list[Shown]]) -> Shown | None:
    """The picture that stands at the top, taken out of its group."""
    asked = [question.LEAD for question in answer.case.questions.values() if question.LEAD]
    for name in ["interface", *reversed(asked), "pressure"]:
        for shown in groups.values():
            for each in shown:
                if each[0].name.startswith(name):
                    shown.remove(each)
                    return each
    return None


def headline(answer: Answer) -> list[tuple[str, str, list[str]]]:
    """The tiles of a report: name, value, and its errors, each with its cause."""
    found, rows = [], answer.tiles
    several = len({row.group for row in rows if row.name == "largest von Mises stress"}) > 1
    for row in rows:
        body = row.group.removeprefix("stress in the ").partition(" (")[0]
        name = f"{row.name}, {body}" if several and row.group.startswith("stress") else row.name
        value, place = row.value_and_place
        errors = [*filter(None, [place]), *row.shown.split("; ")[1:]]
        if not row.error_of_places > 0 and row.between_places:
            errors.append(row.between_places)
        found.append((name, value, errors))
    return found


def reports_of_questions(answer: Answer) -> list[Markup]:
    """The parts of the report that questions have a template for."""
    package, asked = "asperity.engineering.questions", answer.case.questions.items()
    templates = {name: question.TEMPLATE for name, question in asked if question.TEMPLATE}
    return [Markup(rendered(package, each, found=answer.found[name])) for name, each in templates.items()]


def constants_of_table(case: Case) -> list[str]:
    """Constants of a case that come from the table of materials, a line for each body."""
    lines = []
    for name, body in case.groups_of_bodies.items():
        for part, group in ((name, body), *((f"{name}, layer", layer) for layer in body.layers)):
            if constants := group.from_material:
                values = [f"{each} {found.value} ({found.source})" for each, found in constants.items()]
                lines.append(f"{part.replace('_', ' ')}, {group.material}: {'; '.join(values)}")
    return lines


def settings_of(answer: Answer) -> dict[str, Any]:
    """Settings from which the answer can be made again, and the solids as results describe them."""
    case, counter = answer.case, answer.case.elastic_counter_body
    solids = {
        "name": answer.face.name,
        "layer": asdict(solid_of(case.body)),
        "upper": None if counter is None else asdict(solid_of(counter)),
        "friction": case.friction,
        "sliding_direction": case.sliding_direction,
    }
    return case.written() | solids


def surface_of(answer: Answer) -> xr.Dataset:
    """The surface that was pressed, with its roughness parameters and spectrum."""
    face = answer.face
    return surface_dataset(face.height, face.grid).assign_attrs(
        unit_system=SI_UNITS,
        map_treatment="\n".join(face.done),
        wavelength_short=face.wavelength_short,
        edge_step=face.treatment.edge_step,
    )


def contact_dataset(answer: Answer) -> xr.Dataset:
    """Pressure, displacement, gap and patches; the attributes describe the lower body, the settings both."""
    columns = {str(name).rsplit("_", 1)[0]: values.to_numpy() for name, values in answer.spots.items()}
    spots = {f"spot_{name}": ("spot", values) for name, values in columns.items()}
    fields: dict[str, Any] = {}
    for question in answer.case.questions.values():
        fields |= {name: (("y", "x"), values) for name, values in question.fields(answer).items()}
    attributes = {"force": answer.numbers.force, "approach_since_first_touch": answer.numbers.approach}
    settings = json.dumps(settings_of(answer), sort_keys=True)
    return answer.contact.to_dataset().assign(spots | fields).assign_attrs(settings=settings, **attributes)


def stress_dataset(answer: Answer, name: str) -> xr.Dataset:
    """The stress in one body, with attributes that describe it as in the files of the study."""
    part = answer.bodies[name]
    layer = part.layer
    attributes: dict[str, Any] = {
        "unit_system": SI_UNITS,
        "body": name,
        "solid": layer.description,
        "solid_reason": "asked for",
        "solid_bound": 0.0,
        "uniform_mode": "laterally confined",
        "poisson_contact": layer.poisson,
        "young": layer.young,
        "gradient_rms_contact": answer.numbers.gradient_rms_contact,
    }
    for question in answer.case.questions.values():
        attributes |= question.attributes(answer, name)
    return part.stress.assign_attrs(attributes)
