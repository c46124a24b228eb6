"""The half-space in place of a layer: proven bounds of the difference, and the choice between the two.

A half-space is cheaper to compute than a layer and serves every Poisson's ratio at once. The field of a
pressure mode decays as e^(−q depth), so a layer that is tall against the longest wave differs little from the
half-space.

Derivation of the bounds
------------------------
With h = q height, d = q depth and t = h − d, a kernel of the layer is e^(−d) (k H + N)/(k + D). Here H is the
polynomial of the half-space kernel H e^(−d), k = 3 − 4ν for a bonded layer and 1 for a frictionless one, and
N and D hold powers of e^(−2t) and e^(−2h). The difference from the half-space is e^(−d) (N − D H)/(k + D).
The terms of N in e^(−2t) are linear in t, and the maximum of their contribution over t is taken in closed
form; all terms in e^(−2h) are bounded by their absolute values. Both bounds fall with h, so the bound for the
smallest wavenumber holds for all larger ones.

The mean (q = 0) mode is left out: its stress is the same in both solids, and its displacement only shifts
the approach.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asperity.core.arguments import magnitude, number
from asperity.elasticity.layer import Layer

# Least q height at which the bounds are evaluated: they are far above 1 there, and 0 would be divided by.
_LOWEST = 1e-12


@dataclass(frozen=True)
class SolidChoice:
    """The simplest solid that a tolerance allows, and the reason for it.

    Attributes
    ----------
    layer : Layer
        The layer asked about, or the half-space of the same material.
    bound : float
        The larger of the two bounds below; 0 for a half-space.
    compliance_bound : float
        Proven largest relative difference between the surface compliances of the layer and the half-space,
        over all q ≥ q_min.
    stress_bound : float
        Proven largest difference of any stress component at any depth, relative to the pressure amplitude of
        the mode, over all q ≥ q_min.
    reason : str
        One sentence for the record of a result.
    """

    layer: Layer
    bound: float
    compliance_bound: float
    stress_bound: float
    reason: str


def simplest_solid(layer: Layer, q_min: float, tolerance: float) -> SolidChoice:
    """The half-space if it differs from the layer by at most the tolerance for all q ≥ q_min; else the layer.

    Parameters
    ----------
    layer : Layer
    q_min : float
        Smallest wavenumber of the pressure: 2π over the longer edge of the cell.
    tolerance : float
        Largest accepted difference, of both kinds in `SolidChoice`.

    Returns
    -------
    SolidChoice
        A layer with a free bottom is always kept.

    Raises
    ------
    TypeError, ValueError
        If q_min is not from 1e-75 to 1e75, or the tolerance is not a finite number ≥ 0.
    """
    q_min = magnitude("q_min", q_min)
    tolerance = number("tolerance", tolerance, "a finite number ≥ 0", lambda size: size >= 0)
    if layer.height is None:
        return SolidChoice(layer, 0.0, 0.0, 0.0, "the half-space was asked for")
    if layer.bottom == "free":
        reason = "a free layer has no support; no bound is known"
        return SolidChoice(layer, np.inf, np.inf, np.inf, reason)
    h = q_min * layer.height
    frictionless = layer.bottom == "frictionless"
    compliance = _compliance_bound(h, layer.poisson, frictionless)
    stress = _stress_bound(h, layer.poisson, frictionless)
    bound = max(compliance, stress)
    differ = (
        f"for q·height ≥ {h:.4g} the surface compliance of the layer and of the half-space differ by at "
        f"most {compliance:.2g} of its value, the stress by at most {stress:.2g} of a mode's pressure"
    )
    if bound <= tolerance:
        half_space = replace(layer, height=None)
        reason = f"half-space: {differ}, within the tolerance {tolerance:g}"
        return SolidChoice(half_space, bound, compliance, stress, reason)
    reason = f"layer: {differ}, beyond the tolerance {tolerance:g}"
    return SolidChoice(layer, bound, compliance, stress, reason)


def _compliance_bound(h: float, poisson: float, frictionless: bool) -> float:
    """Bound of the relative difference of the surface compliance from the half-space's, for q height ≥ h."""
    h = max(h, _LOWEST)
    e2h, c2h = np.exp(-2 * h), -np.expm1(-2 * h)
    if frictionless:
        return float(e2h * (2 + 4 * h) / (c2h * (1 + e2h)))
    k, m1 = 3 - 4 * poisson, 2 - 2 * poisson
    # The exact numerator is |2k (1 − e2h) − 4 m1² − 4 (h + h²)| e2h. It exceeds (2k + 4 m1²) e2h by at most
    # (4 (h + h²) − 4k + 2k e2h) e2h, which is below 0.62 for h ≤ 1.6 and k ≥ 1: less than 4 (h + h²) e2h at h
    # = 1.6.
    reach = max(h, 1.6)
    return float((2 * k * e2h + 4 * m1**2 * e2h + 4 * (reach + reach**2) * np.exp(-2 * reach)) / (k * c2h**2))


def _stress_bound(h: float, poisson: float, frictionless: bool) -> float:
    """Bound of the difference of any stress from that of the half-space, at any depth and for q height ≥ h.

    In units of the pressure amplitude of the mode. The keys "normal", "longitudinal" and "shear" are the
    kernels Z, L and T; "sum" is ν (Z + L), the stress across the wavevector. `near` holds the terms of N in
    e^(−2t) as (constant, slope) of a line in t, `rest` the bound of all others, `least` the smallest
    denominator.
    """
    h = max(h, _LOWEST)
    nu = poisson
    m, m1, k = 1 - 2 * nu, 2 - 2 * nu, 3 - 4 * nu
    e2h, c2h = np.exp(-2 * h), -np.expm1(-2 * h)
    if frictionless:
        near = {"normal": (1 + h, 1.0), "longitudinal": (1 - h, -1.0), "shear": (-h, -1.0), "sum": (2.0, 0.0)}
        rest = dict.fromkeys(near, 2 + 2 * h + 4 * h + 1)
        rest["sum"] *= 2
        least = c2h * (1 + e2h)
    else:
        normal = (h + k + 2 * m**2, 2 * h + 1)
        along = (k * (h - m), 2 * (m - h) - k)
        longitudinal = ((along[0] + nu * normal[0]) / (1 - nu), (along[1] + nu * normal[1]) / (1 - nu))
        near = {
            "normal": normal,
            "longitudinal": longitudinal,
            "shear": (h - 2 * m * m1, -1 - 2 * h),
            "sum": (normal[0] + longitudinal[0], normal[1] + longitudinal[1]),
        }
        rest_normal = 2 * h**2 + 2 * k + 2 * m**2 + 2 * (m1 + abs(m)) * h
        rest_along = k * (abs(m) + h) + 2 * abs(m) * h + 2 * h**2
        rest_longitudinal = (rest_along + abs(nu) * rest_normal) / (1 - nu)
        change = 4 * h**2 + 4 * m1**2
        rest = {
            "normal": rest_normal + change,
            "longitudinal": rest_longitudinal + change,
            "shear": 2 * m1 * h + abs(m) * h + 2 * h**2 + 2 * abs(m) * m1 + change,
            "sum": rest_normal + rest_longitudinal + 2 * change,
        }
        least = k * c2h**2
    bounds = {name: (np.exp(-h) * _largest(*near[name]) + e2h * rest[name]) / least for name in near}
    bounds["sum"] *= abs(nu)
    return float(max(bounds.values()))


def _largest(constant: float, slope: float) -> float:
    """Maximum of |constant + slope t| e^(−t) over t ≥ 0."""
    largest = abs(constant)
    if slope != 0 and constant / slope < 1:
        largest = max(largest, abs(slope) * np.exp(constant / slope - 1))
    return largest
