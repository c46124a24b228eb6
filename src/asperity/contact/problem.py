"""The contact problem in units of its own, the imposed quantity, and the result of a method.

A problem is solved in units in which its numbers are near one: lengths in units of the map's edge, heights in
units of the displacement that the load can cause, pressures in units of modulus × height / length. Heights
are measured from a datum near the nodes that touch, and heights that cannot matter are clipped (`reach`), so
that neither the datum nor such heights set a scale or reduce the accuracy of the others.
"""

import math
from dataclasses import dataclass, replace
from threading import Event
from typing import ClassVar

import numpy as np

from asperity.contact.contact_nodes import field_of
from asperity.contact.response import Response
from asperity.core.parallel import in_strips
from asperity.core.types import Array, Progress
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import Solids, TwoBodies
from asperity.fourier.grid import Grid

# A given start is used if its load, its area, or its approach measured from first contact differs from the
# imposed one by less than this fraction: beyond, the coarse grids give a better one.
NEAR_START = 0.3

# Least square of the correlation between the heights and the displacement under a given start.
LEAST_FIT = 0.5


@dataclass(frozen=True)
class Control:
    """The imposed quantity: "contact_area_fraction", "mean_pressure" or "approach", and its value."""

    kind: str
    value: float

    @property
    def fixes_load(self) -> bool:
        """True if the mean pressure of an iterate is known; control by area changes it between iterations."""
        return self.kind != "approach"


@dataclass(frozen=True)
class State:
    """Result of a method.

    Attributes
    ----------
    pressure : (ny, nx) array
        Non-negative.
    approach : float
        Imposed, or of the last evaluation.
    load : float
        Mean pressure, NaN under an imposed approach.
    error : float
        Estimated error of the pressure, relative to its norm.
    iterations : int
        Applications of the compliance, on all grids.
    displacement : (ny, nx) array, optional
        Displacement under the pressure, if the method knows it.
    """

    pressure: Array
    approach: float
    load: float
    error: float = 0.0
    iterations: int = 0
    displacement: Array | None = None


class Problem:
    """A surface and the response of a solid on one grid.

    Parameters
    ----------
    height : (ny, nx) array
    response : Response
    hardness : float
        Maximum pressure, rounded to the precision of the fields.
    plastic : Event, optional
        Set once a pressure has met the hardness, on any grid.

    Attributes
    ----------
    has_whole_grid : bool
        False if the heights belong to some of the grid's nodes.
    """

    has_whole_grid: ClassVar[bool] = True

    def __init__(
        self, height: Array, response: Response, hardness: float = math.inf, plastic: Event | None = None
    ) -> None:
        self.response, self.plastic = response, plastic or Event()
        self.fourier = response.fourier
        self.grid = response.grid
        self.height = np.ascontiguousarray(height, dtype=response.fourier.real)
        self.hardness = float(response.fourier.real.type(hardness))

    @property
    def lowest(self) -> float:
        """The least height."""
        return float(self.height.min())

    @property
    def nodal_compliance(self) -> float:
        """Unit of displacement per pressure, see `Response.nodal_compliance`."""
        return self.response.nodal_compliance

    @property
    def own_compliance(self) -> float:
        """Displacement of a node per unit of its own pressure; the unit where that is 0."""
        return self.response.own_compliance or self.nodal_compliance

    def coarser(self, min_points: int) -> "Problem | None":
        """The same problem on half the nodes of each axis, as of `Response.coarser`; None if none is left."""
        response = self.response.coarser(min_points)
        if response is None:
            return None
        height = self.response.resampled(self.height, response.grid)
        return Problem(height, response, self.hardness, self.plastic)

    def in_single_precision(self) -> "Problem":
        """The same problem in single precision."""
        response = self.response.in_precision("float32")
        return Problem(self.height, response, self.hardness, self.plastic)

    def displacement(self, nodes: Array, values: Array, out: Array | None = None) -> Array:
        """Displacement of the whole grid under pressures on some nodes; `out` is an array for it."""
        field = field_of(self.grid.shape, nodes, values, out)
        return self.response.displacement(field, field)

    def full_contact(self, load: float | None = None) -> State:
        """All nodes touch: every mode but the uniform one has û = −ĥ.

        At the least load, or at a mean pressure, where the pressure may be negative.
        """
        coefficients = self.fourier.forward(self.height)
        mean, compliance = float(coefficients[0, 0].real), self.response.compliance
        np.divide(coefficients, -compliance, out=coefficients, where=compliance > 0)
        coefficients[0, 0] = 0
        pressure = self.fourier.inverse(coefficients, overwrite=True)
        if load is not None:
            approach = mean + load * self.response.uniform_compliance
            return State(pressure + load, approach, load, iterations=1)
        # The last node to touch bears a pressure just above rounding.
        pressure += np.ptp(pressure) * 4 * np.finfo(pressure.dtype).eps - pressure.min()
        return State(pressure, 0.0, float(pressure.mean(dtype=float)))

    def near_start(self, control: Control, initial: Array) -> Array | None:
        """A given pressure without tension, so large that the displaced surface in contact fits the indenter.

        None if its load, area or approach is then far from the imposed one.
        """
        contact = initial > 0
        if not contact.any():
            return None
        pressure = (np.maximum(initial, 0) / initial.max()).astype(self.fourier.real)
        heights = self.height[contact].astype(float)
        displaced = self.response.displacement(pressure)[contact].astype(float)
        variance, lowest = float(np.var(displaced)), self.lowest
        covariance = -float(np.mean(displaced * (heights - heights.mean())))
        if not covariance**2 > LEAST_FIT * variance * float(np.var(heights)):
            return None
        factor = covariance / variance
        now, wanted = {
            "mean_pressure": (factor * float(pressure.mean(dtype=float)), control.value),
            "contact_area_fraction": (heights.size / self.grid.size, control.value),
            "approach": (float(np.mean(heights + factor * displaced)) - lowest, control.value - lowest),
        }[control.kind]
        if not (factor > 0 and abs(now - wanted) < NEAR_START * wanted):
            return None
        return pressure * pressure.dtype.type(factor)


@dataclass(frozen=True)
class Units:
    """Units of a contact problem: powers of two, so that scaling rounds nothing.

    Attributes
    ----------
    length, height, stress : float
        In the units of lengths and of Young's modulus.
    datum : float
        Height from which heights and the approach are measured.
    below, above : float
        Distances below and above the datum beyond which heights are clipped.
    """

    length: float
    height: float
    stress: float
    datum: float = 0.0
    below: float = math.inf
    above: float = math.inf

    @classmethod
    def of_solid(cls, solid: Solids, grid: Grid) -> "Units":
        """Units of the longer edge and of the modulus."""
        length = _power_of_two(max(grid.length))
        return cls(length, length, _power_of_two(solid.effective_modulus))

    def for_problem(self, height: Array, control: Control, hardness: float, response: Response) -> "Units":
        """Units for an imposed quantity, given a response in the units of the solid."""
        lowest, highest = float(height.min()), float(height.max())
        datum, below, above = reach(height, lowest, control, hardness / self.stress, response, self)
        if lowest >= datum - below and highest <= datum + above:
            below = above = math.inf
        if control.kind == "mean_pressure":
            depth = control.value / self.stress * self.length
        else:
            depth = (control.value if control.kind == "approach" else highest) - lowest
        height_unit = _power_of_two(depth) if depth > 0 else self.length
        stress = self.stress * (height_unit / self.length)
        return Units(self.length, height_unit, stress, datum, below, above)

    def for_adhesion(self, height: Array, attraction_range: float) -> "Units":
        """Units for faces that attract each other: no height is clipped."""
        unit, lowest = _power_of_two(max(float(np.ptp(height)), attraction_range)), float(height.min())
        return Units(self.length, unit, self.stress * (unit / self.length), lowest)

    def grid(self, grid: Grid) -> Grid:
        return replace(grid, length=(grid.length[0] / self.length, grid.length[1] / self.length))

    def solid(self, solid: Solids) -> Solids:
        """The solid in these units: the ratio of a stress to a slope is its modulus."""
        if isinstance(solid, TwoBodies):
            return TwoBodies(self._layer(solid.lower), self._layer(solid.upper))
        return self._layer(solid)

    def _layer(self, layer: Solid) -> Solid:
        height = None if layer.height is None else layer.height / self.length
        young = layer.young / self.stress * (self.height / self.length)
        base = None if layer.base is None else self._layer(layer.base)
        return replace(layer, young=young, height=height, base=base)

    def heights(self, height: Array) -> Array:
        """Heights above the datum, clipped."""
        out = np.empty(height.shape)

        def write(rows: slice) -> None:
            np.subtract(height[rows], self.datum, out=out[rows])
            if min(self.below, self.above) < math.inf:
                np.clip(out[rows], -self.below, self.above, out=out[rows])
            out[rows] *= 1 / self.height

        in_strips(write, height.shape, 1)
        return out

    def clipped_by(self, height: Array) -> Array | None:
        """Part of each height that is clipped, in the unit of the caller; None if heights are not clipped."""
        if self.below == self.above == math.inf:
            return None
        above = height - self.datum
        return above - np.clip(above, -self.below, self.above)

    def control(self, control: Control) -> Control:
        if control.kind == "mean_pressure":
            return replace(control, value=control.value / self.stress)
        if control.kind == "approach":
            return replace(control, value=(control.value - self.datum) / self.height)
        return control


def reach(
    height: Array, lowest: float, control: Control, hardness: float, response: Response, units: Units
) -> tuple[float, float, float]:
    """Datum, and the distances below and above it beyond which every node, or none, touches.

    A node is displaced by at most the whole load times the largest displacement of a node per unit of a force
    on it alone: the compliance is positive semidefinite, so that no element exceeds the largest one on its
    diagonal. At a given load the approach then lies within that bound of the height of a certain node: the
    lowest one, or under a hardness the highest of the lowest nodes that together can bear the load. At a
    given approach the energy bounds it. Proofs: ``paper/supplement/method.md``. Under an imposed
    area no bound is known.

    Parameters
    ----------
    height : (ny, nx) array
        In the unit of the caller, as the control.
    lowest : float
        The least of them.
    control : Control
    hardness : float
        In units of the solid's modulus.
    response : Response
        In units of the solid.
    units : Units
        Units of the solid.

    Returns
    -------
    datum, below, above : float
        In the unit of the heights; infinite where nothing is clipped.
    """
    nodes, below = height.size, math.inf
    if control.kind == "contact_area_fraction" or (control.kind == "approach" and control.value <= lowest):
        return lowest, math.inf, math.inf
    if control.kind == "mean_pressure":
        load, datum = control.value / units.stress * nodes, lowest
        # Twice the bound: a clipped node keeps a gap.
        above = 4 * load * response.largest_own_compliance * units.length
        if (full := math.ceil(load / hardness) - 1 if hardness < math.inf else 0) > 0:
            first = float(np.partition(height, full, axis=None)[full])
            if first - lowest > above:
                return first, above, above
            return lowest, math.inf, above + (first - lowest)
    else:
        datum = control.value
        if response.repeats:
            above = _largest_displacement(height, datum, response)
        else:
            # Without surroundings all displacements are downward: higher nodes than the approach never touch.
            above = datum - lowest if all(response.free) else math.inf
        above = 2 * min(above, nodes * hardness * response.largest_own_compliance * units.length)
        below = above if hardness < math.inf and response.repeats else math.inf
    return datum, below, above


def _largest_displacement(height: Array, approach: float, response: Response) -> float:
    """Bound of the displacement of any node at a given approach, from the energy; infinite if none is known.

    On a solid with a uniform displacement the mean pressure does at most the work of lowering the whole
    surface. On another one the surface that is lowered where it overlaps the indenter, and raised by the same
    volume where it has room, has an energy that the true one does not exceed.
    """
    depth = approach - float(height.min())
    if response.uniform_compliance > 0:
        energy = response.grid.size / response.uniform_compliance
    else:
        overlapping = float(np.count_nonzero(height < approach)) / height.size
        room = float(np.count_nonzero(height >= approach + 2 * overlapping * depth)) / height.size
        modes = response.half_compliance
        softest = float(modes.min(where=modes > 0, initial=math.inf))
        if room < 0.5 or not softest < math.inf:
            return math.inf
        energy = height.size * overlapping * (1 + 2 * overlapping) / softest
    return depth * math.sqrt(response.largest_own_compliance * energy)


class ConvergenceProgress:
    """Reports the decrease of an error to its tolerance as progress, on a logarithmic scale.

    The progress never decreases, although the error may grow.
    """

    def __init__(self, progress: Progress | None, tolerance: float) -> None:
        self._progress = progress
        self._tolerance = tolerance
        self._largest = 0.0
        self._smallest = math.inf

    def __call__(self, error: float) -> None:
        """Report an error."""
        if self._progress is None or not 0 < error < math.inf:
            return
        self._largest = max(self._largest, error, 2 * self._tolerance)
        self._smallest = max(min(self._smallest, error), self._tolerance)
        total = math.log(self._largest / self._tolerance)
        self._progress(math.log(self._largest / self._smallest), total)


def _power_of_two(value: float) -> float:
    """The power of two at or below a positive number."""
    return math.ldexp(0.5, math.frexp(value)[1])
