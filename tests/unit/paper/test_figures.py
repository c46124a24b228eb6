"""Figures: the results that each is drawn from, and axes for extreme values or for none."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from small_study import CONTACT, LAYER

from asperity.fourier.grid import Grid
from asperity.paper.figures import cases, cell, draw, figures_of, known, peaks
from asperity.paper.figures.cases import finish_densities, folded_density
from asperity.results import dataset
from asperity.study.stages.contact import press_surface
from asperity.surface.roughness import surface_dataset
from asperity.views.style import save, style


def density_axis(*lines):
    axis = Figure().add_subplot()
    for x, y in lines:
        axis.plot(x, y, label="surface")
    finish_densities(axis, "t_3")
    return axis


X = np.linspace(0.05, 29.95, 300)
RAYLEIGH = X * np.exp(-(X**2) / 2)


def test_axis_of_a_density_ends_with_it():
    axis = density_axis((X, RAYLEIGH))
    end = axis.get_xlim()[1]
    assert 3.0 < end < 5.0
    assert axis.get_legend().get_title().get_text() == ""


def test_spikes_of_a_density_are_counted():
    spiked = RAYLEIGH + 0.1 * RAYLEIGH.sum() * (np.arange(X.size) == 290)
    axis = density_axis((X, RAYLEIGH), (X, spiked))
    assert axis.get_xlim()[1] == pytest.approx(density_axis((X, RAYLEIGH)).get_xlim()[1], rel=0.1)
    assert axis.get_legend().get_title().get_text() == "9.1 % beyond the axis"


def test_a_folded_density_is_that_of_the_magnitude():
    """Rounding: the density is constant in each bin, and the folded bins divide them."""
    edges = np.linspace(-1.0, 2.0, 31)
    folded = np.linspace(0.0, 2.0, 21)
    values = np.where(edges[1:] <= 1e-12, 0.25, 0.375)
    result = folded_density(values, edges, folded)
    np.testing.assert_allclose(result[:10], 0.625, rtol=1e-12)
    np.testing.assert_allclose(result[10:], 0.375, rtol=1e-12)
    assert float(np.sum(result * np.diff(folded))) == pytest.approx(1)


@pytest.mark.parametrize("bins_with_peaks", [0, 1])
def test_joint_densities_are_drawn_without_peaks(chain, tmp_path, bins_with_peaks):
    statistics = dataset.read(chain["statistics"])
    few = statistics.assign(joint_counts=statistics["joint_counts"] * 0)
    few["joint_counts"][..., 3, 3] = bins_with_peaks
    figure = peaks.draw_depths({"one": few}, "surfaces")
    figure.savefig(tmp_path / "figure.png")
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert ("no peaks" in texts) == (bins_with_peaks == 0)


def test_depths_end_below_most_peaks(chain):
    """Of 2000 peaks three lie deep: two of every thousand may, one and a half do not."""
    statistics = dataset.read(chain["statistics"])
    many = statistics.assign(joint_counts=statistics["joint_counts"] * 0)
    many["joint_counts"][..., 0, 2], many["joint_counts"][..., 0, 5], many["joint_counts"][..., 0, 40] = (
        1997,
        1,
        2,
    )
    (axis, *_) = peaks.draw_depths({"one": many}, "surfaces").axes
    unit = cases.FigureCase("", many).wavelength_short
    assert axis.get_ylim() == pytest.approx((float(many["depth_edge"][6]) / unit, 0))
    assert [text.get_text() for text in axis.texts] == ["2 of 2000 peaks\nbeyond the axes"]


def test_figures_tell_their_surface_ratios_area_and_seeds(chain):
    statistics = dataset.read(chain["statistics"])
    area = 100 * float(statistics["seed_contact_area_fraction"].mean())
    text = cases.settings_in_words({"statistics": {"one": statistics}}, several_ratios=True)
    ratios = ", ".join(f"{ratio:g}" for ratio in statistics["poisson"].values)
    assert text.startswith(f"H = 0.8; ν = {ratios}; area {area:.2g} %; seeds 1")
    own = cases.settings_in_words({"statistics": {"one": statistics}}, several_ratios=False)
    assert f"ν = {statistics.attrs['poisson_contact']:g};" in own


def test_copies_under_other_loads_are_one_surface(chain):
    one = dataset.read(chain["statistics"])
    copies = {f"a_load{n}": one.assign_attrs(label=f"ground, {n} %") for n in (1, 2, 3)}
    found = cases.distinct(copies)
    assert {key: data.attrs["label"] for key, data in found.items()} == {"a_load1": "ground"}


def test_the_cell_of_an_oblong_map_is_drawn(tmp_path):
    waves = np.cos(2 * np.pi * np.arange(32) / 32)
    surface = surface_dataset(1e-3 * (waves[::2, None] + waves), Grid((16, 32), (0.5, 1.0)))
    contact = press_surface(surface, LAYER, CONTACT)
    results = ({"one": data.assign_attrs(label="a")} for data in (surface, contact))
    cell.draw_rough(*results).savefig(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").exists()


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


@pytest.mark.parametrize(
    ("name", "stages"), [("fig07", ["contact"]), ("fig09", ["statistics"]), ("fig14", ["statistics"])]
)
def test_figures_of_the_paper_are_drawn(chain, tmp_path, name, stages):
    """From the results of one surface, as the rule of the study draws them."""
    shown = {stage: {"small": dataset.read(chain[stage])} for stage in stages}
    pictures = [tmp_path / "figure.png", tmp_path / "figure.pdf"]
    with style():
        save(draw(known()[name], shown), *pictures)
    assert all(picture.stat().st_size > 3000 for picture in pictures)
