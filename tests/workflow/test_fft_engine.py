"""A study with the engine pyfftw measures its plans first, and its jobs read them."""

import json

import pytest
import yaml
from project import copy_project, snakemake

from asperity.results import dataset

pytest.importorskip("pyfftw")

CONFIG = {
    "fft_engine": "pyfftw",
    "seeds": [1],
    "surfaces": {
        "a": {
            "label": "A",
            "hurst": 0.8,
            "wavelength_long": 0.5,
            "wavelength_short": 0.25,
            "rms_height": 0.001,
            "points": 32,
        }
    },
}
WISDOM = "results/mine/fft_wisdom/32.json"
STAGES = ("surface", "contact", "stress", "statistics", "verification")


def test_jobs_read_the_plans_that_a_rule_has_measured(tmp_path):
    folder = copy_project(tmp_path / "project")
    (folder / "mine.yaml").write_text(yaml.safe_dump(CONFIG), encoding="utf-8")
    options = ("--configfile", "mine.yaml")
    planned = snakemake(folder, *options, "--dry-run")
    text = planned.stdout + planned.stderr
    assert planned.returncode == 0, text
    rules = {block.split(":")[0]: block for block in text.split("rule ")[1:]}
    assert [name for name in rules if WISDOM in rules[name] and name in STAGES] == list(STAGES)
    assert "fft_wisdom" not in snakemake(folder, *options, "--dry-run", "--config", "fft_engine=ducc0").stdout

    made = "results/mine/surface/a/seed1.nc"
    found = snakemake(folder, *options, "--", made)
    assert found.returncode == 0, found.stdout + found.stderr
    assert set(json.loads((folder / WISDOM).read_text())["plans"]) >= {"r2c 32 32 float64"}
    assert " wisdom " in dataset.read(folder / made).attrs["fft_engine"]
