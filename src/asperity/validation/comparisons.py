"""The solver held against closed forms and against finite elements, one dataset a comparison.

The indenter is a paraboloid throughout (Hertz), or a wave (Westergaard). Lengths are in units of the edge
of the square cell and stresses in units of E*, except where Young's modulus is the natural unit because
Poisson's ratio varies at a fixed one. Everything is linear: the indenter's curvature only scales the stress.

Positions are relative to the indenter's axis, which stands on a grid node in the middle of the cell.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from asperity.contact import Contact, solve
from asperity.elasticity.layer import Layer
from asperity.reference import calculix, finite_element
from asperity.reference.hertz import Hertz
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.reference.westergaard import Westergaard
from asperity.spectral import Fourier, Grid, resample
from asperity.types import Array

Progress = Callable[[float, float], None] | None

CURVATURE_RADIUS = 1000.0
"""Radius of curvature of the indenter, in cell lengths.

The slope at the edge of contact stays near 10⁻⁴: CalculiX turns the pressure with the surface, linear theory
does not."""

INDENTATION = 0.02
"""The paper's indentation depth, in units of (slab height × cell length) / radius of curvature."""

FIELDS = {"displacement_z": 2, "stress_zz": 2, "stress_xx": 0, "stress_xz": 4}
"""Compared fields, with their place among the components of a displacement or a stress."""

EDGE_DISTANCE = 0.05
"""Points nearer than this to the edge of contact count as near it."""

BOUNDS = {
    "load_area": 0.01,
    "wave_pressure_rate": 0.8,
    "wave_approach": 5e-4,
    "slab_load": 5e-4,
    "elements_load": 5e-4,
    "elements_away": 3e-3,
    "elements_edge": 0.1,
    "calculix_load": 5e-3,
    "calculix_away": 0.02,
    "punch_peak": 0.01,
    "punch_depth": 0.01,
}
"""What every comparison must stay below (the rate: above); the tests and the table read it here."""


def paraboloid(grid: Grid, curvature_radius: float) -> Array:
    """Height ``r²/(2R)`` of the indenter's lower face over the middle node of the grid."""
    y, x = (spacing * (np.arange(n) - n // 2) for n, spacing in zip(grid.shape, grid.spacing, strict=True))
    return (y[:, None] ** 2 + x**2) / (2 * curvature_radius)


def fields_at(
    pressure: Array, grid: Grid, layer: Layer, y: ArrayLike, x: ArrayLike, depths: ArrayLike
) -> tuple[Array, Array]:
    """Displacement and stress at chosen points below a pressure, mode by mode without interpolation.

    Parameters
    ----------
    pressure : (ny, nx) array
    grid : Grid
    layer : Layer
    y, x : (points,) arrays
        Positions in the coordinates of the grid.
    depths : (depths,) array

    Returns
    -------
    displacement : (depths, points, 3) array
    stress : (depths, points, 6) array
    """
    y, x = np.atleast_1d(y), np.atleast_1d(x)
    rows, place = np.unique(y, return_inverse=True)
    whole = Fourier(grid).forward(pressure)
    displacement: list[Array] = []
    stress: list[Array] = []
    for depth in np.atleast_1d(depths):
        part = _reaching(grid, depth)
        coefficients = resample(whole, grid, part) * part.multiplicity
        wave_y = np.exp(1j * np.outer(rows, part.qy))
        wave_x = np.exp(1j * np.outer(x, part.qx))
        qx, qy = part.qx[None, :], part.qy[:, None]
        for modes, out in (
            (layer.displacement(qx, qy, depth), displacement),
            (layer.stress(qx, qy, depth), stress),
        ):
            flat = (coefficients[..., None] * modes).reshape(part.shape[0], -1)
            lines = (wave_y @ flat).reshape(len(rows), len(part.qx), -1)
            out.append(np.einsum("px,pxc->pc", wave_x, lines[place]).real)
    return np.array(displacement), np.array(stress)


def _reaching(grid: Grid, depth: float) -> Grid:
    """The grid of one node more, or of the modes with ``q depth < 40`` alone; the others have died out."""
    reach = [40 * length / (2 * np.pi * depth) if depth > 0 else np.inf for length in grid.length]
    ny, nx = (int(min(n + 1, 2 * np.ceil(modes) + 1)) for n, modes in zip(grid.shape, reach, strict=True))
    return Grid((ny, nx), grid.length)


def load_area(
    points: int = 128,
    poisson: Sequence[float] = (0.0, 0.33, 0.5),
    contact_radii: Sequence[float] = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3),
    method: str = "gfmd",
    rtol: float = 1e-6,
    threads: int = 1,
    progress: Progress = None,
) -> xr.Dataset:
    """Figure 2a: area of contact at the loads of the periodic closed form, at one Young's modulus.

    The closed form takes Hertz's shape of the pressure, good for radii up to 0.3 cell lengths.
    """
    grid = Grid((points, points))
    height = paraboloid(grid, CURVATURE_RADIUS)
    curve = np.linspace(0.0, max(contact_radii) + 0.02, 61)[1:]
    solved = np.empty((len(poisson), len(contact_radii)))
    imposed = np.empty_like(solved)
    measured = np.empty_like(solved)
    drawn = np.empty((len(poisson), len(curve)))
    for row, nu in enumerate(poisson):
        layer = Layer(1.0, nu)
        modulus = layer.effective_modulus
        drawn[row] = [PeriodicHertz(a, CURVATURE_RADIUS, 1.0, modulus).mean_pressure for a in curve]
        for column, a in enumerate(contact_radii):
            imposed[row, column] = PeriodicHertz(a, CURVATURE_RADIUS, 1.0, modulus).mean_pressure
            contact = solve(
                height, layer, mean_pressure=imposed[row, column], method=method, rtol=rtol, threads=threads
            )
            solved[row, column] = contact.area_fraction
            measured[row, column] = contact_radius(contact)
            if progress:
                progress(row * len(contact_radii) + column + 1, solved.size)
    radii = np.asarray(contact_radii)
    return xr.Dataset(
        {
            "hertz_contact_radius": ("path", radii),
            "hertz_area_fraction": ("path", np.pi * radii**2),
            "imposed_mean_pressure_young": (("poisson", "path"), imposed),
            "solved_area_fraction": (("poisson", "path"), solved),
            "solved_contact_radius": (("poisson", "path"), measured),
            "curve_area_fraction": ("curve", np.pi * curve**2),
            "curve_mean_pressure_young": (("poisson", "curve"), drawn),
        },
        coords={"poisson": np.asarray(poisson, float)},
        attrs={"grid_points": points, "method": method, "rtol": rtol, "curvature_radius": CURVATURE_RADIUS},
    )


def contact_radius(contact: Contact) -> float:
    """Radius of contact from where the pressure's square runs out, finer than a count of nodes.

    For Hertz it falls linearly with r²; a parabola is fitted where it is above a tenth of its largest value.
    """
    square = contact.pressure**2
    inside = square > 0.1 * square.max()
    distance = 2 * CURVATURE_RADIUS * paraboloid(contact.grid, CURVATURE_RADIUS)[inside]
    c, b, a = np.polyfit(distance / distance.max(), square[inside] / square.max(), 2)
    # The root that stays finite when the parabola is a line.
    return float(np.sqrt(-2 * a / (b - np.sqrt(b**2 - 4 * a * c)) * distance.max()))


def slab_load_area(
    points: int = 128,
    heights: Sequence[float] = (0.1, 0.25, 0.5, 1.0),
    poisson: float = 0.33,
    steps: int = 6,
    method: str = "gfmd",
    rtol: float = 1e-6,
    threads: int = 1,
    progress: Progress = None,
) -> xr.Dataset:
    """Figure 2b: bonded slabs indented step by step to the paper's depth, beside the half-space.

    The depth is 0.02 (slab height × cell length) / R, reached in steps even in the contact radius, the first
    at half of the last radius. The stiffening is the load over that of a single contact with a half-space at
    the same approach: at the same area of contact the loads of slab and half-space nearly agree.
    """
    grid = Grid((points, points))
    height = paraboloid(grid, CURVATURE_RADIUS)
    young = 1 - poisson**2
    shape = (len(heights), steps)
    approach, area, radius, pressure = (np.empty(shape) for _ in range(4))
    part = np.linspace(0.5, 1.0, steps) ** 2
    for row, tall in enumerate(heights):
        layer = Layer(young, poisson, height=tall, bottom="bonded")
        approach[row] = INDENTATION * tall / CURVATURE_RADIUS * part
        for column in range(steps):
            contact = solve(
                height, layer, approach=approach[row, column], method=method, rtol=rtol, threads=threads
            )
            area[row, column], pressure[row, column] = contact.area_fraction, contact.mean_pressure
            radius[row, column] = contact_radius(contact)
            if progress:
                progress(row * steps + column + 1, area.size)
    half_space = [[Hertz.from_approach(d, CURVATURE_RADIUS).load for d in row] for row in approach]
    drawn = np.geomspace(0.9 * radius.min(), 1.1 * radius.max(), 61)
    curve = [PeriodicHertz(a, CURVATURE_RADIUS).mean_pressure for a in drawn]
    return xr.Dataset(
        {
            "slab_approach": (("slab", "step"), approach),
            "slab_area_fraction": (("slab", "step"), area),
            "slab_contact_radius": (("slab", "step"), radius),
            "slab_mean_pressure": (("slab", "step"), pressure),
            "slab_stiffening": (("slab", "step"), pressure / np.array(half_space)),
            "curve_area_fraction": ("curve", np.pi * drawn**2),
            "curve_mean_pressure": ("curve", np.array(curve)),
        },
        coords={"slab_height": ("slab", np.asarray(heights, float))},
        attrs={
            "grid_points": points,
            "method": method,
            "rtol": rtol,
            "poisson": poisson,
            "curvature_radius": CURVATURE_RADIUS,
        },
    )


def grid_convergence(
    points: Sequence[int] = (32, 64, 128, 256),
    loads: Sequence[float] = (0.15, 0.27, 0.4, 0.52, 0.66),
    indentations: Sequence[float] = (0.012, 0.015, 0.018, 0.021, 0.024),
    poisson: float = 0.33,
    rtol: float = 1e-8,
    threads: int = 1,
    progress: Progress = None,
) -> xr.Dataset:
    """Errors of the contact against the number of grid points, where the truth is known or far finer.

    Root mean squares over several loads, since an edge of contact falls anywhere between two nodes.

    Parameters
    ----------
    points : sequence of int
        Grids, coarse to fine; the slab's truth is a grid twice as fine as the last.
    loads : sequence of float
        Mean pressures of Westergaard's wave, over that of complete contact.
    indentations : sequence of float
        Approaches of the paraboloid on the cubic slab, in squares of the cell length over R.
    """
    young = 1 - poisson**2
    half_space, slab = Layer(young, poisson), Layer(young, poisson, height=1.0, bottom="bonded")
    amplitude = 1e-5
    limit = np.pi * amplitude
    work = np.array([*points, 2 * points[-1]], float) ** 2
    done = 0.0
    wave = np.empty((len(points), len(loads), 3))
    load = np.empty((len(points) + 1, len(indentations)))
    for row, n in enumerate([*points, 2 * points[-1]]):
        if row < len(points):
            line = Grid((8, n), (8 / n, 1.0))
            x = line.coordinates()[1] - 0.5
            for column, part in enumerate(loads):
                exact = Westergaard(part * limit, amplitude)
                height = np.tile(exact.height(x), (8, 1))
                contact = solve(
                    height, half_space, line.length, mean_pressure=part * limit, rtol=rtol, threads=threads
                )
                pressure = exact.pressure(x)
                wave[row, column] = (
                    float(np.linalg.norm(contact.pressure[0] - pressure) / np.linalg.norm(pressure)),
                    contact.approach / exact.approach - 1,
                    contact.area_fraction / exact.area_fraction - 1,
                )
        height = paraboloid(Grid((n, n)), CURVATURE_RADIUS)
        for column, depth in enumerate(indentations):
            load[row, column] = solve(
                height, slab, approach=depth / CURVATURE_RADIUS, rtol=rtol, threads=threads
            ).mean_pressure
        done += work[row]
        if progress:
            progress(done, work.sum())
    wave = np.sqrt(np.mean(wave**2, axis=1))
    return xr.Dataset(
        {
            "wave_pressure_error": ("grid_points", wave[:, 0]),
            "wave_approach_error": ("grid_points", wave[:, 1]),
            "wave_area_error": ("grid_points", wave[:, 2]),
            "slab_load_error": ("grid_points", np.sqrt(np.mean((load[:-1] / load[-1] - 1) ** 2, axis=1))),
        },
        coords={"grid_points": np.asarray(points)},
        attrs={"rtol": rtol, "poisson": poisson, "curvature_radius": CURVATURE_RADIUS},
    )


def slab_contact(
    points: int, approach: float, poisson: float = 0.33, rtol: float = 1e-8, threads: int = 1
) -> Contact:
    """The paraboloid on the bonded cubic slab, by the spectral solver."""
    layer = Layer(1 - poisson**2, poisson, height=1.0, bottom="bonded")
    height = paraboloid(Grid((points, points)), CURVATURE_RADIUS)
    return solve(height, layer, approach=approach, rtol=rtol, threads=threads)


def mesh(elements: tuple[int, int]) -> tuple[Array, Array]:
    """Edges of a number of elements along half the cell, and up the cubic slab, graded to the contact."""
    plane, column = elements
    return finite_element.graded(0.5, plane, 3.0), 1 - finite_element.graded(1.0, column, 10.0)[::-1]


def compare_elements(
    elements: tuple[int, int] = (24, 20),
    points: int = 256,
    approach: float = INDENTATION / CURVATURE_RADIUS,
    poisson: float = 0.33,
    threads: int = 1,
    contact: Contact | None = None,
    progress: Progress = None,
) -> xr.Dataset:
    """Figures 1, 3 and 4: the diagonal plane by the spectral solver and by finite elements.

    Parameters
    ----------
    elements : (int, int)
        27-node hexahedra along half an edge of the cell, and along its height.
    points : int
        Nodes of the spectral grid on an edge.
    approach, poisson : float
    contact : Contact, optional
        The spectral solution, if there is one already.
    """
    plane, column = mesh(elements)
    slab = finite_element.Slab(plane, column, 1 - poisson**2, poisson)
    pressed = finite_element.press(slab, CURVATURE_RADIUS, approach, progress=progress)
    x, z, displacement, stress = slab.on_diagonal(pressed.displacement)
    contact = contact or slab_contact(points, approach, poisson, threads=threads)
    dataset = _compare(contact, x, 1 - z, displacement, stress, pressed.load)
    nodes = slab.free.nodes
    middle = contact.grid.shape[0] // 2
    positions = contact.grid.coordinates()[1][middle:] - 0.5
    extra = {
        "axis_node": nodes,
        "pressure_elements": ("axis_node", pressed.pressure[0]),
        "axis_position": positions,
        "pressure_spectral": ("axis_position", contact.pressure[middle, middle:]),
        "node_z": slab.column.nodes,
        "surface_displacement_elements": (("node_y", "axis_node"), pressed.displacement[2, -1]),
        "wall_displacement_elements": (("component", "node_z", "axis_node"), pressed.displacement[:, :, 0]),
        "rim_displacement_elements": (("component", "node_z", "axis_node"), pressed.displacement[:, :, -1]),
    }
    dataset = dataset.assign(
        {name: value for name, value in extra.items() if isinstance(value, tuple)}
    ).assign_coords({name: value for name, value in extra.items() if not isinstance(value, tuple)})
    dataset.attrs |= {
        "code": "scikit-fem",
        "elements": f"{elements[0]} × {elements[0]} × {elements[1]} hexahedra of 27 nodes",
        "unknowns": int(pressed.displacement.size),
        "iterations": pressed.iterations,
        "active_sets": pressed.active_sets,
        "poisson": poisson,
        "approach": approach,
    }
    return dataset


def compare_calculix(
    folder: str | os.PathLike[str],
    elements: tuple[int, int] = (14, 12),
    points: int = 256,
    approach: float = INDENTATION / CURVATURE_RADIUS,
    poisson: float = 0.33,
    penalty: float = 5e3,
    threads: int = 1,
    contact: Contact | None = None,
) -> xr.Dataset:
    """The diagonal plane by the spectral solver and by CalculiX, which must be installed.

    Parameters as `compare_elements`, and

    folder : path
        Where the deck and the files of the program are kept.
    penalty : float
        Contact pressure per length of penetration, in E* per cell length.
    """
    plane, column = mesh(elements)
    found = calculix.press(
        folder, plane, column, 1 - poisson**2, poisson, CURVATURE_RADIUS, approach, penalty, threads
    )
    contact = contact or slab_contact(points, approach, poisson, threads=threads)
    dataset = _compare(contact, found.x, 1 - found.z, found.displacement, found.stress, found.load)
    dataset.attrs |= {
        "code": f"CalculiX {found.version}",
        "elements": f"{elements[0]} × {elements[0]} × {elements[1]} bricks of 20 nodes, reduced integration",
        "penalty": penalty,
        "poisson": poisson,
        "approach": approach,
    }
    return dataset


def _compare(
    contact: Contact, x: Array, depth: Array, displacement: Array, stress: Array, load: float
) -> xr.Dataset:
    """Both solutions at the points of an element code, the surface first."""
    order = np.argsort(depth)
    depth = depth[order]
    ours = fields_at(contact.pressure, contact.grid, contact.layer, x + 0.5, x + 0.5, depth)
    theirs = displacement[order], stress[order]
    dimensions = ("depth", "distance")
    variables: dict[str, object] = {
        "load_spectral": contact.mean_pressure,
        "load_elements": load,
        "contact_radius": contact_radius(contact),
    }
    for name, place in FIELDS.items():
        kind = 0 if name.startswith("displacement") else 1
        variables[f"{name}_spectral"] = dimensions, ours[kind][..., place]
        variables[f"{name}_elements"] = dimensions, theirs[kind][..., place]
    return xr.Dataset(
        variables,
        coords={"distance": np.sqrt(2) * x, "depth": depth},
        attrs={"grid_points": contact.grid.shape[0], "curvature_radius": CURVATURE_RADIUS},
    )


def differences(dataset: xr.Dataset) -> xr.Dataset:
    """Largest differences of each field over its largest magnitude, near the edge of contact and away.

    Parameters
    ----------
    dataset : Dataset
        Of `compare_elements` or `compare_calculix`.

    Returns
    -------
    Dataset
        ``difference_away`` and ``difference_edge`` along ``field``, and ``difference_load``.
    """
    distance = np.hypot(dataset.distance - dataset.contact_radius, dataset.depth)
    rows = []
    for name in FIELDS:
        ours, theirs = dataset[f"{name}_spectral"], dataset[f"{name}_elements"]
        relative = np.abs(ours - theirs) / np.abs(ours).max()
        away = float(relative.where(distance > EDGE_DISTANCE).max())
        near = float(relative.where(distance <= EDGE_DISTANCE).max())
        rows.append((away, near))
    away, near = np.array(rows).T
    return xr.Dataset(
        {
            "difference_away": ("field", away),
            "difference_edge": ("field", near),
            "difference_load": float(dataset.load_elements / dataset.load_spectral - 1),
        },
        coords={"field": list(FIELDS)},
    )


def mesh_convergence(
    meshes: Sequence[tuple[int, int]] = ((8, 7), (12, 10), (16, 13), (24, 20)),
    points: int = 512,
    approach: float = INDENTATION / CURVATURE_RADIUS,
    poisson: float = 0.33,
    threads: int = 1,
    progress: Progress = None,
) -> xr.Dataset:
    """The same comparison over several meshes against one fine grid: the error of the elements."""
    contact = slab_contact(points, approach, poisson, threads=threads)
    found = []
    for number, elements in enumerate(meshes):
        found.append(
            differences(compare_elements(elements, approach=approach, poisson=poisson, contact=contact))
        )
        if progress:
            progress(number + 1, len(meshes))
    dataset = xr.concat(found, "mesh")
    return dataset.assign_coords(mesh_elements=("mesh", [plane for plane, _ in meshes])).assign_attrs(
        grid_points=points, poisson=poisson, approach=approach, curvature_radius=CURVATURE_RADIUS
    )


def punch(
    points: int = 512,
    contact_radius: float = 0.1,
    poisson: Sequence[float] = (0.0, 0.5),
    reach: float = 2.0,
    samples: int = 81,
    rtol: float = 1e-8,
    threads: int = 1,
    progress: Progress = None,
) -> xr.Dataset:
    """Figure 12: von Mises stress under the paraboloid on a half-space, beside Huber's closed form.

    The closed form is a single contact, the spectral solution a periodic one, and the stress of its uniform
    mode is a choice: laterally confined, ``σ_xx = σ_yy = −ν/(1 − ν) p̄``, or free, zero. Single contacts
    added up carry ``−(½ + ν) p̄``, the mean over directions of the kernels' limit q → 0; with it the largest
    stress is that of one contact but for the neighbours' pressure, and the two choices differ from it by a
    known amount.

    Parameters
    ----------
    points : int
    contact_radius : float
        Of the closed form, whose load on the periodic array is imposed.
    poisson : sequence of float
    reach : float
        Extent of the drawn plane to each side and in depth, in contact radii.
    samples : int
        Depths of the drawn plane.
    """
    grid = Grid((points, points))
    array = PeriodicHertz(contact_radius, CURVATURE_RADIUS)
    single = Hertz.from_load(array.load, CURVATURE_RADIUS)
    contact = solve(
        paraboloid(grid, CURVATURE_RADIUS),
        Layer(1.0, 0.0),
        mean_pressure=array.mean_pressure,
        rtol=rtol,
        threads=threads,
    )
    width = int(reach * contact_radius * points)
    x = np.arange(-width, width + 1) / points
    depth = np.linspace(0.0, reach * contact_radius, samples)
    fine = np.linspace(0.2, 0.8, 61) * contact_radius
    shape = (len(poisson), len(depth), len(x))
    solved, exact = np.empty(shape), np.empty(shape)
    peaks = {name: np.empty((2, len(poisson))) for name in ("confined", "free", "array", "closed_form")}
    for row, nu in enumerate(poisson):
        layer = Layer(1 - nu**2, nu, lateral="free")
        _, stress = fields_at(contact.pressure, grid, layer, 0.5, 0.5, fine)
        for name, lateral in (("free", 0.0), ("confined", nu / (1 - nu)), ("array", 0.5 + nu)):
            uniform = -lateral * array.mean_pressure * np.array([1, 1, 0, 0, 0, 0])
            peaks[name][:, row] = _peak(von_mises(stress[:, 0] + uniform), fine)
        layer = Layer(1 - nu**2, nu)
        _, stress = fields_at(contact.pressure, grid, layer, np.full(len(x), 0.5), x + 0.5, depth)
        solved[row] = von_mises(stress)
        exact[row] = single.stress(np.abs(x), depth[:, None], nu).von_mises
        peaks["closed_form"][:, row] = _peak(single.stress(0.0, fine, nu).von_mises, fine)
        if progress:
            progress(row + 1, len(poisson))
    return xr.Dataset(
        {
            "von_mises_spectral": (("poisson", "depth", "x"), solved),
            "von_mises_closed_form": (("poisson", "depth", "x"), exact),
            **{
                f"{what}_{name}": ("poisson", values[place])
                for name, values in peaks.items()
                for place, what in enumerate(("peak_von_mises", "peak_depth"))
            },
            "contact_radius": single.contact_radius,
            "largest_pressure": single.largest_pressure,
            "largest_pressure_spectral": float(contact.pressure.max()),
            "gradient_rms_contact": single.contact_radius / (np.sqrt(2) * CURVATURE_RADIUS),
        },
        coords={"poisson": np.asarray(poisson, float), "depth": depth, "x": x},
        attrs={"grid_points": points, "rtol": rtol, "curvature_radius": CURVATURE_RADIUS},
    )


def von_mises(stress: Array) -> Array:
    """Von Mises stress of components xx, yy, zz, yz, xz, xy along the last axis."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3 * (yz**2 + xz**2 + xy**2))


def _peak(values: Array, depth: Array) -> tuple[float, float]:
    """Height and place of a maximum, by the parabola through its three samples."""
    i = int(np.clip(values.argmax(), 1, len(values) - 2))
    below, here, above = values[i - 1 : i + 2]
    bend = below - 2 * here + above
    shift = 0.5 * (below - above) / bend
    return here - 0.25 * (below - above) * shift, depth[i] + shift * (depth[1] - depth[0])


class Row(NamedTuple):
    """A line of the validation table."""

    quantity: str
    against: str
    grid: str
    source: str
    error: float
    bound: float
    test: str

    @property
    def holds(self) -> bool:
        """Whether the error stays below its bound, or a rate above it."""
        return self.error >= self.bound if self.source == "rate" else self.error <= self.bound


def table(datasets: Mapping[str, xr.Dataset]) -> list[Row]:
    """What is compared with what, how far apart they are and why, and the bound that the tests guard.

    Parameters
    ----------
    datasets : mapping
        load_area, grid_convergence, elements, mesh_convergence, punch, and calculix if it ran.
    """
    rows = []

    def add(quantity: str, against: str, grid: str, source: str, error: float, bound: str) -> None:
        test = f"test_validation.py::test_{bound}"
        rows.append(Row(quantity, against, grid, source, float(abs(error)), BOUNDS[bound], test))

    found = datasets["load_area"]
    error = np.abs(found.solved_contact_radius / found.hertz_contact_radius - 1).max()
    size = f"{found.attrs['grid_points']}²"
    add(
        "contact radius at given load",
        "periodic Hertz, Eq. 15",
        size,
        "grid, Hertz's shape",
        error,
        "load_area",
    )

    found = datasets["grid_convergence"]
    finest = found.isel(grid_points=-1)
    size = f"{int(finest.grid_points)}"
    rate = _rate(found.grid_points, found.wave_pressure_error)
    add("pressure, L2", "Westergaard", "all grids", "rate", rate, "wave_pressure_rate")
    add("approach", "Westergaard", size, "grid", finest.wave_approach_error, "wave_approach")
    add(
        "load at given approach, slab",
        "twice the grid",
        f"{size}²",
        "grid",
        finest.slab_load_error,
        "slab_load",
    )

    for short in ("elements", "calculix"):
        if short not in datasets:
            continue
        found = datasets[short]
        apart = differences(found)
        size = f"{found.attrs['grid_points']}²; {found.attrs['elements']}"
        code = found.attrs["code"]
        add("load at given approach, slab", code, size, "mesh, grid", apart.difference_load, f"{short}_load")
        for field in FIELDS:
            error = apart.difference_away.sel(field=field)
            add(f"{_label(field)} away from the edge", code, size, "mesh, grid", error, f"{short}_away")
        if f"{short}_edge" in BOUNDS:
            for field in FIELDS:
                error = apart.difference_edge.sel(field=field)
                add(f"{_label(field)} at the edge", code, size, "edge", error, f"{short}_edge")

    found = datasets["punch"]
    size = f"{found.attrs['grid_points']}²"
    for nu in found.poisson.values:
        one = found.sel(poisson=nu)
        error = one.peak_von_mises_array / one.peak_von_mises_closed_form - 1
        what = f"largest von Mises stress, ν = {nu:g}"
        add(what, "Hertz, Huber", size, "periodic cell, grid", error, "punch_peak")
        error = one.peak_depth_array / one.peak_depth_closed_form - 1
        add(f"its depth, ν = {nu:g}", "Hertz, Huber", size, "periodic cell, grid", error, "punch_depth")
    return rows


def markdown(rows: Sequence[Row]) -> str:
    """The table for `docs/validation.md` and the report."""
    head = "| quantity | against | grid; mesh | error is of | error | bound | guarded by |"
    lines = [head, "|---|---|---|---|---|---|---|"]
    for row in rows:
        value = f"order {row.error:.2f}" if row.source == "rate" else f"{100 * row.error:.2g} %"
        limit = f"≥ {row.bound:g}" if row.source == "rate" else f"{100 * row.bound:g} %"
        verdict = limit if row.holds else f"{limit}, **exceeded**"
        cells = [row.quantity, row.against, row.grid, row.source, value, verdict, f"`{row.test}`"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _rate(points: xr.DataArray, error: xr.DataArray) -> float:
    """Order of convergence, fitted over all grids."""
    return float(-np.polyfit(np.log(points.values), np.log(error.values), 1)[0])


def _label(field: str) -> str:
    """Symbol of a field."""
    quantity, component = field.split("_")
    return {"displacement": "u", "stress": "σ"}[quantity] + "_" + component
