"""Cracks that are expected to start, from cycles of the stress and the scatter of the fatigue limit.

In the weakest-link model a body survives if each of its volumes does. With a Weibull-distributed limit whose
mean is t₋₁ for specimens of the stressed volume V₀, the expected number of cracks per nominal area is

    n_c = 1/V₀ ∫ (Γ(1 + 1/m) d)^m dz,    averaged over the area,

with the Dang Van stress d over the limit, and no crack starts on an area A with the probability e^(−n_c A)
(W. Weibull, J. Appl. Mech. 18 (1951) 293; the integral over the stressed volume in rolling contact is that
of E. Ioannides, T. A. Harris, J. Tribol. 107 (1985) 367, DOI 10.1115/1.3261081, here without life and
threshold). The exponent m follows from the coefficient of variation, √(Γ(1 + 2/m)/Γ(1 + 1/m)² − 1). The
integral is that of the trapezoidal rule over the planes, of means over all points of each.
"""

import numpy as np
import scipy  # submodules are imported at first use
import xarray as xr

from asperity.core.arguments import magnitude, number

SCATTERS = (0.01, 1.0)
"""Accepted coefficients of variation; fatigue limits of steels have 0.03 to 0.15."""


def weibull_exponent(scatter: float) -> float:
    """Exponent m of the Weibull distribution with a coefficient of variation.

    Examples
    --------
    >>> from asperity.stress.cycles.survival import weibull_exponent
    >>> print(f"{weibull_exponent(0.1):.2f} {weibull_exponent(1.0):.2f}")
    12.15 1.00
    """
    low, high = SCATTERS
    accepted = f"a number from {low:g} to {high:g}"
    number("scatter", scatter, accepted, lambda value: low <= value <= high)

    def excess(logarithm: float) -> float:
        inverse = np.exp(-logarithm)
        return float(
            np.expm1(scipy.special.gammaln(1 + 2 * inverse) - 2 * scipy.special.gammaln(1 + inverse))
            - scatter**2
        )

    return float(np.exp(scipy.optimize.brentq(excess, -0.1, 6.0, xtol=1e-14)))


def cracks_per_area(cycles: xr.Dataset, scatter: float, volume: float) -> float:
    """Expected number of cracks per nominal area, n_c; none starts on an area A with probability e^(−n_c A).

    Parameters
    ----------
    cycles : dataset
        Of `asperity.stress.stress_cycles` with fatigue limits.
    scatter : float
        Coefficient of variation of the fatigue limit, from 0.01 to 1. The smaller it is, the more the few
        highest points count: at 0.1, 0.05, 0.02 and 0.01 the distance of the planes of
        `asperity.stress.depth_grid` causes errors of up to 1, 5, 20 and 40 %.
    volume : float
        Stressed volume of the specimens on which limits and scatter were measured, in the unit of length of
        the contact cubed.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the cycles have no Dang Van stress.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 2e-4, mean_pressure=20e6)
    >>> cycles = asp.stress.stress_cycles(contact, fatigue_torsion=300e6, fatigue_bending=480e6)
    >>> cracks = asp.stress.cracks_per_area(cycles, scatter=0.1, volume=1e-8)
    >>> bool(0 < np.exp(-cracks * 1e-6) < 1)
    True
    """
    if "fatigue_mean" not in cycles:
        raise ValueError("cycles: a result of stress_cycles with fatigue limits is needed")
    exponent, depths = weibull_exponent(scatter), cycles["cycle_depth"].values
    means = np.maximum(cycles["fatigue_mean"].values, 1e-300)  # nothing is above 0 under enough compression
    log_mean = scipy.interpolate.CubicSpline(np.log(cycles["fatigue_exponent"].values), np.log(means))
    power = np.exp(exponent * (scipy.special.gammaln(1 + 1 / exponent) + log_mean(np.log(exponent))))
    total = power * (depths[-1] - depths[0])
    return float(total / magnitude("volume", volume))
