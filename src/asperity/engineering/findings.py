"""Numbers of a case, in SI units: the contact, the stress in each body, and their change with the pixels."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import NamedTuple

from asperity.engineering.case import Body, Load
from asperity.engineering.indenter import Indenter


@dataclass(frozen=True)
class ContactNumbers:
    """Numbers of a contact, in SI units.

    Parameters
    ----------
    nominal_area, area_fraction, contact_area : float
        Area of the map, real over nominal contact area, and real contact area of the map.
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
        Nodes under pressure, and connected patches of them.
    typical_patch_nodes : float
        Patches of more nodes carry half of the load.
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
    typical_patch_nodes: float
    load_of_largest_node: float
    load_on_small_patches: float
    load_on_edges: float
    violation: float


class Extreme(NamedTuple):
    """Extreme value of a field of the stress in Pa, and its place on the map in m."""

    value: float
    depth: float
    y: float
    x: float


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
    peak_count : int
    volume_above_yield : float or None
        Volume under the map whose von Mises stress is above yield; None without a yield stress.
    depths_above_yield : (first, last) or None
        Depths between which planes contain such points.
    fraction_above_yield : float or None
        That volume over the volume from the surface to the last of these depths.
    """

    body: Body
    largest: dict[str, Extreme]
    peak_percentiles: dict[int, float]
    peak_count: int
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
class Numbers:
    """The numbers whose change with the resolution is reported; stresses in Pa, of the lower body.

    Parameters
    ----------
    area_fraction, largest_pressure, largest_von_mises : float
    peaks_90, peaks_99 : float
        Percentiles of the von Mises peaks below the contacts.
    """

    area_fraction: float
    largest_pressure: float
    largest_von_mises: float
    peaks_90: float
    peaks_99: float

    def changes_from(self, other: Numbers) -> dict[str, float]:
        """Relative difference of every number to that of another; NaN where that is zero or unknown."""
        mine, its = asdict(self), asdict(other)
        return {name: mine[name] / its[name] - 1 if its[name] else float("nan") for name in mine}


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


@dataclass(frozen=True)
class Findings:
    """All from which the advice on a case follows.

    Parameters
    ----------
    indenter : Indenter
    load : Load
    numbers : ContactNumbers
    bodies : dict
        ``lower`` and, if it is elastic, ``upper`` → `BodyAnswer`.
    fine, coarse : Numbers
        Main numbers, and those with pixels twice as large.
    neighbours : Neighbours or None
        None without the form of a ball or cylinder, and with a free boundary.
    """

    indenter: Indenter
    load: Load
    numbers: ContactNumbers
    bodies: dict[str, BodyAnswer]
    fine: Numbers
    coarse: Numbers
    neighbours: Neighbours | None = None
