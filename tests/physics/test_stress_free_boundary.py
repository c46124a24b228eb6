"""Stress under an isolated map against closed forms of single contacts."""

from dataclasses import replace

import numpy as np
import pytest
from samples import HALF_SPACE, centred, order

import asperity as asp
from asperity.elasticity.solid import COMPONENTS
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.stress.planes.fields import FIELDS

RATIOS = [0.0, 0.3, 0.5]


def ellipse(a, b, shape, length=1.0):
    """Pressure √(1 − x²/a² − y²/b²) about the node in the middle of the map, averaged over each pixel."""
    grid, parts = asp.Grid(shape, length), 16
    within = (np.arange(parts) + 0.5) / parts - 0.5
    y, x = (
        ((np.arange(n) - n // 2)[:, None] + within).ravel() * step
        for n, step in zip(shape, grid.spacing, strict=True)
    )
    pressure = np.sqrt(np.maximum(1 - (y[:, None] / b) ** 2 - (x[None, :] / a) ** 2, 0.0))
    pressure = pressure.reshape(shape[0], parts, shape[1], parts).mean(axis=(1, 3))
    return asp.LoadedSolid(pressure, grid, HALF_SPACE, "free")


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_sphere_at_rest_and_sliding(friction):
    """All components at every node against Hertz, and Hamilton and Goodman (J. Appl. Mech. 33 (1966) 371).

    The error comes from the pixels, of order h².
    """
    radius, points, errors = 0.3, [48, 96], []
    sphere = SlidingSphere(Hertz(radius, curvature_radius=2 / np.pi * radius), friction)
    for n in points:
        solid, worst = ellipse(radius, radius, (n, n)), []
        y, x = (place - 0.5 for place in solid.grid.coordinates())
        depths = radius * np.array([0.2, 0.5, 1.0, 3.0, 20.0])
        for plane in asp.stress_planes(solid, depths, RATIOS, COMPONENTS, 0, friction=friction):
            expected = [sphere.stress(y[:, None], x[None, :], plane.depth, nu) for nu in RATIOS]
            found = np.stack([plane.fields[name] for name in COMPONENTS], axis=-1)
            worst.append(np.abs(found - expected).max() / np.abs(expected).max())
        errors.append(max(worst))
    assert errors[1] < 3e-3
    assert order(points, errors) > 1.5


def test_sphere_between_steel_and_aluminium():
    """Pressure and von Mises stress on the axis of both bodies, of the solved contact; grid error."""
    pair, radius = asp.TwoBodies(asp.Solid(210e9, 0.3), asp.Solid(70e9, 0.33)), 1e-4
    exact = EllipticHertz(radius, radius, 1e9, pair.effective_modulus)
    grid = asp.Grid((49, 49), 2.3 * radius)
    y, x = centred(grid)
    height = (x**2 + y**2) / (2 * exact.curvature_radii[0])
    contact = asp.solve_contact(height, pair, grid.length, force=exact.load, boundary="free")
    assert contact.maximum_pressure == pytest.approx(1e9, rel=1e-3)
    depths = np.linspace(0.2, 1.0, 81) * radius
    for name in ("lower", "upper"):
        body = contact.in_body(name)
        planes = asp.stress_planes(body, depths, fields=("von_mises",), tolerance=0)
        values = np.array([plane.fields["von_mises"][0, 24, 24] for plane in planes])
        expected = exact.maximum_von_mises_on_axis(body.layer.poisson)
        assert values.max() == pytest.approx(expected.value, rel=2e-3)
        assert depths[values.argmax()] == pytest.approx(expected.depth, abs=0.005 * radius)


def sharp(boundary):
    solid = ellipse(0.3, 0.2, (192, 192))
    solid.pressure[:, ::3] *= 0.5
    solid.pressure[:8, -8:] = 1.0
    return replace(solid, boundary=boundary)


def smooth(boundary):
    """A pressure without short waves, of which coarse planes drop nothing: what is left is aliasing."""
    y, x = centred(asp.Grid((192, 192)))
    return asp.LoadedSolid(np.exp(-(y**2 + x**2) / 0.08**2), asp.Grid((192, 192)), HALF_SPACE, boundary)


@pytest.mark.parametrize(
    ("make", "boundary", "friction", "tolerance"),
    [
        (sharp, "free", 0.0, 1e-6),
        (sharp, "free", 0.5, 1e-3),
        (smooth, "free", 0.0, 1e-3),
        *((sharp, f"free along {axis}", friction, 1e-4) for axis in "yx" for friction in (0.0, 0.5)),
    ],
)
def test_coarse_planes_are_within_their_bound(make, boundary, friction, tolerance):
    """At the nodes that both grids have, for every field."""
    solid, nodes = make(boundary), []
    depths = np.array([0.01, 0.02, 0.05, 0.1, 0.3, 1.0, 5.0])
    settings = {"poisson": 0.2, "fields": FIELDS, "friction": friction}
    coarse, fine = (asp.stress_planes(solid, depths, tolerance=t, **settings) for t in (tolerance, 0))
    for plane, full in zip(coarse, fine, strict=True):
        nodes.append(plane.grid.shape[0])
        every, other = (np.lcm(nodes[-1], 192) // n for n in (192, nodes[-1]))
        assert boundary != "free" or plane.bound <= tolerance * np.abs(full.fields["zz"]).max()
        for name in FIELDS:
            shared = plane.fields[name][0, ::every, ::every] - full.fields[name][0, ::other, ::other]
            assert np.abs(shared).max() <= plane.bound + 1e-12
    assert nodes[-1] == 48


def test_nodes_at_opposite_edges_are_no_neighbours():
    """Two contacts at opposite edges: both have their peaks, and the higher hides the other in a period."""
    pressure, grid = np.zeros((48, 48)), asp.Grid((48, 48))
    pressure[24, 0], pressure[24, 47] = 1.0, 0.8
    names = ("pressure", "von_mises")
    solids = (asp.LoadedSolid(pressure, grid, HALF_SPACE, kind) for kind in ("free", "periodic"))
    free, periodic = (asp.analyse_stress(solid, poisson=0.3, quantities=names) for solid in solids)
    for name in names:
        alone, hidden = (
            asp.stress.select_peaks(each, name, selection="at_contact")["peak_x"] for each in (free, periodic)
        )
        assert np.sort(alone)[[0, -1]] == pytest.approx([0.0, 47 / 48])
        assert np.abs(hidden - 47 / 48).min() > 0.01
