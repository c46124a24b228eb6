"""Numba kernels of a coating bonded to an elastic half-space: fields of one mode, and surface compliances.

In each material a mode is a field that decays downward and, in the coating, one that decays upward from the
interface, as under tractions on a half-space. With sums and differences S± = S_z ± S_l of the tractions of
`asperity.elasticity.layer_fields`, the amplitudes a of the first and b e^(−h) of the second are connected by

    b₋ = −ρ (a₊ + 2 h a₋),     ρ = (Γ − 1)/(Γ + k),
    b₊ = −σ a₋,                σ = (Γ k' − k)/(Γ k' + 1),     Γ = μ/μ',   k = 3 − 4ν,

where the prime marks the base, and the amplitudes a₊ + 2 h a₋ and a₋ times (1 − ρ) e^(−h) and (1 − σ) e^(−h)
give the tractions on the interface. The coefficients ρ and σ are 0 for equal materials, −1/k and −k on a
rigid base and 1 without a base.

Floating point
--------------
Γ enters as the shares μ/(μ + μ') and μ'/(μ + μ'), `stiff` and `soft`. The coefficients of their powers are
multiplied out so that no difference cancels in floating point. For h < 1 the field in the coating follows
from its state on the interface by the matrix exponential of `asperity.elasticity.layer_fields`, whose
elements are accurate one by one; otherwise from a and b. All exponentials decay.

References
----------
D. M. Burmister, J. Appl. Phys. 16 (1945) 89, DOI 10.1063/1.1707558, for the surface compliance in another
form. The forms that do not cancel are new here.
"""

from typing import Any

import numpy as np

from asperity.core.compiled import fused, fused_inlined
from asperity.elasticity.kernels import (
    BOTTOM_OUT_OF_REACH,
    MAX_SCALED_DEPTH,
    cosh_rest,
    decaying,
    double_sinh_rest,
    half_space_kernels,
    half_space_shear_kernels,
    sinh_rest,
)

Materials = tuple[float, float, float, float]
"""Poisson's ratio of the coating and of the base; shear modulus of each over the sum of both."""

StateVector = tuple[float, float, float, float, float]
"""U_l, U_z, S_l, S_z and σ_ll of a mode, see `asperity.elasticity.layer_fields`."""


@fused_inlined
def _determinant(h: float, e2h: float, c2h: float, materials: Materials) -> float:
    """(1 − ρ e^(−2h)) (1 − σ e^(−2h)) − 4 h² ρ e^(−2h) times the divisors of ρ and σ, by positive terms."""
    nu, nu_base, stiff, soft = materials
    k, k_base = 3.0 - 4.0 * nu, 3.0 - 4.0 * nu_base
    if h < 1.0:  # 4 e^(−2h) (sinh² h − h²)
        rest = sinh_rest(h * h)
        bending = 4.0 * e2h * (h * h) * (h * h) * rest * (2.0 + h * h * rest)
    else:
        bending = c2h * c2h - 4.0 * h * h * e2h
    mixed = c2h * (1.0 + k * e2h + k_base * (k + e2h)) + 4.0 * h * h * e2h * (k_base - 1.0)
    return (
        stiff * stiff * k_base * bending
        + stiff * soft * mixed
        + soft * soft * ((k + e2h) * (1.0 + k * e2h) + 4.0 * h * h * e2h)
    )


@fused
def coated_compliance(h: float, materials: Materials) -> float:
    """Surface compliance over the compliance of a half-space of the coating's material."""
    nu, nu_base, stiff, soft = materials
    k, k_base = 3.0 - 4.0 * nu, 3.0 - 4.0 * nu_base
    e2h, c2h = decaying(2.0 * h)
    m = 1.0 - 2.0 * nu
    if h < 1.0:  # as of the bonded layer
        rigid = 4.0 * e2h * h * (2.0 * m + k * h * h * double_sinh_rest(h * h))
    else:
        rigid = k * c2h * (1.0 + e2h) - 4.0 * h * e2h
    mixed = 1.0 + k * k_base + (k + k_base) * e2h * e2h - 4.0 * h * e2h * (k_base - 1.0)
    found = stiff * stiff * k_base * (c2h * (1.0 + e2h) + 4.0 * h * e2h) + stiff * soft * mixed
    return (found + soft * soft * rigid) / _determinant(h, e2h, c2h, materials)


@fused
def _interface(of_shear: bool, h: float, materials: Materials) -> tuple[float, float, float, float]:
    """State on the interface, above it, under S_z = −1 or S_l = −1 at the top: U_l − h/2 U_z, U_z, S_l, S_z.

    In bending U_l is h/2 U_z except for the stretching of the middle of a thin coating.
    """
    nu, nu_base, stiff, soft = materials
    m, n = 1.0 - 2.0 * nu, 1.0 - 2.0 * nu_base
    k, k_base = 1.0 + 2.0 * m, 1.0 + 2.0 * n
    e2h, c2h = decaying(2.0 * h)
    both = h * (1.0 + e2h)
    # h (1 + e^(−2h)) − (1 − e^(−2h)) = 2 e^(−h) (h cosh h − sinh h)
    series = 2.0 * np.exp(-h) * h * h * h * (cosh_rest(h * h) - sinh_rest(h * h))
    curved = series if h < 1.0 else both - c2h
    if of_shear:
        s_l = stiff * 2.0 * (n * (2.0 * h - c2h) + curved) - soft * ((1.0 + k) * (1.0 + e2h) - 2.0 * h * c2h)
        s_z = stiff * 2.0 * (n * (2.0 * h - c2h) + h * c2h) + soft * 2.0 * (both + m * c2h)
        soft_l = 2.0 * h * (1.0 - k_base * e2h) - (1.0 + k * k_base) - (k + k_base) * e2h
        soft_z = 2.0 * (h * (1.0 + k_base * e2h) + m * c2h + n * (k + e2h))
        u_z = stiff * k_base * 2.0 * h * c2h + soft * soft_z
        middle = stiff * k_base * (2.0 * curved - h * h * c2h)
        unit = 0.5
    else:
        s_l = stiff * 2.0 * (n * (c2h + 2.0 * h) + h * c2h) + soft * 2.0 * (both - m * c2h)
        s_z = stiff * 2.0 * ((1.0 + n) * (c2h + 2.0 * h) - h * c2h) + soft * (
            (1.0 + k) * (1.0 + e2h) + 2.0 * h * c2h
        )
        soft_l = 2.0 * (h * (1.0 + k_base * e2h) - m * c2h - n * (k + e2h))
        soft_z = 1.0 + k * k_base + (k + k_base) * e2h + 2.0 * h * (1.0 - k_base * e2h)
        u_z = stiff * k_base * 2.0 * (c2h + both) + soft * soft_z
        middle = -stiff * k_base * h * curved
        unit = -0.5
    unit *= (1.0 + k) * np.exp(-h) / _determinant(h, e2h, c2h, materials)
    middle += soft * (soft_l - 0.5 * h * soft_z)
    return unit * stiff * middle, unit * stiff * u_z, unit * soft * s_l, unit * soft * s_z


@fused
def _thin_state(of_shear: bool, h: float, t: float, materials: Materials) -> StateVector:
    """State at the scaled distance t above the interface for h < 1."""
    middle, u_z, s_l, s_z = _interface(of_shear, h, materials)
    poisson, u_l = materials[0], middle + 0.5 * h * u_z
    p, r, tt = 1.0 / (1.0 - poisson), poisson / (1.0 - poisson), t * t
    rest, above = sinh_rest(tt), cosh_rest(tt)
    sinh, cosh = t + t * tt * rest, 1.0 + tt * above
    linear, cubic = 0.5 * p * t * sinh, 0.5 * p * t * tt * (above - rest)
    along, normal = u_l - s_z, u_z - s_l
    bent = (0.5 * h - t) + 0.5 * h * tt * above - t * tt * rest  # h/2 cosh t − sinh t
    higher_u_l = cosh * middle + bent * u_z + 2.0 * sinh * s_l + linear * along - cubic * normal
    higher_s_z = cosh * s_z + sinh * s_l + linear * along - cubic * normal
    # The terms of S_z in U_z cancel at ν = 1/2, unless they are put together first.
    higher_u_z = (
        (cosh - linear) * u_z
        + (sinh * r + cubic) * u_l
        + linear * s_l
        + (p * (1.0 - 2.0 * poisson) * sinh - cubic) * s_z
    )
    higher_s_l = (cosh + linear) * s_l + (sinh * p + cubic) * u_l - linear * u_z - (sinh * r + cubic) * s_z
    return higher_u_l, higher_u_z, higher_s_l, higher_s_z, (poisson * higher_s_z - higher_u_l) * p


@fused
def _of_amplitudes(plus: float, minus: float, d: float, k: float) -> StateVector:
    """State at the scaled depth d of a half-space over e^(−d), from a₊ and a₋."""
    far = d * minus
    return (
        0.5 * (plus - k * minus) + far,
        0.5 * (plus + k * minus) + far,
        0.5 * (plus - minus) + far,
        0.5 * (plus + minus) + far,
        0.5 * (3.0 * minus - plus) - far,
    )


@fused
def _coated_state(of_shear: bool, h: float, d: float, t: float, materials: Materials) -> StateVector:
    """State at the scaled depth d, the scaled distance t above the interface or −t below it."""
    nu, nu_base, stiff, soft = materials
    k, k_base = 3.0 - 4.0 * nu, 3.0 - 4.0 * nu_base
    if t < 0.0:
        _, _, s_l, s_z = _interface(of_shear, h, materials)
        u_l, u_z, s_l, s_z, along = _of_amplitudes(s_z + s_l, s_z - s_l, -t, k_base)
        scale = np.exp(t)
        return scale * u_l, scale * u_z, scale * s_l, scale * s_z, scale * along
    if h < 1.0:
        return _thin_state(of_shear, h, t, materials)
    rho = (stiff - soft) / (stiff + k * soft)
    sigma = (k_base * stiff - k * soft) / (k_base * stiff + soft)
    e2h = np.exp(-2.0 * h)
    scale = 1.0 / ((1.0 - rho * e2h) * (1.0 - sigma * e2h) - 4.0 * h * h * rho * e2h)
    sign, mixed = (1.0 if of_shear else -1.0), 2.0 * h * rho * e2h
    plus = scale * (sign * mixed - (1.0 - sigma * e2h - 2.0 * h * mixed))
    minus = scale * (sign * (1.0 - rho * e2h) - mixed)
    back_plus, back_minus = -sigma * minus, -rho * (plus + 2.0 * h * minus)
    down = _of_amplitudes(plus, minus, d, k)
    up = _of_amplitudes(back_plus, back_minus, t, k)
    near, far = np.exp(-d), np.exp(-h - t)
    return (
        near * down[0] + far * up[0],
        near * down[1] - far * up[1],
        near * down[2] - far * up[2],
        near * down[3] + far * up[3],
        near * down[4] + far * up[4],
    )


@fused
def _across(h: float, d: float, t: float, materials: Materials) -> tuple[float, float]:
    """P and Q: the stresses of a traction across the wavevector."""
    _, _, stiff, soft = materials
    e2h, c2h = decaying(2.0 * h)
    scale = np.exp(-d) / (soft * (1.0 + e2h) + stiff * c2h)
    if t < 0.0:
        return 2.0 * soft * scale, 2.0 * soft * scale
    e2t, c2t = decaying(2.0 * t)
    return scale * (soft * (1.0 + e2t) + stiff * c2t), scale * (soft * c2t + stiff * (1.0 + e2t))


@fused
def fill_coated_kernels(
    of_shear: bool, q: Any, depth: Any, height: float, materials: Materials, out: Any
) -> None:
    """As `asperity.elasticity.kernels.fill_kernels`, for a coated half-space.

    A depth equal to the height belongs to the coating. V and W are in units of (1 + ν)/(E q) of the material
    at their depth.
    """
    many = depth.size > 1
    for n in range(q.size):
        wavenumber = float(q[n])
        below = depth[n if many else 0]
        d, t, h = wavenumber * below, wavenumber * (height - below), wavenumber * height
        if wavenumber == 0.0:
            values = (0.0, 0.0, 1.0, 1.0, 0.0) if of_shear else (1.0, 0.0, 0.0, 0.0, 0.0)
        elif d > MAX_SCALED_DEPTH:
            values = (0.0, 0.0, 0.0, 0.0, 0.0)
        elif t > BOTTOM_OUT_OF_REACH:
            values = half_space_shear_kernels(d) if of_shear else half_space_kernels(d, materials[0])
        else:
            u_l, u_z, s_l, s_z, along = _coated_state(of_shear, h, d, t, materials)
            if of_shear:
                across, turn = _across(h, d, t, materials)
                values = (s_z, along, -s_l, across, turn)
            else:
                values = (-s_z, -along, -s_l, u_l, -u_z)
        out[0, n], out[1, n], out[2, n], out[3, n], out[4, n] = values


@fused
def fill_coated_compliance(q: Any, height: float, materials: Materials, unit: float, out: Any) -> None:
    """Write the surface compliance of all modes, 0 at q = 0: `unit` is 2/E* of the coating."""
    for n in range(q.size):
        wavenumber = float(q[n])
        h = wavenumber * height
        if wavenumber == 0.0:
            out[n] = 0.0
        elif h > BOTTOM_OUT_OF_REACH:
            out[n] = unit / wavenumber
        else:
            out[n] = unit / wavenumber * coated_compliance(h, materials)
