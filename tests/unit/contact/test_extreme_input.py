"""Extreme and wrong arguments: a finite, certified result under the load imposed, or one line of refusal."""

import numpy as np
import pytest
from samples import HALF_SPACE, difference, refuses, rough

import asperity as asp
from asperity.stress import probability_density, stress_box

HUGE = 10**400
"""A whole number beyond floating point."""


def noise(shape=(32, 32)):
    return np.random.default_rng(0).standard_normal(shape)


# Contacts of any scale


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize(("heights", "lengths", "moduli"), [(-200, 0, 0), (200, 100, 0), (0, -180, 200)])
def test_units_by_powers_of_two_change_no_bit(boundary, heights, lengths, moduli):
    """Multiplication by a power of two is exact, also far beyond the range of single precision."""
    height, by = 0.01 * noise(), [2.0**exponent for exponent in (heights, lengths, moduli)]
    settings = {"contact_area_fraction": 0.1, "boundary": boundary}
    one = asp.solve_contact(height, HALF_SPACE, **settings)
    other = asp.solve_contact(height * by[0], asp.Solid(by[2], 0.3), by[1], **settings)
    np.testing.assert_array_equal(other.pressure, one.pressure * (by[0] / by[1] * by[2]))
    np.testing.assert_array_equal(other.gap, one.gap * by[0])
    assert other.approach == one.approach * by[0]
    assert other.certificate.worst == one.certificate.worst


@pytest.mark.parametrize(
    ("height", "settings", "bound"),
    [
        (1e-3 * (noise() + 1000), {"contact_area_fraction": 0.1}, 1e-5),
        (rough((32, 32)), {"contact_area_fraction": 0.01, "method": "gfmd"}, 1e-6),
        (rough((32, 32)), {"contact_area_fraction": 0.1, "method": "gfmd"}, 1e-6),
        (rough(), {"mean_pressure": 1e-3, "rtol": 1e-4}, 1e-3),
        (rough(), {"mean_pressure": 1e-3, "rtol": 1e-4, "boundary": "free"}, 1e-3),
        (rough(), {"mean_pressure": 1e-3, "rtol": 1e-4, "method": "gfmd"}, 1e-3),
    ],
)
def test_single_precision_is_refined_in_double(height, settings, bound):
    """Rounding alone is above the bound: of an offset of 1000 rms heights, or of a contact of 1 %."""
    single, double = (
        asp.solve_contact(height, HALF_SPACE, dtype=d, **settings) for d in ("float32", "float64")
    )
    assert single.pressure.dtype == single.gap.dtype == np.float32
    assert difference(single.pressure, double.pressure) < bound


# An imposed area that the surface does not allow


@pytest.mark.parametrize("method", ["active_set", "gfmd"])
@pytest.mark.parametrize(
    ("height", "fraction"),
    [
        (np.random.default_rng(1).integers(0, 2, (8, 8)), 0.001),
        (np.random.default_rng(1).integers(0, 2, (8, 8)), 0.1),
        (np.zeros((2, 2)), 0.01),
        (np.zeros((2, 2)), 0.99),
        (np.tile(1e-3 * np.arange(8.0), (8, 1)), 0.1),
        (rough(), 1e-4),
    ],
)
def test_smallest_area_is_the_lowest_level(height, fraction, method):
    """Of steps, a flat surface, a tilted plane and a rough surface."""
    contact = asp.solve_contact(height, HALF_SPACE, contact_area_fraction=fraction, method=method)
    contact.certificate.check(1e-4)
    lowest = height == height.min()
    np.testing.assert_array_equal(contact.pressure > 0, lowest)
    assert contact.control_error == pytest.approx(np.mean(lowest) / fraction - 1)
    assert f"(imposed area missed by {100 * contact.control_error:.2g} %)" in repr(contact)


# Arguments


EIGHT = noise((8, 8))


def loaded(size=1.0):
    return asp.LoadedSolid(size * np.random.default_rng(0).random((8, 8)), asp.Grid((8, 8)), HALF_SPACE)


def covering(height):
    return asp.solve_contact(height, HALF_SPACE, contact_area_fraction=0.1)


test_argument_out_of_range_is_refused = refuses(
    (lambda: asp.stress_planes(loaded(), [0.0], fields=[np.zeros(2)]), "fields = array.*: names from xx, yy"),
    (lambda: covering([[HUGE, 1], [1, 2]]), "height = .*: real numbers are neede"),
    (lambda: asp.Body(young=HUGE, poisson=0.3), r"young = 10+\.\.\.: a pressure > 0 with its unit"),
    (lambda: covering(1e80 * EIGHT), "height: numbers from -1e"),
    (lambda: covering(1e-80 * EIGHT), "height: heights that differ by 1e-75"),
    (lambda: asp.surface.with_moments(np.empty((0, 0)), 0.0, 3.0), r"height of shape \(0, 0\): an array"),
    (lambda: next(iter(asp.stress_planes(loaded(1e150), [0.0]))), "pressure: numbers from -1e"),
    (lambda: stress_box(loaded(), [0.0], spacing=5e-324), "spacing = 5e-324: a number of at least 1e-05"),
    (lambda: probability_density(EIGHT, 10, (0.0, 5e-324)), r"limits = \(0.0, 5e-324\): a pair of finit"),
    (lambda: asp.prepare_map(asp.HeightMap(np.ones(8), (1.0, 1.0))), r"height has the shape \(8,\): at"),
    (lambda: asp.analyse_stress(loaded(), friction=1e20), r"friction = 1e\+20: a number from 0 to 1000"),
)


def test_long_narrow_cells_agree_along_both_axes():
    """Rings of wavenumbers without modes are left out: here 16 million of 16 million."""
    pressure = np.random.default_rng(0).random((16, 16))
    long = asp.LoadedSolid(pressure, asp.Grid((16, 16), (1.0, 1e-6)), HALF_SPACE)
    wide = asp.LoadedSolid(pressure.T, asp.Grid((16, 16), (1e-6, 1.0)), HALF_SPACE)
    one, other = (next(iter(asp.stress_planes(solid, [1e-7], fields=["zz"]))) for solid in (long, wide))
    np.testing.assert_allclose(one.fields["zz"][0].T, other.fields["zz"][0], rtol=1e-9)
