"""Many maps of one surface: a job for each, continued where it stopped, with the numbers of one process."""

import shutil
import sys
from pathlib import Path

import yaml
from project import ROOT, snakemake

from asperity.cli.main import main

sys.path.append(str(Path(__file__).parents[1] / "data"))
import bearing


def test_maps_continue_with_the_same_bits(tmp_path):
    """One answer of two is there, as after a kill; it is kept, and the means are those of one process."""
    bearing.write_maps(tmp_path, (24, 32), patches=2)
    pool = {"map": ["ring_1.x3p", "ring_2.x3p"], "body": {"young": "210 GPa", "poisson": 0.3}}
    pool |= {"load": {"mean_pressure": "300 MPa"}, "sample": {}}
    (tmp_path / "pool.yaml").write_text(yaml.safe_dump(pool), encoding="utf-8")
    assert main(["run", str(tmp_path / "pool.yaml"), "--out", str(tmp_path / "one")]) == 0
    shutil.copytree(tmp_path / "one/ring_1", tmp_path / "study/ring_1")
    kept = tmp_path / "study/ring_1/contact.nc"
    before = kept.stat().st_mtime_ns
    arguments = ["--snakefile", str(ROOT / "workflow/maps.smk"), "--config", "case=pool.yaml", "out=study"]
    found = snakemake(tmp_path, *arguments)
    assert found.returncode == 0, found.stdout + found.stderr
    assert kept.stat().st_mtime_ns == before
    for name in ("sample.csv", "peaks_per_area.csv", "ring_2/answer.csv", "ring_2/peaks.csv"):
        assert (tmp_path / "study" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()
    logs = (tmp_path / "study/logs/ring_2.log").read_text(encoding="utf-8")
    assert "stress in the elastic body" in logs
    assert not (tmp_path / "study/logs/ring_1.log").exists()


def test_what_is_no_pool_is_refused(tmp_path):
    (tmp_path / "one.yaml").write_text("map: a.x3p\n", encoding="utf-8")
    found = snakemake(tmp_path, "--snakefile", str(ROOT / "workflow/maps.smk"), "--config", "case=one.yaml")
    assert "one.yaml: the group `sample` and a list of maps are needed" in found.stderr + found.stdout
