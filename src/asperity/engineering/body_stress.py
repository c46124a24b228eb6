"""Stress in one body of a case: peaks, profiles, extreme values, and their grid error.

One stream of planes gives all but the error; the planes close to the highest pressures are kept for pictures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import Solid
from asperity.engineering.continuum import continuum_on_grids
from asperity.engineering.values import DepthPlanes
from asperity.fourier.grid import Grid
from asperity.settings.body import Body
from asperity.stress.analysis import SOUGHT, analyse_stress
from asperity.stress.peaks.selection import select_peaks
from asperity.stress.planes.stream import LinearPlane, PlaneStream
from asperity.stress.statistics.extrapolation import resolution
from asperity.surface.treatment.treatment import TreatedMap

if TYPE_CHECKING:
    from asperity.engineering.answer import Answer

BOXES = 4
"""Number of close-ups around the highest pressures; if the largest stress is in none, one is added."""

WIDTHS = 2
"""Half of the edge of a close-up over the typical width of a patch."""

FEWEST_PIXELS, MOST_PIXELS = 12, 64
"""Half of the edge of a close-up, in pixels."""

DEPTH = 0.6
"""Depth of a close-up over its edge."""

INTERPOLATION_NODES = 3
"""Nodes beyond a close-up that the interpolation in it uses."""


@dataclass(frozen=True)
class CloseUp:
    """Fields of the stress in a box of the solid below a high pressure.

    Parameters
    ----------
    grid : Grid
        Of the contact.
    part : (rows, columns)
        Nodes of the box.
    along : "x" or "y"
        Axis across the contact.
    depths : list of float
    planes : list of dict
        Of each depth, field → its values at the nodes.
    """

    grid: Grid
    part: tuple[slice, slice]
    along: str
    depths: list[float] = field(default_factory=list)
    planes: list[dict[str, Array]] = field(default_factory=list)

    def add(self, plane: LinearPlane, names: Sequence[str], poisson: float) -> None:
        """Keep the next plane, unless the planes already reach below the box."""
        from scipy.ndimage import map_coordinates

        edge = max((nodes.stop - nodes.start) * step for nodes, step in self._axes)
        if self.depths and self.depths[-1] > DEPTH * edge:
            return
        nodes_along, places = [], []
        each = zip(self._axes, plane.grid.shape, plane.grid.spacing, plane.first_node, strict=True)
        for (nodes, step), count, own, first in each:
            place = (np.arange(nodes.start, nodes.stop) * step - first) / own
            beyond = min(INTERPOLATION_NODES, count - 2)
            node = np.arange(int(place[0]) - beyond, int(place[-1]) + beyond + 2)
            places.append(place - node[0])
            nodes_along.append(node)
        at = np.meshgrid(*places, indexing="ij")
        self.depths.append(plane.depth)
        self.planes.append(
            {name: map_coordinates(plane.field_around(name, poisson, *nodes_along), at) for name in names}
        )

    @property
    def _axes(self) -> list[tuple[slice, float]]:
        """Nodes and spacing along y and x."""
        return list(zip(self.part, self.grid.spacing, strict=True))

    def node(self, y: float, x: float) -> tuple[int, int] | None:
        """Row and column in the box of a place; None outside of it."""
        row, column = (
            round(place / step) - nodes.start for place, (nodes, step) in zip((y, x), self._axes, strict=True)
        )
        rows, columns = (nodes.stop - nodes.start for nodes in self.part)
        return (row, column) if 0 <= row < rows and 0 <= column < columns else None


def close_ups(face: TreatedMap, contact: Contact, width: float) -> list[CloseUp]:
    """Empty close-ups around the highest pressures on the map, none of them in the box of a higher one.

    Parameters
    ----------
    face : TreatedMap
    contact : Contact
    width : float
        Typical width of a patch of contact, in pixels.
    """
    found: list[CloseUp] = []
    weight = contact.pressure / max(contact.max_pressure, 1e-300)
    depth = contact.plastic_depth
    if depth is not None and depth.any():  # ranks nodes at the hardness by their plastic depth
        weight = weight + depth / depth.max()
    left = weight.copy()
    half = round(min(max(WIDTHS * width, FEWEST_PIXELS), MOST_PIXELS))
    while len(found) < BOXES and left.any():
        row, column = np.unravel_index(left.argmax(), left.shape)
        found.append(_close_up(face, weight, (int(row), int(column)), half))
        left[found[-1].part] = 0
    return found


def _close_up(face: TreatedMap, weight: Array, middle: tuple[int, int], half: int) -> CloseUp:
    """Empty close-up around a node; `weight` is the pressure on the map."""
    ends = zip(middle, face.grid.shape, strict=True)
    rows, columns = (slice(max(0, node - half), min(count, node + half + 1)) for node, count in ends)
    # The section follows the larger pressure gradient: across the lay, also of several ridges.
    steps = (np.diff(weight[rows, columns], axis=axis) for axis in (0, 1))
    squares = (float(np.square(step).sum()) for step in steps)
    y, x = (square / step**2 for square, step in zip(squares, face.grid.spacing, strict=True))
    return CloseUp(face.grid, (rows, columns), "x" if x > y else "y")


def _around_extremes(
    answer: Answer, loaded: LoadedSolid, near: Sequence[CloseUp], largest: Mapping[str, Extreme], name: str
) -> list[CloseUp]:
    """Close-ups around the extreme values of the drawn fields that lie in none, from one more stream."""
    case, face, found = answer.case, answer.face, list[CloseUp]()
    for field_name in case.fields if near else ():
        place = largest[field_name]
        if any(box.node(place.y, place.x) is not None for box in (*near, *found)):
            continue
        half = max(part.stop - part.start for part in near[0].part) // 2
        steps = zip((place.y, place.x), face.grid.spacing, face.grid.shape, strict=True)
        row, column = (min(round(at / step), count - 1) for at, step, count in steps)
        found.append(_close_up(face, answer.contact.pressure, (row, column), half))
    if found:
        stream = PlaneStream(
            loaded, near[0].depths, None, case.fields, STRESS_TOLERANCE, **case.sliding_of(name)
        )
        for plane in stream.planes():
            for box in found:
                box.add(plane, case.fields, loaded.layer.poisson)
    return found


STRESS_TOLERANCE = 1e-4
"""Error of a deep plane on a coarser grid, relative to the rms of σ_zz in it."""

ESTIMATED = ("pressure", "von_mises")
"""Quantities whose peaks are estimated for vanishing pixels."""

DIRECTION = {"von_mises": 1, "largest_shear": 1, "principal_1": 1, "principal_3": -1, "hydrostatic": -1}
"""Field → 1 if its largest value is sought, −1 if its smallest is; of others the largest magnitude."""

RESOLUTION_ERRORS = {
    "largest_shear": ((0.9, 1.5), (0.28, 0.25)),
    "principal_1": ((1.6, 0.75), (0.42, 0.25)),
    "principal_3": ((1.2, 1.5), (0.07, 0.25)),
    "hydrostatic": ((1.2, 1.5), (0.07, 0.25)),
    "shear_range": ((2.9, 1.5), (0.45, 0.25)),
    "dang_van": ((1.4, 1.5), (0.55, 0.25)),
    "shakedown_lower": ((1.0, 1.5), (0.28, 0.25)),
    "shakedown_upper": ((1.0, 1.5), (0.2, 0.25)),
}
"""Number → factor a and power b of its relative grid error a·c^b, of an elastic contact and of one whose
pressure reaches the hardness; c is the relative correction of the real contact over the share of the area out
of contact. Nine in ten errors of 120 surfaces are smaller (`benchmarks/answers.py`)."""

BOUNDS = {"largest_shear": (3**-0.5, 0.0), "principal_1": (2 / 3, 1.0), "principal_3": (2 / 3, -1.0)}
"""Field → factors of the von Mises and the hydrostatic stress in an upper bound of it, or of its negative.

Principal stresses are computed only where the bound exceeds the extreme value so far: `run` takes a quarter
of the time at 512²."""

BOUND_ERROR = 1e-5
"""Uncertainty of these bounds by rounding in single precision, relative to the highest of a plane."""


class Extreme(NamedTuple):
    """Extreme value of a field of the stress in Pa, and its place in m."""

    value: float
    depth: float
    y: float
    x: float


@dataclass(frozen=True, eq=False)
class Interface:
    """Stress on the interface of a coating.

    Parameters
    ----------
    along : (float, float)
        σ_xx of the largest magnitude, in the coating and in the base.
    largest : dict
        ``shear``, √(σ_xz² + σ_yz²), and ``tension``, σ_zz → its largest value, which is below 0 if the
        interface is nowhere in tension.
    planes : dict
        The same names → grid, and values at the nodes.
    """

    along: tuple[float, float]
    largest: dict[str, Extreme]
    planes: dict[str, tuple[Grid, Array]]


@dataclass(frozen=True, eq=False)
class BodyAnswer:
    """Stress in one body, in SI units.

    Parameters
    ----------
    body : Body
    layer : Solid
        The body as the solver takes it.
    stress : dataset
        As of `analyse_stress`.
    limits : dataset
        `asperity.continuum_limit` of contact pressure and von Mises stress.
    largest : dict
        Field → its extreme value: the largest of ``von_mises``, ``largest_shear`` (Tresca) and
        ``principal_1`` (tension), the smallest of ``principal_3`` and ``hydrostatic`` (compression), and the
        value of largest magnitude of any other field.
    planes : dict
        Field to be drawn → plane of its extreme value at the nodes: depth, grid, values.
    close_ups : sequence of CloseUp
    interface : Interface or None
        None without a coating.
    depth_planes : sequence of (depth, array [y, x])
        Values of the first field to be drawn, at few nodes of few planes.
    """

    body: Body
    layer: Solid
    stress: xr.Dataset
    limits: xr.Dataset
    largest: dict[str, Extreme]
    planes: dict[str, tuple[float, Grid, Array]]
    close_ups: Sequence[CloseUp]
    interface: Interface | None = None
    depth_planes: Sequence[tuple[float, Array]] = ()

    def yield_at(self, depth: Array | float) -> Array:
        """Yield stress of the material at each depth; infinite where none is given."""
        coating, base = self.body.coating, self.body.yield_stress
        in_base = np.full(np.shape(depth), np.inf if base is None else base)
        if coating is None or self.layer.interface is None:
            return in_base
        own = np.inf if coating.yield_stress is None else coating.yield_stress
        return np.where(np.asarray(depth) <= self.layer.interface, own, in_base)

    @property
    def materials(self) -> dict[str, BodyAnswer]:
        """The coating and the base as bodies of their own, with the largest von Mises stress of each.

        Without a coating the body alone.
        """
        coating, interface = self.body.coating, self.layer.interface
        if coating is None or interface is None:
            return {"": self}
        constants = {name: getattr(coating, name) for name in ("young", "poisson", "yield_stress")}
        inside = largest_von_mises_between(self.stress, 0.0, interface)
        below = largest_von_mises_between(self.stress, np.nextafter(interface, np.inf), np.inf)
        return {
            "coating": replace(self, body=Body(**constants), largest=self.largest | {"von_mises": inside}),
            "base": replace(self, largest=self.largest | {"von_mises": below}),
        }

    def grid_error(self, number: str) -> float:
        """Relative error by the grid of a number of `RESOLUTION_ERRORS`; NaN where there is no estimate.

        On surfaces that are not isotropic and Gaussian it is at least the `least_error` of the largest von
        Mises stress.
        """
        if "reason_of_stress" in self.limits.attrs:
            return np.nan
        share, power = RESOLUTION_ERRORS[number][self.limits.attrs["plastic_area"] > 0]
        return max(share * resolution(self.limits) ** power, self.limits.attrs["least_error"])

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


def body_answer(
    loaded: LoadedSolid,
    on_half: LoadedSolid,
    answer: Answer,
    name: str,
    near: Sequence[CloseUp],
    watches: Sequence[Callable[[LinearPlane], None]],
    progress: Progress,
) -> BodyAnswer:
    """Stress in one body under the contact pressure, with its own modulus and Poisson's ratio.

    Parameters
    ----------
    loaded, on_half : LoadedSolid
        The body under the contact, and under the contact on half of the nodes.
    answer : Answer
        With its contact; peaks of the fields of its case are found in addition to the default ones.
    name : "lower" or "upper"
    near : sequence of CloseUp
        Are filled with the fields of the case.
    watches : sequence of callables
        Called with each plane of the stress.
    progress : callable
    """
    case, face, layer = answer.case, answer.face, loaded.layer
    extremes = _Extremes(case.fields, layer)
    planes = DepthPlanes(face.grid, case.fields[0], layer.poisson)

    def observe(plane: LinearPlane) -> None:
        extremes.add(plane)
        planes.add(plane)
        for watch in watches:
            watch(plane)
        for each in near:
            each.add(plane, case.fields, layer.poisson)

    stress = analyse_stress(
        loaded,
        quantities=list(dict.fromkeys((*SOUGHT, *case.fields))),
        tolerance=STRESS_TOLERANCE,
        progress=lambda done, total: progress(0.9 * done, total),
        observe=observe,
        **case.sliding_of(name),
    )
    main = stress.sel(quantity=list(ESTIMATED))
    limits = continuum_on_grids(answer.contact, answer.half, main, name, on_half)
    largest = {}
    for name_of_field, at_nodes in extremes.found.items():
        found = _between_nodes(name_of_field, at_nodes, stress)
        y, x = map(float, face.grid.on_map(found.y, found.x))
        largest[name_of_field] = found._replace(y=y, x=x)
    near = [*near, *_around_extremes(answer, loaded, near, largest, name)]
    progress(1.0, 1.0)
    interface = None
    if extremes.interface:
        (in_coating, on_face), (in_base, _) = extremes.interface
        extreme_of = {}
        for name_of_field, (grid, values) in on_face.items():
            row, column = divmod(int(values.argmax()), grid.shape[1])
            place = np.add(grid.first_node(loaded.grid), np.multiply((row, column), grid.spacing))
            y, x = map(float, face.grid.on_map(*place))
            extreme_of[name_of_field] = Extreme(float(values.max()), float(layer.interface or 0.0), y, x)
        interface = Interface((in_coating, in_base), extreme_of, on_face)
    found_planes = extremes.planes, near, interface, planes.chosen()
    return BodyAnswer(case.bodies[name], layer, stress, limits, largest, *found_planes)


def largest_von_mises_between(stress: xr.Dataset, first: float, last: float) -> Extreme:
    """Largest von Mises stress between two depths, at the nodes or between them; y and x are NaN."""
    planes, found = stress["plane_depth"].values, select_peaks(stress, "von_mises")
    depths = np.append(planes, found["peak_depth"].values)
    values = np.append(stress["largest_von_mises"].values.ravel(), found["peak_value"].values)
    best = np.where((first <= depths) & (depths <= last), values, -1.0).argmax()
    return Extreme(float(values[best]), float(depths[best]), np.nan, np.nan)


def _between_nodes(field: str, found: Extreme, stress: xr.Dataset) -> Extreme:
    """The extreme value at the nodes, or the largest peak between them if that is larger."""
    if field not in stress["quantity"].values:
        return found
    sign = float(DIRECTION.get(field) or np.sign(found.value))
    candidates = select_peaks(stress, field)
    values = sign * candidates["peak_value"].values
    if not values.size or values.max() < sign * found.value:
        return found
    names = ("peak_value", "peak_depth", "peak_y", "peak_x")
    return Extreme(*(float(candidates[name].values[values.argmax()]) for name in names))


class _Extremes:
    """Extreme values of fields from a stream of planes.

    `found` maps a field to its extreme value so far and its place in the cell, `planes` a field to be drawn
    to depth, grid and values of that plane. `interface` holds, for coating and base, σ_xx of the largest
    magnitude on the interface, and `Interface.planes`.
    """

    def __init__(self, drawn: Sequence[str], layer: Solid) -> None:
        self.interface: list[tuple[float, dict[str, tuple[Grid, Array]]]] = []
        self.found: dict[str, Extreme] = {}
        self.planes: dict[str, tuple[float, Grid, Array]] = {}
        self._sizes: dict[str, float] = {}
        self._fields, self._drawn = list(dict.fromkeys((*DIRECTION, *drawn))), drawn
        self._poisson, self._face = layer.poisson, layer.interface or -1.0

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        von_mises, hydrostatic = (plane.field(name, self._poisson) for name in ("von_mises", "hydrostatic"))
        highest, ends = von_mises.max(), {1.0: hydrostatic.max(), -1.0: hydrostatic.min(), 0.0: 0.0}
        if self._face <= plane.depth <= np.nextafter(self._face, np.inf):
            xx, zz, xz, yz = (plane.field(name, self._poisson) for name in ("xx", "zz", "xz", "yz"))
            planes = {"shear": (plane.grid, np.hypot(xz, yz)), "tension": (plane.grid, zz)}
            self.interface.append((float(xx.flat[np.abs(xx).argmax()]), planes))
        for name in self._fields:
            if name in BOUNDS:  # only at nodes where the bound exceeds the extreme value so far
                of_von_mises, of_hydrostatic = BOUNDS[name]
                most = of_von_mises * highest + of_hydrostatic * ends[of_hydrostatic]
                least = self._sizes.get(name, -np.inf) - BOUND_ERROR * abs(most)
                if most < least:
                    continue
                bound = (of_von_mises * von_mises + of_hydrostatic * hydrostatic).ravel()
                if name not in self.found:
                    known = plane.field_at(name, self._poisson, np.array([bound.argmax()]))
                    least = DIRECTION[name] * float(known[0]) - BOUND_ERROR * abs(most)
                nodes = np.flatnonzero(bound >= least)
                values = plane.field_at(name, self._poisson, nodes)
            else:
                field = plane.field(name, self._poisson)
                nodes = np.array([field.argmax(), field.argmin()])
                values = field.flat[nodes]
            sizes = DIRECTION[name] * values if name in DIRECTION else np.abs(values)
            if sizes.size and sizes.max() > self._sizes.get(name, -np.inf):
                best = int(sizes.argmax())
                row, column = divmod(int(nodes[best]), plane.grid.shape[1])
                y, x = np.add(plane.first_node, np.multiply((row, column), plane.grid.spacing)).tolist()
                self._sizes[name] = sizes[best]
                self.found[name] = Extreme(float(values[best]), plane.depth, y, x)
                if name in self._drawn:
                    self.planes[name] = plane.depth, plane.grid, plane.field(name, self._poisson)
