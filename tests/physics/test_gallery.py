"""Every example of the gallery runs without a warning, and its own checks of the physics hold."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/plot_*.py"))

pytestmark = pytest.mark.xdist_group("gallery")  # one process: functions are compiled and imported once


@pytest.fixture(autouse=True)
def _no_window(monkeypatch: pytest.MonkeyPatch):
    """Pictures are drawn but not shown, and closed afterwards."""
    monkeypatch.setattr(plt, "show", lambda: None)
    with mpl.rc_context():
        plt.switch_backend("agg")
        yield
        plt.close("all")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem.split("_", 2)[2])
def test_the_example_runs_and_its_checks_hold(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    checks = [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Assert)]
    assert checks, "an example ends with a check of its physics"
    monkeypatch.chdir(path.parent)
    runpy.run_path(str(path), run_name="__main__")
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 12
