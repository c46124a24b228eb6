"""Layers with data on both faces: high precision, other solutions, and laws of mechanics."""

from itertools import product

import mpmath as mp
import numpy as np
import pytest
from samples import centred, difference, refuses

import asperity as asp
from asperity.elasticity.loaded_faces import DISPLACEMENTS, layer_fields
from asperity.elasticity.solid import COMPONENTS, Solid
from asperity.fourier.grid import Grid
from asperity.reference.state_space import StateSpace

# Rounding, relative to the largest value in the plane or the cell.
ROUNDING = 1e-14


def plane(layer, grid, depth, top, bottom=None):
    """Fields of one plane."""
    (found,) = layer_fields(layer, grid, top, bottom).planes(depth)
    return found.fields


def stacked(fields, names=COMPONENTS):
    return np.stack([fields[name] for name in names])


# One mode in high precision


def random_mode(rng):
    """A layer, and a grid with the place of one of its modes."""
    poisson = rng.choice([rng.uniform(-0.99, 0.5), 0.499999, 0.5])
    young, scaled = 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-6, 3)
    grid = Grid((3, 3), tuple(rng.uniform(0.5, 2, 2)))
    place = ((1, 1), (2, 1), (0, 1), (1, 0))[rng.integers(4)]
    q = float(np.hypot(grid.qy[place[0]], grid.qx[place[1]]))
    return Solid(young, poisson, scaled / q), grid, place, q


def general_solution(layer, grid, place, depths):
    """States (6, 6) and stresses (6, 6) at some depths of six independent solutions, in 60 digits."""
    q = grid.qx[place[1]], grid.qy[place[0]]
    solid = StateSpace(*q, layer.young, layer.poisson, layer.height, digits=60)
    each = np.eye(6, dtype=int).astype(object)
    return [(solid.state(depth, each), solid.stress(depth, each)) for depth in depths]


def amplitudes(faces, moved, data):
    """Amplitudes of the independent solutions, (6, 6): each column is due to one datum alone."""
    rows = [faces[f][k if moved[f, k] else 3 + k].tolist() for f, k in product(range(2), range(3))]
    values = [mp.mpc(value) for value in (data * np.where(moved, 1, [[1], [-1]])).ravel()]
    return np.array((mp.matrix(rows) ** -1).tolist(), object) * np.array(values, object)


def mode_of(fields, names, place):
    """Coefficients of one mode of some fields."""
    return np.array([np.fft.rfft2(fields[name])[place] / fields[name].size for name in names])


def faces_of(grid, place, moved, data):
    """Arguments `top` and `bottom` with these data as coefficients."""
    faces = []
    for kinds, values in zip(moved, data, strict=True):
        face = {}
        for axis, kind, value in zip("xyz", kinds, values, strict=True):
            modes = np.zeros(grid.mode_shape, complex)
            modes[place] = value
            if place[1] == 0:
                modes[-place[0], 0] = np.conj(value)
            face[("displacement_" if kind else "traction_") + axis] = modes
        faces.append(face)
    return faces


def test_random_data_against_high_precision():
    """100 data sets, q height from 1e-6 to 1e3: largest error 1.4e-15 here, 2.5e-15 of 15900 others.

    Errors are relative to the sum of what the six data would give alone, which is what rounding of them
    changes, in the plane, or in the layer times e^(−q distance to the nearer face) if that is larger; and to
    1 + q distance, whose rounding enters the exponential.
    """
    rng, errors = np.random.default_rng(43), []
    for _ in range(20):
        layer, grid, place, q = random_mode(rng)
        depths = np.array([0.0, rng.uniform(0, 1), 1.0]) * layer.height
        decay = q * np.minimum(depths, layer.height - depths)
        with mp.workdps(60):
            solutions = general_solution(layer, grid, place, depths)
            for _ in range(5):
                moved = rng.integers(0, 2, (2, 3)).astype(bool)
                data = rng.standard_normal((2, 3)) + 1j * rng.standard_normal((2, 3))
                data[moved] /= layer.young * q
                parts = amplitudes((solutions[0][0], solutions[2][0]), moved, data)
                found = list(layer_fields(layer, grid, *faces_of(grid, place, moved, data)).planes(depths))
                for names, kind in ((DISPLACEMENTS, 0), (COMPONENTS, 1)):
                    exact = [solution[kind][: len(names)] @ parts for solution in solutions]
                    pairs = zip(found, exact, strict=True)
                    off = [mode_of(here.fields, names, place) - true.sum(axis=1) for here, true in pairs]
                    scale = np.array([np.abs(true).max(axis=0).sum() for true in exact], float)
                    scale = np.maximum(scale, scale.max() * np.exp(-decay)) * (1 + decay)
                    errors.append(np.abs(off).max(axis=1).astype(float) / scale)
    assert len(errors) == 200
    assert np.median(errors) < 3e-16
    assert np.max(errors) < ROUNDING


# Special cases and other solutions


@pytest.mark.parametrize("shape", [(8, 12), (9, 7), (2, 1)])
@pytest.mark.parametrize("lateral", ["confined", "free"])
def test_supported_layers_and_half_space_are_special_cases(shape, lateral):
    """Every node, including the Nyquist modes of even shapes and the mean mode."""
    rng, grid = np.random.default_rng(1), Grid(shape, (1.0, 0.7))
    pressure = rng.standard_normal(shape)
    modes = np.fft.rfft2(pressure)
    for height, bottom, poisson in product(
        (None, 1e-6, 0.1, 30.0), ("bonded", "frictionless"), (-0.7, 0.3, 0.5)
    ):
        layer = Solid(2.0, poisson, height, bottom, lateral)
        depths = np.array([0.0, 0.4, 1.0]) * (height or 0.2)
        solved = layer_fields(layer, grid, {"pressure": pressure})
        largest = np.abs(stacked(next(solved.planes(0.0)).fields, DISPLACEMENTS)).max()
        for depth, found in zip(depths, solved.planes(depths), strict=True):
            pressed = asp.LoadedSolid(pressure, grid, layer)
            (true,) = asp.stress_planes(pressed, [depth], fields=(*COMPONENTS, "von_mises"), tolerance=0)
            expected = np.stack([true.fields[name][0] for name in (*COMPONENTS, "von_mises")])
            off = stacked(found.fields, (*COMPONENTS, "von_mises")) - expected
            assert np.abs(off).max() < ROUNDING * np.abs(expected).max()
            moved = layer.displacement(grid.qx, grid.qy[:, None], depth)
            moved[:, 2 * grid.kx == shape[1], 0] = moved[2 * grid.ky == shape[0], :, 1] = 0
            for axis, name in enumerate(DISPLACEMENTS):
                exact = np.fft.irfft2(moved[..., axis] * modes, shape)
                assert np.abs(found.fields[name] - exact).max() < ROUNDING * largest


def test_free_layer_moves_by_its_green_tensor():
    rng, grid, layer = np.random.default_rng(3), Grid((5, 7), (1.0, 1.3)), Solid(2.0, 0.2, 0.3)
    loads = rng.standard_normal((2, 3, *grid.shape))
    loads -= loads.mean(axis=(2, 3), keepdims=True)
    top, bottom = (
        {f"traction_{axis}": load for axis, load in zip("xyz", face, strict=True)} for face in loads
    )
    solved = layer_fields(layer, grid, top, bottom)
    found = np.concatenate([stacked(face.fields, DISPLACEMENTS) for face in solved.planes([0.0, 0.3])])
    tensor = layer.green_tensor(grid.qx, grid.qy[:, None])
    modes = np.einsum("ijyx,jyx->iyx", tensor, np.fft.rfft2(loads.reshape(6, *grid.shape)))
    assert difference(found, np.fft.irfft2(modes, grid.shape)) < ROUNDING


def test_nyquist_modes_are_the_fields_of_cosines():
    """A cosine along y or x at its Nyquist wavenumber, against the same on a grid twice as fine."""
    layer, coarse, fine = Solid(1.0, 0.3, 0.2), Grid((8, 6)), Grid((16, 12))

    def faces(grid):
        y, x = grid.coordinates()
        waves = np.cos(8 * np.pi * y[:, None]) + np.cos(2 * np.pi * x), np.cos(6 * np.pi * x) + 0 * y[:, None]
        mixed = np.cos(8 * np.pi * y[:, None] + 4 * np.pi * x) + np.cos(
            8 * np.pi * y[:, None] - 4 * np.pi * x
        )
        return (
            {"traction_x": waves[0], "displacement_y": waves[1], "displacement_z": mixed},
            {"displacement_x": mixed, "traction_y": waves[0], "displacement_z": waves[1]},
        )

    found, true = (plane(layer, grid, 0.03, *faces(grid)) for grid in (coarse, fine))
    assert difference(stacked(found), stacked(true)[:, ::2, ::2]) < ROUNDING


# Laws of mechanics

FACES = Grid((7, 5), (1.0, 1.2))


def random_faces(rng, poisson):
    """Any data on both faces: for each component a traction or a displacement."""
    moved = rng.integers(0, 2, (2, 3))
    moved[0, rng.integers(3)] = 1
    moved[:, moved.sum(axis=0) == 0] = 1
    kinds = np.where(moved, "displacement_", "traction_")
    return [
        {kind + axis: rng.standard_normal(FACES.shape) for kind, axis in zip(face, "xyz", strict=True)}
        for face in kinds
    ]


def face_data(solved, height):
    """Tractions and displacements of both faces, (2, 3, ny, nx) each."""
    loads, moves = [], []
    for sign, face in zip((1, -1), solved.planes([0.0, height]), strict=True):
        loads.append(sign * stacked(face.fields, ("xz", "yz", "zz")))
        moves.append(stacked(face.fields, DISPLACEMENTS))
    return np.array(loads), np.array(moves)


@pytest.mark.parametrize("height", [0.02, 0.3, 2.0])
def test_reciprocity_and_energy(height):
    """Betti's theorem, and the work of the faces equals the energy inside, by Gauss's rule over the depth."""
    rng, young, poisson = np.random.default_rng(6), 1.7, 0.3
    layer = Solid(young, poisson, height)
    points, weights = np.polynomial.legendre.leggauss(48)
    for _ in range(5):
        first, second = (layer_fields(layer, FACES, *random_faces(rng, poisson)) for _ in range(2))
        (loads, moves), (others, theirs) = (face_data(solved, height) for solved in (first, second))
        work, crossed, back = (np.mean(a * b) for a, b in ((loads, moves), (loads, theirs), (others, moves)))
        scale = np.sqrt(np.mean(loads**2) * np.mean(theirs**2)) + np.sqrt(
            np.mean(others**2) * np.mean(moves**2)
        )
        assert abs(crossed - back) < ROUNDING * scale
        density = []
        for level in first.planes(height * (1 + points) / 2):
            xx, yy, zz, yz, xz, xy = stacked(level.fields)
            squares = xx**2 + yy**2 + zz**2 + 2 * (yz**2 + xz**2 + xy**2)
            density.append(np.mean((1 + poisson) * squares - poisson * (xx + yy + zz) ** 2) / young)
        assert height / 2 * (weights @ density) == pytest.approx(6 * work, rel=1e-11)


def test_faces_of_a_thick_layer_decouple():
    """Each face as the half-space of its own, to e^(−q height); nothing overflows."""
    rng, grid = np.random.default_rng(8), Grid((8, 8))
    loads = rng.standard_normal((2, *grid.shape))
    loads -= loads.mean(axis=(1, 2), keepdims=True)
    for height in (8.0, 1e3, 1e30):
        layer = Solid(1.0, 0.3, height)
        both = layer_fields(layer, grid, {"pressure": loads[0]}, {"pressure": loads[1]})
        for load, depth, mirrored in ((loads[0], 0.1, 1), (loads[1], height - 0.1, -1)):
            alone = plane(
                Solid(1.0, 0.3), grid, height - depth if mirrored < 0 else depth, {"pressure": load}
            )
            found = next(both.planes(depth)).fields
            signs = np.array([1, 1, 1, mirrored, mirrored, 1])[:, None, None]
            # At 1e30 the depth 0.1 above the bottom is the bottom itself.
            if height < 1e29 or mirrored > 0:
                assert difference(signs * stacked(found), stacked(alone)) < 1e-10
        (middle,) = both.planes(height / 2)
        assert np.abs(stacked(middle.fields)).max() < 1e-9


def test_mean_mode_of_prescribed_displacements():
    """Uniform compression and shear, by Hooke's law."""
    for lateral, modulus in (("confined", 2.0 * 0.7 / (1.3 * 0.4)), ("free", 2.0)):
        layer = Solid(2.0, 0.3, 0.5, lateral=lateral)
        faces = (
            {"displacement_z": 0.1, "displacement_x": 0.2},
            {"displacement_z": 0.0, "displacement_x": -0.3},
        )
        found = plane(layer, FACES, 0.2, *faces)
        np.testing.assert_allclose(found["zz"], modulus * 0.2, rtol=ROUNDING)
        np.testing.assert_allclose(found["xx"], 0.3 / 0.7 * modulus * 0.2 * (lateral == "confined"))
        np.testing.assert_allclose(found["xz"], 2.0 / 2.6 * 1.0, rtol=ROUNDING)
        np.testing.assert_allclose(found["displacement_z"], 0.06, rtol=ROUNDING)
        np.testing.assert_allclose(found["displacement_x"], 0.0, atol=ROUNDING)
    pushed = plane(Solid(2.0, 0.3), FACES, 1.0, {"displacement_z": -0.1})
    np.testing.assert_allclose(pushed["displacement_z"], -0.1, rtol=ROUNDING)
    assert np.abs(pushed["zz"]).max() == 0
    kept = plane(Solid(2.0, 0.5, 0.1), FACES, 0.02, {"displacement_z": -0.1}, {"displacement_z": -0.1})
    np.testing.assert_allclose(kept["displacement_z"], -0.1, rtol=ROUNDING)


@pytest.mark.parametrize("young", [1e-75, 1.0, 1e75])
@pytest.mark.parametrize("edge", [1e-60, 1.0, 1e60])
def test_extreme_units(young, edge):
    """The stress is proportional to Young's modulus, whatever the lengths, the displacement to both."""
    pressure = np.arange(16.0).reshape(4, 4) / 16

    def faces(young, edge):
        push = {"displacement_x": 1e-3 * edge * pressure, "traction_y": -young * (pressure - pressure.mean())}
        return {"pressure": young * pressure}, push | {"displacement_z": 0}

    for height, poisson in product((1e-9, 1.0, 1e9), (-0.5, 0.5)):
        there = Solid(young, poisson, height * edge), Grid((4, 4), edge)
        found = plane(*there, 0.3 * height * edge, *faces(young, edge))
        expected = plane(Solid(1.0, poisson, height), Grid((4, 4)), 0.3 * height, *faces(1.0, 1.0))
        for names, unit in ((COMPONENTS, young), (DISPLACEMENTS, edge)):
            off = stacked(found, names) / unit - stacked(expected, names)
            assert np.abs(off).max() < 1e-12 * np.abs(stacked(expected, names)).max()


LAYER, FREE = Solid(1.0, 0.3, 0.2), Solid(1.0, 0.3, 0.2, "free")
FIELD = np.ones(FACES.shape)
HELD = dict.fromkeys(DISPLACEMENTS, 0)


def faced(top, bottom=None, layer=LAYER):
    return layer_fields(layer, FACES, top, bottom)


TWICE, MODES = {"traction_x": 0, "displacement_x": 0}, 1j * FIELD[:, :3]
UNEQUAL = " and 0 on the bottom: equal ones are needed"

test_wrong_argument_is_refused = refuses(
    (lambda: layer_fields(None, FACES, {}), "layer = None, grid = .*: a Solid and a Grid are needed"),
    (lambda: layer_fields(LAYER, (7, 5), {}), "layer = .*, grid = .*: a Solid and a Grid are needed"),
    (lambda: faced(FIELD), "top = .*: a mapping from displacement_x, .* is needed"),
    (lambda: faced({"load": 1}), "a key of top = 'load': one of displacement_x, .* is needed"),
    (
        lambda: faced({}, TWICE),
        "bottom: traction_x and displacement_x are given; only one of them is accepted",
    ),
    (lambda: faced({"pressure": 0, "traction_z": 0}), "top: pressure and traction_z are given; only one"),
    (lambda: faced({"pressure": np.nan}), r"top\['pressure'\] = nan: a finite number"),
    (lambda: faced({"pressure": FIELD * np.nan}), r"top\['pressure'\]: 35 of 35 nodes are not f"),
    (lambda: faced({"pressure": 1j}), r"top\['pressure'\] = 1j: a finite number or a field"),
    (lambda: faced({"pressure": FIELD[1:]}), r"top\['pressure'\] has the shape \(6, 5\): .*\(7, 5\)"),
    (lambda: faced({"pressure": 1j * FIELD}), r"top\['pressure'\] has the shape .*\(7, 3\) is n"),
    (lambda: faced({"pressure": MODES}), r"top\['pressure'\]: the coefficients of a real field are needed"),
    (lambda: faced({"pressure": np.nan * MODES}), r"top\['pressure'\]: 21 of 21 nodes are not finite"),
    (lambda: faced({"pressure": "high"}), r"top\['pressure'\] = 'high': a finite number"),
    (lambda: layer_fields(Solid(1.0, 0.3), FACES, {}, {}), "bottom = {}: None is needed for a half-space"),
    (lambda: faced({}, layer=Solid(1.0, 0.3, 1e-61)), "height = 1e-61: 1e-60 of the cell or more is needed"),
    (lambda: faced({}).planes(0.3), "depth = 0.3: a finite depth from 0 to 0.2 is needed"),
    (lambda: faced({}).planes([0.1, np.nan]), "depth = nan: a finite depth"),
    (lambda: faced({"pressure": 0.1}, layer=FREE), f"mean σ_zz = -0.1 on top{UNEQUAL} for no net force"),
    (
        lambda: faced({"traction_y": 1}, {"displacement_z": 0}),
        f"mean σ_yz = 1 on top{UNEQUAL} for no net force",
    ),
    (
        lambda: faced({"traction_x": 0.1}, {"traction_x": -0.1}, Solid(1.0, 0.3, 0.2, lateral="free")),
        "mean σ_xz, σ_yz = 0.1, 0: 0 is needed, as nothing bears their moment with lateral = 'free'",
    ),
    (
        lambda: faced(HELD | {"displacement_z": 0.1}, layer=Solid(1.0, 0.5, 0.2)),
        f"mean displacement_z = 0.1 on top{UNEQUAL} for poisson = 0.5",
    ),
)


def test_too_large_a_field_is_an_error():
    """A thin free layer bends beyond double precision."""
    wave = np.cos(2 * np.pi * centred(FACES)[1]) + 0 * FIELD
    solved = layer_fields(Solid(1e-75, 0.3, 1e-59), FACES, {"pressure": 1e70 * (wave - wave.mean())}, {})
    with pytest.raises(ValueError, match=r"layer_fields: .* are not finite"):
        next(solved.planes(0.0))
