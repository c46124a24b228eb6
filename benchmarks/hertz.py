"""Errors of solved contacts against the closed forms of single contacts, as a table in Markdown.

    python benchmarks/hertz.py [--points 128 256]

Every contact is solved over a free boundary by `asperity.solve`, and its stress is that of the solved
pressure. Elliptic contact: `asperity.reference.elliptic_hertz`; sliding sphere: G. M. Hamilton and L. E.
Goodman, J. Appl. Mech. 33 (1966) 371.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np

import asperity as asp
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere

STEEL, ALUMINIUM = asp.Layer(210e9, 0.3), asp.Layer(70e9, 0.33)
LARGEST_PRESSURE, SEMI_MINOR, MARGIN = 1e9, 1e-4, 1.15
"""Pressure in Pa, semi-axis in m, and half the edge of the map over the semi-axis."""

COLUMNS = ("contact", "nodes in b", "largest pressure", "real contact", "von Mises", "largest shear", "depth")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=[128, 256])
    points = parser.parse_args().points
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    for nodes in points:
        for row in rows(nodes):
            print(f"| {' | '.join(row)} |")


def rows(points: int) -> Iterator[list[str]]:
    """Errors of every contact, in percent; of the sliding sphere also that of all components."""
    for ratio in (1.0, 0.85, 0.7, 0.5, 0.35, 0.2):
        exact, contact = elliptic(ratio, STEEL, points)
        name = "sphere" if ratio == 1 else f"ellipse, b/a = {ratio:g}"
        yield [name, *errors(exact, contact.in_body("lower"), contact)]
    exact, contact = elliptic(1.0, asp.TwoBodies(STEEL, ALUMINIUM), points)
    for body, material in (("lower", "steel"), ("upper", "aluminium")):
        yield [f"steel on aluminium, {material}", *errors(exact, contact.in_body(body), contact)]
    exact, contact = elliptic(1.0, STEEL, points)
    for friction in (0.1, 0.3, 0.5):
        error = sliding_error(contact, friction)
        name = f"sliding sphere, μ = {friction:g}, every component at every node"
        yield [name, f"{points / 2 / MARGIN:.0f}", "", "", f"{100 * error:.3f} % of p0", "", ""]


def elliptic(
    ratio: float, solid: asp.Layer | asp.TwoBodies, points: int
) -> tuple[EllipticHertz, asp.Contact]:
    """The closed form and the solved contact of a paraboloid with an ellipse of contact of some b/a."""
    modulus = solid.effective_modulus
    exact = EllipticHertz(SEMI_MINOR / ratio, SEMI_MINOR, LARGEST_PRESSURE, modulus)
    radius_x, radius_y = exact.curvature_radii
    length = 2 * MARGIN * SEMI_MINOR, 2 * MARGIN * SEMI_MINOR / ratio
    y, x = ((np.arange(points) - points // 2) * edge / points for edge in length)
    height = y[:, None] ** 2 / (2 * radius_y) + x**2 / (2 * radius_x)
    return exact, asp.solve(height, solid, length, force=exact.load, boundary="free")


def errors(exact: EllipticHertz, pressed: asp.PressedSolid, contact: asp.Contact) -> list[str]:
    """Errors of pressure, area, stresses on the axis and the depth of the largest von Mises stress."""
    depths = np.linspace(0.2, 1.0, 81) * SEMI_MINOR
    middle = tuple(nodes // 2 for nodes in contact.grid.shape)
    box = asp.stress_box(
        pressed,
        depths,
        *((node * step, node * step) for node, step in zip(middle, contact.grid.spacing, strict=True)),
        fields=("von_mises", "largest_shear"),
    ).dataset()
    poisson = pressed.layer.poisson
    found = {name: box[name].values.ravel() for name in ("von_mises", "largest_shear")}
    mises, shear = exact.largest_von_mises_on_axis(poisson), exact.largest_shear_on_axis(poisson)
    area = np.pi * exact.semi_major * exact.semi_minor
    return [
        f"{SEMI_MINOR / contact.grid.spacing[0]:.0f}",
        percent(contact.max_pressure, exact.largest_pressure),
        percent(contact.area_fraction * contact.grid.area, area),
        percent(found["von_mises"].max(), mises.value),
        percent(found["largest_shear"].max(), shear.value),
        percent(refined_depth(depths, found["von_mises"]), mises.depth),
    ]


def refined_depth(depths: np.ndarray, values: np.ndarray) -> float:
    """Depth of the largest value, by a parabola through it and its neighbours."""
    top = int(values.argmax())
    below, here, above = values[top - 1 : top + 2]
    return float(depths[top] + 0.5 * (below - above) / (below - 2 * here + above) * (depths[1] - depths[0]))


def sliding_error(contact: asp.Contact, friction: float) -> float:
    """Largest error of any component at any node of five planes, over the largest pressure."""
    radius = SEMI_MINOR
    modulus = STEEL.effective_modulus
    curvature = 2 * radius * modulus / (np.pi * LARGEST_PRESSURE)
    sphere = SlidingSphere(Hertz(radius, curvature_radius=curvature), friction)
    names = ("xx", "yy", "zz", "yz", "xz", "xy")
    places = [
        (np.arange(n) - n // 2) * step
        for n, step in zip(contact.grid.shape, contact.grid.spacing, strict=True)
    ]
    worst = 0.0
    depths = radius * np.array([0.2, 0.5, 1.0, 2.0, 5.0])
    for plane in asp.stress_planes(contact, depths, fields=names, tolerance=0, friction=friction):
        exact = sphere.stress(places[0][:, None], places[1][None, :], plane.depth, STEEL.poisson) * modulus
        found = np.stack([plane.fields[name][0] for name in names], axis=-1)
        worst = max(worst, float(np.abs(found - exact).max()))
    return worst / LARGEST_PRESSURE


def percent(found: float, exact: float) -> str:
    """Relative error."""
    return f"{100 * (found / exact - 1):+.3f} %"


if __name__ == "__main__":
    main()
