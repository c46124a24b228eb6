"""Numba kernels of the elastic layer and the half-space: fields of one pressure mode, and compliances.

All are in closed form; the equations are in ``docs/method.md``. In the names and comments

    h = q height,   d = q depth,   t = h − d   (scaled height of the layer, depth, and distance to the bottom)
    m = 1 − 2ν,     m1 = 2 − 2ν,   k = 3 − 4ν.

Z, L, T, V and W are the five kernels of `asperity.elasticity.solid`: stresses per unit pressure, and
displacements in units of (1 + ν)/(E q) per unit pressure. N, M, X, P and Q are the stresses per unit shear
traction.

Floating point
--------------
The closed forms are quotients of hyperbolic functions of h, t and d. For h ≥ 1 numerators are evaluated in
units of e^(2h − d)/4 and denominators in units of e^(2h)/4, so that only decaying exponentials are left and
nothing overflows. In these units ``shch`` is sinh h cosh t, ``chsh`` is cosh h sinh t, ``cd`` is cosh d and
``sd`` is sinh d; ``e2h`` is e^(−2h) and ``c2h`` is 1 − e^(−2h). For h < 1 differences of hyperbolic functions
cancel and are replaced by series. Both forms agree to rounding at h = 1.

References
----------
Half-space: Eq. 10 of the paper. Bonded layer, surface compliance: G. Carbone and L. Mangialardi, J. Mech.
Phys. Solids 56 (2008) 684. Free layer: Eq. A.3 of the paper with its misprints corrected. The scaled forms
and the series are new here; `asperity.reference.state_space` is the independent solution they are tested
against.
"""

import math
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval

from asperity.core.compiled import fused, fused_inlined
from asperity.core.types import Array

HALF_SPACE, BONDED, FRICTIONLESS, FREE = range(4)
"""Kinds of solid."""

Values = tuple[float, float, float, float, float]
"""The kernels Z, L, T, V, W of one mode at one depth."""


@fused
def decaying(x: float) -> tuple[float, float]:
    """e^(−x) and 1 − e^(−x) for x ≥ 0, both to full relative precision, from one exponential."""
    if x < 0.5:
        rest = -np.expm1(-x)
        return 1.0 - rest, rest
    decayed = np.exp(-x)
    return decayed, 1.0 - decayed


# Coefficients 1/(2k + 1)! and 1/(2k)!, k = 9 to 1: sinh x and cosh x to double precision for x ≤ 1.
_SINH_SERIES = tuple(1.0 / math.factorial(2 * k + 1) for k in range(9, 0, -1))
_COSH_SERIES = tuple(1.0 / math.factorial(2 * k) for k in range(9, 0, -1))
# Coefficients 1/(2k + 1)!, k = 1 to 12: sinh x / x to double precision for x ≤ 2.
_SINHC_SERIES = tuple(1.0 / math.factorial(2 * k + 1) for k in range(1, 13))


@fused_inlined
def sinh_rest(square: float) -> float:
    """(sinh x / x − 1)/x² as a function of x², for x ≤ 1."""
    value = 0.0
    for coefficient in _SINH_SERIES:
        value = value * square + coefficient
    return value


@fused_inlined
def cosh_rest(square: float) -> float:
    """(cosh x − 1)/x² as a function of x², for x ≤ 1.

    The difference `cosh_rest` − `sinh_rest` is (x cosh x − sinh x)/x³.
    """
    value = 0.0
    for coefficient in _COSH_SERIES:
        value = value * square + coefficient
    return value


@fused_inlined
def double_sinh_rest(square: float) -> float:
    """(sinh 2x / (2x) − 1)/x² as a function of x², for x ≤ 1."""
    sinh, cosh = sinh_rest(square), cosh_rest(square)
    return sinh + cosh + square * sinh * cosh


@fused_inlined
def _sinhc_difference(square_a: float, square_b: float) -> float:
    """(sinh a / a − sinh b / b)/(a² − b²) as a function of a² and b², for b ≤ a ≤ 2."""
    power, power_b, value = 0.0, 1.0, 0.0
    for coefficient in _SINHC_SERIES:
        power = square_a * power + power_b
        power_b *= square_b
        value += power * coefficient
    return value


@fused
def half_space_kernels(d: float, poisson: float) -> Values:
    """Z, L (the normal stress along the wavevector), T, V and W of the half-space."""
    a = np.exp(-d)
    m = 1.0 - 2.0 * poisson
    return (1.0 + d) * a, (1.0 - d) * a, d * a, (m - d) * a, (1.0 + m + d) * a


@fused
def frictionless_kernels(h: float, t: float, d: float, poisson: float) -> Values:
    """Z, L, T, V and W of a layer on a rigid frictionless support."""
    if h < 1.0:
        return _thin_frictionless_kernels(h, t, d, poisson)
    m = 1.0 - 2.0 * poisson
    e2t, c2t = decaying(2.0 * t)
    e2h, c2h = decaying(2.0 * h)
    _, c2d = decaying(2.0 * d)
    scale = np.exp(-d) / (c2h * (1.0 + e2h) + 4.0 * h * e2h)
    shch = c2h * (1.0 + e2t)
    far = d * (1.0 + e2h) * (1.0 + e2t) + 2.0 * t * (e2t + e2h)
    shear = scale * (d * (1.0 + e2h) * c2t - 2.0 * t * e2t * c2d)
    return (
        scale * (shch + far),
        scale * (shch - far),
        shear,
        scale * (m * shch - far),
        shear + scale * (1.0 + m) * c2h * c2t,
    )


@fused_inlined
def _thin_frictionless_kernels(h: float, t: float, d: float, poisson: float) -> Values:
    """`frictionless_kernels` for h < 1, by series."""
    s = h + t
    hh, tt, dd, quarter = h * h, t * t, d * d, 0.25 * s * s
    sinh_h, cosh_h = h + h * hh * sinh_rest(hh), 1.0 + hh * cosh_rest(hh)
    sinh_t, cosh_t = t + t * tt * sinh_rest(tt), 1.0 + tt * cosh_rest(tt)
    above_d = dd * cosh_rest(dd)
    half_s = 0.5 * s * (1.0 + quarter * sinh_rest(quarter))
    scale = 1.0 / (sinh_h * cosh_h + h)
    normal = scale * (sinh_h * cosh_t + d * cosh_h * cosh_t + t * (1.0 + above_d))
    shear = scale * 2.0 * h * t * s * d * _sinhc_difference(4.0 * quarter, dd)
    # sinh s − s + sinh d − d − s (cosh d − 1) − d (cosh s − 1)
    excess = s * quarter * double_sinh_rest(quarter) + d * dd * sinh_rest(dd)
    longitudinal = scale * (0.5 * (excess - s * above_d) - d * half_s * half_s)
    along = (1.0 - poisson) * longitudinal - poisson * normal
    downward = shear + scale * 2.0 * (1.0 - poisson) * sinh_h * sinh_t
    return normal, longitudinal, shear, along, downward


@fused
def bonded_kernels(h: float, t: float, d: float, poisson: float) -> Values:
    """Z, L, T, V and W of a layer bonded to a rigid support."""
    if h < 1.0:
        return _thin_bonded_kernels(h, t, d, poisson)
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = m1 + m
    e2t, c2t = decaying(2.0 * t)
    e2h, c2h = decaying(2.0 * h)
    _, c2d = decaying(2.0 * d)
    scale = np.exp(-d) / (k * c2h * c2h + 4.0 * e2h * (h * h + m1 * m1))
    chch, shsh = (1.0 + e2h) * (1.0 + e2t), c2h * c2t
    shch, chsh = c2h * (1.0 + e2t), (1.0 + e2h) * c2t
    cd, sd = 2.0 * (e2t + e2h), 2.0 * e2t * c2d
    normal = scale * ((h * t + m * m) * cd + k * chch + d * (m1 * shch + m * chsh) + t * sd)
    shear = scale * (d * (m1 * chch + m * shsh) - (h * t + m * m1) * sd)
    along = scale * (k * (m * shsh - d * chsh) + t * (m * sd - h * cd))
    longitudinal = (along + poisson * normal) / (1.0 - poisson)
    if t >= 1.0:
        downward = scale * (k * (m1 * chsh + d * shsh) - t * (m1 * cd + h * sd))
    else:
        tt = t * t
        bend = 2.0 * np.exp(-t) * t * tt * (cosh_rest(tt) - sinh_rest(tt))
        downward = scale * (
            m * (2.0 * m1 * chsh + (h + d) * shsh) + h * t * chsh - bend * (m1 * (1.0 + e2h) + h * c2h)
        )
    return normal, longitudinal, shear, along, downward


@fused_inlined
def _thin_bonded_kernels(h: float, t: float, d: float, poisson: float) -> Values:
    """`bonded_kernels` for h < 1, by series."""
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = m1 + m
    hh, tt, dd = h * h, t * t, d * d
    rest_h, rest_t, rest_d = sinh_rest(hh), sinh_rest(tt), sinh_rest(dd)
    above_h, above_t, above_d = cosh_rest(hh), cosh_rest(tt), cosh_rest(dd)
    sinh_h, cosh_h = h + h * hh * rest_h, 1.0 + hh * above_h
    sinh_t, cosh_t = t + t * tt * rest_t, 1.0 + tt * above_t
    sinhc_d, cosh_d = 1.0 + dd * rest_d, 1.0 + dd * above_d
    scale = 1.0 / (hh + m1 * m1 + k * sinh_h * sinh_h)
    normal = scale * (
        (h * t + m * m) * cosh_d
        + k * cosh_h * cosh_t
        + d * (m1 * sinh_h * cosh_t + m * cosh_h * sinh_t + t * sinhc_d)
    )
    half = 0.5 * (h + t)
    half *= 1.0 + half * half * sinh_rest(half * half)
    squares = 2.0 * poisson + half * half + 0.5 * dd * above_d - m * dd * rest_d
    shear = scale * d * (m1 * squares + m * sinh_h * sinh_t - h * t * sinhc_d)
    half_sum, half_t = 0.25 * (h + d) * (h + d), 0.25 * tt
    # (cosh h − cosh d)/t
    drop = 0.5 * (h + d) * (1.0 + half_sum * sinh_rest(half_sum)) * (1.0 + half_t * sinh_rest(half_t))
    along = scale * (
        -2.0 * poisson * (k * sinh_h * sinh_t + t * d * sinhc_d)
        - k * h * hh * (above_h - rest_h) * sinh_t
        - t * d * dd * (above_d - rest_d)
        + t * (2.0 * m * cosh_h * sinh_t + tt * (cosh_h * rest_t * t + drop))
    )
    longitudinal = (along + poisson * normal) / (1.0 - poisson)
    downward = scale * (
        sinh_t * (m * (2.0 * m1 * cosh_h + (h + d) * sinh_h) + h * t * cosh_h)
        - t * tt * (above_t - rest_t) * (m1 * cosh_h + h * sinh_h)
    )
    return normal, longitudinal, shear, along, downward


@fused
def half_space_shear_kernels(d: float) -> Values:
    """N, M, X, P and Q of the half-space under a shear traction."""
    a = np.exp(-d)
    return d * a, (2.0 - d) * a, (1.0 - d) * a, a, a


@fused
def bonded_shear_kernels(h: float, t: float, d: float, poisson: float) -> Values:
    """N, M, X, P and Q of a layer bonded to a rigid support, under a shear traction; for any h."""
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = m1 + m
    e2t, c2t = decaying(2.0 * t)
    e2h, c2h = decaying(2.0 * h)
    _, c2d = decaying(2.0 * d)
    decay = np.exp(-d)
    scale = decay / (k * c2h * c2h + 4.0 * e2h * (h * h + m1 * m1))
    chch, shsh = (1.0 + e2h) * (1.0 + e2t), c2h * c2t
    shch, chsh = c2h * (1.0 + e2t), (1.0 + e2h) * c2t
    cd, sd = 2.0 * (e2t + e2h), 2.0 * e2t * c2d
    far = d * (m1 * chch + m * shsh) + h * t * sd
    normal = scale * (m1 * m * sd + far)
    longitudinal = scale * (m1 * (1.0 + m1) * chsh + (1.0 - m) * m * shch + 2.0 * h * cd - far)
    shear = scale * ((m1 * m1 + h * t) * cd + k * shsh - h * sd - d * (m1 * chsh + m * shch))
    across = decay / (1.0 + e2h)
    return normal, longitudinal, shear, across * (1.0 + e2t), across * c2t


# Largest q depth at which kernels are evaluated. Beyond, they are below 1e-300 and are set to 0, because
# subnormal numbers are slow.
MAX_SCALED_DEPTH = 700.0

# Beyond this q (height − depth) the kernels of a layer differ from the half-space's by less than 1e-30, and
# beyond this q height the surface compliance does: the half-space is used.
BOTTOM_OUT_OF_REACH = 40.0


@fused
def fill_kernels(
    kind: int, of_shear: bool, q: Any, depth: Any, height: float, poisson: float, out: Any
) -> None:
    """Write the kernels of a pressure or a shear traction to the rows of `out`, for all modes.

    There is one depth for all modes or one for each. Under a shear traction the solid is the half-space or
    bonded, and at q = 0 the kernels do not depend on the height.
    """
    many = depth.size > 1
    for n in range(q.size):
        wavenumber = float(q[n])
        below = depth[n if many else 0]
        d, t = wavenumber * below, wavenumber * (height - below)
        if wavenumber == 0.0:
            values = (0.0, 0.0, 1.0, 1.0, 0.0) if of_shear else (1.0, 0.0, 0.0, 0.0, 0.0)
        elif d > MAX_SCALED_DEPTH:
            values = (0.0, 0.0, 0.0, 0.0, 0.0)
        elif kind == HALF_SPACE or t > BOTTOM_OUT_OF_REACH:
            values = half_space_shear_kernels(d) if of_shear else half_space_kernels(d, poisson)
        elif of_shear:
            values = bonded_shear_kernels(wavenumber * height, t, d, poisson)
        elif kind == BONDED:
            values = bonded_kernels(wavenumber * height, t, d, poisson)
        else:
            values = frictionless_kernels(wavenumber * height, t, d, poisson)
        out[0, n], out[1, n], out[2, n], out[3, n], out[4, n] = values


@fused
def fill_surface_compliance(
    kind: int, q: Any, height: float, poisson: float, unit: float, uniform: float, out: Any
) -> None:
    """Write the surface compliance of all modes: `unit` is 2/E*, `uniform` the compliance at q = 0."""
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = 3.0 - 4.0 * poisson
    for n in range(q.size):
        wavenumber = float(q[n])
        h = wavenumber * height
        if wavenumber == 0.0:
            out[n] = uniform
            continue
        if kind == HALF_SPACE or h > BOTTOM_OUT_OF_REACH:
            out[n] = unit / wavenumber
            continue
        e2h, c2h = decaying(2.0 * h)
        if kind == FRICTIONLESS:
            slope = c2h / (2.0 * h)
            out[n] = unit * height * 2.0 * slope * slope / (slope * (1.0 + e2h) + 2.0 * e2h)
        elif h >= 1.0:
            bending = c2h * (1.0 + e2h)
            if kind == BONDED:
                ratio = (k * bending - 4.0 * h * e2h) / (k * c2h * c2h + 4.0 * e2h * (h * h + m1 * m1))
            else:
                ratio = (bending + 4.0 * h * e2h) / (c2h * c2h - 4.0 * h * h * e2h)
            out[n] = unit / wavenumber * ratio
        else:
            beyond = h * h * double_sinh_rest(h * h)
            if kind == BONDED:
                divisor = h * h + m1 * m1 + k * np.sinh(h) ** 2
                out[n] = unit * height * (2.0 * m + (1.0 + 2.0 * m) * beyond) / divisor
            else:
                rest = sinh_rest(h * h)
                bending = h * h * h * rest * (2.0 + h * h * rest)
                out[n] = unit / wavenumber * (2.0 + beyond) / bending


NOTHING_LEFT = 750.0
"""Scaled distance at which e^(−distance) is 0 in double precision; a larger one is replaced by this."""


def green_elements(scaled: Array, poisson: float) -> Array:
    """Elements of the Green's tensor of a layer with two faces, (2, 4, ...), in units of (1 + ν)/(E q).

    Eq. A.3 of the paper with its misprints corrected is, with h = q height, D = sinh² h − h²,
    K = 2 (1 − ν²)/(E q), M = 2 (1 + ν)/(E q), and l along and t across the wavevector,

        ll: K (sinh h cosh h − h)/D,    zz: K (sinh h cosh h + h)/D,    tt: M coth h,
        lz: −K [(1 − 2ν) sinh² h + h²]/(2 (1 − ν) D)

    for displacement and traction at the same face, and for displacement and traction at opposite faces

        ll: K (sinh h − h cosh h)/D,    zz: K (sinh h + h cosh h)/D,    tt: M/sinh h,    lz: −K h sinh h/D.

    Here they are evaluated in units of e^h, so that nothing overflows, and by the factors sinh h ± h of D and
    cosh h ± 1, so that nothing cancels: (sinh h cosh h − h)/D, for one, is half the sum of
    (cosh h + 1)/(sinh h + h) and (cosh h − 1)/(sinh h − h), the stretching and the bending of the layer.

    Parameters
    ----------
    scaled : array
        h = q height > 0, also infinite.
    poisson : float

    Returns
    -------
    array
        ll, zz, tt and lz of displacement and traction at the same face, and then at opposite faces.
    """
    h, m = np.minimum(scaled, NOTHING_LEFT), 1 - 2 * poisson
    decay, low = np.exp(-h), h < 1
    # sinh h, cosh h and h in units of e^h/2; `ends` is twice the 1 in these units.
    sinh, cosh, linear, ends = -np.expm1(-2 * h), 1 + decay**2, 2 * h * decay, 4 * decay
    plus = sinh + linear
    minus = np.where(low, 2 * decay * h**3 * polyval(h * h, _SINH_SERIES[::-1]), sinh - linear)
    determinant = plus * minus
    above, below = (1 + decay) ** 2, np.expm1(-h) ** 2
    # Both equal far_along: the first loses digits for high layers, the second for low ones.
    by_parts, at_once = above / plus - below / minus, ends * (sinh - h * cosh) / determinant
    same = [
        (1 + m) / 2 * (above / plus + below / minus),
        (1 + m) / 2 * (above / minus + below / plus),
        2 * cosh / sinh,
        -(m * sinh**2 + linear**2) / determinant,
    ]
    opposite = [
        (1 + m) / 2 * np.where(low, by_parts, at_once),
        (1 + m) / 2 * ends * (sinh + h * cosh) / determinant,
        ends / sinh,
        -(1 + m) * linear * sinh / determinant,
    ]
    return np.array([same, opposite])
