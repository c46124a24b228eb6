"""Verdicts on the statements of the paper: the rule, interpretations, their numbers, and a tiny study."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.stats import ks_2samp, t
from small_study import CONTACT, LAYER, STRESS

from asperity.paper.claims import report
from asperity.paper.claims.numbers import Evidence, FixedNumber, MissingEvidenceError, Number, SeedNumbers
from asperity.paper.claims.sources import roles, surfaces_by_delta
from asperity.paper.claims.verdicts import (
    CLAIMS,
    DEPENDS,
    FAILS,
    HOLDS,
    NO_DATA,
    REGIONS,
    UNDECIDED,
    UNTESTABLE,
    Claim,
    Judgement,
    conclude,
    decide,
    judge,
)
from asperity.stress.analysis import SOUGHT
from asperity.study.stages.contact import press_surface
from asperity.study.stages.statistics import QUANTILES, seed_statistics
from asperity.study.stages.stress import stress_of_seed
from asperity.study.stages.surface import make_surface

EMPTY = Evidence({})
ATTRIBUTES = {"poisson_contact": 0.33, "uniform_mode": "laterally confined"}


def claim(values, region="larger", grid_error=0.0):
    found = xr.DataArray(values, dims="seed")
    numbers = SeedNumbers(found, xr.full_like(found, grid_error), found)
    return Claim("name", "5.2", "sentence", "quantity", region, lambda evidence: numbers)


def fixed(value, *untestable):
    return Claim("n", "4.2", "s", "q", "one percent", lambda evidence: FixedNumber(value, 0.001), *untestable)


def statistics(**variables):
    """Statistics of one surface with these variables, each a list over seeds."""
    seeds = len(next(iter(variables.values())))
    return xr.Dataset(
        {name: ("seed", values) for name, values in variables.items()},
        coords={"seed": np.arange(1, seeds + 1)},
        attrs=ATTRIBUTES,
    )


def quantiles(*curves):
    """Statistics of a surface whose peaks of σ_xx have these quantiles, a curve for each Poisson's ratio."""
    return xr.Dataset(
        {"seed_peak_quantile": (("seed", "quantity", "poisson", "level"), np.array(curves)[None, None])},
        coords={"seed": [1], "quantity": ["xx"], "poisson": [0.33, 0.5][: len(curves)], "level": QUANTILES},
        attrs=ATTRIBUTES,
    )


@pytest.mark.parametrize(
    ("measured", "seeds", "verdict"),
    [
        (claim([1.2, 1.3, 1.25, 1.22]), 4, HOLDS),
        (claim([0.8, 0.7, 0.75, 0.78]), 4, FAILS),
        (claim([0.8, 1.3, 0.9, 1.1]), 4, UNDECIDED),
        (claim([1.2]), 1, UNDECIDED),
        (claim([1.2, math.nan]), 0, NO_DATA),
        (claim([0.01, 0.011, 0.01], "overlapping", grid_error=0.03), 3, HOLDS),  # no distance is below zero
        (fixed(0.008), 0, HOLDS),
        (fixed(0.0095), 0, UNDECIDED),
        (fixed(0.02), 0, FAILS),
    ],
)
def test_the_whole_interval_decides(measured, seeds, verdict):
    """Of the scatter of seeds, or of the uncertainty of a fixed number."""
    found = judge(measured, EMPTY)
    assert (found.seeds, found.verdict) == (seeds, verdict)


def test_interval_is_students_with_the_grid_error():
    narrow, wide = (judge(claim([1.0, 2.0, 3.0], grid_error=error), EMPTY) for error in (0.0, 1.0))
    assert narrow.standard_error == pytest.approx(1 / math.sqrt(3))
    half = 4.302653 / math.sqrt(3)  # printed table
    assert narrow.interval_high - narrow.value == pytest.approx(half, rel=1e-6)
    assert wide.interval_high - wide.value == pytest.approx(math.hypot(half, 1.0), rel=1e-6)
    assert wide.grid_error == 1.0


def test_comparisons_are_paired_by_seed():
    small = statistics(seed_x=[2.0, 20.0], seed_gradient_rms_contact=[0.1, 0.2])
    large = statistics(seed_x=[1.0, 10.0], seed_gradient_rms_contact=[0.2, 0.1])
    evidence = Evidence({"small": small, "large": large.isel(seed=[1, 0])})
    np.testing.assert_allclose(Number("x", ("small", "large"))(evidence).values, [2, 2])
    np.testing.assert_allclose(Number("x", ("small", "large"), unscaled=True)(evidence).values, [1, 4])


@pytest.mark.parametrize(("of", "expected"), [(("a", "b"), 2 * np.hypot(0.02, 0.01)), (("a",), 0.03)])
def test_estimates_decide_with_their_errors(of, expected):
    """The errors of two terms are independent."""

    def corrected(value, error):
        of_kind = (("kind", "seed"), [[value], [error]])
        data = statistics(seed_x=[9.0]).assign(continuum_x=of_kind)
        return data.assign_coords(kind=["estimate", "error"])

    evidence = Evidence({"a": corrected(1.5, 0.02), "b": corrected(0.75, 0.01)})
    found = Number("x", of)(evidence)
    assert found.on_grid.item() == (1.0 if len(of) > 1 else 9.0)
    assert found.values.item() == (2.0 if len(of) > 1 else 1.5)
    assert found.grid_errors.item() == pytest.approx(expected, rel=0.02)  # to first order


def test_kolmogorov_distance_from_quantiles_is_hardly_low():
    """Bounds of a distance, against the distance of all peaks; exact for uniform distributions."""
    distance = Number("peak_quantile", ("one", "other"), ("xx",))
    shifted = Evidence({"one": quantiles(QUANTILES), "other": quantiles(QUANTILES + 0.2)})
    np.testing.assert_allclose(distance(shifted).values, [0.2], rtol=1e-9)
    draw = np.random.default_rng(0)
    for count, bound in ((2000, 0.006), (10_000, 0.0025)):
        peaks = [draw.rayleigh(scale, count) for scale in (1.0, 1.04)]
        one, other = (quantiles(np.quantile(values, QUANTILES)) for values in peaks)
        low = ks_2samp(*peaks).statistic - distance(Evidence({"one": one, "other": other})).values.item()
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


def test_tractions_and_poissons_ratio():
    """On a half-space they do not feel it; on a slab the longest wave feels the bottom."""
    area = xr.Dataset({"solved_contact_area_fraction": (("poisson", "path"), np.full((3, 2), 0.1))})
    evidence = Evidence({}, {"load_area": area})
    wanted = ("tractions_of_poisson", "slab_tractions_of_poisson")
    found = {c.identifier: judge(c, evidence) for c in CLAIMS if c.identifier in wanted}
    assert found["tractions_of_poisson"].value == 0
    assert 1e-4 < found["slab_tractions_of_poisson"].value < 1e-2


def judged(verdict, **options):
    value = {HOLDS: 1.5, FAILS: 0.5, UNDECIDED: 1.0, NO_DATA: math.nan}[verdict]
    return Judgement(
        options, *REGIONS["larger"], value, value, 0.1, 0.0, value - 0.2, value + 0.2, 4, verdict
    )


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
    finding = conclude(claim([1.0]), [judged(one, lateral=lateral) for lateral, one in verdicts.items()])
    assert (finding.verdict, finding.choices) == (verdict, choices)


def test_the_nearest_interpretations_tell_verdicts_apart():
    """Peaks alone change the verdict of the study's own mean mode; both changes together do not matter."""
    table = {
        ("confined", "below"): FAILS,
        ("confined", "with"): HOLDS,
        ("free", "below"): UNDECIDED,
        ("free", "with"): HOLDS,
    }
    finding = conclude(claim([1.0]), [judged(v, lateral=a, peaks=b) for (a, b), v in table.items()])
    assert (finding.verdict, finding.choices) == (DEPENDS, ("peaks",))
    assert [one.verdict for one in finding.shown] == [FAILS, HOLDS]
    assert report.frame([finding])["verdict"].item() == DEPENDS
    words = report.found_in_words(finding)
    assert words == "below: 0.5 (0.3 to 0.7) does not hold; with: 1.5 (1.3 to 1.7) holds"


def test_the_size_of_the_same_is_a_choice():
    one = claim([1.07, 1.071, 1.072], "alike")
    (finding,) = decide([one], EMPTY, interpretations={"alike": [0.05, 0.1]})
    assert (finding.verdict, finding.choices) == (DEPENDS, ("alike",))
    assert [j.verdict for j in finding.judgements] == [FAILS, HOLDS]
    (strict,) = decide([one], EMPTY)
    assert strict.verdict == FAILS


def test_untestable_claims_can_hold_but_not_fail():
    refuted, held = decide([fixed(0.04, "our mesh"), fixed(0.005, "our mesh")], EMPTY)
    assert (refuted.verdict, held.verdict) == (UNTESTABLE, HOLDS)
    assert report.found_in_words(refuted) == "0.04 (0.039 to 0.041); our mesh"
    # the same verdict in both tables
    assert report.frame([refuted])["verdict"].item() == UNTESTABLE
    assert report.frame_of_interpretations([refuted])["verdict"].item() == UNTESTABLE


def on_nodes(grid_error, standard_error=0.1, seeds=16):
    half = np.hypot(t.ppf(0.975, seeds - 1) * standard_error, grid_error)
    ends = 1.08 - half, 1.08 + half
    return Judgement({}, 1.0, math.inf, 1.08, 1.08, standard_error, grid_error, *ends, seeds, UNDECIDED)


@pytest.mark.parametrize(
    ("errors", "needed", "left"),
    [
        ({8: 0.0}, 8, 0.0),
        ({8: 0.1}, 16, 0.05),  # in proportion to the spacing
        ({8: 0.4, 16: 0.1}, 32, 0.025),  # to its square, as from 8 to 16 nodes
        ({8: 0.1, 16: 0.05}, 16, 0.05),
    ],
)
def test_open_statements_name_the_nodes_and_seeds_that_decide(errors, needed, left):
    """0.08 from the edge, scatter of 0.4: the interval on so many nodes, of so many seeds, ends before it."""
    reason = report.why_open({nodes: on_nodes(error) for nodes, error in errors.items()})
    found, seeds = (int(word) for word in reason.split() if word.isdigit())
    assert found == needed
    interval = [np.hypot(t.ppf(0.975, n - 1) * 0.4 / math.sqrt(n), left) for n in (seeds, 0.4 * seeds)]
    assert interval[0] < 0.08 < interval[1]


def test_undecided_statements_stand_beside_larger_studies():
    """More nodes decide what more seeds do not, by the narrower interval."""
    undecided, decided = claim([0.8, 1.3]), claim([1.2, 1.3, 1.25, 1.22])
    few = decide([undecided, decided], EMPTY)
    wide = replace(judged(UNDECIDED), interval_high=1.3)
    larger = {8: [conclude(undecided, [wide])], 16: [conclude(undecided, [judged(HOLDS)])]}
    table = report.beside(few, larger)
    assert table["verdict"].tolist() == [HOLDS]
    assert "nodes" in report.beside(few, {8: larger[8]})["verdict"].item()


INTERPRETATIONS = {
    "lateral": ["confined", "free"],
    "patches": ["every_peak", "highest_of_patch"],
    "shear": ["xz", "xy"],
    "alike": [0.05, 0.1],
}


def made_statistics(hurst, layer=LAYER, others=("free",)):
    """Numbers of one seed of a surface, under several conditions of the mean mode."""
    band = {"wavelength_long": 0.25, "wavelength_short": 0.0625, "rms_height": 1e-3, "points": 64}
    surface = make_surface({"hurst": hurst, **band}, 1)
    contact = press_surface(surface, layer, CONTACT | {"path_contact_area_fractions": []})
    stress = stress_of_seed(contact, layer, STRESS, others, [*SOUGHT, "xy"])
    return seed_statistics(surface, contact, stress).expand_dims(seed=[1]).assign_attrs(stress.attrs)


def by_role(small, large):
    return {"small_hurst": small, "large_hurst": large, "compressibility": large}


@pytest.fixture(scope="module")
def study():
    """The findings about H and ν of a tiny study, by their identifiers."""
    evidence = Evidence(by_role(made_statistics(0.2), made_statistics(0.8)))
    return {f.claim.identifier: f for f in decide(CLAIMS, evidence, interpretations=INTERPRETATIONS)}


def test_interpretation_is_a_study_with_its_mode(study):
    """The free cell as the study's own, solved and analysed on its own, gives the same numbers."""
    free = LAYER | {"lateral": "free"}
    small, large = (made_statistics(hurst, free, ()) for hurst in (0.2, 0.8))
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


def test_tables_are_read_again_and_hold_every_claim(study, tmp_path):
    found = list(study.values())
    report.frame_of_interpretations(found).to_csv(tmp_path / "interpretations.csv", index=False)
    text = report.markdown(found)
    assert report.markdown(report.findings_of(pd.read_csv(tmp_path / "interpretations.csv"), CLAIMS)) == text
    assert all(f.claim.compared.replace("|", "\\|") in text for f in found)
    assert len(report.picture(found).axes[0].get_yticks()) == len(CLAIMS)


def test_surfaces_of_another_delta_are_found():
    def skew(gamma, delta, hurst=0.8):
        return {"label": f"{delta}", "hurst": hurst, "johnson": {"gamma": gamma, "delta": delta}}

    surfaces = {
        "n": skew(-1.25, 1.0),
        "g": {"label": "", "hurst": 0.8},
        "p": skew(1.25, 1.0),
        "n2": skew(-1.25, 1.5),
        "p2": skew(1.25, 1.5),
    }
    own = roles({"skewness": ["n", "g", "p"]}, surfaces)
    found = surfaces_by_delta(own, surfaces)
    assert list(found) == [1.0, 1.5]
    assert found[1.5] == {"skew_negative, delta 1.5": "n2", "skew_positive, delta 1.5": "p2"}
    assert list(surfaces_by_delta(own, {**surfaces, "n2": skew(-1.25, 1.5, hurst=0.5)})) == [1.0]
    assert surfaces_by_delta({}, surfaces) == {}
