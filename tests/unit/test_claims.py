import math

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from asperity.paper.claims.continuum import continuum, extrapolate
from asperity.paper.claims.evidence import Evidence, Fixed, MissingEvidenceError
from asperity.paper.claims.overview import draw
from asperity.paper.claims.readings import (
    Reading,
    following,
    kolmogorov,
    percentile,
    ratio,
    ratio_of_poisson,
    single,
)
from asperity.paper.claims.report import (
    continuum_table,
    findings_of,
    frame,
    frame_of_readings,
    markdown,
    page,
    verdict_in_words,
    with_error,
)
from asperity.paper.claims.sources import deltas, resolutions, roles
from asperity.paper.claims.statements import CLAIMS, LARGER
from asperity.paper.claims.verdicts import (
    DEPENDS,
    FAILS,
    HOLDS,
    NO_DATA,
    UNDECIDED,
    UNTESTABLE,
    Claim,
    Judgement,
    Region,
    Threshold,
    conclude,
    decide,
    judge,
    tally,
)
from asperity.pipeline.statistics import LEVELS
from asperity.views.style import save, style


def claim(values, region=LARGER):
    found = xr.DataArray(values, dims="seed")
    return Claim("name", "5.2", "sentence", "quantity", region, lambda evidence: found)


def statistics(**variables):
    """Statistics of one surface with these variables, each a list over seeds."""
    seeds = len(next(iter(variables.values())))
    return xr.Dataset(
        {name: ("seed", values) for name, values in variables.items()},
        coords={"seed": np.arange(1, seeds + 1)},
        attrs={"poisson_contact": 0.33},
    )


def quantiles(*curves):
    """Statistics of a surface whose peaks of σ_xx have these quantiles, a curve for each Poisson's ratio."""
    return xr.Dataset(
        {"seed_peak_quantile": (("seed", "quantity", "poisson", "level"), np.array(curves)[None, None])},
        coords={"seed": [1], "quantity": ["xx"], "poisson": [0.33, 0.5][: len(curves)], "level": LEVELS},
        attrs={"poisson_contact": 0.33},
    )


EMPTY = Evidence({})


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ([1.2, 1.3, 1.25, 1.22], HOLDS),
        ([0.8, 0.7, 0.75, 0.78], FAILS),
        ([0.8, 1.3, 0.9, 1.1], UNDECIDED),
        ([1.2], UNDECIDED),
        ([1.2, float("nan")], NO_DATA),
    ],
)
def test_the_rule_asks_for_the_whole_interval_on_one_side(values, verdict):
    assert judge(claim(values), EMPTY).verdict == verdict


def test_the_interval_is_that_of_student():
    finding = judge(claim([1.0, 2.0, 3.0]), EMPTY)
    assert finding.error == pytest.approx(1 / math.sqrt(3))
    assert finding.high - finding.value == pytest.approx(4.302653 / math.sqrt(3), rel=1e-6)  # printed table
    assert finding.seeds == 3


def test_intervals_of_95_percent_hold_the_mean_in_95_percent_of_ensembles():
    draws = np.random.default_rng(0).normal(1.5, 0.2, (2000, 8))
    inside = [f.low < 1.5 < f.high for f in (judge(claim(values), EMPTY) for values in draws)]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.015)  # three standard errors of 2000 draws


def test_what_is_not_random_is_decided_by_its_numerical_uncertainty():
    def fixed(value, uncertainty):
        return Claim("n", "4.2", "s", "q", Region(0.0, 0.01), lambda evidence: Fixed(value, uncertainty))

    assert judge(fixed(0.008, 0.001), EMPTY).verdict == HOLDS
    assert judge(fixed(0.0095, 0.001), EMPTY).verdict == UNDECIDED
    assert judge(fixed(0.02, 0.001), EMPTY).verdict == FAILS
    assert judge(fixed(0.02, 0.001), EMPTY).seeds == 0


def test_every_claim_without_evidence_stays_in_the_table_and_says_what_is_missing():
    closed_form = "slab_tractions_of_poisson"
    wanting = [c for c in CLAIMS if c.identifier != closed_form]
    findings = decide(wanting, EMPTY)
    assert len(findings) == len(wanting) >= 20
    assert {f.verdict for f in findings} == {NO_DATA}
    assert all(f.own.missing.startswith("no ") for f in findings)
    text = markdown(findings, [1], 8)
    assert text.count(f"**{NO_DATA}**") == len(wanting)


def test_identifiers_are_unique_and_sections_are_the_papers():
    assert len({c.identifier for c in CLAIMS}) == len(CLAIMS)
    known = {"abstract", "4.1", "4.2", "5.2", "5.3", "5.4", "6", "supplement"}
    assert all(set(c.section.split(", ")) <= known for c in CLAIMS)


def test_comparisons_are_paired_by_seed():
    small = statistics(x=[2.0, 20.0], seed_gradient_rms_contact=[0.1, 0.2])
    large = statistics(x=[1.0, 10.0], seed_gradient_rms_contact=[0.2, 0.1])
    evidence = Evidence({"small": small, "large": large.isel(seed=[1, 0])})
    np.testing.assert_allclose(ratio(Reading("x"), "small", "large")(evidence), [2, 2])
    np.testing.assert_allclose(ratio(Reading("x", unscaled=True), "small", "large")(evidence), [1, 4])


def test_the_ends_of_the_range_of_poissons_ratio_are_found():
    data = xr.Dataset({"x": (("seed", "poisson"), [[3.0, 2.5, 2.0]])}, {"poisson": [0.0, 0.33, 0.5]})
    evidence = Evidence({"compressibility": data.assign_attrs(poisson_contact=0.33)})
    np.testing.assert_allclose(ratio_of_poisson(Reading("x"))(evidence), [1.5])


def test_a_percentile_is_read_at_the_ratio_of_the_contact():
    found = percentile("xx").of(quantiles(LEVELS, 3 * LEVELS))
    assert found.dims == ("seed",)
    assert float(found.item()) == 0.99


def test_kolmogorov_distance_of_shifted_uniform_distributions():
    evidence = Evidence({"one": quantiles(LEVELS), "other": quantiles(LEVELS + 0.2)})
    np.testing.assert_allclose(kolmogorov("xx", "one", "other")(evidence), [0.2], rtol=1e-9)
    np.testing.assert_allclose(kolmogorov("xx", "one", "one")(evidence), [0.0], atol=1e-15)


def test_roles_follow_the_parameters_not_the_names():
    surfaces = {
        "a": {"hurst": 0.8, "wavelength_short": 0.01},
        "b": {"hurst": 0.2, "wavelength_short": 0.02},
        "c": {"hurst": 0.8, "wavelength_short": 0.04, "johnson": {"gamma": -1.25}},
        "d": {"hurst": 0.8, "wavelength_short": 0.04, "johnson": {"gamma": 1.25}},
    }
    studies = {
        "hurst": ["a", "b"],
        "skewness": ["d", "a", "c"],
        "kurtosis": ["a", "b"],
        "compressibility": ["a"],
    }
    assert roles(studies, surfaces) == {
        "small_hurst": "b",
        "large_hurst": "a",
        "compressibility": "a",
        "skew_negative": "c",
        "gaussian": "a",
        "skew_positive": "d",
        "long_cutoff": "b",
        "short_cutoff": "a",
    }
    assert roles({"skewness": ["a", "c"], "hurst": ["a"]}, surfaces) == {}


def test_surfaces_that_differ_in_their_nodes_alone_are_resolutions():
    def surface(hurst, points):
        return {"label": str(points), "hurst": hurst, "wavelength_short": 1 / 16, "points": points}

    surfaces = {f"{h}_{n}": surface(h, n) for h in (0.2, 0.8) for n in (128, 256)}
    found = resolutions({**surfaces, "alone": surface(0.5, 128)})
    assert list(found) == [8, 16]
    assert found[16]["small_hurst"] == "0.2_256"
    assert found[8]["compressibility"] == "0.8_128"
    assert resolutions({"alone": surface(0.5, 128)}) == {}


@pytest.mark.parametrize("order", [0.5, 1.0, 1.7])
def test_extrapolation_finds_the_limit_of_a_power_law(order):
    nodes = np.array([8.0, 16.0, 32.0])
    values = 3 + np.array([[0.5], [1.0]]) * nodes**-order
    found = extrapolate(nodes, values)
    assert found.limit == pytest.approx(3, rel=1e-12)
    assert found.error >= abs(found.values[-1] - found.limit)


def test_extrapolation_of_a_number_that_does_not_converge_has_a_wide_error():
    found = extrapolate([8, 16, 32], np.array([[1.0, 1.1, 1.3]]))
    assert found.limit == pytest.approx(1.5)
    assert found.error == pytest.approx(0.2)
    with pytest.raises(ValueError, match="twice the one before"):
        extrapolate([8, 12], np.ones((1, 2)))


def test_the_shift_of_a_claim_is_the_limit_less_the_coarsest_value():
    def resolved(nodes, seeds=1):
        return Evidence(
            {
                "large_hurst": statistics(x=[1 + 1 / nodes] * seeds),
                "small_hurst": statistics(x=[1.0] * seeds),
            }
        )

    one = Claim("n", "5.2", "s", "q", LARGER, ratio(Reading("x"), "large_hurst", "small_hurst"))
    finer = {8.0: resolved(8.0, seeds=3), 16.0: resolved(16.0), 32.0: resolved(32.0)}
    (finding,) = decide([one], finer[8.0], finer)
    assert finding.own.shift == pytest.approx(-1 / 8)
    assert finding.own.at_nodes == pytest.approx(1 + 1 / 8)
    assert finding.own.value == pytest.approx(1)  # the limit decides: there is no scatter
    (of_nodes,) = decide([one], finer[8.0], finer, {"grid": ["nodes"]})
    assert of_nodes.own.value == pytest.approx(1 + 1 / 8)
    with pytest.raises(MissingEvidenceError):
        continuum(one.measure, {8.0: finer[8.0]})
    (row,) = continuum_table({"x": one.measure}, finer).to_numpy().tolist()
    assert row == ["x", "1.125", "1.062", "1.031", "1.000 ± 0.031"]
    assert continuum_table({"x": one.measure}, {}).empty


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.4449, 0.0123, "1.445 ± 0.012"),
        (1.4449, float("nan"), "1.44"),
        (0.001234, 0.0, "0.00123"),
        (float("nan"), 1.0, ""),
    ],
)
def test_numbers_carry_their_error_in_two_digits(value, error, text):
    assert with_error(value, error) == text


def test_tables_and_picture_hold_every_claim(tmp_path):
    ours = [claim([1.2, 1.3, 1.25]), claim([12.0, 13.0, 12.5]), claim([0.01, 0.02], Region(0.0, 0.05))]
    findings = decide([*ours, *CLAIMS[:2]], EMPTY)
    frame(findings, 8).to_csv(tmp_path / "claims.csv", index=False)
    table = pd.read_csv(tmp_path / "claims.csv")
    assert table["verdict"].tolist() == [HOLDS, HOLDS, UNDECIDED, NO_DATA, NO_DATA]
    assert sum(tally(findings).values()) == len(findings)
    assert "1.250 ± 0.029" in markdown(findings, [1, 2, 3], 8)
    assert page(findings).count("<tr") == len(findings) + 2  # and the heads of two sections
    with style():
        figure = draw(findings)
        save(figure, tmp_path / "claims.png")
    assert len(figure.axes[0].get_yticks()) == len(findings)


def test_tractions_do_not_feel_poissons_ratio_and_a_slab_feels_it_a_little():
    area = xr.Dataset({"solved_area_fraction": (("poisson", "path"), np.full((3, 2), 0.1))})
    evidence = Evidence({}, {"load_area": area})
    wanted = ("tractions_of_poisson", "slab_tractions_of_poisson")
    found = {c.identifier: judge(c, evidence) for c in CLAIMS if c.identifier in wanted}
    assert found["tractions_of_poisson"].value == 0
    assert 1e-4 < found["slab_tractions_of_poisson"].value < 1e-2  # the longest wave feels the bottom


def judged(verdict, **options):
    value = {HOLDS: 1.5, FAILS: 0.5, UNDECIDED: 1.0, NO_DATA: math.nan}[verdict]
    return Judgement(options, LARGER, verdict, value, 0.1, value - 0.2, value + 0.2, 4)


ANY = Claim("name", "5.2", "sentence", "quantity", LARGER, lambda evidence: Fixed(1.0))


@pytest.mark.parametrize(
    ("verdicts", "verdict", "choices"),
    [
        ({"confined": HOLDS, "free": HOLDS}, HOLDS, ()),
        ({"confined": FAILS, "free": FAILS}, FAILS, ()),
        ({"confined": FAILS, "free": HOLDS}, DEPENDS, ("lateral",)),
        ({"confined": HOLDS, "free": UNDECIDED}, UNDECIDED, ("lateral",)),
        ({"confined": UNDECIDED, "free": UNDECIDED}, UNDECIDED, ()),
        ({"confined": HOLDS, "free": NO_DATA}, HOLDS, ()),
        ({"confined": NO_DATA, "free": HOLDS}, NO_DATA, ()),
    ],
)
def test_a_claim_holds_only_if_every_reading_agrees(verdicts, verdict, choices):
    finding = conclude(ANY, [judged(one, lateral=lateral) for lateral, one in verdicts.items()])
    assert (finding.verdict, finding.choices) == (verdict, choices)


def test_the_readings_that_tell_two_verdicts_apart_are_the_nearest_ones():
    """Peaks alone change the verdict of the study's own uniform mode; both changes together do not matter."""
    table = {
        ("confined", "below"): FAILS,
        ("confined", "with"): HOLDS,
        ("free", "below"): UNDECIDED,
        ("free", "with"): HOLDS,
    }
    finding = conclude(ANY, [judged(v, lateral=a, peaks=b) for (a, b), v in table.items()])
    assert (finding.verdict, finding.choices) == (DEPENDS, ("peaks",))
    assert [one.verdict for one in finding.shown] == [FAILS, HOLDS]
    below, surface = "peaks below: 0.5 (0.3 to 0.7) does not hold", "peaks with: 1.5 (1.3 to 1.7) holds"
    assert verdict_in_words(finding) == f"**depends on peaks**: {below}; {surface}"


def test_two_choices_that_each_change_the_verdict_are_both_named():
    table = {("a", "x"): HOLDS, ("a", "y"): FAILS, ("b", "x"): FAILS, ("b", "y"): FAILS}
    finding = conclude(ANY, [judged(v, one=a, two=b) for (a, b), v in table.items()])
    assert (finding.verdict, finding.choices) == (DEPENDS, ("one", "two"))
    assert len(finding.shown) == 3


def test_a_threshold_is_a_choice_of_the_reading():
    same = Threshold("alike", 0.05, lambda share: Region(1 - share, 1 + share))
    one = Claim("n", "5.2", "s", "q", same, lambda evidence: xr.DataArray([1.07, 1.071, 1.072], dims="seed"))
    assert one.region == Region(0.95, 1.05)
    (finding,) = decide([one], EMPTY, readings={"alike": [0.05, 0.1]})
    assert (finding.verdict, finding.choices) == (DEPENDS, ("alike",))
    assert [j.verdict for j in finding.judgements] == [FAILS, HOLDS]
    (strict,) = decide([one], EMPTY, readings={"alike": [0.05]})
    assert strict.verdict == FAILS


def test_what_our_numbers_cannot_refute_is_not_testable_here():
    def edge(value):
        return Claim("n", "4.2", "s", "q", Region(0, 0.01), lambda evidence: Fixed(value, 0.001), "our mesh")

    assert decide([edge(0.04)], EMPTY)[0].verdict == UNTESTABLE
    assert verdict_in_words(decide([edge(0.04)], EMPTY)[0]) == "**not testable here** (our mesh)"
    assert decide([edge(0.005)], EMPTY)[0].verdict == HOLDS


def of_stress(lateral, below, surface, gradient=0.5):
    """Statistics with von Mises peaks of these sizes, below the surface and with those in it."""
    shape = (2, 1, 1, LEVELS.size)
    counted = np.empty((2, 2, 1, LEVELS.size))
    counted[:, 0], counted[:, 1] = below, surface
    return xr.Dataset(
        {
            "seed_peak_quantile": (("seed", "quantity", "poisson", "level"), np.full(shape, below)),
            "seed_counted_quantile": (("seed", "counted", "poisson", "level"), counted),
            "seed_gradient_rms_contact": ("seed", [gradient, gradient]),
        },
        coords={
            "seed": [1, 2],
            "quantity": ["von_mises"],
            "poisson": [0.33],
            "level": LEVELS,
            "counted": ["below_surface", "with_surface"],
        },
        attrs={"poisson_contact": 0.33, "uniform_mode": f"laterally {lateral}"},
    )


def test_a_reading_takes_the_peaks_the_scale_and_the_uniform_mode_of_its_options():
    confined, free = of_stress("confined", 1.0, 0.9), of_stress("free", 0.8, 0.7)
    evidence = Evidence({"large_hurst": confined}, laterals={"free": {"large_hurst": free}})
    number = single(following(percentile("von_mises"), "scaling"), "large_hurst")
    assert number.choices == ("lateral", "peaks", "tail", "scaling")

    def under(**options):
        return float(number(evidence.under(options)).mean())

    assert under() == 1.0
    assert under(lateral="confined", peaks="below_surface") == 1.0
    assert under(lateral="free") == 0.8
    assert under(peaks="with_surface") == 0.9
    assert under(lateral="free", peaks="with_surface", scaling="absolute") == 0.35
    with pytest.raises(MissingEvidenceError, match="laterally free"):
        number(Evidence({"large_hurst": confined}).under({"lateral": "free"}))


def test_findings_are_read_again_from_their_table(tmp_path):
    confined, free = of_stress("confined", 1.1, 0.9), of_stress("free", 0.8, 0.7)
    evidence = Evidence({"large_hurst": confined}, laterals={"free": {"large_hurst": free}})
    one = Claim("n", "5.2", "s", "q", LARGER, single(percentile("von_mises"), "large_hurst"))
    readings = {"lateral": ["confined", "free"], "peaks": ["below_surface", "with_surface"], "tail": [0.99]}
    found = decide([one, *CLAIMS[:2]], evidence, readings=readings)
    frame_of_readings(found).to_csv(tmp_path / "readings.csv", index=False)
    again = findings_of(pd.read_csv(tmp_path / "readings.csv"), [one, *CLAIMS[:2]])
    assert [verdict_in_words(f) for f in again] == [verdict_in_words(f) for f in found]
    assert again[0].choices == ("lateral", "peaks")
    assert again[0].verdict == DEPENDS


def test_skewed_surfaces_of_another_delta_are_found_by_their_parameters():
    def skew(gamma, delta, hurst=0.8):
        return {"label": f"{delta}", "hurst": hurst, "johnson": {"gamma": gamma, "delta": delta}}

    surfaces = {
        "n": skew(-1.25, 1.0),
        "g": {"label": "", "hurst": 0.8},
        "p": skew(1.25, 1.0),
        "n2": skew(-1.25, 2.0),
        "p2": skew(1.25, 2.0),
        "p3": skew(1.25, 3.0),
        "n3": skew(-1.25, 3.0, hurst=0.5),
    }
    own = roles({"skewness": ["n", "g", "p"]}, surfaces)
    found = deltas(own, surfaces, [1.0, 2.0, 3.0])
    assert list(found) == [1.0, 2.0]
    assert found[2.0] == {"skew_negative": "n2", "skew_positive": "p2"}
    assert deltas({}, surfaces, [2.0]) == {}
