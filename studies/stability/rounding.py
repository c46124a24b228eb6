"""Rounding errors of the elastic layer: the printed formulas, a direct solution, and the library.

The reference is `asperity.reference.state_space` in high precision, for exactly the rounded numbers that the
formulas were given.

Two quantities are compared over q · height:

* ``compliance``: the normal displacement of the surface of a free layer under a pressure mode, G33 of
  Eqs. A.1–A.3, for a wave along x. The error is relative.
* ``bonded_stress``: the stress under a pressure mode on a bonded layer at five depths. The error is relative
  to the largest component at that depth and divided by 1 + q · depth, because the rounding of q · depth
  alone is amplified by this factor.

Two formulas compute them: ``printed`` is Eq. A.3 with its misprints corrected (compliance only), ``layer`` is
`asperity.Solid`.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import printed
import xarray as xr

from asperity.core.types import Array
from asperity.elasticity.solid import Solid
from asperity.reference.state_space import StateSpace

FORMULAS = ("printed", "layer")
PRECISIONS = ("float64", "float32")
QUANTITIES = ("compliance", "bonded_stress")

# The results depend on q · height alone; direction of the wavevector, height and Young's modulus are
# arbitrary.
_DIRECTION = (0.6, 0.8)
_HEIGHT = 1.0
_YOUNG = 1.0

_DEPTH_FRACTIONS = np.array([0.0, 0.125, 0.5, 0.875, 1.0])

# Limit on q · depth of `rounding_errors`: deeper, single precision has no digits left.
_DEEPEST = 40.0

# Decimal digits of the reference.
_DIGITS = 80


def rounding_errors(
    poisson: Sequence[float] = (0.0, 0.33, 0.4999, 0.5),
    smallest: float = 1e-8,
    largest: float = 1e5,
    per_decade: int = 4,
) -> xr.Dataset:
    """Rounding errors of the formulas of the layer in both precisions, for q · height in a range.

    Poisson's ratios are rounded to single precision, so that both precisions have the same solid. An error is
    NaN where a formula gives no finite number, and for the stress by the printed formulas, which have none.
    """
    steps = round(per_decade * np.log10(largest / smallest)) + 1
    nominal = np.geomspace(smallest, largest, steps)
    qx, qy = (np.float32(component * nominal).astype(float) for component in _DIRECTION)
    along = np.float32(nominal).astype(float)
    scaled = np.hypot(qx, qy) * _HEIGHT
    ratios = np.asarray(poisson, np.float32).astype(float)
    depths = _HEIGHT * np.minimum(1.0, _DEEPEST / scaled)[:, None] * _DEPTH_FRACTIONS
    depths = np.minimum(np.float32(depths).astype(float), _HEIGHT)
    error = np.full((len(QUANTITIES), len(FORMULAS), len(PRECISIONS), len(ratios), steps), np.nan)
    for n, nu in enumerate(ratios):
        modes = [(x, y, _YOUNG, nu, _HEIGHT) for x, y in zip(qx, qy, strict=True)]
        exact = [StateSpace(*mode, bottom="bonded", digits=_DIGITS) for mode in modes]
        true = [float(-StateSpace(q, 0, _YOUNG, nu, _HEIGHT, "free").displacement(0)[2].real) for q in along]
        stress = [[m.stress(level) for level in levels] for m, levels in zip(exact, depths, strict=True)]
        layer, free = Solid(_YOUNG, nu, _HEIGHT), Solid(_YOUNG, nu, _HEIGHT, "free")
        for p, precision in enumerate(PRECISIONS):
            q, x, y, d = (part.astype(precision) for part in (along, qx, qy, depths))
            number = np.dtype(precision).type(nu)
            with np.errstate(all="ignore"):
                compliances = _printed_compliance(q, number), free.surface_compliance(q)
                fields = layer.stress(x[:, None], y[:, None], d)
                error[0, :, p, n] = [np.abs(values / np.array(true) - 1) for values in compliances]
            error[1, 1, p, n] = _stress_error(fields, stress, scaled[:, None] * depths)
    return xr.Dataset(
        {"error": (("quantity", "formula", "precision", "poisson", "scaled_wavenumber"), error)},
        coords={
            "quantity": list(QUANTITIES),
            "formula": list(FORMULAS),
            "precision": list(PRECISIONS),
            "poisson": np.asarray(poisson, dtype=float),
            "scaled_wavenumber": nominal,
        },
    )


def element_errors(
    poisson: Sequence[float] = (-0.999999, -0.5, 0.0, 0.33, 0.4999, 0.5), per_decade: int = 4
) -> Array:
    """Largest errors of the elements of `asperity.Solid.green_tensor`, (6, 6), over √(G_ii G_jj).

    Over q · height from 1e-3 to 1e3, in as many directions of the wavevector.
    """
    errors = np.zeros((6, 6))
    for turn, scaled in enumerate(np.geomspace(1e-3, 1e3, 6 * per_decade + 1)):
        qx, qy = scaled * np.cos(turn), scaled * np.sin(turn)
        for nu in poisson:
            exact = StateSpace(qx, qy, _YOUNG, nu, _HEIGHT, "free", _DIGITS).compliance()
            size = np.sqrt(np.abs(np.diag(exact)).astype(float))
            off = np.abs(Solid(_YOUNG, nu, _HEIGHT).green_tensor(qx, qy) - exact).astype(float)
            errors = np.maximum(errors, off / np.outer(size, size))
    return errors


def _stress_error(values: Array, true: Sequence[Sequence[Any]], decay: Array) -> Array:
    """Largest error over all depths of every mode, (modes,); NaN if not finite.

    The error at a depth is relative to the largest component there and divided by 1 + q · depth, `decay`.
    """
    out = np.full(len(true), np.nan)
    for n, (levels, exact) in enumerate(zip(values, true, strict=True)):
        if np.all(np.isfinite(levels)):
            error, size = abs(levels.astype(complex) - np.array(exact)), np.max(np.abs(exact), axis=1)
            out[n] = np.max((np.max(error, axis=1) / size).astype(float) / (1 + decay[n]))
    return out


def _printed_compliance(q: Array, nu: Any) -> Array:
    """Surface compliance of a free layer by G33 of Eq. A.3, misprints corrected, (modes,)."""
    kind = q.dtype.type
    elements = printed.compliance_elements(np, q, np.zeros_like(q), kind(_HEIGHT), kind(_YOUNG), nu)
    return np.asarray(elements["33"])
