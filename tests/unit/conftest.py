"""Results that several modules of tests read."""

import pytest
from bad_input import make_chain

from asperity.results import dataset
from asperity.results.variables import in_si

EDGE = 512e-6


@pytest.fixture(scope="session")
def chain(tmp_path_factory):
    """Results of one small surface of the study by stage, made by the command line."""
    return make_chain(tmp_path_factory.mktemp("chain"))


@pytest.fixture(scope="session")
def chain_in_si(chain, tmp_path_factory):
    """The same in SI, with an edge of 512 µm and a modulus of 200 GPa."""
    folder, paths = tmp_path_factory.mktemp("si"), {}
    for stage in ("surface", "contact", "stress"):
        data = dataset.read(chain[stage])
        si, settings = in_si(data, dataset.settings_of(data), EDGE, 200e9)
        for name in ("settings", "settings_digest", "content_digest", "comment"):
            del si.attrs[name]
        paths[stage] = str(folder / f"{stage}.nc")
        dataset.write(si, paths[stage], "SI", settings)
    return paths
