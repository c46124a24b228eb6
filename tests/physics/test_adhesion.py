"""Adhesion against closed forms: JKR, Bradley, Maugis, Johnson's wave; paths, certificate and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

import asperity as asp

SOLID = asp.Solid(young=1.0, poisson=0.0)
BALL = {"length": 0.26, "boundary": "free"}
WORK = 0.1**3 * 2 / (9 * np.pi)
"""Work of adhesion at which, by JKR, a ball of radius 1 touches on the radius 0.1 without a load."""


def ball(nodes, length):
    return asp.surface.add_sphere(np.zeros((nodes, nodes)), length, radius=1.0)


def curve(height, length, adhesion, approaches, boundary="free"):
    settings = {"adhesion": adhesion, "boundary": boundary, "approaches": approaches}
    contacts = [*asp.solve_load_path(height, SOLID, length, **settings)]
    return contacts, np.array([contact.force for contact in contacts])


def least(approaches, forces):
    """Least of the parabola through the smallest of the forces and its neighbours."""
    k = int(np.argmin(forces))
    assert 0 < k < len(forces) - 1
    two, one, zero = np.polyfit(approaches[k - 1 : k + 2], forces[k - 1 : k + 2], 2)
    return zero - one**2 / (4 * two)


def test_short_range_approaches_jkr():
    """Pull-off of −3/2 π w R, extrapolated linearly to no range, and the radius without a load."""
    pulls, ranges = [], []
    for nodes in (64, 128):
        grid = asp.Grid((nodes, nodes), 0.26)
        adhesion = asp.Adhesion.fitted(WORK, SOLID, grid)
        approaches = np.r_[0.1**2 / 3, np.linspace(-0.04, -0.22, 6) * 0.1**2]
        contacts, forces = curve(ball(nodes, 0.26), 0.26, adhesion, approaches)
        pulls.append(least(approaches[1:], forces[1:]) / (np.pi * WORK))
        ranges.append(adhesion.range)
    assert pulls[0] < pulls[1] < -1.5
    assert abs(np.polyval(np.polyfit(ranges, pulls, 1), 0) / -1.5 - 1) < 0.03
    radius = np.sqrt(contacts[0].contact_area_fraction / np.pi) * 0.26
    assert abs(radius - 0.1) < adhesion.cohesive_zone(1.0)  # where the attraction ends


@pytest.mark.parametrize(("law", "length"), [("exponential", 0.12), ("maugis-dugdale", 0.04)])
def test_rigid_ball_pulls_as_bradley(law, length):
    """2 π w R from a ball that hardly deforms, on a map that the attraction does not leave."""
    adhesion = asp.Adhesion(work=1e-9, range=1e-4, law=law)
    _, forces = curve(ball(128, length), length, adhesion, [-1e-4, -3e-7])
    assert abs(forces[-1] / (-2 * np.pi * 1e-9) - 1) < 0.01


@pytest.mark.parametrize("parameter", [0.3, 0.8, 1.2])
def test_pull_off_follows_maugis(parameter):
    """The least force over the solution of Maugis's equations (10.1016/0021-9797(92)90285-T)."""
    modulus, work = 4 / 3, 1e-4
    ratio = 1 + np.geomspace(1e-4, 60, 20000)
    root = np.sqrt(ratio**2 - 1)
    angle = np.arctan(root)
    square = parameter / 2 * (root + (ratio**2 - 2) * angle)
    linear = 4 * parameter**2 / 3 * (root * angle - ratio + 1)
    radius = (np.sqrt(linear**2 + 4 * square) - linear) / (2 * square)
    force = radius**3 - parameter * radius**2 * (root + ratio**2 * angle)
    approach = (radius**2 - 4 / 3 * parameter * radius * root) * (np.pi * work / modulus) ** (2 / 3)
    k = int(force.argmin())
    strength = parameter / 2 * (np.pi * work * modulus**2) ** (1 / 3)
    adhesion = asp.Adhesion(work, work / strength, "maugis-dugdale")
    length = 2.6 * (np.pi * work / modulus) ** (1 / 3) * (radius * ratio)[k]
    nodes = 64 if parameter < 1 else 128
    approaches = approach[k] + (np.pi * work / modulus) ** (2 / 3) * np.array([0.6, 0.15, 0.05, -0.05, -0.15])
    _, forces = curve(ball(nodes, length), length, adhesion, approaches)
    assert abs(least(approaches[1:], forces[1:]) / (np.pi * work) / force[k] - 1) < 0.01


@pytest.mark.parametrize("alpha", [0.3, 0.5, 0.7])
def test_wave_jumps_into_full_contact(alpha):
    """p̄ = p* sin²ψ − √(2 E* w tan ψ / λ) up to its maximum (K. L. Johnson, 10.1016/0020-7683(94)00111-9)."""
    nodes, amplitude = 256, 1e-2
    height = np.tile(amplitude * (1 - np.cos(2 * np.pi * np.arange(nodes) / nodes)), (4, 1))
    grid, full = asp.Grid((4, nodes), (4 / nodes, 1.0)), np.pi * amplitude
    adhesion = asp.Adhesion.fitted((alpha * full) ** 2 / 2, SOLID, grid)

    def load(angle):
        return np.sin(angle) ** 2 - alpha * np.sqrt(np.tan(angle))

    angles = np.linspace(1e-4, np.pi / 2 - 1e-4, 10000)
    highest = int(load(angles).argmax())
    lowest = int(load(angles)[: highest + 1].argmin())
    most, last = load(angles[highest]), None
    for part in sorted({0.0, 0.8 * max(most, 0.0), max(most, 0.0) + 0.03}):
        settings = {"mean_pressure": part * full, "adhesion": adhesion, "initial": last}
        last = asp.solve_contact(height, SOLID, grid, **settings)
        exact = 1.0
        if part < most:
            exact = (
                brentq(lambda angle, part=part: load(angle) - part, angles[lowest], angles[highest])
                * 2
                / np.pi
            )
        assert (
            abs(last.contact_area_fraction - exact) < 2.5 * adhesion.cohesive_zone(1.0) * (exact < 1) + 1e-9
        )


def test_path_without_jumps_dissipates_nothing():
    height = asp.self_affine((64, 64), 0.8, 0.5, 1 / 16, rms_height=2e-3, seed=1)
    adhesion = asp.Adhesion(1e-5, 2.5e-3)
    up = height.min() + np.linspace(-0.01, 0.003, 9)
    approaches = [*up, *up[-2::-1]]
    settings = {"adhesion": adhesion, "approaches": approaches, "rtol": 1e-8}
    force = np.array([contact.mean_pressure for contact in asp.solve_load_path(height, SOLID, **settings)])
    assert force.min() < 0
    work = np.trapezoid(np.abs(force[:9]), up)
    assert abs(np.trapezoid(force, approaches)) < 1e-6 * work


LAYER, COATED = asp.Solid(1.0, 0.5, height=0.05), asp.Solid(5.0, 0.3, height=0.02, base=SOLID)
PAIR = asp.TwoBodies(asp.Solid(2.0, 0.3), asp.Solid(3.0, 0.2))


def test_steps_with_equal_changes_are_extrapolated():
    height, solid = asp.self_affine((32, 32), 0.8, 0.5, 1 / 8, rms_height=2e-3, seed=2), asp.Solid(1.0, 0.3)
    adhesion = asp.Adhesion.fitted(2e-5, solid, asp.Grid((32, 32)), "maugis-dugdale")
    contact = asp.solve_contact(height, solid, approach=height.min(), adhesion=adhesion)
    assert 0 < contact.pressure.max() < np.inf


@pytest.mark.parametrize(
    ("solid", "kind"),
    [
        *((SOLID, kind) for kind in ("exponential", "maugis-dugdale", "mirrored", "hardness", "free")),
        *((LAYER, "exponential"), (LAYER, "mirrored"), (COATED, "exponential"), (COATED, "hardness")),
        *((PAIR, "maugis-dugdale"), (PAIR, "free")),
    ],
)
def test_rough_path_is_certified(solid, kind):
    """Forward and back over jumps: force balance, bounds and stability of each contact, evaluated anew."""
    height = asp.self_affine((48, 48), 0.8, 0.5, 1 / 12, rms_height=2e-3, seed=3)
    grid = asp.Grid((48, 48), mirrored=kind == "mirrored")
    law = kind if kind == "maugis-dugdale" else "exponential"
    adhesion = asp.Adhesion.fitted(2e-5, solid, grid, law)
    boundary = "free" if kind == "free" else "periodic"
    path = height.min() + np.array([0.0, 1.5, 3.0, 3.0, 1.5, 0.0, -2.0]) * 1e-3
    hardness = None
    if kind == "hardness":
        hardness = 0.7 * asp.solve_contact(height, solid, grid, approach=path[2]).maximum_pressure
    settings = {"adhesion": adhesion, "boundary": boundary, "hardness": hardness, "approaches": path}
    contacts = [*asp.solve_load_path(height, solid, grid, **settings)]
    for contact in contacts:
        assert contact.pressure.min() >= -adhesion.strength * (1 + 1e-12)
        assert contact.gap.min() > -1e-6 * adhesion.range
        assert contact.certificate.stability > 0
        assert contact.pressure.max() <= (hardness or np.inf)
        found = asp.contact.verify_contact(
            contact.height,
            contact.pressure,
            solid,
            grid,
            approach=contact.approach,
            adhesion=adhesion,
            boundary=boundary,
            hardness=hardness,
        )
        assert found.worst < 1e-4
    if kind == "hardness":
        assert contacts[2].plastic_area > 0
        assert_allclose(contacts[3].height, contacts[2].flattened_height())
        depth = contacts[-1].flattened_height() - height
        assert depth.max() > 0
        assert depth.min() == 0
    else:
        assert contacts[4].contact_area_fraction >= contacts[1].contact_area_fraction  # the path decides


def test_certificate_rejects_another_contact():
    height, adhesion = ball(64, 0.26), asp.Adhesion(WORK, 2e-3)
    contact = asp.solve_contact(height, SOLID, **BALL, approach=1e-3, adhesion=adhesion)
    settings = {"approach": contact.approach, "adhesion": adhesion, "boundary": "free"}
    for pressure, limit in ((contact.pressure, 1e-4), (1.01 * contact.pressure, np.inf)):
        found = asp.contact.verify_contact(height, pressure, SOLID, 0.26, **settings)
        assert (found.worst < 1e-4) == (limit < 1)
        assert found.error_bound == np.inf


def test_pastewka_and_robbins_predict_sticking():
    """Below 1 rough surfaces touch without a load; far above 1 the area at a small load hardly changes."""
    height = asp.self_affine((128, 128), 0.8, 0.5, 1 / 16, rms_height=2e-3, seed=1)
    grid = asp.Grid((128, 128))
    areas = {}
    for work in (0.0, 2e-7, 5e-5):
        adhesion = None if work == 0 else asp.Adhesion.fitted(work, SOLID, grid)
        contact = asp.solve_contact(height, SOLID, mean_pressure=1e-3, adhesion=adhesion)
        criterion = np.inf if work == 0 else asp.contact.stickiness(adhesion, height, SOLID)
        areas[criterion] = contact.contact_area_fraction
    weak, strong = sorted(areas)[1], sorted(areas)[0]
    assert strong < 1 < weak
    assert areas[np.inf] < areas[weak] < 1.3 * areas[np.inf]
    assert areas[strong] > 1.5 * areas[np.inf]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"contact_area_fraction": 0.1}, "contact_area_fraction: .* needed with adhesion"),
        ({"approach": 0.0, "method": "gfmd", "boundary": "periodic"}, "method = 'gfmd': active_set"),
        ({"approach": 0.0, "dtype": "float32"}, "dtype = 'float32': float64"),
        ({"approach": 0.0, "adhesion": 1.0}, "adhesion = 1.0: an Adhesion"),
        (
            {"approach": 0.0, "adhesion": asp.Adhesion(WORK, 1e-5)},
            "adhesion.range = 1e-05: nodes at most d/2",
        ),
    ],
)
def test_adhesion_refuses(settings, message):
    with pytest.raises((ValueError, TypeError), match=message):
        asp.solve_contact(ball(64, 0.26), SOLID, **{"adhesion": asp.Adhesion(WORK, 2e-3), **BALL, **settings})


def test_quantities_without_meaning_are_refused():
    contact = asp.solve_contact(
        ball(64, 0.26), SOLID, **BALL, approach=1e-3, adhesion=asp.Adhesion(WORK, 2e-3)
    )
    for name in ("stiffness", "load_interval"):
        with pytest.raises(ValueError, match=f"{name}: a contact without adhesion"):
            getattr(contact, name)
    assert contact.conductance(1.0) > 0
    assert replace(contact, adhesion=None, attraction=None).contact_area_fraction > np.mean(
        contact.pressure > 0
    )
