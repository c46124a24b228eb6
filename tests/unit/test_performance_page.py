"""The page of the performance is what its tables say, and its benchmarks count and compare as it states."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import asperity as asp

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def benchmarks(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")


def test_the_page_is_made_from_the_tables_beside_it():
    from performance_page import FOLDER, PAGE, page

    text = PAGE.read_text(encoding="utf-8")
    assert text == page(FOLDER)
    for picture in FOLDER.glob("*.png"):
        assert f"performance/{picture.name}" in text


def test_costs_at_equal_error_follow_a_power_law_between_the_runs():
    from performance_plots import at_error

    error = np.array([1e-4, 1e-5, 3e-7])
    runs = pd.DataFrame({"error": error, "seconds": 2 * error**-0.25})
    seconds, is_bound = at_error(runs, 1e-6)
    assert seconds == pytest.approx(2 * 1e-6**-0.25)
    assert not is_bound
    assert at_error(runs, 1e-3) == (pytest.approx(20.0), True)
    assert np.isnan(at_error(runs, 1e-8)[0])


def test_the_exponent_is_that_of_the_nodes():
    from performance_page import exponent

    points = np.array([512, 1024, 4096])
    runs = pd.DataFrame({"points": points, "seconds": 3.0 * (points**2.0) ** 1.07})
    assert exponent(runs, "seconds") == pytest.approx(1.07)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_every_transform_of_a_solution_is_counted(boundary):
    """The library leaves out those on the small maps, of 64² nodes, from which it makes its stencils."""
    from contact_run import counted, solver_of

    solver, height = solver_of("active_set float64", boundary), np.random.default_rng(0).random((64, 64))
    with counted() as transforms:
        contact = solver.solve(height, 0.02, 1e-6)
    pairs = sum(transforms.nodes.values()) / (2 * height.size)
    assert contact.certificate.pairs < pairs < contact.certificate.pairs + 10
    assert transforms.nodes["float32"] > 0
    assert asp.verify_contact(height, contact.pressure, contact.solid, boundary=boundary).worst < 1e-4
