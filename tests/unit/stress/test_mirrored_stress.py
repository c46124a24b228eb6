"""The stress under a mirrored map equals the stress under the map and its three mirror images."""

from dataclasses import replace

import numpy as np
import pytest
from samples import refuses

import asperity as asp
from asperity.fourier.grid import Fourier, Grid, with_mirror_images
from asperity.stress.exceedance import Exceedance
from asperity.stress.planes.fields import ODD
from asperity.stress.planes.stream import PlaneStream
from asperity.stress.statistics.extrapolation import OnGrid, numbers_on, reason_against

LENGTH = 1.0, 1.2718
SOLIDS = {
    "half-space": asp.Solid(1.0, 0.3),
    "layer": asp.Solid(1.0, 0.3, height=0.2),
    "coating": asp.Solid(1.0, 0.2, height=0.05, base=asp.Solid(0.3, 0.4)),
}
SHAPES = [(24, 31), (40, 40), (13, 48), (3, 4)]
DEPTHS = [0.0, 0.01, 0.03, 0.05, 0.1, 0.15, 0.2]
EVEN_FIELDS = "xx", "yy", "zz", "von_mises", "maximum_shear", "principal_1", "hydrostatic"


def pressed(shape, solid, seed=1):
    """A smooth random pressure on a mirrored map, on the map alone and on the cell of four."""
    grid = Grid(shape, LENGTH, mirrored=True)
    fourier = Fourier(grid)
    modes = fourier.forward(np.random.default_rng(seed).normal(size=shape))
    field = fourier.inverse(modes / (1 + (grid.wavenumber() / 20) ** 2.5))
    pressure = np.maximum(field - 0.3 * field.std(), 0.0)
    cell = asp.LoadedSolid(with_mirror_images(pressure, grid), grid.whole_cell, solid)
    return asp.LoadedSolid(pressure, grid, solid), cell


@pytest.mark.engines
@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("tolerance", "bound"), [(0.0, 1e-14), (1e-4, 1e-6)])
def test_planes_are_those_of_the_cell_of_four(shape, solid, tolerance, bound):
    poisson = [0.1, 0.4] if solid.height is None else None
    fields = *EVEN_FIELDS, *ODD
    planes = [asp.stress_planes(each, DEPTHS, poisson, fields, tolerance) for each in pressed(shape, solid)]
    for found, expected in zip(*planes, strict=True):
        ny, nx = found.grid.shape
        assert found.grid.whole_cell == expected.grid
        scale = np.abs(expected.fields["zz"]).max()
        for name in fields:
            own, cell = found.fields[name], expected.fields[name]
            if found.grid.shape == shape:
                np.testing.assert_allclose(own, cell[:, :ny, :nx], atol=bound * scale)
            elif name in (*EVEN_FIELDS[:3], "hydrostatic"):
                # Nodes of a coarser grid have other positions, of which means do not depend.
                np.testing.assert_allclose(own.mean(), cell.mean(), atol=1e-6 * scale)
                rms = [np.sqrt(np.mean(np.square(field))) for field in (own, cell)]
                np.testing.assert_allclose(*rms, atol=max(10 * tolerance, 1e-6) * scale)


def peak_table(stress, name, grid, scale):
    """Depth, y, x on the map, and magnitude of peaks, with those near a mirror line on the line."""
    peaks = asp.stress.select_peaks(stress, name)
    places = []
    for axis, edge, step in zip("yx", grid.length, grid.spacing, strict=True):
        distance = (peaks[f"peak_{axis}"].values + step / 2) % (2 * edge)
        distance = np.minimum(distance, 2 * edge - distance)
        distance[distance < 1.6 * step] = 0.0
        distance[distance > edge - 1.6 * step] = edge
        places.append(distance - step / 2)
    return np.column_stack([peaks["peak_depth"], *places, np.abs(peaks["peak_value"]) / scale])


def test_nodes_beyond_the_mirror_lines_are_those_of_the_cell_of_four():
    shape = SHAPES[0]
    streams = [
        PlaneStream(each, DEPTHS[:3], None, ("von_mises",), 0.0)
        for each in pressed(shape, SOLIDS["half-space"])
    ]
    rows, columns = np.arange(-4, shape[0] + 4), np.arange(-3, 5)
    for own, cell in zip(*(stream.planes() for stream in streams), strict=True):
        for name in (*EVEN_FIELDS, *ODD):
            around = own.field_around(name, 0.3, rows, columns)
            expected = cell.field(name, 0.3)[np.ix_(rows % (2 * shape[0]), columns % (2 * shape[1]))]
            np.testing.assert_allclose(around, expected, atol=1e-14 * np.abs(cell.field("zz", 0.3)).max())


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("shape", SHAPES[:3])
@pytest.mark.parametrize(("tolerance", "bound"), [(1e-6, 1e-8), (1e-4, 1e-5)])
def test_analysis_is_that_of_the_cell_of_four(shape, solid, tolerance, bound):
    own, cell = pressed(shape, solid)
    quantities = "pressure", "von_mises", "xx", "zz", "xz"
    found, expected = (
        asp.analyse_stress(each, None, None, quantities, tolerance=tolerance, covariances=True)
        for each in (own, cell)
    )
    np.testing.assert_array_equal(found["plane_depth"], expected["plane_depth"])
    np.testing.assert_array_equal(2 * found["plane_points"], expected["plane_points"])
    np.testing.assert_array_equal(found["reference_depth"], expected["reference_depth"])
    np.testing.assert_allclose(found["lag"], expected["lag"], rtol=1e-14)
    np.testing.assert_allclose(
        found["maximum_von_mises"].max(), expected["maximum_von_mises"].max(), rtol=1e-6
    )
    # Nodes of coarser grids have other positions in the cell of four.
    for name, allowed in (("mean_von_mises", 1e-4), ("covariance_plane", bound), ("covariance_depth", 1e-2)):
        scale = np.abs(expected[name]).max().item()
        np.testing.assert_allclose(found[name], expected[name], atol=allowed * scale)
    for name in quantities:
        peaks, others = (peak_table(each, name, own.grid, own.pressure.max()) for each in (found, expected))
        if not solid.height and not len(others):
            continue
        apart = np.abs(peaks[:, None] - others).max(axis=2)
        assert apart.min(axis=0).max() < 5e-3
        assert apart.min(axis=1).max() < 5e-3
        twice = np.abs(peaks[:, None] - peaks).max(axis=2) + np.eye(len(peaks))
        assert twice.min() > 1e-4  # every peak once, also those on a mirror line


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("shape", SHAPES[:3])
def test_sections_and_boxes_are_those_of_the_cell_of_four(shape, friction):
    chosen = {"depths": DEPTHS, "fields": (*EVEN_FIELDS, *ODD), "friction": friction}
    pair = pressed(shape, SOLIDS["half-space"])
    found, expected = (asp.stress_section(each, "y", 0.42, **chosen) for each in pair)
    boxes = [
        asp.stress.stress_box(each, y=(0, 1), x=(0.1, 1.2), spacing=0.07, **chosen).dataset() for each in pair
    ]
    for own, cell in ((found, expected), boxes):
        for name in chosen["fields"]:
            whole = cell[name].isel(y=slice(own.sizes["y"]))
            np.testing.assert_allclose(own[name], whole, atol=1e-5 * np.abs(cell["zz"]).max().item())


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
def test_friction_is_that_of_the_cell_of_four_on_the_map(solid):
    own, cell = pressed((24, 31), solid)
    chosen = {"friction": 0.3, "sliding_direction": 30.0}
    for found, expected in zip(
        *(asp.stress_planes(each, DEPTHS, **chosen) for each in (own, cell)), strict=True
    ):
        ny, nx = found.grid.shape
        assert found.grid.coordinates()[0][-1] < own.grid.length[0]
        np.testing.assert_array_equal(found.fields["von_mises"], expected.fields["von_mises"][:, :ny, :nx])
    found, expected = (asp.analyse_stress(each, DEPTHS, **chosen, covariances=True) for each in (own, cell))
    for name in ("mean_von_mises", "maximum_von_mises", "covariance_depth", "covariance_plane"):
        np.testing.assert_array_equal(found[name], expected[name])
    np.testing.assert_array_equal(found["peak_value"], expected["peak_value"])
    assert (found["peak_weight"] == 0.25).all()
    for axis, edge in zip("yx", LENGTH, strict=True):
        place, on_map = expected[f"peak_{axis}"].values, found[f"peak_{axis}"].values
        assert ((on_map >= 0) & (on_map < edge)).all()
        step = edge / own.grid.shape[axis == "x"]
        folded = np.abs((place + step / 2 + edge) % (2 * edge) - edge) - step / 2
        np.testing.assert_allclose(on_map, np.maximum(folded, 0), atol=1e-12)


@pytest.mark.parametrize(("middle", "share"), [(0.5, 0.5), (1.0, 0.25)])
def test_peak_on_a_mirror_line_is_found_under_friction_and_counts_in_part(middle, share):
    """A ball whose summit lies on the line x = 1; sliding moves its peak to the image beyond the line."""
    nodes = 48
    y, x = (np.mgrid[:nodes, :nodes] + 0.5) / nodes
    grid, ball = Grid((nodes, nodes), mirrored=True), ((y - middle) ** 2 + (1 - x) ** 2) / 10
    contact = asp.solve_contact(ball, SOLIDS["half-space"], grid, mean_pressure=2e-4)
    without, under = (
        asp.analyse_stress(contact, quantities=("pressure", "von_mises"), friction=friction)
        for friction in (0.0, 0.05)
    )
    for name in ("pressure", "von_mises"):
        peaks = asp.stress.select_peaks(without, name)
        assert peaks["peak_weight"].values == [share]
        sliding = asp.stress.select_peaks(under, name)
        high = sliding.isel(peak=np.flatnonzero(sliding["peak_value"] > 0.1 * peaks["peak_value"].item()))
        assert high["peak_weight"].sum() == share
        np.testing.assert_allclose(high["peak_value"], peaks["peak_value"].item(), rtol=0.01)
    assert high["peak_on_image"].all()
    assert (high["peak_x"] < peaks["peak_x"].item()).all()


def test_background_of_shear_is_added_in_the_cell_of_four():
    own, cell = pressed((16, 20), SOLIDS["half-space"])
    for shear, whole in ((0.0, False), (0.1, True)):
        background = lambda depth: np.array([0.1, 0.2, 0.3, 0.0, shear, 0.0])  # noqa: B023, E731
        pair = (replace(each, background=background) for each in (own, cell))
        found, expected = (next(asp.stress_planes(each, [0.01], fields=("xx", "xz"))) for each in pair)
        assert found.grid.mirrored is not whole
        for name, field in found.fields.items():
            np.testing.assert_allclose(field, expected.fields[name][:, :16, :20], atol=1e-14)


@pytest.mark.parametrize("direction", ["x", "y"])
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_cycles_are_those_of_the_cell_of_four(direction, friction):
    settings = {
        "fatigue_torsion": 1.0,
        "fatigue_bending": 1.5,
        "yield_stress": 1.0,
        "sliding_direction": direction,
    }
    found, expected = (
        asp.stress.stress_cycles(each, [0.0, 0.02, 0.1], friction=friction, **settings)
        for each in pressed((24, 31), SOLIDS["half-space"])
    )
    for name in ("shear_range", "dang_van", "shakedown_upper", "shakedown_line", "shakedown_lower"):
        rows = found[name].shape[1]
        assert rows == (31 if direction == "y" else 24)
        np.testing.assert_allclose(found[name], expected[name][:, :rows], rtol=0.02)


def test_numbers_of_the_extrapolation_are_those_of_the_cell_of_four():
    own, cell = pressed((24, 31), SOLIDS["half-space"])
    height = own.pressure - 0.2 * np.cos(np.arange(24))[:, None]
    found, expected = (
        numbers_on(OnGrid(each.pressure, 1.0, 0.1, each.grid, height=with_mirror_images(height, grid)))
        for each, grid in ((own, Grid((24, 31))), (cell, own.grid))
    )
    for name in set(found.variables) - {"spacing", "pressure_quantile"}:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, atol=1e-14)
    assert reason_against(own.pressure, height, mirrored=True) == reason_against(
        cell.pressure, with_mirror_images(height, own.grid)
    )


def test_volume_above_a_limit_is_that_of_the_cell_of_four():
    volumes = []
    for each in pressed((40, 40), SOLIDS["half-space"]):
        limit = 0.2 * each.pressure.max()
        exceedance = Exceedance(limit)
        for plane in asp.stress_planes(each, np.linspace(0, 0.2, 21)):
            exceedance.add(plane.depth, plane.grid, plane.fields["von_mises"][0])
        exceedance.finish(np.inf)
        volumes.append(exceedance.volume)
    np.testing.assert_allclose(volumes[0], volumes[1], rtol=2e-3)


test_wrong_argument_is_refused = refuses(
    (
        lambda: asp.LoadedSolid(np.ones((4, 4)), Grid((4, 4), mirrored=True), SOLIDS["half-space"], "free"),
        "boundary = 'free': a grid without mirror images is needed",
    )
)
