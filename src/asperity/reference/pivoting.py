"""Contact by principal pivoting on the dense compliance: no iteration on pressures, for small grids.

Every node is either in contact, its gap zero, or out of it, its pressure zero. For a choice of the nodes
in contact the pressures solve one dense linear system. All nodes that break the other half of the
conditions (tension in contact, overlap out of it) change sides at once while their number falls, and
else only the last of them, which cannot cycle (J. J. Júdice, F. M. Pires, Computers & Operations Research
21 (1994) 587, doi 10.1016/0305-0548(94)90106-6).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from asperity.elasticity.layer import Layer
from asperity.types import Array

# Violations below this fraction of the largest term are rounding.
ROUNDING = 1e-13

# Exchanges of all nodes without fewer violations before they change sides one by one, and in total.
PATIENCE = 10
MOST_PIVOTS = 1000


class PivotingError(RuntimeError):
    """No choice of contact nodes was found that fulfils all conditions, or its system is singular."""


def pivot(
    height: Array,
    layer: Layer,
    *,
    mean_pressure: float | None = None,
    approach: float | None = None,
    guess: Array | None = None,
) -> Array:
    """Contact pressure on a square unit cell, under a mean pressure or at an approach.

    Parameters
    ----------
    height : (ny, nx) array
    layer : Layer
    mean_pressure, approach : float
        One of them.
    guess : (ny, nx) bool array, optional
        Nodes first taken for those in contact; by default the lowest.

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
    spectrum = _spectrum(layer, height.shape)
    if load is not None:
        # A uniform compliance shifts the approach alone, and makes the system definite.
        spectrum[0, 0] += np.abs(spectrum).max()
    contact = surface == 0 if guess is None else np.ravel(guess).copy()
    fewest, patience = surface.size + 1, PATIENCE
    for _ in range(MOST_PIVOTS):
        if not contact.any():
            contact[np.argmin(surface)] = True
        pressure, gap, rounding = _settle(surface.reshape(height.shape), spectrum, contact, load, level)
        tension = contact & (pressure < -ROUNDING * np.abs(pressure).max())
        wrong = np.flatnonzero(tension | (~contact & (gap < -rounding)))
        if wrong.size == 0:
            return np.maximum(pressure, 0).reshape(height.shape)
        fewest, patience = (wrong.size, PATIENCE) if wrong.size < fewest else (fewest, patience - 1)
        contact[wrong if patience > 0 else wrong[-1]] ^= True
    raise PivotingError(f"{wrong.size} of {surface.size} nodes still wrong after {MOST_PIVOTS} pivots")


def _spectrum(layer: Layer, shape: tuple[int, int]) -> Array:
    """Compliance of every mode, (ny, nx)."""
    qy, qx = (2 * np.pi * np.fft.fftfreq(n, 1 / n) for n in shape)
    return layer.surface_compliance(np.hypot(qy[:, None], qx[None, :]))


def _settle(
    surface: Array, spectrum: Array, contact: Array, load: float | None, level: float | None
) -> tuple[Array, Array, float]:
    """Pressure and gap for a choice of contact nodes, and what rounding may make of the gap."""
    inside = np.flatnonzero(contact)
    row, column = np.unravel_index(inside, surface.shape)
    # A node's displacement by the pressure on another depends on their distance alone.
    kernel = np.fft.ifft2(spectrum).real
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
    displacement = np.fft.ifft2(spectrum * np.fft.fft2(pressure.reshape(surface.shape))).real
    gap = (surface + displacement - level).ravel()
    return pressure, gap, ROUNDING * max(float(np.abs(displacement).max()), abs(level))
