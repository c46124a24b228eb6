"""Contact of two rough bodies that move against each other, and passage of a point through a Hertz contact.

The upper body moves over the lower one by whole nodes along a direction of the grid. Every position is a
contact of its own, under one mean pressure over a whole period of the motion. On its way through a Hertz
contact the mean pressure at a point rises and falls, while the other face slides past it by the
slide-to-roll ratio S = 2 (u_upper − u_lower)/(u_upper + u_lower) of the surface velocities: when a point of
the lower body has moved by s, the upper face has moved past it by S s/(1 − S/2), and for a point of the upper
body by S s/(1 + S/2). In the middle of the contact the faces lie as they are given.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from asperity.contact import solve_contact
from asperity.contact.solution import Solids
from asperity.core.arguments import choice, magnitude, number, whole_number
from asperity.core.errors import InputError, shown
from asperity.core.types import Array, ArrayLike, Progress
from asperity.elasticity.loaded_solid import direction_cosines, traction_direction
from asperity.elasticity.two_bodies import TwoBodies
from asperity.fourier.grid import Edges, Grid, with_mirror_images
from asperity.stress.cycles.hertz_contact import HertzContact
from asperity.stress.cycles.histories import MovingPressure

MOST_SHIFTS = 10_000
"""Most positions of moving bodies."""

LONGEST_STEP = 8
"""Most nodes along an axis of one step in a direction of the grid."""

FARTHEST = 1.5
"""Places from the middle of a Hertz contact, in half-widths, beyond which a point is taken as unloaded."""

SAME_DIRECTION = 1e-3
"""Largest difference in degrees between an angle and the direction of the grid that it means."""


class Shift(NamedTuple):
    """A position: steps of the upper body, mean pressure, and place of the point along the motion."""

    steps: int
    mean_pressure: float
    place: float


class MovingContact:
    """Two bodies, rough or smooth, that move against each other in contact.

    Parameters
    ----------
    lower : (ny, nx) array
        Upper face of the lower body, peaks upward; zeros if it is smooth.
    upper : (ny, nx) array
        Lower face of the upper body, measured upward as `asperity.solve_contact` takes it; zeros if it is
        smooth.
    solid : Solid or TwoBodies
    length : float, (length_y, length_x) or Grid
        Edges of the periodic cell. Mirrored maps, which move against the images of each other, are continued
        to the `whole_cell` of their grid, on which the cycles are given.
    shifts : int
        Number of positions: over a whole period of the motion, or on the way through the Hertz contact.
    sliding_direction : "x", "y" or float
        Direction in which the upper body moves over the lower one; a number is an angle in degrees from x
        towards y, along a line through nodes.
    mean_pressure : float, optional
    hertz : HertzContact, optional
        In place of the mean pressure; of half-spaces.
    at : (y, x)
        Position, in half-widths of the Hertz contact, on the line along which points pass through it.
    slide_to_roll : float
        S, between −2 and 2, in the Hertz contact. At 0 the faces do not move against each other.
    friction : float
        As for `asperity.stress_planes`; the traction on the lower body has the sliding direction.
    hardness : float, optional
        As for `asperity.solve_contact`.
    film_share : float
        Fraction of the load that a film carries, as a smooth pressure without a shear traction; the
        asperities carry the rest.
    wavelength_short : float, optional
        Shortest wavelength of the faces; a step is at most half of it. By default it is two node steps, so
        that every node is a position.
    rtol : float
        Of each contact; see `asperity.solve_contact`.
    progress : callable, optional
        Called as progress(done, total) for the contacts of one body.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of range, no line through nodes has the direction, or there are too few shifts.

    Examples
    --------
    Two equal wavy faces that roll and slide along x; the cycles are at points of the lower one:

    >>> x = np.arange(64) / 64
    >>> waves = 1e-3 * np.cos(2 * np.pi * x) * np.ones((4, 1))
    >>> pair = asp.TwoBodies(asp.Solid(1.0, 0.3), asp.Solid(1.0, 0.3))
    >>> moving = asp.engineering.MovingContact(
    ...     waves, -waves, pair, (1 / 16, 1.0), shifts=16, mean_pressure=1e-3, wavelength_short=1.0
    ... )
    >>> cycles = asp.stress.stress_cycles(moving.in_body("lower"), yield_stress=1e-2)
    >>> print(f"range of σ_xz {cycles.attrs['worst_shear_range'][0] / 1e-3:.2f} p̄")
    range of σ_xz 1.25 p̄
    """

    def __init__(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        solid: Solids,
        length: Edges = 1.0,
        *,
        shifts: int,
        sliding_direction: str | float = "x",
        mean_pressure: float | None = None,
        hertz: HertzContact | None = None,
        at: tuple[float, float] = (0.0, 0.0),
        slide_to_roll: float = 0.0,
        friction: float = 0.0,
        hardness: float | None = None,
        film_share: float = 0.0,
        wavelength_short: float | None = None,
        rtol: float = 1e-6,
        progress: Progress | None = None,
    ) -> None:
        grid = Grid(np.shape(lower), length)  # type: ignore[arg-type]
        self._lower, self._upper = (
            with_mirror_images(grid.field(name, face), grid).astype(float)
            for name, face in (("lower", lower), ("upper", upper))
        )
        self.grid = grid.whole_cell
        accepted = f"a whole number from 2 to {MOST_SHIFTS}"
        self.shifts = whole_number("shifts", shifts, accepted, lambda count: 2 <= count <= MOST_SHIFTS)
        self._layers = (
            {"lower": solid.lower, "upper": solid.upper} if isinstance(solid, TwoBodies) else {"lower": solid}
        )
        if any(layer.base is not None for layer in self._layers.values()):
            raise ValueError("solid: bodies without a coating are needed")
        self._solid, self._hertz, self._at, self._progress = solid, hertz, at, progress
        self._direction, self._friction = sliding_direction, friction
        accepted = "a number from 0 to below 1"
        self._film = number("film_share", film_share, accepted, lambda share: 0 <= share < 1)
        self.step = step_along(sliding_direction, self.grid)
        self._along = np.array(direction_cosines(sliding_direction)[::-1])
        self.step_length = float(np.hypot(*np.multiply(self.step, self.grid.spacing)))
        accepted = "a number above -2 and below 2"
        self._ratio = number("slide_to_roll", slide_to_roll, accepted, lambda ratio: -2 < ratio < 2)
        if (mean_pressure is None) == (hertz is None):
            raise ValueError("exactly one of mean_pressure and hertz is needed")
        if hertz is None:
            if slide_to_roll:
                raise ValueError(f"slide_to_roll = {slide_to_roll:g}: a Hertz contact is needed")
            self._mean_pressure = magnitude("mean_pressure", mean_pressure)
        elif any(layer.height is not None for layer in self._layers.values()):
            raise ValueError("hertz: half-spaces are needed, the solid is a layer")
        self._settings: dict[str, Any] = {"hardness": hardness, "rtol": rtol}
        self._solved: dict[tuple[int, float], Array] = {}
        wave = 2 * self.step_length if wavelength_short is None else wavelength_short
        for body, moving in (("lower", self._upper), ("upper", self._lower)):
            steps = [state.steps for state in self.states(body) if state.mean_pressure]
            if body not in self._layers or not np.ptp(moving) or len(steps) < 2:
                continue
            moved = abs(steps[-1] - steps[0]) / (len(steps) - 1) if self._hertz else self.period / self.shifts
            longest = self.step_length * moved
            if longest > 0.5 * wave * (1 + 1e-9):
                needed = math.ceil(self.shifts * 2 * longest / wave)
                if needed > MOST_SHIFTS:
                    text = (
                        f"wavelength_short = {wave:.4g}: at least {wave * needed / MOST_SHIFTS:.4g} is needed"
                        f"{', or a smaller slide_to_roll' if self._hertz else ''}: steps of half of it take "
                        f"{needed} shifts, and {MOST_SHIFTS} are the most"
                    )
                    raise InputError("", [text])
                text = (
                    f" = {self.shifts}: at least {needed} are needed, for steps of half of the shortest wave "
                    f"of the faces, {wave:.4g}; fewer suffice with a longer wavelength_short"
                )
                raise InputError("", [("shifts", text)])

    @property
    def period(self) -> int:
        """Steps after which the upper body lies as before."""
        each = zip(self.grid.shape, self.step, strict=True)
        return math.lcm(*(nodes // math.gcd(nodes, step) for nodes, step in each))

    def states(self, body: str) -> list[Shift]:
        """Positions at which the contact is computed for the history of a point of `body`."""
        if self._hertz is None:
            steps = np.rint(np.arange(self.shifts) * self.period / self.shifts)
            return [Shift(int(step), self._mean_pressure, 0.0) for step in steps]
        places = self._places()
        pressures = self._hertz.pressure(*self._line(places))
        share = self._ratio / (1 - self._ratio / 2 if body == "lower" else 1 + self._ratio / 2)
        steps = np.rint(share * places / self.step_length)
        found = zip(steps.astype(int).tolist(), pressures.tolist(), places.tolist(), strict=True)
        return [Shift(*state) for state in found]

    def _places(self) -> Array:
        """Places on the line through the Hertz contact from the middle of its chord."""
        assert self._hertz is not None
        half = np.array([self._hertz.half_width_y, self._hertz.half_width_x])
        per_width, start = self._along / half, np.array(self._at)
        square, middle = per_width @ per_width, -(start @ per_width)
        chord = middle**2 + square * (1 - start @ start)  # (half its length · square)²
        if not (square > 0 and chord > 0):
            at = f"at = {self._at[0]:g} {self._at[1]:g}: a line across the Hertz contact is needed"
            raise InputError("", [("sliding_direction", f" = {shown(self._direction)}, {at}")])
        reach = FARTHEST * math.sqrt(chord) * (2 * np.arange(self.shifts) + 1 - self.shifts) / self.shifts
        return (middle + reach) / square

    def _line(self, places: Array) -> tuple[Array, Array]:
        """Positions y and x of places on the line through the Hertz contact."""
        assert self._hertz is not None
        start = self._hertz.position(self._at)
        return start[0] + places * self._along[0], start[1] + places * self._along[1]

    def in_body(self, body: str) -> MovingPressure:
        """The pressures on points of a body, for `asperity.stress.stress_cycles`.

        Parameters
        ----------
        body : "lower" | "upper"

        Raises
        ------
        ValueError
            If there is no such body.
        ConvergenceError
            If a contact does not converge.
        """
        layer = self._layers[choice("body", body, tuple(self._layers))]
        states, pressures = self.states(body), []
        for done, state in enumerate(states):
            pressures.append(self._pressure(state, body) if state.mean_pressure else None)
            if self._progress is not None:
                self._progress(done + 1, len(states))
        hertz, sliding = self._hertz, traction_direction(self._direction, body)
        background: Callable[[float], Array] | None = None
        if hertz is not None:
            place = self._line(np.array([state.place for state in states]))
            background = hertz.background(*place, layer, (1 - self._film) * self._friction, sliding)
        if self._film:
            carried = self._film * np.array([state.mean_pressure for state in states])
            film, smooth = carried[:, None] * layer.uniform_stress(), background
            background = (lambda depth: film) if smooth is None else (lambda depth: smooth(depth) + film)
        return MovingPressure(
            pressures,
            self.grid,
            layer,
            self._direction,
            self._friction,
            sliding,
            background,
            hertz is not None,
            0.0 if hertz is None else hertz.deepest(),
        )

    def _pressure(self, state: Shift, body: str) -> Array:
        """Pressure of a position in coordinates of a body."""
        shift = np.multiply(state.steps, self.step)
        both_rough = bool(np.ptp(self._upper)) and bool(np.ptp(self._lower))
        key = (state.steps % self.period if both_rough else 0), state.mean_pressure
        if key not in self._solved:
            self._solved[key] = solve_contact(
                np.roll(self._upper, shift if both_rough else 0, (0, 1)) - self._lower,
                self._solid,
                self.grid.length,
                mean_pressure=(1 - self._film) * state.mean_pressure,
                initial=next(reversed(self._solved.values()), None),
                **self._settings,
            ).pressure
        pressure = self._solved[key]
        if not both_rough and np.ptp(self._upper):  # the pressure moves with the rough upper body
            pressure = np.roll(pressure, shift, (0, 1))
        return pressure if body == "lower" else np.roll(pressure, -shift, (0, 1))


def step_along(sliding_direction: str | float, grid: Grid) -> tuple[int, int]:
    """Nodes (y, x) of the shortest step along a direction of a grid.

    Raises
    ------
    ValueError
        If no step of at most `LONGEST_STEP` nodes along each axis has the direction.
    """
    x, y = direction_cosines(sliding_direction)
    apart, nodes = {}, range(-LONGEST_STEP, LONGEST_STEP + 1)
    for j, i in ((j, i) for j in nodes for i in nodes if math.gcd(j, i) == 1):
        down, right = j * grid.spacing[0], i * grid.spacing[1]
        apart[j, i] = abs(math.degrees(math.atan2(down * x - right * y, right * x + down * y)))
    nearest = min(apart, key=lambda step: (apart[step], abs(step[0]) + abs(step[1])))
    if apart[nearest] > SAME_DIRECTION:
        angle = math.degrees(math.atan2(nearest[0] * grid.spacing[0], nearest[1] * grid.spacing[1]))
        text = (
            f" = {shown(sliding_direction)}: x, y or the angle of a line through nodes is needed; the "
            f"nearest is {angle:.6g}, by {nearest[0]} nodes along y and {nearest[1]} along x"
        )
        raise InputError("", [("sliding_direction", text)])
    return nearest
