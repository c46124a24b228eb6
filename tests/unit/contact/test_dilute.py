"""Contacts that touch little, solved on candidate nodes, against solutions on the whole grid."""

import numpy as np
import pytest
from samples import HALF_SPACE, difference

import asperity as asp
from asperity.contact import dilute
from asperity.contact.response import response_on

LAYER = asp.Solid(1.0, 0.3, height=0.5)
COATED = asp.Solid(1.0, 0.3, 0.1, base=asp.Solid(0.3, 0.2))
PAIR = asp.TwoBodies(HALF_SPACE, asp.Solid(3.0, 0.2))


@pytest.fixture
def small_grids(monkeypatch):
    """Smaller grids may be split than pays."""
    monkeypatch.setattr(dilute, "MIN_POINTS", 128)


@pytest.fixture
def solved_twice(monkeypatch, small_grids):
    """Contacts on candidate nodes and on the whole grid, of the same arguments."""

    def solve(*arguments, **options):
        made = []
        init = dilute.CandidateProblem.__init__
        with monkeypatch.context() as patch:
            patch.setattr(
                dilute.CandidateProblem, "__init__", lambda *some: made.append(some[0]) or init(*some)
            )
            on_candidates = asp.solve_contact(*arguments, **options)
            assert made
            count = len(made)
            patch.setattr(dilute, "MAX_AREA", 0.0)
            whole = asp.solve_contact(*arguments, **options)
            assert len(made) == count
        return on_candidates, whole

    return solve


def patches(shape):
    """Nodes of spherical contacts at random places, and Hertzian pressures on them."""
    generator, (y, x) = np.random.default_rng(1), np.indices(shape)
    pressure = np.zeros(shape)
    for row, column in generator.integers(0, shape, (60, 2)):
        square = (y - row) ** 2 + (x - column) ** 2
        pressure += np.sqrt(np.maximum(1 - square / generator.integers(2, 60), 0))
    nodes = np.flatnonzero(pressure).astype(np.uint32)
    return nodes, pressure.reshape(-1)[nodes].astype(np.float32)


@pytest.mark.parametrize(
    ("boundary", "solid", "shape", "length"),
    [
        ("mirrored", HALF_SPACE, (128, 256), (1.0, 2.0)),
        ("mirrored", COATED, (257, 263), (1.0, 1.0)),
        ("periodic", HALF_SPACE, (256, 512), (1.0, 2.0)),
        ("periodic", HALF_SPACE, (257, 263), (1.0, 1.5)),
        ("periodic", LAYER, (300, 256), (1.0, 1.0)),
        ("periodic", COATED, (300, 256), (1.0, 1.0)),
        ("free", HALF_SPACE, (257, 512), (1.0, 1.7)),
        ("free", PAIR, (256, 256), (1.0, 1.0)),
        ("free along y", HALF_SPACE, (257, 512), (1.0, 1.7)),
        ("free along x", HALF_SPACE, (257, 263), (1.0, 1.0)),
    ],
)
@pytest.mark.parametrize(("division", "error"), [(dilute.DIVISION, 1e-3), (dilute.INNER_DIVISION, 1e-2)])
def test_displacement_of_candidates_is_that_of_the_whole_grid(
    boundary, solid, shape, length, division, error
):
    grid = asp.Grid(shape, length, mirrored=boundary == "mirrored")
    boundary = "periodic" if boundary == "mirrored" else boundary
    response = response_on(boundary, solid, grid, omits_mean=boundary == "periodic")
    nodes, pressure = patches(shape)
    field = np.zeros(shape)
    field.reshape(-1)[nodes] = pressure
    exact = response.displacement(field).reshape(-1) / response.nodal_compliance
    every = np.arange(exact.size, dtype=np.uint32)
    assert dilute.can_be_split(response)
    split = dilute.SplitResponse(response, division)
    assert difference(split.displacement(pressure, nodes, every), exact) < error


@pytest.mark.parametrize(
    ("solid", "options", "seed"),
    [
        *((HALF_SPACE, {}, seed) for seed in range(3)),
        (HALF_SPACE, {"boundary": "free"}, 0),
        (HALF_SPACE, {"boundary": "free"}, 1),
        (HALF_SPACE, {"boundary": "free along x"}, 2),
        (HALF_SPACE, {"hardness": 0.04}, 2),
        (HALF_SPACE, {"dtype": "float32", "rtol": 1e-4}, 1),
        (LAYER, {}, 0),
        (COATED, {"rtol": 1e-8}, 2),
        (PAIR, {"boundary": "free", "hardness": 0.03}, 0),
        (HALF_SPACE, {"mirrored": True}, 1),
        (HALF_SPACE, {"mirrored": True}, 2),
        (LAYER, {"mirrored": True, "hardness": 0.04}, 0),
    ],
)
def test_pressure_is_that_of_the_whole_grid(solid, options, seed, solved_twice):
    """Errors of the pressure add up: each estimate is too small by a factor of a few at most."""
    shape = [(256, 512), (263, 269), (400, 200)][seed]
    hurst, load = (0.8, 0.2, 0.5)[seed], (2e-5, 1e-4, 2e-4)[seed]
    height = asp.self_affine(shape, hurst, 0.25, 0.02, rms_height=2e-3, seed=seed)
    grid = asp.Grid(shape, (1.0, shape[1] / shape[0]), options.get("mirrored", False))
    options = {name: value for name, value in options.items() if name != "mirrored"} | {"length": grid}
    found, whole = solved_twice(height, solid, mean_pressure=load, **options)
    assert 0 < whole.contact_area_fraction < dilute.MAX_AREA
    assert difference(found.pressure, whole.pressure) < 5 * options.get("rtol", 1e-6)
    assert found.certificate.pairs < whole.certificate.pairs
    approach = asp.solve_contact(height, solid, approach=whole.approach, **options)
    assert difference(approach.pressure, whole.pressure) < 2e2 * options.get("rtol", 1e-6)
    area = asp.solve_contact(height, solid, contact_area_fraction=whole.contact_area_fraction, **options)
    assert area.contact_area_fraction == pytest.approx(whole.contact_area_fraction, rel=1e-3)


@pytest.mark.parametrize("edges", ["periodic", "mirrored", "free"])
@pytest.mark.parametrize("kind", ["node", "punch", "sphere", "spikes", "corner", "steps"])
def test_pressure_under_other_shapes_is_that_of_the_whole_grid(kind, edges, solved_twice):
    shape = (383, 509) if edges == "free" else (384, 512)  # primes are padded to other numbers
    y, x = np.indices(shape) / 384
    rows, columns = np.ogrid[: shape[0], : shape[1]]
    height = {
        "node": np.where((rows == 200) & (columns == 3), 0.0, 1.0),
        "punch": np.where((abs(y - 0.4) < 0.04) & (abs(x - 0.7) < 0.03), 0.0, 0.1),
        "sphere": (y - 0.47) ** 2 + (x - 0.99) ** 2,
        "spikes": np.where((rows % 37 == 0) & (columns % 41 == 0), -0.01, 0) + x**4,
        "corner": np.hypot(y, x) + 0.1 * np.hypot(y - 0.5, x - 4 / 3),
        "steps": np.round(asp.self_affine(shape, 0.8, 0.25, 0.02, rms_height=1e-3, seed=3), 4),
    }[kind]
    grid = asp.Grid(shape, (1.0, shape[1] / shape[0]), edges == "mirrored")
    boundary = "free" if edges == "free" else "periodic"
    found, whole = solved_twice(height, HALF_SPACE, grid, force=1e-4, boundary=boundary)
    assert difference(found.pressure, whole.pressure) < 5e-6


@pytest.mark.parametrize("division", dilute.DIVISIONS, ids=lambda division: f"{division.error:g}")
@pytest.mark.parametrize("points", [300, 301])
def test_displacement_by_a_division_is_that_of_the_whole_grid(points, division):
    response = response_on("free", PAIR, asp.Grid((points, 300), (1.0, 300 / points)))
    nodes, pressure = patches(response.grid.shape)
    problem = dilute.Problem(np.zeros(response.grid.shape), response)
    exact = problem.displacement(nodes, pressure.astype(float))
    divided = dilute.DividedProblem(problem, dilute.SplitResponse(response, division))
    found = divided.displacement(nodes, pressure.astype(float))
    assert difference(found, exact) < division.error


def test_threads_change_no_bit(small_grids):
    height = asp.self_affine((512, 512), 0.5, 0.25, 0.02, rms_height=2e-3, seed=4)
    for boundary in ("periodic", "free"):
        one, two = (
            asp.solve_contact(height, HALF_SPACE, mean_pressure=2e-4, boundary=boundary, threads=threads)
            for threads in (1, 2)
        )
        np.testing.assert_array_equal(one.pressure, two.pressure)


def test_dilute_contact_takes_five_pairs():
    """Two pairs of the whole grid in double precision, a few on coarser grids, and the far field."""
    height = asp.self_affine((1024, 1024), 0.8, 0.25, 8 / 1024, rms_height=1e-3, seed=1)
    for load in (4e-5, 3.5e-4):
        contact = asp.solve_contact(height, HALF_SPACE, mean_pressure=load)
        assert 1e-4 < contact.contact_area_fraction < 0.01
        assert contact.certificate.pairs < 5


def test_an_area_that_a_flat_cannot_have_is_sought_on_the_whole_grid(small_grids):
    """Candidates take ten times as many steps to the nearest area, the flat."""
    height = np.ones((256, 256))
    height[:4, :6] = 0
    grid = asp.Grid(height.shape, (256.0, 256.0), mirrored=True)
    contact = asp.solve_contact(height, HALF_SPACE, grid, contact_area_fraction=48 / height.size, rtol=1e-3)
    assert np.count_nonzero(contact.pressure) == 24
    assert contact.certificate.pairs < 25
