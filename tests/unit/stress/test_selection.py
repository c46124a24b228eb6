"""Peaks are selected by name: from an analysis, and from its file as any reader opens it."""

import numpy as np
import pytest
import xarray as xr
from samples import spots

import asperity as asp
from asperity.results import dataset
from asperity.stress.peaks.selection import SELECTIONS, selection_for

RATIOS = [0.0, 0.33, 0.5]


@pytest.fixture(scope="module")
def stress():
    return asp.analyse_stress(spots(), poisson=RATIOS, tolerance=1e-4)


@pytest.fixture(scope="module", params=["in memory", "file by asperity", "file by xarray"])
def source(request, stress, tmp_path_factory):
    """The same result in memory and in its file."""
    if request.param == "in memory":
        return stress
    path = tmp_path_factory.mktemp("stress") / "stress.nc"
    dataset.write(stress, path, "Stress", {})
    return asp.read_result(path) if request.param == "file by asperity" else xr.open_dataset(path)


def test_every_peak_is_under_one_quantity_and_ratio(source):
    """Those that do not depend on Poisson's ratio are found under each; all are in the layout of the file."""
    total = 0
    for quantity, alike in {"pressure": 1, "von_mises": 0, "xx": 0, "zz": 1, "xz": 1}.items():
        of_quantity = source["peak_quantity"] == quantity
        for nu in [None] if alike else RATIOS:
            ratio = source["peak_poisson"]
            chosen = of_quantity & (ratio.isnull() if alike else ratio == nu)
            by_hand = source["peak_value"].values[chosen.values]
            found = asp.stress.select_peaks(source, quantity, nu)
            np.testing.assert_array_equal(found["peak_value"], by_hand)
            total += found.sizes["peak"]
            for other in RATIOS if alike else []:
                one = asp.stress.select_peaks(source, quantity, other)
                xr.testing.assert_identical(one.drop_vars("poisson"), found.drop_vars("poisson"))
                assert (float(one["poisson"]), bool(np.isnan(found["poisson"]))) == (other, True)
    assert total == source.sizes["peak"]


@pytest.mark.parametrize("quantity", ["pressure", "von_mises", "xx", "xz"])
def test_selections_are_what_they_are_called(source, quantity):
    every, at_contact, interior, under_contact = (
        asp.stress.select_peaks(source, quantity, 0.33, selection) for selection in SELECTIONS
    )
    deep, touched = every["peak_interior"].values, every["peak_under_contact"].values
    for found, chosen in ((at_contact, touched), (interior, deep), (under_contact, deep & touched)):
        np.testing.assert_array_equal(found["peak_value"], every["peak_value"].values[chosen])
    np.testing.assert_array_equal(deep, every["peak_depth"].values > 0)
    # Figures count peaks in the surface of what is largest there.
    at_surface = quantity in ("pressure", "xx")
    assert selection_for(quantity) == ("at_contact" if at_surface else "under_contact")
    assert touched.any()
    assert deep.any() or at_surface


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        (("yy",), "quantity = 'yy': one of pressure, von_mises, xx, zz, xz is"),
        (("von_mises",), r"poisson: one of 0, 0\.33, 0\.5 is needed, there are"),
        (("zz", 0.3), r"poisson = 0\.3: one of 0, 0\.33, 0\.5 is needed"),
        (("xz", 0, "inside"), "selection = 'inside': one of all, at_contact,"),
    ],
)
def test_wrong_name_is_refused(stress, chosen, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        asp.stress.select_peaks(stress, *chosen)


def test_wrong_dataset_is_refused(stress):
    with pytest.raises(TypeError, match=r"^stress.*: the result"):
        asp.stress.select_peaks(stress.drop_vars("peak_quantity"), "xx")
