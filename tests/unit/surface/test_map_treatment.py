"""Treatment of maps: spikes, gaps, levels, ways to a period, waves in metres, and the record of all of it."""

import numpy as np
import pytest
from samples import HALF_SPACE, refuses

from asperity.contact.solve import solve_contact
from asperity.engineering.face import read_face
from asperity.fourier.grid import Fourier, Grid, with_mirror_images
from asperity.results.dataset import grid_of, read, write
from asperity.settings.map import CounterMap, Map
from asperity.stress.analysis import analyse_stress
from asperity.stress.planes.planes import depth_grid, stress_planes
from asperity.study.stages.surface import read_surface
from asperity.surface.heights import johnson
from asperity.surface.reading.height_map import HeightMap, MapOptions
from asperity.surface.reading.map_file import read_map
from asperity.surface.self_affine import self_affine
from asperity.surface.treatment import levelling
from asperity.surface.treatment.treatment import DESPIKE, make_periodic, treat_map

EDGE = 256e-6


def steel(points=64, hurst=0.8, seed=1):
    """A part of a self-affine surface, so that it is not periodic, on 4 µm pixels."""
    band = {"hurst": hurst, "wavelength_long": 0.25, "wavelength_short": 0.03, "rms_height": 1e-3}
    return EDGE * self_affine((2 * points, 2 * points), seed=seed, **band)[:points, :points]


def as_map(height, **said):
    return HeightMap(height, (EDGE, EDGE), unit="m", **said)


@pytest.mark.parametrize(
    "height",
    [
        *(
            self_affine((512, 512), h, 0.25, short, 1e-3, 2)
            for h, short in ((0.2, 0.03), (0.5, 0.004), (0.9, 0.03))
        ),
        np.round(steel() / 2e-7),  # half of the points equal their neighbours
        np.zeros((16, 16)),
    ],
    ids=["hurst 0.2", "hurst 0.5", "hurst 0.9", "quantised", "flat"],
)
def test_surfaces_without_spikes(height):
    assert not levelling.find_spikes(height, DESPIKE).any()


def test_spikes_are_found_and_scratches_stay():
    height = steel()
    spots = [(5, 5), (5, 6), (30, 40), (0, 63), (63, 20), (31, 25)]
    spiky = height.copy()
    for spot in spots:
        spiky[spot] += 20 * height.std()
    spiky[40, :] -= 20 * height.std()  # a scratch across the map
    spiky[10:20, 50:60] += 20 * height.std()  # a particle
    spiky[20:30, 20:30] = np.nan  # a gap beside a spike
    found = levelling.find_spikes(spiky, DESPIKE)
    assert {(int(i), int(j)) for i, j in np.argwhere(found)} == set(spots)


def test_a_plane_has_its_slope_and_edge_step():
    y, x = np.mgrid[:20, :30].astype(float)
    left, slope, bow = levelling.subtract_trend(3e-3 * x - 1e-3 * y, "tilt", (20.0, 30.0))
    assert slope == pytest.approx((-1e-3, 3e-3), rel=1e-12)
    assert (np.abs(left).max(), bow) == pytest.approx((0, 0), abs=1e-15)
    # The step is 29 at 20 of the 50 points on the edges, and 1 between 20 · 29 of 20 · 29 + 19 · 30 pairs.
    assert levelling.edge_step(x) == pytest.approx(29 * np.sqrt(20 / 50) / np.sqrt(580 / 1150))


@pytest.mark.parametrize("detrend", ["tilt", "curvature"])
def test_the_trend_is_that_of_measured_points(detrend):
    """Waves with a tilt of 0.5°, a corner missing, by least squares of all other points.

    A trend of the filled map is 0.447°, and leaves an rms height of 405 nm.
    """
    y, x = np.mgrid[:200, :200] * 5e-6
    waves = 4e-7 * np.sin(x / 2e-5) * np.sin(y / 2e-5)
    height = waves + np.tan(np.radians(0.5)) * (x + y) / np.sqrt(2)
    height[x + y > 1.5e-3] = np.nan
    known = np.isfinite(height)
    treated = treat_map(
        HeightMap(height, (1e-3, 1e-3), unit="m"), periodic="none", undefined="harmonic", detrend=detrend
    )
    terms = [np.ones_like(x), x, y, *([x * x, x * y, y * y] if detrend == "curvature" else [])]
    matrix = np.stack([1e3 * term[known] for term in terms], axis=1)
    left = height[known] - matrix @ np.linalg.lstsq(matrix, height[known])[0]
    found = -treated.height[known]
    np.testing.assert_allclose(found - found.mean(), left - left.mean(), atol=1e-15)
    assert found.std() == pytest.approx(2e-7, rel=2e-3)  # the part of the waves that looks like a tilt
    assert np.degrees(treated.treatment.tilt) == pytest.approx(0.5, abs=2e-3 if detrend == "tilt" else 0.02)


def test_a_period_keeps_its_waves():
    """sin x + sin y has a least-squares plane, without which its rms height is 62.7 instead of 100 nm."""
    phase = 2 * np.pi * np.arange(64) / 64
    waves = 1e-7 * (np.sin(phase)[None] + np.sin(phase)[:, None])
    of_file = HeightMap(waves, (1e-3, 1e-3), periodic=True, unit="m")
    for surface, given in (
        (of_file, {}),
        (of_file, {"detrend": "none"}),
        (as_map(waves), {"periodic": "declared"}),
    ):
        treated = treat_map(surface, **given)
        np.testing.assert_allclose(treated.height, -waves, atol=1e-20)
        assert (treated.treatment.tilt, treated.height.std()) == (0, pytest.approx(1e-7))
        assert "levelled: mean height removed, a period has no tilt" in treated.done
    levelled = treat_map(as_map(waves), periodic="declared", detrend="tilt")
    assert "removed, with a step at the edges of the period" in levelled.done[1]
    assert levelled.height.std() == pytest.approx(62.7e-9, rel=1e-3)
    assert treat_map(of_file, periodic="mirrored").treatment.tilt > 0


def test_periodic_maps_face_to_face_keep_their_waves():
    waves = self_affine((32, 32), 0.8, 0.5, 0.1, rms_height=1e-7, seed=1)
    surface = HeightMap(waves, (1e-4, 1e-4), periodic=True, unit="m")
    flat = HeightMap(waves[::-1], (1e-4, 1e-4), periodic=True, unit="m")
    face = read_face(Map(file=surface), CounterMap(file=flat)).face
    np.testing.assert_allclose(face.height, -waves - waves[::-1, ::-1], atol=1e-20)


def test_a_gap_is_filled_by_a_harmonic_function():
    y, x = np.mgrid[:20, :24].astype(float)
    harmonic = x**2 - y**2 + 3 * x * y  # also harmonic for differences between neighbours
    missing = np.zeros(harmonic.shape, bool)
    missing[5:9, 6:12] = missing[15, 3] = True
    filled = levelling.fill_harmonic(np.where(missing, np.nan, harmonic), missing)
    np.testing.assert_allclose(filled, harmonic, atol=1e-9)  # rounding of a linear solve


def test_the_record_says_what_was_done():
    height = steel()
    y, x = (np.arange(64) + 0.5)[:, None] / 64, (np.arange(64) + 0.5)[None, :] / 64
    bow = 3e-6 * (2 * x - 1) ** 2
    tilted = height + EDGE * (0.03 * x - 0.04 * y) + bow
    tilted[10, 11] += 1e-4
    tilted[50:52, 7] = np.nan
    options = MapOptions(detrend="curvature", periodic="windowed", undefined="harmonic", despike=DESPIKE)
    treated = treat_map(as_map(tilted), options, wavelength_short="20 um", points=32)
    record = treated.treatment
    assert (record.missing, record.spikes) == (2, 1)
    assert record.filled_fraction == 3 / 64**2
    own = np.polyfit(x[0], height.mean(axis=0), 1)[0], np.polyfit(y[:, 0], height.mean(axis=1), 1)[0]
    slope = np.hypot(0.03 + own[0] / EDGE, -0.04 + own[1] / EDGE)
    assert np.tan(record.tilt) == pytest.approx(slope, rel=0.02)  # the filled points
    assert record.bow == pytest.approx(np.ptp(bow), rel=0.3)  # the curvature of the roughness itself
    assert record.altered_fraction == pytest.approx(1 - 0.8**2, abs=0.03)  # nodes at the ends of the taper
    assert (treated.grid.shape, treated.grid.length) == ((32, 32), (EDGE, EDGE))
    text = "\n".join(treated.done)
    for words in ("turned upside down", "1 point (0.024 %) beyond 8", "2 points (0.049 %)", "tilt of 2."):
        assert words in text
    for words in ("% of the area", "waves shorter than 20 µm", "resampled to 32 x 32"):
        assert words in text


@pytest.mark.parametrize("periodic", ["declared", "mirrored", "windowed", "none"])
def test_a_wavelength_does_not_depend_on_the_period(periodic):
    """A wave of 16 µm is kept by a limit of 15 µm and removed by one of 17 µm, mirrored or not."""
    x = (np.arange(64) + 0.5) * 4e-6
    long, short = np.cos(2 * np.pi * x / 64e-6), np.cos(2 * np.pi * x / 16e-6)
    surface = as_map(np.ones((64, 1)) * (long + 0.1 * short)[None, :])
    middle = slice(16, 48)
    # The window spreads each wave over its neighbours.
    for limit, share in ((15e-6, 0.1), (17e-6, 0.0)):
        treated = treat_map(surface, detrend="none", periodic=periodic, wavelength_short=limit)
        profile = -treated.height[32, middle]
        both = np.column_stack([long[middle], short[middle], np.ones(32)])
        fit, *_ = np.linalg.lstsq(both, profile, rcond=None)
        assert fit[:2] == pytest.approx([1.0, share], abs=0.01 if periodic == "windowed" else 1e-12)


def test_a_bounded_map_keeps_its_edges():
    height = steel() + np.linspace(0, 1e-5, 64)[:, None]
    treated = treat_map(as_map(height), detrend="none", periodic="none")
    np.testing.assert_allclose(treated.height, height.mean() - height, atol=1e-18)
    grid, finer = (Grid(shape, (EDGE, EDGE), mirrored=True) for shape in ((64, 64), (128, 192)))
    fine = levelling.low_pass(height, grid, finer, None)
    again = levelling.low_pass(fine, finer, grid, None)
    np.testing.assert_allclose(again, height - height.mean(), atol=1e-18)
    step = np.abs(fine[-1] - fine[0]).mean()
    assert step == pytest.approx(np.abs(height[-1] - height[0]).mean(), rel=0.02)


PLAIN = {"detrend": "none", "periodic": "declared"}


def made(**changes):
    return make_periodic(HeightMap(rough((32, 32)), (1.0, 1.0)), **PLAIN | changes)


def treated(**changes):
    return treat_map(as_map(steel()), **{"periodic": "mirrored"} | changes)


test_wrong_option_is_refused = refuses(
    (lambda: made(detrend="slope"), "detrend = 'slope': none or tilt or curvature is needed"),
    (lambda: made(periodic="none"), "periodic = 'none': one of declared, mirrored, windowed is needed"),
    (lambda: made(periodic=None), ".*set it to declared, mirrored or windowed"),
    (lambda: made(wavelength_short=0.01), r"wavelength_short = 0\.01: a number ≥ 0\.0625"),
    (lambda: made(wavelength_short="8 um"), "unit: the file does not say the unit"),
    (lambda: made(points=1), "points = 1: a whole number ≥ 2 and ≤ 65536"),
    (lambda: made(points=65, periodic="mirrored"), "points = 65: an even number ≥ 4 is needed on the cell o"),
    (lambda: made(despike=1.0), r"despike = 1\.0: a number ≥ 3"),
    (
        lambda: treat_map(HeightMap(rough(), (1.0, 1.0), periodic=True), detrend="tilt"),
        "detrend = 'tilt': the file states that the map is one period, which has no trend; leave it out, ",
    ),
    (lambda: treated(radius="1 kg"), "radius = '1 kg': a length > 0 with its unit"),
    (lambda: treated(wavelength_short=1e-6), r"wavelength_short = 1 µm: a number ≥ 8 µm \(two nodes\), ≤ 51"),
    (lambda: HeightMap(np.ones((1, 8)), (1.0, 1.0)), r"height has the shape \(1, 8\): at least 2 x 2 points"),
    (lambda: make_periodic(HeightMap(np.ones((8, 8)), (1.0, 1.0)), **PLAIN), ".*a surface that varies is ne"),
)


def rough(shape=(24, 32), seed=0):
    return np.random.default_rng(seed).normal(size=shape)


def waves(shape, length=(1.0, 1.0)):
    """A smooth periodic map."""
    y, x = Grid(shape, length).coordinates()
    ky, kx = 2 * np.pi / length[0], 2 * np.pi / length[1]
    return np.cos(2 * ky * y[:, None] + 0.3) * np.sin(kx * x[None, :]) + 0.5 * np.cos(3 * kx * x[None, :])


@pytest.mark.parametrize(
    ("ny", "nx", "slope", "bend"), [(4, 17, (-5, 3), (1, -4, 2)), (9, 6, (0.1, 2), (-3, 5, 0.2))]
)
def test_detrending_removes_its_polynomial_and_nothing_else(ny, nx, slope, bend):
    y, x = np.linspace(-1, 1, ny)[:, None], np.linspace(-1, 1, nx)[None, :]
    plane = 3.0 + slope[0] * y + slope[1] * x
    quadratic = plane + bend[0] * y**2 + bend[1] * x * y + bend[2] * x**2
    own = rough((ny, nx))

    def detrended(height, detrend):
        return make_periodic(HeightMap(height, (ny, nx)), detrend=detrend, periodic="mirrored").height

    for detrend, trend in (("tilt", plane), ("curvature", quadratic)):
        found = detrended(own + trend, detrend)
        np.testing.assert_allclose(found, detrended(own, detrend), atol=1e-12)  # rounding


def test_a_mirrored_map_has_the_grid_of_the_map():
    surface = make_periodic(HeightMap(rough(), (24.0, 32.0)), detrend="none", periodic="mirrored")
    assert surface.grid == Grid((24, 32), (0.375, 0.5), mirrored=True)
    assert surface.treatment.edge_step == 0
    smooth = HeightMap(waves((24, 32)), (24.0, 32.0))
    inside = make_periodic(smooth, detrend="none", periodic="mirrored").height
    np.testing.assert_allclose(inside, (waves((24, 32)).mean() - waves((24, 32))) / 64, atol=1e-14)


def test_mirror_images_join_without_a_crease():
    """The slope across the edges falls; summits on the edges, and heights elsewhere, stay as they are."""
    y, x = (np.arange(nodes) + 0.5 for nodes in (48, 64))
    summit = -((y[:, None] - 24) ** 2) / 100 - x**2 / 400
    treated = treat_map(HeightMap(summit, (48.0, 64.0)), periodic="mirrored", detrend="none", joins=True)
    found, exact = treated.height[24, 0] - treated.height, summit - summit[24, 0]
    np.testing.assert_allclose(found[5:-5, :32], exact[5:-5, :32], atol=1e-9)
    height = steel()
    joined, widths = levelling.level_edges(height)
    assert 1 < min(widths) < max(widths) < 4
    inside = (slice(4, -4),) * 2
    np.testing.assert_array_equal(joined[inside], height[inside])
    for axis in (0, 1):
        slopes = [np.diff(each, axis=axis).take([0, -1], axis) for each in (joined, height)]
        assert np.linalg.norm(slopes[0]) < 0.9 * np.linalg.norm(slopes[1])


def test_asperities_at_the_edges_of_a_cut_map_are_not_sharper():
    """Maximum von Mises stress of cut maps under the load that they carry in the periodic surface."""
    height = johnson(self_affine((192, 192), 0.8, 1 / 6, 1 / 24, 1e-3, seed=1), 0.8, 1.5)
    whole, solid = solve_contact(height, HALF_SPACE, contact_area_fraction=0.1), HALF_SPACE
    planes = list(stress_planes(whole, depth_grid(whole.grid, 0.05)))
    errors = []
    for row, column in np.ndindex(3, 3):
        part = tuple(slice(64 * at, 64 * at + 64) for at in (row, column))
        truth = max(plane.fields["von_mises"][0][part].max() for plane in planes if plane.grid == whole.grid)
        load, grid = whole.pressure[part].mean(), Grid((64, 64), 1 / 3, mirrored=True)
        for made in (height[part], levelling.level_edges(height[part])[0]):
            contact = solve_contact(made, solid, grid, mean_pressure=load)
            stress = analyse_stress(contact, quantities=("von_mises",))
            errors.append(float(stress["maximum_von_mises"].max()) / truth - 1)
    as_it_is, joined = np.reshape(errors, (-1, 2)).T
    assert joined.max() < 0.1
    assert as_it_is.max() > 0.2
    assert np.linalg.norm(joined) < 0.6 * np.linalg.norm(as_it_is)


@pytest.mark.parametrize("points", [None, 40, 90])
def test_mirror_images_have_places_on_the_map(points):
    """Also on other nodes than the map's; the mirrors stand half a spacing away from them, too."""
    treated = treat_map(HeightMap(rough(), (24.0, 32.0)), periodic="mirrored", points=points)
    grid = treated.grid
    assert grid.shape[1] == (points or 64) // 2
    y, x = np.meshgrid(*grid.whole_cell.coordinates(), indexing="ij")
    rows, columns = np.rint(grid.on_map(y, x) / np.array(grid.spacing)[:, None, None]).astype(int)
    whole = with_mirror_images(treated.height, grid)
    np.testing.assert_allclose(treated.height[rows, columns], whole, atol=1e-14)


def test_short_waves_are_removed_on_any_grid():
    surface = HeightMap(rough((32, 32)), (1.0, 1.0))
    smooth = make_periodic(surface, **PLAIN, wavelength_short=0.25)
    coefficients = Fourier(smooth.grid).forward(smooth.height)
    short = smooth.grid.wavenumber() > 2 * np.pi / 0.25 * 1.001
    assert np.abs(coefficients[short]).max() < 1e-15
    finer = make_periodic(surface, **PLAIN, wavelength_short=0.25, points=64)
    np.testing.assert_allclose(finer.height[::2, ::2], smooth.height, atol=1e-14)  # rounding


def test_a_surface_file_keeps_its_map_record(tmp_path):
    """A text export in the form of Gwyddion: 6 rows and 8 columns of 0.5 µm, heights in nm."""
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "map.asc"
    header = "# Channel: Height\n# Width: 4 µm\n# Height: 3 µm\n# Value units: nm\n"
    path.write_text(header + "\n".join(" ".join(f"{v:.9f}" for v in row) for row in waves((6, 8))) + "\n")
    parameters = {"file": str(path), "detrend": "tilt", "periodic": "mirrored"}
    data = read_surface(parameters)
    grid = grid_of(data)
    assert (grid.shape, grid.length, grid.mirrored) == ((6, 8), pytest.approx((0.375, 0.5)), True)
    assert float(data["height"].std()) == pytest.approx(float(data["rms_height"]))
    assert data.attrs["wavelength_short"] == pytest.approx(2 / 12 * 0.75)
    assert data.attrs["map_cell_length"] == pytest.approx(8e-6)
    assert "mirrored at two edges" in data.attrs["map_treatment"]
    write(data, tmp_path / "s.nc", "Surface", {"name": "s", "seed": 0, "surface": parameters})
    assert read(tmp_path / "s.nc").attrs["map_tilt"] == data.attrs["map_tilt"]
    found = read_map(tmp_path / "s.nc")
    assert (found.orientation, found.unit, found.periodic) == ("lower face", None, False)
    np.testing.assert_array_equal(found.as_indenter(), data["height"])
