"""Many maps of one surface: a job for each, continued where it stopped, with the numbers of one process."""

import os
import re
import shutil
import sys
from contextlib import chdir
from pathlib import Path

import pytest
import yaml
from project import ROOT, snakemake, snakemake_here

from asperity.cli.main import main

sys.path.append(str(Path(__file__).parents[1] / "data"))
import bearing


def test_maps_continue_with_the_same_bits(tmp_path, without_pictures):
    """One answer of two is there, as after a kill; it is kept, and the means are the same as of one process.

    The names have characters that mean something to the shell, in patterns and to the command line.
    """
    names = ["scan (1)", "-a[1]+$b"]
    for file, name in zip(bearing.write_maps(tmp_path, (24, 32), patches=2)["ring"], names, strict=True):
        file.rename(tmp_path / f"{name}.x3p")
    pool = {"map": [f"{name}.x3p" for name in names], "body": {"young": "210 GPa", "poisson": 0.3}}
    pool |= {"load": {"mean_pressure": "300 MPa"}, "sample": {}}
    (tmp_path / "pool.yaml").write_text(yaml.safe_dump(pool), encoding="utf-8")
    assert main(["run", str(tmp_path / "pool.yaml"), "--out", str(tmp_path / "one")]) == 0
    shutil.copytree(tmp_path / "one" / names[0], tmp_path / "study" / names[0])
    kept = tmp_path / "study" / names[0] / "contact.nc"
    before = kept.stat().st_mtime_ns
    arguments = ["--snakefile", str(ROOT / "workflow/maps.smk"), "--config", "case=pool.yaml", "out=study"]
    found = snakemake(tmp_path, *arguments)
    assert found.returncode == 0, found.stdout + found.stderr
    assert kept.stat().st_mtime_ns == before
    for name in ("sample.csv", "peaks_per_area.csv", f"{names[1]}/answer.csv", f"{names[1]}/peaks.csv"):
        assert (tmp_path / "study" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()
    os.utime(tmp_path / f"{names[1]}.x3p", (2e9, 2e9))  # as in a copy
    assert not re.search(r"^answer +\d", snakemake_here(tmp_path, *arguments, "--dry-run"), re.MULTILINE)
    (tmp_path / "materials.yaml").write_text("{}", encoding="utf-8")
    assert re.search(r"^answer +2$", snakemake_here(tmp_path, *arguments, "--dry-run"), re.MULTILINE)
    logs = (tmp_path / f"study/logs/{names[1]}.log").read_text(encoding="utf-8")
    assert "The bodies are in contact on " in logs
    assert not (tmp_path / f"study/logs/{names[0]}.log").exists()


@pytest.mark.parametrize(
    ("case", "line"),
    [
        ("map: a.x3p", "case.yaml: the group `sample` and a list of maps are needed"),
        ("{sample: {}, map: ['{x}.x3p']}", "{x}.x3p: a name without braces is needed"),
    ],
)
def test_what_is_no_pool_is_refused(case, line, tmp_path):
    (tmp_path / "case.yaml").write_text(case, encoding="utf-8")
    above_the_rules = (ROOT / "workflow/maps.smk").read_text(encoding="utf-8").split("\nwildcard_")[0]
    with chdir(tmp_path), pytest.raises(SystemExit, match=re.escape(line)):
        exec(above_the_rules, {"config": {"case": "case.yaml"}})
