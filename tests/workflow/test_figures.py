"""Every figure of the paper is a target of `rule all`, and drawn from datasets alone."""

import ast
import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asperity.paper.figures import describe, describe_all, modules
from asperity.paper.figures.plots import folded_density

ROOT = Path(__file__).parents[2]
PAPER = [f"fig{number:02d}" for number in range(1, 19)]


@pytest.fixture(scope="module")
def jobs():
    """What `rule all` would do from nothing: figure → its input files, in a dry run of the paper's study."""
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    run = subprocess.run(
        ["snakemake", "--cores", "1", "--dry-run", "--forceall"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
    )
    text = run.stdout + run.stderr
    assert run.returncode == 0, text
    found = re.findall(r"^rule figure:\n    input: (.*)\n    output: (\S+)/(\w+)\.png", text, re.MULTILINE)
    return {name: inputs.split(", ") for inputs, _, name in found}


def test_rule_all_asks_for_every_figure_of_the_paper(jobs):
    missing = [figure for figure in PAPER if figure not in jobs]
    assert not missing, f"not targets of rule all: {', '.join(missing)}"


def test_a_figure_reads_the_results_that_its_module_names(jobs):
    for figure, inputs in jobs.items():
        description = describe(figure.split("_")[0])
        results = [Path(file) for file in inputs if file.endswith(".nc")]
        assert {path.parts[1] for path in results} == set(description.stages), figure
        datasets = {path.stem for path in results if path.parts[1] == "validation"}
        assert datasets == set(description.datasets), figure


@pytest.mark.parametrize("name", modules())
def test_drawing_and_caption_take_the_stages_that_the_module_names(name):
    module = importlib.import_module(f"asperity.paper.figures.{name}")
    for function in (module.draw, module.caption):
        assert tuple(inspect.signature(function).parameters) == describe(name).stages


def test_descriptions_are_read_without_the_libraries_for_plotting():
    code = "import sys, asperity.paper.figures as f; f.modules(); print('matplotlib' in sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "False"


def test_the_results_of_a_figure_are_a_tree_of_stages_studies_and_surfaces():
    studies = {"hurst": ["a"], "moments": ["b", "c"], "measured": [], "skewness": ["a"], "kurtosis": ["c"]}
    figures = describe_all(studies)

    def tree(name):
        return figures[name].results(studies, lambda stage, surface: f"{stage}/{surface}")

    assert tree("fig08") == {"contact": {"a": "contact/a"}, "statistics": {"a": "statistics/a"}}
    assert tree("fig10_moments") == {"statistics": {"b": "statistics/b", "c": "statistics/c"}}
    assert tree("fig17") == {
        "statistics": {"skewness": {"a": "statistics/a"}, "kurtosis": {"c": "statistics/c"}}
    }
    assert tree("fig12") == {"validation": {"punch": "validation/punch"}}
    assert "fig10_measured" not in figures


def test_every_figure_depends_on_its_module_and_the_style(jobs):
    for figure, inputs in jobs.items():
        assert f"src/asperity/paper/figures/{figure.split('_')[0]}.py" in inputs
        assert "src/asperity/views/style.mplstyle" in inputs


def test_the_supplement_shows_given_kurtosis_and_measured_surfaces(jobs):
    studies = {name.split("_")[1] for name in jobs if "_" in name}
    assert studies == {"moments", "measured"}


@pytest.mark.parametrize("name", modules())
def test_a_figure_opens_no_file_of_its_own(name):
    tree = ast.parse((ROOT / f"src/asperity/paper/figures/{name}.py").read_text())
    called = {
        node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
    }
    assert not called & {"open", "open_dataset", "load", "loadtxt", "read", "read_text", "read_bytes"}


def test_every_figure_of_the_paper_says_what_the_paper_says_and_ours_shows():
    rows = [line for line in (ROOT / "docs/figures.md").read_text().splitlines() if line.startswith("| ")]
    described = {row.split("|")[1].strip() for row in rows}
    assert described >= {str(number) for number in range(1, 19)}


def test_a_folded_density_is_the_density_of_the_magnitude():
    """Rounding: the density is constant in each bin, and the folded bins divide them."""
    edges = np.linspace(-1.0, 2.0, 31)
    folded = np.linspace(0.0, 2.0, 21)
    values = np.where(edges[1:] <= 1e-12, 0.25, 0.375)
    result = folded_density(values, edges, folded)
    np.testing.assert_allclose(result[:10], 0.625, rtol=1e-12)
    np.testing.assert_allclose(result[10:], 0.375, rtol=1e-12)
    assert float(np.sum(result * np.diff(folded))) == pytest.approx(1)
