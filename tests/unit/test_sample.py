"""Maps of one surface as a sample: means, intervals, and what is pooled per area."""

import numpy as np
import pandas as pd
import pytest
from samples import refuses

import asperity as asp
from asperity import Body, run
from asperity.engineering.records import DISCRETISATION, POSITIONS, Record
from asperity.engineering.sample import mean_of_maps
from asperity.stress.statistics.largest import largest_on

EDGE = 64e-6
STEEL = Body(young=210e9, poisson=0.3, yield_stress=2e9)


def a_map(seed, points=64, rms=1e-7):
    height = asp.self_affine((points, points), 0.8, EDGE / 2, EDGE / 8, rms, seed, length=EDGE)
    return asp.HeightMap(height, (EDGE, EDGE), periodic=True, name=f"patch {seed}")


def pooled_with(other, load=200e6):
    return asp.pool(
        [run(a_map(1), STEEL, mean_pressure=200e6), run(other, STEEL, mean_pressure=load)]
    )


@pytest.fixture(scope="module")
def answers():
    return [run(a_map(seed), STEEL, mean_pressure=200e6) for seed in (1, 2, 3)]


def mean_of(values):
    """Mean of a number of one map each."""
    return mean_of_maps([Record("gap", value, "m") for value in values])[0]


def test_interval_is_students_and_holds_the_mean():
    """Quantiles of t from M. Abramowitz, I. Stegun, Table 26.10; 1500 samples leave ± 1.1 % of the share."""
    for count, quantile in ((2, 12.706), (3, 4.303), (6, 2.5706)):
        values = np.arange(count, dtype=float)
        expected = quantile * values.std(ddof=1) / np.sqrt(count)
        assert mean_of(values).errors == {POSITIONS: pytest.approx(expected, rel=1e-4)}
    draws = np.random.default_rng(1).normal(5.0, 0.3, (1500, 3))
    found = [mean_of(draw) for draw in draws]
    assert np.mean([abs(each.value - 5.0) <= each.error for each in found]) == pytest.approx(0.95, abs=0.015)


def test_sample_pools_volumes_over_one_depth(answers):
    sample = asp.pool(answers)
    volumes, depths = (
        [answer[quantity].value for answer in answers]
        for quantity in ("volume above yield", "maximum depth above yield")
    )
    values = sample.frame().set_index("quantity").filter(like="map_")
    np.testing.assert_allclose(values.loc["volume above yield per area"], np.divide(volumes, EDGE**2))
    above = np.divide(volumes, EDGE**2 * max(depths))
    np.testing.assert_allclose(values.loc["volume fraction above yield"], above)
    area, records = sample["contact area fraction"], [answer["contact area fraction"] for answer in answers]
    assert area.best == np.mean([each.extrapolated for each in records])
    assert area.errors[DISCRETISATION] == np.mean([each.errors[DISCRETISATION] for each in records])
    assert area.errors[POSITIONS] == mean_of([each.extrapolated for each in records]).error
    assert area.error > area.errors[POSITIONS]
    assert not sample["yield stress"].errors
    assert f"{100 * area.best:.1f}" in str(sample)


@pytest.mark.parametrize("draw", ["exponential", "uniform", "rayleigh"])
def test_largest_of_an_area_is_met(draw):
    """Of 100 times the area of 4 maps; the median of the largest of n draws is F⁻¹(2^(−1/n))."""
    random = np.random.default_rng(2)
    sample, found = getattr(random, draw), []
    for _ in range(20):
        maps = [sample(size=random.poisson(60)) for _ in range(4)]
        found.append((largest_on(maps, 4e-6, 4e-4), sample(size=24000).max()))
    assert sum(each.low <= true <= each.high for each, true in found) >= 17
    medians = {"exponential": np.log(24000 / np.log(2)), "uniform": 1.0}
    medians["rayleigh"] = np.sqrt(2 * medians["exponential"])
    assert np.median([each.value for each, _ in found]) == pytest.approx(medians[draw], rel=0.2)


def test_largest_is_not_below_the_observed():
    """Also where one peak lies far above the others."""
    maps = [np.append(np.random.default_rng(seed).random(30), 1.0 + 2.0 * (seed == 0)) for seed in range(4)]
    found = largest_on(maps, 4e-6, 4e-6)
    assert found.high >= found.value >= 3.0


def test_identical_bodies_are_one_row():
    """Under friction, whose direction is opposite in the other body."""
    maps = [a_map(seed, 96) for seed in (1, 2)]
    answers = [run(each, STEEL, STEEL, mean_pressure=2e9, sliding={"friction": 0.2}) for each in maps]
    sample, peaks = asp.pool(answers), pd.concat([answer.tables["peaks"] for answer in answers])
    found = sample.maximum(2 * EDGE**2).set_index("quantity")
    assert list(found.index) == ["pressure", "von_mises"]
    observed = peaks.groupby("quantity")["value_Pa"].max()
    assert (found["value_Pa"] >= observed[found.index]).all()


def test_few_peaks_have_no_percentile(answers):
    """The 99th percentile of fewer than 100 peaks is the largest one, or between the two largest."""
    for answer in answers:
        stress = answer.stress["lower"]
        count = asp.stress.select_peaks(stress, "von_mises", selection="under_contact").sizes["peak"]
        names = {each.quantity for each in answer.records}
        assert 2 <= count < 100
        for percent, least in ((50, 2), (90, 10), (99, 100)):
            assert (f"{percent}th percentile of the peaks" in names) == (count >= least)


test_what_is_no_sample_is_refused = refuses(
    (lambda: asp.pool([]), "answers: at least one"),
    (lambda: pooled_with(a_map(2, 32)), "pooled: patch 2 has pixels of 2 µm x 2 µm, patch 1 of 1 µm"),
    (lambda: pooled_with(a_map(2, rms=2e-5)), "pooled: patch 2 has Sq = 20 µm"),
    (lambda: largest_on([np.ones(30)], 1e-6, 1e-5), "area: 40 peaks are needed, the maps have 30"),
    (lambda: largest_on([np.ones(90)], 1e-6, 2e-4), "area = 200 mm²: an area > 0 and ≤ 100 mm² is needed"),
    (lambda: pooled_with(a_map(2), load=220e6), "answers: patch 2 is of E = 210 GPa.*220 MPa"),
)


def test_peaks_are_counted_per_area(answers):
    """Against counts of the peaks of each map; those above yield lie between the levels beside it."""
    sample = asp.pool(answers)
    found = sample.peaks_per_area().query("quantity == 'von_mises'")
    for answer, name in zip(answers, sample.names, strict=True):
        sizes = answer.tables["peaks"].query("quantity == 'von_mises'")["value_Pa"].to_numpy()
        expected = [(sizes > level).sum() / (1e6 * EDGE**2) for level in found["stress_Pa"]]
        np.testing.assert_allclose(found[f"map_{name}"], expected)
    above = sample["peaks above yield"]
    row = int((found["stress_Pa"] <= 2e9).sum()) - 1
    per_mm2 = found["per_mm2"].to_numpy()
    assert per_mm2[row] * (1 + 1e-9) >= 1e-6 * above.value >= per_mm2[row + 1] * (1 - 1e-9)
