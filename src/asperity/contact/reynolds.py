"""Flow of a thin film through the gap between two pressed bodies, by Reynolds' equation.

The pressure p of the film fulfils ∇·(g³ ∇p) = 0, with the flux −g³ ∇p / (12 η) per width in a gap g: the film
is laminar and fills the gap, and its pressure does not open it. Finite volumes, a cell a node: two neighbours
exchange the flow K (pᵢ − pⱼ), where K is the harmonic mean of g³ times the width of their face over their
distance. Pores that no path joins to the flow are left out of the equations.

The conductances K span many orders of magnitude, since they grow with g³. The equations are solved by
conjugate gradients with algebraic multigrid (J. W. Ruge, K. Stüben, in S. F. McCormick, Multigrid Methods,
1987, ch. 4) of pyamg; the second pass of the choice of coarse nodes keeps the number of steps at about a
dozen. The flow rate is taken from the dissipated power Σ K (pᵢ − pⱼ)², whose error is the square of the error
of the pressure, and which a wide basin before a narrow constriction does not round off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import ndimage

from asperity.contact.gap import open_gap
from asperity.contact.patches import contact_patches
from asperity.contact.problem import ConvergenceProgress
from asperity.contact.solution import Contact
from asperity.core.arguments import choice, magnitude
from asperity.core.packages import require
from asperity.core.types import Array, Progress
from asperity.fourier.grid import Grid

CLOSED = 1e-6
"""Gap over the mean gap below which a node is closed to the film: its flux would be 1e-18 of the mean."""

ENERGY_TOLERANCE = 1e-10
"""Power of the error of the pressure over the dissipated power: the error of the flow rate; the pressure is
exact to about 1e-5."""

DELAY = 4
"""Steps after which the decrease of the power estimates its error (Z. Strakoš, P. Tichý, Electron. Trans.
Numer. Anal. 13 (2002) 56)."""

SMOOTHERS = {
    "presmoother": ("gauss_seidel", {"sweep": "forward"}),
    "postsmoother": ("gauss_seidel", {"sweep": "backward"}),
}
"""Half of the default sweeps, in two thirds of the time of a solution."""

MAX_STEPS = 500
"""Most conjugate gradient steps; usually 5 to 20. `FilmFlow.conservation_error` shows the error left."""

COARSEST = 500
"""Nodes of the coarsest grid, which is solved directly."""


@dataclass(frozen=True, eq=False)
class FilmFlow:
    """Flow of a thin film through the gap.

    Attributes
    ----------
    flow_rate : float
        Volume per time through the width of the map; 0 if the contact seals the gap.
    flow_factor : float
        Flow rate over the flow rate between parallel plates at the mean gap.
    flux : (2, ny, nx) array
        Volume per time and width along y and x.
    pressure : (ny, nx) array
        Pressure of the film; NaN where the gap is closed, and in pores that no path joins to the flow.
    conservation_error : float
        Largest difference between the flow through sections of the map, over the flow.
    """

    flow_rate: float
    flow_factor: float
    flux: Array
    pressure: Array
    conservation_error: float


def film_flow(
    contact: Contact,
    viscosity: float,
    pressure_difference: float,
    flow_direction: str = "x",
    progress: Progress | None = None,
    start: FilmFlow | None = None,
) -> FilmFlow:
    """Flow of a thin film through the gap of a contact; needs ``pip install "asperity[flow]"``.

    The flow through a periodic map is periodic. With a free boundary, and through a mirrored map, the film
    enters and leaves at the two edges across the flow, and the other two are sealed.

    Parameters
    ----------
    contact : Contact
    viscosity : float
        Dynamic viscosity η, in stress times time.
    pressure_difference : float
        Fall of the pressure of the film over the length of the map.
    flow_direction : "x" | "y"
    progress : callable, optional
        Called as progress(done, total).
    start : FilmFlow, optional
        A similar flow under the same pressure difference, on any grid, with whose pressure it starts.

    Returns
    -------
    FilmFlow

    Raises
    ------
    ValueError
        If an argument is out of range.
    MissingPackageError
        If pyamg is not installed.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> flow = asp.contact.film_flow(contact, viscosity=1e-6, pressure_difference=1e-3)  # doctest: +SKIP
    >>> print(f"{flow.flow_factor:.3f} of the flow between planes at the mean gap")  # doctest: +SKIP
    0.335 of the flow between planes at the mean gap
    """
    viscosity = magnitude("viscosity", viscosity)
    pressure_difference = magnitude("pressure_difference", pressure_difference)
    axis = "yx".index(choice("flow_direction", flow_direction, ("x", "y")))
    known = None if start is None else start.pressure / pressure_difference
    given = contact.grid, contact.edges_meet, axis, pressure_difference, viscosity, progress, known
    return flow_through(open_gap(contact), *given)


def flow_through(
    gap: Array,
    grid: Grid,
    periodic: bool,
    axis: int,
    pressure_difference: float,
    viscosity: float,
    progress: Progress | None = None,
    start: Array | None = None,
) -> FilmFlow:
    """Flow through a gap [y, x], which is 0 where it is closed, along y (`axis` 0) or x; see `film_flow`.

    `start` is a pressure that falls by 1, on any grid.
    """
    require(["pyamg"])
    mean = float(gap.mean(dtype=float))
    step_across, step_along = grid.spacing if axis == 1 else grid.spacing[::-1]
    relative = (gap if axis == 1 else gap.T).astype(float) / (mean or 1.0)  # the film flows along axis 1
    relative[relative < CLOSED] = 0.0
    pressure, piece = _joined(relative > 0, periodic)
    net = _Network.of(np.where(piece > 0, relative, 0.0), piece, step_across / step_along, periodic)
    if net.size:
        first = np.broadcast_to(1 - (np.arange(gap.shape[axis]) + 0.5) / gap.shape[axis], relative.shape)
        if start is not None:
            rows, columns = (np.arange(n) * m // n for n, m in zip(gap.shape, start.shape, strict=True))
            known = start[np.ix_(rows, columns)]
            first = np.where(np.isnan(known := known if axis == 1 else known.T), first, known)
        report = ConvergenceProgress(progress, ENERGY_TOLERANCE)
        pressure[piece > 0] = net.solve(first[piece > 0], report)
        pressure = net.levelled(pressure)
    across, along, rate = net.flows(pressure)  # the flow rate is the power under a fall of 1
    sections = along.sum(axis=0)
    unit = mean**3 * pressure_difference / (12 * viscosity)
    flux = np.stack(
        [(across[:-1] + across[1:]) / (2 * step_along), (along[:, :-1] + along[:, 1:]) / (2 * step_across)]
    )
    if axis == 0:
        pressure, flux = pressure.T, flux.transpose(0, 2, 1)[::-1]
    return FilmFlow(
        rate * unit,
        rate * grid.length[axis] / grid.length[1 - axis],
        flux * unit,
        pressure * pressure_difference,
        float(np.ptp(sections)) / rate if rate else 0.0,
    )


def _joined(opened: Array, periodic: bool) -> tuple[Array, Array]:
    """Pressure of the film where it does not flow, and the numbers of the pores through which it flows.

    The pressure is 1 in pores that only the inlet meets, 0 at the outlet, and NaN without either.
    """
    if periodic:
        found = contact_patches(opened, True, diagonals=False)
        flowing = np.append(False, found.spans[:, 1])
        piece, pressure = found.number, np.full(opened.shape, np.nan)
    else:
        piece, count = ndimage.label(opened)
        inlet, outlet = (np.isin(np.arange(count + 1), piece[:, end]) for end in (0, -1))
        inlet[0] = outlet[0] = False
        flowing = inlet & outlet
        pressure = np.where(inlet, 1.0, np.where(outlet, 0.0, np.nan))[piece]
    return pressure, np.where(flowing[piece], piece, 0)


class _Network(NamedTuple):
    """Nodes of the pores through which the film flows along axis 1, and conductances of their faces.

    Along the axis across a face there is one face more than nodes. Through a periodic map the pressure falls
    by 1 between a node and its image; otherwise from 1 in the inlet to 0 in the outlet.
    """

    piece: Array
    across: Array
    along: Array
    periodic: bool

    @classmethod
    def of(cls, gap: Array, piece: Array, face_over_distance: float, periodic: bool) -> _Network:
        """Network of a gap; `face_over_distance` is the width over the length of a cell."""
        with np.errstate(divide="ignore"):
            resistance = gap**-3.0
            walls = 0.0 if periodic else np.inf
            across = 2 / np.add(*_sides(resistance, 0, periodic, walls, walls)) / face_over_distance
            along = 2 / np.add(*_sides(resistance, 1, periodic, 0.0, 0.0)) * face_over_distance
        return cls(piece, across, along, periodic)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return int(np.count_nonzero(self.piece))

    def solve(self, start: Array, report: Callable[[float], None]) -> Array:
        """Pressure at the nodes, up to a constant in each pore of a periodic map, from a first guess."""
        import pyamg

        matrix, inflow = self._equations()
        second_pass = ("RS", {"second_pass": True})
        settings = {"CF": second_pass, "max_coarse": COARSEST, "coarse_solver": "splu", **SMOOTHERS}
        levels = pyamg.ruge_stuben_solver(matrix, **settings)
        return _conjugate_gradients(matrix, inflow, levels.aspreconditioner(), start, report)

    def _equations(self) -> tuple[Any, Array]:
        """Matrix of the equations of the nodes, and the flow into each node from outside."""
        from scipy.sparse import coo_array, csr_matrix

        nodes = self.piece > 0
        number = np.full(nodes.shape, -1, np.int32)
        number[nodes] = np.arange(self.size, dtype=np.int32)
        diagonal = (self.across[:-1] + self.across[1:] + self.along[:, :-1] + self.along[:, 1:])[nodes]
        inflow = np.zeros(nodes.shape)
        inflow[:, 0] += self.along[:, 0]
        if self.periodic:
            inflow[:, -1] -= self.along[:, -1]
            _, first = np.unique(self.piece[nodes], return_index=True)
            diagonal[first] *= 2  # sets the pressure of a node of each pore to 0
        own = np.arange(self.size, dtype=np.int32)
        rows, columns, values = [own], [own], [diagonal]
        for axis, conductance in enumerate((self.across, self.along)):
            outside = 0 if self.periodic else -1
            faces = self._each_once(axis)
            one, other = (side[faces] for side in _sides(number, axis, self.periodic, outside, outside))
            joined = (one >= 0) & (other >= 0)
            one, other, value = one[joined], other[joined], -conductance[faces][joined]
            rows += [one, other]
            columns += [other, one]
            values += [value, value]
        places = np.concatenate(rows), np.concatenate(columns)
        matrix = coo_array((np.concatenate(values), places), (self.size, self.size))
        return csr_matrix(matrix), inflow[nodes]

    def flows(self, pressure: Array) -> tuple[Array, Array, float]:
        """Flow through the faces across and along the flow, and the power that it dissipates."""
        outlet, flows, power = -1.0 if self.periodic else 0.0, [], 0.0
        for axis, conductance in enumerate((self.across, self.along)):
            one, other = _sides(pressure, axis, self.periodic, *((1.0, outlet) if axis else (0.0, 0.0)))
            fall = np.where(conductance > 0, one - other, 0.0)
            flows.append(conductance * fall)
            power += float(np.sum((flows[-1] * fall)[self._each_once(axis)]))
        return flows[0], flows[1], power

    def levelled(self, pressure: Array) -> Array:
        """The pressure, which in each pore of a periodic map falls on average from 1 to 0."""
        if not self.periodic:
            return pressure
        columns = self.piece.shape[1]
        missing = 1 - (np.arange(columns) + 0.5) / columns - pressure
        pores, number = np.unique(self.piece, return_inverse=True)
        number = number.reshape(self.piece.shape)
        return pressure + ndimage.mean(missing, number, np.arange(pores.size))[number]

    def _each_once(self, axis: int) -> tuple[slice, ...]:
        """Faces across an axis without the last one, if it is the image of the first."""
        each = slice(0, -1 if self.periodic else None)
        return (each,) if axis == 0 else (slice(None), each)


def _sides(field: Array, axis: int, periodic: bool, before: float, after: float) -> tuple[Array, Array]:
    """Values on both sides of the faces across an axis; outside the image's plus a number, or the number."""
    first, last = field.take([0], axis), field.take([-1], axis)
    outside = (
        (last + before, first + after)
        if periodic
        else (np.full_like(first, before), np.full_like(first, after))
    )
    padded = np.concatenate([outside[0], field, outside[1]], axis)
    return padded.take(range(padded.shape[axis] - 1), axis), padded.take(range(1, padded.shape[axis]), axis)


def _conjugate_gradients(
    matrix: Any, inflow: Array, preconditioner: Any, start: Array, report: Callable[[float], None]
) -> Array:
    """Solution of a positive definite system to `ENERGY_TOLERANCE`, or after `MAX_STEPS` steps."""
    solution = start.astype(float)
    residual = inflow - matrix @ solution
    image = preconditioner @ residual
    direction, product = image, float(residual @ image)
    powers: list[float] = []
    for _ in range(MAX_STEPS):
        applied = matrix @ direction
        step = product / float(direction @ applied)
        solution += step * direction
        residual -= step * applied
        powers.append(step * product)
        error = sum(powers[-DELAY:]) / abs(float(solution @ inflow))
        report(error)
        if error < ENERGY_TOLERANCE:
            break
        image = preconditioner @ residual
        earlier, product = product, float(residual @ image)
        direction = image + product / earlier * direction
    return solution
