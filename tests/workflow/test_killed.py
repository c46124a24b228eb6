"""A killed study loses no finished result, and continues with the same command."""

import os
import signal
import subprocess
import time

import numpy as np
from project import TINY, copy_project, environment, snakemake

from asperity.results import dataset
from asperity.stress.analysis import SOUGHT
from asperity.study.config.study import read_study
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.study.stages.stress import stress_of_seed
from asperity.study.stages.surface import make_surface

SURFACE, CONTACT, STRESS = (
    f"results/tiny/{stage}/hurst_08/seed1.nc" for stage in ("surface", "contact", "stress")
)
STATISTICS = "results/tiny/statistics/hurst_08.nc"
ARGUMENTS = (*TINY, "--", STATISTICS)


def killed(folder, path):
    """Run the study until a file is there, and kill it with all its jobs."""
    command = ["snakemake", "--cores", "2", *ARGUMENTS]
    with subprocess.Popen(command, cwd=folder, env=environment(folder), start_new_session=True) as study:
        while not (folder / path).exists():
            assert study.poll() is None
            time.sleep(0.05)
        os.killpg(study.pid, signal.SIGKILL)


def computed(folder, monkeypatch):
    """Results of all stages by the functions that the scripts call."""
    monkeypatch.chdir(folder)
    config = read_study(TINY[1:])
    surface = make_surface(config["surfaces"]["hurst_08"], 1)
    contact = solve_contact(surface, config["layer"], config["contact"])
    quantities = [*SOUGHT, "xy"]  # for the interpretations of the claims
    stress = stress_of_seed(contact, config["layer"], config["stress"], ["free"], quantities)
    statistics = surface_statistics([SeedResults(1, surface, contact, stress)], **config["statistics"])
    return {SURFACE: surface, CONTACT: contact, STRESS: stress, STATISTICS: statistics}


def test_killed_study_continues_without_loss(tmp_path, monkeypatch):
    """Also if the killed job has left half of its result: Snakemake marks results that are being made."""
    folder = copy_project(tmp_path / "project")
    killed(folder, "results/tiny/log/stress/hurst_08/seed1.log")  # surface and contact are finished
    before = [(folder / name).stat().st_mtime_ns for name in (SURFACE, CONTACT)]
    assert not (folder / STRESS).exists()
    (folder / STRESS).parent.mkdir(parents=True, exist_ok=True)
    (folder / STRESS).write_bytes(b"half of a result")
    refused = snakemake(folder, *ARGUMENTS)
    assert refused.returncode != 0
    assert "--unlock" in refused.stdout + refused.stderr
    assert snakemake(folder, *TINY, "--unlock").returncode == 0
    found = snakemake(folder, *ARGUMENTS)
    assert found.returncode == 0, found.stdout + found.stderr
    assert [(folder / name).stat().st_mtime_ns for name in (SURFACE, CONTACT)] == before
    for name, expected in computed(folder, monkeypatch).items():
        written = dataset.read(folder / name)
        assert set(written.variables) >= set(expected.variables), name
        for variable in expected.variables:
            np.testing.assert_array_equal(written[variable], expected[variable], f"{name}: {variable}")
