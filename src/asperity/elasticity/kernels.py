"""Numba kernels of the elastic layer and the half-space: fields of one pressure mode, and compliances.

All are in closed form; the equations are in ``paper/supplement/method.md``. In the names and comments

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
