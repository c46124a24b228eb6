"""Volume above a limit: closed forms, stress on fine planes, and depths of a smooth contact."""

from itertools import pairwise

import numpy as np
import pytest

import asperity as asp
from asperity.fourier.grid import Fourier, Grid, resample
from asperity.reference.hertz import LineHertz, von_mises
from asperity.stress.exceedance import Exceedance


def filled(planes, limit, largest=np.inf):
    found = Exceedance(limit)
    for plane in planes:
        found.add(*plane)
    found.finish(largest)
    return found


@pytest.mark.parametrize("limit", [0.5, 0.9, 0.99])
def test_ball_between_nodes_and_planes(limit):
    """1 − r²/s² is above L in a ball of s √(1 − L), of 8 to 1 spacings; 16 samples of a box leave 4 %."""
    grid, size, centre = Grid((48, 48)), 12 / 48, np.array([0.513, 0.507, 0.211])
    y, x = grid.coordinates()
    square = (y[:, None] - centre[0]) ** 2 + (x - centre[1]) ** 2
    depths = asp.stress.depth_grid(grid, 0.6)
    found = filled([(z, grid, 1 - (square + (z - centre[2]) ** 2) / size**2) for z in depths], limit)
    radius = size * np.sqrt(1 - limit)
    assert found.volume == pytest.approx(4 / 3 * np.pi * radius**3, rel=0.002 if limit < 0.95 else 0.04)
    assert found.depths == pytest.approx((centre[2] - radius, centre[2] + radius), abs=0.04 * radius)
    assert filled([(z, grid, np.ones(grid.shape)) for z in depths], 0.5).volume == pytest.approx(0.6)


def planes_of(solid, depths):
    planes = asp.stress_planes(solid, depths, tolerance=1e-4)
    return [(plane.depth, plane.grid, plane.fields["von_mises"][0]) for plane in planes]


@pytest.mark.parametrize(("over_yield", "allowed"), [(1.05, 0.12), (1.3, 0.02), (3.0, 0.004)])
def test_rough_contact_against_fine_planes(over_yield, allowed):
    """Counts of nodes on a grid and planes four times finer.

    A relative error of the stress of 0.004 is 1.5 · 0.004/0.05 of the volume of a small ellipsoid.
    """
    height = asp.self_affine((64, 64), 0.8, 0.5, 1 / 8, 1e-3, seed=1)
    solid = asp.LoadedSolid.of(asp.solve_contact(height, asp.Solid(1.0, 0.3), contact_area_fraction=0.2))
    depths, fine = asp.stress.depth_grid(solid.grid, 0.3), Grid((256, 256))
    pressure = Fourier(fine).inverse(resample(Fourier(solid.grid).forward(solid.pressure), solid.grid, fine))
    found = planes_of(solid, depths)
    dense = np.unique(np.concatenate([np.linspace(*pair, 5) for pair in pairwise(depths)]))
    exact = planes_of(asp.LoadedSolid(pressure, fine, solid.layer), dense)
    limit = max(values.max() for *_, values in exact) / over_yield
    volume = np.trapezoid([np.mean(values > limit) for *_, values in exact], dense)
    assert filled(found, limit).volume == pytest.approx(volume, rel=allowed)


def test_nothing_is_above_the_largest_peak():
    """The quadratics of neighbouring nodes differ where their boxes touch."""
    grid = Grid((8, 8))
    values = np.random.default_rng(1).random((5, 8, 8))
    planes = [(0.1 * number, grid, plane) for number, plane in enumerate(values)]
    found = filled(planes, 1.01, largest=1.0)
    assert found.volume == 0
    assert found.depths is None


def test_smooth_roller_yields_where_hertz_says():
    """Half-widths of eight cells; planes 6 % apart below the cell leave 0.1 % of the stress."""
    edge, largest, limit = 48e-6, 1.2e9, 655e6
    wave = 1e-10 * np.cos(6 * np.pi * np.arange(32) / 32)
    surface = asp.HeightMap(wave * wave[:, None] * 1e10, (edge, edge), periodic=True, unit="m")
    body = {"young": 210e9, "poisson": 0.3, "yield_stress": limit}
    load = {"hertz_pressure": largest, "radius_x": 36.54e-3, "radius_y": np.inf}
    answer = asp.run(surface, body, load=load)
    line = LineHertz(answer.case.hertz_contact.half_width_x, largest)
    depth = line.half_width * np.linspace(0, 3, 30_001)
    exact = von_mises(line.stress(0.0, depth, 0.3))
    largest = answer["maximum von Mises stress"]
    assert largest.value == pytest.approx(exact.max(), rel=1e-3)
    assert largest.position.depth == pytest.approx(depth[exact.argmax()], rel=0.06)
    above = depth[exact > limit]
    deepest = answer["maximum depth above yield"]
    first = 1e-6 * float(deepest.note.removeprefix("from a depth of ").removesuffix(" µm"))
    assert (first, deepest.value) == pytest.approx((above[0], above[-1]), rel=0.02)
    volume = answer["volume above yield"].value
    assert volume == pytest.approx((above[-1] - above[0]) * edge**2, rel=0.05)
    shear = np.ptp(line.stress(0.0, depth, 0.3)[:, :3], axis=1) / 2
    assert answer["maximum shear stress (Tresca)"].value == pytest.approx(shear.max(), rel=2e-3)
