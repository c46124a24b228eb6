"""Axes of figures show the curves although a few values are far away."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from asperity.paper.figures.plots import finish_densities


def density_axis(*lines):
    axis = Figure().add_subplot()
    for x, y in lines:
        axis.plot(x, y, label="surface")
    finish_densities(axis, "t_3")
    return axis


X = np.linspace(0.05, 29.95, 300)
RAYLEIGH = X * np.exp(-(X**2) / 2)


def test_the_axis_of_a_density_ends_where_the_density_does():
    axis = density_axis((X, RAYLEIGH))
    end = axis.get_xlim()[1]
    assert 3.0 < end < 5.0
    assert axis.get_legend().get_title().get_text() == ""


def test_spikes_do_not_flatten_a_density_and_are_counted():
    spiked = RAYLEIGH + 0.1 * RAYLEIGH.sum() * (np.arange(X.size) == 290)
    axis = density_axis((X, RAYLEIGH), (X, spiked))
    assert axis.get_xlim()[1] == pytest.approx(density_axis((X, RAYLEIGH)).get_xlim()[1], rel=0.1)
    assert axis.get_legend().get_title().get_text() == "9.1 % beyond the axis"
