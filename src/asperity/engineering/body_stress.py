"""Stress in one body of a case: peaks and profiles, extreme values of its fields, and what is above yield.

All come from one stream of planes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.engineering.case import Case
from asperity.engineering.close_up import CloseUp
from asperity.fourier.grid import Grid
from asperity.stress.analysis import analyse_stress
from asperity.stress.planes.planes import depth_grid
from asperity.stress.planes.stream import LinearPlane

STRESS_TOLERANCE = 1e-4
"""Error of a deep plane on a coarser grid, relative to the rms of σ_zz in it."""

DEPTH_SPACING, DEPTH_GROWTH = 0.5, 0.125
"""Distance of the planes near the surface in grid spacings, and farther down over their depth."""

QUANTITIES = ("pressure", "von_mises", "xx", "zz", "xz")
"""Quantities whose peaks are always found."""

DIRECTION = {"von_mises": 1, "largest_shear": 1, "principal_1": 1, "principal_3": -1, "hydrostatic": -1}
"""Field → 1 if its largest value is sought, −1 if its smallest is; of others the largest magnitude."""


BOUNDS = {"largest_shear": (3**-0.5, 0.0), "principal_1": (2 / 3, 1.0), "principal_3": (2 / 3, -1.0)}
"""Field → factors of the von Mises and the hydrostatic stress in an upper bound of it, or of its negative.

Principal stresses are computed only where the bound exceeds the extreme value so far: `run` takes a quarter
of the time at 512²."""

ROUNDING = 1e-5
"""Uncertainty of these bounds by rounding in single precision, relative to the highest of a plane."""


class Extreme(NamedTuple):
    """Extreme value of a field of the stress in Pa, and its place in m."""

    value: float
    depth: float
    y: float
    x: float


class StressInBody(NamedTuple):
    """Stress in one body.

    Parameters
    ----------
    dataset : dataset
        As of `analyse_stress`, in Pa and m.
    extremes : dict
        Field → extreme value at the nodes and its place in the cell, for those of `DIRECTION` and the fields
        that were asked for.
    above_yield : (planes,) array or None
        Share of each plane whose von Mises stress is above yield; None without a yield stress.
    planes : dict
        Field to be drawn → plane of its extreme value at the nodes: depth, grid, values.
    close_ups : sequence of CloseUp
    """

    dataset: xr.Dataset
    extremes: dict[str, Extreme]
    above_yield: Array | None
    planes: dict[str, tuple[float, Grid, Array]]
    close_ups: Sequence[CloseUp]


def stress_in(
    contact: Contact,
    case: Case,
    name: str,
    near: Sequence[CloseUp] = (),
    progress: Progress | None = None,
) -> StressInBody:
    """Stress in one body under the contact pressure, with its own modulus and Poisson's ratio, in Pa.

    Parameters
    ----------
    contact : Contact
    case : Case
        The peaks of its fields are found beside those of `QUANTITIES`.
    name : "lower" or "upper"
    near : sequence of CloseUp, optional
        Take the fields of the case.
    progress : callable, optional
    """
    body = case.bodies[name]
    watch = _Extremes(case.fields, body.poisson, body.yield_stress)

    def observe(plane: LinearPlane) -> None:
        watch.add(plane)
        for each in near:
            each.add(plane, case.fields, body.poisson, contact.boundary == "periodic")

    dataset = analyse_stress(
        contact.in_body(name),
        depth_grid(contact.grid, body.height, DEPTH_SPACING, DEPTH_GROWTH),
        quantities=list(dict.fromkeys((*QUANTITIES, *case.fields))),
        tolerance=STRESS_TOLERANCE,
        progress=progress,
        observe=observe,
        **case.sliding_of(name),
    )
    above = None if body.yield_stress is None else np.array(watch.above)
    return StressInBody(dataset, watch.found, above, watch.planes, near)


class _Extremes:
    """Extreme values of fields, and the share of each plane above a limit, from a stream of planes.

    Attributes
    ----------
    found : dict
        Field → its extreme value so far, and its place in the cell.
    planes : dict
        Field to be drawn → depth, grid and values of the plane of its extreme value so far.
    above : list of float
        Share of each plane whose von Mises stress is above the limit.
    """

    def __init__(self, drawn: Sequence[str], poisson: float, limit: float | None) -> None:
        self.found: dict[str, Extreme] = {}
        self.planes: dict[str, tuple[float, Grid, Array]] = {}
        self.above: list[float] = []
        self._fields, self._drawn = list(dict.fromkeys((*DIRECTION, *drawn))), drawn
        self._poisson, self._limit = poisson, limit

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        invariants = {name: plane.field(name, self._poisson) for name in ("von_mises", "hydrostatic")}
        if self._limit is not None:
            self.above.append(float(np.mean(invariants["von_mises"] > self._limit)))
        for name in self._fields:
            if name in BOUNDS:
                nodes = self._candidates(name, invariants, plane)
                values = plane.field_at(name, self._poisson, nodes)
            else:
                field = invariants[name] if name in invariants else plane.field(name, self._poisson)
                nodes = np.array([field.argmax(), field.argmin()])
                values = field.ravel()[nodes]
            self._take(name, values, nodes, plane)

    def _candidates(self, name: str, invariants: Mapping[str, Array], plane: LinearPlane) -> Array:
        """Nodes at which the upper bound of a field exceeds its extreme value so far."""
        of_von_mises, of_hydrostatic = BOUNDS[name]
        bound = of_von_mises * invariants["von_mises"] + of_hydrostatic * invariants["hydrostatic"]
        bound = bound.ravel()
        highest = bound.argmax()
        if name in self.found:
            known = self.found[name].value
        else:
            known = float(plane.field_at(name, self._poisson, np.array([highest]))[0])
        return np.flatnonzero(bound >= DIRECTION[name] * known - ROUNDING * abs(float(bound[highest])))

    def _take(self, name: str, values: Array, nodes: Array, plane: LinearPlane) -> None:
        """Take the most extreme of some values if it is more extreme than the one so far."""
        if not nodes.size:
            return
        sizes = _size(name, values)
        best = int(sizes.argmax())
        if name not in self.found or sizes[best] > _size(name, np.array(self.found[name].value)):
            row, column = divmod(int(nodes[best]), plane.grid.shape[1])
            y, x = row * plane.grid.spacing[0], column * plane.grid.spacing[1]
            self.found[name] = Extreme(float(values[best]), plane.depth, y, x)
            if name in self._drawn:
                self.planes[name] = plane.depth, plane.grid, plane.field(name, self._poisson).copy()


def _size(name: str, values: Array) -> Array:
    """What is largest for the extreme value of a field."""
    return DIRECTION[name] * values if name in DIRECTION else np.abs(values)
