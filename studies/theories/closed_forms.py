"""Theories of rough contact in closed form; pressures are in units of E*ḡ unless stated otherwise.

Spectra are given by the squared amplitudes of waves: `power` belongs to the ring `wavenumber`, and the sum of
all is the mean square of the heights. Integrals of the theories over the spectral density C(q) become such
sums, 2π ∫ q C f dq → Σ power f.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erf

from asperity.core.types import Array

VARIANCE = 0.25
"""Variance of the pressure in full contact over (E*ḡ)²: Σ (E* q/2)² |h|²."""

TERMS = 400
"""Terms of the series: the last one is exp(−2e4 / p_H²) at the variance of full contact, far below
rounding for hardnesses up to 4, and up to TERMS π/p_H beyond which no load is resolved at vanishing
variance."""

GAMMA = 0.45
"""Factor of the elastic energy of partial contact, as quoted with Persson's theory; 1 in its first form."""


def elastic_area(load: ArrayLike) -> Array:
    """Area fraction of Persson's theory: probability that a diffusing pressure has not fallen to 0.

    B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840, doi 10.1063/1.1388626.
    """
    return erf(np.asarray(load) / np.sqrt(2 * VARIANCE))


def elastoplastic_areas(
    load: ArrayLike, hardness: ArrayLike, variance: float = VARIANCE
) -> tuple[Array, Array]:
    """Elastic and plastic area fraction of Persson's elastoplastic theory.

    The distribution P(σ, v) of the pressure diffuses as the variance v of full contact grows with the
    magnification, ∂P/∂v = ½ ∂²P/∂σ², from P(σ, 0) = δ(σ − p̄), and is absorbed at σ = 0, where the surfaces
    part, and at σ = p_H, where they yield. With α_n = n π/p_H,

        P = (2/p_H) Σ sin(α_n σ) sin(α_n p̄) exp(−α_n² v/2).

    The elastic area is the integral of P, and the plastic one the current −½ ∂P/∂σ through σ = p_H over v.
    The load p̄ is carried by both: ∫ σ P dσ + p_H A_plastic = p̄.
    """
    load, hardness = np.broadcast_arrays(load, hardness)
    n = np.arange(1, TERMS + 1)
    share = (load / hardness)[..., None]
    left = np.exp(-((n * np.pi / hardness[..., None]) ** 2) * variance / 2)
    wave = np.sin(n * np.pi * share) * left / (n * np.pi)
    elastic = (4 * wave[..., ::2]).sum(-1)
    plastic = share[..., 0] - (2 * (-1.0) ** (n + 1) * wave).sum(-1)
    return elastic, plastic


def cavity_pressure(hardness: ArrayLike) -> Array:
    """Mean pressure of an indentation after Johnson's expanding cavity, with a yield stress of a third of
    p_H.

    p_m = (2/3) Y [1 + ln(E* tan β / (3 Y))], between first yield at 1.1 Y and the hardness 3 Y, with the rms
    gradient as tan β. K. L. Johnson, J. Mech. Phys. Solids 18 (1970) 115, doi 10.1016/0022-5096(70)90029-3.
    """
    yield_stress = np.asarray(hardness) / 3
    pressure = 2 / 3 * yield_stress * (1 + np.log(1 / (3 * yield_stress)))
    return np.clip(pressure, 1.1 * yield_stress, hardness)


def mean_gap(load: float, wavenumber: Array, power: Array, gamma: float = GAMMA) -> tuple[float, float]:
    """Mean gap after Persson's theory, and its change −dū/d(ln p̄), both in the unit of the heights.

        −p dū/dp = √π ∫ q² C(q) w(q) [γ + 3 (1 − γ) erf²(w p/E*)] exp(−(w p/E*)²) dq,
        w(q) = (π ∫_{q₀}^{q} q'³ C dq')^{−1/2}

    (C. Yang and B. N. J. Persson, J. Phys.: Condens. Matter 20 (2008) 215214, doi
    10.1088/0953-8984/20/21/215214). For every γ its integral over p is the elastic energy of full contact.

    Parameters
    ----------
    load : float
        Mean pressure over E*; not over E*ḡ.
    wavenumber, power : (rings,) arrays
    """
    width = _width(wavenumber, power)

    def slope(pressure: Array) -> Array:
        x = pressure[:, None] * width
        weight = gamma + 3 * (1 - gamma) * erf(x) ** 2
        return (wavenumber * power * width * weight * np.exp(-(x**2))).sum(1) / (2 * np.sqrt(np.pi))

    steps = np.geomspace(load, max(load, 1.0) * 8 / width.min(), 400)
    return float(np.trapezoid(slope(steps), np.log(steps))), float(slope(np.array([load]))[0])


def _width(wavenumber: Array, power: Array) -> Array:
    """w(q) of `mean_gap`: one over the root of half of the squared gradient of the waves up to q."""
    squared = wavenumber**2 * power
    return 1 / np.sqrt((np.cumsum(squared) - squared / 2) / 2)


def pressure_power(load: float, wavenumber: Array, power: Array, gamma: float = GAMMA) -> Array:
    """Squared amplitudes of the pressure over E* after Persson's theory, from those of the heights.

    Those of full contact times P (γ + (1 − γ) P²), where P = erf(w p/E*) is the area at the magnification q
    (B. N. J. Persson, J. Phys.: Condens. Matter 20 (2008) 312001, doi 10.1088/0953-8984/20/31/312001).
    `load` is the mean pressure over E*.
    """
    area = erf(load * _width(wavenumber, power))
    return area * (gamma + (1 - gamma) * area**2) * (wavenumber / 2) ** 2 * power


def stress_covariance(wavenumber: Array, power: Array, poisson: float, depths: Array) -> Array:
    """Covariance (depths, 6, 6) of xx, yy, zz, yz, xz and xy in planes of a half-space under isotropic waves.

    Each wave of the pressure makes stresses of its own wavenumber, so that variances are sums over waves.
    With d = q z: σ_zz = −p (1 + d) e^−d, along the wave σ_ll = −p (1 − d) e^−d, across it σ_tt = −p 2 ν e^−d,
    and σ_lz = −i p d e^−d, averaged over all directions (K. L. Johnson, Contact Mechanics, 1985; variances
    against depth: M. H. Müser, J. Mech. Phys. Solids 119 (2018) 73). `power` belongs to the pressure.
    """
    d = wavenumber * np.asarray(depths)[:, None]
    decay = np.exp(-d)
    along, across, down, shear = (1 - d) * decay, 2 * poisson * decay, (1 + d) * decay, d * decay
    covariance = np.zeros((len(depths), 6, 6))
    squares, product = (along**2 + across**2) @ power, (along * across) @ power
    covariance[:, 0, 0] = covariance[:, 1, 1] = (3 * squares + 2 * product) / 8
    covariance[:, 0, 1] = covariance[:, 1, 0] = (squares + 6 * product) / 8
    covariance[:, 2, 2] = down**2 @ power
    for i in (0, 1):
        covariance[:, i, 2] = covariance[:, 2, i] = ((along + across) * down) @ power / 2
    covariance[:, 3, 3] = covariance[:, 4, 4] = shear**2 @ power / 2
    covariance[:, 5, 5] = (along - across) ** 2 @ power / 8
    return covariance


def von_mises_profile(
    covariance: Array, load: float, poisson: float, shares: ArrayLike, area: float = 1.0, count: int = 2**14
) -> Array:
    """Root mean square and percentiles of the von Mises stress, (depths, 1 + shares), without lateral strain.

    The root mean square is exact whatever the distribution. Percentiles are computed for Gaussian stresses in
    the share `area` of each plane, with all of the variance, and none elsewhere.
    """
    lateral = poisson / (1 - poisson)
    mean = -load * np.array([lateral, lateral, 1, 0, 0, 0])
    within = np.maximum(1 - (1 - np.asarray(shares)) / area, 0)
    normal = np.random.default_rng(1).standard_normal((count, 6))
    axes = np.array([[1, -1, 0, 0, 0, 0], [0, 1, -1, 0, 0, 0], [-1, 0, 1, 0, 0, 0]])
    found = []
    for each in covariance:
        square = (axes @ (each + np.outer(mean, mean)) * axes).sum() / 2 + 3 * np.trace(each[3:, 3:])
        value, vector = np.linalg.eigh(each / area)
        stress = normal @ (vector * np.sqrt(np.maximum(value, 0))).T + mean
        squares = ((stress @ axes.T) ** 2).sum(1) / 2 + 3 * (stress[:, 3:] ** 2).sum(1)
        found.append([np.sqrt(square), *np.sqrt(np.quantile(squares, within))])
    return np.array(found)
