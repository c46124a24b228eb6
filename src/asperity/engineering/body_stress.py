"""Stress in one body of a case: peaks, profiles, extreme values, and their discretisation error.

One stream of planes gives all but the error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import Solid
from asperity.engineering.continuum import HalfGrid, continuum_on_grids
from asperity.engineering.scene import Scene
from asperity.fourier.grid import Grid
from asperity.settings.body import Body
from asperity.stress.analysis import SOUGHT, analyse_stress
from asperity.stress.peaks.selection import select_peaks
from asperity.stress.planes.stream import LinearPlane
from asperity.stress.statistics.extrapolation import resolution
from asperity.surface.treatment.treatment import TreatedMap

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


class Observer(Protocol):
    """Takes each plane of the stress in a body, from the surface downward."""

    def add(self, plane: LinearPlane) -> None:
        """Take the next plane."""


@dataclass(frozen=True, eq=False)
class Interface:
    """Stress on the interface of a coating.

    Parameters
    ----------
    along : (float, float)
        σ_xx of the largest magnitude, in the coating and in the base.
    extremes : dict
        ``shear``, √(σ_xz² + σ_yz²), and ``tension``, σ_zz → its maximum, which is below 0 if the interface
        is nowhere in tension.
    """

    along: tuple[float, float]
    extremes: dict[str, Extreme]


@dataclass(frozen=True, eq=False)
class BodyStress:
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
    extremes : dict
        Field → its extreme value: the maximum of ``von_mises``, ``largest_shear`` (Tresca) and
        ``principal_1`` (tension), the minimum of ``principal_3`` and ``hydrostatic`` (compression), and the
        value of largest magnitude of any other field.
    interface : Interface or None
        None without a coating.
    observed : mapping
        Name of a question → its observer of the planes.
    """

    body: Body
    layer: Solid
    stress: xr.Dataset
    limits: xr.Dataset
    extremes: dict[str, Extreme]
    interface: Interface | None = None
    observed: Mapping[str, Any] = field(default_factory=dict)

    @property
    def materials(self) -> dict[str, BodyStress]:
        """The coating and the base as bodies of their own, with the maximum von Mises stress of each.

        Without a coating the body alone.
        """
        coating, interface = self.body.coating, self.layer.interface
        if coating is None or interface is None:
            return {"": self}
        constants = {name: getattr(coating, name) for name in ("young", "poisson", "yield_stress")}
        inside = largest_von_mises_between(self.stress, 0.0, interface)
        below = largest_von_mises_between(self.stress, np.nextafter(interface, np.inf), np.inf)
        return {
            "coating": replace(self, body=Body(**constants), extremes=self.extremes | {"von_mises": inside}),
            "base": replace(self, extremes=self.extremes | {"von_mises": below}),
        }

    def grid_error(self, number: str) -> float:
        """Relative discretisation error of a number of `RESOLUTION_ERRORS`; NaN where it is not known.

        On surfaces that are not isotropic and Gaussian it is at least the `least_error` of the largest von
        Mises stress.
        """
        if "reason_of_stress" in self.limits.attrs:
            return np.nan
        share, power = RESOLUTION_ERRORS[number][self.limits.attrs["plastic_area"] > 0]
        return max(share * resolution(self.limits) ** power, self.limits.attrs["least_error"])

    @property
    def von_mises(self) -> Extreme:
        """The maximum von Mises stress."""
        return self.extremes["von_mises"]


def body_stress(
    case: Scene,
    face: TreatedMap,
    contact: Contact,
    coarse: HalfGrid,
    name: str,
    loaded: tuple[LoadedSolid, LoadedSolid],
    observed: Mapping[str, Observer],
    progress: Progress,
) -> BodyStress:
    """Stress in one body under the contact pressure, with its own modulus and Poisson's ratio.

    Parameters
    ----------
    case : Scene
        Peaks of its fields are found in addition to the default ones.
    face : TreatedMap
    contact : Contact
    coarse : HalfGrid
    name : "lower" or "upper"
    loaded : (LoadedSolid, LoadedSolid)
        The body under the contact, and under the contact on half of the nodes.
    observed : mapping
        Name of a question → observer of each plane of the stress.
    progress : callable
    """
    on_nodes, on_half = loaded
    layer = on_nodes.layer
    extremes = _Extremes(case.fields, layer)

    def observe(plane: LinearPlane) -> None:
        extremes.add(plane)
        for each in observed.values():
            each.add(plane)

    stress = analyse_stress(
        on_nodes,
        quantities=list(dict.fromkeys((*SOUGHT, *case.fields))),
        tolerance=STRESS_TOLERANCE,
        progress=progress,
        observe=observe,
        **case.sliding_of(name),
    )
    main = stress.sel(quantity=list(ESTIMATED))
    limits = continuum_on_grids(contact, coarse, main, name, on_half)
    found = {}
    for name_of_field, at_nodes in extremes.found.items():
        extreme = _between_nodes(name_of_field, at_nodes, stress)
        y, x = map(float, face.grid.on_map(extreme.y, extreme.x))
        found[name_of_field] = extreme._replace(y=y, x=x)
    interface = None
    if extremes.interface:
        (in_coating, on_face), (in_base, _) = extremes.interface
        extreme_of = {}
        for name_of_field, (grid, values) in on_face.items():
            row, column = divmod(int(values.argmax()), grid.shape[1])
            place = np.add(grid.first_node(on_nodes.grid), np.multiply((row, column), grid.spacing))
            y, x = map(float, face.grid.on_map(*place))
            extreme_of[name_of_field] = Extreme(float(values.max()), float(layer.interface or 0.0), y, x)
        interface = Interface((in_coating, in_base), extreme_of)
    return BodyStress(case.bodies[name], layer, stress, limits, found, interface, observed)


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

    `found` maps a field to its extreme value so far and its place in the cell. `interface` holds, for
    coating and base, σ_xx of the largest magnitude on the interface, and shear and tension there.
    """

    def __init__(self, drawn: Sequence[str], layer: Solid) -> None:
        self.interface: list[tuple[float, dict[str, tuple[Grid, Array]]]] = []
        self.found: dict[str, Extreme] = {}
        self._sizes: dict[str, float] = {}
        self._fields = list(dict.fromkeys((*DIRECTION, *drawn)))
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
