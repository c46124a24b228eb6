"""Peaks are selected by name: from an analysis, and from its file as any reader opens it."""

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.results import dataset
from asperity.stress.peaks.selection import SELECTIONS, selection_for

RATIOS = [0.0, 0.33, 0.5]


@pytest.fixture(scope="module")
def stress():
    """Stress under a few spots of different sizes on a half-space."""
    grid = asp.Grid((64, 64))
    y, x = grid.coordinates()
    pressure = np.maximum(np.sin(19 * y)[:, None] * np.sin(23 * x)[None, :] + 0.3 * np.sin(7 * x) - 0.5, 0)
    solid = asp.LoadedSolid(0.1 * pressure, grid, asp.Layer(young=1.0, poisson=0.33))
    return asp.analyse_stress(solid, poisson=RATIOS, tolerance=1e-4)


@pytest.fixture(scope="module", params=["in memory", "file by asperity", "file by xarray"])
def source(request, stress, tmp_path_factory):
    """The same result in memory and in its file."""
    if request.param == "in memory":
        return stress
    path = tmp_path_factory.mktemp("stress") / "stress.nc"
    dataset.write(stress, path, "Stress", {})
    return asp.read_result(path) if request.param == "file by asperity" else xr.open_dataset(path)


def test_one_line_gives_a_table_of_the_peaks_asked_for(source):
    frame = asp.peaks(source, "von_mises", poisson=0.33, selection="under_contact").to_dataframe()
    assert {"peak_value", "peak_depth", "peak_y", "peak_x"} < set(frame.columns)
    assert len(frame) > 5
    assert (frame["quantity"] == "von_mises").all()
    assert (frame["poisson"] == 0.33).all()
    assert (frame["peak_depth"] > 0).all()
    assert frame["peak_interior"].all()
    assert frame["peak_under_contact"].all()


def test_names_select_the_same_peaks_by_hand(source):
    """The layout that the descriptions in the file promise."""
    asked = (source["peak_quantity"] == "von_mises") & (source["peak_poisson"] == 0.5)
    by_hand = source["peak_value"].values[asked.values]
    np.testing.assert_array_equal(asp.peaks(source, "von_mises", 0.5)["peak_value"], by_hand)
    alike = (source["peak_quantity"] == "zz") & source["peak_poisson"].isnull()
    by_hand = source["peak_value"].values[alike.values]
    np.testing.assert_array_equal(asp.peaks(source, "zz")["peak_value"], by_hand)


@pytest.mark.parametrize("quantity", ["pressure", "zz", "xz"])
def test_peaks_that_do_not_depend_on_poissons_ratio_are_found_under_each(source, quantity):
    one, *others = (asp.peaks(source, quantity, nu) for nu in (*RATIOS, None))
    assert one.sizes["peak"] > 0
    for other in others:
        xr.testing.assert_identical(other.drop_vars("poisson"), one.drop_vars("poisson"))
    assert float(one["poisson"]) == 0.0
    assert np.isnan(others[-1]["poisson"])


def test_every_peak_is_under_one_quantity_and_ratio(source):
    counts = [
        asp.peaks(source, quantity, nu).sizes["peak"]
        for quantity, ratios in {
            "pressure": [None],
            "von_mises": RATIOS,
            "xx": RATIOS,
            "zz": [None],
            "xz": [None],
        }.items()
        for nu in ratios
    ]
    assert sum(counts) == source.sizes["peak"]


@pytest.mark.parametrize("quantity", ["pressure", "von_mises", "xx", "xz"])
def test_selections_are_what_they_are_called(source, quantity):
    every, at_contact, interior, under_contact = (
        asp.peaks(source, quantity, 0.33, selection) for selection in SELECTIONS
    )
    deep, touched = every["peak_interior"].values, every["peak_under_contact"].values
    for found, chosen in ((at_contact, touched), (interior, deep), (under_contact, deep & touched)):
        np.testing.assert_array_equal(found["peak_value"], every["peak_value"].values[chosen])
    np.testing.assert_array_equal(deep, every["peak_depth"].values > 0)
    assert touched.any()
    assert deep.any() or quantity in ("pressure", "xx")


def test_figures_count_peaks_in_the_surface_of_what_is_largest_there():
    assert selection_for("xx") == selection_for("pressure") == "at_contact"
    assert selection_for("von_mises") == selection_for("xz") == "under_contact"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("yy",), "quantity = 'yy': one of pressure, von_mises, xx, zz, xz is needed"),
        (("von_mises",), r"poisson: one of 0, 0\.33, 0\.5 is needed, there are several"),
        (("von_mises", 0.3), r"poisson = 0\.3: one of 0, 0\.33, 0\.5 is needed"),
        (("zz", 0.3), r"poisson = 0\.3: one of 0, 0\.33, 0\.5 is needed"),
        (("xz", 0.0, "inside"), "selection = 'inside': one of all, at_contact, interior, under_contact"),
    ],
)
def test_a_wrong_name_is_answered_with_those_that_there_are(stress, arguments, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        asp.peaks(stress, *arguments)


def test_a_dataset_without_peaks_is_refused(stress):
    with pytest.raises(
        TypeError, match=r"^stress = .*: the result of a stress analysis, a dataset, is needed"
    ):
        asp.peaks(stress.drop_vars("peak_quantity"), "xx")
    numbers = stress.assign_coords(peak_quantity=("peak", np.zeros(stress.sizes["peak"], np.int16)))
    with pytest.raises(ValueError, match=r"^stress: made by another version"):
        asp.peaks(numbers, "xx")
