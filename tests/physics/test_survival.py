"""Residual stress, distribution of the Dang Van stress, and the probability that no crack starts."""

import numpy as np
import pytest
import xarray as xr
from samples import HALF_SPACE, refuses, rough
from scipy.stats import weibull_min

import asperity as asp
from asperity.stress.cycles.criteria import Criteria, CycleMaps, hydrostatic_factor
from asperity.stress.cycles.stress_cycles import weibull_exponent

LIMITS = {"fatigue_torsion": 2e-2, "fatigue_bending": 3e-2}


@pytest.mark.parametrize("scatter", [0.01, 0.05, 0.1, 0.3, 1.0])
def test_exponent_has_the_scatter(scatter):
    limit = weibull_min(weibull_exponent(scatter))
    assert limit.std() / limit.mean() == pytest.approx(scatter, rel=1e-8)


SCATTERS = (0.01, 0.02, 0.1, 1.0)


def test_cracks_below_a_stress_falling_with_depth():
    """d = d₀ e^(−z/L): ∫ (Γ d)^m dz = (Γ d₀)^m L/m; planes err by (m h/L)²/12, down to 20 L."""
    largest, length, maps = 1.7, 3.0, CycleMaps(asp.Grid((8, 8)), Criteria(1.0, 1.5))
    for depth in 20 * length * np.linspace(0, 1, 4001) ** 2:
        maps.take(depth, np.full((5, 2), largest * np.exp(-depth / length)))
    cycles = maps.dataset()
    for scatter in SCATTERS:
        exponent = weibull_exponent(scatter)
        exact = (weibull_min(exponent).mean() * largest) ** exponent * length / exponent / 7.0
        assert asp.stress.cracks_per_area(cycles, scatter, 7.0) == pytest.approx(exact, rel=5e-4), scatter


def test_volume_and_cracks_are_those_of_all_points():
    """Of a smooth body under a moving rough one, and the same by histories of all points; sums of powers."""
    height, depths = rough((32, 32)), np.linspace(0, 0.1, 21)
    contact = asp.solve_contact(height, HALF_SPACE, mean_pressure=3e-3)
    cycles = asp.stress.stress_cycles(contact, depths, **LIMITS, tolerance=0)
    moving = asp.engineering.MovingContact(0 * height, height, HALF_SPACE, shifts=32, mean_pressure=3e-3)
    same = asp.stress.stress_cycles(moving.in_body("lower"), depths, **LIMITS, tolerance=0)
    for scatter in SCATTERS:
        exponent = weibull_exponent(scatter)
        power = np.maximum(cycles["dang_van"].values * weibull_min(exponent).mean(), 0) ** exponent
        exact = np.trapezoid(power.mean(axis=1), depths)
        for each in (cycles, same):
            assert asp.stress.cracks_per_area(each, scatter, 1.0) == pytest.approx(exact, rel=1e-4), scatter
    volume = float((cycles["dang_van"] > 0.9).mean("cycle_y").integrate("cycle_depth"))
    assert float(cycles["fatigue_volume"].interp(fatigue_share=0.9)) == pytest.approx(volume, rel=1e-2)


def test_residual_stress_moves_the_mean_stress():
    contact = asp.solve_contact(rough((32, 32)), HALF_SPACE, mean_pressure=3e-3)
    free, pressed = (
        asp.stress.stress_cycles(contact, [0.01], **LIMITS, yield_stress=0.1, residual_stress=stress)
        for stress in (0.0, -5e-3)
    )
    change = hydrostatic_factor(2e-2, 3e-2) * 2 / 3 * -5e-3 / 2e-2
    np.testing.assert_allclose(pressed["dang_van"] - free["dang_van"], change, rtol=1e-6)
    for name in ("shear_range", "shakedown_upper"):
        np.testing.assert_array_equal(pressed[name], free[name])


@pytest.fixture(scope="module")
def answers():
    edge, known = 2e-4, {"periodic": True, "unit": "m"}
    limits = {"fatigue_torsion": 3e8, "fatigue_bending": 4.8e8, "residual_stress": -1e8}
    steel = asp.Body(young=210e9, poisson=0.3, **limits)
    heights = (asp.self_affine((32, 32), 0.8, 1e-4, 5e-5, 1e-7, seed, length=edge) for seed in (1, 2, 3))
    maps = (asp.HeightMap(height, (edge, edge), **known, name="ground") for height in heights)
    cycles = {"fatigue_scatter": 0.1, "fatigue_volume": 1e-12}
    return [asp.run(each, steel, mean_pressure=30e6, cycles=cycles) for each in maps]


def test_probability_is_not_known_where_the_error_of_the_stress_is_not(answers):
    sample, area = asp.pool(answers), 1e-8
    (row,) = sample.survival(area).itertuples()
    cracks = [each["cracks expected per area"].value for each in answers]
    assert row.no_crack == pytest.approx(np.exp(-area * np.mean(cracks)), rel=1e-9)
    assert np.isnan([row.low, row.high]).all()
    assert isinstance(sample, asp.engineering.Sample)
    assert (
        answers[0]["cracks expected per area"]
        .text()
        .partition(" per mm²")[2]
        .startswith(" on these pixels, ± not known")
    )


def test_interval_of_the_cracks_is_that_of_the_stress_to_the_power():
    """Factors (1 ± e)^m of each map; on a mean with the scatter between maps, as logarithms."""
    edge, exponent = 4e-4, weibull_exponent(0.1)
    steel = asp.Body(young=210e9, poisson=0.3, fatigue_torsion=3e8, fatigue_bending=4.8e8)
    asked, found = {"fatigue_scatter": 0.1, "fatigue_volume": 1e-7, "area": 5e-4}, []
    for seed in (1, 2):
        height = asp.self_affine((128, 128), 0.8, 1e-4, 2e-5, 1e-7, seed, length=edge)
        surface = asp.HeightMap(height, (edge, edge), periodic=True, unit="m", name="ground")
        found.append(asp.run(surface, steel, mean_pressure=1e8, cycles=asked))
    for answer in found:
        stress, cracks = answer["maximum Dang Van stress over limit"], answer["cracks expected per area"]
        ends = cracks.value * (1 + stress.error / stress.value * np.array([-1, 1])) ** exponent
        np.testing.assert_allclose(cracks.interval, ends, rtol=1e-9)
        none = answer["probability of no crack on the track"]
        np.testing.assert_allclose(none.interval, np.exp(-5e-4 * ends[::-1]), rtol=1e-9)
        chances = [f"{1 - each:.2g}" for each in none.interval[::-1]]
        (told,) = (text for text in answer.verdict if "cracks can start" in text)
        assert all(each in told for each in chances), (chances, told)
        assert "with limits 10 % lower 3.6 times" in cracks.text()
    each = [answer["cracks expected per area"] for answer in found]
    values = np.array([record.value for record in each])
    scatter = 12.706204736432095 * abs(np.diff(values)[0]) / 2 / values.mean()  # Student's t, one degree
    common = np.mean([np.log(np.divide(record.interval, record.value)) for record in each], axis=0)
    ends = values.mean() * np.exp([-np.hypot(common[0], scatter), np.hypot(common[1], scatter)])
    sample = asp.pool(found)
    np.testing.assert_allclose(sample["cracks expected per area"].interval, ends, rtol=1e-9)
    (row,) = sample.survival(5e-4).itertuples()
    np.testing.assert_allclose([row.low, row.high], np.exp(-5e-4 * ends[::-1]), rtol=1e-9)


def case(**cycles):
    body = asp.Body(young=210e9, poisson=0.3)
    return asp.run("a.x3p", body, mean_pressure=1e6, cycles=cycles)


test_wrong_argument_is_refused = refuses(
    (lambda: weibull_exponent(2), "scatter = 2: a number from 0.01 to 1 is needed"),
    (
        lambda: asp.stress.cracks_per_area(xr.Dataset(), 0.1, 1.0),
        "cycles: a result of stress_cycles with fatigue",
    ),
    (lambda: case(fatigue_scatter=2, fatigue_volume=1e-9), "cycles.fatigue_scatter = 2: a number ≥ 0.01 and"),
    (lambda: case(fatigue_scatter=0.1), "3 problems:\n  cycles: both fatigue_scatter and fatigue_volume ar"),
    (
        lambda: case(fatigue_scatter=0.1, fatigue_volume=1e-9),
        "2 problems:\n  cycles.fatigue_scatter = 0.1: fatigue limits of a body are needed",
    ),
)
