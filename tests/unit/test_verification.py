import json

import numpy as np
import pytest
from small_study import CONTACT, LAYER, STRESS

from asperity.stress.planes.planes import stress_planes
from asperity.study.stages import verification
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.seed_numbers import LEVELS, seed_statistics
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface
from asperity.study.stages.verification import (
    Verification,
    VerificationError,
    require,
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


def chain_of(**changes):
    """Surface, contact and stress of one seed with changed sections, and the settings of their files."""
    settings = SETTINGS | {name: SETTINGS[name] | changed for name, changed in changes.items()}
    surface = make_surface(settings["surface"], 1)
    contact = solve_contact(surface, settings["layer"], settings["contact"])
    stress = compute_stress(contact, settings["layer"], settings["stress"])
    return [data.assign_attrs(settings=json.dumps(settings)) for data in (surface, contact, stress)]


@pytest.fixture(scope="module")
def chain():
    return chain_of()


def broken(checks):
    return {name for name, (value, bound) in checks.items() if not value <= bound}


def test_sound_results_pass_every_check(chain):
    checks = verify_seed(*chain)
    assert len(checks) >= 15
    assert broken(checks) == set()
    require(checks, "small")


@pytest.mark.parametrize(
    "changes",
    [
        {"surface": {"points": 32}},  # four nodes on the shortest wavelength
        {"layer": {"height": 0.05, "half_space_tolerance": 0.0}},  # thinner than half of it
        # the least that a configuration may ask for
        {"contact": {"tolerance": 1e-14, "precision": "float64"}, "stress": {"tolerance": 0.0}},
    ],
    ids=lambda changes: " ".join(changes),
)
def test_unusual_settings_pass_every_check(changes):
    assert broken(verify_seed(*chain_of(**changes))) == set()


def test_a_pressure_one_percent_too_large_is_found(chain):
    surface, contact, stress = chain
    found = broken(verify_seed(surface, contact.assign(pressure=1.01 * contact.pressure), stress))
    assert found >= {
        "gap under contact over its length scale",
        "load balance",
        "mean von Mises stress of a plane, computed again",
    }


@pytest.mark.parametrize(
    ("stage", "name", "changed", "law"),
    [
        (1, "path_area_fraction", lambda path: path[::-1], "falls of the area along the load path"),
        (2, "mean_von_mises", lambda mean: 1.01 * mean, "mean von Mises stress of a plane, computed again"),
        (2, "peak_depth", lambda depth: -1 - depth, "peaks outside the solid"),
        (2, "peak_value", lambda value: 2 * value, "largest von Mises peak over the largest node"),
    ],
)
def test_a_wrong_variable_breaks_its_law_alone(chain, stage, name, changed, law):
    found = list(chain)
    found[stage] = found[stage].assign(
        {name: found[stage][name].copy(data=changed(found[stage][name].values))}
    )
    assert broken(verify_seed(*found)) == {law}


def test_statistics_that_lose_peaks_or_do_not_integrate_to_one_are_found(chain):
    surface, contact, stress = chain
    results = SeedResults(1, surface, contact, stress)
    statistics = surface_statistics([results], bins=20, resamples=10, confidence=0.95)
    assert broken(verify_statistics(statistics, [stress])) == set()
    assert broken(
        verify_statistics(statistics.assign(peak_density=0.99 * statistics.peak_density), [stress])
    ) == {"densities of the peaks against an integral of one"}
    verification = Verification("small")
    surface_statistics(verification.checked([results]), bins=20, resamples=10, confidence=0.95)
    table = verification.table(statistics)
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
            if "xz" in plane.fields:
                plane.fields["xz"] *= 1.01
            yield plane

    monkeypatch.setattr(verification, "stress_planes", wrong)
    assert broken(verify_seed(*chain)) == {"equilibrium along x", "equilibrium along z"}
