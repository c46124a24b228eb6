"""An RO-Crate of the results of a study: the content of each file, the workflow and the settings.

The crate follows RO-Crate 1.1 and the profiles Workflow RO-Crate 1.0 and Workflow Run Crate 0.5
(https://w3id.org/ro/crate/1.1, https://w3id.org/workflowhub/workflow-ro-crate/1.0,
https://w3id.org/ro/wfrun/workflow/0.5).
"""

import shutil
from collections.abc import Sequence
from datetime import UTC, datetime
from mimetypes import guess_type
from pathlib import Path
from typing import Any

import xarray as xr
from rocrate.model.contextentity import ContextEntity
from rocrate.model.person import Person
from rocrate.rocrate import ROCrate

from asperity.core.version import __version__
from asperity.paper import PAPER
from asperity.results.dataset import FINGERPRINT

METADATA = "ro-crate-metadata.json"
LICENCE = "https://spdx.org/licenses/MIT"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
"""Profile → its name."""

WORKFLOW = "workflow"
"""Folder of the crate that holds a copy of the Snakefile and of the configuration."""

_NO_RESULTS = ("log", "benchmark", WORKFLOW, METADATA)


def write_crate(results: Path, snakefile: Path, configfiles: Sequence[Path] = ()) -> int:
    """Write the metadata of the crate among the results, and return the number of files that it describes.

    Parameters
    ----------
    results : Path
        Folder of a finished study. Its files stay as they are; copies of the Snakefile and of the
        configuration are added in ``workflow``.
    snakefile : Path
    configfiles : sequence of Path
        By default ``config/config.yaml``.

    Raises
    ------
    FileNotFoundError
        If there are no results.
    """
    files = [path for path in sorted(results.rglob("*")) if path.is_file()]
    found = [path for path in files if path.relative_to(results).parts[0] not in _NO_RESULTS]
    if not found:
        raise FileNotFoundError(f"{results}: no results; run the study first")
    made = datetime.fromtimestamp(max(path.stat().st_mtime for path in found), UTC)
    crate = ROCrate(version="1.1")

    def entity(identifier: str, kind: str, /, **properties: Any) -> ContextEntity:
        return crate.add(ContextEntity(crate, identifier, {"@type": kind, **properties}))

    crate.name = f"Results of {results.name}: stress inside elastic solids pressed against rough surfaces"
    crate.description = f"Made by asperity {__version__}. The method follows {PAPER}."
    crate.datePublished = made
    crate.license = entity(LICENCE, "CreativeWork", name="MIT License")
    developers = crate.add(Person(crate, "#developers", properties={"name": "The asperity developers"}))
    crate.root_dataset["author"] = developers
    crate.root_dataset["conformsTo"] = [
        entity(profile, "CreativeWork", name=name, version=profile.rpartition("/")[2])
        for profile, name in PROFILES.items()
    ]
    about = {"name": "From rough surfaces to the figures of the paper", "version": __version__}
    about["license"] = LICENCE
    copied, place = _copied(snakefile, results), f"{WORKFLOW}/{snakefile.name}"
    workflow = crate.add_workflow(copied, place, main=True, lang="snakemake", properties=about)
    program = {"name": "asperity", "version": __version__}
    workflow["softwareRequirements"] = entity("#asperity", "SoftwareApplication", **program)
    workflow["author"] = developers
    settings = [
        crate.add_file(_copied(path, results), f"{WORKFLOW}/{path.name}", properties=_described(path))
        for path in configfiles or [Path("config/config.yaml")]
    ]
    places = {path: path.relative_to(results).as_posix() for path in found}
    described = [crate.add_file(*each, properties=_described(each[0])) for each in places.items()]
    run = entity("#run", "CreateAction", name=f"Run of the study into {results.name}")
    run["endTime"] = made.isoformat(timespec="seconds")
    run["actionStatus"] = "http://schema.org/CompletedActionStatus"
    run["instrument"], run["object"], run["result"], run["agent"] = workflow, settings, described, developers
    crate.root_dataset["mentions"] = [run]
    crate.metadata.write(results)
    return len(described)


def _described(path: Path) -> dict[str, Any]:
    """Properties of a file; of a NetCDF file from its own attributes."""
    found = {
        "name": path.stem.replace("_", " "),
        "encodingFormat": guess_type(path.name)[0] or "text/plain",
        "contentSize": str(path.stat().st_size),
    }
    if path.suffix == ".nc":
        with xr.open_dataset(path, engine="netcdf4") as data:
            names = {"name": "title", "description": "summary", "identifier": FINGERPRINT}
            found |= {name: str(data.attrs[key]) for name, key in names.items() if key in data.attrs}
    return found


def _copied(path: Path, results: Path) -> Path:
    """A copy of a file in the folder of the workflow."""
    folder = results / WORKFLOW
    folder.mkdir(exist_ok=True)
    return Path(shutil.copyfile(path, folder / path.name))
