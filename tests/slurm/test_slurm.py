"""The study on a real SLURM: the same results as on this machine, and failed jobs are named and run again."""

import importlib.util
import os
import subprocess

import pytest
import yaml
from cluster import cluster, missing
from project import QUICK, copy_project, numbers, snakemake

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
    """Run the workflow of a folder on the cluster; its output and exit status."""
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
    return {path: os.stat(path).st_mtime_ns for path in sorted(folder.glob("results/quick/**/*.nc"))}


def test_the_quick_study_has_the_same_results_as_on_this_machine(slurm, tmp_path):
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    here, there = copy_project(tmp_path / "here"), copy_project(tmp_path / "there")
    said, code = on_slurm(slurm, there, *QUICK)
    assert code == 0, said
    finished = states(slurm)
    assert {state for state, _ in finished} == {"COMPLETED"}
    assert len(finished) < 16  # allocations, for nearly five times as many jobs
    assert snakemake(here, *QUICK).returncode == 0
    files = {path.relative_to(here) for path in here.glob("results/quick/**/*.nc")}
    assert files == {path.relative_to(there) for path in there.glob("results/quick/**/*.nc")}
    assert len(files) > 25
    for file in sorted(files):
        assert numbers(here / file).identical(numbers(there / file)), file
    for picture in (here / "results/quick/figures").iterdir():
        assert picture.read_bytes() == (there / picture.relative_to(here)).read_bytes()


def test_jobs_killed_for_memory_and_for_time_are_named_and_the_study_goes_on_after_a_fix(slurm, tmp_path):
    folder = copy_project(tmp_path)
    large = {"surfaces": {"hurst_02": {"points": 3072}}}
    (folder / "slow.yaml").write_text(
        yaml.safe_dump(large | {"validation": {"stability": {"per_decade": 50}}})
    )
    (folder / "fast.yaml").write_text(yaml.safe_dump(large))
    names = ("surface/cutoff_64/seed1", "surface/hurst_02/seed1", "validation/stability")
    targets = [f"results/quick/{name}.nc" for name in names]
    ungrouped = ("--groups", "claims=table", "--keep-going")
    megabytes = "420 if wildcards.surface == 'hurst_02' else 700"
    limits = ("--set-resources", f"surface:mem_mb={megabytes}", "validation:runtime=1")
    said, code = on_slurm(slurm, folder, *QUICK, "slow.yaml", *ungrouped, *limits, "--", *targets)
    assert code != 0
    failures = {line for line in said.splitlines() if line.startswith("study: results/")}
    (log,) = (folder / ".snakemake/slurm_logs/rule_surface").rglob("*.log")
    assert [line for line in failures if line.startswith(f"study: {targets[1]}: ") and str(log) in line]
    assert "Out Of Memory" in log.read_text()
    timed_out = [line for line in failures if line.startswith(f"study: {targets[2]}: ")]
    assert ["SLURM status is: 'TIMEOUT'" in line for line in timed_out] == [True]
    kept = modified(folder)
    assert [str(path.relative_to(folder)) for path in kept] == targets[:1]

    said, code = on_slurm(slurm, folder, *QUICK, "fast.yaml", *ungrouped, "--", *targets)
    assert code == 0, said
    again = modified(folder)
    assert [str(path.relative_to(folder)) for path in again] == targets
    assert all(again[path] == time for path, time in kept.items())
