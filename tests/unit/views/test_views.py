"""Pictures: values and units that they show, limits of their colours, panels, and the command."""

import shutil

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

import asperity as asp
from asperity.cli.main import main
from asperity.results import dataset
from asperity.results.variables import SI_UNITS
from asperity.views.maps import PIXELS
from asperity.views.scales import blocks, largest_magnitude, robust_limits

EDGE, PRESSURE = 512e-6, 50e6
GRID = asp.Grid((64, 64), EDGE)
X = GRID.coordinates()[1]
Q = 2 * np.pi / EDGE


def wave(waves=1):
    """Half-space under p (1 + cos q x), in SI."""
    field = np.tile(PRESSURE * (1 + np.cos(waves * Q * X)), (64, 1))
    return asp.LoadedSolid(field, GRID, asp.Solid(210e9, 0.3))


def megapascals(x, depth):
    """σ_zz under p (1 + cos q x): −p (1 + (1 + q z) exp(−q z) cos q x) (Westergaard 1939)."""
    return -PRESSURE / 1e6 * (1 + (1 + Q * depth) * np.exp(-Q * depth) * np.cos(Q * x))


@pytest.fixture
def read(chain, chain_in_si):
    """Result of a stage of the chain, by its name."""
    return lambda stage, si=False: dataset.read((chain_in_si if si else chain)[stage])


def image(figure):
    """Values of the first map."""
    return figure.axes[0].images[0].get_array()


def title(figure):
    return figure.axes[0].get_title(loc="left")


def mesh(figure):
    """Corners in m and values of a section."""
    (found,) = (each for each in figure.axes[0].collections if isinstance(each, QuadMesh))
    points = found.get_coordinates() * 1e-6
    return points[..., 0], points[..., 1], np.asarray(found.get_array()).reshape(points.shape[:2])


def test_limits_hold_the_values_and_are_apart():
    limits = robust_limits([np.linspace(-2.0, 3.0, 1000), np.linspace(0.0, 4.0, 100)])
    assert (limits.low, limits.high, limits.extend) == (-2.0, 4.0, "neither")
    for values in (np.zeros(9), np.full(9, -3.0), np.full(9, np.nan), np.zeros(0)):
        limits = robust_limits([values])
        assert limits.low < limits.high


@pytest.mark.parametrize(
    ("si", "unit", "x", "colours", "right"),
    [
        (False, 1.0, "x / cell length", "contact pressure / $E^*$", 1 - 0.5 / 64),
        (True, 1e-6, "x (µm)", "contact pressure (MPa)", 512 - 4),
    ],
)
def test_map_of_pressure_has_values_and_units(read, si, unit, x, colours, right):
    figure = asp.views.plot_pressure(read("contact", si))
    pressure, shown = read("contact", si)["pressure"].values, image(figure)
    assert np.array_equal(shown.mask, pressure == 0)
    np.testing.assert_allclose(shown.compressed(), pressure[pressure > 0] * unit)
    axis, bar = figure.axes[0], figure.axes[-1]
    assert (axis.get_xlabel(), bar.get_ylabel(), title(figure)) == (x, colours, "small")
    assert axis.get_xlim()[1] == pytest.approx(right)  # half a pixel beyond the last of 64 nodes


def test_spike_leaves_the_picture_and_is_named(read):
    surface = read("surface", si=True).copy(deep=True)
    before = asp.views.plot_height(surface).axes[0].images[0].norm
    surface["height"].values[3, 5] = 4e-3
    figure = asp.views.plot_height(surface)
    assert figure.axes[0].images[0].norm.vmax < 1.5 * before.vmax
    assert "1 point above the scale, up to 4000 µm" in title(figure)


def test_every_result_has_a_panel(read):
    contact, names = read("contact"), [f"number {number}" for number in range(4)]
    figure = asp.views.plot_gap(dict.fromkeys(names, contact), y=(0.25, 0.5), x=(0.0, 0.125))
    panels = [axis for axis in figure.axes if axis.images]
    assert len(figure.axes) == 4 + 1
    assert [axis.get_title(loc="left") for axis in panels] == names
    assert len({(axis.images[0].norm.vmin, axis.images[0].norm.vmax) for axis in panels}) == 1
    np.testing.assert_allclose(image(figure), contact["gap"].values[16:33, :9])
    axis = Figure().add_subplot()
    assert asp.views.plot_gap(contact, axes=axis) is axis.figure
    assert axis.images


def test_pixels_of_fine_grids_hold_the_largest_node():
    grid = asp.Grid((8, 2 * PIXELS + 1), (8.0, 2 * PIXELS + 1.0))
    pressure = np.ones(grid.shape)
    pressure[3, 1000] = 7.0
    axis = asp.views.plot_pressure(asp.LoadedSolid(pressure, grid, asp.Solid(1, 0.3))).axes[0]
    (shown,) = axis.images
    left, right, bottom, top = shown.get_extent()
    ny, nx = shown.get_array().shape
    assert (ny, nx) == (8, -(-(2 * PIXELS + 1) // 3))
    row, column = np.unravel_index(shown.get_array().argmax(), (ny, nx))
    assert shown.get_array()[row, column] == 7.0
    assert left + (column + 0.5) * (right - left) / nx == pytest.approx(1000, abs=1.01)
    assert bottom + (row + 0.5) * (top - bottom) / ny == pytest.approx(3)
    assert axis.get_xlim() == (-0.5, 2 * PIXELS + 0.5)  # the last block is not full
    assert blocks(np.array([[1.0, -2.0], [0.0, 1.5]]), (2, 2), largest_magnitude).tolist() == [[-2.0]]


def test_section_shows_the_stress_of_a_wave():
    figure = asp.views.plot_section(wave(), y=100e-6, depth=60e-6, field="zz", unit_system=SI_UNITS)
    x, depth, values = mesh(figure)
    np.testing.assert_allclose(values, megapascals(x, depth), rtol=0, atol=1e-6)
    assert depth[-1, 0] == pytest.approx(60e-6)
    labels = title(figure), figure.axes[0].get_xlabel(), figure.axes[-1].get_xlabel()
    assert labels[1:] == ("x (µm)", r"$\sigma_{zz}$ (MPa)")
    assert labels[0] == "y = 104 µm\ndepth drawn 2.1 times as large"  # through the nearest node
    part = asp.views.plot_section(
        wave(), x=0.0, y=(0.0, 200e-6), depth=60e-6, field="zz", unit_system=SI_UNITS
    )
    y, _, values = mesh(part)
    np.testing.assert_allclose(values[0], -2 * PRESSURE / 1e6)
    assert y[0, -1] == pytest.approx(200e-6)


def placed(figure):
    """Edges of each axes with its labels, in pixels: left, bottom, right, top."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    boxes = [axis.get_tightbbox(canvas.get_renderer(), for_layout_only=True) for axis in figure.axes]
    return np.array([box.extents for box in boxes]), figure.bbox.extents


@pytest.mark.parametrize(("results", "si"), [(1, False), (2, True), (4, True)])
def test_labels_are_in_the_figure_and_apart(read, results, si):
    """The places of the panels are chosen without drawing them."""
    contact, stress = ({str(n): read(name, si) for n in range(results)} for name in ("contact", "stress"))
    edge = EDGE if si else 1.0
    figures = [
        asp.views.plot_height(contact),
        asp.views.plot_pressure(contact, y=(0.2 * edge, 0.3 * edge)),
        asp.views.plot_gap(contact, x=(0.2 * edge, 0.22 * edge)),
        asp.views.plot_peaks(stress, "von_mises"),
        asp.views.plot_section(contact, depth=0.1 * edge),
    ]
    for figure in figures:
        boxes, whole = placed(figure)
        assert (boxes[:, :2] >= -1).all()
        assert (boxes[:, 2:] <= whole[2:] + 1).all()
        apart = (boxes[:, None, :2] >= boxes[None, :, 2:] - 1).any(axis=2)
        assert (apart | apart.T | np.eye(len(boxes), dtype=bool)).all()


@pytest.mark.parametrize(("waves", "bottom"), [(4, 5.9 / (4 * Q)), (16, 0.12 * EDGE)])
def test_section_ends_where_the_stress_has_faded(waves, bottom):
    """σ_xz = p q z exp(−q z) sin q x falls to 5 % of its largest at q z = 5.9; or at 0.12 of the length."""
    axis = asp.views.plot_section(wave(waves), field="xz", unit_system=SI_UNITS).axes[0]
    assert axis.get_ylim()[0] == pytest.approx(1e6 * bottom, abs=0.013 * 512)  # planes are an eighth apart


@pytest.mark.parametrize(("young", "label"), [(210e9, "depth (µm)"), (1.0, "depth (input units)")])
def test_stress_of_a_body_in_pascal_has_units(young, label):
    height = 1e-6 * np.cos(Q * X) * np.cos(Q * X[:, None])
    contact = asp.solve_contact(height, asp.Solid(young, 0.3), EDGE, contact_area_fraction=0.1)
    figure = asp.views.plot_peaks(asp.analyse_stress(contact), "von_mises")
    assert figure.axes[0].get_ylabel() == label


def test_plane_shows_the_stress_of_a_wave():
    """σ_xz = p q z exp(−q z) sin q x is largest at z = 1/q, 81.5 µm; the planes are an eighth apart."""
    figure = asp.views.plot_plane(wave(), depth=50e-6, field="zz", unit_system=SI_UNITS)
    np.testing.assert_allclose(image(figure), np.tile(megapascals(X, 50e-6), (64, 1)), rtol=0, atol=1e-6)
    assert title(figure) == "depth: 50 µm"
    largest = asp.views.plot_plane(wave(), field="xz", unit_system=SI_UNITS)
    depth = float(title(largest).removeprefix("depth of the maximum: ").removesuffix(" µm"))
    assert depth == pytest.approx(1e6 / Q, rel=0.125)
    assert np.abs(image(largest)).max() == pytest.approx(PRESSURE / 1e6 / np.e, rel=0.01)


@pytest.mark.parametrize(("body", "degrees"), [("lower", 0.0), ("upper", 180.0)])
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_pictures_show_body_boundary_and_sliding(body, degrees, boundary):
    """Against the planes of the body; the traction on the upper one has the opposite direction."""
    grid = asp.Grid((32, 40), (1e-3, 1.2e-3))
    y, x = grid.coordinates()
    height = ((x - 5e-4) ** 2 + (y[:, None] - 4e-4) ** 2) / (2 * 5e-3)
    solid = asp.TwoBodies(asp.Solid(210e9, 0.3), asp.Solid(70e9, 0.1))
    contact = asp.solve_contact(height, solid, grid.length, force=200.0, boundary=boundary)
    settings = {"fields": ("xx",), "tolerance": 0, "friction": 0.4, "sliding_direction": degrees}
    planes = asp.stress_planes(contact.in_body(body), [0.0, 1e-4], **settings)
    surface, below = (plane.fields["xx"][0] / 1e6 for plane in planes)
    chosen = {"field": "xx", "body": body, "friction": 0.4, "sliding_direction": "x", "unit_system": SI_UNITS}
    np.testing.assert_allclose(image(asp.views.plot_plane(contact, 1e-4, **chosen)), below, rtol=1e-6)
    section = asp.views.plot_section(contact, y=13 * grid.spacing[0], depth=2e-4, **chosen)
    np.testing.assert_allclose(mesh(section)[2][0], surface[13], atol=1e-4 * np.abs(surface[13]).max())


def test_peaks_are_points_of_magnitude_and_depth(read):
    """Points of the stress, bars of the pressure."""
    stress = read("stress", si=True)
    axis = asp.views.plot_peaks(stress, "von_mises", 0.33).axes[0]
    del (unknown := stress.copy()).attrs["unit_system"]
    for system, label in ((None, "depth (input units)"), ("SI", "depth (µm)")):
        assert asp.views.plot_peaks(unknown, unit_system=system).axes[0].get_ylabel() == label
    found = asp.stress.select_peaks(stress, "von_mises", 0.33)
    points = np.concatenate([np.array(line.get_data()).T for line in axis.lines[:2]])
    expected = np.column_stack([np.abs(found["peak_value"]) / 1e6, found["peak_depth"] * 1e6])
    np.testing.assert_allclose(np.sort(points, axis=0), np.sort(expected, axis=0))
    assert axis.get_xlabel() == "magnitude of peaks of von Mises stress (MPa)"
    bars = asp.views.plot_peaks(stress, "pressure").axes[0].patches
    assert sum(bar.get_height() for bar in bars) == asp.stress.select_peaks(stress, "pressure").sizes["peak"]


@pytest.mark.parametrize("scatter", [0.0, 1e-15, 1e-9])
def test_a_histogram_of_equal_peaks_has_few_bars(read, scatter):
    """The peaks of a regular texture; the rule for the width of a bar asks for 1e9 of them."""
    stress = read("stress", si=True)
    values = stress["peak_value"].copy()
    values[stress["peak_quantity"].values == "pressure"] = 1e9
    values *= 1 + scatter * np.random.default_rng(1).standard_normal(values.size)
    bars = asp.views.plot_peaks(stress.assign(peak_value=values), "pressure").axes[0].patches
    assert len(bars) <= 200
    assert sum(bar.get_height() for bar in bars) > 0


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("pressure", lambda of: of("surface"), "pressure: the result has height"),
        ("height", lambda of: [of("contact"), of("contact", si=True)], "one unit system are needed"),
        ("section", lambda of: of("surface"), "contact: the result of a contact, with its pressure"),
        ("height", lambda of: 3, "result = 3: a result of stage surface or contact"),
        ("peaks", lambda of: of("contact"), "stress: a result of stage stress"),
    ],
)
def test_unsuitable_results_are_refused(read, name, given, message):
    with pytest.raises((ValueError, TypeError), match=message):
        getattr(asp.views, f"plot_{name}")(given(read))


def test_unsuitable_options_are_refused(read):
    with pytest.raises(ValueError, match="y = 600 µm: a position from 0 to 5"):
        asp.views.plot_section(read("contact", si=True), y=600e-6)
    with pytest.raises(ValueError, match="axes: 2 are needed"):
        asp.views.plot_gap([read("contact")] * 2, axes=Figure().add_subplot())


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        ("surface", "height"),
        ("contact", "gap y=0-100um x=0.1..0.2mm"),
        ("contact", "section y=205um x=0-100um --field xx"),
        ("contact", "plane depth=max --poisson 0.2"),
        ("stress", "peaks --field pressure"),
    ],
)
def test_command_puts_the_picture_beside_the_result(chain_in_si, capsys, tmp_path, stage, words):
    path = shutil.copy(chain_in_si[stage], tmp_path / "mine.nc")
    assert main(["view", str(path), *words.split()]) == 0
    picture = tmp_path / f"mine_{words.split()[0]}.png"
    assert capsys.readouterr().out.splitlines()[-1] == str(picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
