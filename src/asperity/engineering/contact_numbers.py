"""Numbers of the contact in an answer, in SI units: contact spots, areas, pressures, and the certificate."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Certificate, Contact, verify_contact
from asperity.contact.certificate import MAX_ROUNDINGS, rms_deviation
from asperity.contact.patches import contact_patches
from asperity.contact.solution import adhesion_of
from asperity.core.types import Array
from asperity.elasticity.loaded_solid import solid_of
from asperity.engineering.face import RoughFace
from asperity.fourier.grid import BOUNDARIES
from asperity.results.dataset import grid_of, height_of
from asperity.surface.roughness import roughness_parameters
from asperity.surface.treatment.treatment import TreatedMap

SPANS = "none", "y", "x", "x and y"
"""Directions along which a contact spot spans the cell."""


def _named(name: str, unit: str) -> Any:
    """A number that the answer lists under a name, with its unit."""
    return field(metadata={"name": name, "unit": unit})


@dataclass(frozen=True, kw_only=True)
class ContactNumbers:
    """Numbers of the contact on the map, in SI units.

    Parameters
    ----------
    contact_area_fraction, contact_area, nominal_area : float
        Real over nominal contact area, real contact area, and area of the map.
    nominal_pressure, mean_pressure, maximum_pressure : float
        Load over nominal area, load over real contact area, and the maximum pressure at a node.
    force : float
        Load on the area of the map.
    load_per_length : float
        Load over the edge along which the map continues, if it ends along the other one; else NaN.
    normal_approach, mean_gap : float
        Approach of the bodies since their first touch, and mean distance of the deformed surfaces.
    rms_height, rms_gradient, peak_to_valley : float
        Of the surface that was pressed.
    gradient_rms_contact : float
        Rms gradient of the deformed surface over the real contact.
    patches, contact_nodes : int
        Contact spots of the map, and their nodes.
    typical_patch_width : float
        Width in pixels; wider spots carry half of the load.
    pressure_on_spike : bool
        True if the maximum pressure is on a spike of the map.
    presses_spikes : bool
        True if a spike bears pressure.
    load_of_largest_node, load_on_small_patches : float
        Fraction of the load on one node, and on spots of at most four nodes.
    load_on_edges : float
        Fraction of the load on the outermost nodes where the map ends.
    violation : float
        Largest violation of the conditions of contact; see `asperity.contact.Certificate`.
    """

    contact_area_fraction: float = _named("contact area fraction", "1")
    contact_area: float = _named("contact area", "m^2")
    nominal_pressure: float = _named("mean pressure", "Pa")
    mean_pressure: float = _named("mean contact pressure", "Pa")
    maximum_pressure: float = _named("maximum pressure", "Pa")
    force: float = _named("force", "N")
    load_per_length: float = _named("load per length", "N/m")
    normal_approach: float = _named("normal approach", "m")
    mean_gap: float = _named("mean gap", "m")
    rms_height: float = _named("Sq", "m")
    rms_gradient: float = _named("Sdq", "1")
    gradient_rms_contact: float = _named("rms gradient in contact", "1")
    patches: int = _named("contact spots", "1")
    nominal_area: float = _named("nominal area", "m^2")
    contact_nodes: int
    peak_to_valley: float
    typical_patch_width: float
    pressure_on_spike: bool
    presses_spikes: bool
    load_of_largest_node: float
    load_on_small_patches: float
    load_on_edges: float
    violation: float


def certificate_in_words(certificate: Certificate) -> str:
    """The certificate of a contact: the largest violation of its conditions, and the bound of the error."""
    if math.isfinite(certificate.stability):
        stable = "stable" if certificate.stability > 0 else "unstable"
        return (
            f"it is stationary, its conditions are violated by at most {certificate.worst:.1e}, and {stable} "
            "along the directions computed; other contacts may exist"
        )
    return (
        f"its conditions are violated by at most {certificate.worst:.1e}; the energy of the error of the "
        f"pressure is at most {certificate.error_bound:.1e} of load times Sq"
    )


def stored_certificate(
    contact: xr.Dataset, height: Array | None = None
) -> tuple[Certificate, dict[str, float]]:
    """Certificate of a stored contact, recomputed, and the largest violations that are accepted.

    These are the violations that the solver found, with the rounding of the fields in the file.

    Parameters
    ----------
    contact : dataset
        Result of stage contact.
    height : (ny, nx) array, optional
        By default it follows from gap, displacement and approach.
    """
    grid, solid = grid_of(contact), solid_of(contact)
    pressure, displacement = (
        contact[name].transpose("y", "x").values for name in ("pressure", "displacement")
    )
    if height is None:
        height = height_of(contact).transpose("y", "x").values
    approach = float(contact["approach"])
    found = verify_contact(
        height,
        pressure,
        solid,
        grid,
        approach=approach,
        mean_pressure=float(contact["mean_pressure"]),
        hardness=float(contact["hardness"]) if "hardness" in contact else None,
        boundary=str(contact.attrs.get("boundary", "periodic")),
        adhesion=adhesion_of(contact),
    )
    rounding = MAX_ROUNDINGS * float(np.finfo(pressure.dtype).eps)
    nodal = float(pressure.max()) * min(grid.spacing) / solid.effective_modulus
    largest = abs(approach) + float(np.abs(height).max()) + float(np.abs(displacement).max())
    lengths = rounding * largest / (rms_deviation(height) or nodal or 1.0)
    found = replace(found, stability=float(contact.attrs.get("certificate_stability", math.nan)))
    return found, {
        name: float(contact.attrs.get(f"certificate_{name}", 0.0))
        + (rounding if name in ("tension", "load_imbalance") else lengths)
        for name in found.violations
    }


def contact_spots(face: TreatedMap, contact: Contact) -> pd.DataFrame:
    """Contact spots on the map, the largest load first.

    Returns
    -------
    DataFrame
        Columns as ``docs/tables.md`` describes them. Length and width are the axes of the ellipse with the
        area of the spot and the ratio of its principal second moments. Numbers of a spot that spans the cell
        are for one period.
    """
    pressure, grid = contact.pressure, face.grid
    axes = zip(grid.images, BOUNDARIES[face.boundary], strict=True)
    meets = tuple(images == 1 and not ends for images, ends in axes)  # opposite edges of the map
    number, _, cells, spans = contact_patches(contact.touching, meets)
    node = np.flatnonzero(number)
    spot, carried = number.ravel()[node] - 1, pressure.ravel()[node].astype(float)
    nodes = np.bincount(spot)

    def mean(values: Array) -> Array:
        return np.bincount(spot, values, nodes.size) / nodes

    place, offset = [], []
    for axis, index in enumerate(np.divmod(node, grid.shape[1])):
        along = index + grid.shape[axis] * cells[axis].ravel()[node]
        middle = mean(along)
        place.append(middle % grid.shape[axis] * grid.spacing[axis])
        offset.append((along - middle[spot]) * grid.spacing[axis])
    yy, xx = (mean(own**2) + step**2 / 12 for own, step in zip(offset, grid.spacing, strict=True))
    yx = mean(offset[0] * offset[1])
    spread = np.hypot((xx - yy) / 2, yx)
    ratio = np.sqrt(((xx + yy) / 2 + spread) / ((xx + yy) / 2 - spread))
    area = nodes * grid.area / grid.size
    largest = np.zeros(nodes.size)
    np.maximum.at(largest, spot, carried)
    table = pd.DataFrame(
        {
            "area_m2": area,
            "load_N": np.bincount(spot, carried, nodes.size) * grid.area / grid.size,
            "y_m": place[0],
            "x_m": place[1],
            "length_m": np.sqrt(4 / np.pi * area * ratio),
            "width_m": np.sqrt(4 / np.pi * area / ratio),
            "angle_deg": np.degrees(np.arctan2(2 * yx, xx - yy) / 2) % 180,
            "maximum_pressure_Pa": largest,
            "nodes": nodes,
            "spans": np.array(SPANS)[spans @ [1, 2]],
        }
    )
    return table.sort_values("load_N", ascending=False, ignore_index=True)


def contact_numbers(rough: RoughFace, contact: Contact, spots: pd.DataFrame) -> ContactNumbers:
    """Numbers of the contact: areas, pressures, spots."""
    face = rough.face
    pressure, load = np.maximum(contact.pressure, 0), spots["load_N"].clip(lower=0)
    nominal = face.grid.area
    node = nominal / face.grid.size
    free = BOUNDARIES[face.boundary]
    inner = tuple(slice(ends, -1 if ends else None) for ends in map(int, free))
    total, inside = max(float(load.sum()), 1e-300), float(pressure[inner].sum(dtype=float)) * node
    area, force = contact.contact_area_fraction * nominal, contact.mean_pressure * nominal
    largest = np.array(np.unravel_index(pressure.argmax(), pressure.shape)) * face.grid.spacing
    spikes = np.rint(rough.spikes / face.grid.spacing).astype(int)
    spikes = np.minimum(spikes, np.subtract(pressure.shape, 1))
    is_line = free.count(True) == 1
    roughness = roughness_parameters(face.height, face.grid)
    return ContactNumbers(
        contact_area_fraction=contact.contact_area_fraction,
        contact_area=area,
        nominal_pressure=contact.mean_pressure,
        mean_pressure=(force / area if contact.adhesion is None else contact.mean_contact_pressure)
        if area
        else 0.0,
        maximum_pressure=float(pressure.max()),
        force=force,
        load_per_length=force / face.grid.length[free.index(False)] if is_line else math.nan,
        normal_approach=contact.approach - float(contact.height.min()),
        mean_gap=float(gap_of(contact).mean(dtype=float)),
        rms_height=roughness.rms_height,
        rms_gradient=roughness.rms_gradient,
        gradient_rms_contact=contact.gradient_rms_contact,
        patches=len(spots),
        contact_nodes=int(spots["nodes"].sum()),
        nominal_area=nominal,
        peak_to_valley=float(np.ptp(face.height)),
        typical_patch_width=typical_width(spots) / max(face.grid.spacing),
        pressure_on_spike=bool((np.abs(rough.spikes - largest) <= rough.reach).all(axis=1).any()),
        presses_spikes=bool(pressure[tuple(spikes.T)].any()),
        load_of_largest_node=float(pressure.max()) * node / total,
        load_on_small_patches=float(load[spots["nodes"] <= 4].sum()) / total,
        load_on_edges=1 - inside / total,
        violation=contact.certificate.worst,
    )


def typical_width(spots: pd.DataFrame) -> float:
    """Width of a spot in m such that wider spots carry half of the load; 0 without contact."""
    if spots.empty:
        return 0.0
    by_width = spots.sort_values("width_m")
    carried = by_width["load_N"].clip(lower=0).cumsum().to_numpy()  # adhesion pulls at some
    return float(by_width["width_m"].iloc[np.searchsorted(carried, carried[-1] / 2)])


def gap_of(contact: Contact) -> Array:
    """Gap on the nodes, 0 where they touch."""
    return np.where(contact.touching, 0.0, contact.gap)
