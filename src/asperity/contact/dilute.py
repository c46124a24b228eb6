"""Contacts that touch little: the displacement of candidate nodes, without transforms of the whole grid.

The convolution with the compliance G is divided as in particle-mesh Ewald sums (Essmann et al. 1995,
10.1063/1.470117): with the distance r, the length 1/α and the half-space's kernel 1/(π E* r),

    near = erfc(α r) / (π E* r)      in Fourier space      2 erf(q/2α) / (E* q),

falls off like a Gaussian, and the rest of G has no short waves. The near part is a stencil of radius 15. The
far part is a convolution on a grid of four or eight times the spacing, to which pressures are distributed by
cubic B-splines, and from which displacements are interpolated by the same splines; its factors make the mean
square of the error least (Hockney & Eastwood 1988, 10.1201/9780367806934, chapter 8).

The division is used three times, with a stencil and a coarse grid as fine as each use needs: to a per cent in
inner solves; to about 1e-3 on the candidates, where only the change of the pressure since the last evaluation
of the whole grid has this error (`CandidateProblem`); and over a free boundary to a fraction of the tolerance
for this evaluation (`DividedProblem`), which otherwise takes transforms of four times the nodes. Where single
precision suffices for it, candidates have the same division, and the whole grid is evaluated once.
"""

import math
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import scipy  # whose transforms are loaded when they are first used

from asperity.contact.contact_nodes import WIDE_RADIUS, WIDER_RADIUS, StencilProduct, inserted, whole_stencil
from asperity.contact.iterate import ContactSystem, Iterate, Pressure, Step
from asperity.contact.operators import MAX_SPACING_RATIO, InnerResponse
from asperity.contact.problem import Problem
from asperity.contact.response import Response
from asperity.core.compiled import compiled, vectorised_sums
from asperity.core.parallel import in_parts
from asperity.core.sizes import good_size
from asperity.core.types import Array
from asperity.elasticity.loaded_rectangle import rectangle_compliance, surface_influence
from asperity.fourier.grid import Fourier, Grid

# A contact is dilute if at most this fraction of the coarser grid's nodes touch, and nodes that may touch are
# at most so many times as many. Above, the transforms of the whole grid take less time.
MAX_AREA, MAX_CANDIDATES = 0.015, 4.0

# Nodes outside the contact may touch if their gap on the coarser grid is at most this times the gap that the
# mean pressure of the contact closes at a node that alone is in contact.
FIRST_MARGIN = 1.0

# Fewest nodes on an axis of the grid that is transformed, of twice the nodes over a free boundary: contacts
# of 1 % on 512² nodes that repeat take 1.1 to 1.6 times as long on candidates. Coarse grids, which are solved
# less accurately, take the same time with candidates from 512² nodes, and fewer transforms.
MIN_POINTS, MIN_COARSE_POINTS = 1024, 512

# Of waves shorter than the far field's grid holds, the compliance differs by at most this fraction from a
# half-space's with the modulus of the surface.
MAX_DEVIATION = 1e-3


@dataclass(frozen=True)
class Division:
    """Division of a compliance into a near and a far field.

    Attributes
    ----------
    error : float
        Largest error of a displacement, over the displacement of a node under the maximum pressure.
    radius_times_alpha : float
        The stencil ends where α × distance is this number.
    spacing_times_alpha : float
        α × spacing of the far field's grid.
    radius : int
        Radius of the stencil, in nodes.
    order : int
        Nodes along an axis to which a B-spline distributes a pressure.
    real : type
        Precision of the displacements.
    """

    error: float
    radius_times_alpha: float
    spacing_times_alpha: float
    radius: int = WIDE_RADIUS
    order: int = 4
    real: type = np.float32

    def alpha(self, grid: Grid) -> float:
        """α for the nodes of a grid."""
        return self.radius_times_alpha / (self.radius * min(grid.spacing))

    def far_grid(self, response: Response) -> Grid:
        """Grid of the far field, longer by the splines where the map ends."""
        grid, step = response.grid, self.spacing_times_alpha / self.alpha(response.grid)
        ny, nx = (
            math.ceil(edge / step) + self.order if ends else good_size(math.ceil(edge / step))
            for edge, ends in zip(grid.length, response.free, strict=True)
        )
        y, x = (
            nodes * step if ends else edge
            for nodes, edge, ends in zip((ny, nx), grid.length, response.free, strict=True)
        )
        return Grid((ny, nx), (y, x), grid.mirrored)


# For inner solves, in half the time of the next one.
INNER_DIVISION = Division(1e-2, 2.2, 1.2)

# Displacements under the pressure of a rough surface are right to 6e-4, and under random pressures to 1e-3.
DIVISION = Division(1e-3, 2.3, 0.6)

# For the whole grid over a free boundary. The stencil of a map that repeats has a tail, as its waves end at
# the shortest of the grid: radius and order do not make it more accurate than 3e-6 there.
DIVISIONS = (
    DIVISION,
    Division(1e-5, 3.0, 0.5, WIDER_RADIUS, 8),
    Division(1e-7, 3.9, 0.4, 39, 12, np.float64),
)

# Largest error of a division, over the tolerance of the pressure.
LARGEST_SHARE = 0.1


class SplitResponse:
    """Displacement of some nodes under pressures on others, in units of `Response.nodal_compliance`.

    Parameters
    ----------
    response : Response
    division : Division
    """

    def __init__(self, response: Response, division: Division) -> None:
        grid, threads = response.grid, response.fourier.threads
        alpha, unit = division.alpha(grid), 1 / response.nodal_compliance
        self.division, self._threads = division, threads
        self._near = unit * _near_field(response, alpha, division.radius)
        self._products = StencilProduct(grid, response.free, threads, division.radius)
        self._stencil = whole_stencil(self._near)
        far = response.on_grid(division.far_grid(response))
        factors = unit * _far_field(response, far, alpha, division.order)
        self._far = far.in_precision(division.real)
        self._far.half_compliance = factors.astype(division.real)
        of_rows, of_columns = (
            _splines(grid, far.grid, axis, ends, division) for axis, ends in enumerate(response.free)
        )
        self._splines = *of_rows, *of_columns, grid.shape[1]
        self._field: Array = np.empty(far.grid.shape, division.real)

    def displacement(self, pressure: Array, nodes: Array, at: Array) -> Array:
        """Displacements of nodes under pressures on others.

        Parameters
        ----------
        pressure : (count,) array
        nodes, at : (count,) arrays of unsigned integers
            Sorted indices in the flattened map, of the nodes that bear pressure and of the displaced nodes.
        """
        far_field = partial(self._convolve, nodes, pressure)
        out = self._products(self._stencil, nodes, pressure, at, meanwhile=far_field)
        in_parts(
            lambda part: _add_interpolant(at[part], *self._splines, self._field, out[part]),
            out.size,
            self._threads,
        )
        return out

    def write(self, nodes: Array, pressure: Array, unit: float, out: Array) -> None:
        """Write the displacements, times a unit, of all nodes of a map that nothing surrounds."""
        self._convolve(nodes, pressure)
        row, of_row, column, of_column, columns = self._splines
        lines = np.empty((len(self._field), columns), self._field.dtype)
        first = np.searchsorted(nodes, np.arange(len(out) + 1) * columns)

        def interpolate(part: slice) -> None:
            _interpolate_along_x(self._field[part], column, of_column, lines[part])

        def write(part: slice) -> None:
            _interpolate_along_y(lines, row[part], unit * of_row[part], out[part])
            _add_near_field(nodes, unit * pressure, first, self._near, part.start, out[part])

        in_parts(interpolate, len(lines), self._threads, smallest=16)
        in_parts(write, len(out), self._threads, smallest=16)

    def _convolve(self, nodes: Array, pressure: Array) -> None:
        """Write the far field on its grid."""
        _distribute(nodes, pressure, *self._splines, self._field)
        self._far.displacement(self._field, self._field)


class CandidateResponse(InnerResponse):
    """A split response for the indices of candidates."""

    def __init__(self, candidates: Array, split: SplitResponse) -> None:
        self.candidates, self.split = candidates, split

    def in_map(self, nodes: Array) -> Array:
        """Indices of nodes in the flattened map."""
        return self.candidates[nodes]

    indices = in_map

    def displacement(self, pressure: Array, nodes: Array, indices: Any, at: Array | None = None) -> Array:
        """Displacements under pressures on nodes, at these nodes or at others."""
        return self.split.displacement(pressure, indices, indices if at is None else self.in_map(at))


class CandidateProblem(Problem):
    """The contact problem of candidate nodes, near an iterate of the whole grid.

    All indices are indices of candidates: nodes that touch, and nodes that may.

    Parameters
    ----------
    problem : Problem
        Of the whole grid.
    candidates : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    split : SplitResponse
        Of the whole grid.
    iterate : Iterate, optional
        Of the whole grid; without it displacements are not corrected.
    """

    has_whole_grid = False

    def __init__(
        self, problem: Problem, candidates: Array, split: SplitResponse, iterate: Iterate | None = None
    ) -> None:
        heights = problem.height.reshape(-1)[candidates]
        super().__init__(heights, problem.response, problem.hardness, problem.plastic)
        self.candidates, self._split = candidates, split
        self._pressure, self._displacement = np.zeros_like(heights), np.zeros_like(heights)
        if iterate is not None:
            self._displacement = iterate.displacement.reshape(-1)[candidates]
            self._pressure[np.searchsorted(candidates, iterate.nodes)] = iterate.pressure

    def displacement(self, nodes: Array, values: Array, out: Array | None = None) -> Array:
        """Displacement of all candidates: the iterate's, plus the effect of the change of the pressure."""
        change = -self._pressure
        change[nodes] += values
        if np.abs(change).max() <= 4 * np.finfo(change.dtype).eps * self._pressure.max():
            return self._displacement.copy()
        caused = self._split.displacement(change.astype(np.float32), self.candidates, self.candidates)
        return self._displacement + self.nodal_compliance * caused

    def step_to(self, found: Pressure, approach: float) -> Step:
        """The step of the whole grid to a pressure of the candidates."""
        change = -self._pressure
        change[found.nodes] += found.values
        some = np.flatnonzero((self._pressure > 0) | (change > 0))  # released nodes, too
        before, level = self._pressure[some], self.height[some] + self._displacement[some]
        return Step(self.candidates[some], before, level, change[some], before == 0, approach)


class DividedProblem(Problem):
    """The contact problem of the whole grid, with displacements by a division of the compliance."""

    def __init__(self, problem: Problem, split: SplitResponse) -> None:
        super().__init__(problem.height, problem.response, problem.hardness, problem.plastic)
        self._split = split

    def displacement(self, nodes: Array, values: Array, out: Array | None = None) -> Array:
        """Displacement of the whole grid under pressures on some nodes; `out` is an array for it."""
        out = np.empty_like(self.height) if out is None else out
        self._split.write(nodes, values, self.nodal_compliance, out)
        return out


def divided(problem: Problem, tolerance: float) -> tuple[Problem, SplitResponse]:
    """The problem with displacements by the coarsest division that suffices for a tolerance of the pressure.

    The problem itself if none does. And the division for its candidates: the same one in single precision, so
    that one displacement of the whole grid suffices, otherwise `DIVISION`.
    """
    for division in DIVISIONS if all(problem.response.free) else ():
        if division.error <= LARGEST_SHARE * tolerance:
            split = SplitResponse(problem.response, division)
            problem = DividedProblem(problem, split)
            if division.real == np.float32:
                return problem, split
            break
    return problem, SplitResponse(problem.response, DIVISION)


def first_margin(iterate: Iterate, finer: Problem, is_finest: bool) -> float:
    """Maximum pressure that closes the gap of nodes that may touch; 0 if the contact is not dilute."""
    fewest = MIN_POINTS if is_finest else MIN_COARSE_POINTS
    dilute = 0 < iterate.nodes.size <= MAX_AREA * iterate.problem.grid.size
    if not dilute or min(finer.response.mode_grid.shape) < fewest or not can_be_split(finer.response):
        return 0.0
    return FIRST_MARGIN * float(iterate.pressure.mean())


def are_few(candidates: Array, problem: Problem) -> bool:
    """True if candidates take less time than the whole grid."""
    return candidates.size <= MAX_CANDIDATES * MAX_AREA * problem.grid.size


def candidates_of(iterate: Iterate, system: ContactSystem) -> Array:
    """Sorted indices of the contact nodes of an iterate, and of nodes that may touch after a step.

    Nodes out of contact move by no more than the contact nodes do, in either direction.
    """
    moves = float(np.ptp(system.linear.residual)) if system.linear.residual.size else 0.0
    held = iterate.held_nodes(system.approach + moves * iterate.problem.nodal_compliance, system.plastic)
    others = held.nodes[held.side > 0]
    return inserted(iterate.nodes, np.searchsorted(iterate.nodes, others), others)


def can_be_split(response: Response) -> bool:
    """True if pixels are nearly square, and the solid is a half-space for short waves."""
    grid, solid = response.grid, response.solid
    if max(grid.spacing) / min(grid.spacing) > MAX_SPACING_RATIO:
        return False
    if solid.height is None and solid.interface is None:
        return True
    longest = np.pi / max(INNER_DIVISION.far_grid(response).spacing)
    q = np.geomspace(longest, np.pi / min(grid.spacing), 30)
    relative = solid.surface_compliance(q) * q * (solid.effective_modulus / 2)
    return bool(np.abs(relative - 1).max() < MAX_DEVIATION)


def _near_field(response: Response, alpha: float, radius: int) -> Array:
    """Displacement near a node per unit of its pressure, without the far field: a stencil."""
    grid, modulus = response.grid, response.solid.effective_modulus
    dy, dx = grid.spacing
    rows, columns = np.ogrid[: radius + 1, : radius + 1]
    if response.repeats:
        count = good_size(4 * radius)
        tile = Grid((count, count), (count * dy, count * dx))
        modes = _near_modes(tile.wavenumber(), alpha, modulus) / tile.size
        out = Fourier(tile).inverse(modes + 0j)[: radius + 1, : radius + 1]
    else:
        y, x = dy * rows, dx * columns
        out = rectangle_compliance(y, x, grid.spacing, modulus) - _far_of_node(y, x, grid, alpha, modulus)
    out = np.where(rows**2 + columns**2 <= radius * (radius + 1), out, 0)
    off = np.abs(np.arange(-radius, radius + 1))
    return out[off[:, None], off]


def _far_field(response: Response, far: Response, alpha: float, order: int) -> Array:
    """Factors of the far field's coefficients with ky ≥ 0, divided by the coefficients of the splines."""
    grid, modulus, modes_of = response.grid, response.solid.effective_modulus, far.mode_grid
    if response.repeats:
        modes = far.half_compliance - _near_modes(modes_of.half_wavenumber(), alpha, modulus)
        modes *= modes_of.size / grid.size
    else:
        y, x = np.ogrid[: modes_of.half_shape[0], : modes_of.half_shape[1]]
        y, x = modes_of.spacing[0] * y, modes_of.spacing[1] * x
        if all(response.free):
            quarter = _erf_over(np.hypot(y, x), alpha) * (grid.area / (grid.size * np.pi * modulus))
        else:  # that of a node and its images, less the near field of the node
            quarter = surface_influence(y.ravel(), x.ravel(), grid, modulus, response.free)
            quarter -= rectangle_compliance(y, x, grid.spacing, modulus)
            quarter += _far_of_node(y, x, grid, alpha, modulus)
        modes = scipy.fft.dctn(quarter, type=1, overwrite_x=True)  # of an even field on even numbers of nodes
    attenuation = []
    wavevector = modes_of.qy[: modes_of.half_shape[0]], modes_of.qx
    for q, spacing, of_node in zip(wavevector, modes_of.spacing, grid.spacing, strict=True):
        waves = np.sinc(q * spacing / (2 * np.pi) + np.arange(-2, 3)[:, None]) ** (2 * order)
        over_node = 1 if not all(response.free) else np.sinc(q * of_node / (2 * np.pi))
        attenuation.append(over_node * waves[2] / waves.sum(axis=0) ** 2)
    return modes * attenuation[0][:, None] * attenuation[1]


def _far_of_node(y: Array, x: Array, grid: Grid, alpha: float, modulus: float) -> Array:
    """Mean of the far field over the rectangle of a node, by the rule of Gauss."""
    dy, dx = grid.spacing
    corners = [(a * dy / math.sqrt(12), b * dx / math.sqrt(12)) for a, b in product((-1, 1), repeat=2)]
    values = [_erf_over(np.hypot(y + above, x + beside), alpha) for above, beside in corners]
    return np.sum(values, axis=0) * (dy * dx / (4 * np.pi * modulus))


def _near_modes(wavenumber: Array, alpha: float, modulus: float) -> Array:
    """2 erf(q/2α) / (E* q)."""
    return _erf_over(wavenumber, 0.5 / alpha) * (2 / modulus)


def _erf_over(distance: Array, factor: float) -> Array:
    """erf(factor × r) / r."""
    out = np.empty(distance.shape)
    _write_erf_over(distance.reshape(-1), factor, out.reshape(-1))
    return out


@compiled
def _write_erf_over(distance: Any, factor: float, out: Any) -> None:
    for i in range(distance.size):
        r = distance[i]
        out[i] = math.erf(factor * r) / r if r > 0 else 2 * factor / math.sqrt(math.pi)


@vectorised_sums
def _interpolate_along_x(field: Any, column: Any, of_column: Any, out: Any) -> None:
    """Write the interpolant of each row of a field at the columns of the map."""
    for j in range(out.shape[0]):
        line, values = out[j], field[j]
        for x in range(line.size):
            total = 0.0
            for b in range(column.shape[1]):
                total += values[column[x, b]] * of_column[x, b]
            line[x] = total


@compiled
def _interpolate_along_y(lines: Any, row: Any, of_row: Any, out: Any) -> None:
    """Write the interpolant between an even number of lines at the rows of the map."""
    for j in range(out.shape[0]):
        line = out[j]
        line[:] = 0
        for a in range(0, row.shape[1], 2):
            one, two, of_one, of_two = lines[row[j, a]], lines[row[j, a + 1]], of_row[j, a], of_row[j, a + 1]
            for x in range(line.size):
                line[x] += of_one * one[x] + of_two * two[x]


@compiled
def _add_near_field(nodes: Any, values: Any, first: Any, kernel: Any, top: int, out: Any) -> None:
    """Add a kernel × values of nodes to the rows of a map from the row `top` on; nothing surrounds it."""
    radius, columns = kernel.shape[0] // 2, out.shape[1]
    for j in range(out.shape[0]):
        line, row = out[j], top + j
        for other in range(max(row - radius, 0), min(row + radius + 1, first.size - 1)):
            weights = kernel[other - row + radius]
            for k in range(first[other], first[other + 1]):
                column, value = np.int64(nodes[k]) - other * columns, values[k]
                start, stop = max(column - radius, 0), min(column + radius + 1, columns)
                some, near = line[start:stop], weights[start - column + radius :]
                for x in range(some.size):
                    some[x] += value * near[x]


def _splines(grid: Grid, far: Grid, axis: int, ends: bool, division: Division) -> tuple[Array, Array]:
    """Coarse-grid nodes around each node along an axis, and the values of their B-splines there.

    Where the map ends, the nodes of its first spline are the first ones.
    """
    ratio, period = grid.spacing[axis] / far.spacing[axis], far.whole_cell.shape[axis]
    position = (np.arange(grid.shape[axis])[:, None] + 0.5) * ratio - 0.5 + ends * (division.order // 2)
    last = np.floor(position + division.order / 2).astype(int)
    steps = np.arange(division.order)
    at = position + division.order / 2 - last + steps  # distances from the beginnings of the splines
    values = np.zeros(at.shape)
    values[:, 0] = 1
    for order in range(2, division.order + 1):
        before = np.roll(values, 1, axis=1)
        values = (at * values + (order - at) * before) / (order - 1)
    coarse = (last - steps) % period
    if far.mirrored:
        coarse = np.minimum(coarse, period - 1 - coarse)
    return coarse.astype(np.int32), values.astype(division.real)


@compiled
def _distribute(
    nodes: Any, values: Any, row: Any, of_row: Any, column: Any, of_column: Any, columns: int, field: Any
) -> None:
    """Write values on nodes to a field on the coarse-grid nodes around them."""
    field[:] = 0
    for k in range(nodes.size):
        y, x = np.int64(nodes[k]) // columns, np.int64(nodes[k]) % columns
        for a in range(row.shape[1]):
            value, line = values[k] * of_row[y, a], row[y, a]
            for b in range(row.shape[1]):
                field[line, column[x, b]] += value * of_column[x, b]


@compiled
def _add_interpolant(
    nodes: Any, row: Any, of_row: Any, column: Any, of_column: Any, columns: int, field: Any, out: Any
) -> None:
    """Add the interpolant of a field on the coarse-grid nodes to values on nodes."""
    for k in range(nodes.size):
        y, x = np.int64(nodes[k]) // columns, np.int64(nodes[k]) % columns
        total = 0.0
        for a in range(row.shape[1]):
            part, line = 0.0, row[y, a]
            for b in range(row.shape[1]):
                part += field[line, column[x, b]] * of_column[x, b]
            total += of_row[y, a] * part
        out[k] += total
