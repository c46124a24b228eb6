"""Maps of one surface as a sample: means, intervals, and what is pooled per area."""

import json

import numpy as np
import pandas as pd
import pytest
from samples import refuses

import asperity as asp
from asperity import Body, run
from asperity.engineering.records import DISCRETISATION, POSITIONS, Bounds, Record
from asperity.engineering.sample import doubt_of_one_surface, mean_of_maps
from asperity.stress.statistics.largest import largest_on

EDGE = 64e-6
STEEL = Body(young=210e9, poisson=0.3, yield_stress=2e9)


def a_map(seed, points=64, rms=1e-7):
    height = asp.self_affine((points, points), 0.8, EDGE / 2, EDGE / 8, rms, seed, length=EDGE)
    return asp.HeightMap(height, (EDGE, EDGE), periodic=True, name=f"patch {seed}")


def pooled_with(other, load=200e6):
    return asp.pool([run(a_map(1), STEEL, mean_pressure=200e6), run(other, STEEL, mean_pressure=load)])


def mean_of(values, **more):
    return mean_of_maps([Record("gap", float(value), "m", **more) for value in values])[0]


@pytest.fixture(scope="module")
def answers():
    return [run(a_map(seed), STEEL, mean_pressure=200e6) for seed in (1, 2, 3)]


def test_answers_slide_along_the_lay_of_the_first_map():
    """As `asperity run --pooled` and the page compute them; a direction that was given is not changed."""
    y, x = np.mgrid[:32, :32] / 32
    rng = np.random.default_rng(1)
    lays = [1e-7 * np.sin(8 * np.pi * each) + 1e-8 * rng.normal(size=x.shape) for each in (y, x)]
    maps = [
        asp.HeightMap(lay, (EDGE, EDGE), periodic=True, name=n) for lay, n in zip(lays, "ab", strict=True)
    ]

    def slid(number, **direction):
        sliding = {"friction": 0.3, **direction}
        return run(maps[number], STEEL, mean_pressure=200e6, sliding=sliding)

    found = [slid(0), slid(1)]
    assert [each.case.sliding.direction for each in found] == ["x", "y"]
    sample, given = asp.pool(found), asp.pool([slid(0), slid(1, direction="x")])
    assert [each.value for each in sample.records] == [each.value for each in given.records]
    with pytest.raises(ValueError, match="one case is needed"):
        asp.pool([slid(0), slid(1, direction="y")])


def test_interval_is_students_and_holds_the_mean():
    """Quantiles of t from M. Abramowitz, I. Stegun, Table 26.10; 1500 samples leave ± 1.1 % of the share."""
    for count, quantile in ((2, 12.706), (3, 4.303), (6, 2.5706)):
        values = np.arange(count, dtype=float)
        expected = quantile * values.std(ddof=1) / np.sqrt(count)
        assert mean_of(values).error == pytest.approx(expected, rel=1e-4)
    draws = np.random.default_rng(1).normal(5.0, 0.3, (1500, 3))
    found = [mean_of(draw) for draw in draws]
    assert np.mean([abs(each.value - 5.0) <= each.error for each in found]) == pytest.approx(0.95, abs=0.015)


def test_common_errors_do_not_fall_with_the_number_of_maps():
    found = mean_of([1.0, 2.0, 3.0], errors={DISCRETISATION: 0.5})
    assert found.errors[DISCRETISATION] == 0.5
    assert found.error == pytest.approx(np.hypot(0.5, found.errors[POSITIONS]))
    assert "without" not in mean_of([1.0]).text()
    (one,) = mean_of([1.0], varies=True).error_texts()
    assert one == "between measurement positions: not known"
    some = [Record("gap", 1.0, extrapolated=0.9, errors={DISCRETISATION: 0.1}), Record("gap", 1.2)]
    mean, values = mean_of_maps(some)  # one map has no estimate: the values as they are, of both
    assert (mean.best, DISCRETISATION in mean.errors) == (pytest.approx(1.1), False)
    np.testing.assert_array_equal(values, [1.0, 1.2])


def test_mean_keeps_the_widest_bounds():
    maps = [Record("p", 1.0, "Pa", bounds=Bounds(0.0, high, "the hardness")) for high in (1.0, 1.5)]
    mean, _ = mean_of_maps([*maps, Record("p", 1.3, "Pa", bounds=maps[1].bounds)])
    assert mean.bounds == (0.0, 1.5, "the hardness")
    assert mean.interval[1] <= 1.5


def test_sample_pools_volumes_over_one_depth(answers):
    sample = asp.pool(answers)
    volumes, depths = (
        [answer[name].value for answer in answers]
        for name in ("volume above yield per area", "maximum depth above yield")
    )
    values = sample.frame().set_index("quantity").filter(like="map_")
    np.testing.assert_allclose(values.loc["volume above yield per area"], volumes)
    np.testing.assert_allclose(values.loc["volume fraction above yield"], np.divide(volumes, max(depths)))
    area = sample["contact area fraction"]
    records = [answer["contact area fraction"] for answer in answers]
    estimates, errors = (
        [each.extrapolated for each in records],
        [each.errors[DISCRETISATION] for each in records],
    )
    assert area.best == pytest.approx(np.mean(estimates))
    assert area.value == pytest.approx(np.mean([each.value for each in records]))
    assert area.errors[DISCRETISATION] == pytest.approx(np.mean(errors))
    assert area.error > area.errors[POSITIONS]
    assert np.isnan(sample["yield stress"].error)
    assert area.best_text() in str(sample)


def test_verdict_of_a_sample_comes_first(answers, tmp_path, without_pictures):
    """The number that decides with its whole interval, the maps, and what dominates the interval."""
    sample = asp.pool(answers)
    volume = sample["volume above yield per area"]
    verdict, above = sample.verdict
    assert above == "Above the yield stress on 3 of 3 maps."
    assert verdict.startswith(
        f"Volume above yield per area: {volume.best_text()} as the mean over 3 maps; most"
    )
    largest = max(volume.errors, key=volume.errors.get)
    assert largest in verdict
    assert " ".join(str(sample).split("\n\n")[1].split()) == f"{verdict} {above}"
    for name, answer in sample.answers.items():
        answer.write(tmp_path / name)
    assert {path.name for path in sample.write(tmp_path)} >= {"sample.csv", "sample.html", "sample.json"}
    page = (tmp_path / "sample.html").read_text(encoding="utf-8")
    assert page.index(verdict) < page.index('class="headline"') < page.index("<h2>All numbers</h2>")
    again = asp.open_answer(tmp_path)
    pd.testing.assert_frame_equal(again.frame(), sample.frame())
    assert list(json.loads((tmp_path / "sample.json").read_text())["maps"]) == [*sample.names]
    single = asp.pool(answers[:1])
    assert single.verdict[0].endswith("on 1 map; differences between positions are not known.")


def test_maps_of_other_heights_are_doubted():
    assert not doubt_of_one_surface({"a": 1e-7, "b": 1.29e-7, "c": 1.1e-7})
    doubt = doubt_of_one_surface({"a": 1e-7, "b": 1.31e-7, "c": 1.1e-7})
    assert doubt.startswith("Sq is 100 nm on a and 131 nm on b: ")


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


@pytest.mark.parametrize("shape", [1.2, 1.6, 2.5])
def test_largest_of_bounded_peaks_is_met(shape):
    """Peaks below a bound, as under a hardness."""
    random = np.random.default_rng(3)
    met = []
    for _ in range(40):
        maps = [5 - random.weibull(shape, random.poisson(300)) for _ in range(4)]
        found, true = largest_on(maps, 4e-6, 1.6e-4), 5 - random.weibull(shape, 48000).min()
        met.append(found.low <= true <= found.high)
    assert np.mean(met) >= 0.85


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
