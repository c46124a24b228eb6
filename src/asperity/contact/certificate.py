"""How well a contact solution fulfils the conditions of contact, recomputed from the pressure alone.

A solution has p ≥ 0, g = h + u − δ ≥ 0 and p g = 0 at every node, with the displacement u that the
layer has under p. `verify_contact` evaluates u anew in double precision, so that nothing a solver kept can
hide an error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.elasticity.layer import Layer
from asperity.errors import ConvergenceError
from asperity.spectral import Fourier, Grid
from asperity.types import Array


@dataclass(frozen=True)
class Certificate:
    """Violations of the conditions of contact, and the work spent.

    Lengths are relative to the larger of the rms height of the surface and the largest pressure
    × grid spacing / E*, the indentation of one node.

    Attributes
    ----------
    penetration : float
        Largest overlap, max(−g).
    contact_gap : float
        Largest gap |g| where p > 0.
    tension : float
        Largest tension max(−p), relative to the largest pressure.
    load_imbalance : float
        Relative difference between the mean pressure and the one imposed; 0 if the load is not imposed.
    complementarity : float
        Σ p |g| / Σ p.
    iterations : int
        Applications of the compliance, on all grids.
    pairs : float
        Forward and inverse transforms in pairs of the finest grid, coarser grids counted by size.
    seconds : float
        Wall time of the solution.
    """

    penetration: float
    contact_gap: float
    tension: float
    load_imbalance: float
    complementarity: float
    iterations: int = 0
    pairs: float = 0.0
    seconds: float = 0.0

    @property
    def worst(self) -> float:
        """The largest violation."""
        violations = (
            self.penetration,
            self.contact_gap,
            self.tension,
            self.load_imbalance,
            self.complementarity,
        )
        return max(violations) if np.all(np.isfinite(violations)) else np.inf

    def check(self, tolerance: float) -> None:
        """Raise `ConvergenceError` if a violation exceeds the tolerance or is not a number."""
        if not self.worst <= tolerance:
            raise ConvergenceError(
                f"certificate not fulfilled, {self}", self.worst, tolerance, self.iterations, np.nan
            )


def verify_contact(
    height: Array,
    pressure: Array,
    layer: Layer,
    length: float | tuple[float, float] = 1.0,
    *,
    approach: float | None = None,
    mean_pressure: float | None = None,
    iterations: int = 0,
    pairs: float = 0.0,
    seconds: float = 0.0,
    threads: int = 1,
) -> Certificate:
    """Measure how far a pressure is from solving a contact problem.

    Parameters
    ----------
    height, pressure : (ny, nx) arrays
    layer : Layer
    length : float or (length_y, length_x)
    approach : float, optional
        The approach claimed; without it the mean of h + u over the contact.
    mean_pressure : float, optional
        The load imposed, if it was.
    iterations, pairs, seconds
        Work to be recorded.

    Returns
    -------
    Certificate
    """
    grid = Grid(np.shape(pressure), length)  # type: ignore[arg-type]
    fourier = Fourier(grid, threads=threads)
    pressure = np.asarray(pressure, dtype=float)
    height = np.asarray(height, dtype=float)
    coefficients = fourier.forward(pressure)
    coefficients *= layer.grid_surface_compliance(grid)
    gap = fourier.inverse(coefficients, overwrite=True)
    gap += height
    contact = pressure > 0
    if approach is None:
        approach = float(gap[contact].mean()) if contact.any() else float(gap.min())
    gap -= approach
    least, largest = float(pressure.min()), float(pressure.max())
    largest = max(largest, -least)
    scale = max(
        kernels.standard_deviation(height.reshape(-1)), largest * min(grid.spacing) / layer.effective_modulus
    )
    scale = scale or 1.0
    load = float(pressure.mean())
    imbalance = 0.0
    if mean_pressure is not None and mean_pressure != load:
        imbalance = abs(load - mean_pressure) / max(abs(mean_pressure), abs(load))
    pushed, held = pressure[contact], np.abs(gap[contact])
    return Certificate(
        penetration=max(0.0, float(-gap.min())) / scale,
        contact_gap=float(held.max(initial=0.0)) / scale,
        tension=max(0.0, -least) / (largest or 1.0),
        load_imbalance=imbalance,
        complementarity=float(pushed @ held) / (float(pushed.sum()) or 1.0) / scale,
        iterations=iterations,
        pairs=pairs,
        seconds=seconds,
    )
