"""`find_peaks` and `plane_peaks`: every maximum once, on one grid and across grids, refined between nodes."""

import itertools

import numpy as np
import pytest
from samples import refuses

from asperity.core.sizes import good_size
from asperity.fourier.grid import Grid
from asperity.stress.peaks.finder import find_peaks, plane_peaks
from asperity.stress.peaks.maxima import refine_in_plane, refine_in_solid
from asperity.stress.planes.planes import StressPlane


def stack(fields, depths=None):
    """Planes with a field each, one apart by default."""
    for k, field in enumerate(fields):
        yield StressPlane(
            float(k) if depths is None else depths[k], Grid(field.shape), (0.3,), {"f": field[None]}, 0.0
        )


@pytest.mark.parametrize("shape", [(12, 17), (16, 16), (3, 9)])
def test_maxima_on_one_grid_are_all_found(shape):
    """Strict maxima of a periodic stack over 26 neighbours; none above the first plane."""
    values = np.random.default_rng(3).standard_normal((9, *shape))
    size, expected = np.abs(values), set()
    for k in range(8):
        largest = np.full(shape, -np.inf)
        for dk, dj, di in itertools.product((-1, 0, 1), repeat=3):
            if (dk, dj, di) != (0, 0, 0) and k + dk >= 0:
                largest = np.maximum(largest, np.roll(size[k + dk], (dj, di), (0, 1)))
        expected |= {(k, *map(int, node)) for node in np.argwhere(size[k] > largest)}
    peaks = find_peaks(stack(values), "f")
    nodes = {value: node for node, value in np.ndenumerate(values)}
    assert {nodes[value] for value in peaks.node_value} == expected
    assert peaks.size == len(expected)
    assert all((nodes[v][0] > 0) == deep for v, deep in zip(peaks.node_value, peaks.interior, strict=True))


@pytest.mark.parametrize("edge", [0, 2, 7])
def test_equal_nodes_have_one_peak(edge):
    """At the first of them, also across the boundary, where the last row and column come before the first."""
    for rows, columns in ((1, 2), (2, 1), (2, 2)):
        field = np.zeros((8, 8))
        field[:rows, :columns] = 1.0
        peaks = plane_peaks(np.roll(field, (edge, edge), (0, 1)), Grid((8, 8)))
        middle = ((edge + 0.5 * (nodes - 1)) / 8 for nodes in (rows, columns))
        assert peaks.node_value == pytest.approx([1.0])
        assert (peaks.y, peaks.x) == tuple(pytest.approx([place], abs=0.2 / 8) for place in middle)


def test_floor_leaves_out_what_is_below():
    """A uniform plane has no peak; no planes have none."""
    grid, field = Grid((8, 8)), np.zeros((8, 8))
    assert find_peaks([], "f").size == 0
    assert plane_peaks(field + 1, grid).size == 0
    field[6, 6] = -0.5
    assert plane_peaks(field, grid).value == pytest.approx([-0.5], abs=1e-12)
    assert plane_peaks(field, grid, floor=0.5).size == 0


def bumps(count):
    """Places, depths, widths and heights of separate bumps, whose maxima are all there are."""
    draw = np.random.default_rng(0)
    side = int(np.ceil(np.sqrt(count)))
    cells = np.argwhere(np.ones((side, side)))[:count]
    centre = (cells + 0.5 + draw.uniform(-0.12, 0.12, cells.shape)) / side
    depth, width, height = (draw.uniform(*ends, count) for ends in ((0.02, 0.5), (0.1, 0.18), (0.5, 2.0)))
    return centre, depth, width / side, height


def bumps_on(shapes, depths, centre, depth, width, height):
    """Planes through the bumps."""
    for shape, z in zip(shapes, depths, strict=True):
        axes = zip(Grid(shape).coordinates(), np.transpose(centre), strict=True)
        apart = (((place - c[:, None] + 0.5) % 1 - 0.5) / np.array(width)[:, None] for place, c in axes)
        along_y, along_x = (np.exp(np.maximum(-(a**2), -100)) for a in apart)
        tall = (z - np.array(depth)) / (0.4 * np.maximum(depth, 0.1))
        yield (height * np.exp(np.maximum(-(tall**2), -100)) * along_y.T) @ along_x


@pytest.mark.parametrize(
    "sizes",
    [
        np.full(47, 192),
        [good_size(int(n)) for n in np.linspace(260, 140, 47)],
        np.repeat([240, 210, 192, 160], 12)[:47],
    ],
    ids=["one grid", "every plane its own", "four grids"],
)
def test_no_peak_is_lost_or_doubled_between_grids(sizes):
    centre, depth, width, height = bumps(49)
    depths = np.linspace(0.0, 1.0, 47) ** 1.3
    fields = bumps_on([(n, n) for n in sizes], depths, centre, depth, width, height)
    peaks = find_peaks(stack(fields, depths), "f", floor=0.1)
    found = np.stack([peaks.y, peaks.x], 1)
    distance = np.abs(found[:, None] - centre[None])
    owner = np.argmin(np.max(np.minimum(distance, 1 - distance), axis=2), axis=1)
    assert sorted(owner) == list(range(49))
    # Depth grid: the bumps are as little as two spacings tall.
    np.testing.assert_allclose(peaks.value, height[owner], rtol=1e-2)
    np.testing.assert_allclose(peaks.depth, depth[owner], atol=0.2 * np.diff(depths).max())
    np.testing.assert_allclose(found, centre[owner], atol=0.1 / sizes[-1])


def test_plane_peaks_are_refined_between_the_nodes():
    """The grid error is the quadratic's."""
    grid = Grid((64, 48))
    y, x = grid.coordinates()
    field = np.cos(2 * np.pi * (y - 0.1234))[:, None] + np.cos(2 * np.pi * (x - 0.9871))[None, :]
    peaks = plane_peaks(field, grid)
    np.testing.assert_allclose(peaks.value, [2, -2], atol=1e-5)
    np.testing.assert_allclose([peaks.y[0], peaks.x[0]], [0.1234, 0.9871], atol=1e-4)
    assert not peaks.interior.any()


def test_first_plane_below_the_surface_has_none():
    depths = np.linspace(0.0, 1.0, 30)
    planes = list(stack(bumps_on([(48, 48)] * 30, depths, *bumps(9)), depths))
    every, below = find_peaks(planes, "f", floor=0.1), find_peaks(planes[4:], "f", floor=0.1)
    deeper = every.depth > depths[4] + 0.5 * depths[1]
    assert 0 < below.size < every.size
    np.testing.assert_array_equal(np.sort(below.value), np.sort(every.value[deeper]))
    assert below.interior.all()


def two_ratios(field=None):
    """Three planes of two Poisson's ratios."""
    field = np.random.default_rng(1).random((2, 8, 8)) if field is None else field
    return [StressPlane(depth, Grid((8, 8)), (0.1, 0.3), {"f": field}, 0.0) for depth in (0.0, 0.1, 0.2)]


test_wrong_argument_is_refused = refuses(
    (lambda: find_peaks(two_ratios(), "f", 0.2), r"poisson = 0\.2: one of 0\.1, 0\.3 is needed"),
    (lambda: find_peaks(two_ratios(), "von_mises", 0.1), "name = 'von_mises': one of f is needed"),
    (lambda: find_peaks(two_ratios()[:1] * 2, "f", 0.1), r"depth = 0\.0: planes rising in depth are needed"),
    (lambda: find_peaks(two_ratios(np.full((2, 8, 8), np.nan)), "f", 0.1), "field: 64 of 64 nodes are not"),
    (lambda: find_peaks(two_ratios(np.ones((2, 8, 9))), "f", 0.1), r"field has the shape \(8, 9\): \(8, 8\)"),
    (lambda: plane_peaks(np.zeros((2, 9)), Grid((2, 9))), r"grid\.shape = \(2, 9\): at least three nodes"),
    (lambda: plane_peaks(np.zeros((8, 8)), Grid((8, 8)), np.nan), "floor = nan"),
)


DEPTHS = (0.2, 0.5, 0.7)
UNIT = 0.2  # the smaller distance of the planes


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("axes", [2, 3])
def test_maxima_of_quadratics_are_exact(axes, sign):
    """In a plane, and between planes at unequal distances; rounding."""
    draw = np.random.default_rng(0)
    root = draw.standard_normal((200, axes, axes))
    second = -np.einsum("nij,nkj->nik", root, root) - 0.5 * np.eye(axes)
    heights, places = draw.uniform(5, 6, 200), draw.uniform(-0.4, 0.4, (200, axes))
    along = (np.array(DEPTHS) - DEPTHS[1]) / UNIT if axes == 3 else [0.0]
    nodes = np.stack(np.meshgrid(along, [-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1)[..., 3 - axes :]
    away = nodes[None] - places[:, None, None, None]
    values = sign * (
        heights[:, None, None, None] + 0.5 * np.einsum("n...i,nij,n...j->n...", away, second, away)
    )
    if axes == 3:
        value, depth, y, x = refine_in_solid(*np.moveaxis(values, 1, 0), DEPTHS)
        np.testing.assert_allclose((depth - DEPTHS[1]) / UNIT, places[:, 0], atol=1e-11)
    else:
        value, y, x = refine_in_plane(values[:, 0])
    np.testing.assert_allclose(value, heights, rtol=1e-12)
    np.testing.assert_allclose(np.stack([y, x], axis=1), places[:, -2:], atol=1e-11)
