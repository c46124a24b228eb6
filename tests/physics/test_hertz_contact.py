"""Smooth Hertz contacts against closed forms, and a rough cell in one against the whole rough contact."""

import re
from dataclasses import replace

import numpy as np
import pytest
from project import ROOT
from samples import HALF_SPACE, refuses

import asperity as asp
from asperity.engineering.case import Case
from asperity.engineering.scene import solid_of
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz, LineHertz, von_mises
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.stress import HertzContact

DEPTHS = (0.0, 1e-3, 0.1, 0.48, 1.0, 3.3, 9.0)


@pytest.mark.parametrize("traction", [(0.0, 0.0), (0.3, 0.0), (0.0, 0.3), (-0.2, 0.1)])
def test_line_contact_against_point_forces(traction):
    """Integrals of Flamant's solution and of the line force in antiplane shear over the pressure."""
    places, weights = np.polynomial.chebyshev.chebgauss(4000)
    load = weights * (1 - places**2) / np.pi  # √(1 − s²) ds, over π
    for x, z in ((0.0, 0.3), (0.7, 0.05), (-1.2, 0.5), (3.0, 2.0)):
        dx, r2 = x - places, (x - places) ** 2 + z**2
        normal, along = -2 * load * z / r2**2, -2 * load * dx / r2**2 * traction[0]
        radial = normal + along
        xx, zz, xz = (radial * dx**2).sum(), (radial * z**2).sum(), -(radial * dx * z).sum()
        yz, xy = (load * z / r2).sum() * traction[1], -(load * dx / r2).sum() * traction[1]
        found = LineHertz(0.1, 5.0).stress(0.1 * x, 0.1 * z, 0.3, traction)
        np.testing.assert_allclose(found / 5, [xx, 0.3 * (xx + zz), zz, yz, xz, xy], atol=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_ball_against_closed_forms(friction):
    """To rounding; the mean over directions converges slowly in the surface around the contact only."""
    ball = Hertz(1.0, 5.0)
    contact = HertzContact(ball.maximum_pressure, 1.0, 1.0)
    x = np.array([0.0, 0.3, -0.6, 0.95, 1.4])
    found = contact.stress(0.2, x, HALF_SPACE, friction)
    for depth in DEPTHS:
        exact = SlidingSphere(ball, friction).stress(0.2, x, depth, 0.3)
        error = np.abs(found(depth) - exact).max(axis=1) / ball.maximum_pressure
        assert error[:4].max() < 1e-11
        assert error[4] < (1e-11 if depth > 1 / 40 else 1e-3)


@pytest.mark.parametrize("ratio", [3.0, 20.0, 80.0])
def test_ellipse_against_point_forces(ratio):
    """Boussinesq's solution (Johnson, Eq. 3.19) over the pressure, inside and outside the contact.

    Gauss's rule along the radius and equal steps of the angle err by less than 1e-6 at this depth.
    """
    nodes, weights = np.polynomial.legendre.leggauss(180 + 11 * int(ratio))
    radius, nu, z, count = (nodes + 1) / 2, 0.3, 0.4, 120 + 36 * int(ratio)
    angle = 2 * np.pi * np.arange(count) / count
    radius = np.sin(np.pi / 2 * radius)  # √(1 − r²) is smooth in the arc sine of r
    load = (np.pi / 4 * weights * radius * (1 - radius**2))[:, None] * ratio * 2 * np.pi / angle.size
    loaded_x, loaded_y = radius[:, None] * np.cos(angle), ratio * radius[:, None] * np.sin(angle)
    places = np.array([[0.0, 0.9], [0.6, 0.5], [0.2, 1.3]])
    found = HertzContact(1.0, ratio, 1.0).stress(ratio * places[:, 0], places[:, 1], HALF_SPACE)(z)
    for (y, x), stress in zip(places * [ratio, 1.0], found, strict=True):
        x, y = x - loaded_x, y - loaded_y
        r2, rho = x**2 + y**2, np.sqrt(x**2 + y**2 + z**2)
        plane = (1 - 2 * nu) / (rho * (rho + z))  # (1 − z/ρ)/r²

        def along(u, v, plane=plane, r2=r2, rho=rho):
            return (
                plane * (u**2 - v**2) / r2 + (1 - 2 * nu) * z * v**2 / (r2 * rho**3) - 3 * z * u**2 / rho**5
            )

        xy = 2 * plane * x * y / r2 - (1 - 2 * nu) * x * y * z / (r2 * rho**3) - 3 * x * y * z / rho**5
        normal = 3 * z**2 / rho**5
        fields = along(x, y), along(y, x), -normal * z, normal * y, normal * x, xy
        exact = [float((load * field).sum()) / (2 * np.pi) for field in fields]
        np.testing.assert_allclose(stress, exact, atol=1e-6)


@pytest.mark.parametrize("wide", ["y", "x"])
def test_ellipse_and_strip_against_closed_forms(wide):
    order = [1, 0, 2] if wide == "y" else [0, 1, 2]
    half = (
        {"half_width_y": 3.0, "half_width_x": 1.0}
        if wide == "y"
        else {"half_width_y": 1.0, "half_width_x": 3.0}
    )
    ellipse = HertzContact(2.0, **half).stress(0, 0, HALF_SPACE)
    strip = HertzContact(2.0, **{name: np.inf if width == 3 else width for name, width in half.items()})
    below = strip.stress(0.4, 0.4, HALF_SPACE, 0.2, 90.0 if wide == "y" else 180.0)
    turned = [0, 1, 2, 3, 4, 5] if wide == "y" else [1, 0, 2, 4, 3, 5]
    traction = (0.0, 0.2) if wide == "y" else (0.0, -0.2)
    for depth in DEPTHS:
        exact = EllipticHertz(3.0, 1.0, 2.0).stress_on_axis(depth, 0.3)[order]
        np.testing.assert_allclose(ellipse(depth)[0, :3], exact, atol=1e-11)
        exact = LineHertz(1.0, 2.0).stress(0.4, depth, 0.3, traction)[turned]
        np.testing.assert_allclose(below(depth)[0], exact, atol=1e-12)


def test_radii_and_loads():
    """Johnson (1985), Eqs. 4.22 to 4.24, 4.43 to 4.45: p0 of a ball; p0 = E* b / (2R) of a roller."""
    ball = HertzContact.from_radii(0.1, 0.1, 2.0, force=3.0)
    assert ball.half_width_x == pytest.approx((0.75 * 3 * 0.1 / 2) ** (1 / 3), rel=1e-9)
    assert ball.maximum_pressure == pytest.approx(1.5 * 3 / (np.pi * ball.half_width_x**2), rel=1e-9)
    again = HertzContact.from_radii(0.1, 0.1, 2.0, maximum_pressure=ball.maximum_pressure)
    assert again.half_width_y == pytest.approx(ball.half_width_y, rel=1e-9)
    roller = HertzContact.from_radii(np.inf, 0.1, 2.0, maximum_pressure=0.5)
    assert (roller.half_width_x, roller.half_width_y) == (np.inf, pytest.approx(0.05, rel=1e-9))
    shear, depth = roller.maximum_shear(0.3)
    assert shear / 0.5 == pytest.approx(0.300, abs=1e-3)  # Johnson, section 4.2
    assert depth / 0.05 == pytest.approx(0.786, abs=2e-3)


def test_cell_has_the_stress_of_the_wavy_ball():
    """A wave of a sixth of the radius in complete contact, resolved with the ball, and as one periodic cell.

    Scale separation neglects (λ/a)² = 0.03 times the curvature of the pressure; found is 0.4 %. Without the
    stress of the smooth contact beyond the mean mode the cell errs by half.
    """
    modulus, half, nodes = HALF_SPACE.effective_modulus, 0.1, 256
    largest, wave = 2 * modulus * half / np.pi, half / 6
    x = (np.arange(nodes) - nodes // 2) * 2.4 * half / nodes
    height = (x**2 + x[:, None] ** 2) / 2 + largest * wave / (2 * np.pi * modulus) * (
        1 - np.cos(2 * np.pi * x / wave)
    )
    force = 4 / 3 * modulus * half**3
    ball = asp.solve_contact(height, HALF_SPACE, 2.4 * half, boundary="free", force=force)
    pressure = largest * (1 + 0.5 * np.cos(2 * np.pi * np.arange(32) / 32)) * np.ones((8, 1))
    plain = asp.LoadedSolid(pressure, asp.Grid((8, 32), (wave / 4, wave)), HALF_SPACE)
    smooth = HertzContact.from_radii(1.0, 1.0, modulus, force=force)
    cell = replace(plain, background=smooth.background(0.0, 0.0, HALF_SPACE))
    depths = wave * np.array([0.0, 0.1, 0.25, 0.5, 1.0, 3.0])
    whole, part, without = (
        np.array(
            [
                plane.fields["von_mises"][0].ravel()[at]
                for plane in asp.stress_planes(each, depths, tolerance=0)
            ]
        )
        for each, at in ((ball, nodes // 2 * (nodes + 1)), (cell, 0), (plain, 0))
    )
    np.testing.assert_allclose(part, whole, rtol=5e-3)
    assert np.abs(without / whole - 1).max() > 0.5


def a_case(at=(0.0, 0.0), kind="hertz_pressure", load=1e9, radius_y=50e-3, radius_x=5e-3, **more):
    edge = 10e-6
    height = asp.self_affine((32, 32), 0.8, edge / 2, edge / 4, rms_height=1e-10, seed=1, length=edge)
    surface = asp.HeightMap(height, (edge, edge), periodic=True, unit="m", name="ground")
    steel = asp.Body(young=210e9, poisson=0.3)
    load = {kind: load, "radius_x": radius_x, "radius_y": radius_y, "at": at}
    return Case(**{"map": surface, "body": steel, "counter_body": steel, "load": load} | more)


def test_nearly_smooth_map_has_the_answer_of_hertz():
    """Heights of 0.1 nm change the pressure by 2e-3; the mean of each plane is the stress of Hertz."""
    case = a_case(at=(0.0, 0.5))
    answer = asp.engineering.answer_of(case)
    contact = case.hertz_contact
    assert answer.contact.mean_pressure == pytest.approx(1e9 * np.sqrt(0.75), rel=1e-6)
    stress = answer.stress["lower"]
    below = contact.stress(0.0, 0.5 * contact.half_width_x, solid_of(case.body))
    exact = [float(von_mises(below(depth)[0])) for depth in stress["plane_depth"].values]
    np.testing.assert_allclose(stress["mean_von_mises"].values[0], exact, rtol=3e-3)
    forced = a_case(kind="force", load=200.0)
    ellipse = EllipticHertz.from_load(200.0, 50e-3, 5e-3, forced.solid.effective_modulus)
    assert forced.cell_pressure == pytest.approx(ellipse.maximum_pressure, rel=1e-9)
    assert answer["half-width along x"].value == contact.half_width_x
    assert not any(each.warns and each.subject == "map in the Hertz contact" for each in answer.warnings)


def test_a_published_ball_bearing_is_met():
    """The page's own block and table; the published lengths have two to four digits."""
    page = (ROOT / "docs/validation.md").read_text("utf-8").split("## A published ball bearing")[1]
    names: dict = {}
    exec(re.search(r"```python\n(.*?)```", page, re.DOTALL)[1], names)
    answer = names["answer"]
    found = [
        answer["maximum pressure"].value / 1e6,
        answer["contact area"].value * 1e6,
        answer["maximum shear stress (Tresca)"].value / 1e6,
        answer["normal approach"].value * 1e3,
    ]
    table = re.findall(r"^\| [^|]+ \| ([\d.]+) \w+²? \| ([\d.]+) \w+²? \|", page, re.MULTILINE)
    published, here = np.array(table, float).T
    np.testing.assert_allclose(found, published, rtol=1e-2)
    np.testing.assert_allclose(found, here, rtol=5e-4, atol=5e-5)
    contact = HertzContact.from_radii(3.7764e-3, 182.66e-3, 210e9 / 0.91 / 2, force=5000 / 9)
    np.testing.assert_allclose(contact.maximum_pressure, 1746e6, rtol=1e-3)
    np.testing.assert_allclose(contact.maximum_shear(0.3), (546e6, 88e-6), rtol=5e-3)


@pytest.mark.parametrize(
    ("radii", "expected"),
    [
        (("5 mm",), (5e-3, 5e-3)),
        (("5 mm", "80 mm"), (5e-3, 80e-3)),
        (("5 mm", "inf"), (5e-3, np.inf)),
        (("inf", "5 mm"), (np.inf, 5e-3)),
    ],
)
def test_settings_make_the_same_case(radii, expected):
    load = {"hertz_pressure": "1 GPa", "at": [0.0, 0.0]} | dict(
        zip(("radius_x", "radius_y"), radii, strict=False)
    )
    case = Case.read({"map": "a.x3p", "body": {"young": "210 GPa", "poisson": 0.3}, "load": load})
    assert Case.read(case.written()) == case
    assert case.load.radii == expected
    assert case.map.radius is None


ENDLESS = {"radius_y": np.inf}
COATED = {"young": 2e11, "poisson": 0.3, "layers": [{"thickness": 1e-6, "young": 4e11, "poisson": 0.2}]}

test_wrong_argument_is_refused = refuses(
    (lambda: a_case(at=(0.9, 0.9)), "load.at = 0.9 0.9: a position inside the contact"),
    (lambda: a_case(at=(0.2, 0.0), radius_y=np.inf), "load.at = 0.2 0: .*across the axis of the roller"),
    (
        lambda: a_case(kind="normal_approach"),
        "load.normal_approach: hertz_pressure, force or mean_pressure is",
    ),
    (lambda: a_case(kind="force", **ENDLESS), "load.force: the Hertz pressure is needed under a roller"),
    (lambda: a_case(body=COATED), "body.layers: half-spaces are needed in a Hertz contact"),
    (
        lambda: asp.run(a_case(load=1e7)),
        "2 problems:\n  load.radius_y: a Hertz contact wider than the map, 10 µm along y, is needed",
    ),
    (lambda: HertzContact(1.0, np.inf, np.inf), "half_width_y = inf.*at most one of them infinite"),
    (lambda: HertzContact.from_radii(1.0, 1.0, 1.0), "exactly one of maximum_pressure and force"),
    (lambda: a_case(radius_x=np.inf, **ENDLESS), "load.radius_y = inf: at most one of the radii is infinite"),
    (
        lambda: asp.LoadedSolid(
            np.ones((8, 8)), asp.Grid((8, 8)), HALF_SPACE, "free", background=lambda depth: None
        ),
        "background: a periodic boundary is needed",
    ),
)
