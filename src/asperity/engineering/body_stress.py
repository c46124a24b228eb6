"""Stress in one body of a case: peaks, profiles, extreme values, and their discretisation error.

One stream of planes gives all but the error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import Solid
from asperity.engineering.continuum import HalfGrid, continuum_on_grids
from asperity.engineering.scene import Scene
from asperity.settings.body import Body
from asperity.stress.analysis import SOUGHT, analyse_stress
from asperity.stress.extremes import DIRECTION, Extreme, Extremes, largest_of
from asperity.stress.planes.stream import LinearPlane
from asperity.stress.statistics.extrapolation import resolution
from asperity.surface.treatment.treatment import TreatedMap

STRESS_TOLERANCE = 1e-4
"""Tolerance of the planes of the stress in `asperity run` and its answers: the error of a deep plane on a
coarser grid, relative to the rms of σ_zz in it. The default of the library is `PLANE_TOLERANCE`."""

ESTIMATED = ("pressure", "von_mises")
"""Quantities whose peaks are estimated for vanishing pixels."""

CYCLE_ERRORS = {
    "shear_range": ((2.9, 1.5), (0.45, 0.25)),
    "dang_van": ((1.4, 1.5), (0.55, 0.25)),
    "shakedown_lower": ((1.0, 1.5), (0.28, 0.25)),
    "shakedown_upper": ((1.0, 1.5), (0.2, 0.25)),
}
"""Number of stress cycles → factor a and power b of its relative discretisation error a·c^b, of an elastic
contact and of one whose pressure reaches the hardness; c is the relative correction of the contact area over
the fraction of the area out of contact. Nine in ten errors of 120 surfaces are smaller
(`benchmarks/answers.py`)."""


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
    parts : sequence of dict
        Field → its extreme value, in each material from the surface down: the maximum of ``von_mises``,
        ``maximum_shear`` (Tresca) and ``principal_1`` (tension), the minimum of ``principal_3`` and
        ``hydrostatic`` (compression), and the value of largest magnitude of any other field.
    interface : Interface or None
        None without a coating.
    observed : mapping
        Name of a question → its observer of the planes.
    """

    body: Body
    layer: Solid
    stress: xr.Dataset
    limits: xr.Dataset
    parts: Sequence[dict[str, Extreme]]
    interface: Interface | None = None
    observed: Mapping[str, Any] = field(default_factory=dict)

    @property
    def extremes(self) -> dict[str, Extreme]:
        """Field → its extreme value in the whole body."""
        return largest_of(self.parts)

    @property
    def materials(self) -> dict[str, BodyStress]:
        """The coating and the base as bodies of their own; without a coating the body alone."""
        coating = self.body.coating
        if coating is None or len(self.parts) < 2:
            return {"": self}
        constants = {name: getattr(coating, name) for name in ("young", "poisson", "yield_stress")}
        return {
            "coating": replace(self, body=Body(**constants), parts=self.parts[:1]),
            "base": replace(self, parts=self.parts[1:]),
        }

    def cycle_error(self, number: str) -> float:
        """Relative discretisation error of a number of `CYCLE_ERRORS`; NaN where it is not known.

        On surfaces that are not isotropic and Gaussian it is at least the `least_error` of the maximum von
        Mises stress.
        """
        if "reason_of_stress" in self.limits.attrs:
            return np.nan
        share, power = CYCLE_ERRORS[number][self.limits.attrs["plastic_area"] > 0]
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
    layer, sliding = on_nodes.layer, case.sliding_of(name)
    extremes, interface = Extremes(layer, case.fields), _AtInterface(face, on_nodes)
    observers: list[Observer] = [extremes, interface, *observed.values()]

    def observe(plane: LinearPlane) -> None:
        for each in observers:
            each.add(plane)

    stress = analyse_stress(
        on_nodes,
        quantities=list(dict.fromkeys((*SOUGHT, *case.fields))),
        tolerance=STRESS_TOLERANCE,
        progress=progress,
        observe=observe,
        **sliding,
    )
    parts = extremes.refined(on_nodes, STRESS_TOLERANCE, **sliding)
    values = {field: each.value for field, each in largest_of(parts).items()}
    stress["peak_value"].values = _within(stress, values)
    main = stress.sel(quantity=list(ESTIMATED))
    limits = continuum_on_grids(contact, coarse, main, name, on_half, values)
    return BodyStress(case.bodies[name], layer, stress, limits, parts, interface.found, observed)


def _within(stress: xr.Dataset, extremes: Mapping[str, float]) -> Array:
    """Values of the peaks, none of which is beyond the extreme value of its field: both are interpolated."""
    values, quantities = stress["peak_value"].values.copy(), stress["peak_quantity"].values
    for name, value in extremes.items():
        ends = {1: (-np.inf, value), -1: (value, np.inf)}.get(
            DIRECTION.get(name, 0), (-abs(value), abs(value))
        )
        values[quantities == name] = np.clip(values[quantities == name], *ends)
    return values


class _AtInterface:
    """Takes the planes of a stress on both sides of the interface of a coating."""

    def __init__(self, face: TreatedMap, loaded: LoadedSolid) -> None:
        self._face, self._grid, self._poisson = face, loaded.grid, loaded.layer.poisson
        self._depth, self._along = loaded.layer.interface or -1.0, list[float]()
        self._extremes: dict[str, Extreme] = {}

    def add(self, plane: LinearPlane) -> None:
        """Take the next plane."""
        if not self._depth <= plane.depth <= np.nextafter(self._depth, np.inf):
            return
        xx, zz, xz, yz = (plane.field(name, self._poisson) for name in ("xx", "zz", "xz", "yz"))
        self._along.append(float(xx.flat[np.abs(xx).argmax()]))
        for name, values in {"shear": np.hypot(xz, yz), "tension": zz}.items():
            row, column = divmod(int(values.argmax()), plane.grid.shape[1])
            place = np.add(plane.grid.first_node(self._grid), np.multiply((row, column), plane.grid.spacing))
            y, x = map(float, self._face.grid.on_map(*place))
            self._extremes.setdefault(name, Extreme(float(values.max()), self._depth, y, x))

    @property
    def found(self) -> Interface | None:
        """The stress on the interface; None without one."""
        return Interface((self._along[0], self._along[1]), self._extremes) if self._along else None
