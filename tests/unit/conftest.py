"""Results that several modules of tests read."""

import pytest
from bad_input import make_chain

import asperity as asp
from asperity.results import dataset
from asperity.surface.roughness import surface_dataset

EDGE = 512e-6


@pytest.fixture(scope="session")
def chain(tmp_path_factory):
    """Results of one small surface of the study by stage."""
    return make_chain(tmp_path_factory.mktemp("chain"))


@pytest.fixture(scope="session")
def chain_in_si(chain, tmp_path_factory):
    """The same in SI, with an edge of 512 µm and a modulus of 200 GPa, by the functions of the library."""
    folder, grid = tmp_path_factory.mktemp("si"), asp.Grid((64, 64), EDGE)
    height = EDGE * dataset.read(chain["surface"])["height"].values
    contact = asp.solve_contact(
        height, asp.Solid(200e9 * (1 - 0.33**2), 0.33), grid, contact_area_fraction=0.2
    )
    stress = asp.analyse_stress(contact, poisson=[0.0, 0.33]).assign_attrs(poisson_contact=0.33)
    results = {
        "surface": surface_dataset(height, grid),
        "contact": contact.to_dataset(),
        "stress": stress.assign_attrs(gradient_rms_contact=contact.gradient_rms_contact),
    }
    paths = {stage: str(folder / f"{stage}.nc") for stage in results}
    for stage, path in paths.items():
        dataset.write(results[stage].assign_attrs(unit_system="SI"), path, "SI", {"name": "small"})
    return paths
