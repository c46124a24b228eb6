import json

import numpy as np
import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.stress.planes.planes import stress_planes
from asperity.study.stages import verification
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.statistics import LEVELS, SeedResults, seed_statistics, surface_statistics
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface
from asperity.study.stages.verification import (
    VerificationError,
    require,
    verify,
    verify_seed,
    verify_statistics,
)

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


def chain_of(surface_changes, layer_changes):
    """The same chain for another grid or layer."""
    parameters, layer = {**SURFACE, **surface_changes}, {**LAYER, **layer_changes}
    surface = make_surface(parameters, 1)
    contact = solve_contact(surface, layer, CONTACT)
    stress = compute_stress(contact, layer, STRESS)
    settings = json.dumps({**SETTINGS, "surface": parameters, "layer": layer})
    return [data.assign_attrs(settings=settings) for data in (surface, contact, stress)]


def broken(checks):
    return {name for name, (value, bound) in checks.items() if not value <= bound}


def test_sound_results_pass_every_check(chain):
    checks = verify_seed(*chain)
    assert len(checks) >= 15
    assert broken(checks) == set()
    require(checks, "small")


@pytest.mark.parametrize(
    ("surface", "layer"),
    [({"points": 32}, {}), ({}, {"height": 0.05, "half_space_tolerance": 0.0})],
    ids=["four nodes on the shortest wavelength", "a layer thinner than half of it"],
)
def test_a_coarse_grid_and_a_thin_layer_pass_every_check(surface, layer):
    assert broken(verify_seed(*chain_of(surface, layer))) == set()


@pytest.mark.parametrize("tolerance", [0.0, 1e-30])
def test_tolerances_below_rounding_pass_every_check(tolerance):
    """The least that a configuration may ask for: a contact to 1e-14, and planes without any truncation."""
    contact_settings = {**CONTACT, "tolerance": 1e-14, "precision": "float64"}
    stress_settings = {**STRESS, "tolerance": tolerance}
    surface = make_surface(SURFACE, 1)
    contact = solve_contact(surface, LAYER, contact_settings)
    stress = compute_stress(contact, LAYER, stress_settings)
    settings = json.dumps({**SETTINGS, "contact": contact_settings, "stress": stress_settings})
    chain = [data.assign_attrs(settings=settings) for data in (surface, contact, stress)]
    assert broken(verify_seed(*chain)) == set()


def test_a_pressure_one_percent_too_large_is_found(chain):
    surface, contact, stress = chain
    found = broken(verify_seed(surface, contact.assign(pressure=1.01 * contact.pressure), stress))
    assert found >= {
        "gap under contact over its length scale",
        "load balance",
        "mean von Mises stress of a plane, computed again",
    }


def test_a_load_area_curve_that_falls_is_found(chain):
    surface, contact, stress = chain
    area = contact.path_area_fraction.copy(data=contact.path_area_fraction.values[::-1])
    found = broken(verify_seed(surface, contact.assign(path_area_fraction=area), stress))
    assert found == {"falls of the area along the load path"}


def test_a_stress_field_one_percent_too_large_is_found(chain):
    surface, contact, stress = chain
    found = broken(verify_seed(surface, contact, stress.assign(mean_von_mises=1.01 * stress.mean_von_mises)))
    assert found == {"mean von Mises stress of a plane, computed again"}


def test_peaks_outside_the_solid_or_above_their_plane_are_found(chain):
    surface, contact, stress = chain
    assert broken(verify_seed(surface, contact, stress.assign(peak_depth=-1 - stress.peak_depth))) == {
        "peaks outside the solid"
    }
    assert broken(verify_seed(surface, contact, stress.assign(peak_value=2 * stress.peak_value))) == {
        "largest von Mises peak over the largest node"
    }


def test_statistics_that_lose_peaks_or_do_not_integrate_to_one_are_found(chain):
    surface, contact, stress = chain
    results = SeedResults(1, surface, contact, stress)
    statistics = surface_statistics([results], bins=20, resamples=10, confidence=0.95)
    assert broken(verify_statistics(statistics, [stress])) == set()
    assert broken(
        verify_statistics(statistics.assign(peak_density=0.99 * statistics.peak_density), [stress])
    ) == {"densities of the peaks against an integral of one"}
    table = verify("small", [results], statistics)
    assert set(table["of"]) == {"seed 1", "all seeds"}
    assert (table["value"] <= table["bound"]).all()
    fewer = statistics.assign(peak_counts=(statistics.peak_counts * 0.5).astype(int))
    assert "peaks not counted" in broken(verify_statistics(fewer, [stress]))


def test_a_broken_law_is_told_in_one_line():
    with pytest.raises(VerificationError, match=r"^place: law 2 > 1; other nan > 1$"):
        require({"law": (2, 1), "fine": (0, 1), "other": (float("nan"), 1)}, "place")


def test_numbers_of_a_seed_are_those_of_its_results(chain):
    surface, contact, stress = chain
    found = seed_statistics(surface, contact, stress)
    gradient = float(contact.gradient_rms_contact)
    assert float(found["seed_kurtosis"]) == float(surface["kurtosis"])
    assert float(found["seed_proportionality"]) == pytest.approx(
        float(contact.area_fraction) * gradient / float(contact.mean_pressure)
    )
    assert float(found["seed_load_exponent"]) == pytest.approx(1, abs=0.2)  # a few circles of contact
    assert float(found["seed_largest_von_mises"].sel(poisson=0.33)) == pytest.approx(
        float(stress.largest_von_mises.sel(poisson=0.33).max()) / gradient
    )
    quantile = found["seed_peak_quantile"]
    assert quantile.sizes["level"] == LEVELS.size
    assert bool((quantile.diff("level") >= 0).all())
    assert bool((found["seed_peak_mean"] < quantile.sel(level=1.0)).all())
    assert bool((found["seed_decay_length_depth"] > 0).all())
    assert bool((found["seed_decay_length_plane"] > 0).all())


def test_a_seed_without_peaks_has_counts_of_zero_and_no_numbers(chain):
    surface, contact, stress = chain
    found = seed_statistics(
        surface, contact, stress.assign(peak_under_contact=~(stress.peak_under_contact | True))
    )
    assert int(found["seed_peak_count"].sum()) == 0
    assert bool(found["seed_mean_depth"].isnull().all())
    assert bool(found["seed_depth_patch_correlation"].isnull().all())


def test_pooled_numbers_of_one_seed_are_its_own(chain):
    found = surface_statistics([SeedResults(7, *chain)], bins=20, resamples=10, confidence=0.95)
    assert found["seed"].values.tolist() == [7]
    counted = found.sel(selection="under_contact", quantity="von_mises", seed=7)
    np.testing.assert_allclose(
        counted["peak_percentile"].sel(percent=[50, 90, 99]),
        counted["seed_peak_quantile"].sel(level=[0.5, 0.9, 0.99]),
    )
    np.testing.assert_allclose(found["decay_length_depth"], counted["seed_decay_length_depth"])
    assert int(found["height_counts"].sum()) == chain[0]["height"].size


def test_a_shear_stress_one_percent_too_large_is_out_of_equilibrium(chain, monkeypatch):
    def wrong(*arguments, **options):
        for plane in stress_planes(*arguments, **options):
            plane.fields["xz"] *= 1.01
            yield plane

    monkeypatch.setattr(verification, "stress_planes", wrong)
    assert broken(verify_seed(*chain)) == {"equilibrium along x", "equilibrium along z"}
