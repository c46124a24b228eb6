"""Verdicts on the statements of the paper: the rule, interpretations, their numbers, and a tiny study."""

import math

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.stats import ks_2samp
from small_study import CONTACT, LAYER, STRESS

from asperity.paper.claims.continuum import extrapolate
from asperity.paper.claims.numbers import Evidence, Fixed, MissingEvidenceError, Number
from asperity.paper.claims.overview import draw
from asperity.paper.claims.paper import CLAIMS, REGIONS, Claim
from asperity.paper.claims.report import (
    continuum_table,
    findings_of,
    frame,
    frame_of_interpretations,
    markdown,
    verdict_in_words,
)
from asperity.paper.claims.sources import deltas, resolutions, roles
from asperity.paper.claims.verdicts import (
    DEPENDS,
    FAILS,
    HOLDS,
    NO_DATA,
    UNDECIDED,
    UNTESTABLE,
    Judgement,
    conclude,
    decide,
    judge,
)
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.statistics import LEVELS, SeedResults, statistics_of_seeds
from asperity.study.stages.stress import QUANTITIES, compute_stresses
from asperity.study.stages.surface import make_surface

EMPTY = Evidence({})


def claim(values, region="larger"):
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
def test_the_whole_interval_decides(values, verdict):
    assert judge(claim(values), EMPTY).verdict == verdict


def test_the_interval_is_that_of_student():
    finding = judge(claim([1.0, 2.0, 3.0]), EMPTY)
    assert finding.standard_error == pytest.approx(1 / math.sqrt(3))
    assert finding.interval_high - finding.value == pytest.approx(
        4.302653 / math.sqrt(3), rel=1e-6
    )  # printed table
    assert finding.seeds == 3


@pytest.mark.parametrize(("value", "verdict"), [(0.008, HOLDS), (0.0095, UNDECIDED), (0.02, FAILS)])
def test_a_fixed_number_is_decided_by_its_uncertainty(value, verdict):
    one = Claim("n", "4.2", "s", "q", "one percent", lambda evidence: Fixed(value, 0.001))
    assert judge(one, EMPTY).verdict == verdict
    assert judge(one, EMPTY).seeds == 0


def test_claims_without_evidence_stay_in_the_table():
    wanting = [c for c in CLAIMS if c.identifier != "slab_tractions_of_poisson"]  # a closed form
    findings = decide(wanting, EMPTY)
    assert {f.verdict for f in findings} == {NO_DATA}
    assert all(f.own.missing.startswith("no ") for f in findings)
    assert markdown(findings, [1], 8).count(f"**{NO_DATA}**") == len(wanting) == 50


def test_comparisons_are_paired_by_seed():
    small = statistics(x=[2.0, 20.0], seed_gradient_rms_contact=[0.1, 0.2])
    large = statistics(x=[1.0, 10.0], seed_gradient_rms_contact=[0.2, 0.1])
    evidence = Evidence({"small": small, "large": large.isel(seed=[1, 0])})
    np.testing.assert_allclose(Number("x", ("small", "large"))(evidence), [2, 2])
    np.testing.assert_allclose(Number("x", ("small", "large"), unscaled=True)(evidence), [1, 4])


def test_ratios_of_the_extreme_poisson_ratios():
    data = xr.Dataset({"x": (("seed", "poisson"), [[3.0, 2.5, 2.0]])}, {"poisson": [0.0, 0.33, 0.5]})
    evidence = Evidence({"compressibility": data.assign_attrs(poisson_contact=0.33)})
    ends = Number("x", ("compressibility",), poisson=("smallest", "largest"))
    np.testing.assert_allclose(ends(evidence), [1.5])


def test_a_percentile_is_taken_at_the_contacts_ratio():
    number = Number("seed_peak_quantile", ("one",), ("xx",), level=0.99)
    assert number(Evidence({"one": quantiles(LEVELS, 3 * LEVELS)})).item() == 0.99


def test_kolmogorov_distance_from_quantiles_is_hardly_low():
    """Bounds of docs/claims.md, against the distance of all peaks; exact for uniform distributions."""
    distance = Number("seed_peak_quantile", ("one", "other"), ("xx",))
    shifted = Evidence({"one": quantiles(LEVELS), "other": quantiles(LEVELS + 0.2)})
    np.testing.assert_allclose(distance(shifted), [0.2], rtol=1e-9)
    draw = np.random.default_rng(0)
    for count, bound in ((2000, 0.006), (10_000, 0.0025)):
        peaks = [draw.rayleigh(scale, count) for scale in (1.0, 1.04)]
        one, other = (quantiles(np.quantile(values, LEVELS)) for values in peaks)
        low = ks_2samp(*peaks).statistic - distance(Evidence({"one": one, "other": other})).item()
        assert -2 / count < low < bound


def test_roles_follow_the_parameters():
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


def test_surfaces_on_several_grids_are_resolutions():
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


def test_a_diverging_number_has_a_wide_error():
    found = extrapolate([8, 16, 32], np.array([[1.0, 1.1, 1.3]]))
    assert found.limit == pytest.approx(1.5)
    assert found.error == pytest.approx(0.2)
    with pytest.raises(ValueError, match="twice the one before"):
        extrapolate([8, 12], np.ones((1, 2)))


def test_the_shift_is_the_limit_less_the_coarsest_value():
    def resolved(nodes, seeds=1):
        large, small = statistics(x=[1 + 1 / nodes] * seeds), statistics(x=[1.0] * seeds)
        return Evidence({"large_hurst": large, "small_hurst": small})

    number = Number("x", ("large_hurst", "small_hurst"))
    one = Claim("n", "5.2", "s", "q", "larger", number)
    finer = {8.0: resolved(8.0, seeds=3), 16.0: resolved(16.0), 32.0: resolved(32.0)}
    (finding,) = decide([one], finer[8.0], finer)
    assert finding.own.continuum_shift == pytest.approx(-1 / 8)
    assert finding.own.value_at_nodes == pytest.approx(1 + 1 / 8)
    assert finding.own.value == pytest.approx(1)  # the limit decides: there is no scatter
    (row,) = continuum_table({"x": number}, finer).to_numpy().tolist()
    assert row == ["x", "1.125", "1.062", "1.031", "1.000 ± 0.031"]


def test_tractions_and_poissons_ratio():
    """On a half-space they do not feel it; on a slab the longest wave feels the bottom."""
    area = xr.Dataset({"solved_area_fraction": (("poisson", "path"), np.full((3, 2), 0.1))})
    evidence = Evidence({}, {"load_area": area})
    wanted = ("tractions_of_poisson", "slab_tractions_of_poisson")
    found = {c.identifier: judge(c, evidence) for c in CLAIMS if c.identifier in wanted}
    assert found["tractions_of_poisson"].value == 0
    assert 1e-4 < found["slab_tractions_of_poisson"].value < 1e-2


def judged(verdict, **options):
    value = {HOLDS: 1.5, FAILS: 0.5, UNDECIDED: 1.0, NO_DATA: math.nan}[verdict]
    return Judgement(options, *REGIONS["larger"], value, 0.1, value - 0.2, value + 0.2, 4, verdict)


ANY = Claim("name", "5.2", "sentence", "quantity", "larger", lambda evidence: Fixed(1.0))


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
def test_a_claim_holds_only_if_all_interpretations_agree(verdicts, verdict, choices):
    finding = conclude(ANY, [judged(one, lateral=lateral) for lateral, one in verdicts.items()])
    assert (finding.verdict, finding.choices) == (verdict, choices)


def test_the_nearest_interpretations_tell_verdicts_apart():
    """Peaks alone change the verdict of the study's own mean mode; both changes together do not matter."""
    table = {
        ("confined", "below"): FAILS,
        ("confined", "with"): HOLDS,
        ("free", "below"): UNDECIDED,
        ("free", "with"): HOLDS,
    }
    finding = conclude(ANY, [judged(v, lateral=a, peaks=b) for (a, b), v in table.items()])
    assert (finding.verdict, finding.choices) == (DEPENDS, ("peaks",))
    assert [one.verdict for one in finding.shown] == [FAILS, HOLDS]
    assert frame([finding], 8.0)["verdict"].item() == DEPENDS
    below, surface = "peaks below: 0.5 (0.3 to 0.7) does not hold", "peaks with: 1.5 (1.3 to 1.7) holds"
    assert verdict_in_words(finding) == f"**depends on peaks**: {below}; {surface}"


def test_both_of_two_deciding_choices_are_named():
    table = {("a", "x"): HOLDS, ("a", "y"): FAILS, ("b", "x"): FAILS, ("b", "y"): FAILS}
    finding = conclude(ANY, [judged(v, one=a, two=b) for (a, b), v in table.items()])
    assert (finding.verdict, finding.choices) == (DEPENDS, ("one", "two"))
    assert len(finding.shown) == 3


def test_the_size_of_the_same_is_a_choice():
    one = claim([1.07, 1.071, 1.072], "alike")
    (finding,) = decide([one], EMPTY, interpretations={"alike": [0.05, 0.1]})
    assert (finding.verdict, finding.choices) == (DEPENDS, ("alike",))
    assert [j.verdict for j in finding.judgements] == [FAILS, HOLDS]
    (strict,) = decide([one], EMPTY)
    assert strict.verdict == FAILS


def test_untestable_claims_can_hold_but_not_fail():
    def edge(value):
        number = Fixed(value, 0.001)
        return Claim("n", "4.2", "s", "q", "one percent", lambda evidence: number, "our mesh")

    refuted, held = decide([edge(0.04), edge(0.005)], EMPTY)
    assert (refuted.verdict, held.verdict) == (UNTESTABLE, HOLDS)
    assert verdict_in_words(refuted) == "**not testable here** (our mesh)"
    # the same verdict in both tables
    assert frame([refuted], 8.0)["interpretations"].item().endswith("not testable here")
    assert frame_of_interpretations([refuted])["verdict"].item() == UNTESTABLE


SEEDS = (1, 2)
INTERPRETATIONS = {
    "lateral": ["confined", "free"],
    "patches": ["every_peak", "highest_of_patch"],
    "shear": ["xz", "xy"],
    "alike": [0.05, 0.1],
}


def made_statistics(hurst, layer=LAYER, others=("free",)):
    """Condition of the mean mode → statistics of a surface over its seeds."""
    found = {}
    band = {"wavelength_long": 0.25, "wavelength_short": 0.0625, "rms_height": 1e-3, "points": 64}
    for seed in SEEDS:
        surface = make_surface({"hurst": hurst, **band}, seed)
        contact = solve_contact(surface, layer, CONTACT | {"path_area_fractions": []})
        stresses = compute_stresses(contact, layer, STRESS, others, [*QUANTITIES, "xy"])
        for lateral, stress in stresses.items():
            found.setdefault(lateral, []).append(SeedResults(seed, surface, contact, stress))
    return {lateral: statistics_of_seeds(results) for lateral, results in found.items()}


def by_role(small, large):
    return {"small_hurst": small, "large_hurst": large, "compressibility": large}


@pytest.fixture(scope="module")
def study():
    """The findings about H and ν of a tiny study, by their identifiers."""
    small, large = made_statistics(0.2), made_statistics(0.8)
    free = by_role(small["free"], large["free"])
    evidence = Evidence(by_role(small["confined"], large["confined"]), laterals={"free": free})
    return {f.claim.identifier: f for f in decide(CLAIMS, evidence, interpretations=INTERPRETATIONS)}


def test_an_interpretation_is_a_study_with_its_mean_mode(study):
    """The free cell as the study's own, solved and analysed on its own, gives the same numbers."""
    free = LAYER | {"lateral": "free"}
    small, large = (made_statistics(hurst, free, ())["free"] for hurst in (0.2, 0.8))
    compared = 0
    for finding in decide(CLAIMS, Evidence(by_role(small, large))):
        twin = study[finding.claim.identifier]
        if finding.verdict != NO_DATA and "lateral" in finding.claim.choices:
            wanted = twin.own.interpretation | {"lateral": "free"}
            (other,) = (one for one in twin.judgements if one.interpretation == wanted)
            assert other.value == finding.own.value
            assert other.value != twin.own.value
            compared += 1
    assert compared > 10
    with pytest.raises(MissingEvidenceError, match="laterally confined"):
        Evidence(by_role(small, large)).under({"lateral": "confined"}).statistics("small_hurst")


def test_only_shear_in_the_plane_depends_on_poisson(study):
    value = {one.interpretation["shear"]: one.value for one in study["shear_of_poisson"].judgements}
    assert value["xz"] == 0
    assert value["xy"] > 0.2


def test_stresses_over_the_modulus_are_over_the_gradient_times_it(study):
    number = study["cutoff_larger"].claim.measure
    data = quantiles(LEVELS).assign(seed_gradient_rms_contact=("seed", [0.5]))
    data = data.assign_coords(quantity=["von_mises"])
    over = data.assign(seed_gradient_rms_contact=("seed", [0.1]))
    evidence = Evidence({"short_cutoff": data, "long_cutoff": over})
    assert number(evidence).item() == 1
    assert number(evidence.under({"scaling": "absolute"})).item() == pytest.approx(5)


def test_findings_are_read_again_from_their_table(study, tmp_path):
    found = list(study.values())
    frame_of_interpretations(found).to_csv(tmp_path / "interpretations.csv", index=False)
    again = findings_of(pd.read_csv(tmp_path / "interpretations.csv"), CLAIMS)
    assert [verdict_in_words(f) for f in again] == [verdict_in_words(f) for f in found]


def test_tables_and_picture_hold_every_claim(study):
    found = list(study.values())
    text = markdown(found, SEEDS, 4)
    assert all(f.claim.measured.replace("|", "\\|") in text for f in found)
    assert len(draw(found).axes[0].get_yticks()) == len(CLAIMS)


def test_surfaces_of_another_delta_are_found():
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
    assert found[2.0] == {"skew_negative, delta 2": "n2", "skew_positive, delta 2": "p2"}
    assert deltas({}, surfaces, [2.0]) == {}
