"""Comparisons with two finite-element codes: a paraboloid pressed into a bonded cubic slab."""

from __future__ import annotations

import os

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.reference import calculix, finite_element
from asperity.reference.line_elements import graded
from asperity.types import Array, Progress
from asperity.validation.indenter import CURVATURE_RADIUS, INDENTATION, fitted_contact_radius, slab_contact
from asperity.validation.pointwise import displacement_and_stress

FIELDS = {"displacement_z": 2, "stress_zz": 2, "stress_xx": 0, "stress_xz": 4}
"""Compared fields, with their index among the components of displacement or stress."""

EDGE_DISTANCE = 0.05
"""Points within this distance of the edge of contact, in cell edges, count as near it."""

APPROACH = INDENTATION / CURVATURE_RADIUS
"""The paper's indentation depth for the cubic slab."""


def slab_mesh(elements: tuple[int, int]) -> tuple[Array, Array]:
    """Ends of the elements along half the cell and along the height of the slab, finer at the contact."""
    across, up = elements
    return graded(0.5, across, 3.0), 1 - graded(1.0, up, 10.0)[::-1]


def compare_elements(
    elements: tuple[int, int] = (24, 20),
    points: int = 256,
    approach: float = APPROACH,
    poisson: float = 0.33,
    contact: Contact | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Fields on the diagonal plane of a slab by the spectral solver and finite elements (figures 1, 3, 4).

    Parameters
    ----------
    elements : (int, int)
        27-node hexahedra along half an edge of the cell, and along its height.
    points : int
        Nodes on an edge of the spectral grid.
    approach, poisson : float
    contact : Contact, optional
        The spectral solution, if it is already known.
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        The fields `FIELDS` of both on the diagonal plane (depth, distance), the loads, the pressures along
        x, and the displacements of the elements on the outside of the quarter cell.
    """
    plane, column = slab_mesh(elements)
    slab = finite_element.Slab(plane, column, 1 - poisson**2, poisson)
    pressed = finite_element.press(slab, CURVATURE_RADIUS, approach, progress=progress)
    x, z, displacement, stress = slab.on_diagonal(pressed.displacement)
    contact = contact or slab_contact(points, approach, poisson)
    dataset = _fields_of_both(contact, x, 1 - z, displacement, stress, pressed.load)
    middle = contact.grid.shape[0] // 2
    moved = pressed.displacement
    dataset = dataset.assign(
        pressure_elements=("axis_node", pressed.pressure[0]),
        pressure_spectral=("axis_position", contact.pressure[middle, middle:]),
        surface_displacement_elements=(("node_y", "axis_node"), moved[2, -1]),
        wall_displacement_elements=(("component", "node_z", "axis_node"), moved[:, :, 0]),
        rim_displacement_elements=(("component", "node_z", "axis_node"), moved[:, :, -1]),
    ).assign_coords(
        axis_node=slab.free.nodes,
        axis_position=contact.grid.coordinates()[1][middle:] - 0.5,
        node_z=slab.column.nodes,
    )
    return dataset.assign_attrs(
        code="scikit-fem",
        elements=f"{elements[0]} × {elements[0]} × {elements[1]} hexahedra of 27 nodes",
        unknowns=int(moved.size),
        iterations=pressed.iterations,
        active_sets=pressed.active_sets,
        poisson=poisson,
        approach=approach,
    )


def compare_calculix(
    folder: str | os.PathLike[str],
    elements: tuple[int, int] = (14, 12),
    points: int = 256,
    approach: float = APPROACH,
    poisson: float = 0.33,
    penalty: float = 5e3,
) -> xr.Dataset:
    """Fields on the diagonal plane of the slab by the spectral solver and by CalculiX, which must be
    installed.

    Parameters
    ----------
    folder : path
        Folder of the input deck and the files of CalculiX.
    elements : (int, int)
        20-node bricks along half an edge of the cell, and along its height.
    points : int
        Nodes on an edge of the spectral grid.
    approach, poisson : float
    penalty : float
        Contact pressure per length of penetration, in E* per cell edge.

    Returns
    -------
    Dataset
        The fields `FIELDS` of both on the diagonal plane (depth, distance), and the loads.
    """
    plane, column = slab_mesh(elements)
    found = calculix.press(
        folder, plane, column, 1 - poisson**2, poisson, CURVATURE_RADIUS, approach, penalty
    )
    contact = slab_contact(points, approach, poisson)
    dataset = _fields_of_both(contact, found.x, 1 - found.z, found.displacement, found.stress, found.load)
    return dataset.assign_attrs(
        code=f"CalculiX {found.version}",
        elements=f"{elements[0]} × {elements[0]} × {elements[1]} bricks of 20 nodes, reduced integration",
        penalty=penalty,
        poisson=poisson,
        approach=approach,
    )


def _fields_of_both(
    contact: Contact, x: Array, depth: Array, displacement: Array, stress: Array, load: float
) -> xr.Dataset:
    """Fields of both solutions at the Gauss points of the elements, ordered by depth."""
    order = np.argsort(depth)
    depth = depth[order]
    spectral = displacement_and_stress(contact.pressure, contact.grid, contact.layer, x + 0.5, x + 0.5, depth)
    elements = displacement[order], stress[order]
    dimensions = ("depth", "distance")
    variables: dict[str, object] = {
        "load_spectral": contact.mean_pressure,
        "load_elements": load,
        "contact_radius": fitted_contact_radius(contact.pressure, contact.grid),
    }
    for name, component in FIELDS.items():
        kind = 0 if name.startswith("displacement") else 1
        variables[f"{name}_spectral"] = dimensions, spectral[kind][..., component]
        variables[f"{name}_elements"] = dimensions, elements[kind][..., component]
    return xr.Dataset(
        variables,
        coords={"distance": np.sqrt(2) * x, "depth": depth},
        attrs={"grid_points": contact.grid.shape[0], "curvature_radius": CURVATURE_RADIUS},
    )


def largest_differences(dataset: xr.Dataset) -> xr.Dataset:
    """Largest difference of each field over its largest magnitude, near the edge of contact and away from it.

    Parameters
    ----------
    dataset : Dataset
        Result of `compare_elements` or `compare_calculix`.

    Returns
    -------
    Dataset
        ``difference_away`` and ``difference_edge`` along ``field``, and ``difference_load``.
    """
    distance = np.hypot(dataset.distance - dataset.contact_radius, dataset.depth)
    rows = []
    for name in FIELDS:
        spectral, elements = dataset[f"{name}_spectral"], dataset[f"{name}_elements"]
        relative = np.abs(spectral - elements) / np.abs(spectral).max()
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
