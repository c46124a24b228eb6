"""Every figure of the paper is a target of `rule all`, and drawn from datasets alone."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from asperity.paper.figures import figures_of, known

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def jobs():
    """What `rule all` would do from nothing: figure → its input files, in a dry run of the paper's study."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    run = subprocess.run(
        ["snakemake", "--cores", "1", "--dry-run", "--forceall"],
        cwd=ROOT,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
    )
    text = run.stdout + run.stderr
    assert run.returncode == 0, text
    found = re.findall(r"^rule figure:\n    input: (.*)\n    output: (\S+)/(\w+)\.png", text, re.MULTILINE)
    return {name: inputs.split(", ") for inputs, _, name in found}


def test_rule_all_draws_every_figure_of_the_paper(jobs):
    assert jobs.keys() >= {f"fig{number:02d}" for number in range(1, 19)}
    assert {name.split("_")[1] for name in jobs if "_" in name} == {"moments", "measured"}


def test_a_figure_reads_what_its_table_names(jobs):
    for name, inputs in jobs.items():
        figure = known()[name.split("_")[0]]
        results = [Path(file) for file in inputs if file.endswith(".nc")]
        assert {path.parts[1] for path in results} == set(figure.stages), name
        assert {path.stem for path in results if path.parts[1] == "validation"} == set(figure.datasets), name


def test_figures_are_listed_without_matplotlib():
    code = "import sys, asperity.paper.figures as f; f.known(); print('matplotlib' in sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "False"


def test_results_are_a_tree_of_stages_studies_surfaces():
    studies = {"hurst": ["a"], "moments": ["b", "c"], "measured": [], "skewness": ["a"], "kurtosis": ["c"]}
    config = {"studies": {**studies, "mine": ["d"]}, "figures": "paper", "validation": ["punch"]}
    figures = figures_of({**config, "stress": {"poisson": [0.3]}})

    def tree(name):
        return figures[name].results(config["studies"], lambda stage, surface: f"{stage}/{surface}")

    assert tree("fig07") == {"contact": {"a": "contact/a"}}
    assert tree("fig10_moments") == {"statistics": {"b": "statistics/b", "c": "statistics/c"}}
    both = {"skewness": {"a": "statistics/a"}, "kurtosis": {"c": "statistics/c"}}
    assert tree("fig17") == {"statistics": both}
    assert tree("fig12") == {"validation": {"punch": "validation/punch"}}
    assert tree("peaks_mine") == {"statistics": {"d": "statistics/d"}}
    assert not {"fig10_measured", "fig01", "poisson_decay_mine"} & figures.keys()
