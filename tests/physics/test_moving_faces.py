"""Histories of two rough faces that move: closed forms, exchange of the bodies, and brute force."""

import numpy as np
import pytest
from samples import HALF_SPACE, refuses

import asperity as asp
from asperity.reference.hertz import LineHertz
from asperity.reference.westergaard import Westergaard
from asperity.stress.cycles.criteria import hydrostatic_factor

PAIR = asp.TwoBodies(HALF_SPACE, asp.Solid(2.0, 0.3))
LIMITS = {"fatigue_torsion": 0.3, "fatigue_bending": 0.48, "yield_stress": 0.1}
LOAD = {"mean_pressure": 3e-3}


def face(points, seed, rms_height=1e-3):
    return asp.self_affine((points, points), 0.8, 0.5, 4 / points, rms_height, seed)


@pytest.mark.parametrize("direction", ["x", "y"])
def test_smooth_counter_face_has_cycles_of_smooth_body(direction):
    """To the rounding of states in single precision; the residual stress of the lower bound is along x."""
    rough, depths = face(32, 1), [0.0, 0.01, 0.05]
    settings = {"friction": 0.2, "sliding_direction": direction}
    contact = asp.solve_contact(rough, HALF_SPACE, **LOAD)
    smooth = asp.stress.stress_cycles(contact, depths, **LIMITS, **settings, tolerance=0)
    moving = asp.engineering.MovingContact(0 * rough, rough, HALF_SPACE, shifts=32, **LOAD, **settings)
    found = asp.stress.stress_cycles(moving.in_body("lower"), depths, **LIMITS, tolerance=0)
    for name in (
        "shear_range",
        "dang_van",
        "shakedown_upper",
        *(["shakedown_lower"] if direction == "x" else []),
    ):
        worst = found.attrs[f"worst_{name}"]
        assert worst[:2] == pytest.approx(smooth.attrs[f"worst_{name}"][:2], rel=2e-6)
        if direction == "x":
            np.testing.assert_allclose(found[name], smooth[name], rtol=2e-6)


@pytest.mark.parametrize(("bottom", "friction"), [("bonded", 0.2), ("frictionless", 0.0)])
def test_layer_has_cycles_of_smooth_body(bottom, friction):
    """From the surface to the bottom, to the rounding of states in single precision."""
    rough, layer = face(32, 1), asp.Solid(1.0, 0.3, 0.2, bottom)
    contact = asp.solve_contact(rough, layer, **LOAD)
    smooth = asp.stress.stress_cycles(contact, **LIMITS, friction=friction, tolerance=0)
    moving = asp.engineering.MovingContact(0 * rough, rough, layer, shifts=32, **LOAD, friction=friction)
    found = asp.stress.stress_cycles(moving.in_body("lower"), **LIMITS, tolerance=0)
    assert found["cycle_depth"][-1] == layer.height
    for name in ("shear_range", "dang_van", "shakedown_upper", "shakedown_lower"):
        np.testing.assert_allclose(found[name], smooth[name], rtol=1e-5)


def test_two_equal_wavy_faces():
    """Their sum is one wave of amplitude 2A |cos(k s/2)| at every shift s: Westergaard's contact."""
    nodes, shifts, amplitude, pressure = 256, 16, 1e-3, 2e-3
    x = np.arange(nodes) / nodes
    waves = amplitude * np.cos(2 * np.pi * x) * np.ones((8, 1))
    settings = {"shifts": shifts, "mean_pressure": pressure, "wavelength_short": 1.0}
    moving = asp.engineering.MovingContact(waves, -waves, PAIR, (8 / nodes, 1.0), **settings)
    depths = np.array([0.05, 0.1, 0.2])
    found = asp.stress.stress_cycles(moving.in_body("lower"), depths)["shear_range"].values[:, 0]
    history = np.zeros((shifts, depths.size, nodes))
    for number in range(shifts):
        shift = number / shifts
        size = 2 * amplitude * np.cos(np.pi * shift)
        if abs(size) > 1e-12:  # two flat faces otherwise
            place = x - shift / 2 + (0.5 if size < 0 else 0)
            wave = Westergaard(pressure, abs(size), 1.0, PAIR.effective_modulus)
            history[number] = wave.stress(place, depths[:, None], 0.3)[..., 4]
    exact = np.ptp(history, axis=0).max(axis=1)
    np.testing.assert_allclose(found, exact, rtol=1e-3)  # 256 nodes in a wave


def test_passage_without_relative_motion_is_hertz():
    """Johnson (1985), sections 4.2, 9.3: σ_xz = ±p₀/4 at b/2, 4 k; 200 places miss the extremes by 1e-4."""
    hertz = asp.stress.HertzContact(1.0, np.inf, 20.0)
    moving = asp.engineering.MovingContact(*np.zeros((2, 16, 16)), HALF_SPACE, shifts=200, hertz=hertz)
    depths = 20 * np.linspace(0.4, 0.6, 5)
    cycles = asp.stress.stress_cycles(moving.in_body("lower"), depths, yield_stress=3**0.5)
    value, depth, *_ = cycles.attrs["worst_shear_range"]
    assert (value, depth) == pytest.approx((0.5, 10.0), rel=2e-4)
    assert cycles.attrs["worst_shakedown_upper"][0] == pytest.approx(4.0, rel=2e-3)


@pytest.mark.parametrize("body", ["lower", "upper"])
def test_passage_of_rough_faces_sees_place_and_shift(body):
    """Each state against a contact of its own, solved afresh: pressure of the place, shift by its share."""
    low, high, ratio = face(16, 1), face(16, 2), 0.4
    hertz, shifts = asp.stress.HertzContact(6e-3, np.inf, 3.0), 40
    settings = {"shifts": shifts, "hertz": hertz, "slide_to_roll": ratio, "friction": 0.1}
    moving = asp.engineering.MovingContact(low, high, PAIR, wavelength_short=0.25, **settings).in_body(body)
    place = 1.5 * 3.0 * (2 * np.arange(shifts) + 1 - shifts) / shifts
    share = ratio / (1 - ratio / 2 if body == "lower" else 1 + ratio / 2)
    for number in (8, 17, 30):
        pressure = 6e-3 * np.sqrt(1 - (place[number] / 3) ** 2)
        steps = round(share * place[number] * 16)
        contact = asp.solve_contact(np.roll(high, steps, 1) - low, PAIR, mean_pressure=pressure)
        expected = np.roll(contact.pressure, 0 if body == "lower" else -steps, 1)
        np.testing.assert_allclose(moving.pressures[number], expected, atol=3e-5 * contact.maximum_pressure)
        line = LineHertz(3.0, 6e-3).stress(place[number], 0.5, 0.3, (0.1 if body == "lower" else -0.1, 0.0))
        mean = pressure * moving.layer.uniform_stress()
        mean[4] += pressure * 0.1 * (1, -1)[body == "upper"]
        np.testing.assert_allclose(moving.background(0.5)[number], line - mean, atol=1e-12)
    assert moving.pressures[0] is None
    assert moving.is_unloaded


def brute_force(history):
    """Range of σ_xz, Dang Van stress, squared radius of each history (points, states, 3, 3)."""
    mean = np.trace(history, axis1=2, axis2=3) / 3
    deviator = history - mean[..., None, None] * np.eye(3)
    centre = deviator.mean(axis=1, keepdims=True)
    # M. Badoiu, K. L. Clarkson, SODA (2003) 801: steps of 1/n towards the farthest point.
    for step in range(2, 1500):
        distance = ((deviator - centre) ** 2).sum(axis=(2, 3))
        far = np.take_along_axis(deviator, distance.argmax(axis=1)[:, None, None, None], axis=1)
        centre += (far - centre) / step
    rest = deviator - centre
    values = np.linalg.eigvalsh(rest)
    stress = (values[..., 2] - values[..., 0]) / 2 + hydrostatic_factor(0.3, 0.48) * mean
    return np.ptp(history[..., 0, 2], axis=1), stress.max(axis=1), (rest**2).sum(axis=(2, 3)).max(axis=1)


@pytest.mark.parametrize(("direction", "step"), [("y", (2, 0)), (45, (2, 2))])
def test_agreement_with_brute_force(direction, step):
    """16² nodes, 8 shifts: fresh contacts, planes of `stress_planes`, spheres by another method, to 2e-3."""
    low, high, depth, shifts = face(16, 1), face(16, 2), 0.02, 8
    settings = {"shifts": shifts, "wavelength_short": 0.5, "sliding_direction": direction}
    moving = asp.engineering.MovingContact(low, high, PAIR, **LOAD, **settings)
    names, indices = ("xx", "yy", "zz", "yz", "xz", "xy"), [[0, 5, 4], [5, 1, 3], [4, 3, 2]]
    for body in ("lower", "upper"):
        states = []
        for number in range(shifts):
            shift = number * np.array(step)
            contact = asp.solve_contact(np.roll(high, shift, (0, 1)) - low, PAIR, **LOAD)
            pressed = contact.in_body(body)
            (plane,) = asp.stress_planes(pressed, [depth], fields=names, tolerance=0)
            fields = np.stack([plane.fields[name][0] for name in names], axis=-1)
            states.append(np.roll(fields, (0, 0) if body == "lower" else -shift, (0, 1)))
        history = np.stack(states, axis=2)[..., indices].reshape(-1, shifts, 3, 3)
        shear, dang_van, squared = brute_force(history)
        if direction != 45:
            shear = np.ptp(history[..., 1, 2], axis=1)
        else:
            shear = np.ptp((history[..., 0, 2] + history[..., 1, 2]) / np.sqrt(2), axis=1)
        found = asp.stress.stress_cycles(moving.in_body(body), [depth], **LIMITS, tolerance=0)
        by_row = [each.reshape(16, 16).max(axis=1) for each in (shear, dang_van, squared)]
        np.testing.assert_allclose(found["shear_range"][0], by_row[0], rtol=1e-4)
        np.testing.assert_allclose(found["dang_van"][0], by_row[1] / 0.3, rtol=3e-3)
        np.testing.assert_allclose(found["shakedown_upper"][0], 0.1 / np.sqrt(1.5 * by_row[2]), rtol=2e-3)
        assert (found["shakedown_lower"] <= found["shakedown_upper"] * (1 + 1e-6)).all()


def test_error_of_few_shifts_is_estimated():
    """With steps of a quarter wave, against all positions."""
    low, high = (asp.self_affine((32, 32), 0.8, 0.5, 1 / 4, 1e-3, seed) for seed in (1, 2))
    depths = asp.stress.depth_grid(asp.Grid((32, 32)))[:10]
    cycles = []
    for shifts in (32, 16):
        moving = asp.engineering.MovingContact(low, high, PAIR, shifts=shifts, **LOAD, wavelength_short=1 / 4)
        cycles.append(
            asp.stress.stress_cycles(moving.in_body("lower"), depths, **LIMITS, tolerance=1e-4).attrs
        )
    every, few = cycles
    for name in ("shear_range", "dang_van", "shakedown_upper"):
        change = abs(few[f"worst_{name}"][0] / every[f"worst_{name}"][0] - 1)
        assert change <= few["few_shifts_error"] < 0.2


def moving(**settings):
    settings = {"shifts": 16, "wavelength_short": 0.25, **LOAD} | settings
    return asp.engineering.MovingContact(face(16, 1), face(16, 2), PAIR, **settings)


STEEL = asp.Body(young=210e9, poisson=0.3, fatigue_torsion=3e8, fatigue_bending=4.8e8)
HERTZ = {"mean_pressure": None, "hertz": asp.stress.HertzContact(1e-2, np.inf, 9.0)}

test_wrong_argument_is_refused = refuses(
    (lambda: moving(shifts=7), "shifts = 7: at least 8 are needed, for steps of half of the shortest wave"),
    (lambda: moving(**HERTZ, slide_to_roll=0.5), "shifts = 16: at least 144 are needed"),
    (
        lambda: moving(**HERTZ, slide_to_roll=1.99),
        "wavelength_short = 0.25: at least .* or a smaller slide_to_roll: .* 10000 are the most",
    ),
    (lambda: moving(**HERTZ, at=(0.5, 0.0)), "at = 0.5 0: 0 is needed along the axis of the roller"),
    (lambda: moving(sliding_direction=30), "sliding_direction = 30: .* 29.7449, by 4 nodes along y"),
    (lambda: moving(slide_to_roll=0.1), "slide_to_roll = 0.1: a Hertz contact is needed"),
    (lambda: moving(**HERTZ, slide_to_roll=2), "slide_to_roll = 2: a number above -2 and below 2"),
    (lambda: moving(**HERTZ, sliding_direction="y"), "sliding_direction = 'y', at = 0 0: a line across"),
    (lambda: moving(hertz=HERTZ["hertz"]), "exactly one of mean_pressure and hertz"),
    (lambda: moving().in_body("middle"), "body = 'middle': one of lower, upper"),
)


def test_run_moves_two_maps():
    """Both maps make the faces, the upper one turned over; each body has cycles of its own."""
    edge = 24e-6
    low, high = (
        asp.self_affine((16, 16), 0.8, edge / 2, edge / 4, 2e-8, seed, length=edge) for seed in (1, 2)
    )
    maps = [
        asp.HeightMap(each, (edge, edge), periodic=True, unit="m", orientation="peaks up")
        for each in (low, high)
    ]
    surface = {"file": maps[0], "detrend": "none", "wavelength_short": edge / 4}
    asked = {"cycles": {"shifts": 8}, "sliding": {"direction": "y"}}
    answer = asp.run(surface, STEEL, STEEL.replaced(map=maps[1]), mean_pressure=5e8, **asked)
    pair = asp.TwoBodies(asp.Solid(210e9, 0.3), asp.Solid(210e9, 0.3))
    load = {"mean_pressure": 5e8, "shifts": 8, "sliding_direction": "y"}
    direct = asp.engineering.MovingContact(low, -high[:, ::-1], pair, edge, wavelength_short=edge / 4, **load)
    limits = {"fatigue_torsion": 3e8, "fatigue_bending": 4.8e8, "tolerance": 1e-4}
    for body in ("lower", "upper"):
        found = asp.stress.stress_cycles(direct.in_body(body), **limits)
        own = answer.datasets[f"cycles_{body}"]
        for name in ("shear_range", "dang_van"):
            assert own.attrs[f"worst_{name}"] == pytest.approx(found.attrs[f"worst_{name}"], rel=1e-3)
        record = answer.record("maximum range of shear stress", body)
        assert record.value == own.attrs["worst_shear_range"][0]
    assert any("the faces move along y, 8 shifts" in text for text in answer.assumptions)


def case(cycles=None, counter=None, options=None, **groups):
    surface = asp.HeightMap(face(16, 1) * 1e-5, (1e-5, 1e-5), periodic=True, unit="m")
    groups |= {} if cycles is None else {"cycles": cycles}
    counter = STEEL.replaced(**counter or {})
    return asp.run({"file": surface} | (options or {}), STEEL, counter, mean_pressure=1e8, **groups)


def test_factor_without_a_cycle_is_told_in_words():
    """The rough body presses the same points all the way: any load shakes down, and there is no error."""
    surface = asp.HeightMap(face(16, 1) * 1e-5, (1e-5, 1e-5), periodic=True, unit="m")
    body = asp.Body(young=210e9, poisson=0.3, yield_stress=1e9)
    answer = asp.run(surface, body, mean_pressure=1e8, cycles={"shifts": 8})
    factor = answer.record("shakedown factor, at most", "lower")
    assert factor.text().startswith("unlimited, as the stress does not change")
    assert not factor.errors
    assert "1e+12" not in " ".join(answer.verdict)


SLIDING = {"friction": 0.1, "direction": 30}
COATING = {"layers": [{"thickness": 1e-6, "young": 4e11, "poisson": 0.3}]}
test_wrong_case_is_refused = refuses(
    (lambda: case(counter={"map": "a.x3p"}), "counter_body.map: needs cycles.shifts, for the stress cycles"),
    (lambda: case({"slide_to_roll": 0.1}), "cycles.slide_to_roll = 0.1: needs cycles.shifts"),
    (
        lambda: case({"shifts": 8, "slide_to_roll": 0.1}),
        "cycles.shifts = 8: .* slide_to_roll without a Hertz",
    ),
    (lambda: case({"shifts": 8}, options={"periodic": "none"}), "cycles.shifts = 8: .* map.periodic = none"),
    (lambda: case({"shifts": 8}, options={"radius": 1e-3}), "cycles.shifts = 8: .* a radius of the map"),
    (lambda: case({"shifts": 8}, load_curve={"loads": [1e7]}), "cycles.shifts = 8: .* a load curve"),
    (lambda: case({"shifts": 8}, COATING), "cycles.shifts = 8: .* layers on a body"),
    (lambda: case({"shifts": 2}), "cycles.shifts = 2: at least .* are needed, for steps of half"),
    (lambda: case(sliding=SLIDING), "sliding.direction = 30: x, y or a multiple of 90 is needed"),
    (lambda: case({"shifts": 8}, sliding=SLIDING), "sliding.direction = 30.0: .* by 4 nodes along y"),
)
