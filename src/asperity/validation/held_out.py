"""Comparisons with closed forms that no part of the library is built on or was tuned by.

Each goes through the whole chain, from the height of the indenter to the quantity compared: elliptic contact
and the tension at the edge of a circular one, on an isolated map; a bonded layer under a flat punch and a
paraboloid, against a Fredholm equation; and a bisinusoidal wave in small and in nearly complete contact.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.contact import solve
from asperity.elasticity.layer import Layer
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.bonded_layer import BondedLayer, LayerContact
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.spectral import Grid
from asperity.stress.planes import stress_planes
from asperity.types import Array, Progress
from asperity.validation.indenter import (
    CURVATURE_RADIUS,
    bonded_slab,
    fitted_contact_radius,
    largest_sample,
    paraboloid,
)

SEMI_MINOR = 0.3
"""Smaller semi-axis of the contacts on an isolated map, over the shorter edge of the map."""

WAVE_AMPLITUDE = 1e-4
"""Amplitude of the bisinusoidal wave over its wavelength; all errors are independent of it."""


def elliptic_contacts(
    points: int = 128,
    axis_ratios: Sequence[float] = (0.2, 0.4, 0.6, 0.8, 1.0),
    poisson: float = 0.3,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Pressure and stress of elliptic contacts on an isolated map, against closed forms.

    Parameters
    ----------
    points : int
        Nodes on each edge of the map, whose edges are in proportion to the semi-axes.
    axis_ratios : sequence of float
        Semi-axes b/a of the closed form, whose load is imposed.
    poisson : float
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Largest pressure, area of contact over that of the map, and the largest von Mises and shear stress on
        the axis with their depths, each ``solved_`` and ``exact_`` (axis_ratio).
    """
    names = ("von_mises", "largest_shear")
    found: dict[str, list[float]] = {}
    for done, ratio in enumerate(axis_ratios, start=1):
        exact = EllipticHertz(SEMI_MINOR / ratio, SEMI_MINOR, largest_pressure=1e-4)
        grid = Grid((points, points), (1.0, 1.0 / ratio))
        y, x = (place - edge / 2 for place, edge in zip(grid.coordinates(), grid.length, strict=True))
        radius_x, radius_y = exact.curvature_radii
        height = y[:, None] ** 2 / (2 * radius_y) + x**2 / (2 * radius_x)
        solid = Layer(1 - poisson**2, poisson)
        contact = solve(height, solid, grid.length, force=exact.load, boundary="free", rtol=rtol)
        depth = np.linspace(0.25, 1.0, 61) * SEMI_MINOR
        middle = points // 2
        planes = stress_planes(contact, depth, poisson, names, tolerance=0)
        axis = np.array([[plane.fields[name][0, middle, middle] for name in names] for plane in planes])
        peaks = exact.largest_von_mises_on_axis(poisson), exact.largest_shear_on_axis(poisson)
        values: dict[str, float] = {
            "solved_largest_pressure": float(contact.pressure.max()),
            "exact_largest_pressure": exact.largest_pressure,
            "solved_area": contact.area_fraction,
            "exact_area": np.pi * exact.semi_major * exact.semi_minor / (grid.length[0] * grid.length[1]),
        }
        for name, samples, peak in zip(names, axis.T, peaks, strict=True):
            value, place = largest_sample(samples, depth)
            values |= {f"solved_{name}": value, f"exact_{name}": peak.value}
            values |= {f"solved_{name}_depth": place, f"exact_{name}_depth": peak.depth}
        for name, value in values.items():
            found.setdefault(name, []).append(value)
        if progress:
            progress(done, len(axis_ratios))
    return xr.Dataset(
        {name: ("axis_ratio", values) for name, values in found.items()},
        coords={"axis_ratio": np.asarray(axis_ratios, float)},
        attrs={"grid_points": points, "poisson": poisson, "rtol": rtol},
    )


def edge_tension(
    points: int = 512,
    poisson: Sequence[float] = (0.0, 0.3, 0.5),
    reach: float = 1.5,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Radial stress of the surface outside a circular isolated contact, against (1 − 2ν)/3 p₀ a²/r².

    Parameters
    ----------
    points : int
        Nodes on each edge of the map.
    poisson : sequence of float
    reach : float
        Largest distance from the axis, in contact radii.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Radial stress over the largest pressure, ``solved_tension`` and ``exact_tension``, on the nodes of a
        line through the axis outside the contact (poisson, radial_distance), the distance in contact radii.
    """
    exact = EllipticHertz(SEMI_MINOR, SEMI_MINOR, largest_pressure=1e-4)
    grid = Grid((points, points))
    height = paraboloid(grid, exact.curvature_radii[0])
    contact = solve(height, Layer(1.0, 0.0), force=exact.load, boundary="free", rtol=rtol)
    distance = (np.arange(points) - points // 2) / points / SEMI_MINOR
    outside = (distance > 1) & (distance <= reach)
    plane = next(stress_planes(contact, [0.0], poisson, ["xx"], tolerance=0))
    if progress:
        progress(1, 1)
    tension = (1 - 2 * np.asarray(poisson, float)) / 3
    solved = plane.fields["xx"][:, points // 2, outside] / exact.largest_pressure
    return xr.Dataset(
        {
            "solved_tension": (("poisson", "radial_distance"), solved),
            "exact_tension": (("poisson", "radial_distance"), tension[:, None] / distance[outside] ** 2),
        },
        coords={"poisson": np.asarray(poisson, float), "radial_distance": distance[outside]},
        attrs={"grid_points": points, "rtol": rtol},
    )


def layer_indentation(
    points: int = 512,
    contact_ratios: Sequence[float] = (0.5, 1.0, 2.0),
    poisson: Sequence[float] = (0.0, 0.3, 0.5),
    contact_radius: float = 0.05,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Load of bonded layers under a flat punch and a paraboloid, against a Fredholm equation.

    The cell is so large that neighbours do not matter: their influence decays within a few layer heights.
    The radius of the flat punch is that of a circle with the area of its nodes.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    contact_ratios : sequence of float
        Contact radius over layer height.
    poisson : sequence of float
    contact_radius : float
        In cell edges.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Load, ``solved_`` and ``exact_load`` (indenter, contact_ratio, poisson), and the contact radius under
        the paraboloid (contact_ratio, poisson), at the approach of the closed form. The contact radius is
        that of a circle with the area of the contact nodes.
    """
    grid = Grid((points, points))
    round_face = paraboloid(grid, CURVATURE_RADIUS)
    inside = round_face <= contact_radius**2 / (2 * CURVATURE_RADIUS)
    punch_radius = float(np.sqrt(np.mean(inside) / np.pi))
    shape = 2, len(contact_ratios), len(poisson)
    solved, exact = np.empty(shape), np.empty(shape)
    radius = np.empty(shape[1:])
    for done, (i, j) in enumerate(np.ndindex(shape[1:]), start=1):
        height, nu = contact_radius / contact_ratios[i], poisson[j]
        layer = BondedLayer(height, nu)
        forms: tuple[tuple[Array, LayerContact], ...] = (
            # The face around the punch is too high to be touched.
            (np.where(inside, 0.0, 1.0), layer.flat_punch(punch_radius, 1e-4)),
            (round_face, layer.paraboloid(contact_radius, CURVATURE_RADIUS)),
        )
        for indenter, (face, expected) in enumerate(forms):
            contact = solve(face, bonded_slab(nu, height), approach=expected.approach, rtol=rtol)
            solved[indenter, i, j], exact[indenter, i, j] = contact.mean_pressure, expected.load
        radius[i, j] = np.sqrt(contact.area_fraction / np.pi)
        if progress:
            progress(done, radius.size)
    along = ("contact_ratio", "poisson")
    return xr.Dataset(
        {
            "solved_load": (("indenter", *along), solved),
            "exact_load": (("indenter", *along), exact),
            "solved_contact_radius": (along, radius),
            "exact_contact_radius": (along, np.full(shape[1:], contact_radius)),
        },
        coords={
            "indenter": ["flat punch", "paraboloid"],
            "contact_ratio": np.asarray(contact_ratios, float),
            "poisson": np.asarray(poisson, float),
        },
        attrs={"grid_points": points, "rtol": rtol},
    )


def wave_asymptotes(
    points: int = 512,
    small_loads: Sequence[float] = (0.001, 0.01),
    nearly_complete_loads: Sequence[float] = (0.95, 0.99),
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Bisinusoidal wave on a half-space in small and nearly complete contact, against its asymptotes.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    small_loads, nearly_complete_loads : sequence of float
        Mean pressures over the smallest one of complete contact.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Contact radius under small loads (small_load), and mean gap in nearly complete contact
        (nearly_complete_load), each ``solved_`` and ``exact_``. The asymptotes have errors of their own,
        which vanish with the load and with the part of the surface that is out of contact.
    """
    wave = Bisinusoid(WAVE_AMPLITUDE)
    grid = Grid((points, points))
    y, x = (place - 0.5 for place in grid.coordinates())
    height = wave.height(y[:, None], x)
    total = len(small_loads) + len(nearly_complete_loads)
    radius, gap = [], []
    for done, load in enumerate((*small_loads, *nearly_complete_loads), start=1):
        pressure = load * wave.complete_pressure
        contact = solve(height, Layer(1.0, 0.0), mean_pressure=pressure, rtol=rtol)
        if done <= len(small_loads):
            radius.append(fitted_contact_radius(contact.pressure, grid))
        else:
            gap.append(float(contact.gap.mean()))
        if progress:
            progress(done, total)
    pressures = [wave.complete_pressure * np.asarray(loads) for loads in (small_loads, nearly_complete_loads)]
    areas = [wave.small_area_fraction(pressure) for pressure in pressures[0]]
    return xr.Dataset(
        {
            "solved_contact_radius": ("small_load", radius),
            "exact_contact_radius": ("small_load", np.sqrt(np.divide(areas, np.pi))),
            "solved_mean_gap": ("nearly_complete_load", gap),
            "exact_mean_gap": (
                "nearly_complete_load",
                [wave.nearly_complete_mean_gap(pressure) for pressure in pressures[1]],
            ),
        },
        coords={
            "small_load": np.asarray(small_loads, float),
            "nearly_complete_load": np.asarray(nearly_complete_loads, float),
        },
        attrs={"grid_points": points, "rtol": rtol},
    )
