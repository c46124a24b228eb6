"""The stress under a mirrored map is that under the map and its three mirror images."""

import numpy as np
import pytest
from samples import refuses

import asperity as asp
from asperity.fourier.grid import Fourier, Grid, with_mirror_images
from asperity.stress.planes.fields import ODD

pytestmark = pytest.mark.engines

LENGTH = 1.0, 1.2718
SOLIDS = {
    "half-space": asp.Solid(1.0, 0.3),
    "layer": asp.Solid(1.0, 0.3, height=0.2),
    "coating": asp.Solid(1.0, 0.2, height=0.05, base=asp.Solid(0.3, 0.4)),
}
SHAPES = [(24, 31), (40, 40), (13, 48), (3, 4)]
DEPTHS = [0.0, 0.01, 0.03, 0.05, 0.1, 0.15, 0.2]
EVEN_FIELDS = "xx", "yy", "zz", "von_mises", "largest_shear", "principal_1", "hydrostatic"


def pressed(shape, solid, seed=1):
    """A smooth random pressure on a mirrored map, on the map alone and on the cell of four."""
    grid = Grid(shape, LENGTH, mirrored=True)
    fourier = Fourier(grid)
    modes = fourier.forward(np.random.default_rng(seed).normal(size=shape))
    field = fourier.inverse(modes / (1 + (grid.wavenumber() / 20) ** 2.5))
    pressure = np.maximum(field - 0.3 * field.std(), 0.0)
    cell = asp.LoadedSolid(with_mirror_images(pressure, grid), grid.whole_cell, solid)
    return asp.LoadedSolid(pressure, grid, solid), cell


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("tolerance", "bound"), [(0.0, 1e-14), (1e-6, 1e-14), (1e-4, 1e-6)])
def test_planes_are_those_of_the_cell_of_four(shape, solid, tolerance, bound):
    poisson = [0.1, 0.4] if solid.height is None else None
    fields = *EVEN_FIELDS, *ODD
    planes = [
        asp.stress_planes(each, DEPTHS, poisson, fields, tolerance) for each in pressed(shape, solid)
    ]
    for found, expected in zip(*planes, strict=True):
        ny, nx = found.grid.shape
        assert found.grid.whole_cell == expected.grid
        scale = np.abs(expected.fields["zz"]).max()
        for name in fields:
            own, cell = found.fields[name], expected.fields[name]
            if found.grid.shape == shape:
                np.testing.assert_allclose(own, cell[:, :ny, :nx], atol=bound * scale)
            elif name in (*EVEN_FIELDS[:3], "hydrostatic"):
                # Nodes of a coarser grid have other positions. The mean of a component does not depend on them.
                np.testing.assert_allclose(own.mean(), cell.mean(), atol=1e-6 * scale)
                rms = [np.sqrt(np.mean(np.square(field))) for field in (own, cell)]
                np.testing.assert_allclose(*rms, atol=max(10 * tolerance, 1e-6) * scale)


def folded(places, grid):
    """Positions in the cell of four on the map, with those near a mirror line on the line."""
    out = []
    for place, edge, step in zip(places, grid.length, grid.spacing, strict=True):
        distance = (place + step / 2) % (2 * edge)
        distance = np.minimum(distance, 2 * edge - distance)
        distance[distance < 0.7 * step] = 0.0
        distance[distance > edge - 0.7 * step] = edge
        out.append(distance - step / 2)
    return out


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
@pytest.mark.parametrize("shape", SHAPES[:3])
@pytest.mark.parametrize(("tolerance", "bound"), [(1e-6, 1e-8), (1e-4, 1e-5)])
def test_analysis_is_that_of_the_cell_of_four(shape, solid, tolerance, bound):
    own, cell = pressed(shape, solid)
    quantities = "pressure", "von_mises", "xx", "zz", "xz"
    found, expected = (asp.analyse_stress(each, None, None, quantities, tolerance=tolerance) for each in (own, cell))
    np.testing.assert_array_equal(found["plane_depth"], expected["plane_depth"])
    np.testing.assert_array_equal(2 * found["plane_points"], expected["plane_points"])
    np.testing.assert_allclose(found["lag"], expected["lag"], rtol=1e-14)
    np.testing.assert_array_equal(found["reference_depth"], expected["reference_depth"])
    for name, allowed in (("mean_von_mises", 1e-4), ("covariance_plane", bound), ("largest_von_mises", 1e-2)):
        scale = np.abs(expected[name]).max().item()
        np.testing.assert_allclose(found[name], expected[name], atol=allowed * scale)
    for name in quantities:
        peaks, others = (asp.stress.select_peaks(each, name) for each in (found, expected))
        where, around = (
            np.column_stack(
                [
                    each["peak_depth"].values,
                    *folded((each["peak_y"].values, each["peak_x"].values), own.grid),
                    np.abs(each["peak_value"].values) / own.pressure.max(),
                ]
            )
            for each in (peaks, others)
        )
        print(name, len(where), len(around))


test_wrong_argument_is_refused = refuses(
    (lambda: asp.LoadedSolid(np.ones((4, 4)), Grid((4, 4), mirrored=True), SOLIDS["half-space"], "free"),
     "boundary = 'free': a grid that is not mirrored is needed"),
)
