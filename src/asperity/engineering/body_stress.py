"""Stress in one body of a case: peaks, profiles, extreme values, and their discretisation error.

One stream of planes gives all but the error.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import Solid
from asperity.engineering.continuum import HalfGrid, continuum_on_grids
from asperity.engineering.scene import Scene
from asperity.settings.body import Body, OfMaterial
from asperity.stress.analysis import SOUGHT, analyse_stress
from asperity.stress.extremes import DIRECTION, Extreme, Extremes, Interface, largest_of
from asperity.stress.planes.stream import LinearPlane
from asperity.stress.statistics.extrapolation import resolution
from asperity.surface.treatment.treatment import TreatedMap

STRESS_TOLERANCE = 1e-4
"""Tolerance of the planes of the stress in `asperity run` and its answers: the error of a deep plane on a
coarser grid, relative to the rms of σ_zz in it. The default of the library is `PLANE_TOLERANCE`."""

ESTIMATED = ("pressure", "von_mises")
"""Quantities whose peaks are estimated for zero pixel size."""

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
    interfaces : sequence of Interface
        Between the materials, from the surface down.
    observed : mapping
        Name of a question → its observer of the planes.
    """

    body: Body
    layer: Solid
    stress: xr.Dataset
    limits: xr.Dataset
    parts: Sequence[dict[str, Extreme]]
    interfaces: Sequence[Interface] = ()
    observed: Mapping[str, Any] = field(default_factory=dict)

    @property
    def extremes(self) -> dict[str, Extreme]:
        """Field → its extreme value in the whole body."""
        return largest_of(self.parts)

    @property
    def materials(self) -> dict[str, tuple[OfMaterial, dict[str, Extreme]]]:
        """Name of each part of the body → its constants, and the extreme values in it."""
        parts = self.body.parts
        if len(parts) == 1:
            return {"": (self.body, self.extremes)}
        return dict(zip(parts, zip(parts.values(), self.parts, strict=False), strict=False))

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
    extremes = Extremes(layer, case.fields)
    observers: list[Observer] = [extremes, *observed.values()]

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
    values = extremes.values(parts)
    stress["peak_value"].values = _within(
        stress, {field: values[field] for field in DIRECTION if field in values}
    )
    main = stress.sel(quantity=list(ESTIMATED))
    limits = continuum_on_grids(contact, coarse, main, name, on_half, values)
    interfaces = [each.on_map(face.grid) for each in extremes.interfaces]
    return BodyStress(case.bodies[name], layer, stress, limits, parts, interfaces, observed)


def _within(stress: xr.Dataset, extremes: Mapping[str, float]) -> Array:
    """Values of the peaks, none of which is beyond the extreme value of its field: both are interpolated."""
    values, quantities = stress["peak_value"].values.copy(), stress["peak_quantity"].values
    for name, value in extremes.items():
        ends = {1: (-np.inf, value), -1: (value, np.inf)}.get(
            DIRECTION.get(name, 0), (-abs(value), abs(value))
        )
        values[quantities == name] = np.clip(values[quantities == name], *ends)
    return values
