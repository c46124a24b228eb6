import json

import numpy as np
import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.pipeline.contact import solve_contact
from asperity.pipeline.statistics import summarise
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.summary import LEVELS, QUANTITIES
from asperity.pipeline.summary import summarise as numbers
from asperity.pipeline.surface import make_surface
from asperity.pipeline.verification import Check, VerificationError, require, verify_member, verify_statistics

SURFACE = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 0.125, "rms_height": 1e-3, "points": 64}
SETTINGS = {
    "name": "small",
    "seed": 1,
    "surface": SURFACE,
    "layer": LAYER,
    "contact": CONTACT,
    "stress": STRESS,
}


@pytest.fixture(scope="module")
def chain():
    """Surface, contact and stress of one seed, with the settings that their files would carry."""
    surface = make_surface(SURFACE, 1)
    contact = solve_contact(surface, LAYER, CONTACT)
    stress = compute_stress(contact, LAYER, STRESS)
    return [data.assign_attrs(settings=json.dumps(SETTINGS)) for data in (surface, contact, stress)]


def broken(checks):
    return {check.name for check in checks if not check.holds}


def test_sound_results_pass_every_check(chain):
    checks = verify_member(*chain)
    assert len(checks) >= 15
    assert broken(checks) == set()
    require(checks, "small")


def test_a_pressure_one_percent_too_large_is_found(chain):
    surface, contact, stress = chain
    found = broken(verify_member(surface, contact.assign(pressure=1.01 * contact.pressure), stress))
    assert found >= {
        "gap under contact over its length scale",
        "load balance",
        "mean von Mises stress of a plane, computed again",
    }


def test_a_load_area_curve_that_falls_is_found(chain):
    surface, contact, stress = chain
    area = contact.path_area_fraction.copy(data=contact.path_area_fraction.values[::-1])
    found = broken(verify_member(surface, contact.assign(path_area_fraction=area), stress))
    assert found == {"falls of the area along the load path"}


def test_a_stress_field_one_percent_too_large_is_found(chain):
    surface, contact, stress = chain
    found = broken(
        verify_member(surface, contact, stress.assign(mean_von_mises=1.01 * stress.mean_von_mises))
    )
    assert found == {"mean von Mises stress of a plane, computed again"}


def test_peaks_outside_the_solid_or_above_their_plane_are_found(chain):
    surface, contact, stress = chain
    assert broken(verify_member(surface, contact, stress.assign(peak_depth=-1 - stress.peak_depth))) == {
        "peaks outside the solid"
    }
    assert broken(verify_member(surface, contact, stress.assign(peak_value=2 * stress.peak_value))) == {
        "largest von Mises peak over the largest node"
    }


def test_statistics_that_lose_peaks_or_do_not_integrate_to_one_are_found(chain):
    surface, contact, stress = chain
    statistics = summarise([surface], [contact], [stress], bins=20, resamples=10, confidence=0.95)
    assert broken(verify_statistics(statistics, [stress])) == set()
    assert broken(
        verify_statistics(statistics.assign(peak_density=0.99 * statistics.peak_density), [stress])
    ) == {"densities of the peaks against an integral of one"}
    fewer = statistics.assign(peak_counts=(statistics.peak_counts * 0.5).astype(int))
    assert "peaks not counted" in broken(verify_statistics(fewer, [stress]))


def test_a_broken_law_is_told_in_one_line():
    with pytest.raises(VerificationError, match=r"^place: law 2 > 1; other nan > 1$"):
        require([Check("law", 2, 1), Check("fine", 0, 1), Check("other", float("nan"), 1)], "place")


def test_a_summary_measures_what_the_results_hold(chain):
    surface, contact, stress = chain
    found = numbers(surface, contact, stress)
    gradient = float(contact.gradient_rms_contact)
    assert found["contact.proportionality"] == pytest.approx(
        float(contact.area_fraction) * gradient / float(contact.mean_pressure)
    )
    assert found["contact.load_exponent"] == pytest.approx(1, abs=0.2)  # a few circles of contact
    assert found["profile.largest@0.33"] == pytest.approx(
        float(stress.largest_von_mises.sel(poisson=0.33).max()) / gradient
    )
    for name, curve in found.quantiles.items():
        quantity, _, ratio = name.partition("@")
        assert quantity in QUANTITIES
        assert np.all(np.diff(curve) >= 0)
        assert curve[-1] == found[f"{quantity}.largest@{ratio}"]
        assert found.exceeded(name, 0.5) == pytest.approx(found[f"{quantity}.p50@{ratio}"])
        assert curve.size == LEVELS.size
    assert found["decay.depth@0"] > 0
    assert found["decay.plane@0"] > 0
