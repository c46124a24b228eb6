"""The stages of the study, called as functions."""

import numpy as np
import pytest
from samples import refuses
from small_study import CONTACT, LAYER, STRESS, SURFACE, results_of

import asperity as asp
from asperity.study.stages.contact import SOLID_ATTRIBUTES, press_surface, solid
from asperity.study.stages.statistics import surface_statistics
from asperity.study.stages.stress import compute_stress, stress_of_seed
from asperity.study.stages.surface import make_surface

STATISTICS = {"bins": 10, "resamples": 50, "confidence": 0.9}
ROUGH = make_surface(SURFACE, 1)
UNLOADED = {name: value for name, value in CONTACT.items() if name != "area_fraction"}


def test_half_space_replaces_only_a_tall_layer():
    tall, record = solid(LAYER)
    assert tall.height is None
    assert record["solid"] == "half-space"
    assert 0 < record["solid_bound"] <= LAYER["half_space_tolerance"]
    thin, record = solid(LAYER | {"height": 0.2})
    assert thin.height == 0.2
    assert record["solid"] == "layer, bonded bottom"
    assert thin.effective_modulus == pytest.approx(1)


def test_load_area_curve_has_rising_areas():
    contact = press_surface(ROUGH, LAYER, CONTACT | {"path_area_fractions": [0.15, 0.05]})
    np.testing.assert_allclose(contact.path_area_fraction, [0.05, 0.1, 0.15], atol=1 / 64**2)
    assert np.all(np.diff(contact.path_mean_pressure) > 0)
    assert float(contact.area_fraction) == pytest.approx(0.1, abs=1 / 64**2)
    middle = contact.path_mean_pressure.values[1]
    assert float(contact.mean_pressure) == middle == pytest.approx(contact.pressure.values.mean())


def test_layer_has_only_the_ratio_of_its_contact():
    half_space = results_of(1).stress
    assert half_space.poisson.values.tolist() == [0.0, 0.33]
    layer = results_of(1, LAYER | {"height": 0.2}).stress
    assert layer.poisson.values.tolist() == [0.33]
    assert layer.plane_depth.values[-1] == pytest.approx(0.2)


def incompressible():
    """A ratio at which the half-space does not stand for the layer."""
    compute_stress(press_surface(ROUGH, LAYER, CONTACT), LAYER, STRESS | {"poisson": [0.33, 0.5]})


test_wrong_setting_is_refused = refuses(
    (lambda: press_surface(ROUGH, LAYER, UNLOADED | {"approach": 0.5}), r"contact.approach = 0.5: less than"),
    (incompressible, r"stress\.poisson = 0\.5: layer: .*beyond the tolerance 0\.03; leave"),
)


def test_bins_follow_the_number_of_peaks():
    found = surface_statistics([results_of(1)], **STATISTICS | {"bins": 100})
    fewest = int(found["seed_peak_count"].min())
    assert found.sizes["bin"] == max(10, fewest // 20) < 100
    assert found.sizes["height_bin"] == 100


def test_two_seeds_have_bands_and_one_has_none():
    results = [results_of(seed) for seed in (1, 2)]
    two = surface_statistics(results, **STATISTICS)
    one = surface_statistics(results[:1], **STATISTICS)
    assert np.isnan(one.scaled_covariance_depth_low.values).all()
    low, high = two.scaled_covariance_depth_low, two.scaled_covariance_depth_high
    assert bool((low <= high).all())
    assert bool((low < high).any())
    assert two["seed"].values.tolist() == [1, 2]
    assert float((two.height_density * np.diff(two.height_edge)).sum()) == pytest.approx(1)
    load, low, high = (two[f"path_scaled_load{end}"].values for end in ("", "_low", "_high"))
    assert np.all((low < load) & (load < high))
    assert np.all(np.diff(load) > 0)
    assert all(name in two.attrs for name in SOLID_ATTRIBUTES)


def test_study_has_the_estimates_of_the_library():
    """But for the planes in depth, which the study has at other distances."""
    surface = make_surface({**SURFACE, "wavelength_short": 1 / 16, "points": 128}, 1)
    found = stress_of_seed(press_surface(surface, LAYER, CONTACT), LAYER, STRESS)
    solved = asp.solve_contact(surface["height"].values, asp.Solid(1 - 0.33**2, 0.33), area_fraction=0.1)
    stress = asp.analyse_stress(solved, poisson=STRESS["poisson"], quantities=("pressure", "von_mises"))
    expected = asp.continuum_limit(solved, stress)
    of = {"kind": "estimate", "quantity": ["pressure", "von_mises"]}
    for name in ("area_fraction", "gradient_rms_contact", "proportionality"):
        estimate = found[f"continuum_{name}"].sel(kind="estimate")
        assert float(estimate) == pytest.approx(float(expected[name].sel(kind="estimate")), rel=1e-4), name
    scale = found["continuum_gradient_rms_contact"].sel(kind="estimate")
    quantile = found["continuum_peak_quantile"].sel(of).sel(level=0.99) * scale
    np.testing.assert_allclose(quantile, expected["p99"].sel(of), rtol=0.01)
