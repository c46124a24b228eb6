"""A tiny study from the surface to the verdicts: one contact serves both conditions of the uniform mode."""

import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.paper.claims.evidence import Evidence
from asperity.paper.claims.report import markdown, tables
from asperity.paper.claims.statements import CLAIMS
from asperity.paper.claims.verdicts import NO_DATA, decide
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.statistics import SeedResults, reading_statistics
from asperity.pipeline.stress import QUANTITIES, compute_stresses
from asperity.pipeline.surface import make_surface

SEEDS = (1, 2, 3)
READINGS = {
    "lateral": ["confined", "free"],
    "peaks": ["below_surface", "with_surface"],
    "patches": ["every_peak", "highest_of_patch"],
    "shear": ["xz", "xy"],
    "tail": [0.99, 0.9],
    "decay": ["half", "inverse_e"],
    "breadth": ["deviation", "quartiles"],
    "alike": [0.05, 0.1],
}


def statistics(hurst, layer=LAYER, others=("free",)):
    """Condition of the uniform mode → statistics of a surface over its seeds."""
    found = {}
    for seed in SEEDS:
        surface = make_surface(
            {
                "hurst": hurst,
                "wavelength_long": 0.25,
                "wavelength_short": 0.0625,
                "rms_height": 1e-3,
                "points": 64,
            },
            seed,
        )
        contact = solve_contact(surface, layer, CONTACT | {"path_area_fractions": []})
        stresses = compute_stresses(contact, layer, STRESS, others, [*QUANTITIES, "xy"])
        for lateral, stress in stresses.items():
            found.setdefault(lateral, []).append(SeedResults(seed, surface, contact, stress))
    return {lateral: reading_statistics(results) for lateral, results in found.items()}


def by_role(small, large):
    return {"small_hurst": small, "large_hurst": large, "compressibility": large}


@pytest.fixture(scope="module")
def judged():
    """The findings about H and ν by their identifiers."""
    small, large = statistics(0.2), statistics(0.8)
    evidence = Evidence(
        by_role(small["confined"], large["confined"]),
        laterals={"free": by_role(small["free"], large["free"])},
    )
    return {f.claim.identifier: f for f in decide(CLAIMS, evidence, readings=READINGS)}


def test_every_statement_has_a_judgement_for_every_reading_of_its_choices(judged):
    assert len(judged) == len(CLAIMS)
    known = [f for f in judged.values() if f.verdict != NO_DATA]
    assert len(known) > 20
    for finding in known:
        expected = 1
        for name in finding.claim.choices:
            expected *= len(READINGS.get(name, [0]))
        assert len(finding.judgements) == expected
        assert not [one.missing for one in finding.judgements if one.missing]
    text = markdown(list(judged.values()), SEEDS, 4)
    assert all(f.claim.quantity.replace("|", "\\|") in text for f in judged.values())
    assert sum(len(table) for table in tables(list(judged.values())).values()) == len(CLAIMS)


def test_a_reading_has_the_number_of_a_study_with_its_uniform_mode(judged):
    """The free cell as the study's own, solved and analysed on its own, gives the numbers of the reading."""
    free = LAYER | {"lateral": "free"}
    small, large = (statistics(hurst, free, ())["free"] for hurst in (0.2, 0.8))
    own = decide(CLAIMS, Evidence(by_role(small, large)))
    compared = 0
    for finding in own:
        reading = judged[finding.claim.identifier]
        if finding.verdict == NO_DATA or "lateral" not in finding.claim.choices:
            continue
        wanted = reading.own.options | {"lateral": "free"}
        (twin,) = (one for one in reading.judgements if one.options == wanted)
        assert twin.value == finding.own.value
        assert twin.value != reading.own.value
        compared += 1
    assert compared > 10


def test_tractions_do_not_depend_on_the_uniform_mode(judged):
    for name in ("same_traction_peaks", "same_area_load", "shear_of_hurst", "finer_contacts"):
        assert "lateral" not in judged[name].claim.choices


def test_the_shear_in_the_plane_depends_on_poissons_ratio_and_that_along_depth_does_not(judged):
    value = {one.options["shear"]: one.value for one in judged["shear_of_poisson"].judgements}
    assert value["xz"] == 0
    assert value["xy"] > 0.2
