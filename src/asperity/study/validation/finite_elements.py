"""Comparison with finite elements: a paraboloid pressed into a bonded cubic slab."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.reference import finite_element
from asperity.reference.finite_element import graded
from asperity.study.validation import indenter
from asperity.study.validation.indenter import CURVATURE_RADIUS

COMPARED_FIELDS = {"displacement_z": 2, "stress_zz": 2, "stress_xx": 0, "stress_xz": 4}
"""Compared fields, with their index among the components of displacement or stress."""

EDGE_DISTANCE = 0.05
"""Points within this distance of the edge of contact, in cell edges, are near it."""

APPROACH = indenter.INDENTATION / CURVATURE_RADIUS
"""The paper's indentation depth for the cubic slab."""


def elements(
    meshes: Sequence[tuple[int, int]] = ((8, 7), (12, 10), (16, 13), (24, 20)), points: int = 256
) -> xr.Dataset:
    """Fields on the diagonal plane of a slab by the spectral solver and finite elements (figures 1, 3, 4).

    Parameters
    ----------
    meshes : sequence of (int, int)
        27-node hexahedra along half an edge of the cell, and along its height; finer at the contact. Coarse
        to fine.
    points : int
        Nodes on an edge of the spectral grid.

    Returns
    -------
    Dataset
        Of the finest mesh, the fields `COMPARED_FIELDS` of both on the diagonal plane (depth, distance),
        ordered by depth, at the Gauss points of the elements; the loads, and the displacements of the
        elements on the outside of the quarter cell. Of all meshes, along ``mesh``, the variables of
        `largest_differences`.
    """
    contact = indenter.slab_contact(points, APPROACH)
    compared = [_on_mesh(across, up, contact) for across, up in meshes]
    differences = xr.concat([largest_differences(one) for one in compared], "mesh")
    return compared[-1].merge(differences).assign_coords(mesh_elements=("mesh", [one for one, _ in meshes]))


def _on_mesh(across: int, up: int, contact: Contact) -> xr.Dataset:
    """Fields by the elements of one mesh, and by the spectral solution at the same places."""
    poisson = 0.33
    nodes = graded(0.5, across, 3.0), 1 - graded(1.0, up, 10.0)[::-1]
    slab = finite_element.Slab(*nodes, 1 - poisson**2, poisson)
    moved, push = finite_element.press(slab, CURVATURE_RADIUS, APPROACH)
    x, z, *by_elements = slab.on_diagonal(moved)
    order = np.argsort(1 - z)
    depth = (1 - z)[order]
    solved = contact.pressure, contact.grid, contact.layer
    spectral = indenter.displacement_and_stress(*solved, x + 0.5, x + 0.5, depth)
    variables: dict[str, object] = {
        "load_spectral": contact.mean_pressure,
        "load_elements": 4 * float(push.sum()),
        "contact_radius": indenter.fitted_contact_radius(contact.pressure, contact.grid),
        "surface_displacement_elements": (("node_y", "axis_node"), moved[2, -1]),
        "rim_displacement_elements": (("component", "node_z", "axis_node"), moved[:, :, -1]),
    }
    for name, component in COMPARED_FIELDS.items():
        kind = 0 if name.startswith("displacement") else 1
        variables[f"{name}_spectral"] = ("depth", "distance"), spectral[kind][..., component]
        variables[f"{name}_elements"] = ("depth", "distance"), by_elements[kind][order][..., component]
    nodes_of_walls = {"axis_node": slab.plane.nodes, "node_z": slab.column.nodes}
    return xr.Dataset(
        variables,
        coords={"distance": np.sqrt(2) * x, "depth": depth} | nodes_of_walls,
        attrs={
            "grid_points": contact.grid.shape[0],
            "curvature_radius": CURVATURE_RADIUS,
            "approach": APPROACH,
            "poisson": poisson,
            "elements": f"{across} × {across} × {up} hexahedra of 27 nodes",
            "unknowns": int(moved.size),
        },
    )


def largest_differences(dataset: xr.Dataset) -> xr.Dataset:
    """Largest difference of each field over its largest magnitude, near the edge of contact and away from it.

    Parameters
    ----------
    dataset : Dataset
        With the fields of `elements`.

    Returns
    -------
    Dataset
        ``difference_away`` and ``difference_edge`` along ``field``, and ``difference_load``.
    """
    near = np.hypot(dataset.distance - dataset.contact_radius, dataset.depth) <= EDGE_DISTANCE
    fields = {name: (dataset[f"{name}_spectral"], dataset[f"{name}_elements"]) for name in COMPARED_FIELDS}
    relative = xr.Dataset(
        {name: np.abs(ours - theirs) / np.abs(ours).max() for name, (ours, theirs) in fields.items()}
    ).to_dataarray("field")
    return xr.Dataset(
        {
            "difference_away": relative.where(~near).max(("depth", "distance")),
            "difference_edge": relative.where(near).max(("depth", "distance")),
            "difference_load": dataset.load_elements / dataset.load_spectral - 1,
        }
    )
