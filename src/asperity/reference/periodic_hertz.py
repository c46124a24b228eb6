"""Periodic Hertz contact: the paper's square array of spherical indenters on a half-space (Eqs. 11–16).

Every contact carries Hertz's pressure distribution on a circle of radius a. The displacements by all
neighbours are summed over the lattice, and the load is chosen so that the surface fits the paraboloid at the
centre and at the edge of contact, r = (a, 0). This is an approximation because the true contact is not a
circle: the radius is good to 0.2 % for a ≤ 0.3 periods and to 1.2 % at 0.45.

The printed sum diverges, since every neighbour adds ``4a³/(3r)``. Differences of displacement converge, if
summed over windows symmetric in both indices; ``k ≠ 0, l ≠ 0`` in print must be read ``(k, l) ≠ (0, 0)``.
Here the sum runs over |k|, |l| ≤ n, neighbours outside this window enter by the integral of their
leading term, and the remainder, which falls as n⁻³, is removed by extrapolating from n and 2n.
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike
from asperity.reference.hertz import Hertz, unit_displacement

# Neighbours on each side in the coarser of the two sums; the result is then good to 10⁻⁹.
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

    Examples
    --------
    >>> array = asp.reference.periodic_hertz.PeriodicHertz(contact_radius=0.1, curvature_radius=10.0)
    >>> bool(array.load > array.single.load)  # neighbours press the surface down
    True
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
        """Hertz contact of the same radius without neighbours."""
        return Hertz(self.contact_radius, self.curvature_radius, self.effective_modulus)

    @property
    def enhancement(self) -> float:
        """Pressure over the pressure of a single contact of the same radius, about ``1 + 1.917 (a/L)³``."""
        neighbours = replica_difference(self.contact_radius, 0.0, self.contact_radius, self.period)
        # π(2a² − 0) − π(2a² − a²) = πa² without neighbours; the sums of Eq. 16 carry a factor 2.
        return float(1 / (1 - 2 / np.pi * neighbours))

    @property
    def mean_contact_pressure(self) -> float:
        """Load over contact area, P_0 of Eq. 15."""
        return self.enhancement * self.single.mean_contact_pressure

    @property
    def maximum_pressure(self) -> float:
        """Pressure on the axis."""
        return 1.5 * self.mean_contact_pressure

    @property
    def load(self) -> float:
        """Force on each indenter."""
        return np.pi * self.contact_radius**2 * self.mean_contact_pressure

    @property
    def mean_pressure(self) -> float:
        """Load over the area of the cell."""
        return self.load / self.period**2

    def pressure(self, r: ArrayLike) -> Array:
        """Contact pressure at distances `r` from the nearest axis, in the shape of `r`."""
        return self.enhancement * self.single.pressure(r)

    def displacement(self, y: ArrayLike, x: ArrayLike) -> Array:
        """Downward displacement of the surface at (y, x), less the displacement on the axis.

        The positions are relative to an axis, at most half a period from it along x and y; they broadcast.
        """
        a = self.contact_radius
        scale = 0.5 * self.maximum_pressure * a / self.effective_modulus
        own = unit_displacement(np.hypot(y, x) / a) - unit_displacement(0.0)
        return scale * (own + replica_difference(a, y, x, self.period))


def replica_difference(contact_radius: float, y: ArrayLike, x: ArrayLike, period: float) -> Array:
    """Displacement by all neighbours at (y, x), less their displacement at the origin: ``u_pt/a²`` of Eq. 12.

    Parameters
    ----------
    contact_radius, period : float
        Lengths in the unit of the positions.
    y, x : array_like
        Positions relative to an axis; they broadcast, and the result has their shape.
    """
    radius = contact_radius / period
    y, x = np.asarray(y, float) / period, np.asarray(x, float) / period
    sums = []
    for window in (_WINDOW, 2 * _WINDOW):
        index = np.arange(-window, window + 1)
        inside = np.zeros(np.broadcast_shapes(y.shape, x.shape))
        for row in index:
            columns = index if row else index[index != 0]
            here = unit_displacement(np.hypot(y[..., None] - row, x[..., None] - columns) / radius)
            origin = unit_displacement(np.hypot(row, columns) / radius)
            inside += np.sum(here - origin, axis=-1)
        # A neighbour outside adds 4a/(3r), whose Laplacian is 4a/(3r³). The integral of 1/r³ outside a square
        # of half-width w is 4√2/w, and by the symmetry of the lattice the change at r is r²/4 times the
        # Laplacian.
        outside = 4 / 3 * radius * 4 * np.sqrt(2) / (window + 0.5)
        sums.append(inside + 0.25 * (x**2 + y**2) * outside)
    coarse, fine = sums
    # The windows are 2n + 1 periods wide, and the remainder falls with the third power of the width.
    ratio = ((4 * _WINDOW + 1) / (2 * _WINDOW + 1)) ** 3
    return fine + (fine - coarse) / (ratio - 1)
