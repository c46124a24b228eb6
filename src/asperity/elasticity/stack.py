"""Numba kernels of a stack of elastic layers: fields of one mode at any depth, and the surface compliance.

Layers are bonded to each other, on a half-space or on a rigid base. In each of them a mode has a state, with
l along the wavevector and t across it (`asperity.elasticity.loaded_faces`),

    u_l = i U_l/(2 μ q),  u_t = i U_t/(2 μ q),  u_z = U_z/(2 μ q),  σ_lz = i S_l,  σ_tz = i S_t,  σ_zz = S_z.

What lies below an interface allows two of the four U_l, U_z, S_l and S_z to be chosen there. One recursion
carries this space of states upward from the base, and the state at any depth follows downward again. With
h = q height of the layer, d and t the scaled distances from its top and bottom, and k = 3 − 4ν:

* On an interface the space is described by the two components, one of U_l and S_l and one of U_z and S_z, on
  which all four depend with factors of at most one: the base may be rigid, smooth, soft or stiff. There U
  changes by the ratio of the shear moduli.
* For h ≥ 1 a field that decays downward and one that decays upward are superposed. With the sums and
  differences S± = S_z ± S_l and U±, and with a₊ and a₋ the tractions S± of the first field at a depth,

      S₊ = a₊ + b₋,   S₋ = a₋ + b₊,   U₊ = a₊ − k b₋,   U₋ = k a₋ − b₊,
      a₊(d) = e^(−d) (a₊ + 2 d a₋),   a₋(d) = e^(−d) a₋,   likewise b(t).

  The base reflects (b₋, b₊) = −R (a₊, a₋). R is 0 for equal materials, diag(−1/k, −k) over a bonded base,
  −1 off the diagonal over a frictionless one, 1 without a base. On top of the layer it is e^(−2h) Tᵀ R T,
  with T the matrix of a₊ + 2 h a₋ and a₋.
* For h < 1 the states above follow from the states on the interface by the matrix exponential of
  `asperity.elasticity.loaded_faces`. Its elements are accurate one by one.

Antiplane shear is a scalar of the same kind, whose state is the traction S_t and the displacement U_t/2.

Floating point
--------------
All exponentials decay, and differences of close numbers occur only in determinants of two rows, which lose a
factor of about three for each thin layer. A layer whose bottom is out of reach is a half-space.

References
----------
W. T. Thomson, J. Appl. Phys. 21 (1950) 89, DOI 10.1063/1.1699629, for the transfer matrix, which loses
e^(2 q height); B. L. N. Kennett, Seismic Wave Propagation in Stratified Media, 1983, for reflections that are
carried upward; D. M. Burmister, J. Appl. Phys. 16 (1945) 89, DOI 10.1063/1.1707558, for one and two layers.
The choice of the components and the series are new here.
"""

import math
from typing import Any

import numpy as np

from asperity.core.compiled import fused, fused_inlined
from asperity.elasticity.kernels import (
    BONDED,
    FRICTIONLESS,
    HALF_SPACE,
    cosh_rest,
    decaying,
    sinh_rest,
)

Stack = tuple[int, Any, Any, Any, Any]
"""Kind of the base; depths of the bottoms of the layers, and their heights; Poisson's ratio and shear modulus
of each layer and of an elastic base."""

StateVector = tuple[float, float, float, float]
"""U_l, U_z, S_l and S_z of a mode."""

Matrix = tuple[float, float, float, float]
"""Rows one after the other."""

Place = tuple[int, int, bool]
"""Of a depth, see `_placed`."""

MAX_SCALED_DEPTH = 700.0
"""Largest q depth at which kernels are evaluated. Beyond, they are below 1e-300 and are set to 0, because
subnormal numbers are slow."""

BOTTOM_OUT_OF_REACH = 24.0
"""Beyond this q (bottom − depth) the fields of a layer differ from the half-space's by less than 1e-17."""

INTERVALS, DEGREE = 16, 8
"""Intervals of an octave of wavenumbers, and degree of the polynomials on them."""


@fused_inlined
def _product(a: Matrix, b: Matrix) -> Matrix:
    return (
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    )


@fused
def _of_amplitudes(plus: float, minus: float, d: float, k: float) -> StateVector:
    """State at the scaled depth d of a half-space over e^(−d), from a₊ and a₋."""
    far = d * minus
    return (
        0.5 * (plus - k * minus) + far,
        0.5 * (plus + k * minus) + far,
        0.5 * (plus - minus) + far,
        0.5 * (plus + minus) + far,
    )


@fused
def _raising(t: float, poisson: float) -> tuple[float, ...]:
    """Elements of the matrix exponential that raises a state by the scaled distance t < 1."""
    p, r, tt = 1.0 / (1.0 - poisson), poisson / (1.0 - poisson), t * t
    rest, above = sinh_rest(tt), cosh_rest(tt)
    sinh, cosh = t + t * tt * rest, 1.0 + tt * above
    linear, cubic = 0.5 * p * t * sinh, 0.5 * p * t * tt * (above - rest)
    return (
        cosh + linear,
        cosh - linear,
        sinh + cubic,
        2.0 * sinh + cubic,
        p * sinh + cubic,
        r * sinh + cubic,
        p * (1.0 - 2.0 * poisson) * sinh - cubic,
        linear,
        cubic,
    )


@fused_inlined
def _raised(by: tuple[float, ...], state: StateVector) -> StateVector:
    u_l, u_z, s_l, s_z = state
    more, less, sinh, twice, of_p, of_r, squeezed, linear, cubic = by
    return (
        more * u_l - sinh * u_z + twice * s_l - linear * s_z,
        less * u_z + of_r * u_l + linear * s_l + squeezed * s_z,
        more * s_l + of_p * u_l - linear * u_z - of_r * s_z,
        less * s_z + sinh * s_l + linear * u_l - cubic * u_z,
    )


@fused
def _in_components(first: StateVector, second: StateVector) -> tuple[StateVector, StateVector, Matrix]:
    """States of which one component along l, and one along z, is 1 or 0, and their amounts of the given ones.

    The components are those with the largest determinant: all others are at most 1.
    """
    ul1, uz1, sl1, sz1 = first
    ul2, uz2, sl2, sz2 = second
    of_u = max(abs(ul1 * uz2 - ul2 * uz1), abs(ul1 * sz2 - ul2 * sz1))
    of_s = max(abs(sl1 * uz2 - sl2 * uz1), abs(sl1 * sz2 - sl2 * sz1))
    takes_u_l = of_u >= of_s
    a1, a2, c1, c2 = (ul1, ul2, sl1, sl2) if takes_u_l else (sl1, sl2, ul1, ul2)
    takes_u_z = abs(a1 * uz2 - a2 * uz1) >= abs(a1 * sz2 - a2 * sz1)
    b1, b2, e1, e2 = (uz1, uz2, sz1, sz2) if takes_u_z else (sz1, sz2, uz1, uz2)
    scale = 1.0 / (a1 * b2 - a2 * b1)
    c1, c2 = scale * (c1 * b2 - c2 * b1), scale * (a1 * c2 - a2 * c1)
    e1, e2 = scale * (e1 * b2 - e2 * b1), scale * (a1 * e2 - a2 * e1)
    ul1, ul2, sl1, sl2 = (1.0, 0.0, c1, c2) if takes_u_l else (c1, c2, 1.0, 0.0)
    uz1, uz2, sz1, sz2 = (0.0, 1.0, e1, e2) if takes_u_z else (e1, e2, 0.0, 1.0)
    amounts = scale * b2, -scale * a2, -scale * b1, scale * a1
    return (ul1, uz1, sl1, sz1), (ul2, uz2, sl2, sz2), amounts


@fused
def _through(
    h: float, poisson: float, first: StateVector, second: StateVector
) -> tuple[StateVector, StateVector, Matrix, Matrix]:
    """States on top of a layer with h ≥ 1 under a₊ = 1 and a₋ = 1, their parts, and R.

    The parts are the amounts of the given states on its bottom.
    """
    k, e, g = 3.0 - 4.0 * poisson, np.exp(-h), 2.0 * h
    ul1, uz1, sl1, sz1 = first
    ul2, uz2, sl2, sz2 = second
    plus1, minus1 = k * (sz1 + sl1) + (uz1 + ul1), (sz1 - sl1) + (uz1 - ul1)
    plus2, minus2 = k * (sz2 + sl2) + (uz2 + ul2), (sz2 - sl2) + (uz2 - ul2)
    scale = 1.0 / (plus1 * minus2 - plus2 * minus1)
    inverse = scale * minus2, -scale * plus2, -scale * minus1, scale * plus1
    back = (
        (uz1 + ul1) - (sz1 + sl1),
        (uz2 + ul2) - (sz2 + sl2),
        (uz1 - ul1) - k * (sz1 - sl1),
        (uz2 - ul2) - k * (sz2 - sl2),
    )
    reflected = _product(back, inverse)
    p, pq, qp, q = reflected
    p, pq, qp, q = e * e * p, e * e * (pq + g * p), e * e * (qp + g * p), e * e * (q + g * (pq + qp + g * p))
    # Rows of S₊, S₋, U₊ and U₋ are (1 − p, −pq), (−qp, 1 − q), (1 + k p, k pq) and (qp, k + q).
    top1 = 0.5 * (1.0 + k * p - qp), 0.5 * (1.0 + k * p + qp), 0.5 * (1.0 - p + qp), 0.5 * (1.0 - p - qp)
    top2 = 0.5 * (k * pq - k - q), 0.5 * (k * pq + k + q), 0.5 * (q - 1.0 - pq), 0.5 * (1.0 - q - pq)
    scale = e * (1.0 + k)
    amounts = (
        scale * inverse[0],
        scale * (inverse[1] + g * inverse[0]),
        scale * inverse[2],
        scale * (inverse[3] + g * inverse[2]),
    )
    return top1, top2, amounts, reflected


@fused_inlined
def _placed(q: float, depth: float, stack: Stack) -> tuple[int, int, bool]:
    """Number of layers above a depth and of those that influence it, and whether their base is rigid.

    Without a rigid base they lie on a half-space as far as the depth is concerned.
    """
    kind, bottoms = stack[0], stack[1]
    place, last = 0, 0
    while place < bottoms.size and depth > bottoms[place]:
        place += 1
    while last < bottoms.size and q * (bottoms[last] - depth) < BOTTOM_OUT_OF_REACH:
        last += 1
    return place, last, last == bottoms.size and kind != HALF_SPACE


@fused
def _mode(of_shear: bool, q: float, depth: float, placed: Place, stack: Stack) -> StateVector:
    """State at a depth under S_z = −1 or S_l = −1 at the top."""
    kind, bottoms, heights, poisson, shear = stack
    place, last, rigid = placed
    of_l, of_z = (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)  # a free bottom
    if not rigid:
        m = 1.0 - 2.0 * poisson[last]
        of_l, of_z = (1.0 + m, -m, 1.0, 0.0), (-m, 1.0 + m, 0.0, 1.0)
    elif kind == BONDED:
        of_l, of_z = (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    elif kind == FRICTIONLESS:
        of_z = 0.0, 0.0, 0.0, 1.0
    bottom_l, bottom_z, reflected, alike = of_l, of_z, (0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 1.0)
    on_bottom = down = alike  # from amounts of the present states to amounts in the layer of the depth
    for number in range(last - 1, -1, -1):
        if number < last - 1 or not rigid:
            ratio = shear[number] / shear[number + 1]
            of_l = ratio * of_l[0], ratio * of_l[1], of_l[2], of_l[3]
            of_z = ratio * of_z[0], ratio * of_z[1], of_z[2], of_z[3]
        of_l, of_z, amounts = _in_components(of_l, of_z)
        if number < place:
            down = _product(down, amounts)
        elif number == place:
            bottom_l, bottom_z = of_l, of_z
        h = q * heights[number]
        if h < 1.0:
            by = _raising(h, poisson[number])
            of_l, of_z = _raised(by, of_l), _raised(by, of_z)
        else:
            of_l, of_z, amounts, back = _through(h, poisson[number], of_l, of_z)
            if number < place:
                down = _product(down, amounts)
            elif number == place:
                on_bottom, reflected = amounts, back
    # Amounts of both states under the traction, and of those in the layer of the depth.
    scale = 1.0 / (of_l[2] * of_z[3] - of_z[2] * of_l[3])
    first, second = (-of_z[3], of_l[3]) if of_shear else (of_z[2], -of_l[2])
    first, second = (
        scale * (down[0] * first + down[1] * second),
        scale * (down[2] * first + down[3] * second),
    )
    k, d = 3.0 - 4.0 * poisson[place], q * (depth - (bottoms[place - 1] if place else 0.0))
    if place >= last and not rigid:
        found, decay = _of_amplitudes(second + first, second - first, d, k), np.exp(-d)
        return decay * found[0], decay * found[1], decay * found[2], decay * found[3]
    h, t = q * heights[place], max(q * (bottoms[place] - depth), 0.0)
    if t < 1.0:  # also in a thick layer: next to a rigid or stiff base displacements do not cancel
        first, second = (
            on_bottom[0] * first + on_bottom[1] * second,
            on_bottom[2] * first + on_bottom[3] * second,
        )
        state = (
            first * bottom_l[0] + second * bottom_z[0],
            first * bottom_l[1] + second * bottom_z[1],
            first * bottom_l[2] + second * bottom_z[2],
            first * bottom_l[3] + second * bottom_z[3],
        )
        return _raised(_raising(t, poisson[place]), state)
    near, far = np.exp(-d), np.exp(-h - t)
    lowest = first + 2.0 * h * second
    minus = -(reflected[0] * lowest + reflected[1] * second)
    plus = -(reflected[2] * lowest + reflected[3] * second)
    below = _of_amplitudes(first, second, d, k)
    above = _of_amplitudes(plus, minus, t, k)
    return (
        near * below[0] + far * above[0],
        near * below[1] - far * above[1],
        near * below[2] - far * above[2],
        near * below[3] + far * above[3],
    )


@fused
def _across(q: float, depth: float, placed: Place, stack: Stack) -> tuple[float, float]:
    """Stresses σ_tz and σ_lt, over i, at a depth under a unit traction across the wavevector."""
    bottoms, heights, shear = stack[1], stack[2], stack[4]
    place, last, rigid = placed
    s, u, down = 1.0, 0.0 if rigid else 1.0, 1.0
    on_bottom, along = s, u
    for number in range(last - 1, -1, -1):
        if number < last - 1 or not rigid:
            u *= shear[number] / shear[number + 1]
        if number == place:
            on_bottom, along = s, u
        decay, rest = decaying(q * heights[number])
        e2h, c2h = decay * decay, rest * (1.0 + decay)
        higher = s * (1.0 + e2h) + u * c2h
        if number <= place:
            down *= (2.0 * decay * s if number < place else 1.0) / higher
        s, u = 1.0, (u * (1.0 + e2h) + s * c2h) / higher
    d = q * (depth - (bottoms[place - 1] if place else 0.0))
    if place >= last and not rigid:
        return down * np.exp(-d), down * np.exp(-d)
    e2t, c2t = decaying(2.0 * max(q * (bottoms[place] - depth), 0.0))
    down *= np.exp(-d)
    return down * (on_bottom * (1.0 + e2t) + along * c2t), down * (along * (1.0 + e2t) + on_bottom * c2t)


@fused
def fill_kernels(of_shear: bool, q: Any, depth: Any, stack: Stack, out: Any) -> None:
    """Write the kernels of a pressure or a shear traction to the rows of `out`, for all modes.

    There is one depth for all modes or one for each. A depth equal to the bottom of a layer belongs to it. V
    and W are in units of (1 + ν)/(E q) of the material at their depth.
    """
    many, poisson = depth.size > 1, stack[3]
    for n in range(q.size):
        wavenumber, below = float(q[n]), depth[n if many else 0]
        if wavenumber == 0.0:
            values = (0.0, 0.0, 1.0, 1.0, 0.0) if of_shear else (1.0, 0.0, 0.0, 0.0, 0.0)
        elif wavenumber * below > MAX_SCALED_DEPTH:
            values = (0.0, 0.0, 0.0, 0.0, 0.0)
        else:
            placed = _placed(wavenumber, below, stack)
            nu = poisson[placed[0]]
            u_l, u_z, s_l, s_z = _mode(of_shear, wavenumber, below, placed, stack)
            along = (nu * s_z - u_l) / (1.0 - nu)
            if of_shear:
                across, turn = _across(wavenumber, below, placed, stack)
                values = (s_z, along, -s_l, across, turn)
            else:
                values = (-s_z, -along, -s_l, u_l, -u_z)
        out[0, n], out[1, n], out[2, n], out[3, n], out[4, n] = values


def fill_interpolated(of_shear: bool, q: Any, depth: Any, stack: Stack, out: Any) -> None:
    """As `fill_kernels` at one depth, to rounding, in a time that hardly depends on the number of layers.

    Every octave of wavenumbers is divided into `INTERVALS`, on which polynomials interpolate the kernels over
    e^(−q depth): functions of q without poles near the real axis.
    """
    wavenumbers = q[q > 0].astype(float)
    first = _interval(float(wavenumbers.min()))[0]
    intervals = np.arange(first, _interval(float(wavenumbers.max()))[0] + 1)
    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    octave, part = np.divmod(intervals[:, None], INTERVALS)
    at = np.ldexp(0.5 + (part + 0.5 + 0.5 * nodes) / (2 * INTERVALS), octave)
    values = np.empty((5, at.size))
    fill_kernels(of_shear, at.ravel(), depth, stack, values)
    values *= np.exp(np.minimum(at.ravel() * depth, MAX_SCALED_DEPTH))
    powers = np.linalg.inv(np.vander(nodes, increasing=True))
    table = np.ascontiguousarray(np.einsum("kn,rin->ikr", powers, values.reshape(5, *at.shape)))
    _fill_from_table(of_shear, q, float(depth[0]), first, table, out)


@fused_inlined
def _interval(wavenumber: float) -> tuple[int, float]:
    """Number of the interval of a wavenumber, and its place there from −1 to 1."""
    mantissa, octave = math.frexp(wavenumber)
    place = (mantissa - 0.5) * (2 * INTERVALS)
    number = int(place)
    return octave * INTERVALS + number, 2.0 * (place - number) - 1.0


@fused
def _fill_from_table(of_shear: bool, q: Any, depth: float, first: int, table: Any, out: Any) -> None:
    for n in range(q.size):
        wavenumber = float(q[n])
        if wavenumber == 0.0:
            values = (0.0, 0.0, 1.0, 1.0, 0.0) if of_shear else (1.0, 0.0, 0.0, 0.0, 0.0)
        else:
            number, x = _interval(wavenumber)
            row, decay = table[number - first], np.exp(-wavenumber * depth)
            a, b, c, d, e = row[DEGREE]
            for k in range(DEGREE - 1, -1, -1):
                a, b, c = a * x + row[k, 0], b * x + row[k, 1], c * x + row[k, 2]
                d, e = d * x + row[k, 3], e * x + row[k, 4]
            values = a * decay, b * decay, c * decay, d * decay, e * decay
        out[0, n], out[1, n], out[2, n], out[3, n], out[4, n] = values
