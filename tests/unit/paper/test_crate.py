"""The RO-Crate of results against the rules of RO-Crate 1.1 and of the Workflow Run Crate."""

from __future__ import annotations

import json

import numpy as np
import pytest
from project import ROOT

import asperity as asp

pytest.importorskip("rocrate")

from asperity.paper.crate import METADATA, PROFILES, write_crate

STUDY = ROOT / "workflow/Snakefile", [ROOT / "config/config.yaml"]


@pytest.fixture
def results(tmp_path):
    height = asp.self_affine((32, 32), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    (tmp_path / "contact").mkdir()
    contact.to_netcdf(tmp_path / "contact/seed1.nc")
    (tmp_path / "claims.csv").write_text("identifier,value\na,1\n")
    (tmp_path / "log").mkdir()
    (tmp_path / "log/claims.csv").write_text("not a result")
    return tmp_path


def graph(folder):
    entities = json.loads((folder / METADATA).read_text())["@graph"]
    found = {entity["@id"]: entity for entity in entities}
    assert len(found) == len(entities)
    return found


def references(value):
    if isinstance(value, dict):
        return [value["@id"]]
    return [one for item in value for one in references(item)] if isinstance(value, list) else []


def test_the_crate_describes_results_workflow_and_run(results):
    assert write_crate(results, *STUDY) == 2
    found = graph(results)
    descriptor, root = found[METADATA], found["./"]
    assert descriptor["about"] == {"@id": "./"}
    assert {"@id": "https://w3id.org/ro/crate/1.1"} in np.atleast_1d(descriptor["conformsTo"]).tolist()
    assert {"name", "description", "datePublished", "license", "author"} <= root.keys()
    assert set(references(root["conformsTo"])) == set(PROFILES)
    workflow = found[root["mainEntity"]["@id"]]
    assert workflow["@type"] == ["File", "SoftwareSourceCode", "ComputationalWorkflow"]
    run = found[root["mentions"]["@id"] if isinstance(root["mentions"], dict) else root["mentions"][0]["@id"]]
    assert run["@type"] == "CreateAction"
    assert run["instrument"] == {"@id": workflow["@id"]}
    assert set(references(run["result"])) == {"contact/seed1.nc", "claims.csv"}
    contact = found["contact/seed1.nc"]
    assert contact["encodingFormat"] == "application/x-netcdf"
    assert contact["identifier"] == asp.read_result(results / "contact/seed1.nc").attrs["content_digest"]


def test_every_file_and_reference_of_crate_exists(results):
    assert write_crate(results, *STUDY) == write_crate(results, *STUDY)  # a crate is no part of the next one
    found = graph(results)
    for entity in found.values():
        if "File" in np.atleast_1d(entity["@type"]):
            assert (results / entity["@id"]).is_file()
            assert entity["@id"] in references(found["./"]["hasPart"])
        for name, value in entity.items():
            for reference in references(value) if name != "@type" else ():
                assert reference in found or reference.startswith("https://"), (entity["@id"], name)


def test_without_results_there_is_no_crate(tmp_path):
    with pytest.raises(FileNotFoundError, match="no results; run the study first"):
        write_crate(tmp_path, *STUDY)
