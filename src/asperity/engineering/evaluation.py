"""Numbers of an answer from the results of its stages."""

from __future__ import annotations

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.engineering.case import Body
from asperity.engineering.extremes import DIRECTION, StressInBody
from asperity.engineering.findings import BodyAnswer, ContactNumbers, Extreme, Numbers
from asperity.engineering.indenter import Indenter
from asperity.stress.patches import contact_patches
from asperity.stress.selection import peaks
from asperity.surface.roughness import roughness_parameters
from asperity.types import Array


def main_numbers(contact: Contact, stress: xr.Dataset) -> Numbers:
    """The numbers whose change with the resolution is reported."""
    found = np.abs(peaks(stress, "von_mises", selection="under_contact")["peak_value"].values)
    return Numbers(
        area_fraction=contact.area_fraction,
        largest_pressure=float(contact.pressure.max()),
        largest_von_mises=float(stress["largest_von_mises"].max()),
        peaks_90=float(np.percentile(found, 90)) if found.size else float("nan"),
        peaks_99=float(np.percentile(found, 99)) if found.size else float("nan"),
    )


def contact_span(indenter: Indenter, contact: Contact) -> float:
    """Width of the contact on the map over the edge of the map, the larger of those along y and x."""
    touching = np.argwhere((contact.pressure > 0)[: indenter.map_shape[0], : indenter.map_shape[1]])
    if not touching.size:
        return 0.0
    return float(((np.ptp(touching, axis=0) + 1) / indenter.map_shape).max())


def contact_numbers(indenter: Indenter, contact: Contact) -> ContactNumbers:
    """Numbers of the contact: areas, pressures, patches."""
    touching = contact.pressure > 0
    patch, radii = contact_patches(touching, contact.boundary == "periodic")
    nodes = np.bincount(patch.ravel())[1:]
    carried = np.bincount(patch.ravel(), contact.pressure.ravel().astype(float))[1:]
    area = contact.area_fraction * indenter.map_area
    force = contact.mean_pressure * indenter.map_area
    roughness = roughness_parameters(indenter.height, indenter.grid.length)
    return ContactNumbers(
        nominal_area=indenter.map_area,
        area_fraction=contact.area_fraction,
        contact_area=area,
        nominal_pressure=contact.mean_pressure,
        mean_pressure=force / area if area else 0.0,
        largest_pressure=float(contact.pressure.max()),
        force=force,
        approach=contact.approach - float(contact.height.min()),
        mean_gap=float(contact.gap.mean(dtype=float)),
        rms_height=roughness.rms_height,
        peak_to_valley=float(np.ptp(indenter.height)),
        rms_gradient=roughness.rms_gradient,
        gradient_rms_contact=contact.gradient_rms_contact,
        contact_nodes=int(np.count_nonzero(touching)),
        patches=int(radii.size),
        typical_patch_nodes=_load_median(nodes, carried),
        load_of_largest_node=float(contact.pressure.max() / max(contact.pressure.sum(dtype=float), 1e-300)),
        load_on_small_patches=float(carried[nodes <= 4].sum() / max(carried.sum(), 1e-300)),
        load_on_edges=_load_on_edges(contact.pressure),
        violation=contact.certificate.worst,
    )


def _load_on_edges(pressure: Array) -> float:
    """Share of the load on the outermost nodes."""
    total = float(pressure.sum(dtype=float))
    return 1 - float(pressure[1:-1, 1:-1].sum(dtype=float)) / total if total else 0.0


def _load_median(nodes: Array, carried: Array) -> float:
    """Number of nodes of a patch such that larger patches carry half of the load."""
    if not nodes.size:
        return 0.0
    order = np.argsort(nodes)
    share = np.cumsum(carried[order]) / carried.sum()
    return float(nodes[order][np.searchsorted(share, 0.5)])


def body_answer(body: Body, stress: StressInBody, indenter: Indenter) -> BodyAnswer:
    """Numbers of the stress in one body."""
    dataset = stress.dataset
    under = np.abs(peaks(dataset, "von_mises", selection="under_contact")["peak_value"].values)
    percentiles = {
        percent: float(np.percentile(under, percent)) if under.size else float("nan")
        for percent in (50, 90, 99)
    }
    share = stress.above_yield
    depths = dataset["plane_depth"].values
    volume, bounds, fraction = None, None, None
    if share is not None:
        volume = float(np.trapezoid(share, depths)) * indenter.map_area
        above = np.flatnonzero(share)
        if above.size:
            bounds = float(depths[above[0]]), float(depths[above[-1]])
            fraction = volume / (indenter.map_area * bounds[1]) if bounds[1] else 0.0
    return BodyAnswer(
        body=body,
        largest=_on_map(_refined(stress), indenter),
        peak_percentiles=percentiles,
        peak_count=int(under.size),
        volume_above_yield=volume,
        depths_above_yield=bounds,
        fraction_above_yield=fraction,
    )


def _refined(stress: StressInBody) -> dict[str, Extreme]:
    """Extreme values, replaced by the peak between the nodes where that is larger."""
    found = dict(stress.extremes)
    for field in found:
        if field in stress.dataset["quantity"].values:
            candidates = peaks(stress.dataset, field)
            value, sign = (
                candidates["peak_value"].values,
                _sign(field, found[field]),
            )
            if (
                value.size
                and sign * value[(top := int(np.argmax(sign * value)))] >= sign * found[field].value
            ):
                names = ("peak_value", "peak_depth", "peak_y", "peak_x")
                found[field] = Extreme(*(float(candidates[name].values[top]) for name in names))
    return found


def _sign(field: str, found: Extreme) -> float:
    return DIRECTION[field] if field in DIRECTION else float(np.sign(found.value))


def _on_map(found: dict[str, Extreme], indenter: Indenter) -> dict[str, Extreme]:
    """The extreme values with their places on the map."""
    on_map = {}
    for field, extreme in found.items():
        y, x = indenter.on_map(extreme.y, extreme.x)
        on_map[field] = extreme._replace(y=y, x=x)
    return on_map
