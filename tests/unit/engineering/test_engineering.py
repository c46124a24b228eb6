"""Answers in SI units agree with closed forms, and follow from bodies and load as they must."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from samples import invariants, refuses

import asperity as asp
from asperity import Body, run
from asperity.engineering.contact_numbers import contact_spots
from asperity.fourier.grid import Grid
from asperity.reference.hertz import Hertz, LineHertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.surface.reading.height_map import HeightMap
from asperity.surface.treatment.treatment import TreatedMap

EDGE, POINTS, RADIUS, FORCE = 160e-6, 160, 1e-3, 1.0
STEEL, ALUMINIUM = Body(young=210e9, poisson=0.3), Body(young=70e9, poisson=0.33)
MODULUS = asp.Solid(STEEL.young, STEEL.poisson).effective_modulus
AS_IT_IS = {"detrend": "none", "periodic": "declared"}


def a_sphere():
    x = (np.arange(POINTS) - POINTS / 2) * EDGE / POINTS
    return HeightMap(-(x[:, None] ** 2 + x**2) / (2 * RADIUS), (EDGE, EDGE))


def a_rough_map(points=64, wavelength_short=8e-6, seed=1):
    edge = 64e-6
    height = asp.self_affine((points, points), 0.8, edge / 2, wavelength_short, 0.2e-6, seed, length=edge)
    return HeightMap(height, (edge, edge))


def hertz(*bodies):
    """Radius of contact and largest pressure (K. L. Johnson, Contact Mechanics, 1985, Eqs. 4.22 and 4.24)."""
    modulus = 1 / sum((1 - body.poisson**2) / body.young for body in bodies)
    radius = (3 * FORCE * RADIUS / (4 * modulus)) ** (1 / 3)
    return radius, 3 * FORCE / (2 * np.pi * radius**2)


def von_mises_on_axis(depth, poisson):
    """Von Mises stress over the largest pressure on the axis, depth over the radius (Johnson, Eq. 3.45)."""
    radial = -(1 + poisson) * (1 - depth * np.arctan2(1, depth)) + 0.5 / (1 + depth**2)
    return np.abs(radial + 1 / (1 + depth**2))


@pytest.fixture(scope="module")
def sphere():
    _, largest = hertz(STEEL)
    return run({"file": a_sphere(), **AS_IT_IS}, STEEL.replaced(yield_stress=0.5 * largest), force=FORCE)


def test_a_sphere_is_as_hertz_says(sphere):
    """The periodic cell of eleven radii changes the pressure by a percent, pixels of a/15 as much."""
    radius, largest = hertz(STEEL)
    assert sphere["force"].value == pytest.approx(FORCE, rel=1e-5)
    assert sphere["maximum pressure"].value == pytest.approx(largest, rel=0.02)
    assert sphere["contact area"].value == pytest.approx(np.pi * radius**2, rel=0.03)
    found = sphere["maximum von Mises stress"]
    depth = np.linspace(0, 2, 2001)
    on_axis = von_mises_on_axis(depth, STEEL.poisson)
    assert found.value == pytest.approx(on_axis.max() * largest, rel=0.02)
    assert found.position.depth == pytest.approx(depth[on_axis.argmax()] * radius, rel=0.05)
    assert found.position[1:] == pytest.approx((EDGE / 2, EDGE / 2), abs=EDGE / POINTS)


def test_depths_above_yield_are_those_of_hertz(sphere):
    """On the axis the stress is above half of the largest pressure between two depths."""
    radius, _ = hertz(STEEL)
    depth = np.linspace(0, 2, 2001)
    above = depth[von_mises_on_axis(depth, STEEL.poisson) > 0.5] * radius
    deepest, volume = sphere["maximum depth above yield"], sphere["volume above yield"].value
    assert deepest.value == pytest.approx(above[-1], abs=0.02 * radius)
    first = 1e-6 * float(deepest.note.removeprefix("from a depth of ").removesuffix(" µm"))
    assert first == pytest.approx(above[0], abs=0.02 * radius)
    assert 0.1 < volume / (radius**2 * (above[-1] - above[0])) < np.pi
    fraction = sphere["volume fraction above yield"].value
    assert fraction == pytest.approx(volume / (EDGE**2 * deepest.value))


def test_sliding_sphere_is_as_hamilton_goodman_say():
    """All extreme values, through run, for sliding along y; pixels of a fifteenth of the radius."""
    radius, largest = hertz(STEEL)
    free = {"file": a_sphere(), "detrend": "none", "periodic": "none"}
    answer = run(free, STEEL, force=FORCE, sliding={"friction": 0.3, "direction": "y"})
    curvature = 2 * radius * MODULUS / (np.pi * largest)
    sphere = SlidingSphere(Hertz(radius, curvature_radius=curvature), 0.3)
    place = radius * np.linspace(-1.5, 1.5, 61)
    depth = radius * np.concatenate([[0.0], np.linspace(0.05, 1.2, 47)])
    stress = sphere.stress(place[:, None], place, depth[:, None, None], STEEL.poisson)
    fields = invariants(stress * MODULUS)
    expected = {name: fields[name].max() for name in ("von_mises", "maximum_shear", "principal_1")}
    expected |= {name: fields[name].min() for name in ("principal_3", "hydrostatic")}
    for field, value in expected.items():
        # The tension behind the contact has a cusp at its edge, which the pixels cut off.
        rel = 0.2 if field == "principal_1" else 0.02
        assert answer.extreme(field).value == pytest.approx(value, rel=rel), field
    # Behind the contact: the traction on the lower body points along y.
    tension = answer.extreme("principal_1")
    assert tension.y - EDGE / 2 == pytest.approx(-radius, rel=0.15)
    assert tension.x == pytest.approx(EDGE / 2, abs=1.5 * EDGE / POINTS)


@pytest.fixture(scope="module")
def both_rough():
    lower, upper = a_rough_map(seed=1), a_rough_map(seed=2)
    return lower, upper, run(lower, STEEL, ALUMINIUM.replaced(map=upper), mean_pressure=100e6)


def test_two_rough_maps_touch_at_summed_heights(both_rough):
    """Turned over about y, the peaks of the upper map lie at the other side of it."""
    lower, upper, answer = both_rough
    face = -(lower.height + upper.height[:, ::-1])
    one = HeightMap(face, lower.length, orientation="lower face")
    again = run(one, STEEL, ALUMINIUM, mean_pressure=100e6)
    for quantity, rel in (("contact area", 0.01), ("maximum pressure", 1e-3)):
        assert again[quantity].value == pytest.approx(answer[quantity].value, rel=rel)
    assert any("turned over about the axis y" in line for line in answer.face.done)


@pytest.fixture(scope="module")
def rough():
    return run(a_rough_map(), STEEL, mean_pressure=200e6)


SLIPPING = Body(
    layers=[{"thickness": 5e-6, "young": STEEL.young, "poisson": STEEL.poisson}], base="frictionless"
)


test_wrong_load_is_refused = refuses(
    (lambda: run(a_rough_map(), STEEL, mean_pressure=1e6, fields="xx"), "fields = 'xx': a list of"),
    (lambda: run(np.eye(8), STEEL, mean_pressure=1e6), "length: the edges .* of the map in m are needed"),
    (
        lambda: run(a_rough_map(), STEEL),
        "load.mean_pressure, hertz_pressure, .*: exactly one of them is needed, none",
    ),
    (
        lambda: run(a_rough_map(), SLIPPING, force=1.0, sliding={"friction": 0.4}),
        "sliding.friction = 0.4: .*frictionless, which bears no shear",
    ),
    (
        lambda: run({"file": "a.x3p", "radius": 1.0, "form": "cylinder", "ends": "y"}, STEEL, force=1.0),
        "map.ends = y: x or none is needed, a cylinder ends across its axis",
    ),
    (
        lambda: run("a.x3p", STEEL, {"map": {"file": "b.x3p", "ends": "y"}}, force=1.0),
        "counter_body.map.ends: not accepted; it holds for both maps, give map.ends",
    ),
)


@pytest.mark.parametrize(
    ("key", "message"),
    [
        (("contact, area", None), "no number of this answer; near are contact area, contact area fraction"),
        (("maximum pressure", "upper"), "no number of this answer; see the attribute `records`"),
    ],
)
def test_an_unknown_number_is_answered_with_near_ones(rough, key, message):
    with pytest.raises(KeyError, match=message):
        rough.record(*key)


def test_neighbouring_balls_are_compared_with_one_alone():
    waves = 1e-9 * np.cos(2 * np.pi * np.arange(32) / 32)
    flat = HeightMap(waves[:, None] + waves, (32e-6, 32e-6), name="nearly flat")
    ball = {"file": flat, "radius": RADIUS / 2, "detrend": "none"}
    beside, alone = (run({**ball, "periodic": each}, STEEL, force=0.3) for each in ("declared", "none"))
    (told,) = (each.text for each in beside.warnings if each.subject == "neighbouring forms")
    pressure, area = (
        beside[quantity].value / alone[quantity].value - 1
        for quantity in ("maximum pressure", "contact area fraction")
    )
    assert f"contact area by {100 * area:+.2g} % and the maximum pressure by {100 * pressure:+.2g} %" in told
    assert pressure > 0.01
    assert not [each for each in alone.warnings if each.subject == "neighbouring forms"]


def test_cylinder_that_ends_across_its_axis_is_line_contact():
    """By default; the load per length, and the approach that the note explains, have closed forms."""
    flat = HeightMap(1e-12 * np.random.default_rng(0).normal(size=(8, 256)), (5e-6, 160e-6), periodic=True)
    answer = run({"file": flat, "detrend": "none", "radius": 1e-3, "form": "cylinder"}, STEEL, force=0.05)
    exact = LineHertz.from_load(0.05 / 5e-6, 1e-3, MODULUS)
    assert answer.contact.boundary == "free along x"
    assert answer["load per length"].value == pytest.approx(0.05 / 5e-6, rel=1e-6)
    assert answer["maximum pressure"].value == pytest.approx(exact.maximum_pressure, rel=3e-3)
    assert answer["maximum von Mises stress"].value == pytest.approx(
        0.5577 * exact.maximum_pressure, rel=5e-3
    )
    approach = 1e4 / (np.pi * MODULUS) * (1 + 2 * np.log(2 * 160e-6 / exact.half_width))
    assert answer["normal approach"].value == pytest.approx(approach, rel=2e-3)
    assert answer["normal approach"].note == "from the surface 160 µm beside a line of load"
    told = {each.subject for each in answer.warnings}
    assert "line contact" in told
    assert not told & {"mean lateral stress", "neighbouring forms", "contact at the edge of the map"}


def test_cylinder_among_its_images_is_confined():
    """The stress is Hertz's plus the lateral stress ν p̄/(1 − ν) of the confined cell, which a note states."""
    flat = HeightMap(1e-12 * np.random.default_rng(0).normal(size=(8, 128)), (10e-6, 160e-6), periodic=True)
    roller = {"radius": 1e-3, "form": "cylinder", "cylinder_axis": "y", "ends": "none"}
    answer = run({"file": flat, "detrend": "none", **roller}, STEEL, force=0.1)
    told = {each.subject: each.text for each in answer.warnings}
    assert {"line contact", "mean lateral stress"} <= set(told)
    assert "is endless along y" in told["line contact"]
    assert "spans 9.4 % of" in told["neighbouring forms"]
    assert not any("boundary to free" in text for text in told.values())
    modulus, load = STEEL.young / (1 - STEEL.poisson**2), 0.1 / 10e-6
    largest = np.sqrt(load * modulus / (np.pi * 1e-3))  # Johnson (1985), Eq. 4.45; von Mises 0.558 of it
    lateral = STEEL.poisson / (1 - STEEL.poisson) * answer["mean pressure"].value
    von_mises = answer["maximum von Mises stress"].value
    assert von_mises == pytest.approx(0.558 * largest + lateral, rel=0.015)  # seven nodes across the contact
    assert von_mises > 1.03 * 0.558 * largest
    assert f"{100 * lateral / von_mises:.2g} % of the maximum von Mises" in told["mean lateral stress"]


def test_patches_and_edges_carry_their_load():
    """A large ball, and a small one at the edge of the map."""
    x = np.arange(48) * 1e-6
    large = -((x[:, None] - 16e-6) ** 2 + (x - 16e-6) ** 2) / (2 * 200e-6)
    small = -((x[:, None] - 30e-6) ** 2 + (x - 47e-6) ** 2) / (2 * 20e-6)
    surface = HeightMap(np.maximum(large, small), (48e-6, 48e-6))
    answer = run({"file": surface, "detrend": "none", "periodic": "none"}, STEEL, force=0.05)
    pressure = answer.contact.pressure
    assert answer["contact spots"].value == 2
    first, second = answer.tables["contact_spots"].itertuples()
    assert first.nodes == np.count_nonzero(pressure[:, :32])
    assert first.load_N + second.load_N == pytest.approx(0.05)
    assert (first.y_m, first.x_m) == pytest.approx((16e-6, 16e-6), abs=1e-7)
    assert first.width_m == pytest.approx(2 * np.sqrt(first.area_m2 / np.pi), rel=0.02)  # a disc of pixels
    (told,) = (each for each in answer.warnings if each.subject == "contact at the edge of the map")
    assert 0 < told.size < 0.5
    assert told.size == pytest.approx(pressure[:, -1].sum() / pressure.sum())


def spots_of(touching):
    """Spots of a pressure of one on a periodic cell, a micrometre between nodes."""
    pressure = np.asarray(touching, float)
    grid = Grid(pressure.shape, tuple(1e-6 * n for n in pressure.shape))
    face = TreatedMap(pressure, grid, 2e-6, None)
    return contact_spots(face, SimpleNamespace(pressure=pressure, touching=pressure > 0))


def test_long_spots_of_a_cell_are_not_folded():
    """A bar of n × 1 nodes has the moments n²/12 and 1/12: length √(4 n²/π), width √(4/π)."""
    bar = np.zeros((20, 20))
    bar[6, 1:15] = 1
    for shift in (0, 3, 12):  # over the edge of the cell, too
        (spot,) = spots_of(np.roll(bar, (shift, 2 * shift), (0, 1))).itertuples()
        assert (spot.length_m, spot.width_m) == pytest.approx((15.797e-6, 1.1284e-6), rel=1e-4)
        middle = (6 + shift) % 20 * 1e-6, (7.5 + 2 * shift) % 20 * 1e-6
        assert (spot.y_m, spot.x_m, spot.angle_deg) == pytest.approx((*middle, 0))
        assert spot.spans == "none"
    blocks = np.kron(np.random.default_rng(2).random((10, 12)) < 0.35, np.ones((3, 3)))
    numbers = ["area_m2", "length_m", "width_m", "angle_deg"]
    tables = [spots_of(np.roll(blocks, shift, (0, 1))) for shift in ((0, 0), (11, 0), (5, 19))]
    for table in tables:
        assert (table["spans"] == "none").all()  # of 10 or more spots, some over edges and corners
        assert table[numbers].sort_values(numbers[:2]).to_numpy() == pytest.approx(
            tables[0][numbers].sort_values(numbers[:2]).to_numpy()
        )


def test_spots_that_span_the_cell_say_so():
    field = np.zeros((12, 20))
    field[3], field[:, 5] = 1, 1
    assert spots_of(field)["spans"].tolist() == ["x and y"]
    assert spots_of(np.ones((12, 20)))["spans"].tolist() == ["x and y"]
    field = np.zeros((12, 20))
    field[3], field[7, 2] = 1, 1
    ridge, node = spots_of(field).itertuples()
    assert (ridge.spans, node.spans) == ("x", "none")
    assert ridge.length_m == pytest.approx(np.sqrt(4 / np.pi) * 20e-6)
    diagonal = np.eye(12)[:, ::-1] + np.roll(np.eye(12)[:, ::-1], 1, 1)
    assert spots_of(diagonal)["spans"].tolist() == ["x and y"]
    half = diagonal.copy()
    half[:5] = 0
    assert spots_of(half)["spans"].tolist() == ["none"]


def test_peaks_are_those_of_the_map(rough):
    """Not of its mirror images; a peak on a mirror line lies half a spacing beyond the outermost node."""
    places, grid = rough.tables["peaks"][["y_m", "x_m"]].to_numpy(), rough.face.grid
    assert grid.mirrored
    assert (places >= -0.51 * grid.spacing[0]).all()
    assert (places <= grid.length[0] - 0.49 * grid.spacing[0]).all()


def test_a_spike_under_the_maximum_pressure_is_told():
    surface = a_rough_map()
    height = surface.height.copy()
    height[20, 30] += 30e-6
    spiky = replace(surface, height=height)
    maps = ({"file": spiky}, {"file": spiky, "despike": 8})
    answers = (run(each, STEEL, mean_pressure=90e6) for each in maps)
    told, removed = ({each.subject for each in answer.warnings} for answer in answers)
    assert {"maximum pressure on a spike", "pressure above Young's modulus"} <= told
    assert not {"maximum pressure on a spike", "despike of the map"} & removed


def test_section_through_the_extreme_value_holds_it(rough):
    """A section and a plane, computed anew, on nodes that are at most half a spacing from its place."""
    found = rough.extreme("von_mises")
    for values in (rough.section(), rough.section("y"), rough.plane()):
        assert float(values.max()) == pytest.approx(found.value, rel=0.15)
        assert float(values.max()) <= found.value * (1 + 1e-3)
