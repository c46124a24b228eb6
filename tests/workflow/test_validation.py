"""The comparisons of the validation table stay within its bounds, and tell a wrong field from a right one."""

from functools import cache

import numpy as np
import pytest

from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Grid
from asperity.results import dataset
from asperity.study.validation.closed_forms import slab_load_area
from asperity.study.validation.finite_elements import largest_differences
from asperity.study.validation.indenter import displacement_and_stress
from asperity.study.validation.table import CHECKS, comparison, for_reader, frame

FINER = {"load_area": {"method": "active_set"}, "elements": {"meshes": ((8, 7), (20, 16))}}
"""Comparisons that need finer grids and meshes than those of the quick study."""


@cache
def on_finer_grid(name):
    return comparison(name)(**FINER[name])


@pytest.fixture
def compared(quick_study):
    """Dataset of a comparison, of the study of the tests where its grid is fine enough."""
    folder = quick_study.results / "validation"
    return lambda name: on_finer_grid(name) if name in FINER else dataset.read(folder / f"{name}.nc")


@pytest.mark.parametrize("name", {check["comparison"]: 0 for check in CHECKS})
def test_errors_are_within_their_bounds(name, compared):
    table = frame({name: compared(name)})
    assert len(table) > 0
    assert table["holds"].all(), table[~table["holds"]]


def test_table_marks_an_exceeded_bound(compared):
    found = compared("load_area")
    wrong = found.assign(solved_contact_radius=1.1 * found.solved_contact_radius)
    shown = [for_reader(frame({"load_area": data}))["bound"].tolist() for data in (found, wrong)]
    assert shown == [["1 %"], ["1 %, **exceeded**"]]


def test_fields_at_points_are_those_of_a_mode():
    grid = Grid((12, 16), (0.9, 1.2))
    wavenumber = 2 * np.pi / 1.2 * 3
    pressure = np.tile(np.cos(wavenumber * grid.coordinates()[1]), (12, 1))
    y, x, depths = np.array([0.1, 0.37]), np.array([0.21, 0.4]), np.array([0.0, 0.05, 0.3])
    moved, stress = displacement_and_stress(pressure, grid, Solid(1.3, 0.3), y, x, depths)
    for found, field in ((moved, Solid.displacement), (stress, Solid.stress)):
        mode = field(Solid(1.3, 0.3), wavenumber, 0.0, depths)[:, None]
        expected = (mode * np.exp(1j * wavenumber * x)[:, None]).real
        np.testing.assert_allclose(found, expected, atol=1e-13)  # rounding


def test_slab_is_stiffer_than_the_half_space():
    found = slab_load_area(64, heights=(0.25, 1.0), steps=2, method="active_set")
    assert np.all(found.slab_stiffening > 1.05)
    assert np.all(found.slab_stiffening[0] > found.slab_stiffening[1])


def test_a_wrong_field_is_found(compared):
    found = compared("elements")
    spoiled = found.assign(stress_xx_elements=1.1 * found.stress_xx_elements)
    away = largest_differences(spoiled).difference_away
    assert away.sel(field="stress_xx") > 0.03
    assert away.sel(field="stress_zz") < 0.003


def test_mean_mode_shifts_the_stress_under_a_punch(compared):
    """A confined and a free cell differ from summed contacts by their mean lateral stress."""
    found = compared("punch")
    nu, mean = found.poisson, 2 / 3 * np.pi * float(found.contact_radius) ** 2
    for name, lateral in (("free", 0 * nu), ("confined", nu / (1 - nu))):
        change = (found[f"peak_von_mises_{name}"] - found.peak_von_mises_array) / found.maximum_pressure
        # On the axis von Mises is |σ_xx − σ_zz|.
        np.testing.assert_allclose(change, (0.5 + nu - lateral) * mean, atol=1e-4)
