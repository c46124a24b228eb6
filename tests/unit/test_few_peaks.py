"""Figures of contacts so small that nothing, or only one value, can be counted under them."""

import pytest

from asperity.paper.figures import fig10_14_18
from asperity.results import dataset


@pytest.mark.parametrize("bins_with_peaks", [0, 1])
def test_joint_densities_are_drawn_without_peaks(chain, tmp_path, bins_with_peaks):
    statistics = dataset.read(chain["statistics"])
    few = statistics.assign(joint_counts=statistics["joint_counts"] * 0)
    few["joint_counts"][..., 3, 3] = bins_with_peaks
    figure = fig10_14_18.draw({"one": few}, "surfaces")
    figure.savefig(tmp_path / "figure.png")
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert ("no peaks" in texts) == (bins_with_peaks == 0)
