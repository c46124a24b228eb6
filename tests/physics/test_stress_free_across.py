"""Stress under pressures that repeat along one axis and end along the other one, such as a roller's."""

import numpy as np
import pytest
from samples import HALF_SPACE, centred, difference, rough

import asperity as asp
from asperity.elasticity.loaded_rectangle import with_images
from asperity.elasticity.solid import COMPONENTS
from asperity.reference.hertz import LineHertz
from asperity.stress.planes.free_boundary import rectangle_stress

BOUNDARY = {"y": ("periodic", "free"), "x": ("free", "periodic")}
"""Axis along which a map repeats → boundary."""


@pytest.mark.parametrize("component", COMPONENTS)
@pytest.mark.parametrize("loaded", ["z", "x", "y"])
@pytest.mark.parametrize(
    ("free", "period"), [((False, True), 1.0), ((True, False), 0.4), ((False, True), 5.0)]
)
def test_influence_is_the_sum_over_images(component, loaded, free, period):
    """Images summed one by one; the rest is of order 1/N, and extrapolated to 1e-11 or so."""
    grid = asp.Grid((6, 9), (period, 1.3)) if free[1] else asp.Grid((9, 6), (1.3, period))
    axis = free.index(False)

    def influence(y, x, edges):
        constant, slope = rectangle_stress(component, loaded, y, x, depth, edges)
        return constant + 0.3 * slope

    def part(y, x, count):
        images = period * np.arange(-count, count + 1)
        y, x = (y + images, np.array([x])) if axis == 0 else (np.array([y]), x + images)
        return influence(y, x, grid.spacing).sum()

    for depth in (0.05, 2.0):
        y, x = grid.coordinates()
        found = with_images(influence, y, x, grid, free, far=depth)
        for j, i in ((0, 0), (2, 3), (5, 4)):
            counts = 500 * 2 ** np.arange(6)
            powers = (counts[0] / (counts + 0.5)[:, None]) ** np.arange(6)
            exact = np.linalg.solve(powers, [part(y[j], x[i], count) for count in counts])[0]
            assert found[j, i] == pytest.approx(exact, abs=1e-10)


def strip(points, rows, length, axis="y", half_width=0.3, parts=16):
    """Hertz's pressure on a strip, averaged over each pixel, and places across."""
    places = np.arange(points) - points // 2
    within = (places[:, None] + (np.arange(parts) + 0.5) / parts - 0.5) / points
    pressure = np.tile(np.sqrt(np.maximum(1 - (within / half_width) ** 2, 0)).mean(axis=1), (rows, 1))
    grid = asp.Grid((rows, points), (length, 1.0))
    if axis == "x":
        pressure, grid = pressure.T, asp.Grid((points, rows), (1.0, length))
    return asp.LoadedSolid(pressure, grid, HALF_SPACE, BOUNDARY[axis]), places / points


@pytest.mark.parametrize(("rows", "length"), [(1, 1.0), (8, 0.3), (48, 7.0)])
@pytest.mark.parametrize("direction", [None, "x", "y"])
def test_strip_has_the_stress_of_a_line_contact(rows, length, direction):
    """All components against the closed form, for every length of the cell; error of the pixels, order h²."""
    exact, ratios = LineHertz(0.3, 1.0), [0.0, 0.3, 0.5]
    solid, x = strip(64, rows, length)
    sliding = {} if direction is None else {"friction": 0.3, "sliding_direction": direction}
    traction = {None: (0, 0), "x": (0.3, 0), "y": (0, 0.3)}[direction]
    for plane in asp.stress_planes(solid, 0.3 * np.array([0.2, 1, 3, 20]), ratios, COMPONENTS, 0, **sliding):
        expected = np.stack([exact.stress(x, plane.depth, nu, traction) for nu in ratios])
        found = np.stack([plane.fields[name] for name in COMPONENTS], axis=-1)
        np.testing.assert_allclose(found, np.broadcast_to(expected[:, None], found.shape), atol=3e-3)


@pytest.mark.parametrize("axis", ["y", "x"])
def test_largest_stresses_of_a_line_contact(axis):
    """Von Mises 0.558 p0 at 0.704 b, largest shear 0.300 p0 at 0.786 b (ν = 0.3), of the solved contact."""
    load, exact = 5e-2, LineHertz.from_load(5e-2, 2.0, HALF_SPACE.effective_modulus)
    grid = asp.Grid((8, 128), (0.3, 1.0))
    height = np.tile(centred(grid)[1] ** 2 / 4, (8, 1))
    if axis == "x":
        height, grid = height.T, asp.Grid((128, 8), (1.0, 0.3))
    contact = asp.solve_contact(height, HALF_SPACE, grid, force=0.3 * load, boundary=BOUNDARY[axis])
    depths, names = np.linspace(0.65, 0.85, 21) * exact.half_width, ("von_mises", "maximum_shear")
    planes = list(asp.stress_planes(contact, depths, fields=names, tolerance=0))
    for name, value, depth in (("von_mises", 0.5577, 0.7042), ("maximum_shear", 0.3003, 0.7861)):
        largest = np.array([plane.fields[name].max() for plane in planes])
        assert largest.max() / exact.maximum_pressure == pytest.approx(value, rel=2e-3)
        assert depths[largest.argmax()] / exact.half_width == pytest.approx(depth, abs=0.01)
    if axis == "y":
        found = asp.stress_section(contact, "x", fields=("von_mises",))["von_mises"]
    else:
        found = asp.analyse_stress(contact, quantities=["von_mises"])["maximum_von_mises"]
    assert float(found.max()) / exact.maximum_pressure == pytest.approx(0.558, rel=0.01)


def test_mirrored_along_the_axis_is_the_doubled_cell():
    """Planes, peaks and a section; without friction no peak is listed twice."""
    shape, grid = (24, 32), asp.Grid((24, 32), (0.75, 1.0), mirrored=True)
    height = 3 * rough(shape) + centred(grid)[1] ** 2
    contact = asp.solve_contact(height, HALF_SPACE, grid, mean_pressure=4e-3, boundary=BOUNDARY["y"])
    doubled = np.concatenate([contact.pressure, contact.pressure[::-1]])
    whole = asp.LoadedSolid(doubled, asp.Grid((48, 32), (1.5, 1.0)), HALF_SPACE, "free along x")
    for friction in (0.0, 0.4):
        options = {"friction": friction, "sliding_direction": "y", "tolerance": 0}
        depths = [0.0, 0.02, 0.1, 0.5]
        for plane, other in zip(
            *(asp.stress_planes(each, depths, **options) for each in (contact, whole)), strict=True
        ):
            assert plane.grid.length == (0.75, 1.0)
            assert difference(plane.fields["von_mises"][0], other.fields["von_mises"][0, :24]) < 1e-12
        options = options | {
            "depths": np.linspace(0, 0.2, 11),
            "quantities": ["von_mises"],
            "tolerance": 1e-4,
        }
        one, two = (asp.analyse_stress(each, **options) for each in (contact, whole))
        found, expected = (each["peak_value"][each["peak_quantity"] == "von_mises"] for each in (one, two))
        assert found.max() == pytest.approx(float(expected.max()), rel=1e-9)
        weight = one["peak_weight"][one["peak_quantity"] == "von_mises"]
        assert 2 * float(weight.sum()) == pytest.approx(expected.size, abs=1)
        assert found.size == pytest.approx(expected.size / (1 if friction else 2), abs=4)
        assert one["peak_y"].max() <= 0.75
    section = asp.stress_section(contact, "y", at=0.5, depths=[0.1])
    assert section.sizes["y"] == 24


def test_nodes_at_opposite_edges_are_neighbours_along_the_axis_alone():
    pressure, grid = np.zeros((48, 48)), asp.Grid((48, 48))
    pressure[24, 0], pressure[24, 47], pressure[0, 24], pressure[47, 24] = 1.0, 0.8, 1.0, 0.8
    stress = asp.analyse_stress(
        asp.LoadedSolid(pressure, grid, HALF_SPACE, BOUNDARY["y"]), quantities=("pressure", "von_mises")
    )
    for name in ("pressure", "von_mises"):
        peaks = asp.stress.select_peaks(stress, name, selection="at_contact")
        assert np.abs(peaks["peak_x"] - 47 / 48).min() < 1e-9
        assert np.abs(peaks["peak_y"] - 47 / 48).min() > 0.01


def test_cycles_are_unloaded_where_the_map_ends():
    """A point that a strip passes across is unloaded; one that moves along the strip has no cycle."""
    solid = strip(64, 16, 0.5)[0]
    limits = {"fatigue_torsion": 0.3, "fatigue_bending": 0.5, "depths": [0.1]}
    across, along = (asp.stress.stress_cycles(solid, sliding_direction=each, **limits) for each in ("x", "y"))
    assert float(across["shear_range"].max()) > 0.1
    assert float(along["shear_range"].max()) < 1e-9
