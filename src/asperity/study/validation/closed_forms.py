"""Comparisons with closed forms: spheres and ellipses on a half-space, a bonded layer, a wave.

Each goes through the whole chain, from the height of the indenter to the quantity compared. Lengths are in
units of the edge of the cell, stresses in units of E* unless said otherwise.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import Adhesion, solve_contact, solve_load_path
from asperity.contact.gap import percolation
from asperity.contact.slip import partial_slip
from asperity.core.types import Array
from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Grid
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.bonded_layer import BondedLayer, Coating
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz, LineHertz, von_mises
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.reference.westergaard import Westergaard
from asperity.stress.cycles.stress_cycles import stress_cycles
from asperity.stress.planes.planes import stress_planes
from asperity.study.validation import indenter
from asperity.study.validation.indenter import CURVATURE_RADIUS, paraboloid
from asperity.surface.self_affine import self_affine

RTOL = 1e-8
"""Tolerance of the solver: its error is then far below the errors that are compared."""

SEMI_MINOR = 0.3
"""Smaller semi-axis of the contacts on an isolated map, over the shorter edge of the map."""

WAVE_AMPLITUDE = 1e-5
"""Amplitude of the waves over their wavelength; all errors are independent of it."""


def load_area(points: int = 128, method: str = "gfmd") -> xr.Dataset:
    """Contact area under the loads of the periodic Hertz contact, for several Poisson's ratios (figure 2a).

    Young's modulus is the same for all ratios and the unit of the pressures. The closed form assumes Hertz's
    pressure distribution, which is good for radii up to 0.3 cell edges.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    method : str
        Solver.

    Returns
    -------
    Dataset
        Contact radius and area fraction of the closed form (path) and of the solver (poisson, path), and the
        load-area curve of the closed form (poisson, curve).
    """
    poisson, radii = [0.0, 0.33, 0.5], np.array([0.05, 0.1, 0.15, 0.2, 0.25, 0.3])
    curve = np.linspace(0.0, radii.max() + 0.02, 61)[1:]
    layers = [Solid(1.0, nu) for nu in poisson]
    imposed, along_curve = (
        np.array([_periodic_pressures(some, layer.effective_modulus) for layer in layers])
        for some in (radii, curve)
    )
    area, radius, _ = _contacts(points, method, layers, mean_pressure=imposed)
    both = ("poisson", "path")
    return xr.Dataset(
        {
            "hertz_contact_radius": ("path", radii),
            "hertz_contact_area_fraction": ("path", np.pi * radii**2),
            "imposed_mean_pressure_young": (both, imposed),
            "solved_contact_area_fraction": (both, area),
            "solved_contact_radius": (both, radius),
            "curve_contact_area_fraction": ("curve", np.pi * curve**2),
            "curve_mean_pressure_young": (("poisson", "curve"), along_curve),
        },
        coords={"poisson": poisson},
        attrs={"grid_points": points, "method": method, "curvature_radius": CURVATURE_RADIUS},
    )


def slab_load_area(
    points: int = 128,
    method: str = "gfmd",
    steps: int = 6,
    heights: Sequence[float] = (0.1, 0.25, 0.5, 1.0),
) -> xr.Dataset:
    """Load and contact area of bonded slabs of several heights, against the half-space (figure 2b, c).

    Each slab is indented to the paper's depth. That depth, 0.02 (slab height × cell edge) / R, is reached in
    equal steps of the contact radius; the first is at half of the last radius. The stiffening is the load
    over the load of a single Hertz contact with a half-space at the same approach: at the same contact area
    the loads of slab and half-space nearly agree.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    method : str
        Solver.
    steps : int
    heights : sequence of float
        Slab heights in cell edges.

    Returns
    -------
    Dataset
        Approach, area fraction, contact radius, mean pressure and stiffening (slab, step), and the load-area
        curve of the periodic Hertz contact on a half-space (curve).
    """
    approach = indenter.INDENTATION / CURVATURE_RADIUS * np.outer(heights, np.linspace(0.5, 1.0, steps) ** 2)
    slabs = [indenter.bonded_slab(0.33, height) for height in heights]
    area, radius, pressure = _contacts(points, method, slabs, approach=approach)
    hertz_load = [[Hertz.from_approach(depth, CURVATURE_RADIUS).load for depth in row] for row in approach]
    curve = np.geomspace(0.9 * radius.min(), 1.1 * radius.max(), 61)
    along = ("slab", "step")
    return xr.Dataset(
        {
            "slab_approach": (along, approach),
            "slab_contact_area_fraction": (along, area),
            "slab_contact_radius": (along, radius),
            "slab_mean_pressure": (along, pressure),
            "slab_stiffening": (along, pressure / hertz_load),
            "curve_contact_area_fraction": ("curve", np.pi * curve**2),
            "curve_mean_pressure": ("curve", _periodic_pressures(curve)),
        },
        coords={"slab_height": ("slab", list(heights))},
        attrs={"grid_points": points, "method": method, "curvature_radius": CURVATURE_RADIUS},
    )


def _contacts(points: int, method: str, layers: Sequence[Solid], **load: Array) -> Array:
    """Area fraction, contact radius and mean pressure of the paraboloid, a row of loads for each layer."""
    ((kind, loads),) = load.items()
    grid = Grid((points, points))
    height = paraboloid(grid, CURVATURE_RADIUS)
    found = np.empty((3, *loads.shape))
    for (row, column), value in np.ndenumerate(loads):
        imposed: dict[str, Any] = {kind: float(value)}
        contact = solve_contact(height, layers[row], method=method, rtol=1e-6, **imposed)
        radius = indenter.fitted_contact_radius(contact.pressure, grid)
        found[:, row, column] = contact.contact_area_fraction, radius, contact.mean_pressure
    return found


def _periodic_pressures(radii: Array, effective_modulus: float = 1.0) -> Array:
    """Mean pressure of the periodic Hertz contact at each contact radius."""
    contacts = (PeriodicHertz(radius, CURVATURE_RADIUS, 1.0, effective_modulus) for radius in radii)
    return np.array([contact.mean_pressure for contact in contacts])


def grid_convergence(points: Sequence[int] = (32, 64, 128, 256)) -> xr.Dataset:
    """Error of the contact solution against the number of grid points (figure 2d).

    A wave on a half-space is compared with Westergaard's closed form, a paraboloid on the bonded cubic slab
    with a grid twice as fine as the finest. Errors are root mean squares over five loads, since the edge of
    contact can be anywhere between two nodes.

    Parameters
    ----------
    points : sequence of int
        Nodes on an edge of the grids, rising.

    Returns
    -------
    Dataset
        Relative errors of pressure and approach of the wave and of the load of the slab (grid_points).
    """
    loads, indentations = (0.15, 0.27, 0.4, 0.52, 0.66), np.array([0.012, 0.015, 0.018, 0.021, 0.024])
    wave = np.array([[_wave_errors(n, load) for load in loads] for n in points])
    approaches, grids = (indentations / CURVATURE_RADIUS).tolist(), (*points, 2 * points[-1])
    slab = np.array([[indenter.slab_contact(n, depth).mean_pressure for depth in approaches] for n in grids])
    errors = {
        "wave_pressure_error": wave[..., 0],
        "wave_approach_error": wave[..., 1],
        "slab_load_error": slab[:-1] / slab[-1] - 1,
    }
    return xr.Dataset(
        {name: ("grid_points", np.sqrt(np.mean(error**2, axis=1))) for name, error in errors.items()},
        coords={"grid_points": np.asarray(points)},
        attrs={"grid_points": points[-1], "curvature_radius": CURVATURE_RADIUS},
    )


def _wave_errors(points: int, load: float) -> tuple[float, float]:
    """Relative errors of pressure (L2) and approach of a wave; `load` is over the load that closes it."""
    mean_pressure = load * (np.pi * WAVE_AMPLITUDE)
    exact = Westergaard(mean_pressure, WAVE_AMPLITUDE)
    line = Grid((8, points), (8 / points, 1.0))
    x = line.coordinates()[1] - 0.5
    height = np.tile(exact.height(x), (8, 1))
    contact = solve_contact(height, Solid(1.0, 0.0), line.length, mean_pressure=mean_pressure, rtol=RTOL)
    pressure = exact.pressure(x)
    return (
        float(np.linalg.norm(contact.pressure[0] - pressure) / np.linalg.norm(pressure)),
        contact.approach / exact.approach - 1,
    )


def punch(points: int = 512, samples: int = 81) -> xr.Dataset:
    """Von Mises stress under the paraboloid on a half-space, against Huber's closed form (figure 12).

    The closed form is a single contact, the spectral solution a periodic one whose mean lateral stress is a
    choice: laterally confined, ``σ_xx = σ_yy = −ν/(1 − ν) p̄``, or free, zero. A sum of single contacts has
    ``−(½ + ν) p̄``, the mean over all directions of the kernels' limit q → 0. With this value ("array") the
    maximum stress differs from one contact's only by the effect of the neighbours on the pressure, and the
    two choices differ from it by known amounts.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    samples : int
        Depths of the drawn plane, which reaches two contact radii to each side and in depth.

    Returns
    -------
    Dataset
        Von Mises stress of both on a vertical plane through the axis (poisson, depth, x); its largest value
        on the axis and the depth of this value, for the mean stresses "confined", "free" and "array" and for
        the closed form (poisson).
    """
    poisson, contact_radius, reach = (0.0, 0.5), 0.1, 2.0
    grid = Grid((points, points))
    array = PeriodicHertz(contact_radius, CURVATURE_RADIUS)
    single = Hertz.from_load(array.load, CURVATURE_RADIUS)
    height = paraboloid(grid, CURVATURE_RADIUS)
    contact = solve_contact(height, Solid(1.0, 0.0), mean_pressure=array.mean_pressure, rtol=RTOL)
    width = int(reach * contact_radius * points)
    x = np.arange(-width, width + 1) / points
    depth = np.linspace(0.0, reach * contact_radius, samples)
    axis_depth = np.linspace(0.2, 0.8, 61) * contact_radius
    planes = []
    for nu in poisson:
        layer = Solid(1 - nu**2, nu, lateral="free")
        _, stress = indenter.displacement_and_stress(contact.pressure, grid, layer, 0.5, 0.5, axis_depth)
        on_axis = {"closed_form": single.stress(0.0, axis_depth, nu).von_mises}
        for name, lateral in (("free", 0.0), ("confined", nu / (1 - nu)), ("array", 0.5 + nu)):
            uniform = -lateral * array.mean_pressure * np.array([1, 1, 0, 0, 0, 0])
            on_axis[name] = von_mises(stress[:, 0] + uniform)
        peaks = {name: indenter.largest_sample(values, axis_depth) for name, values in on_axis.items()}
        layer, middle = Solid(1 - nu**2, nu), np.full(len(x), 0.5)
        _, stress = indenter.displacement_and_stress(contact.pressure, grid, layer, middle, x + 0.5, depth)
        exact = single.stress(np.abs(x), depth[:, None], nu)
        variables: dict[str, object] = {
            "von_mises_spectral": (("depth", "x"), von_mises(stress)),
            "von_mises_closed_form": (("depth", "x"), exact.von_mises),
            **{f"peak_von_mises_{name}": peak for name, (peak, _) in peaks.items()},
            **{f"peak_depth_{name}": where for name, (_, where) in peaks.items()},
        }
        planes.append(xr.Dataset(variables, coords={"depth": depth, "x": x}))
    found = xr.concat(planes, xr.Variable("poisson", np.asarray(poisson))).assign(
        contact_radius=single.contact_radius,
        maximum_pressure=single.maximum_pressure,
        maximum_pressure_spectral=float(contact.pressure.max()),
        gradient_rms_contact=single.contact_radius / (np.sqrt(2) * CURVATURE_RADIUS),
    )
    return found.assign_attrs(grid_points=points, curvature_radius=CURVATURE_RADIUS)


def elliptic_contacts(points: int = 128) -> xr.Dataset:
    """Pressure and stress of elliptic contacts on an isolated map, against closed forms.

    Parameters
    ----------
    points : int
        Nodes on each edge of the map, whose edges are in proportion to the semi-axes.

    Returns
    -------
    Dataset
        Maximum pressure, and maximum von Mises stress on the axis with its depth, each ``solved_`` and
        ``exact_`` (axis_ratio).
    """
    poisson, axis_ratios, middle = 0.3, [0.2, 0.4, 0.6, 0.8, 1.0], points // 2
    depth = np.linspace(0.25, 1.0, 31) * SEMI_MINOR
    rows = []
    for ratio in axis_ratios:
        exact = EllipticHertz(SEMI_MINOR / ratio, SEMI_MINOR, maximum_pressure=1e-4)
        grid = Grid((points, points), (1.0, 1.0 / ratio))
        y, x = (nodes - edge / 2 for nodes, edge in zip(grid.coordinates(), grid.length, strict=True))
        radius_x, radius_y = exact.curvature_radii
        height = y[:, None] ** 2 / (2 * radius_y) + x**2 / (2 * radius_x)
        solid = Solid(1 - poisson**2, poisson)
        contact = solve_contact(height, solid, grid.length, force=exact.load, boundary="free", rtol=RTOL)
        planes = stress_planes(contact, depth, poisson, ["von_mises"], tolerance=0)
        axis = np.array([plane.fields["von_mises"][0, middle, middle] for plane in planes])
        solved, solved_depth = indenter.largest_sample(axis, depth)
        peak = exact.maximum_von_mises_on_axis(poisson)
        largest = contact.pressure.max(), exact.maximum_pressure
        rows.append([largest, (solved, peak.value), (solved_depth, peak.depth)])
    names = ("maximum_pressure", "von_mises", "von_mises_depth")
    both = np.transpose(rows, (1, 2, 0))  # solved and exact values of each quantity
    pairs = {name: ("axis_ratio", *values) for name, values in zip(names, both, strict=True)}
    return _dataset(pairs, points, {"axis_ratio": axis_ratios}).assign_attrs(poisson=poisson)


def edge_tension(points: int = 512) -> xr.Dataset:
    """Radial stress of the surface outside a circular isolated contact, against (1 − 2ν)/3 p₀ a²/r².

    Parameters
    ----------
    points : int
        Nodes on each edge of the map.

    Returns
    -------
    Dataset
        Radial stress over the maximum pressure, ``solved_tension`` and ``exact_tension``, on the nodes of a
        line through the axis outside the contact, up to 1.5 contact radii from the axis (poisson,
        radial_distance), the distance in contact radii.
    """
    poisson = np.array([0.0, 0.3, 0.5])
    exact = EllipticHertz(SEMI_MINOR, SEMI_MINOR, maximum_pressure=1e-4)
    height = paraboloid(Grid((points, points)), exact.curvature_radii[0])
    contact = solve_contact(height, Solid(1.0, 0.0), force=exact.load, boundary="free", rtol=RTOL)
    distance = (np.arange(points) - points // 2) / points / SEMI_MINOR
    outside = (distance > 1) & (distance <= 1.5)
    plane = next(stress_planes(contact, [0.0], list(poisson), ["xx"], tolerance=0))
    solved = plane.fields["xx"][:, points // 2, outside] / exact.maximum_pressure
    tension = (1 - 2 * poisson[:, None]) / 3 / distance[outside] ** 2
    pairs = {"tension": (("poisson", "radial_distance"), solved, tension)}
    return _dataset(pairs, points, {"poisson": poisson, "radial_distance": distance[outside]})


def layer_indentation(points: int = 512) -> xr.Dataset:
    """Load of bonded layers under a flat punch and a paraboloid, against a Fredholm equation.

    The cell is so large that neighbours do not matter: their influence decays within a few layer heights.
    The flat punch has the radius of a circle with the area of its nodes.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.

    Returns
    -------
    Dataset
        Load, ``solved_`` and ``exact_load`` (indenter, contact_ratio, poisson), at the approach of the closed
        form. The contact ratio is the contact radius over the height of the layer.
    """
    contact_ratios, poisson, contact_radius = [0.5, 1.0, 2.0], [0.0, 0.3, 0.5], 0.05
    round_face = paraboloid(Grid((points, points)), CURVATURE_RADIUS)
    inside = round_face <= contact_radius**2 / (2 * CURVATURE_RADIUS)
    flat_face = np.where(inside, 0.0, 1.0)  # around the punch too high to be touched
    punch_radius = float(np.sqrt(np.mean(inside) / np.pi))
    solved, exact = np.empty((2, 2, len(contact_ratios), len(poisson)))
    for i, j in np.ndindex(solved.shape[1:]):
        height, nu = contact_radius / contact_ratios[i], poisson[j]
        layer = BondedLayer(height, nu)
        forms = layer.flat_punch(punch_radius, 1e-4), layer.paraboloid(contact_radius, CURVATURE_RADIUS)
        for kind, (face, expected) in enumerate(zip((flat_face, round_face), forms, strict=True)):
            slab = indenter.bonded_slab(nu, height)
            contact = solve_contact(face, slab, approach=expected.approach, rtol=RTOL)
            solved[kind, i, j], exact[kind, i, j] = contact.mean_pressure, expected.load
    indenters = ["flat punch", "paraboloid"]
    axes = {"indenter": indenters, "contact_ratio": contact_ratios, "poisson": poisson}
    return _dataset({"load": (tuple(axes), solved, exact)}, points, axes)


def coating_indentation(points: int = 512) -> xr.Dataset:
    """A paraboloid on a coated half-space, against the contact of Fredholm's equation.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.

    Returns
    -------
    Dataset
        Contact radius and maximum pressure, ``solved_`` and ``exact_`` (contact_ratio, modulus_ratio), at the
        load of the closed form. The contact ratio is the exact contact radius over the height of the coating,
        the modulus ratio Young's modulus of the coating over the base's.
    """
    contact_ratios, modulus_ratios, poisson, contact_radius = [0.5, 1.0, 2.0], [0.25, 2.0, 4.0], 0.3, 0.05
    face = paraboloid(Grid((points, points)), CURVATURE_RADIUS)
    found = np.empty((4, len(contact_ratios), len(modulus_ratios)))
    for i, j in np.ndindex(found.shape[1:]):
        height, ratio = contact_radius / contact_ratios[i], modulus_ratios[j]
        coated = Coating(height, poisson, ratio, base_modulus=1.0, base_poisson=poisson)
        exact = coated.paraboloid(contact_radius, CURVATURE_RADIUS)
        base = Solid(1 - poisson**2, poisson)
        coating = Solid(ratio * base.young, poisson, height, base=base)
        contact = solve_contact(face, coating, mean_pressure=exact.load, rtol=RTOL)
        found[:2, i, j] = np.sqrt(contact.contact_area_fraction / np.pi), contact_radius
        found[2:, i, j] = contact.maximum_pressure, float(exact.pressure(0.0))
    axes = {"contact_ratio": contact_ratios, "modulus_ratio": modulus_ratios}
    pairs = {"contact_radius": (tuple(axes), *found[:2]), "maximum_pressure": (tuple(axes), *found[2:])}
    return _dataset(pairs, points, axes)


def wave_asymptotes(points: int = 512) -> xr.Dataset:
    """Bisinusoidal wave on a half-space in small and nearly complete contact, against its asymptotes.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.

    Returns
    -------
    Dataset
        Contact radius under small loads (small_load), and mean gap in nearly complete contact
        (nearly_complete_load), each ``solved_`` and ``exact_``; loads are mean pressures over the smallest
        one of complete contact. The asymptotes have errors of their own, which vanish with the load and with
        the part of the surface that is out of contact.
    """
    small, nearly_complete = np.array([0.001, 0.01]), np.array([0.95, 0.99])
    wave = Bisinusoid(10 * WAVE_AMPLITUDE)
    grid = Grid((points, points))
    y, x = (nodes - 0.5 for nodes in grid.coordinates())
    height = wave.height(y[:, None], x)
    few, most = (
        [solve_contact(height, Solid(1.0, 0.0), mean_pressure=load, rtol=RTOL) for load in loads]
        for loads in (small * wave.complete_pressure, nearly_complete * wave.complete_pressure)
    )
    radius = [indenter.fitted_contact_radius(contact.pressure, grid) for contact in few]
    exact_radius = [
        np.sqrt(wave.small_contact_area_fraction(contact.mean_pressure) / np.pi) for contact in few
    ]
    gap = [contact.gap.mean() for contact in most]
    exact_gap = [wave.nearly_complete_mean_gap(contact.mean_pressure) for contact in most]
    axes = {"small_load": small, "nearly_complete_load": nearly_complete}
    pairs = {"contact_radius": ("small_load", radius, exact_radius)}
    pairs["mean_gap"] = "nearly_complete_load", gap, exact_gap
    return _dataset(pairs, points, axes)


def metal_contacts(points: int = 128) -> xr.Dataset:
    """Hardness, stiffness, slip, percolation and cycles: a flattened map, a sphere, noise and a cylinder.

    A map that was flattened under a load, pressed elastically under it, has the same pressure. A sphere has
    the stiffness 2 E* a. Under half of the tangential force at which it slides it sticks within 0.5^(1/3) of
    the contact radius, and a cycle between this force and its opposite loses energy (Johnson, Sec. 7.4). As a
    cylinder moves, σ_xz changes by p₀/2, and elastic shakedown ends at p₀ = 4 k (K. L. Johnson, Contact
    Mechanics, 1985, Sec. 9.3). A cylinder that ends across its axis is a line contact. A gap of white
    noise percolates where a fraction 0.592746 of its nodes is open, as sites of a square lattice do (M. E. J.
    Newman, R. M. Ziff, Phys. Rev. Lett. 85 (2000) 4104).

    A sphere is pulled off by 1.60073 π w R at Maugis's parameter 1, at −0.48263 (π² w² R / K²)^(1/3) with
    K = 4 E*/3 (D. Maugis, J. Colloid Interface Sci. 150 (1992) 243).

    Parameters
    ----------
    points : int
        Nodes on an edge of the map; across the cylinder four times as many.

    Returns
    -------
    Dataset
        ``flattened_error``, and ``solved_`` and ``exact_`` stiffness, sticking_area, tangential_displacement,
        lost_energy, percolation, pull_off, shear_range, shakedown_pressure, roller_pressure and
        roller_von_mises.
    """
    solid = Solid(1 - 0.3**2, 0.3)
    height = self_affine((points, points), 0.8, 1 / 4, 8 / points, rms_height=1e-3, seed=1)
    rough = solve_contact(height, solid, mean_pressure=1e-3, hardness=0.03, rtol=RTOL)
    again = solve_contact(rough.flattened_height(), solid, mean_pressure=1e-3, rtol=RTOL)
    error = np.linalg.norm(again.pressure - rough.pressure) / np.linalg.norm(rough.pressure)
    exact = Hertz(contact_radius=0.32, curvature_radius=2.0, effective_modulus=1.0)
    x = (np.arange(points) - points / 2 + 0.5) / points
    sphere = solve_contact((x[:, None] ** 2 + x**2) / 4, solid, force=exact.load, boundary="free", rtol=RTOL)
    edges = (0.0625, 1.0)
    friction = 0.4
    slip = partial_slip(sphere, friction, tangential_force=friction * exact.load / 2)
    compliance = 2 * (1 + 0.3) * (2 - 0.3) / solid.young / exact.contact_radius
    displacement = slip.displacement / (3 / 16 * friction * exact.load * compliance)
    lost = slip.lost_energy / (0.9 * (friction * exact.load) ** 2 * compliance)
    # With R = 2 and (π w R² / K)^(1/3) = 0.3.
    work, stiffness = 0.009 / np.pi, 4 / 3
    strength = (np.pi * work * stiffness**2 / 2) ** (1 / 3) / 2
    adhesion = Adhesion(work, work / strength, "maugis-dugdale")
    path = [0.0, -0.48263 * (2 * (np.pi * work / stiffness) ** 2) ** (1 / 3)]
    *_, pulled = solve_load_path(
        sphere.height, solid, approaches=path, adhesion=adhesion, boundary="free", rtol=RTOL
    )
    opened = []
    for seed in range(8):
        noise = np.random.default_rng(seed).random((points, points))
        paths = percolation(replace(sphere, gap=noise, pressure=np.zeros_like(noise)))
        opened += [np.mean(noise >= width) for width in paths.constriction]
    x = (np.arange(4 * points) - 2 * points) / (4 * points)
    line = solve_contact(np.tile(x**2 / 2, (16, 1)), solid, edges, contact_area_fraction=0.1, rtol=RTOL)
    cycles = stress_cycles(line, yield_stress=np.sqrt(3.0)).attrs
    pressure = line.maximum_pressure
    hertz = LineHertz(half_width=0.3, maximum_pressure=0.15)
    roller = solve_contact(
        line.height,
        solid,
        edges,
        force=np.pi / 2 * 0.3 * 0.15 * edges[0],
        boundary=("periodic", "free"),
        rtol=RTOL,
    )
    plane = next(stress_planes(roller, [depth := 0.7042 * 0.3], fields=["von_mises"], tolerance=0))
    pairs = {
        "stiffness": ((), sphere.stiffness * sphere.grid.area / exact.contact_radius, 2.0),
        "sticking_area": ((), slip.sticking_area, 0.5 ** (2 / 3)),
        "tangential_displacement": ((), displacement, 1 - 0.5 ** (2 / 3)),
        "lost_energy": ((), lost, 1 - 0.5 ** (5 / 3) - 5 / 12 * (1 + 0.5 ** (2 / 3))),
        "percolation": ((), np.mean(opened), 0.592746),
        "pull_off": ((), -pulled.force / (2 * np.pi * work), 1.60073),
        "shear_range": ((), cycles["worst_shear_range"][0] / pressure, 0.5),
        "shakedown_pressure": ((), cycles["worst_shakedown_line"][0] * pressure, 4.0),
        "roller_pressure": ((), roller.maximum_pressure, hertz.maximum_pressure),
        "roller_von_mises": ((), plane.fields["von_mises"].max(), von_mises(hertz.stress(0.0, depth, 0.3))),
    }
    return _dataset(pairs, points, {}).assign(flattened_error=error)


def _dataset(pairs: dict[str, Any], points: int, coordinates: dict[str, Any]) -> xr.Dataset:
    """Dataset of ``solved_`` and ``exact_`` values from the dimensions and both arrays of each quantity."""
    variables: dict[str, Any] = {}
    for name, (along, solved, exact) in pairs.items():
        variables |= {f"solved_{name}": (along, solved), f"exact_{name}": (along, exact)}
    return xr.Dataset(variables, coordinates, {"grid_points": points})
