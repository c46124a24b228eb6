"""A film that carries a part of the load, and running-in: limits, equilibrium and published values."""

import math

import numpy as np
import pytest

import asperity as asp
from asperity.engineering.questions.film import Film
from asperity.settings.model import SettingsError

EDGE, PRESSURE = 64e-6, 1e9
STEEL = asp.Body(young=210e9, poisson=0.3)
BALL = {"hertz_pressure": PRESSURE, "radius_x": 0.02}


@pytest.fixture(scope="module")
def ground():
    height = asp.self_affine((32, 32), 0.8, EDGE / 2, EDGE / 8, 3e-8, seed=1, length=EDGE)
    return asp.HeightMap(height, (EDGE, EDGE), periodic=True, unit="m", name="ground")


@pytest.mark.parametrize("load", [{"mean_pressure": 2e8}, BALL])
def test_no_share_is_the_dry_answer(ground, load):
    """To the bit: every number but the film's."""
    dry = asp.run(ground, STEEL, STEEL, load=load, sliding={"friction": 0.1})
    wet = asp.run(ground, STEEL, STEEL, load=load, sliding={"friction": 0.1}, film={"load_fraction": 0.0})
    numbers = [[each for each in answer.records if each.topic != "film"] for answer in (dry, wet)]
    assert numbers[0] == numbers[1]


def test_full_film_leaves_the_stress_of_hertz(ground):
    """0.620 p₀ at 0.481 radii for ν = 0.3 (K. L. Johnson, Contact Mechanics, 1985, section 3.4).

    The asperities carry a thousandth of the load, and cause as much of the stress.
    """
    answer = asp.run(ground, STEEL, STEEL, load=BALL, film={"load_fraction": 0.999})
    depth = 0.481 * answer.case.hertz_contact.narrow
    (plane,) = asp.stress_planes(answer.loaded(), [depth])
    assert float(np.mean(plane.fields["von_mises"])) == pytest.approx(0.6197 * PRESSURE, rel=2e-3)


@pytest.mark.parametrize("share", [0.3, 0.9])
def test_film_and_asperities_carry_the_load(ground, share):
    """Equilibrium: the mean of σ_zz in every plane is minus the load over the nominal area."""
    answer = asp.run(ground, STEEL, mean_pressure=2e8, film={"load_fraction": share})
    for plane in asp.stress_planes(answer.loaded(), [0.0, 5e-6, 3e-5], fields=("zz",)):
        assert plane.fields["zz"].mean() == pytest.approx(-2e8, rel=1e-5)  # tolerance of the contact
    assert answer.contact.mean_pressure == pytest.approx((1 - share) * 2e8, rel=1e-6)


def test_film_lowers_the_cycles(ground):
    """Faces that roll through the contact: less load on asperities, less shear."""
    smooth = asp.Body(young=210e9, poisson=0.3, fatigue_torsion=3e8, fatigue_bending=4.8e8)
    worst = []
    for share in (0.0, 0.9):
        answer = asp.run(
            ground, smooth, STEEL, load=BALL, film={"load_fraction": share}, cycles={"shifts": 8}
        )
        worst.append(answer.record("maximum Dang Van stress over limit", "lower").value)
    assert worst[0] > worst[1]


@pytest.mark.parametrize(
    ("correlation", "ratio", "asperities"),
    [("arana", 1.0, 0.157299), ("arana", 0.5, 0.479500), ("balan", 1.0, 0.116788), ("balan", 0.5, 0.32744)],
)
def test_share_follows_published_correlations(correlation, ratio, asperities):
    """1 − erf from tables (Abramowitz and Stegun, table 7.1); Balan's Eq. A2 by hand."""
    film = Film(lambda_ratio=ratio, correlation=correlation)
    assert 1 - film.share == pytest.approx(asperities, abs=2e-5)


def test_film_states_the_hardness_that_is_given_and_what_a_thinner_film_carries(ground):
    """Plasticity is that of the material; 1 − erf 0.9 = 0.20309 (Abramowitz and Stegun, table 7.1)."""
    steel = asp.Body(young=210e9, poisson=0.3, hardness=2e9)
    dry, wet = (
        asp.run(ground, steel, mean_pressure=2e8, **film) for film in ({}, {"film": {"lambda_ratio": 1}})
    )
    for name in ("hardness", "plasticity index"):
        assert wet[name].value == dry[name].value
    left = 2e9 - 0.842701 * 2e8  # erf 1
    assert wet["hardness left for the asperities"].value == pytest.approx(left, rel=1e-6)
    (told,) = (each.text for each in wet.warnings if each.subject == "film thickness")
    assert told.endswith("If it is 10 % lower, the asperities carry 20 % of the load in place of 16 %.")


def test_running_in_ends_at_the_hardness(ground):
    """The flattened map touches as the plastic contact did, nowhere with more than the hardness."""
    hardness = 2e9
    plastic = asp.run(ground, asp.Body(young=210e9, poisson=0.3, hardness=hardness), mean_pressure=3e8)
    answer = asp.run(ground, STEEL, mean_pressure=3e8, running_in={"hardness": hardness})
    assert plastic.contact.plastic_area > 0.01
    assert answer.contact.contact_area_fraction == pytest.approx(
        plastic.contact.contact_area_fraction, rel=5e-3
    )
    assert answer["maximum pressure"].value == pytest.approx(hardness, rel=1e-4)  # tolerance of the contact
    assert answer["maximum pressure"].value <= hardness
    depth = answer["maximum flattening of the first load"].value
    assert depth == pytest.approx(float(plastic.contact.plastic_depth.max()), rel=1e-6)
    assert answer["flattening by another load"].value < 1e-3 * depth
    before, after = answer["Sq before the first load"].value, answer["Sq"].value
    assert before == pytest.approx(float(ground.height.std()), rel=1e-6)
    assert after < before
    told = answer["Sq before the first load"].note
    assert told.startswith("after running-in ")
    assert told.endswith(f"{100 * (after / before - 1):+.2g} %")
    flattened = answer["volume flattened by the first load per area"].value
    lost = plastic.contact.height.mean() - plastic.contact.flattened_height().mean()
    assert flattened == pytest.approx(abs(float(lost)), rel=1e-5)
    assert "not decided whether the surface runs in further" in " ".join(answer.verdict)
    assert math.isinf(answer.contact.hardness)


def test_running_in_below_the_hardness_changes_nothing(ground):
    dry = asp.run(ground, STEEL, mean_pressure=1e8)
    after = asp.run(ground, STEEL, mean_pressure=1e8, running_in={"hardness": 1e11})
    assert np.array_equal(dry.contact.pressure, after.contact.pressure)
    assert any("flattens nothing" in each.text for each in after.warnings)


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        ({"film": {}}, "film: exactly one of load_fraction and lambda_ratio is needed"),
        ({"film": {"load_fraction": 1.0}}, "film.load_fraction = 1.0: a number ≥ 0 and < 1 is needed"),
        ({"film": {"lambda_ratio": 3}}, "film.lambda_ratio = 3: a number ≥ 0 and ≤ 2 is needed; beyond it"),
        ({"film": {"lambda_ratio": -1}}, "film.lambda_ratio = -1: a number from 0 to 2 is needed"),
        ({"running_in": {}}, "running_in.hardness: missing"),
        ({"running_in": {"hardness": 1e8}}, "running_in.hardness = 100 MPa: more than the mean pressure"),
    ],
)
def test_wrong_film_or_running_in_is_refused(ground, groups, message):
    with pytest.raises(SettingsError, match=message.replace("(", r"\(")):
        asp.Case(map=ground, body=STEEL, load={"mean_pressure": 1e8}, **groups)
