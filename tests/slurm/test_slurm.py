"""A small study on a real SLURM: the same results as on this machine, and a failed job is named."""

import importlib.util
import shutil
import subprocess

import pytest
from cluster import cluster, missing
from project import ROOT, TINY, copy_project, numbers, snakemake

REASON = missing()
if not REASON and importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
    REASON = "snakemake-executor-plugin-slurm is not installed: pip install asperity[slurm]"
pytestmark = [pytest.mark.slurm, pytest.mark.skipif(bool(REASON), reason=REASON)]

STATISTICS = "results/tiny/statistics/hurst_08.nc"
SLURM = ("--profile", "profiles/slurm", "--slurm-init-seconds-before-status-checks", "2")


@pytest.fixture(scope="module")
def slurm():
    with cluster(processors=2, memory=6000) as running:
        yield running


def on_slurm(slurm, folder, *arguments):
    """Run the workflow of a folder on the cluster; its output and exit status."""
    command = ["snakemake", *SLURM, *TINY, *arguments]
    environment = slurm.environment | {"PYTHONPATH": str(folder / "src")}
    found = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    return found.stdout + found.stderr, found.returncode


def test_cluster_gives_the_same_results(slurm, tmp_path):
    here, there = (copy_project(tmp_path / name) for name in ("here", "there"))
    text, code = on_slurm(slurm, there, "--", STATISTICS)
    assert code == 0, text
    states = slurm.run("squeue", "--states=all", "--noheader", "--format=%T").splitlines()
    assert set(states) == {"COMPLETED"}
    assert snakemake(here, *TINY, "--", STATISTICS).returncode == 0
    files = {path.relative_to(here) for path in here.glob("results/tiny/**/*.nc")}
    assert files == {path.relative_to(there) for path in there.glob("results/tiny/**/*.nc")}
    for file in sorted(files):
        assert numbers(here / file).identical(numbers(there / file)), file


def test_failed_job_is_named_with_its_log(slurm, tmp_path):
    folder = copy_project(tmp_path / "project")
    (folder / "src").unlink()  # a link to the library, which keeps its module
    shutil.copytree(ROOT / "src", folder / "src")
    module = folder / "src/asperity/study/stages/statistics.py"
    text = module.read_text()
    module.write_text(text + "\n\ndef surface_statistics(*_, **settings):\n    raise ValueError('none')\n")
    said, code = on_slurm(slurm, folder, "--", STATISTICS)
    assert code != 0
    assert "results/tiny/log/statistics/hurst_08.log" in said
    module.write_text(text)
    said, code = on_slurm(slurm, folder, "--", STATISTICS)
    assert code == 0, said
