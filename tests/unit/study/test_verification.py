import json

import numpy as np
import pytest
from small_study import SETTINGS, results_of

from asperity.study.stages.statistics import (
    QUANTILES,
    SeedResults,
    VerificationError,
    seed_statistics,
    surface_statistics,
    verification_table,
    verify_seed,
    verify_statistics,
)


@pytest.fixture(scope="module")
def chain():
    """Surface, contact and stress of one seed, with the settings of their files."""
    return [data.assign_attrs(settings=json.dumps(SETTINGS)) for data in results_of(1)[1:]]


AREA = "falls of the area along the load path"
GAP = "gap under contact over its length scale"
LARGEST = "largest von Mises peak over the largest node"


def broken(checks):
    return {name for name, (value, bound) in checks.items() if not value <= bound}


@pytest.mark.parametrize(
    ("stage", "changed", "laws"),
    [
        ("contact", lambda data: data, []),
        (
            "contact",
            lambda data: data.assign(path_contact_area_fraction=-data.path_contact_area_fraction),
            [AREA],
        ),
        ("contact", lambda data: data.assign_attrs(certificate_contact_gap=np.nan), [GAP]),
        ("stress", lambda data: data.assign(peak_depth=-1 - data.peak_depth), ["peaks outside the solid"]),
        ("stress", lambda data: data.assign(peak_value=2 * data.peak_value), [LARGEST]),
    ],
)
def test_a_wrong_number_breaks_its_law_alone(chain, stage, changed, laws):
    found = dict(zip(("contact", "stress"), chain[1:], strict=True))
    found[stage] = changed(found[stage])
    assert broken(verify_seed(**found)) == {*laws}


def test_statistics_that_lose_peaks_are_found(chain):
    statistics = surface_statistics([SeedResults(1, *chain)], bins=20, resamples=10, confidence=0.95)
    assert broken(verify_statistics(statistics)) == set()
    lower = statistics.assign(peak_density=0.99 * statistics.peak_density)
    assert broken(verify_statistics(lower)) == {"densities of the peaks against an integral of one"}
    fewer = statistics.assign(peak_counts=(statistics.peak_counts * 0.5).astype(int))
    assert "peaks not counted" in broken(verify_statistics(fewer))


def test_a_broken_law_is_told_in_one_line():
    parts = {"seed 1": {"law": (2, 1), "fine": (0, 1), "other": (float("nan"), 1)}}
    with pytest.raises(VerificationError, match=r"^place: seed 1, law 2 > 1; seed 1, other nan > 1$"):
        verification_table("place", parts)


def test_seed_has_the_numbers_of_its_results(chain):
    surface, contact, stress = chain
    found = seed_statistics(surface, contact, stress)
    gradient = float(contact.gradient_rms_contact)
    assert float(found["seed_kurtosis"]) == float(surface["kurtosis"])
    proportionality = float(contact.contact_area_fraction) * gradient / float(contact.mean_pressure)
    assert float(found["seed_proportionality"]) == pytest.approx(proportionality)
    assert float(found["seed_load_exponent"]) == pytest.approx(1, abs=0.2)  # a few circles of contact
    largest = float(stress.maximum_von_mises.sel(poisson=0.33).max()) / gradient
    assert float(found["seed_maximum_von_mises"].sel(poisson=0.33)) == pytest.approx(largest)
    quantile = found["seed_peak_quantile"]
    assert quantile.sizes["level"] == QUANTILES.size
    assert bool((quantile.diff("level") >= 0).all())
    assert bool((found["seed_peak_mean"] < quantile.sel(level=1.0)).all())
    assert bool((found["seed_decay_length_depth"] > 0).all())
    assert bool((found["seed_decay_length_plane"] > 0).all())
