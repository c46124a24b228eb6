"""What jobs need grows with the grid, the loads, the ratios and the seeds."""

import pytest

from asperity.accuracy.resources import need, table


@pytest.mark.parametrize("stage", ["surface", "contact", "stress", "statistics", "verification"])
def test_four_times_the_nodes_need_four_times_what_the_smallest_grid_adds(stage):
    small, large, none = need(stage, 2048**2), need(stage, 4096**2), need(stage)
    for one, four, zero in zip(small, large, none, strict=True):
        assert four - zero == pytest.approx(4 * (one - zero))
    assert large.memory > small.memory > none.memory > 0


@pytest.mark.parametrize("stage", ["contact", "stress", "statistics", "verification"])
def test_more_loads_ratios_or_seeds_need_more(stage):
    one, two, three = (need(stage, 10**6, times) for times in (1, 2, 3))
    assert three.seconds > two.seconds > one.seconds
    assert three.memory >= two.memory > one.memory


def test_the_paper_s_largest_jobs_are_those_on_4096_squared():
    assert need("stress", 4096**2, 4).memory == pytest.approx(3500, rel=0.1)
    assert need("verification", 4096**2).memory == pytest.approx(4700, rel=0.1)


def test_the_table_has_a_row_for_each_grid():
    rows = table([512, 4096]).splitlines()[2:]
    assert [row.split(" | ")[0] for row in rows] == ["| 512²", "| 4096²"]
    assert f"{need('contact', 4096**2).memory / 1000:.1f} GB" in rows[1]
