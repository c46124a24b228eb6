import math

import numpy as np
import pytest
import xarray as xr

from asperity.errors import DatasetError
from asperity.paper.claims.statements import CLAIMS, LARGER, kolmogorov, of_poisson, ratio
from asperity.paper.claims.verdicts import (
    FAILS,
    HOLDS,
    NO_DATA,
    UNDECIDED,
    Claim,
    Evidence,
    Fixed,
    MissingEvidenceError,
    Region,
    continuum,
    continuum_markdown,
    decide,
    extrapolate,
    judge,
    markdown,
    resolutions,
    roles,
    rows,
    tally,
    with_error,
)
from asperity.paper.figures.claims import draw
from asperity.paper.figures.style import save, style
from asperity.pipeline.summary import LEVELS, Summary, contact_patches, half_length, read, write

SETTINGS = {"layer": {"poisson": 0.33}, "stress": {"poisson": [0.0, 0.33, 0.5]}}


def claim(values, region=LARGER):
    return Claim("name", "5.2", "sentence", "quantity", region, lambda evidence: np.array(values))


def summary(**values):
    return Summary(SETTINGS, {name.replace("__", "."): value for name, value in values.items()})


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
    assert all(f.why.startswith("no ") for f in findings)
    text = markdown(findings, [1], 8)
    assert text.count(f"**{NO_DATA}**") == len(wanting)


def test_identifiers_are_unique_and_sections_are_the_papers():
    assert len({c.identifier for c in CLAIMS}) == len(CLAIMS)
    known = {"abstract", "4.1", "4.2", "5.2", "5.3", "5.4", "6", "supplement"}
    assert all(set(c.section.split(", ")) <= known for c in CLAIMS)


def test_comparisons_are_paired_by_seed():
    small = [
        summary(x=2.0, contact__gradient_rms_contact=0.1),
        summary(x=20.0, contact__gradient_rms_contact=0.2),
    ]
    large = [
        summary(x=1.0, contact__gradient_rms_contact=0.2),
        summary(x=10.0, contact__gradient_rms_contact=0.1),
    ]
    evidence = Evidence({"small": small, "large": large})
    np.testing.assert_allclose(ratio("x", "small", "large")(evidence), [2, 2])
    np.testing.assert_allclose(ratio("x", "small", "large", scaled=False)(evidence), [1, 4])


def test_the_ends_of_the_range_of_poissons_ratio_are_found():
    values = {"x@0": 3.0, "x@0.33": 2.5, "x@0.5": 2.0}
    evidence = Evidence({"compressibility": [Summary(SETTINGS, values)]})
    np.testing.assert_allclose(of_poisson("x")(evidence), [1.5])


def test_kolmogorov_distance_of_shifted_uniform_distributions():
    one = Summary(SETTINGS, {}, {"xx@0.33": LEVELS})
    other = Summary(SETTINGS, {}, {"xx@0.33": LEVELS + 0.2})
    evidence = Evidence({"one": [one], "other": [other]})
    np.testing.assert_allclose(kolmogorov("xx@contact", "one", "other")(evidence), [0.2], rtol=1e-9)
    np.testing.assert_allclose(kolmogorov("xx@contact", "one", "one")(evidence), [0.0], atol=1e-15)


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
    def resolved(nodes):
        return Evidence({"large_hurst": [summary(x=1 + 1 / nodes)], "small_hurst": [summary(x=1.0)]})

    one = Claim("n", "5.2", "s", "q", LARGER, ratio("x", "large_hurst", "small_hurst"))
    finer = {nodes: resolved(nodes) for nodes in (8.0, 16.0, 32.0)}
    (finding,) = decide([one], finer[8.0], finer)
    assert finding.shift == pytest.approx(-1 / 8)
    with pytest.raises(MissingEvidenceError):
        continuum(one.measure, {8.0: finer[8.0]})
    table = continuum_markdown({"x": one.measure}, finer)
    assert "| x | 1.125 | 1.062 | 1.031 | 1.000 ± 0.031 |" in table
    assert continuum_markdown({"x": one.measure}, {}) == ""


def test_patches_are_joined_across_the_edges_of_the_cell_and_across_corners():
    contact = np.zeros((8, 8), bool)
    contact[0, 0] = contact[7, 7] = contact[7, 0] = True  # one patch through three corners of the cell
    contact[3, 3] = contact[4, 4] = True  # one over a corner of a square
    number, radii = contact_patches(contact)
    assert sorted(np.pi * radii**2) == pytest.approx([2, 3])
    assert number[0, 0] == number[7, 7] == number[7, 0] > 0
    assert number[3, 3] == number[4, 4] != number[0, 0]
    assert contact_patches(np.zeros((4, 4), bool))[1].size == 0


def test_half_length_is_between_the_nodes():
    assert half_length(np.array([0.0, 1.0, 2.0]), np.array([1.0, 0.75, 0.25])) == pytest.approx(1.5)
    assert math.isnan(half_length(np.array([0.0, 1.0]), np.array([1.0, 0.9])))


def test_a_summary_survives_its_file(tmp_path):
    one = Summary(SETTINGS, {"a": 1 / 3, "b": float("nan")}, {"q@0": np.array([0.1, 0.2])})
    write(one, tmp_path / "one.json")
    found = read(tmp_path / "one.json")
    assert found.settings == one.settings
    assert found["a"] == 1 / 3
    assert math.isnan(found["b"])
    np.testing.assert_array_equal(found.quantiles["q@0"], [0.1, 0.2])
    assert [p.name for p in tmp_path.iterdir()] == ["one.json"]


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"values": {"a": 2.0}}'])
def test_what_is_no_summary_as_it_was_written_is_named(tmp_path, content):
    path = tmp_path / "one.json"
    path.write_text(content)
    with pytest.raises(DatasetError, match=r"one\.json: .*; delete it and run again"):
        read(path)


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
    findings = [
        judge(claim([1.2, 1.3, 1.25]), EMPTY),
        judge(claim([12.0, 13.0, 12.5]), EMPTY),
        judge(claim([0.01, 0.02], Region(0.0, 0.05)), EMPTY),
        *decide(CLAIMS[:2], EMPTY),
    ]
    table = rows(findings, 8)
    assert [row["verdict"] for row in table] == [HOLDS, HOLDS, UNDECIDED, NO_DATA, NO_DATA]
    assert sum(tally(findings).values()) == len(findings)
    assert "1.250 ± 0.029" in markdown(findings, [1, 2, 3], 8)
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
