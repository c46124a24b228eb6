"""Extreme values between nodes and planes, against Hertz's closed form, finer grids and the cell of four."""

import numpy as np
import pytest
from samples import HALF_SPACE, centred, hardened, invariants, rough, spots

import asperity as asp
from asperity.fourier.grid import Fourier, Grid, resample, with_mirror_images
from asperity.stress.extremes import DIRECTION, Extremes, largest_of

COATED = asp.Solid(1.0, 0.2, height=0.05, base=asp.Solid(0.3, 0.4))


def extremes_of(contact, tolerance=1e-6, fields=(), **sliding):
    loaded = asp.LoadedSolid.of(contact)
    found = Extremes(loaded.layer, fields)
    asp.analyse_stress(loaded, quantities=("von_mises",), tolerance=tolerance, observe=found.add, **sliding)
    return found.refined(loaded, tolerance, **sliding)


def test_extremes_are_those_of_hertz():
    """Under a ball: 0.6200 and 0.3100 of the largest pressure at ν = 0.3 (K. L. Johnson 1985, Eq. 3.45)."""
    grid, radius = Grid((64, 64)), 0.3
    y, x = centred(grid)
    pressure = np.sqrt(np.maximum(1 - ((x - 0.003) ** 2 + (y + 0.004) ** 2) / radius**2, 0))
    (found,) = extremes_of(asp.LoadedSolid(pressure, grid, HALF_SPACE, "free"))
    depth = radius * np.linspace(0.3, 0.7, 4001)
    z = depth / radius
    along = 0.5 / (1 + z**2) - 1.3 * (1 - z * np.arctan(1 / z))
    shear = np.abs(along + 1 / (1 + z**2)) / 2
    assert found["maximum_shear"].value == pytest.approx(shear.max(), rel=2e-3)
    assert found["von_mises"].value == pytest.approx(2 * shear.max(), rel=2e-3)
    assert found["von_mises"].depth == pytest.approx(depth[shear.argmax()], rel=0.02)
    assert found["principal_3"].value == pytest.approx(-1.0, rel=2e-3)
    assert found["hydrostatic"].value == pytest.approx(-2 * 1.3 / 3, rel=2e-3)
    assert found["von_mises"].y == pytest.approx(0.5 - 0.5 / 64 - 0.004, abs=2e-3)
    assert found["von_mises"].x == pytest.approx(0.5 - 0.5 / 64 + 0.003, abs=2e-3)


def test_extreme_between_nodes_is_found_where_nodes_of_another_contact_are_higher():
    """Two alike contacts, one with its middle between four nodes: at nodes the weaker one is higher."""
    grid = Grid((64, 64))
    y, x = np.mgrid[:64, :64] / 64
    on_node, between = ((16 / 64, 16 / 64, 0.97), (47.5 / 64, 46.5 / 64, 1.0))
    pressure = sum(
        size * np.exp(-((y - at_y) ** 2 + (x - at_x) ** 2) * (0.6 * 64) ** 2)
        for at_y, at_x, size in (on_node, between)
    )
    loaded = asp.LoadedSolid(np.asarray(pressure), grid, HALF_SPACE, "periodic")
    stress = asp.analyse_stress(loaded, quantities=("von_mises",))
    (found,) = extremes_of(loaded)
    assert (found["von_mises"].y, found["von_mises"].x) == pytest.approx(between[:2], abs=0.5 / 64)
    assert found["von_mises"].value > 1.02 * float(stress["maximum_von_mises"].max())


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("layer", [HALF_SPACE, COATED], ids=["half-space", "coated"])
@pytest.mark.parametrize("boundary", ["periodic", "mirrored", "free"])
def test_bounds_of_one_point_hold_for_extremes(layer, boundary, friction):
    """Also of each material of a coated body; and the tensor of each point gives its value."""
    if boundary == "free" and layer is COATED:
        pytest.skip("a free boundary needs a half-space")
    loaded = spots(layer=layer, boundary="free" if boundary == "free" else "periodic", seed=3)
    if boundary == "mirrored":
        loaded = asp.LoadedSolid(loaded.pressure, Grid(loaded.grid.shape, mirrored=True), layer)
    parts = extremes_of(loaded, friction=friction, fields=("xz",))
    assert len(parts) == (2 if layer is COATED else 1)
    for part in [*parts, largest_of(parts)]:
        von_mises, shear = part["von_mises"].value, part["maximum_shear"].value
        assert von_mises <= 2 * shear <= 2 * von_mises / np.sqrt(3)
        assert part["principal_1"].value >= part["hydrostatic"].value >= part["principal_3"].value
        for name, each in part.items():
            fields = invariants(np.array(each.stress)) | {"xz": each.stress[4]}
            assert each.value == pytest.approx(fields[name], rel=1e-9, abs=1e-12)
            assert 0 <= each.y < 1
            assert 0 <= each.x < 1
    whole = largest_of(parts)
    for name, sign in DIRECTION.items():
        assert sign * whole[name].value == max(sign * part[name].value for part in parts)


@pytest.mark.parametrize("seed", range(4))
def test_extremes_are_those_of_eight_times_as_many_nodes(seed):
    """Of the same band-limited pressure; in the surface the stress has kinks at the edges of the contacts."""
    contact = asp.solve_contact(rough(seed=seed), HALF_SPACE, contact_area_fraction=0.1)
    grid, fine = contact.grid, Grid((512, 512))
    modes = resample(Fourier(grid).forward(contact.pressure), grid, fine)
    pressed = asp.LoadedSolid(Fourier(fine).inverse(modes), fine, HALF_SPACE)
    sliding = {"friction": 0.1 * seed}
    (found,) = extremes_of(contact, **sliding)
    for name in ("von_mises", "maximum_shear"):
        depths = np.unique(np.maximum(found[name].depth + np.array([-0.1, 0.0, 0.1]) / 64, 0.0))
        planes = asp.stress_planes(pressed, depths, fields=(name,), tolerance=0.0, **sliding)
        largest = max(plane.fields[name].max() for plane in planes)
        assert found[name].value == pytest.approx(largest, rel=5e-3 if found[name].depth else 0.02)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_extremes_are_those_of_the_cell_of_four(friction):
    pressure = spots((24, 30), seed=2).pressure
    grid = Grid(pressure.shape, mirrored=True)
    pair = (
        asp.LoadedSolid(pressure, grid, HALF_SPACE),
        asp.LoadedSolid(with_mirror_images(pressure, grid), grid.whole_cell, HALF_SPACE),
    )
    found, expected = (extremes_of(each, friction=friction)[0] for each in pair)
    for name in found:
        assert found[name].value == pytest.approx(expected[name].value, rel=2e-3)
        assert found[name].depth == pytest.approx(expected[name].depth, abs=0.2 / 30)
        if friction:
            assert found[name].on_image == (not -0.5 / 30 <= expected[name].x < 1 - 0.5 / 30)


def test_extremes_under_a_hardness_are_those_at_nodes():
    contact = hardened(rough(), 0.5)
    (found,) = extremes_of(contact)
    planes = asp.analyse_stress(contact, quantities=("von_mises",))
    assert found["von_mises"].value == pytest.approx(float(planes["maximum_von_mises"].max()), rel=1e-6)
    for each in found.values():
        assert each.depth in planes["plane_depth"]
        assert (np.array([each.y, each.x]) * 64) % 1 == pytest.approx(0, abs=1e-9)
