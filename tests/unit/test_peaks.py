import itertools

import numpy as np
import pytest

from asperity.fourier.grid import Fourier, Grid, good_size, resample
from asperity.stress.peaks.finder import Peaks, find_peaks, plane_peaks
from asperity.stress.peaks.maxima import refine_in_plane, refine_in_solid
from asperity.stress.planes.planes import StressPlane


def bumps(count, seed=0, widths=(0.05, 0.09), spread=0.12):
    """Separate smooth bumps: their maxima are known and are all there are."""
    draw = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    cells = [(j, i) for j in range(side) for i in range(side)][:count]
    centre = np.array([((j + 0.5) / side, (i + 0.5) / side) for j, i in cells])
    centre += draw.uniform(-spread, spread, centre.shape) / side
    depth = draw.uniform(0.02, 0.5, count)
    width = draw.uniform(*widths, count) / side
    height = draw.uniform(0.5, 2.0, count)
    return centre, depth, width * 2, height


def field_of(grid, z, centre, depth, width, height):
    y, x = grid.coordinates()
    apart_y, apart_x = ((p[None] - c[:, None] + 0.5) % 1 - 0.5 for p, c in zip((y, x), centre.T, strict=True))
    width, depth = np.asarray(width)[:, None], np.asarray(depth)
    tall = 0.4 * np.maximum(depth, 0.1)
    along_y, along_x = (np.exp(np.maximum(-((a / width) ** 2), -100)) for a in (apart_y, apart_x))
    return (height * np.exp(np.maximum(-(((z - depth) / tall) ** 2), -100)) * along_y.T) @ along_x


def planes_of(shapes, depths, *what):
    for shape, z in zip(shapes, depths, strict=True):
        grid = Grid(shape)
        yield StressPlane(z, grid, (0.3,), {"f": field_of(grid, z, *what)[None]}, 0.0)


def stack(values):
    """Planes on one grid, one apart."""
    for k, plane in enumerate(values):
        yield StressPlane(float(k), Grid(plane.shape), (0.3,), {"f": plane[None]}, 0.0)


def by_brute_force(values):
    """Strict maxima of a periodic stack over 26 neighbours; none above the first plane."""
    found = set()
    for k in range(values.shape[0] - 1):
        here = np.abs(values[k])
        largest = np.full(here.shape, -np.inf)
        for dk, dj, di in itertools.product((-1, 0, 1), repeat=3):
            if (dk, dj, di) != (0, 0, 0) and k + dk >= 0:
                largest = np.maximum(largest, np.abs(np.roll(values[k + dk], (dj, di), (0, 1))))
        found |= {(k, int(j), int(i)) for j, i in np.argwhere(here > largest)}
    return found


@pytest.mark.parametrize("shape", [(12, 17), (16, 16), (3, 9)])
def test_maxima_on_one_grid_are_those_of_brute_force(shape):
    values = np.random.default_rng(3).standard_normal((9, *shape))
    peaks = find_peaks(stack(values), "f")
    expected = by_brute_force(values)
    nodes = {value: (k, j, i) for (k, j, i), value in np.ndenumerate(values)}
    assert {nodes[value] for value in peaks.node_value} == expected
    assert peaks.size == len(expected)
    assert {nodes[v][0] > 0 for v in peaks.node_value[peaks.interior]} == {True}
    assert {nodes[v][0] for v in peaks.node_value[~peaks.interior]} == {0}


@pytest.mark.parametrize("edge", [0, 2, 7])
def test_equal_nodes_have_one_peak_at_the_first_of_them(edge):
    """Also across the periodic boundary, where the last row and column come before the first."""
    grid = Grid((8, 8))
    for rows, columns in ((1, 2), (2, 1), (2, 2)):
        field = np.zeros((8, 8))
        field[:rows, :columns] = 1.0
        peaks = plane_peaks(np.roll(field, (edge, edge), (0, 1)), grid)
        middle = ((edge + 0.5 * (nodes - 1)) / 8 for nodes in (rows, columns))
        assert peaks.node_value == pytest.approx([1.0])
        assert (peaks.y, peaks.x) == tuple(pytest.approx([place], abs=0.2 / 8) for place in middle)


def test_a_uniform_plane_has_no_peak_and_a_floor_leaves_out_what_is_below():
    grid = Grid((8, 8))
    field = np.ones((8, 8))
    assert plane_peaks(field, grid).size == 0
    field[:] = 0.0
    field[6, 6] = -0.5
    assert plane_peaks(field, grid).value == pytest.approx([-0.5], abs=1e-12)
    assert plane_peaks(field, grid, floor=0.5).size == 0


@pytest.mark.parametrize("rounding", [0.0, 1e-16, -1e-16])
def test_a_peak_between_equal_nodes_does_not_hang_on_rounding(rounding):
    """A wave with its top halfway between two rows, equal or different by a unit in the last place."""
    grid = Grid((32, 32))
    y, x = grid.coordinates()
    wave = np.cos(2 * np.pi * (y[:, None] + 0.5 / 32)) + np.cos(2 * np.pi * (x - 0.3))
    wave[16:] = wave[15::-1]
    wave[31] *= 1 + 2 * rounding
    peaks = plane_peaks(wave, grid)
    (highest,) = np.flatnonzero(peaks.value > 0)
    assert peaks.value[highest] == pytest.approx(2.0, abs=1e-3)
    distance = (peaks.y[highest] - 31.5 / 32 + 0.5) % 1 - 0.5
    assert distance == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("changes", ["none", "every plane", "a few"])
def test_no_peak_is_lost_or_doubled_where_the_grid_changes(changes):
    count = 49
    what = bumps(count)
    depths = np.linspace(0.0, 1.0, 47) ** 1.3
    if changes == "none":
        sizes = np.full(depths.size, 192)
    elif changes == "every plane":
        sizes = np.array([good_size(int(n)) for n in np.linspace(260, 140, depths.size)])
    else:
        sizes = np.repeat([240, 210, 192, 160], 12)[: depths.size]
    peaks = find_peaks(planes_of([(n, n) for n in sizes], depths, *what), "f", floor=0.1)
    assert peaks.size == count
    distance = np.abs(np.stack([peaks.y, peaks.x], 1)[:, None] - what[0][None])
    owner = np.argmin(np.max(np.minimum(distance, 1 - distance), axis=2), axis=1)
    assert sorted(owner) == list(range(count))
    # Depth grid: the bumps are as little as two spacings tall.
    np.testing.assert_allclose(peaks.value, what[3][owner], rtol=1e-2)
    np.testing.assert_allclose(peaks.depth, what[1][owner], atol=0.2 * np.diff(depths).max())
    np.testing.assert_allclose(np.stack([peaks.y, peaks.x], 1), what[0][owner], atol=0.1 / sizes[-1])


@pytest.mark.parametrize(("before", "after"), [(120, 96), (96, 120)])
def test_a_change_of_grid_among_crowded_maxima_touches_only_the_planes_beside_it(before, after):
    """Random waves whose maxima sit on the very planes where the grid changes."""
    draw = np.random.default_rng(5)
    depths = np.linspace(0.0, 0.5, 26)
    step = depths[1]
    coarsest = Grid((32, 32))
    band = (coarsest.wavenumber() > 4 * 2 * np.pi) & (coarsest.wavenumber() < 10 * 2 * np.pi)
    modes = band * np.exp(2j * np.pi * draw.random(band.shape))
    turn = 2 * np.pi * draw.random(band.shape)

    def field(n, z):
        grid = Grid((n, n))
        return Fourier(grid).inverse(resample(modes * np.cos(9 * z + turn), coarsest, grid))

    fields = {n: [field(n, z) for z in depths] for n in (before, after)}

    def search(sizes):
        return find_peaks(
            (
                StressPlane(z, Grid((n, n)), (0.3,), {"f": fields[n][k][None]}, 0.0)
                for k, (n, z) in enumerate(zip(sizes, depths, strict=True))
            ),
            "f",
        )

    def beside(one, other):
        reach = np.array([1.01 * step, 1.5 / 96, 1.5 / 96])
        first, second = (np.stack([p.depth, p.y, p.x], axis=1) / reach for p in (one, other))
        apart, cell = np.abs(first[:, None] - second[None]), np.array([np.inf, 1, 1]) / reach
        return np.all(np.minimum(apart, cell - apart) < 1, axis=2)

    upper, lower = search([before] * 26), search([after] * 26)
    assert min(upper.size, lower.size) > 150
    lost = claimed = 0
    for change in range(3, 24, 4):
        both = search([before] * change + [after] * (26 - change))
        far = np.concatenate(
            [
                upper.node_value[upper.depth < depths[change - 1] - 0.51 * step],
                lower.node_value[lower.depth > depths[change] + 0.51 * step],
            ]
        )
        assert set(far) <= set(both.node_value)
        sure = beside(upper, lower).any(axis=1)
        lost += np.sum(sure & ~beside(upper, both).any(axis=1))
        claimed += np.sum(~(beside(both, upper).any(axis=1) | beside(both, lower).any(axis=1)))
        assert beside(both, both).sum(axis=1).max() <= max(
            beside(p, p).sum(axis=1).max() for p in (upper, lower)
        )
    # A ridge that drifts sideways has lattice maxima where the field has none: a few come and go.
    assert lost <= 0.002 * 6 * upper.size
    assert claimed <= 0.002 * 6 * upper.size


def test_plane_peaks_are_refined_between_the_nodes():
    grid = Grid((64, 48))
    y, x = grid.coordinates()
    field = np.cos(2 * np.pi * (y - 0.1234))[:, None] + np.cos(2 * np.pi * (x - 0.9871))[None, :]
    peaks = plane_peaks(field, grid)
    np.testing.assert_allclose(peaks.value[0], 2, atol=1e-5)  # grid: the quadratic's
    np.testing.assert_allclose([peaks.y[0], peaks.x[0]], [0.1234, 0.9871], atol=1e-4)
    assert peaks.value[1] == pytest.approx(-2, abs=1e-5)
    assert not peaks.interior.any()


def test_sign_is_kept_and_position_stays_in_the_cell():
    what = np.array([[0.999, 0.002]]), [0.3], [0.2], [-1.0]
    peaks = find_peaks(planes_of([(40, 40)] * 30, np.linspace(0, 0.7, 30), *what), "f")
    assert peaks.value == pytest.approx([-1.0], abs=1e-3)
    assert 0 <= peaks.y[0] < 1
    assert 0 <= peaks.x[0] < 1


def test_under_contact_is_what_lies_below_a_loaded_node():
    grid = Grid((10, 10))
    pressure = np.zeros((10, 10))
    pressure[0, 3] = 1.0
    two = np.array([0.98, 0.5])
    peaks = Peaks(two, two, two, np.array([0.31, 0.31]), two, np.ones(2, bool))
    assert peaks.under_contact(pressure, grid).tolist() == [True, False]


def test_no_planes_have_no_peaks():
    assert find_peaks([], "f").size == 0


def test_only_a_first_plane_at_the_surface_has_peaks():
    what = bumps(9)
    depths = np.linspace(0.0, 1.0, 30)
    planes = list(planes_of([(48, 48)] * depths.size, depths, *what))
    every, below = find_peaks(planes, "f", floor=0.1), find_peaks(planes[4:], "f", floor=0.1)
    deeper = every.depth > depths[4] + 0.5 * depths[1]
    assert 0 < below.size < every.size
    np.testing.assert_array_equal(np.sort(below.value), np.sort(every.value[deeper]))
    assert below.interior.all()


def planes(changes=None):
    grid = Grid((8, 8))
    field = np.random.default_rng(1).random((2, 8, 8)) if changes is None else changes
    return [StressPlane(depth, grid, (0.1, 0.3), {"f": field}, 0.0) for depth in (0.0, 0.1, 0.2)]


def test_peaks_of_a_stream_are_those_of_the_poissons_ratio_asked_for():
    second = [StressPlane(p.depth, p.grid, (0.3,), {"f": p.fields["f"][1:]}, 0.0) for p in planes()]
    np.testing.assert_array_equal(find_peaks(planes(), "f", poisson=0.3).value, find_peaks(second, "f").value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((planes(), "f"), r"poisson: one of 0\.1, 0\.3 is needed"),
        ((planes(), "f", 0.2), r"poisson = 0\.2: one of 0\.1, 0\.3 is needed"),
        ((planes(), "f", 1), r"poisson = 1: one of 0\.1, 0\.3 is needed"),
        ((planes(), "von_mises", 0.1), "name = 'von_mises': one of f is needed"),
        ((planes(), "f", 0.1, -1.0), r"floor = -1\.0: a finite number ≥ 0"),
        ((planes(), "f", 0.1, np.nan), "floor = nan: a finite number ≥ 0"),
        ((planes(np.full((2, 8, 8), np.nan)), "f", 0.1), "field: 64 of 64 nodes are not finite"),
        ((planes(np.ones((2, 8, 9))), "f", 0.1), r"field has the shape \(8, 9\): that of its grid, \(8, 8\)"),
    ],
)
def test_a_search_in_a_stream_names_what_is_there(arguments, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        find_peaks(*arguments)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match=r"^depth = 0\.0: planes rising in depth are needed"):
        find_peaks([planes()[0]] * 2, "f", 0.1)
    with pytest.raises(ValueError, match=r"^field has the shape \(8, 9\)"):
        plane_peaks(np.zeros((8, 9)), Grid((8, 8)))
    with pytest.raises(ValueError, match=r"^grid\.shape = \(2, 9\): at least three nodes"):
        plane_peaks(np.zeros((2, 9)), Grid((2, 9)))
    with pytest.raises(ValueError, match=r"^field: 1 of 64 nodes are not finite"):
        plane_peaks(np.diag([np.inf, *np.zeros(7)]), Grid((8, 8)))
    with pytest.raises(ValueError, match=r"^floor = nan"):
        plane_peaks(np.zeros((8, 8)), Grid((8, 8)), floor=np.nan)


DEPTHS = (0.2, 0.5, 0.7)
UNIT = 0.2  # the smaller distance of the planes


def quadratics(count, axes, seed=0):
    """Heights, places (depth per `UNIT`, y, x) and second derivatives of maxima near the middle node."""
    draw = np.random.default_rng(seed)
    root = draw.standard_normal((count, axes, axes))
    second = -np.einsum("nij,nkj->nik", root, root) - 0.5 * np.eye(axes)
    return draw.uniform(5, 6, count), draw.uniform(-0.4, 0.4, (count, axes)), second


def values_at(offsets, heights, places, second):
    """Values of the quadratics at offsets from the node."""
    away = offsets - places
    return heights + 0.5 * np.einsum("ni,nij,nj->n", away, second, away)


def stencil(heights, places, second, depth=None):
    """Values at 3 × 3 nodes, in the plane at a depth per `UNIT` from the node."""
    out = np.empty((heights.size, 3, 3))
    for row in range(3):
        for column in range(3):
            offset = np.array(
                [row - 1.0, column - 1.0] if depth is None else [depth, row - 1.0, column - 1.0]
            )
            out[:, row, column] = values_at(offset, heights, places, second)
    return out


@pytest.mark.parametrize("sign", [1, -1])
def test_maxima_of_quadratics_in_a_plane_are_exact(sign):
    heights, places, second = quadratics(200, 2)
    value, y, x = refine_in_plane(sign * stencil(heights, places, second))
    np.testing.assert_allclose(value, heights, rtol=1e-12)
    np.testing.assert_allclose(np.stack([y, x], axis=1), places, atol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_maxima_of_quadratics_between_unequal_planes_are_exact(sign):
    heights, places, second = quadratics(200, 3)
    along = (np.array(DEPTHS) - DEPTHS[1]) / UNIT
    planes = [sign * stencil(heights, places, second, depth) for depth in along]
    value, depth, y, x = refine_in_solid(*planes, DEPTHS)
    np.testing.assert_allclose(value, heights, rtol=1e-12)
    np.testing.assert_allclose((depth - DEPTHS[1]) / UNIT, places[:, 0], atol=1e-11)
    np.testing.assert_allclose(np.stack([y, x], axis=1), places[:, 1:], atol=1e-11)


def test_a_saddle_is_refined_along_the_axis_that_gains_most():
    """A maximum along y and x, but not along the diagonal."""
    slope = 0.1
    heights, places = np.array([1.0]), np.zeros((1, 2))
    second = np.array([[[-1.0, 2.0], [2.0, -1.0]]])
    values = stencil(heights, places, second) + slope * np.array([-1.0, 0.0, 1.0])[:, None]
    value, y, x = refine_in_plane(values)
    assert (y, x) == (pytest.approx(slope), 0)
    assert value == pytest.approx(1 + 0.5 * slope**2)


def test_a_step_along_one_axis_is_at_most_half_a_spacing():
    values = np.array([[[0.0, 0, 0], [0, 1.0, 0.99], [0, 2.5, 0]]])
    value, y, x = refine_in_plane(values)
    assert 0 <= max(abs(y[0]), abs(x[0])) <= 0.5
    assert min(abs(y[0]), abs(x[0])) == 0
    assert value >= 1
