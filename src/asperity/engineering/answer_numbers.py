"""Numbers of an answer in SI units: of the contact, and of the stress in each body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array
from asperity.engineering.body_stress import DIRECTION, Extreme, StressInBody
from asperity.engineering.case import Body
from asperity.engineering.face import RoughFace
from asperity.fourier.grid import Fourier, mean_square
from asperity.stress.peaks.selection import peaks
from asperity.surface.roughness import roughness_parameters
from asperity.surface.treatment.treatment import TreatedMap


@dataclass(frozen=True)
class ContactNumbers:
    """Numbers of the contact on the map, in SI units.

    Parameters
    ----------
    nominal_area, area_fraction, contact_area : float
        Area of the map, real over nominal contact area, and real contact area.
    nominal_pressure, mean_pressure, largest_pressure : float
        Load over nominal area, load over real contact area, and the largest pressure at a node.
    force : float
        Load on the area of the map.
    approach, mean_gap : float
        Approach of the bodies since their first touch, and mean distance of the deformed surfaces.
    rms_height, peak_to_valley, rms_gradient : float
        Of the surface that was pressed.
    gradient_rms_contact : float
        Rms gradient of the deformed surface over the real contact.
    contact_nodes, patches : int
        Nodes of the map under pressure, and connected patches of them.
    typical_patch_width : float
        Wider patches carry half of the load; in pixels.
    pressure_on_spike : bool
        True if the largest pressure is on a spike of the map.
    load_of_largest_node, load_on_small_patches : float
        Share of the load on one node, and on patches of at most four nodes.
    load_on_edges : float
        Share of the load on the outermost nodes.
    violation : float
        Largest violation of the conditions of contact; see `asperity.contact.Certificate`.
    """

    nominal_area: float
    area_fraction: float
    contact_area: float
    nominal_pressure: float
    mean_pressure: float
    largest_pressure: float
    force: float
    approach: float
    mean_gap: float
    rms_height: float
    peak_to_valley: float
    rms_gradient: float
    gradient_rms_contact: float
    contact_nodes: int
    patches: int
    typical_patch_width: float
    pressure_on_spike: bool
    load_of_largest_node: float
    load_on_small_patches: float
    load_on_edges: float
    violation: float


@dataclass(frozen=True)
class BodyAnswer:
    """Numbers of the stress in one body, in SI units.

    Parameters
    ----------
    body : Body
    largest : dict
        Field → its extreme value: the largest of ``von_mises``, ``largest_shear`` (Tresca) and
        ``principal_1`` (tension), the smallest of ``principal_3`` and ``hydrostatic`` (compression), and that
        of the largest magnitude of any other field.
    peak_percentiles : dict
        Percentage → percentile of the von Mises peaks below the contacts.
    volume_above_yield : float or None
        Volume under the map whose von Mises stress is above yield; None without a yield stress.
    depths_above_yield : (first, last) or None
        Depths between which there are such points, interpolated between planes.
    fraction_above_yield : float or None
        That volume over the volume from the surface to the last of these depths.
    """

    body: Body
    largest: dict[str, Extreme]
    peak_percentiles: dict[int, float]
    volume_above_yield: float | None
    depths_above_yield: tuple[float, float] | None
    fraction_above_yield: float | None

    @property
    def largest_von_mises(self) -> float:
        """Largest von Mises stress."""
        return self.largest["von_mises"].value

    @property
    def depth(self) -> float:
        """Depth of the largest von Mises stress."""
        return self.largest["von_mises"].depth

    @property
    def y(self) -> float:
        """Place of the largest von Mises stress along y."""
        return self.largest["von_mises"].y

    @property
    def x(self) -> float:
        """Place of the largest von Mises stress along x."""
        return self.largest["von_mises"].x


@dataclass(frozen=True)
class Neighbours:
    """Effect of the periodic images of a ball or cylinder.

    Parameters
    ----------
    span : float
        Width of the contact over the distance between neighbours, the larger of those along y and x.
    area_fraction, largest_pressure : float
        Real contact and largest pressure under the same load without neighbours; NaN for layers, whose
        contact cannot be solved without them.
    """

    span: float
    area_fraction: float
    largest_pressure: float


def gap_of(face: TreatedMap, contact: Contact) -> Array:
    """Gap on the nodes of the map, 0 where there is pressure."""
    return face.part(np.where(contact.pressure > 0, 0.0, contact.gap))


def sampling_error(face: TreatedMap) -> float:
    """Relative standard deviation of the rms height between places of a surface, from one of them.

    The power of each wave of a random surface varies by itself from place to place; the fewer waves bear most
    of the height, the more it varies. A mirrored map has a quarter of the independent waves of its cell.
    """
    modes = Fourier(face.grid).forward(face.height)
    power = np.abs(modes) ** 2
    squares, total = (mean_square(modes, face.grid, weight) for weight in (power, np.ones_like(power)))
    return float(0.5 * face.images * np.sqrt(squares) / total)


def contact_span(face: TreatedMap, contact: Contact) -> float:
    """Width of the contact on the map over the edge of the map, the larger of those along y and x."""
    touching = np.argwhere(face.part(contact.pressure) > 0)
    if not touching.size:
        return 0.0
    return float(((np.ptp(touching, axis=0) + 1) / face.map_shape).max())


def contact_numbers(rough: RoughFace, contact: Contact, spots: pd.DataFrame) -> ContactNumbers:
    """Numbers of the contact: areas, pressures, patches."""
    face = rough.face
    pressure, gap = face.part(contact.pressure), gap_of(face, contact)
    load = spots["load_N"]
    node = face.grid.area / face.grid.size
    total, inside = max(float(load.sum()), 1e-300), float(pressure[1:-1, 1:-1].sum(dtype=float)) * node
    area, force = contact.area_fraction * face.map_area, contact.mean_pressure * face.map_area
    largest = np.array(np.unravel_index(pressure.argmax(), pressure.shape)) * face.grid.spacing
    roughness = roughness_parameters(face.height, face.grid.length)
    return ContactNumbers(
        nominal_area=face.map_area,
        area_fraction=contact.area_fraction,
        contact_area=area,
        nominal_pressure=contact.mean_pressure,
        mean_pressure=force / area if area else 0.0,
        largest_pressure=float(pressure.max()),
        force=force,
        approach=contact.approach - float(contact.height.min()),
        mean_gap=float(gap.mean(dtype=float)),
        rms_height=roughness.rms_height,
        peak_to_valley=float(np.ptp(face.height)),
        rms_gradient=roughness.rms_gradient,
        gradient_rms_contact=contact.gradient_rms_contact,
        contact_nodes=int(spots["nodes"].sum()),
        patches=len(spots),
        typical_patch_width=_load_median(spots) / max(face.grid.spacing),
        pressure_on_spike=bool((np.abs(rough.spikes - largest) <= rough.reach).all(axis=1).any()),
        load_of_largest_node=float(pressure.max()) * node / total,
        load_on_small_patches=float(load[spots["nodes"] <= 4].sum()) / total,
        load_on_edges=1 - inside / total,
        violation=contact.certificate.worst,
    )


def _load_median(spots: pd.DataFrame) -> float:
    """Width of a patch such that wider patches carry half of the load."""
    if spots.empty:
        return 0.0
    by_width = spots.sort_values("width_m")
    carried = by_width["load_N"].cumsum().to_numpy()
    return float(by_width["width_m"].iloc[np.searchsorted(carried, carried[-1] / 2)])


def body_answer(body: Body, stress: StressInBody, face: TreatedMap) -> BodyAnswer:
    """Numbers of the stress in one body."""
    depths = stress.dataset["plane_depth"].values
    volume, bounds, fraction = None, None, None
    if stress.above_yield is not None and body.yield_stress is not None:
        volume = float(np.trapezoid(stress.above_yield, depths)) * face.map_area
        bounds = _depths_above(body.yield_stress, stress.dataset["largest_von_mises"].values.ravel(), depths)
        if bounds is not None:
            fraction = volume / (face.map_area * bounds[1]) if bounds[1] else 0.0
    largest = {}
    for field, found in stress.extremes.items():
        found = _between_nodes(field, found, stress.dataset)
        y, x = map(float, face.on_map(found.y, found.x))
        largest[field] = found._replace(y=y, x=x)
    return BodyAnswer(body, largest, _percentiles(stress.dataset), volume, bounds, fraction)


def _depths_above(limit: float, largest: Array, depths: Array) -> tuple[float, float] | None:
    """Depths between which a stress is above a limit, from its largest value in each plane."""
    above = np.flatnonzero(largest > limit)
    if not above.size:
        return None

    def crossing(plane: int, beyond: int) -> float:
        if not 0 <= beyond < depths.size:
            return float(depths[plane])
        return float(np.interp(limit, largest[[beyond, plane]], depths[[beyond, plane]]))

    return crossing(above[0], above[0] - 1), crossing(above[-1], above[-1] + 1)


def _percentiles(stress: xr.Dataset) -> dict[int, float]:
    """Percentiles of the von Mises peaks below the contacts; NaN if there is none."""
    found = np.abs(peaks(stress, "von_mises", selection="under_contact")["peak_value"].values)
    return {n: float(np.percentile(found, n)) if found.size else float("nan") for n in (50, 90, 99)}


def _between_nodes(field: str, found: Extreme, stress: xr.Dataset) -> Extreme:
    """The extreme value at the nodes, or the largest peak between them if that is larger."""
    if field not in stress["quantity"].values:
        return found
    sign = float(DIRECTION.get(field) or np.sign(found.value))
    candidates = peaks(stress, field)
    values = sign * candidates["peak_value"].values
    if not values.size or values.max() < sign * found.value:
        return found
    names = ("peak_value", "peak_depth", "peak_y", "peak_x")
    return Extreme(*(float(candidates[name].values[values.argmax()]) for name in names))
