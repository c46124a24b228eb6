"""Contact pressure by principal pivoting on the dense compliance, for small periodic grids.

Every node is either in contact, where its gap is zero, or out of contact, where its pressure is zero. For a
given choice of contact nodes the pressures solve one dense linear system. All nodes that violate the other
half of the conditions (tension in contact, overlap out of contact) change sides together as long as their
number falls; otherwise only the last of them does, a rule that cannot cycle (J. J. Júdice, F. M. Pires,
Computers & Operations Research 21 (1994) 587, DOI 10.1016/0305-0548(94)90106-6). Unlike the solvers it does
not iterate on pressures, and it has no tolerance but rounding.
"""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from asperity.core.types import Array

# Violations below this fraction of the largest term are taken for rounding.
VIOLATION_ROUNDING = 1e-13

# Exchanges of all violating nodes that may fail to lower their number before nodes change sides one by one.
PATIENCE = 10

# Limit on the exchanges in total.
MAX_PIVOTS = 1000


class PivotingError(RuntimeError):
    """No choice of contact nodes was found that fulfils all conditions, or its linear system is singular."""


def pivot(
    height: Array,
    compliance: Array,
    *,
    mean_pressure: float | None = None,
    approach: float | None = None,
    guess: Array | None = None,
) -> Array:
    """Contact pressure of a periodic surface under a mean pressure or at an approach.

    Parameters
    ----------
    height : (ny, nx) array
        Lower face of the rigid indenter, measured upward.
    compliance : (ny, nx // 2 + 1) array
        Downward surface displacement per unit pressure of every stored mode, in the order of
        `asperity.fourier.grid.Grid.wavenumber`.
    mean_pressure, approach : float
        One of them. At the approach δ the gap is height + displacement − δ.
    guess : (ny, nx) bool array, optional
        First choice of contact nodes; by default the lowest node.

    Returns
    -------
    pressure : (ny, nx) array

    Raises
    ------
    PivotingError
        If the pivots do not end, or a system is singular.
    """
    surface = np.asarray(height, float).ravel()
    # Measured from the lowest node, so that small displacements are not lost in large heights.
    surface, level = surface - surface.min(), None if approach is None else approach - surface.min()
    if mean_pressure == 0 or (level is not None and level <= 0):
        return np.zeros(height.shape)
    load = None if mean_pressure is None else mean_pressure * surface.size
    spectrum = compliance.copy()
    if load is not None:
        # At a given load a uniform compliance changes only the approach, and it makes the system definite.
        spectrum[0, 0] += np.abs(spectrum).max()
    contact = surface == 0 if guess is None else np.ravel(guess).copy()
    fewest, patience = surface.size + 1, PATIENCE
    for _ in range(MAX_PIVOTS):
        if not contact.any():
            contact[np.argmin(surface)] = True
        pressure, gap, rounding = _pressure_and_gap(
            surface.reshape(height.shape), spectrum, contact, load, level
        )
        tension = contact & (pressure < -VIOLATION_ROUNDING * np.abs(pressure).max())
        wrong = np.flatnonzero(tension | (~contact & (gap < -rounding)))
        if wrong.size == 0:
            return np.maximum(pressure, 0).reshape(height.shape)
        fewest, patience = (wrong.size, PATIENCE) if wrong.size < fewest else (fewest, patience - 1)
        contact[wrong if patience > 0 else wrong[-1]] ^= True
    raise PivotingError(f"{wrong.size} of {surface.size} nodes still wrong after {MAX_PIVOTS} pivots")


def _pressure_and_gap(
    surface: Array, spectrum: Array, contact: Array, load: float | None, level: float | None
) -> tuple[Array, Array, float]:
    """Pressure and gap for a choice of contact nodes, flat arrays, and the rounding error of the gap."""
    inside = np.flatnonzero(contact)
    row, column = np.unravel_index(inside, surface.shape)
    # The displacement of one node by the pressure on another depends on their distance alone.
    kernel = np.fft.irfft2(spectrum, surface.shape)
    matrix = kernel[row[:, None] - row, column[:, None] - column]
    sides = np.stack([-surface.ravel()[inside], np.ones(inside.size)], axis=1)
    try:
        own, uniform = cho_solve(cho_factor(matrix, overwrite_a=True, check_finite=False), sides).T
    except LinAlgError as error:
        raise PivotingError(f"the compliance of {inside.size} nodes is singular to rounding") from error
    if load is not None:
        level = (load - own.sum()) / uniform.sum()
    assert level is not None
    pressure = np.zeros(surface.size)
    pressure[inside] = own + level * uniform
    modes = spectrum * np.fft.rfft2(pressure.reshape(surface.shape))
    displacement = np.fft.irfft2(modes, surface.shape)
    gap = (surface + displacement - level).ravel()
    return pressure, gap, VIOLATION_ROUNDING * max(float(np.abs(displacement).max()), abs(level))
