"""The files of an answer: written into a folder, and opened from there as the same data.

``answer.json`` holds the records, texts and names of the other files with all digits. Contacts on half of
the nodes, and the fields of planes, are not kept: planes are computed from the pressure again.
"""

import json
from collections import UserDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Certificate, Contact
from asperity.contact.solution import adhesion_of
from asperity.core.errors import DatasetError
from asperity.core.system import sha256_of
from asperity.engineering.answer_data import AnswerData, Origin
from asperity.engineering.case import Case
from asperity.engineering.case_file import case_of_answer, case_text
from asperity.engineering.face import ReadFile
from asperity.engineering.folder import CASE_FILE, DATA, checksums_in
from asperity.engineering.records import Advice, Record
from asperity.engineering.scene import solid_of
from asperity.fourier.grid import grid_of
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import read_table, write_table, write_workbook
from asperity.results.variables import SI_UNITS
from asperity.surface.reading.height_map import PEAKS_UP, HeightMap
from asperity.surface.roughness import surface_dataset
from asperity.surface.treatment.treatment import MapTreatment, TreatedMap

FORMAT = 1
"""Number of the format of a folder; it rises when a folder is written otherwise."""

HEIGHTS = "map.npy"
"""Name of the heights of a map that was given as an array."""

Kind = TypeVar("Kind", bound=AnswerData)


class OpenedWhenAsked(UserDict[str, Any]):
    """Values that are read from files when they are first asked for; until then a `partial` reads each."""

    def __getitem__(self, name: str) -> Any:
        if isinstance(self.data[name], partial):
            self.data[name] = self.data[name]()
        return self.data[name]


def write_data(answer: AnswerData, folder: Path, final: Path) -> None:
    """Write the data of an answer into an empty folder, which is moved to its final place later."""
    settings, surface = _settings(answer), f"rough surface {answer.face.name}"
    described = surface_dataset(answer.face.height, answer.face.grid).assign_attrs(
        unit_system=SI_UNITS,
        map_treatment="\n".join(answer.face.done),
        wavelength_short=answer.face.wavelength_short,
        edge_step=answer.face.treatment.edge_step,
    )
    dataset.write(described, folder / "surface.nc", f"R{surface[1:]}", settings)
    dataset.write(_contact(answer), folder / "contact.nc", f"Contact with {surface}", settings)
    for body, stress in answer.stress.items():
        suffix = suffix_of(answer, body)
        title = f"Stress under {surface}{suffix.replace('_', ', ')}"
        dataset.write(_described(answer, body, stress), folder / f"stress{suffix}.nc", title, settings)
    tractions = [name for name, each in answer.datasets.items() if {"y", "x"} == set(each.sizes)]
    others = {name: each for name, each in answer.datasets.items() if name not in tractions}
    for name, each in others.items():
        title = str(each.attrs.get("title", name))
        dataset.write(each.assign_attrs(unit_system=SI_UNITS), folder / f"{name}.nc", title, settings)
    for name, table in answer.tables.items():
        write_table(table, f"answer_{name}", folder / f"{name}.csv")
    write_table(answer.frame(), "answer", folder / "answer.csv")
    write_table(answer.warnings_table(), "answer_warnings", folder / "warnings.csv")
    write_workbook({"answer": answer.frame(), **answer.tables}, folder / "answer.xlsx")
    if isinstance(answer.case.map.file, HeightMap):
        np.save(folder / HEIGHTS, answer.case.map.file.height)
    write_text(folder / CASE_FILE, case_of(answer, final))
    contact, face = answer.contact, answer.face
    plain = {
        "format": FORMAT,
        "records": [each.as_plain() for each in answer.records],
        "verdict": list(answer.verdict),
        "warnings": [list(each) for each in answer.warnings],
        "assumptions": list(answer.assumptions),
        "origin": [answer.origin.date, dict(answer.origin.versions), list(map(list, answer.origin.files))],
        "contact": {"rtol": contact.rtol, "control_error": contact.control_error},
        "face": {
            "name": face.name,
            "done": list(face.done),
            "boundary": face.boundary,
            "wavelength_short": face.wavelength_short,
            "treatment": asdict(face.treatment),
        },
        "stress": {body: f"stress{suffix_of(answer, body)}.nc" for body in answer.stress},
        "tables": list(answer.tables),
        "tractions": {name: list(map(str, answer.datasets[name].data_vars)) for name in tractions},
        "datasets": list(others),
    }
    write_text(folder / DATA, json.dumps(plain, indent=1))


def read_data(folder: Path, kind: type[Kind]) -> Kind:
    """The answer that a folder holds, as an object of a kind; datasets and tables are read when asked for.

    Raises
    ------
    DatasetError
        If the folder holds no answer, or one of another format.
    """
    plain, folder = plain_data(folder), folder.absolute()  # also after a change of the working folder

    def read(name: str, names: Sequence[str] | None = None) -> xr.Dataset:
        return dataset.read_checked(unchanged(folder, name), names, is_known=name in checksums_in(folder))

    found = kind.__new__(kind)
    later: dict[str, Callable[[AnswerData], Any]] = {  # no cycle: an answer goes with its last reference
        "case": lambda _: Case.read(case_of_answer(folder)),
        "face": lambda _: _face_from(plain["face"], read("surface.nc")),
        "contact": lambda answer: _contact_from(read("contact.nc"), answer, plain["contact"]),
    }
    try:
        date, versions, files = plain["origin"]
        stresses = {body: partial(read, name) for body, name in plain["stress"].items()}
        tables = {name: partial(_table, folder, name) for name in plain["tables"]}
        datasets = {name: partial(read, f"{name}.nc") for name in plain["datasets"]}
        datasets |= {name: partial(read, "contact.nc", names) for name, names in plain["tractions"].items()}
        parts = {
            "records": tuple(Record.from_plain(each) for each in plain["records"]),
            "verdict": tuple(plain["verdict"]),
            "warnings": tuple(Advice(*each) for each in plain["warnings"]),
            "assumptions": tuple(plain["assumptions"]),
            "stress": OpenedWhenAsked(stresses),
            "tables": OpenedWhenAsked(tables),
            "datasets": OpenedWhenAsked(datasets),
            "origin": Origin(date, versions, tuple(ReadFile(*each) for each in files)),
        }
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise DatasetError(f"{folder / DATA}: damaged ({error}); run {folder / CASE_FILE} again") from error
    found.__dict__.update(parts, folder=folder, _later=later)
    return found


def unchanged(folder: Path, name: str) -> Path:
    """A file of an answer; `DatasetError` if its content is not what was written."""
    path, checksum = folder / name, checksums_in(folder).get(name, "")
    if checksum and path.is_file() and sha256_of(path) != checksum:
        raise DatasetError(f"{path}: changed after it was written; run {folder / CASE_FILE} again")
    return path


def _table(folder: Path, name: str) -> pd.DataFrame:
    return read_table(f"answer_{name}", unchanged(folder, f"{name}.csv"))


def plain_data(folder: Path) -> dict[str, Any]:
    """The content of ``answer.json`` in a folder.

    Raises
    ------
    DatasetError
        If there is none, or one of another format.
    """
    if DATA not in checksums_in(folder):
        raise DatasetError(f"{folder}: the folder of an answer of asperity run is needed")
    try:
        plain = json.loads(unchanged(folder, DATA).read_text(encoding="utf-8"))
        number = plain["format"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DatasetError(f"{folder / DATA}: damaged ({error}); run {folder / CASE_FILE} again") from error
    if number != FORMAT:
        needed = f"format {FORMAT} is read by this version; run {folder / CASE_FILE} again"
        raise DatasetError(f"{folder / DATA}: format {number}; {needed}")
    return plain


def suffix_of(answer: AnswerData, body: str) -> str:
    """End of the names of the files of one body, if there are two."""
    return f"_{body}" if len(answer.stress) > 1 else ""


def case_of(answer: AnswerData, folder: Path) -> str:
    """The case file of an answer in a folder; heights of an array are in a file beside it."""
    case, source = answer.case, answer.case.map.file
    if not isinstance(source, HeightMap):
        return case_text(case, folder, files=answer.origin.files)
    written = {
        "file": str(folder / HEIGHTS),
        "physical_size": [f"{edge!r} m" for edge in source.length],
        "unit": source.unit or "m",
        "orientation": source.orientation or PEAKS_UP,
    }
    periodic = case.map.periodic or ("declared" if source.periodic else None)
    options = case.map.replaced(**written, **({"periodic": periodic} if periodic else {}))
    return case_text(case.with_maps(options, case.counter_map), folder)


def _face_from(plain: Mapping[str, Any], surface: xr.Dataset) -> TreatedMap:
    """The rough surface of a folder."""
    return TreatedMap(
        surface["height"].transpose("y", "x").values,
        grid_of(surface),
        plain["wavelength_short"],
        MapTreatment(**plain["treatment"]),
        tuple(plain["done"]),
        plain["name"],
        plain["boundary"],
    )


def _contact_from(stored: xr.Dataset, answer: AnswerData, plain: Mapping[str, float]) -> Contact:
    """The contact of a folder; the certificate is that of the file, without its time."""
    fields = {name: stored[name].transpose("y", "x").values for name in ("pressure", "displacement", "gap")}
    plastic = stored["plastic_depth"].transpose("y", "x").values if "plastic_depth" in stored else None
    known = {
        name.removeprefix("certificate_"): value
        for name, value in stored.attrs.items()
        if name.startswith("certificate_")
    }
    return Contact(
        height=answer.face.height,
        **fields,
        grid=grid_of(stored),
        solid=answer.case.solid,
        boundary=str(stored.attrs["boundary"]),
        contact_area_fraction=float(stored["contact_area_fraction"]),
        mean_pressure=float(stored["mean_pressure"]),
        approach=float(stored["approach"]),
        certificate=Certificate(**known),
        control_error=plain["control_error"],
        method=str(stored.attrs["method"]),
        rtol=plain["rtol"],
        hardness=float(stored["hardness"]) if "hardness" in stored else np.inf,
        plastic_depth=plastic,
        adhesion=adhesion_of(stored),
        attraction=stored["attraction"].transpose("y", "x").values if "attraction" in stored else None,
        fft_engine=str(stored.attrs["fft_engine"]),
    )


def _settings(answer: AnswerData) -> dict[str, Any]:
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


def _contact(answer: AnswerData) -> xr.Dataset:
    """Pressure, displacement, gap, tractions and spots; the attributes describe the lower body."""
    spots = answer.tables["contact_spots"]
    columns = {str(name).rsplit("_", 1)[0]: values.to_numpy() for name, values in spots.items()}
    listed = {f"spot_{name}": ("spot", values) for name, values in columns.items()}
    found = answer.contact.to_dataset().assign(listed)
    for each in answer.datasets.values():
        if set(each.sizes) == {"y", "x"}:
            found = found.assign(each.data_vars)
    attributes = {
        "force": answer["force"].value,
        "normal_approach": answer["normal approach"].value,
        "settings": json.dumps(_settings(answer), sort_keys=True),
    }
    return found.assign_attrs(attributes)


def _described(answer: AnswerData, body: str, stress: xr.Dataset) -> xr.Dataset:
    """The stress in one body, with attributes that describe it as in the files of the study."""
    layer = solid_of(answer.case.bodies[body])
    return stress.assign_attrs(
        unit_system=SI_UNITS,
        body=body,
        solid=layer.description,
        solid_reason="asked for",
        solid_bound=0.0,
        uniform_mode="laterally confined",
        poisson_contact=layer.poisson,
        young=layer.young,
        gradient_rms_contact=answer["rms gradient in contact"].value,
    )
