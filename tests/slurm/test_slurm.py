"""The study on a real SLURM: the same numbers as here, and jobs that it kills are named and made good."""

import importlib.util
import os
import subprocess

import pytest
import yaml
from cluster import cluster, missing
from project import QUICK, copy_project, snakemake

from asperity import dataset

REASON = missing()
if not REASON and importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
    REASON = "snakemake-executor-plugin-slurm is not installed: pip install asperity[slurm]"
pytestmark = [pytest.mark.slurm, pytest.mark.skipif(bool(REASON), reason=REASON)]

SLURM = ("--profile", "profiles/slurm", "--slurm-init-seconds-before-status-checks", "2")


@pytest.fixture(scope="module")
def slurm():
    with cluster(processors=2, memory=6000) as running:
        yield running


def on_slurm(slurm, folder, *arguments):
    """Run the workflow of a folder on the cluster; what it said, and its exit code."""
    found = subprocess.run(
        ["snakemake", *SLURM, *arguments],
        cwd=folder,
        env=slurm.environment | {"PYTHONPATH": str(folder / "src")},
        capture_output=True,
        text=True,
    )
    return found.stdout + found.stderr, found.returncode


def states(slurm):
    """State and comment of every job of the cluster so far."""
    lines = slurm.run("squeue", "--states=all", "--noheader", "--format=%T %k").splitlines()
    return [tuple(line.split(maxsplit=1)) for line in lines]


def modified(folder):
    """Result → time of its last change."""
    return {path: os.stat(path).st_mtime_ns for path in sorted(folder.glob("results/quick/*/**/*.nc"))}


def test_the_quick_study_has_the_same_numbers_in_every_file_as_here(slurm, tmp_path):
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    here, there = copy_project(tmp_path / "here"), copy_project(tmp_path / "there")
    said, code = on_slurm(slurm, there, *QUICK)
    assert code == 0, said
    finished = states(slurm)
    assert {state for state, _ in finished} == {"COMPLETED"}
    assert len(finished) < 15  # allocations, for five times as many jobs
    assert snakemake(here, *QUICK).returncode == 0
    files = {path.relative_to(here) for path in here.glob("results/quick/**/*.nc")}
    assert files == {path.relative_to(there) for path in there.glob("results/quick/**/*.nc")}
    assert len(files) > 25
    for file in sorted(files):
        assert dataset.read(here / file).identical(dataset.read(there / file)), file
    for picture in (here / "results/quick/figures").iterdir():
        assert picture.read_bytes() == (there / picture.relative_to(here)).read_bytes()


def test_jobs_killed_for_memory_and_for_time_are_named_and_the_study_goes_on_after_a_fix(slurm, tmp_path):
    folder = copy_project(tmp_path)
    points = {"hurst_08": {"points": 1024}, "cutoff_64": {"points": 512}}
    slow = {"surfaces": points, "contact": {"method": "gfmd", "path_area_fractions": [0.1]}}
    (folder / "slow.yaml").write_text(yaml.safe_dump(slow))
    (folder / "fast.yaml").write_text(yaml.safe_dump({"surfaces": points}))
    targets = [f"results/quick/{stage}/seed1.nc" for stage in ("body/cutoff_64", "contact/hurst_08")]
    ungrouped = ("--groups", "claims=table", "--keep-going")
    minutes = "1 if wildcards.surface == 'hurst_08' else 15"
    limits = ("--set-resources", "body:mem_mb=400", f"contact:runtime={minutes}")
    said, code = on_slurm(slurm, folder, *QUICK, "slow.yaml", *ungrouped, *limits, "--", *targets)
    assert code != 0
    assert "Error in rule body" in said
    assert "Out Of Memory" in said
    assert "Error in rule contact" in said
    assert "SLURM status is: 'TIMEOUT'" in said
    assert not any((folder / target).exists() for target in targets)
    kept = modified(folder)
    assert len(kept) == 3  # two surfaces and one contact

    fixed = (*QUICK, "fast.yaml", "--rerun-triggers", "mtime")
    said, code = on_slurm(slurm, folder, *fixed, *ungrouped, "--", *targets)
    assert code == 0, said
    again = modified(folder)
    assert {path: again[path] for path in kept} == kept
    assert {str(path.relative_to(folder)) for path in again} >= set(targets)
