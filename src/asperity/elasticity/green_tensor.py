"""Elements of the Green's tensor of a layer with two faces, for any height.

Eq. A.3 of the paper with its misprints corrected is, with h = q height, D = sinh² h − h²,
K = 2 (1 − ν²)/(E q), M = 2 (1 + ν)/(E q), and l along and t across the wavevector,

    ll: K (sinh h cosh h − h)/D,    zz: K (sinh h cosh h + h)/D,    tt: M coth h,
    lz: −K [(1 − 2ν) sinh² h + h²]/(2 (1 − ν) D)

for displacement and traction at the same face, and for those at opposite faces

    ll: K (sinh h − h cosh h)/D,    zz: K (sinh h + h cosh h)/D,    tt: M/sinh h,    lz: −K h sinh h/D.

Here they are evaluated in units of e^h, so that nothing overflows, and by the factors sinh h ± h of D and
cosh h ± 1, so that nothing cancels: (sinh h cosh h − h)/D, for one, is half the sum of
(cosh h + 1)/(sinh h + h) and (cosh h − 1)/(sinh h − h), the stretching and the bending of the layer.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial.polynomial import polyval

from asperity.core.types import Array

DEEPEST = 750.0
"""Scaled distance at which e^(−distance) is 0 in double precision; larger ones count as this."""

_SINH_SERIES = [1 / math.factorial(2 * k + 1) for k in range(1, 10)]
"""Coefficients of (sinh h − h)/h³ in h², to double precision for h ≤ 1."""


def green_elements(scaled: Array, poisson: float) -> Array:
    """Elements of the Green's tensor, (2, 4, ...), in units of (1 + ν)/(E q).

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
    h, m = np.minimum(scaled, DEEPEST), 1 - 2 * poisson
    decay, low = np.exp(-h), h < 1
    # sinh h, cosh h and h in units of e^h/2; `ends` is twice the 1 in these units.
    sinh, cosh, linear, ends = -np.expm1(-2 * h), 1 + decay**2, 2 * h * decay, 4 * decay
    plus = sinh + linear
    minus = np.where(low, 2 * decay * h**3 * polyval(h * h, _SINH_SERIES), sinh - linear)
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
