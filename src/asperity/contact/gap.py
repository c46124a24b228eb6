"""The gap between two pressed bodies: its percolation, its narrowest constriction, and what flows through it.

Nodes of the contact are neighbours along edges and diagonals, nodes of the gap along edges only: a fluid does
not pass between two contacts that meet at a corner. Then either the contact spans a map along y, or the gap
along x. In a periodic cell a path that meets its own image percolates.

The flow of a thin film is that of Reynolds' equation, ∇·(g³ ∇p) = 0 with the flux −g³ ∇p / (12 η), which
reynoldsflow solves by conservative finite volumes (V. A. Yastrebov,
https://github.com/vyastreb/reynoldsflow): the film is laminar and fills the gap, and its pressure does not
open it.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import ndimage

from asperity.contact.patches import contact_patches
from asperity.contact.solution import Contact
from asperity.core.arguments import choice, magnitude
from asperity.core.errors import shown
from asperity.core.packages import require
from asperity.core.types import Array
from asperity.fourier.grid import Grid

MAX_MULTIPLE = 4096
"""Most nodes on the edge of the square of maps that repeats, on which the flow is solved."""

FLOW_TOLERANCE = 1e-10
"""Residual of the flow, relative to that of a uniform pressure. A flow of a thousandth of that between
plates is then the same through all sections to a few 1e-7."""

CLOSED = 1e-6
"""Gap over the mean gap below which a node is closed to the film: its flux would be 1e-18 of the mean."""


@dataclass(frozen=True)
class Percolation:
    """Percolation of contact and gap along y and x, and the constriction of the best path of each.

    Attributes
    ----------
    contact, gap : (bool, bool)
        True if a path spans the map along y and along x.
    constriction : (float, float)
        Smallest gap on the path along y, and along x, whose smallest gap is largest; 0 without a path.
    place : (2, 2) tuple
        Position (y, x) of the node with that gap on the path along y, and along x; NaN without a path.
    """

    contact: tuple[bool, bool]
    gap: tuple[bool, bool]
    constriction: tuple[float, float]
    place: tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, eq=False)
class FilmFlow:
    """Flow of a thin film through the gap.

    Attributes
    ----------
    flow_rate : float
        Volume per time through the width of the map.
    flow_factor : float
        Flow rate over that between parallel plates at the mean gap.
    flux : (2, ny, nx) array
        Volume per time and width along y and x.
    pressure : (ny, nx) array
        Pressure of the film; NaN where the gap is closed.
    conservation_error : float
        Largest difference between the flow through sections of the map, over the flow.
    """

    flow_rate: float
    flow_factor: float
    flux: Array
    pressure: Array
    conservation_error: float


def percolation(contact: Contact) -> Percolation:
    """Percolation of contact and gap along both axes, and how narrow the gap is at the least.

    The constriction is found by bisection over the sorted gaps: it is the largest gap g for which the
    nodes with gaps ≥ g percolate.

    Parameters
    ----------
    contact : Contact

    Returns
    -------
    Percolation

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> found = asp.contact.percolation(contact)
    >>> found.contact, found.gap
    ((False, False), (True, True))
    >>> bool(0 < found.constriction[1] < contact.gap.max())
    True
    """
    gap, periodic = open_gap(contact), contact.edges_meet
    levels = np.sort(gap[gap > 0])

    @cache
    def spans(level: int) -> tuple[bool, bool]:
        return spanned(gap >= levels[level], periodic, diagonals=False)

    opened = spans(0) if levels.size else (False, False)
    constriction, place = [0.0, 0.0], [(np.nan, np.nan)] * 2
    for axis in np.flatnonzero(opened):
        closes = bisect_left(range(levels.size), True, key=lambda level: not spans(level)[axis])
        constriction[axis] = float(levels[closes - 1])
        nodes = np.argwhere(gap == levels[closes - 1])[0]
        place[axis] = tuple((nodes * contact.grid.spacing).tolist())
    touching = spanned(contact.pressure > 0, periodic, diagonals=True)
    return Percolation(touching, opened, tuple(constriction), tuple(place))  # type: ignore


def spanned(phase: Array, periodic: bool, diagonals: bool) -> tuple[bool, bool]:
    """True for y, and for x, if connected nodes span a map, or meet their image in a periodic cell."""
    if periodic:
        spans = contact_patches(phase, True, diagonals).spans
        return bool(spans[:, 0].any()), bool(spans[:, 1].any())
    piece, _ = ndimage.label(phase, structure=np.ones((3, 3)) if diagonals else None)
    ends = ((piece[0], piece[-1]), (piece[:, 0], piece[:, -1]))
    along_y, along_x = (bool(np.intersect1d(*sides).any()) for sides in ends)
    return along_y, along_x


def open_gap(contact: Contact) -> Array:
    """The gap of a contact [y, x], 0 where there is pressure."""
    return np.where(contact.pressure > 0, 0.0, np.maximum(contact.gap, 0.0))


def film_flow(
    contact: Contact, viscosity: float, pressure_difference: float, flow_direction: str = "x"
) -> FilmFlow:
    """Flow of a thin film through the gap of a contact; needs ``pip install "asperity[flow]"``.

    The flow through a periodic map is periodic. With a free boundary, and through a mirrored map, the film
    enters and leaves at the two edges across the flow, and the other two are sealed.

    Parameters
    ----------
    contact : Contact
        On square pixels, whose numbers along the edges have a common multiple of at most 4096.
    viscosity : float
        Dynamic viscosity η, in stress times time.
    pressure_difference : float
        Fall of the pressure of the film over the length of the map.
    flow_direction : "x" | "y"

    Returns
    -------
    FilmFlow

    Raises
    ------
    ValueError
        If an argument is out of range, the gap does not percolate, or the map does not suit the solver.
    MissingPackageError
        If reynoldsflow is not installed.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> flow = asp.contact.film_flow(contact, viscosity=1e-6, pressure_difference=1e-3)  # doctest: +SKIP
    >>> print(f"{flow.flow_factor:.3f} of the flow between planes at the mean gap")  # doctest: +SKIP
    0.335 of the flow between planes at the mean gap
    """
    require(["reynoldsflow"])
    from reynoldsflow import ReynoldsFlowError
    from reynoldsflow.transport import solve_fluid_problem

    viscosity = magnitude("viscosity", viscosity)
    pressure_difference = magnitude("pressure_difference", pressure_difference)
    axis = "yx".index(choice("flow_direction", flow_direction, ("x", "y")))
    check_film_grid(contact.grid)
    require_path(contact, flow_direction)
    gap = open_gap(contact)
    mean, (ny, nx) = float(gap.mean(dtype=float)), gap.shape
    length, width = contact.grid.length[:: 1 - 2 * axis]
    cell = np.where(gap < CLOSED * mean, 0.0, gap / mean).astype(float)
    if not contact.edges_meet:  # mirror images make reservoirs of two edges and walls of the others
        cell = np.pad(cell, [(0, ny), (0, nx)], "symmetric")
    longest = math.lcm(*cell.shape)
    cell = np.tile(cell, (longest // cell.shape[0], longest // cell.shape[1]))
    settings = {"solver": "scipy.amg-rs", "boundary_mode": "periodic", "rtol": FLOW_TOLERANCE}
    try:
        _, pressure, flux = solve_fluid_problem(cell if axis == 0 else cell.T, **settings)
    except ReynoldsFlowError as error:
        raise RuntimeError(f"film_flow: reynoldsflow did not solve the flow ({error})") from error
    sections = flux[:, :, 0].mean(axis=1)
    factor = float(sections.mean())
    # The solver's cell has the edge 1, the mean gap 1, and a mean pressure gradient of 1.
    nodes = (np.arange(longest) + 0.5) / longest
    fall = pressure_difference / length
    pressure = pressure_difference - fall * longest * contact.grid.spacing[axis] * (nodes[:, None] - pressure)
    flux = np.moveaxis(flux, -1, 0) * mean**3 * fall / (12 * viscosity)
    if axis == 1:
        pressure, flux = pressure.T, flux.transpose(0, 2, 1)[::-1]
    return FilmFlow(
        factor * mean**3 * fall * width / (12 * viscosity),
        factor,
        flux[:, :ny, :nx],
        np.where(gap > 0, pressure[:ny, :nx], np.nan),
        float(np.ptp(sections)) / factor,
    )


def check_film_grid(grid: Grid) -> None:
    """Raise `ValueError` for a grid on which reynoldsflow does not solve the flow."""
    (ny, nx), (step_y, step_x) = grid.shape, grid.spacing
    if math.lcm(ny, nx) > max(ny, nx, MAX_MULTIPLE) or abs(step_y / step_x - 1) > 1e-6:
        raise ValueError(
            f"map: {ny} × {nx} nodes, {step_y:.6g} × {step_x:.6g} apart; the flow needs square pixels, whose "
            f"numbers along the edges have a common multiple of at most {MAX_MULTIPLE}"
        )


def open_along(contact: Contact) -> tuple[bool, bool]:
    """True for y, and for x, if the gap percolates."""
    return spanned(open_gap(contact) > 0, contact.edges_meet, diagonals=False)


def require_path(contact: Contact, flow_direction: str) -> None:
    """Raise `ValueError` if the gap does not percolate in a direction."""
    found = open_along(contact)
    if not found["yx".index(flow_direction)]:
        other = "x" if flow_direction == "y" else "y"
        accepted = f"{other}, along which it is open, or a smaller load" if any(found) else "a smaller load"
        raise ValueError(
            f"flow_direction = {shown(flow_direction)}: {accepted} is needed, the contact closes the gap"
        )
