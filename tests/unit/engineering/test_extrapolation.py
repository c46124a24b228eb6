"""Estimates at zero grid spacing, against finer grids and the closed form of Hertz."""

import re

import numpy as np
import pytest
from project import ROOT
from samples import refuses, rough

import asperity as asp
from asperity.contact.half_grid import on_half_the_nodes, solve_on_half
from asperity.engineering.continuum import continuum_on_grids, solved_on_half
from asperity.fourier.grid import Grid
from asperity.stress.exceedance import Exceedance
from asperity.stress.extremes import DIRECTION, Extremes
from asperity.stress.statistics.extrapolation import BOUNDARY_SHARE, extreme_error
from asperity.surface.treatment.levelling import low_pass

LAYER = asp.Solid(young=1.0, poisson=0.33)


def contact_on(nodes, hurst=0.8, **load):
    """A contact with a number of nodes on the shortest wavelength."""
    height = asp.self_affine((16 * nodes,) * 2, hurst, 1 / 4, 1 / 16, rms_height=1e-3, seed=5)
    return asp.solve_contact(height, LAYER, **load)


def stress_of(contact):
    return asp.analyse_stress(
        contact, poisson=[0.0, 0.33], quantities=("pressure", "von_mises"), covariances=True
    )


def pillars():
    return 1e-3 * (np.arange(32)[:, None] // 8 % 2 + np.arange(32) // 8 % 2)


@pytest.fixture(scope="module")
def on_two_grids():
    """Estimates on 8 and on 32 nodes."""
    coarse = contact_on(8, contact_area_fraction=0.08)
    fine = contact_on(32, mean_pressure=coarse.mean_pressure)
    return asp.continuum_limit(coarse, stress_of(coarse)), asp.continuum_limit(fine, stress_of(fine))


@pytest.mark.parametrize(
    ("output", "tolerance"),
    [
        ("contact_area_fraction", 0.01),
        ("gradient_rms_contact", 0.009),
        ("proportionality", 0.015),
        ("p90", 0.03),
        ("p99", 0.02),
        ("mean_depth", 0.05),
    ],
)
def test_estimate_is_that_of_a_finer_grid(on_two_grids, output, tolerance):
    """Bounds: the grid error of one small surface, some times the medians of continuum.md."""
    coarse, fine = (grid[output] for grid in on_two_grids)
    truth = fine.sel(kind="estimate")
    error = abs(coarse.sel(kind="estimate") / truth - 1).fillna(0)  # pressure has no depth
    assert float(error.max()) < tolerance
    before = abs(coarse.sel(kind="on_grid") / truth - 1).fillna(0)
    assert float(before.mean()) > float(error.mean())


@pytest.mark.parametrize(
    ("hurst", "waves", "area"), [(0.8, 4, 0.02), (0.5, 4, 0.45), (0.8, 4, 0.9), (0.95, 20, 0.85)]
)
def test_stated_errors_cover_the_true_ones(hurst, waves, area):
    """Against four times as many nodes; of many surfaces, 97 to 100 % are covered (continuum.md)."""
    long = 1 / max(16 // waves, 1)

    def estimates(nodes, **load):
        points = round(nodes * waves / long)
        height = asp.self_affine((points, points), hurst, long, long / waves, rms_height=1e-3, seed=7)
        contact = asp.solve_contact(height, LAYER, **load)
        return contact, asp.continuum_limit(contact, stress_of(contact))

    contact, found = estimates(8, contact_area_fraction=area)
    truth = estimates(32, mean_pressure=contact.mean_pressure)[1].sel(kind="estimate")
    true = abs(found.sel(kind="estimate") / truth - 1)
    over = np.concatenate([(true[name] / found[name].sel(kind="error")).values.ravel() for name in found])
    over = over[np.isfinite(over)]
    assert over.size == 23
    assert (over <= 1).mean() > 0.8
    assert over.max() < 2


@pytest.mark.parametrize("area", [0.98, 1.0])
def test_no_estimate_where_almost_all_is_in_contact(area):
    found = asp.continuum_limit(contact_on(4, contact_area_fraction=area))
    assert "out of contact, and 200 are needed" in found.attrs["reason"]


def test_boundary_share_gives_the_area_of_hertz():
    excess, edges = [], []
    for seed in range(4):
        place = np.random.default_rng(seed).random(2)
        y, x = ((np.arange(96) + shift) / 96 - 0.5 for shift in place)
        height = (x[None, :] ** 2 + y[:, None] ** 2) / 2
        radius = 0.09
        load = 4 / 3 * LAYER.effective_modulus * radius**3  # Hertz, on a cell of unit area
        touching = asp.solve_contact(height, LAYER, boundary="free", mean_pressure=load).pressure > 0
        excess.append(touching.mean() - np.pi * radius**2)
        edges.append(sum((touching != np.roll(touching, 1, axis)).mean() for axis in (0, 1)))
    share = np.sum(excess) / np.sum(edges)
    assert share == pytest.approx(BOUNDARY_SHARE, rel=0.35)  # discs have 0.08 to 0.09


def ridges():
    height = 1e-3 * np.cos(2 * np.pi * np.arange(128) / 128) * np.ones((128, 1))
    return asp.solve_contact(height, LAYER, mean_pressure=1e-5)


def at_hardness():
    contact = asp.solve_contact(
        contact_on(8, contact_area_fraction=0.2).height, LAYER, contact_area_fraction=0.2, hardness=0.01
    )
    assert contact.plastic_area > 0
    return contact


def worn(nodes, **load):
    """A plateau: the minimum of two Gaussian surfaces, which has creases."""
    fields = [
        asp.self_affine((16 * nodes,) * 2, 0.8, long, 1 / 16, rms_height=1e-3, seed=seed)
        for long, seed in ((1 / 2, 5), (1 / 4, 6))
    ]
    return asp.solve_contact(np.maximum(fields[0], 0.3 * fields[1] - 2e-4), LAYER, **load)


CASES = {
    "elastic, in a periodic cell": (lambda: contact_on(8, contact_area_fraction=0.2), ""),
    "the pressure reaches a hardness": (at_hardness, ""),
    "ridges are straight": (ridges, ""),
    "creases, steps or noise": (lambda: worn(8, contact_area_fraction=0.2), ""),
    "flat or stepped heights in contact": (
        lambda: asp.solve_contact(pillars(), LAYER, mean_pressure=1e-5),
        "flat or stepped",
    ),
    "fewer than 200 nodes in contact, or out of contact": (
        lambda: contact_on(8, contact_area_fraction=0.005),
        "nodes are in contact, and 200",
    ),
    "free boundary": (lambda: contact_on(4, contact_area_fraction=0.3, boundary="free"), "boundary is free"),
}
"""Contact as the page calls it, how it is made, and the reason against all of its estimates."""
ROWS = re.findall(
    r"^\| (.+?) \| ((?:(?:yes|no) \| ?){4})$", (ROOT / "docs/errors.md").read_text("utf-8"), re.MULTILINE
)
NUMBERS = (
    ["contact_area_fraction", "gradient_rms_contact"],
    ["maximum"],
    ["mean_depth"],
    ["decay_length_depth"],
)
"""The columns of the page."""


@pytest.mark.parametrize(("name", "says"), ROWS)
def test_page_says_which_numbers_have_an_estimate(name, says):
    make, reason = CASES[name]
    contact = make()
    found = asp.continuum_limit(contact, stress_of(contact))
    assert reason in found.attrs.get("reason", "")
    assert bool(reason) == ("reason" in found.attrs)
    assert np.isfinite(found["contact_area_fraction"].sel(kind="on_grid"))
    known = [bool(found[each].sel(kind="estimate").to_array().notnull().any()) for each in NUMBERS]
    assert ["yes" if each else "no" for each in known] == re.findall("yes|no", says)


def test_page_has_all_reasons_against_an_estimate():
    assert [name for name, _ in ROWS] == [*CASES]


@pytest.mark.parametrize("nodes", [2, 4, 8])
def test_extremes_on_creases_have_no_estimate(nodes):
    """They grow with every refinement; a smooth surface on as many nodes has estimates."""
    found = asp.continuum_limit(contact := worn(nodes, contact_area_fraction=0.4), stress_of(contact))
    assert "extreme stresses grow with every refinement" in found.attrs["reason_of_stress"]
    assert found[["p90", "p99", "maximum"]].sel(kind="estimate").to_array().isnull().all()
    assert np.isfinite(found["contact_area_fraction"].sel(kind="error"))
    smooth = asp.continuum_limit(contact := contact_on(nodes, contact_area_fraction=0.4), stress_of(contact))
    assert "reason_of_stress" not in smooth.attrs
    assert np.isfinite(smooth["maximum"].sel(kind="estimate")).all()


def test_stress_on_a_crease_grows_with_every_refinement():
    finest = worn(32, contact_area_fraction=0.2)
    largest = [worn(nodes, mean_pressure=finest.mean_pressure).maximum_pressure for nodes in (4, 8, 16)]
    largest.append(finest.maximum_pressure)
    assert (np.diff(largest) > 0.05 * np.array(largest[:-1])).all()


def extremes_on(nodes, **load):
    """Contact, extreme values and estimates on a number of nodes, and the volume above a stress."""
    contact, limit = contact_on(nodes, **load), 0.02
    found, volume = Extremes(LAYER), Exceedance(limit)

    def observe(plane):
        found.add(plane)
        volume.add(plane.depth, plane.grid, plane.field("von_mises", LAYER.poisson))

    quantities = "pressure", "von_mises"
    stress = asp.analyse_stress(contact, quantities=quantities, tolerance=1e-4, observe=observe)
    values = {name: each.value for name, each in found.refined(contact.in_body("lower"), 1e-4)[0].items()}
    volume.finish(values["von_mises"])
    estimates = continuum_on_grids(contact, solved_on_half(contact), stress, "lower", extremes=values)
    return contact, estimates, volume


def test_extremes_have_one_error_that_covers_the_true_one():
    """Against 16 nodes; the largest peak and the volume above yield use the same error."""
    fine, truth, exact = extremes_on(16, contact_area_fraction=0.2)
    for nodes in (2, 4):
        _, found, volume = extremes_on(nodes, mean_pressure=fine.mean_pressure)
        for name in DIRECTION:
            on_grid, _, estimate, error = found["extreme"].sel(field=name).values
            assert estimate == on_grid
            assert abs(estimate - truth["extreme"].sel(field=name, kind="on_grid")) <= error * estimate
            assert extreme_error(found, name) == error
        assert 0 < abs(volume.volume - exact.volume) <= volume.error(found, 3)


def test_volume_without_peaks_has_an_error_where_the_stress_may_reach_the_limit():
    """Error of the volume above 0 if, and only if, the largest stress and its error reach the limit."""
    contact, found, _ = extremes_on(4, contact_area_fraction=0.2)
    largest = float(found["extreme"].sel(field="von_mises", kind="on_grid"))
    error, depths = extreme_error(found, "von_mises"), asp.stress.depth_grid(contact.grid, 0.5)
    planes = list(asp.stress_planes(contact, depths))
    for over, may_yield in ((1.01, True), (1 + 0.8 * error, True), (1.05 + error, False)):
        each = Exceedance(over * largest)
        for plane in planes:
            each.add(plane.depth, plane.grid, plane.fields["von_mises"][0])
        each.finish(largest)
        assert each.volume == 0
        assert (each.error(found, 0) > 0) == may_yield


def test_fewer_contact_nodes_leave_the_error_unknown():
    """It is not zero."""
    _, found, volume = extremes_on(8, contact_area_fraction=0.005)
    assert "200 are needed" in found.attrs["reason"]
    assert np.isnan(volume.error(found, 1))
    assert np.isnan(extreme_error(found, "von_mises"))


@pytest.mark.parametrize(("points", "phase"), [(80, 0.0), (100, 0.3), (128, 0.0), (128, 0.3), (256, 0.0)])
def test_straight_ridges_are_within_the_error(points, phase):
    """Contact of 3 % of a wave (Westergaard, J. Appl. Mech. 6 (1939) A49), 2 to 9 nodes wide."""
    height = 1e-3 * np.cos(2 * np.pi * (np.arange(points) + phase) / points) * np.ones((points, 1))
    load = np.pi * LAYER.effective_modulus * 1e-3 * np.sin(np.pi * 0.03 / 2) ** 2
    contact = asp.solve_contact(height, LAYER, mean_pressure=load)
    found = asp.continuum_limit(contact, stress_of(contact))
    _, _, estimate, error = found["contact_area_fraction"].values
    assert abs(estimate - 0.03) <= estimate * error
    assert "ridges are straight" in found.attrs["reason_of_stress"]
    assert found["p99"].sel(kind="estimate").isnull().all()


@pytest.mark.parametrize("kind", ["gaussian", "lay", "skewed"])
def test_only_other_surfaces_have_a_least_error(kind):
    """Errors of isotropic Gaussian surfaces are those that paper/supplement/continuum.md lists for them."""
    height = asp.self_affine((128, 128), 0.8, 1 / 4, 1 / 16, rms_height=1e-3, seed=5)
    length = (4.0, 1.0) if kind == "lay" else 1.0  # the same heights, four times as long along y
    height = asp.surface.johnson(height, 0.6, 1.0) if kind == "skewed" else height
    least = asp.continuum_limit(asp.solve_contact(height, LAYER, length, contact_area_fraction=0.1)).attrs[
        "least_error"
    ]
    assert (least > 0) == (kind != "gaussian")


def test_a_number_whose_error_exceeds_it_has_no_estimate():
    """Narrow tips of squared heights, with two nodes on the shortest wave: no depths."""
    height = -(asp.self_affine((96, 96), 0.8, 1 / 4, 1 / 32, rms_height=1.0, seed=1) ** 2)
    contact = asp.solve_contact(1e-3 * height, LAYER, contact_area_fraction=0.1)
    found = asp.continuum_limit(contact, stress_of(contact))
    error, estimate = (found.sel(kind=kind) for kind in ("error", "estimate"))
    assert np.isfinite(error["contact_area_fraction"])
    assert estimate[["mean_depth", "mean_depth_highest"]].to_array().isnull().all()
    assert not (error.to_array() > 1).any()
    assert (error.isnull() == estimate.isnull()).to_array().all()


def test_waves_below_four_nodes_are_estimated_too():
    """Two nodes on the shortest wave against eight; the area on two errs by a third."""
    coarse = contact_on(2, contact_area_fraction=0.3)
    fine = asp.continuum_limit(contact_on(8, mean_pressure=coarse.mean_pressure))
    truth = float(fine["contact_area_fraction"].sel(kind="estimate"))
    found = asp.continuum_limit(coarse)
    on_grid, _, estimate, error = found["contact_area_fraction"].values
    assert found.attrs["lost_gradient"] > 0.2
    assert abs(estimate / truth - 1) < min(error, 0.5 * abs(on_grid / truth - 1))


@pytest.mark.parametrize("shape", [(32, 40), (30, 33)])
def test_half_of_a_mirrored_map_is_mirrored(shape):
    """Against cosine series, whose points are the centres of pixels on both grids."""
    part = asp.self_affine((64, 64), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=5)[: shape[0], : shape[1]]
    grid = Grid(shape, (0.5, 0.6), mirrored=True)
    found, half, _ = on_half_the_nodes(part, grid)
    assert half == Grid((shape[0] // 2, shape[1] // 2), (0.5, 0.6), mirrored=True)
    expected = low_pass(part, grid, half, None)
    np.testing.assert_allclose(found, expected + part.mean(), atol=1e-15)


def test_one_mirrored_node_grows_with_its_pixel():
    """A quarter of the pressure on four times the area."""
    height = np.random.default_rng(1).normal(size=(16, 16))
    height[5, 7] = -50.0
    grid = Grid(height.shape, mirrored=True)
    contact = asp.solve_contact(1e-3 * height, LAYER, grid, mean_pressure=1e-6)
    half, _ = solve_on_half(contact.height, LAYER, grid, mean_pressure=1e-6)
    assert half.contact_area_fraction == pytest.approx(4 * contact.contact_area_fraction)


CONTACT = asp.solve_contact(rough(), LAYER, contact_area_fraction=0.1)


test_wrong_argument_is_refused = refuses(
    (
        lambda: asp.continuum_limit(CONTACT, CONTACT.to_dataset()),
        "stress: a result of analyse_stress is needed",
    ),
    (lambda: asp.continuum_limit(np.zeros((4, 4))), "contact = ndarray: a Contact is needed"),
)
