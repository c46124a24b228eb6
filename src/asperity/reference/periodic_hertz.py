"""Hertz, repeated: the paper's square array of spherical indenters on a half-space (Eqs. 11–16).

Every contact carries Hertz's distribution of pressure on a circle of radius a; the neighbours'
displacements are summed over the lattice, and the load is the one that fits the paraboloid at the centre
and at the edge of contact, r = (a, 0). That is an approximation, the true contact being no circle: the
radius is good to 0.2 % for a ≤ 0.3 periods and to 1.2 % at 0.45 (`docs/validation.md`).

As printed the sum diverges, every neighbour adding ``4a³/(3r)``. Only differences of displacement
converge, over windows symmetric in both indices, and ``k ≠ 0, l ≠ 0`` must be read ``(k, l) ≠ (0, 0)``.
Here the sum runs over |k|, |l| ≤ n, and what lies outside is the integral of its leading term; the
remainder falls as n⁻³ and is removed by one extrapolation from n and 2n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.reference.hertz import Hertz, require_positive, unit_displacement
from asperity.types import Array

_WINDOW = 16


@dataclass(frozen=True)
class PeriodicHertz:
    """Square array of paraboloids ``r² / (2 R)`` on a half-space.

    Parameters
    ----------
    contact_radius : float
        Radius a of every contact circle, below half a period.
    curvature_radius : float
        Radius of curvature R.
    period : float
        Distance between neighbours, the edge of the cell.
    effective_modulus : float
        E* = E / (1 − ν²).

    Raises
    ------
    ValueError
        If one of them is not positive and finite, or if the contacts touch each other.
    """

    contact_radius: float
    curvature_radius: float
    period: float = 1.0
    effective_modulus: float = 1.0

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)
        if self.contact_radius >= 0.5 * self.period:
            raise ValueError(
                f"contact_radius = {self.contact_radius!r}: below half the period {self.period!r} is needed"
            )

    @property
    def single(self) -> Hertz:
        """The contact of the same radius without neighbours."""
        return Hertz(self.contact_radius, self.curvature_radius, self.effective_modulus)

    @property
    def enhancement(self) -> float:
        """Pressure over that of a single contact of the same radius, about ``1 + 1.917 (a/L)³``."""
        neighbours = replica_difference(self.contact_radius, 0.0, self.contact_radius, self.period)
        # π(2a² − 0) − π(2a² − a²) = πa² without neighbours; the sums of Eq. 16 carry a factor 2.
        return float(1 / (1 - 2 / np.pi * neighbours))

    @property
    def mean_contact_pressure(self) -> float:
        """Load over the area of contact: P_0 of Eq. 15."""
        return self.enhancement * self.single.mean_contact_pressure

    @property
    def largest_pressure(self) -> float:
        """Pressure on the axis."""
        return 1.5 * self.mean_contact_pressure

    @property
    def load(self) -> float:
        """Force on each indenter."""
        return np.pi * self.contact_radius**2 * self.mean_contact_pressure

    @property
    def mean_pressure(self) -> float:
        """Load over the area of the cell, what presses on the simulated surface."""
        return self.load / self.period**2

    @property
    def area_fraction(self) -> float:
        """Area of contact over the area of the cell."""
        return np.pi * (self.contact_radius / self.period) ** 2

    def pressure(self, r: ArrayLike) -> Array:
        """Contact pressure at a distance `r` from the nearest axis."""
        return self.enhancement * self.single.pressure(r)

    def displacement(self, y: ArrayLike, x: ArrayLike) -> Array:
        """Downward displacement of the surface against that on the axis, |x|, |y| ≤ half a period."""
        a = self.contact_radius
        scale = 0.5 * self.largest_pressure * a / self.effective_modulus
        own = unit_displacement(np.hypot(y, x) / a) - unit_displacement(0.0)
        return scale * (own + replica_difference(a, y, x, self.period))


def replica_difference(contact_radius: float, y: ArrayLike, x: ArrayLike, period: float) -> Array:
    """Displacement by all neighbours at (y, x) against the origin, ``u_pt/a²`` of Eq. 12 as a difference."""
    coarse, fine = (
        _windowed_difference(contact_radius / period, y, x, period, window)
        for window in (_WINDOW, 2 * _WINDOW)
    )
    # The windows are (2n + 1) periods wide; what is left falls with the third power of that.
    ratio = ((4 * _WINDOW + 1) / (2 * _WINDOW + 1)) ** 3
    return fine + (fine - coarse) / (ratio - 1)


def _windowed_difference(radius: float, y: ArrayLike, x: ArrayLike, period: float, window: int) -> Array:
    """Neighbours inside a window one by one, those outside through their mean curvature."""
    y, x = np.asarray(y, float) / period, np.asarray(x, float) / period
    index = np.arange(-window, window + 1)
    total = np.zeros(np.broadcast_shapes(y.shape, x.shape))
    for row in index:
        columns = index if row else index[index != 0]
        here = unit_displacement(np.hypot(y[..., None] - row, x[..., None] - columns) / radius)
        origin = unit_displacement(np.hypot(row, columns) / radius)
        total += np.sum(here - origin, axis=-1)
    # Outside: 4a/(3r) a neighbour, of Laplacian 4a/(3r³), whose integral beyond a square of half-width w
    # is 4√2/w; on a square lattice a quarter of r² times the Laplacian is the mean change.
    beyond = 4 / 3 * radius * 4 * np.sqrt(2) / (window + 0.5)
    return total + 0.25 * (x**2 + y**2) * beyond
