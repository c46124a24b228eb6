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
UNLOADED = {name: value for name, value in CONTACT.items() if name != "contact_area_fraction"}


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
    contact = press_surface(ROUGH, LAYER, CONTACT | {"path_contact_area_fractions": [0.15, 0.05]})
    np.testing.assert_allclose(contact.path_contact_area_fraction, [0.05, 0.1, 0.15], atol=1 / 64**2)
    assert np.all(np.diff(contact.path_mean_pressure) > 0)
    assert float(contact.contact_area_fraction) == pytest.approx(0.1, abs=1 / 64**2)
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
    (
        lambda: press_surface(ROUGH, LAYER, UNLOADED | {"normal_approach": 0.5}),
        r"contact.normal_approach = 0.5: less than",
    ),
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
    solved = asp.solve_contact(
        surface["height"].values, asp.Solid(1 - 0.33**2, 0.33), contact_area_fraction=0.1
    )
    quantities = "pressure", "von_mises"
    stress = asp.analyse_stress(solved, poisson=STRESS["poisson"], quantities=quantities, covariances=True)
    expected = asp.continuum_limit(solved, stress)
    of = {"kind": "estimate", "quantity": ["pressure", "von_mises"]}
    for name in ("contact_area_fraction", "gradient_rms_contact", "proportionality"):
        estimate = found[f"continuum_{name}"].sel(kind="estimate")
        assert float(estimate) == pytest.approx(float(expected[name].sel(kind="estimate")), rel=1e-4), name
    scale = found["continuum_gradient_rms_contact"].sel(kind="estimate")
    quantile = found["continuum_peak_quantile"].sel(of).sel(level=0.99) * scale
    np.testing.assert_allclose(quantile, expected["p99"].sel(of), rtol=0.01)


def test_library_in_si_has_the_numbers_of_the_study():
    """A surface with materials and a load in SI is computed by the library; the study has no units."""
    edge, young = 80e-6, 210e9
    modulus = young / (1 - LAYER["poisson"] ** 2)
    size = {name: SURFACE[name] * edge for name in ("wavelength_long", "wavelength_short", "rms_height")}
    height = asp.self_affine((64, 64), SURFACE["hurst"], **size, seed=1, length=edge)
    _, surface, study, stress = results_of(1)
    np.testing.assert_allclose(height / edge, surface["height"], rtol=0, atol=1e-15)
    contact = asp.solve_contact(height, asp.Solid(young, LAYER["poisson"]), edge, contact_area_fraction=0.1)
    np.testing.assert_allclose(
        contact.pressure / modulus, study["pressure"], atol=1e-5 * float(study["pressure"].max())
    )
    np.testing.assert_allclose(contact.gap / edge, study["gap"], atol=1e-8)
    depths = stress["plane_depth"].values * edge
    own = asp.analyse_stress(contact, depths, poisson=STRESS["poisson"], tolerance=STRESS["tolerance"])
    assert own.sizes["peak"] == stress.sizes["peak"]
    for name, unit in {"peak_value": modulus, "peak_depth": edge}.items():
        np.testing.assert_allclose(own[name] / unit, stress[name], rtol=1e-4, atol=1e-8)


def test_given_heights_at_one_spectrum(tmp_path):
    """From moments, a honed surface and a map, turned over and without its missing points."""
    gaussian = asp.self_affine((64, 64), 0.8, 0.25, 0.125, 1e-3, seed=1)
    heights = np.random.default_rng(1).gamma(2.0, size=(30, 40)) * 1e-6
    heights[3, 4] = np.nan
    np.savetxt(tmp_path / "map.csv", heights, delimiter=",")
    of_map = {"file": str(tmp_path / "map.csv"), "physical_size": ["3 um", "4 um"], "unit": "m"}
    surface = asp.HeightMap(heights, (3e-6, 4e-6))
    with pytest.warns(UserWarning, match="are the units of edges and heights right"):
        level = asp.prepare_map(surface, periodic="none", undefined="harmonic").height
    plateau = {"rpq": 0.2, "rvq": 0.6, "rmq": 60.0}
    for given, distribution in (
        ({"moments": {"skewness": 0.5, "kurtosis": 4.0}}, {"moments": (0.5, 4.0)}),
        ({"plateau": plateau}, {"plateau": (0.2, 0.6, 60.0)}),
        ({"map": of_map | {"orientation": "peaks up"}}, {"sample": level[np.isfinite(heights)]}),
    ):
        made = make_surface(SURFACE | {"heights": given}, 1)
        shaped = asp.surface.with_heights(gaussian, **distribution)
        np.testing.assert_allclose(made["height"], shaped.height, rtol=0, atol=1e-15)
        assert float(made["heights_residual"]) == pytest.approx(shaped.heights_residual)
    with pytest.raises(asp.MapError, match=r"map.csv: orientation: "):
        make_surface(SURFACE | {"heights": {"map": of_map}}, 1)
