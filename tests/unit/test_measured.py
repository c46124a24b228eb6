"""Measured maps: sizes and orientation as read, each way of making them periodic, and refused arguments."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.pipeline.surface import make_surface, moment_errors, read_surface
from asperity.results.dataset import grid_of, read, write
from asperity.spectral import Fourier, Grid, mean_square
from asperity.surface.height_map import HeightMap
from asperity.surface.levelling import edge_step
from asperity.surface.measured import make_periodic
from asperity.surface.reading import read_map

PLAIN = {"detrend": "none", "periodic": "declared"}


def rough(shape=(24, 32), seed=0):
    return np.random.default_rng(seed).normal(size=shape)


def waves(shape, length=(1.0, 1.0)):
    """A smooth periodic map."""
    y, x = Grid(shape, length).coordinates()
    ky, kx = 2 * np.pi / length[0], 2 * np.pi / length[1]
    return np.cos(2 * ky * y[:, None] + 0.3) * np.sin(kx * x[None, :]) + 0.5 * np.cos(3 * kx * x[None, :])


def test_the_lower_face_is_minus_the_map_in_units_of_the_longer_edge():
    height = waves((24, 32), (3.0, 4.0))
    surface = make_periodic(HeightMap(height, (3.0, 4.0)), **PLAIN)
    np.testing.assert_allclose(surface.height, -height / 4.0, atol=1e-15)  # rounding
    assert surface.grid.length == (0.75, 1.0)
    assert surface.wavelength_short == 2 / 32


def test_a_map_that_is_not_stated_to_be_periodic_is_refused_with_a_remedy():
    with pytest.raises(ValueError, match="set periodic to declared, mirrored or windowed"):
        make_periodic(HeightMap(rough(), (1.0, 1.0)), detrend="tilt")
    make_periodic(HeightMap(rough(), (1.0, 1.0), periodic=True), detrend="tilt")


@settings(max_examples=20, deadline=None)
@given(
    ny=st.integers(4, 17),
    nx=st.integers(4, 17),
    slope=st.tuples(*[st.floats(-5, 5)] * 2),
    bend=st.tuples(*[st.floats(-5, 5)] * 3),
)
def test_detrending_removes_its_polynomial_and_nothing_else(ny, nx, slope, bend):
    y, x = np.linspace(-1, 1, ny)[:, None], np.linspace(-1, 1, nx)[None, :]
    plane = 3.0 + slope[0] * y + slope[1] * x
    quadratic = plane + bend[0] * y**2 + bend[1] * x * y + bend[2] * x**2
    own = rough((ny, nx))

    def detrended(height, detrend):
        return make_periodic(HeightMap(height, (ny, nx)), detrend=detrend, periodic="mirrored").height

    for detrend, trend in (("tilt", plane), ("curvature", quadratic)):
        np.testing.assert_allclose(
            detrended(own + trend, detrend), detrended(own, detrend), atol=1e-12
        )  # rounding


def test_a_flat_surface_is_refused():
    plane = np.add.outer(np.arange(8.0), 2 * np.arange(8.0))
    surface = HeightMap(plane, (1.0, 1.0))
    with pytest.raises(ValueError, match="a surface that varies is needed"):
        make_periodic(HeightMap(np.ones((8, 8)), (1.0, 1.0)), **PLAIN)
    assert np.ptp(make_periodic(surface, detrend="none", periodic="mirrored").height) > 1
    residue = make_periodic(HeightMap(plane + 1e-3 * rough((8, 8)), (1.0, 1.0)), "tilt", "mirrored")
    assert np.ptp(residue.height) < 0.01


def test_a_mirrored_map_is_symmetric_and_continuous_at_every_edge():
    height = rough()
    surface = make_periodic(HeightMap(height, (24.0, 32.0)), detrend="none", periodic="mirrored")
    assert surface.grid.shape == (48, 64)
    assert surface.grid.length == (0.75, 1.0)
    whole = surface.height
    np.testing.assert_allclose(whole, whole[::-1], atol=1e-14)  # rounding
    np.testing.assert_allclose(whole, whole[:, ::-1], atol=1e-14)  # rounding
    assert edge_step(whole) < 1e-10
    inside = make_periodic(HeightMap(waves((24, 32)), (24.0, 32.0)), "none", "mirrored").height[:24, :32]
    np.testing.assert_allclose(inside, (waves((24, 32)).mean() - waves((24, 32))) / 64, atol=1e-14)


def test_a_windowed_map_is_level_at_its_edges_and_itself_in_the_middle():
    height = waves((40, 40)) + np.linspace(0, 1, 40)[:, None]
    kept = make_periodic(HeightMap(height, (1.0, 1.0)), detrend="none", periodic="windowed").height
    tapered = kept - kept[0, 0]
    np.testing.assert_allclose(tapered[0], 0, atol=1e-12)  # rounding
    middle = slice(8, 32)
    expected = -(height - height.mean())[middle, middle]
    np.testing.assert_allclose(np.diff(kept[middle, middle]), np.diff(expected), atol=1e-12)  # rounding


def test_the_seam_of_a_declared_period_is_measured():
    assert 0.2 < edge_step(waves((32, 32))) < 2
    sloped = waves((32, 32)) + np.linspace(0, 4, 32)[:, None]
    assert edge_step(sloped) > 5
    assert edge_step(np.ones((4, 4))) == 0


def test_short_waves_are_removed_and_more_points_change_nothing_else():
    surface = HeightMap(rough((32, 32)), (1.0, 1.0))
    smooth = make_periodic(surface, **PLAIN, wavelength_short=0.25)
    coefficients = Fourier(smooth.grid).forward(smooth.height)
    short = smooth.grid.wavenumber() > 2 * np.pi / 0.25 * 1.001
    assert np.abs(coefficients[short]).max() < 1e-15
    finer = make_periodic(surface, **PLAIN, wavelength_short=0.25, points=64)
    np.testing.assert_allclose(finer.height[::2, ::2], smooth.height, atol=1e-14)  # rounding
    assert mean_square(coefficients, smooth.grid) > 0


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"detrend": "slope"}, "detrend = 'slope': one of none, tilt, curvature is needed"),
        ({"periodic": "yes"}, "periodic = 'yes': one of declared, mirrored, windowed is needed"),
        ({"wavelength_short": 0.01}, "wavelength_short = 0.01: a number ≥ 0.0625"),
        ({"wavelength_short": 2.0}, "wavelength_short = 2.0"),
        ({"points": 1}, "points = 1: a whole number from 2 to 65536"),
    ],
)
def test_an_argument_out_of_range_is_named(change, line):
    with pytest.raises(ValueError, match=re.escape(line)):
        make_periodic(HeightMap(rough((32, 32)), (1.0, 1.0)), **{**PLAIN, **change})


def test_undefined_points_are_refused():
    height = rough()
    height[3, 4] = np.nan
    with pytest.raises(ValueError, match="1 points of the map have no data; set undefined to harmonic"):
        make_periodic(HeightMap(height, (1.0, 1.0)), **PLAIN)


@pytest.fixture
def matrix(tmp_path):
    """A text export in the form of Gwyddion: 6 rows and 8 columns of 0.5 µm, heights in nm."""
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "map.asc"
    height = waves((6, 8))
    header = "# Channel: Height\n# Width: 4 µm\n# Height: 3 µm\n# Value units: nm\n"
    path.write_text(header + "\n".join(" ".join(f"{v:.9f}" for v in row) for row in height) + "\n")
    return path, height


def test_a_file_gives_rows_along_y_and_edges_and_heights_in_metres(matrix):
    path, height = matrix
    found = read_map(path)
    assert found.length == pytest.approx((3e-6, 4e-6))
    np.testing.assert_allclose(found.height, 1e-9 * height, atol=1e-18)  # digits in the file
    assert not found.periodic


def test_an_argument_that_contradicts_the_file_is_refused(matrix):
    with pytest.raises(ValueError, match="the file itself says 3000 x 4000 nm"):
        read_map(matrix[0], physical_size=(1.0, 1.0))


def test_a_file_that_is_not_a_map_is_named(tmp_path):
    pytest.importorskip("SurfaceTopography")
    with pytest.raises(ValueError, match="no such file"):
        read_map(tmp_path / "none.x3p")
    wrong = tmp_path / "wrong.x3p"
    wrong.write_bytes(b"\x00\x01 no map")
    with pytest.raises(ValueError, match=r"wrong\.x3p: not a height map that can be read"):
        read_map(wrong)


def test_undefined_points_are_filled_between_their_neighbours():
    pytest.importorskip("SurfaceTopography")
    height = waves((16, 16))
    height[5, 6] = np.nan
    filled = make_periodic(HeightMap(height, (1.0, 1.0)), **PLAIN, undefined="harmonic").height
    around = np.array([filled[4, 6], filled[6, 6], filled[5, 5], filled[5, 7]])
    assert around.min() <= filled[5, 6] <= around.max()


def test_a_measured_surface_becomes_a_result_of_stage_surface(matrix):
    data = read_surface({"file": str(matrix[0]), "detrend": "tilt", "periodic": "mirrored"})
    assert grid_of(data).shape == (12, 16)
    assert grid_of(data).length == pytest.approx((0.75, 1.0))
    assert float(data["height"].std()) == pytest.approx(float(data["rms_height"]))
    assert data.attrs["wavelength_short"] == pytest.approx(2 / 12 * 0.75)
    assert data.attrs["map_periodic"] == "mirrored"
    assert data.attrs["map_cell_length"] == pytest.approx(8e-6)


def test_a_result_of_stage_surface_is_written_with_the_record_of_its_map(matrix, tmp_path):
    parameters = {"file": str(matrix[0]), "detrend": "tilt", "periodic": "mirrored"}
    data = read_surface(parameters)
    write(data, tmp_path / "s.nc", "Surface", {"name": "s", "seed": 0, "surface": parameters})
    assert read(tmp_path / "s.nc").attrs["map_tilt"] == data.attrs["map_tilt"]
    found = read_map(tmp_path / "s.nc")
    assert (found.orientation, found.unit, found.periodic) == ("lower face", None, True)
    np.testing.assert_array_equal(found.as_indenter(), data["height"])


BAND = {"hurst": 0.8, "wavelength_long": 0.25, "wavelength_short": 0.0625, "rms_height": 1e-3}


def test_the_surfaces_of_opposite_gamma_are_mirror_images():
    """S(γ) of a surface is −S(−γ) of the same surface upside down."""
    parameters = {**BAND, "points": 64}
    found = {
        sign: make_surface(
            {**parameters, "johnson": {"gamma": sign * 1.25, "delta": 1.0, "zeta": -4.0, "lam": 8.0}}, 3
        )
        for sign in (1, -1)
    }
    from asperity.surface.johnson import johnson
    from asperity.surface.self_affine import self_affine

    height = self_affine((64, 64), seed=3, **BAND)
    np.testing.assert_allclose(
        johnson(-height, gamma=-1.25, delta=1.0), -johnson(height, gamma=1.25, delta=1.0), atol=1e-17
    )
    assert float(found[1]["skewness"]) > 0.5
    assert float(found[-1]["skewness"]) < -0.5
    for data in found.values():
        assert float(data["rms_height"]) == pytest.approx(1e-3, rel=1e-12)
        np.testing.assert_array_equal(data["spectrum_before"], make_surface(parameters, 3)["spectrum"])


def test_the_errors_of_the_moments_are_the_scatter_of_samples():
    """200 samples give a standard deviation to 5 %; the formula is exact to first order."""
    parameters = {**BAND, "points": 64}
    samples = [make_surface(parameters, seed) for seed in range(200)]
    skewness, kurtosis = moment_errors(Grid((64, 64)), **BAND)
    assert np.std([float(s["skewness"]) for s in samples]) == pytest.approx(skewness, rel=0.3)
    assert np.std([float(s["kurtosis"]) for s in samples]) == pytest.approx(kurtosis, rel=0.35)
    assert abs(np.mean([float(s["kurtosis"]) for s in samples]) - 3) < 0.3
