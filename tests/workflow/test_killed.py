"""A killed study loses no finished result, and continues with the same command."""

import numpy as np
from project import OWN

from asperity.results import dataset
from asperity.study.config.study import read_study
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.stress import stress_of_seed
from asperity.study.stages.surface import make_surface


def test_killed_study_continues_without_loss(killed_study, own_study, monkeypatch):
    """Also if the killed job has left half of its result: Snakemake marks results that are being made."""
    assert "--unlock" in killed_study.refusal
    assert {path: path.stat().st_mtime_ns for path in killed_study.finished} == killed_study.finished
    monkeypatch.chdir(own_study.folder)
    config = read_study(OWN[1:])
    surface = make_surface(config["surfaces"]["fine"], 1)
    contact = solve_contact(surface, config["layer"], config["contact"])
    stress = stress_of_seed(contact, config["layer"], config["stress"])
    for stage, expected in {"surface": surface, "contact": contact, "stress": stress}.items():
        written = dataset.read(own_study.results / stage / "fine/seed1.nc")
        assert set(written.variables) >= set(expected.variables), stage
        for name in expected.variables:
            np.testing.assert_array_equal(written[name], expected[name], f"{stage}: {name}")
