"""Pictures: values and units that they show, limits of their colours, panels, and the command."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from bad_input import make_chain
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

import asperity as asp
from asperity.cli.main import main
from asperity.results import dataset
from asperity.results.variables import SI_UNITS, STUDY_UNITS, in_si
from asperity.views.maps import PIXELS, blocks, largest_magnitude
from asperity.views.scales import measure, robust_limits

EDGE, PRESSURE = 512e-6, 50e6
GRID = asp.Grid((64, 64), EDGE)
Q = 2 * np.pi / EDGE


def wave(pressure=PRESSURE):
    """Half-space under p (1 + cos q x), in SI."""
    _, x = GRID.coordinates()
    field = np.broadcast_to(pressure * (1 + np.cos(Q * x)), GRID.shape)
    return asp.LoadedSolid(field.copy(), GRID, asp.Layer(210e9, 0.3))


def closed_form(x, depth):
    """σ_zz under p (1 + cos q x): −p (1 + (1 + q z) exp(−q z) cos q x) (Westergaard 1939)."""
    decay = (1 + Q * depth) * np.exp(-Q * depth)
    return -PRESSURE * (1 + decay * np.cos(Q * x))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Results of one surface of the study by stage, and the same in SI by ``si_`` and stage."""
    folder = tmp_path_factory.mktemp("views")
    paths = make_chain(folder)
    for stage in ("surface", "contact", "stress"):
        data = dataset.read(paths[stage])
        paths[f"si_{stage}"] = str(folder / f"si_{stage}.nc")
        si, settings = in_si(data, dataset.settings_of(data), EDGE, 200e9)
        for name in ("settings", "settings_digest", "content_digest", "comment"):
            del si.attrs[name]
        dataset.write(si, paths[f"si_{stage}"], "SI", settings)
    return paths


def colour_bar(figure):
    """Axes of the colour bar, which are added last."""
    return figure.axes[-1]


def image(figure):
    """Values of the first map."""
    return figure.axes[0].images[0].get_array()


def test_limits_without_outliers_are_the_extremes():
    limits = robust_limits([np.linspace(-2.0, 3.0, 1000), np.linspace(0.0, 4.0, 100)])
    assert (limits.low, limits.high, limits.extend) == (-2.0, 4.0, "neither")


def test_limits_of_equal_values_are_apart():
    for values in (np.zeros(9), np.full(9, -3.0), np.full(9, np.nan), np.zeros(0)):
        limits = robust_limits([values])
        assert limits.low < limits.high


@pytest.mark.parametrize(
    ("largest", "dimension", "system", "label"),
    [
        (512e-6, "length", SI_UNITS, "a (µm)"),
        (1.2e9, "stress", SI_UNITS, "a (MPa)"),
        (5e3, "stress", SI_UNITS, "a (kPa)"),
        (0.1, "length", STUDY_UNITS, "a / cell length"),
        (0.1, "stress", None, "a"),
    ],
)
def test_units_have_sensible_prefixes(largest, dimension, system, label):
    assert measure([0.0, -largest], dimension, system).label("a") == label


def test_maps_are_in_cell_lengths_and_modulus(files):
    contact = dataset.read(files["contact"])
    figure = asp.plot_pressure(contact)
    shown, pressure = image(figure), contact["pressure"].values
    assert np.array_equal(shown.mask, pressure == 0)
    assert np.array_equal(shown.compressed(), pressure[pressure > 0])
    assert figure.axes[0].get_xlabel() == "x / cell length"
    assert colour_bar(figure).get_ylabel() == "contact pressure / $E^*$"
    assert figure.axes[0].get_title(loc="left") == "small"


def test_maps_in_si_are_in_micrometres_and_megapascals(files):
    contact = dataset.read(files["si_contact"])
    figure = asp.plot_pressure(contact)
    assert image(figure).max() == pytest.approx(float(contact["pressure"].max()) / 1e6)
    assert figure.axes[0].get_ylabel() == "y (µm)"
    assert figure.axes[0].get_xlim()[1] == pytest.approx(512 - 4)  # half a pixel beyond the last of 64 nodes
    assert colour_bar(figure).get_ylabel() == "contact pressure (MPa)"


def test_the_height_under_a_contact_is_recovered(files):
    surface, contact = (asp.plot_height(dataset.read(files[stage])) for stage in ("surface", "contact"))
    assert np.allclose(image(surface), image(contact), atol=1e-12)
    assert contact.axes[0].collections
    assert not surface.axes[0].collections  # outlines are of contacts only


def test_a_spike_leaves_the_picture_and_is_named(files):
    surface = dataset.read(files["si_surface"]).copy(deep=True)
    before = asp.plot_height(surface).axes[0].images[0].norm
    surface["height"].values[3, 5] = 4e-3
    figure = asp.plot_height(surface)
    after = figure.axes[0].images[0].norm
    assert after.vmax < 1.5 * before.vmax
    assert "1 above the scale, to 4000 µm" in figure.axes[0].get_title(loc="left")


@pytest.mark.parametrize("count", [1, 4])
def test_every_result_has_a_panel(files, count):
    contact = dataset.read(files["contact"])
    figure = asp.plot_gap({f"number {number}": contact for number in range(count)})
    panels = [axis for axis in figure.axes if axis.images]
    assert len(figure.axes) == count + 1
    assert [axis.get_title(loc="left") for axis in panels] == [f"number {number}" for number in range(count)]
    assert len({(axis.images[0].norm.vmin, axis.images[0].norm.vmax) for axis in panels}) == 1


def test_given_axes_are_used(files):
    axis = Figure().add_subplot()
    assert asp.plot_gap(dataset.read(files["contact"]), axes=axis) is axis.figure
    assert axis.images
    with pytest.raises(ValueError, match="axes: 2 are needed, one for each result, 1 are given"):
        asp.plot_gap([dataset.read(files["contact"])] * 2, axes=axis)


def test_a_part_of_the_cell_is_drawn(files):
    contact = dataset.read(files["contact"])
    figure = asp.plot_gap(contact, y=(0.25, 0.5), x=(0.0, 0.125))
    assert np.allclose(image(figure), contact["gap"].values[16:33, :9])


def test_pixels_of_fine_grids_hold_the_largest_node():
    grid = asp.Grid((8, 2 * PIXELS + 1), (8.0, 2 * PIXELS + 1.0))
    pressure = np.ones(grid.shape)
    pressure[3, 1000] = 7.0
    axis = asp.plot_pressure(asp.LoadedSolid(pressure, grid, asp.Layer(1, 0.3))).axes[0]
    (shown,) = axis.images
    left, right, bottom, top = shown.get_extent()
    ny, nx = shown.get_array().shape
    assert (ny, nx) == (8, -(-(2 * PIXELS + 1) // 3))
    row, column = np.unravel_index(shown.get_array().argmax(), (ny, nx))
    assert shown.get_array()[row, column] == 7.0
    assert left + (column + 0.5) * (right - left) / nx == pytest.approx(1000, abs=1.01)
    assert bottom + (row + 0.5) * (top - bottom) / ny == pytest.approx(3)
    assert axis.get_xlim() == (-0.5, 2 * PIXELS + 0.5)  # the last block is not full
    signed = blocks(np.array([[1.0, -2.0], [0.0, 1.5]]), (2, 2), largest_magnitude)
    assert signed.tolist() == [[-2.0]]


def test_a_section_shows_the_stress_of_a_wave():
    figure = asp.plot_section(wave(), y=100e-6, depth=60e-6, field="zz", unit_system=SI_UNITS)
    mesh = next(found for found in figure.axes[0].collections if isinstance(found, QuadMesh))
    points = mesh.get_coordinates() * 1e-6
    expected = closed_form(points[..., 0], points[..., 1]) / 1e6
    assert np.allclose(mesh.get_array().reshape(expected.shape), expected, rtol=0, atol=1e-6)
    assert points[-1, 0, 1] == pytest.approx(60e-6)
    assert figure.axes[0].get_title(loc="left") == "y = 104 µm"  # the nearest node
    assert figure.axes[0].get_xlabel() == "x (µm)"
    assert colour_bar(figure).get_xlabel() == r"$\sigma_{zz}$ (MPa)"


def test_a_section_shows_a_part_of_its_line():
    figure = asp.plot_section(wave(), x=0.0, y=(0.0, 200e-6), depth=60e-6, field="zz", unit_system=SI_UNITS)
    mesh = next(found for found in figure.axes[0].collections if isinstance(found, QuadMesh))
    assert np.allclose(mesh.get_array().ravel()[:25], -2 * PRESSURE / 1e6)
    assert mesh.get_coordinates()[0, -1, 0] == pytest.approx(200)


@pytest.mark.parametrize(("waves", "bottom"), [(4, 5.9 / (4 * Q)), (16, 0.12 * EDGE)])
def test_a_section_ends_where_the_stress_has_faded(waves, bottom):
    """σ_xz = p q z exp(−q z) sin q x falls to 5 % of its largest at q z = 5.9; or at 0.12 of the length."""
    solid = wave()
    _, x = GRID.coordinates()
    solid.pressure[:] = PRESSURE * (1 + np.cos(waves * Q * x))
    axis = asp.plot_section(solid, field="xz", unit_system=SI_UNITS).axes[0]
    assert axis.get_ylim()[0] == pytest.approx(1e6 * bottom, abs=0.013 * 512)  # planes are an eighth apart


def test_a_plane_shows_the_stress_of_a_wave():
    figure = asp.plot_plane(wave(), depth=50e-6, field="zz", unit_system=SI_UNITS)
    _, x = GRID.coordinates()
    assert np.allclose(image(figure), closed_form(x, 50e-6) / 1e6, rtol=0, atol=1e-6)
    assert figure.axes[0].get_title(loc="left") == "depth: 50 µm"


def test_the_plane_of_the_largest_stress_is_found():
    """σ_xz = p q z exp(−q z) sin q x is largest at z = 1/q, 81.5 µm; the planes are an eighth apart."""
    figure = asp.plot_plane(wave(), field="xz", unit_system=SI_UNITS)
    title = figure.axes[0].get_title(loc="left")
    depth = float(title.removeprefix("depth of the largest: ").removesuffix(" µm"))
    assert depth == pytest.approx(1e6 / Q, rel=0.125)
    assert np.abs(image(figure)).max() == pytest.approx(PRESSURE / 1e6 / np.e, rel=0.01)


@pytest.mark.parametrize("body", ["lower", "upper"])
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_sections_show_body_boundary_and_sliding(body, boundary):
    """Against the planes of the body; the traction on the upper one has the opposite direction."""
    grid = asp.Grid((32, 40), (1e-3, 1.2e-3))
    y, x = grid.coordinates()
    height = ((x - 5e-4) ** 2 + (y[:, None] - 4e-4) ** 2) / (2 * 5e-3)
    solid = asp.TwoBodies(asp.Layer(210e9, 0.3), asp.Layer(70e9, 0.1))
    contact = asp.solve(height, solid, grid.length, force=200.0, boundary=boundary)
    chosen = {"field": "xx", "body": body, "friction": 0.4, "sliding_direction": "x", "unit_system": SI_UNITS}
    angle = 0.0 if body == "lower" else 180.0
    expected = list(
        asp.stress_planes(
            contact.in_body(body),
            [0.0, 1e-4],
            fields=("xx",),
            tolerance=0,
            friction=0.4,
            sliding_direction=angle,
        )
    )
    plane = asp.plot_plane(contact, 1e-4, **chosen)
    np.testing.assert_allclose(image(plane), expected[1].fields["xx"][0] / 1e6, rtol=1e-6)
    row = 13
    section = asp.plot_section(contact, y=row * grid.spacing[0], depth=2e-4, **chosen)
    (mesh,) = (found for found in section.axes[0].collections if isinstance(found, QuadMesh))
    shown = np.asarray(mesh.get_array()).reshape(-1, 40)[0]
    surface = expected[0].fields["xx"][0, row] / 1e6
    np.testing.assert_allclose(shown, surface, atol=1e-4 * np.abs(surface).max())


def test_a_plane_shows_the_shear_of_hertz():
    """Free boundary: the largest shear is 0.310 p0 at a depth of 0.48 a for ν = 0.3 (Johnson 1985, 3.45)."""
    grid = asp.Grid((64, 64), 1e-3)
    y, x = grid.coordinates()
    height = ((x - 5e-4) ** 2 + (y[:, None] - 5e-4) ** 2) / (2 * 5e-3)
    contact = asp.solve(height, asp.Layer(210e9, 0.3), 1e-3, force=200.0, boundary="free")
    figure = asp.plot_plane(contact, field="largest_shear", unit_system=SI_UNITS)
    # Pixels of a ninth of the contact radius; the periodic stress would be 2 % larger.
    assert image(figure).max() == pytest.approx(0.310 * contact.pressure.max() / 1e6, rel=5e-3)


def test_peaks_are_points_of_magnitude_and_depth(files):
    stress = dataset.read(files["si_stress"])
    figure = asp.plot_peaks(stress, "von_mises", 0.33)
    found = asp.peaks(stress, "von_mises", 0.33)
    points = np.concatenate([np.array(line.get_data()).T for line in figure.axes[0].lines[:2]])
    expected = np.column_stack([np.abs(found["peak_value"]) / 1e6, found["peak_depth"] * 1e6])
    assert np.allclose(np.sort(points, axis=0), np.sort(expected, axis=0))
    assert figure.axes[0].get_xlabel() == "magnitude of peaks of von Mises stress (MPa)"


def test_one_high_peak_does_not_flatten_the_axes(files):
    stress = dataset.read(files["stress"]).copy(deep=True)
    before = asp.plot_peaks(stress).axes[0].get_xlim()[1]
    ratio = stress["peak_poisson"].values == 0.33
    number = int(np.flatnonzero((stress["peak_quantity"].values == "von_mises") & ratio)[0])
    stress["peak_value"].values[number] = 1e4
    figure = asp.plot_peaks(stress)
    assert figure.axes[0].get_xlim()[1] < 2 * before
    assert "1 above the scale, to 10000 $E^*$" in figure.axes[0].get_title(loc="left")


def test_small_peaks_do_not_set_the_depth_shown(files):
    stress = dataset.read(files["stress"]).copy(deep=True)
    before = asp.plot_peaks(stress).axes[0].get_ylim()
    small = np.abs(stress["peak_value"].values).argsort()[: stress.sizes["peak"] // 2]
    stress["peak_depth"].values[small] = 0.9
    assert asp.plot_peaks(stress).axes[0].get_ylim() == before


def test_peaks_of_the_pressure_are_a_histogram(files):
    stress = dataset.read(files["stress"])
    bars = asp.plot_peaks(stress, "pressure").axes[0].patches
    assert sum(bar.get_height() for bar in bars) == asp.peaks(stress, "pressure").sizes["peak"]


def test_unsuitable_results_are_refused(files):
    contact, surface, si = (dataset.read(files[name]) for name in ("contact", "surface", "si_contact"))
    with pytest.raises(ValueError, match="pressure: the result has height"):
        asp.plot_pressure(surface)
    with pytest.raises(ValueError, match="one unit system are needed"):
        asp.plot_height([contact, si])
    with pytest.raises(ValueError, match="contact: the result of a contact, with its pressure and its solid"):
        asp.plot_section(surface)
    with pytest.raises(TypeError, match="result = 3: a result of stage surface or contact"):
        asp.plot_height(3)
    with pytest.raises(TypeError, match="result: a dataset of stage surface or contact"):
        asp.plot_height(xr.Dataset())
    with pytest.raises(ValueError, match="at least one result is needed"):
        asp.plot_height([])
    with pytest.raises(TypeError, match="stress: a result of stage stress"):
        asp.plot_peaks(contact)
    with pytest.raises(ValueError, match=r"y = 600 µm: a position from 0 to 512 µm is needed"):
        asp.plot_section(si, y=600e-6)


@pytest.mark.parametrize(
    ("result", "words"),
    [
        ("surface", "height"),
        ("si_contact", "pressure"),
        ("si_contact", "gap y=0-100um x=0.1..0.2mm"),
        ("si_contact", "section y=205um x=0-100um --field xx"),
        ("si_contact", "plane depth=max --poisson 0.2"),
        ("si_stress", "peaks --field pressure"),
    ],
)
def test_the_command_puts_the_picture_beside_the_result(files, capsys, tmp_path, result, words):
    path = tmp_path / "mine.nc"
    path.write_bytes(Path(files[result]).read_bytes())
    assert main(["view", str(path), *words.split()]) == 0
    picture = tmp_path / f"mine_{words.split()[0]}.png"
    assert capsys.readouterr().out.splitlines()[-1] == str(picture)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_command_draws_several_results(files, tmp_path):
    pictures = [str(tmp_path / name) for name in ("a.png", "a.svg")]
    copy = tmp_path / "contact.nc"
    copy.write_bytes(Path(files["contact"]).read_bytes())
    assert main(["view", files["contact"], str(copy), "gap", "--out", *pictures]) == 0
    assert (tmp_path / "a.png").stat().st_size > 3000
    assert (tmp_path / "a.svg").read_text().count("y / cell length") == 2  # a panel for each result


def test_names_of_files_are_plain_text(files, tmp_path, capsys):
    paths = [tmp_path / "a" / "$x$\x1b[31m.nc", tmp_path / "b.nc"]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(Path(files["contact"]).read_bytes())
    assert main(["view", *map(str, paths), "gap", "--out", str(tmp_path / "\x1b[31m.svg")]) == 0
    assert capsys.readouterr().out.endswith("\\x1b[31m.svg\n")
    assert "($x$\\x1b[31m)" in (tmp_path / "\x1b[31m.svg").read_text()  # the title in a comment of its text
    unlabelled = dataset.read(files["contact"]).assign_attrs(settings='{"name": "$\\\\frac{1}$"}')
    assert asp.plot_gap(unlabelled).axes[0].get_title(loc="left") == r"\$\frac{1}\$"
    asp.plot_gap(unlabelled).savefig(tmp_path / "gap.png")


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("{contact}", "result files and one of height, pressure, gap, section, plane, peaks are needed"),
        ("{contact} {contact} gap", "contact.nc: given twice"),
        ("{stress} gap", "a result of stress, one of contact is needed"),
        ("{contact} section y=205um", "y = '205um': a number in cell lengths is needed"),
        ("{contact} section y=0.1 x=0.1", "y, x: a number for one of them"),
        ("{contact} section z=1", "'z=1': one of y=..., x=..., depth=... is needed"),
        ("{contact} section y=1 y=1", "'y=1': y is given twice"),
        ("{contact} section depth=0", "depth = 0: a depth > 0 is needed"),
        ("{contact} plane depth=-1", "depth = -1: max or a depth from 0 to 100 is needed"),
        ("{contact} plane x=0.3-0.2", "x = 0.3 to 0.2: rising positions from 0 to 1 are needed"),
        ("{contact} height x=3", "x = '3': a range such as 0-0.1 is needed"),
        ("{contact} height --field xx", "--field: not for height, only for section, plane and peaks"),
        ("{contact} section --field foo", "--field 'foo': one of xx, yy"),
        ("{si_contact} section y=205", "y = '205': a number with a unit of length"),
        ("{si_contact} section y=900um", "y = 900 µm: a position from 0 to 512 µm is needed"),
        ("{stress} peaks --field zz --poisson 0.1", "poisson = 0.1: one of 0, 0.33 is needed"),
        ("{stress} peaks y=0.1", "'y=0.1': peaks takes no position"),
    ],
)
def test_the_command_refuses_in_one_line(files, capsys, command, message):
    assert main(["view", *command.format(**files).split()]) == 1
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
