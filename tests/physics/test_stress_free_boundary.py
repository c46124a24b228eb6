"""Stress under an isolated map against closed forms of single contacts."""

import numpy as np
import pytest

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Grid
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.stress.analysis import analyse_stress
from asperity.stress.peaks.selection import peaks
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.planes import stress_planes

RATIOS = [0.0, 0.3, 0.5]
HALF_SPACE = Layer(young=1.0, poisson=0.3)


def ellipse(a, b, shape, length):
    """Pressure √(1 − x²/a² − y²/b²) about the node in the middle of the map, averaged over each pixel."""
    grid, parts = Grid(shape, length), 16
    within = (np.arange(parts) + 0.5) / parts - 0.5
    y, x = (
        ((np.arange(n) - n // 2)[:, None] + within).ravel() * step
        for n, step in zip(shape, grid.spacing, strict=True)
    )
    pressure = np.sqrt(np.maximum(1 - (y[:, None] / b) ** 2 - (x[None, :] / a) ** 2, 0.0))
    pressure = pressure.reshape(shape[0], parts, shape[1], parts).mean(axis=(1, 3))
    return LoadedSolid(pressure, grid, HALF_SPACE, "free")


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_sphere_at_rest_and_sliding_against_hertz_and_hamilton_and_goodman(friction):
    """All components at every node, at five depths; the error is that of the pixels, of order h²."""
    radius, errors = 0.3, []
    sphere = SlidingSphere(Hertz(radius, curvature_radius=2 / np.pi * radius), friction)
    for points in (48, 96):
        solid = ellipse(radius, radius, (points, points), 1.0)
        y, x = (place - 0.5 for place in solid.grid.coordinates())
        depths = radius * np.array([0.2, 0.5, 1.0, 3.0, 20.0])
        worst = []
        for plane in stress_planes(solid, depths, RATIOS, COMPONENTS, 0, friction=friction):
            expected = [sphere.stress(y[:, None], x[None, :], plane.depth, nu) for nu in RATIOS]
            found = np.stack([plane.fields[name] for name in COMPONENTS], axis=-1)
            worst.append(np.abs(found - expected).max() / np.abs(expected).max())
        errors.append(max(worst))
    assert errors[1] < 3e-3
    assert np.log2(errors[0] / errors[1]) > 1.5


@pytest.mark.parametrize(("ratio", "poisson"), [(0.2, 0.25), (0.5, 0.3), (1.0, 0.3)])
def test_elliptic_contact_largest_stress_on_the_axis_within_two_in_a_thousand(ratio, poisson):
    minor = 0.3
    contact = EllipticHertz(semi_major=minor / ratio, semi_minor=minor, largest_pressure=1.0)
    solid = ellipse(minor / ratio, minor, (64, 64), (0.8, 0.8 / ratio))
    depths = np.linspace(0.3, 1.0, 57) * minor
    names = ("von_mises", "largest_shear")
    planes = list(stress_planes(solid, depths, poisson, names))
    expected = contact.largest_von_mises_on_axis(poisson), contact.largest_shear_on_axis(poisson)
    for name, peak in zip(names, expected, strict=True):
        values = np.array(
            [plane.fields[name][0, plane.grid.shape[0] // 2, plane.grid.shape[1] // 2] for plane in planes]
        )
        assert values.max() == pytest.approx(peak.value, rel=2e-3)
        assert depths[values.argmax()] == pytest.approx(peak.depth, abs=0.02 * minor)


def test_surface_carries_the_pressure_and_the_traction():
    solid = ellipse(0.2, 0.1, (30, 41), (0.5, 1.0))
    plane = next(stress_planes(solid, [0.0], None, COMPONENTS, friction=0.3, sliding_direction="y"))
    np.testing.assert_allclose(plane.fields["zz"][0], -solid.pressure, atol=1e-12)
    np.testing.assert_allclose(plane.fields["yz"][0], 0.3 * solid.pressure, atol=1e-12)
    np.testing.assert_allclose(plane.fields["xz"][0], 0, atol=1e-12)


def test_exchange_of_the_axes_exchanges_the_stress():
    solid = ellipse(0.3, 0.1, (32, 40), (0.5, 1.0))
    solid.pressure[:20] *= 0.3
    other = LoadedSolid(solid.pressure.T, Grid((40, 32), (1.0, 0.5)), HALF_SPACE, "free")
    one = next(stress_planes(solid, [0.07], RATIOS, COMPONENTS, friction=0.4, sliding_direction=25.0))
    two = next(stress_planes(other, [0.07], RATIOS, COMPONENTS, friction=0.4, sliding_direction=65.0))
    for name, exchanged in zip(COMPONENTS, ("yy", "xx", "zz", "xz", "yz", "xy"), strict=True):
        np.testing.assert_allclose(two.fields[exchanged].swapaxes(1, 2), one.fields[name], atol=1e-13)


@pytest.mark.parametrize(("friction", "tolerance"), [(0.0, 1e-6), (0.5, 1e-3)])
def test_coarse_planes_agree_with_full_ones_within_their_bound(friction, tolerance):
    """At the nodes that both grids have, for every field."""
    solid = ellipse(0.3, 0.2, (192, 192), 1.0)
    solid.pressure[:, ::3] *= 0.5
    solid.pressure[:8, -8:] = 1.0
    depths = np.array([0.02, 0.05, 0.1, 0.3, 1.0, 5.0])
    coarse = stress_planes(solid, depths, 0.2, FIELDS, tolerance, friction=friction)
    nodes = []
    for plane, full in zip(
        coarse, stress_planes(solid, depths, 0.2, FIELDS, 0, friction=friction), strict=True
    ):
        nodes.append(plane.grid.shape[0])
        step, fine = (np.lcm(plane.grid.shape[0], 192) // n for n in (192, plane.grid.shape[0]))
        scale = np.abs(full.fields["zz"]).max()
        assert plane.bound <= tolerance * scale
        for name in FIELDS:
            shared = plane.fields[name][0, ::step, ::step] - full.fields[name][0, ::fine, ::fine]
            assert np.abs(shared).max() <= plane.bound + 1e-12
    assert nodes[-1] == 48


def test_peaks_of_a_free_map_are_those_of_the_sphere():
    radius = 0.1
    data = analyse_stress(
        ellipse(radius, radius, (96, 96), 1.0), poisson=0.3, quantities=("von_mises", "largest_shear")
    )
    strongest = data.isel(peak=int(data["peak_value"].values.argmax()))
    assert float(strongest["peak_value"]) == pytest.approx(0.620, rel=0.01)
    assert float(strongest["peak_depth"]) == pytest.approx(0.481 * radius, rel=0.03)
    assert (float(strongest["peak_y"]), float(strongest["peak_x"])) == pytest.approx((0.5, 0.5), abs=1e-3)


def test_nodes_at_opposite_edges_of_a_free_map_are_no_neighbours():
    """Two contacts at opposite edges: both have their peaks, and the higher hides the other in a period."""
    pressure = np.zeros((48, 48))
    pressure[24, 0], pressure[24, 47] = 1.0, 0.8
    grid = Grid(pressure.shape, 1.0)
    found = {
        boundary: analyse_stress(
            LoadedSolid(pressure, grid, HALF_SPACE, boundary),
            poisson=0.3,
            quantities=("pressure", "von_mises"),
        )
        for boundary in ("free", "periodic")
    }
    for quantity in ("pressure", "von_mises"):
        places = {
            boundary: np.sort(peaks(data, quantity, selection="at_contact")["peak_x"].values)
            for boundary, data in found.items()
        }
        assert places["free"][[0, -1]] == pytest.approx([0.0, 47 / 48])
        assert np.abs(places["periodic"] - 47 / 48).min() > 0.01


def test_peaks_of_a_free_map_are_found_across_grids_of_planes():
    """A hundred random contacts: the deep planes are coarse, and coarse planes find the same peaks."""
    draw = np.random.default_rng(3)
    pressure = np.zeros((160, 160))
    pressure[draw.integers(0, 160, 40), draw.integers(0, 160, 40)] = draw.uniform(0.5, 1, 40)
    solid = LoadedSolid(pressure, Grid(pressure.shape, 1.0), HALF_SPACE, "free")
    sets = []
    for tolerance in (0.0, 1e-6):
        data = analyse_stress(solid, poisson=0.3, quantities=("von_mises",), tolerance=tolerance)
        sets.append(np.sort(peaks(data, "von_mises")["peak_value"].values)[-40:])
        coarsest = int(data["plane_points"].min())
    assert coarsest < 160
    np.testing.assert_allclose(sets[1], sets[0], rtol=1e-4)


def test_a_layer_and_an_unknown_boundary_are_refused():
    with pytest.raises(ValueError, match=r"^boundary = 'free': a half-space is needed"):
        LoadedSolid(np.ones((8, 8)), Grid((8, 8)), Layer(1.0, 0.3, 0.5), "free")
    with pytest.raises(ValueError, match=r"^boundary = 'open': one of periodic, free is needed"):
        LoadedSolid(np.ones((8, 8)), Grid((8, 8)), HALF_SPACE, "open")
