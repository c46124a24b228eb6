"""Figures of contacts so small that nothing, or only one value, can be counted under them."""

import pytest
from bad_input import make_chain

from asperity.paper.figures import fig10_14_18
from asperity.results import dataset


@pytest.fixture(scope="module")
def statistics(tmp_path_factory):
    """Statistics of one small surface."""
    return dataset.read(make_chain(tmp_path_factory.mktemp("chain"))["statistics"])


@pytest.mark.parametrize("bins_with_peaks", [0, 1])
def test_joint_densities_are_drawn_without_peaks(statistics, tmp_path, bins_with_peaks):
    counts = statistics["joint_counts"]
    few = statistics.assign(joint_counts=counts * 0)
    if bins_with_peaks:
        few["joint_counts"][..., 3, 3] = 1
    figure = fig10_14_18.draw({"one": few}, "surfaces")
    figure.savefig(tmp_path / "figure.png")
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert ("no peaks" in texts) == (bins_with_peaks == 0)
