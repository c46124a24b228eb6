"""The elastic layer and the half-space: surface compliance, and stress and displacement over depth.

Conventions
-----------
The solid fills ``0 ≤ z ≤ height`` with z up, and ``depth = height − z ≥ 0`` is measured downward from the
loaded top. A field is a sum of modes exp(+i (qx x + qy y)), as in `asperity.spectral`. Tension is positive,
the contact pressure p ≥ 0 is compressive: σ_zz = −p and no shear at the top. Everything is per unit p̂(q).
Stress components are ordered as in `COMPONENTS`, displacements as x, y, z (upward). The effective modulus
is E* = E / (1 − ν²).

Five real kernels of (q, depth) hold everything a pressure mode does. With l along q and t across it,

    σ_zz = −p Z,   σ_ll = −p L,   σ_tt = −p ν (Z + L),   σ_lz = −i p T,
    u_l = i p (1 + ν)/(E q) V,    u_z = −p (1 + ν)/(E q) W,    u_t = σ_lt = σ_tz = 0.

In a half-space, with d = q depth, Z = (1 + d) e^(−d), L = (1 − d) e^(−d), T = d e^(−d).

The mode q = 0
--------------
It is uniform pressure on a cell that is repeated sideways. Its stress and displacement depend on what the
repetition does, which is the choice `Layer.lateral`: ``"confined"`` (no lateral strain) or ``"free"`` (no
mean lateral stress). It is not the limit q → 0, and a half-space has no finite uniform displacement: there,
and for a free bottom, displacement and compliance are 0 at q = 0 by rule. `Layer.kernels` gives 1 for Z and
0 for the others at q = 0.

The Nyquist rule
----------------
A function of (qx, qy) cannot know the grid. `Layer.grid_stress` and `Layer.grid_displacement` evaluate all
stored modes of a `Grid` and set what is odd in a Nyquist wavevector to zero.

Precision
---------
q, depth and the result may be float32 or float64. Numbers are held in double precision only inside the loop
over the modes; the loops use scaled exponentials and, where terms cancel, series, and are accurate for every
q · height and every Poisson's ratio above −1 up to and including 1/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, DTypeLike

from asperity.spectral import REAL_TYPES, Grid
from asperity.types import Array

COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")
BOTTOMS = ("bonded", "frictionless", "free")
LATERALS = ("confined", "free")

_HALF_SPACE, _BONDED, _FRICTIONLESS, _FREE = range(4)


class Kernels(NamedTuple):
    """Real kernels of a pressure mode, each of the shape of q and depth broadcast.

    Attributes
    ----------
    normal, longitudinal, shear : array
        Z, L and T: stresses per unit pressure.
    displacement_longitudinal, displacement_normal : array
        V and W: displacements in units of (1 + ν)/(E q) per unit pressure.
    """

    normal: Array
    longitudinal: Array
    shear: Array
    displacement_longitudinal: Array
    displacement_normal: Array


@dataclass(frozen=True)
class Effective:
    """The simplest solid that a tolerance allows, and why.

    Attributes
    ----------
    layer : Layer
        The layer asked about, or the half-space of the same material.
    bound : float
        The larger of the two bounds below; 0 for a half-space.
    compliance_bound : float
        Proven largest relative difference of the surface compliance, over all q ≥ q_min.
    stress_bound : float
        Proven largest difference of any stress at any depth, relative to the pressure amplitude of the mode.
    tolerance : float
    reason : str
        One sentence for a record.
    """

    layer: Layer
    bound: float
    compliance_bound: float
    stress_bound: float
    tolerance: float
    reason: str


@dataclass(frozen=True)
class Layer:
    """An isotropic linear elastic layer, or the half-space.

    Parameters
    ----------
    young : float
        Young's modulus E > 0.
    poisson : float
        Poisson's ratio, −1 < ν ≤ 1/2.
    height : float, optional
        Of the layer; without it the half-space.
    bottom : "bonded" | "frictionless" | "free"
        Bottom face: no displacement; no normal displacement and no shear; no traction. Without meaning
        for the half-space.
    lateral : "confined" | "free"
        The uniform mode, see the module.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range or not a number.
    """

    young: float
    poisson: float
    height: float | None = None
    bottom: str = "bonded"
    lateral: str = "confined"

    def __post_init__(self) -> None:
        young = _number("young", self.young, "a finite number > 0")
        if not (np.isfinite(young) and young > 0):
            raise ValueError(f"young = {self.young!r}: a finite number > 0 is needed")
        poisson = _number("poisson", self.poisson, "a number > -1 and ≤ 0.5")
        if not -1 < poisson <= 0.5:
            raise ValueError(f"poisson = {self.poisson!r}: a number > -1 and ≤ 0.5 is needed")
        object.__setattr__(self, "young", young)
        object.__setattr__(self, "poisson", poisson)
        if self.height is not None:
            height = _number("height", self.height, "a finite length > 0, or None for the half-space,")
            if not (np.isfinite(height) and height > 0):
                raise ValueError(
                    f"height = {self.height!r}: a finite length > 0, or None for the half-space, is needed"
                )
            object.__setattr__(self, "height", height)
        for name, value, known in (("bottom", self.bottom, BOTTOMS), ("lateral", self.lateral, LATERALS)):
            if value not in known:
                raise ValueError(f"{name} = {value!r}: one of {', '.join(known)} is needed")

    @property
    def effective_modulus(self) -> float:
        """E* = E / (1 − ν²)."""
        return self.young / ((1 - self.poisson) * (1 + self.poisson))

    @property
    def _kind(self) -> int:
        if self.height is None:
            return _HALF_SPACE
        return {"bonded": _BONDED, "frictionless": _FRICTIONLESS, "free": _FREE}[self.bottom]

    def surface_compliance(self, q: ArrayLike) -> Array:
        """Downward surface displacement per unit pressure mode, G_zz(q).

        Parameters
        ----------
        q : array
            Wavenumbers |q| ≥ 0, float32 or float64 (anything else becomes float64).

        Returns
        -------
        compliance : array
            Length per pressure, of the shape and type of q; 2 / (E* q) for the half-space. At q = 0 that of
            `uniform_compliance`.

        Raises
        ------
        ValueError
            If a wavenumber is negative or not finite.
        """
        q = _wavenumbers(q)
        out = np.empty(q.shape, q.dtype)
        _fill_compliance(
            self._kind,
            q.reshape(-1),
            self.height or 0.0,
            self.poisson,
            2 / self.effective_modulus,
            self.uniform_compliance(),
            out.reshape(-1),
        )
        return out

    def uniform_compliance(self) -> float:
        """Downward surface displacement per unit mean pressure: height / C11 if laterally confined,
        height / E if free; 0 by rule for the half-space and the free bottom, where it is not defined.
        """
        if self._kind in (_HALF_SPACE, _FREE):
            return 0.0
        assert self.height is not None
        nu = self.poisson
        ratio = (1 + nu) * (1 - 2 * nu) / (1 - nu) if self.lateral == "confined" else 1.0
        return ratio * self.height / self.young

    def uniform_stress(self) -> Array:
        """Stress of the mode q = 0 per unit mean pressure, (6,): the same at every depth."""
        lateral = -self.poisson / (1 - self.poisson) if self.lateral == "confined" else 0.0
        return np.array([lateral, lateral, -1.0, 0.0, 0.0, 0.0])

    def uniform_displacement(self, depth: ArrayLike) -> Array:
        """Upward displacement of the mode q = 0 per unit mean pressure; −`uniform_compliance` at the top."""
        depth = self._depths(depth)
        if self.height is None:
            return np.zeros(depth.shape)
        return -self.uniform_compliance() * (self.height - depth) / self.height

    def kernels(self, q: ArrayLike, depth: ArrayLike) -> Kernels:
        """The five real kernels of a pressure mode, see the module.

        Parameters
        ----------
        q : array
            Wavenumbers |q| ≥ 0, float32 or float64 (anything else becomes float64).
        depth : array
            Depths from 0 to the height, broadcast against q.

        Returns
        -------
        Kernels
            Arrays of the broadcast shape and the type of q.

        Raises
        ------
        ValueError
            If a wavenumber or a depth is out of range, the shapes do not match, or the bottom is free.
        """
        self._supported("kernels")
        q = _wavenumbers(q)
        depth = self._depths(depth)
        shape = _broadcast_shape(q=q, depth=depth)
        out = np.empty((5, *shape), q.dtype)
        one_depth = depth.size == 1
        _fill_kernels(
            self._kind,
            np.broadcast_to(q, shape).reshape(-1),
            depth.reshape(-1) if one_depth else np.broadcast_to(depth, shape).reshape(-1),
            self.height or 0.0,
            self.poisson,
            out.reshape(5, -1),
        )
        return Kernels(*out)

    def stress(self, qx: ArrayLike, qy: ArrayLike, depth: ArrayLike) -> Array:
        """Stress of a unit pressure mode p̂(q) = 1.

        Parameters
        ----------
        qx, qy : array
            Components of the wavevector.
        depth : array
            Depths from 0 to the height, broadcast against them.

        Returns
        -------
        stress : (..., 6) complex array
            Components as in `COMPONENTS`; complex64 if qx and qy are float32. At q = 0 `uniform_stress`.
        """
        constant, slope = self.stress_split(qx, qy, depth)
        slope *= self.poisson
        constant += slope
        uniform = np.broadcast_to(np.hypot(np.asarray(qx), np.asarray(qy)) == 0, constant.shape[:-1])
        constant[uniform] = self.uniform_stress()
        return constant

    def stress_split(self, qx: ArrayLike, qy: ArrayLike, depth: ArrayLike) -> tuple[Array, Array]:
        """Parts A and B of the stress A + ν B of a unit pressure mode.

        For the half-space and the frictionless bottom both are the same for every Poisson's ratio, so that
        one set of eight transforms (A and the xx, yy and xy components of B, the others being 0;
        A_xx + A_yy + A_zz = B_xx + B_yy) serves all. The uniform mode is left out: at q = 0 the only
        component is A_zz = −1, and ν/(1 − ν) is not linear. For a bonded bottom A and B depend on ν.

        Returns
        -------
        constant, slope : (..., 6) complex arrays
            A and B.
        """
        q, cosine, sine, kind = _polar(qx, qy)
        k = self.kernels(q, depth)
        shape = k.normal.shape
        both = k.normal + k.longitudinal
        constant = np.zeros((*shape, 6), kind)
        slope = np.zeros((*shape, 6), kind)
        constant[..., 0] = -(cosine**2) * k.longitudinal
        constant[..., 1] = -(sine**2) * k.longitudinal
        constant[..., 2] = -k.normal
        constant[..., 3] = -1j * sine * k.shear
        constant[..., 4] = -1j * cosine * k.shear
        constant[..., 5] = -cosine * sine * k.longitudinal
        slope[..., 0] = -(sine**2) * both
        slope[..., 1] = -(cosine**2) * both
        slope[..., 5] = cosine * sine * both
        return constant, slope

    def displacement(self, qx: ArrayLike, qy: ArrayLike, depth: ArrayLike) -> Array:
        """Displacement of a unit pressure mode p̂(q) = 1; arguments as for `stress`.

        Returns
        -------
        displacement : (..., 3) complex array
            Components x, y, z (upward), length per pressure. At q = 0 `uniform_displacement` along z.
        """
        q, cosine, sine, kind = _polar(qx, qy)
        k = self.kernels(q, depth)
        shape = k.normal.shape
        q = np.broadcast_to(q, shape)
        uniform = q == 0
        unit = (1 + self.poisson) / self.young / np.where(uniform, 1.0, q)
        out = np.zeros((*shape, 3), kind)
        out[..., 0] = 1j * cosine * unit * k.displacement_longitudinal
        out[..., 1] = 1j * sine * unit * k.displacement_longitudinal
        normal = -unit * k.displacement_normal
        out[..., 2] = np.where(uniform, self.uniform_displacement(depth), normal)
        return out

    def compliance(self, qx: ArrayLike, qy: ArrayLike) -> Array:
        """Displacements of both faces per traction on both faces: Eq. A.1 with its misprints corrected.

        The displacements (x, y, z at the top, x, y, z at the bottom) follow from the tractions t = σ·n with
        the *outward* normal n at both faces, in the same order; a pressure p is t_z = −p. The matrix is
        Hermitian and positive definite. It knows no support: `bottom` has no influence.

        Parameters
        ----------
        qx, qy : array
            Components of the wavevector.

        Returns
        -------
        compliance : (..., 6, 6) complex array
            Length per pressure. For the half-space the limit of a tall layer: the faces do not feel each
            other. At q = 0, where a layer moves as a rigid body, 0 by rule.

        Notes
        -----
        `layer.compliance(qx, qy)[..., 2, 2]` is the `surface_compliance` of a free bottom.
        """
        q, cosine, sine, kind = _polar(qx, qy)
        flat = q.reshape(-1)
        elements = np.empty((8, flat.size))
        _fill_face_compliance(flat, self.height or 0.0, self.height is None, self.poisson, elements)
        elements *= (1 + self.poisson) / self.young
        ll, ll_far, tt, tt_far, zz, zz_far, lz, lz_far = elements.reshape(8, *q.shape)
        out = np.zeros((*q.shape, 6, 6), kind)
        for row, column, along, across, mixed, normal, sign in (
            (0, 0, ll, tt, lz, zz, 1),
            (3, 3, ll, tt, lz, zz, -1),
            (0, 3, ll_far, tt_far, lz_far, zz_far, 1),
            (3, 0, ll_far, tt_far, lz_far, zz_far, -1),
        ):
            far = row != column
            out[..., row, column] = cosine**2 * along + sine**2 * across
            out[..., row + 1, column + 1] = sine**2 * along + cosine**2 * across
            out[..., row, column + 1] = out[..., row + 1, column] = cosine * sine * (along - across)
            out[..., row, column + 2] = 1j * sign * cosine * mixed
            out[..., row + 1, column + 2] = 1j * sign * sine * mixed
            back = sign if far else -sign
            out[..., row + 2, column] = 1j * back * cosine * mixed
            out[..., row + 2, column + 1] = 1j * back * sine * mixed
            out[..., row + 2, column + 2] = normal
        return out

    def grid_surface_compliance(self, grid: Grid, dtype: DTypeLike = "float64") -> Array:
        """`surface_compliance` of every stored mode of a grid, (ny, nx // 2 + 1).

        Rows of equal |qy| are evaluated once.
        """
        return mirror_rows(self.surface_compliance(_half_wavenumber(grid, dtype)), grid)

    def grid_kernels(self, grid: Grid, depth: float, dtype: DTypeLike = "float64") -> Kernels:
        """`kernels` of the rows 0 ≤ ky ≤ ny/2 of a grid, (ny // 2 + 1, nx // 2 + 1) at one depth.

        The row of −ky is that of ky: `mirror_rows` gives all stored rows.
        """
        return self.kernels(_half_wavenumber(grid, dtype), float(depth))

    def grid_stress(self, grid: Grid, depth: float, dtype: DTypeLike = "float64") -> Array:
        """`stress` of every stored mode of a grid with the Nyquist rule, (ny, nx // 2 + 1, 6)."""
        qx, qy = grid.qx[None, :].astype(dtype), grid.qy[:, None].astype(dtype)
        out = self.stress(qx, qy, float(depth))
        x, y = _nyquist(grid)
        out[:, x, 4] = 0.0
        out[:, x, 5] = 0.0
        out[y, :, 3] = 0.0
        out[y, :, 5] = 0.0
        return out

    def grid_displacement(self, grid: Grid, depth: float, dtype: DTypeLike = "float64") -> Array:
        """`displacement` of every stored mode of a grid with the Nyquist rule, (ny, nx // 2 + 1, 3)."""
        qx, qy = grid.qx[None, :].astype(dtype), grid.qy[:, None].astype(dtype)
        out = self.displacement(qx, qy, float(depth))
        x, y = _nyquist(grid)
        out[:, x, 0] = 0.0
        out[y, :, 1] = 0.0
        return out

    def effective(self, q_min: float, tolerance: float) -> Effective:
        """The half-space, if no mode with q ≥ q_min can tell it from this layer; else the layer itself.

        Parameters
        ----------
        q_min : float
            Smallest wavenumber with a pressure: 2π over the longer edge of the cell.
        tolerance : float
            Largest difference that does not matter, of both kinds in `Effective`.

        Raises
        ------
        ValueError
            If q_min ≤ 0 or the tolerance is negative.

        Notes
        -----
        With h = q height, d = q depth, t = h − d, a kernel of the layer is e^(−d) (k H + N)/(k + D): H is
        that of the half-space, k = 3 − 4ν (1 if frictionless), N and D hold powers of e^(−2t) and e^(−2h).
        The terms of N in e^(−2t) are linear in t, and the maximum of their part of the difference over t is
        taken in closed form; the terms in e^(−2h) are bounded by their absolute values. The uniform mode is
        left out: its stress is the same in both solids, and its displacement shifts the approach alone.
        """
        for name, value in (("q_min", q_min), ("tolerance", tolerance)):
            if not np.isfinite(value) or value < 0 or (name == "q_min" and value == 0):
                accepted = "> 0" if name == "q_min" else "≥ 0"
                raise ValueError(f"{name} = {value!r}: a finite number {accepted} is needed")
        if self.height is None:
            return Effective(self, 0.0, 0.0, 0.0, tolerance, "the half-space was asked for")
        if self._kind == _FREE:
            return Effective(
                self, np.inf, np.inf, np.inf, tolerance, "a free layer has no support; no bound is known"
            )
        h = float(q_min) * self.height
        compliance = _compliance_bound(h, self.poisson, self._kind)
        stress = _stress_bound(h, self.poisson, self._kind)
        bound = max(compliance, stress)
        differ = (
            f"for q·height ≥ {h:.4g} the surface compliance of the layer and of the half-space differ by at "
            f"most {compliance:.2g} of its value, the stress by at most {stress:.2g} of a mode's pressure"
        )
        if bound <= tolerance:
            half_space = replace(self, height=None)
            reason = f"half-space: {differ}, within the tolerance {tolerance:g}"
            return Effective(half_space, bound, compliance, stress, tolerance, reason)
        reason = f"layer: {differ}, beyond the tolerance {tolerance:g}"
        return Effective(self, bound, compliance, stress, tolerance, reason)

    def _supported(self, what: str) -> None:
        if self._kind == _FREE:
            raise ValueError(
                f"bottom = {self.bottom!r}: {what} need a support; a free layer has its compliances only"
            )

    def _depths(self, depth: ArrayLike) -> Array:
        try:
            values = np.asarray(depth)
            single = values.dtype == np.float32
            values = values.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise TypeError(f"depth = {depth!r}: real numbers are needed") from error
        limit = np.inf if self.height is None else self.height
        # A depth equal to the height may have been rounded up, in its own precision.
        slack = limit * (1 + 4 * np.finfo(np.float32 if single else np.float64).eps)
        wrong = ~((values >= 0) & (values <= slack) & np.isfinite(values))
        if wrong.any():
            raise ValueError(f"depth = {values[wrong].flat[0]!r}: a finite depth from 0 to {limit} is needed")
        return np.minimum(values, limit)


def mirror_rows(values: Array, grid: Grid) -> Array:
    """All stored rows, (ny, ...), from those of 0 ≤ ky ≤ ny/2 of something even in qy."""
    return values[np.abs(grid.ky)]


def _number(name: str, value: Any, accepted: str) -> float:
    if isinstance(value, (bool, str)) or not np.isscalar(value) or np.iscomplexobj(value):
        raise TypeError(f"{name} = {value!r}: {accepted} is needed")
    return float(cast(float, value))


def _wavenumbers(q: ArrayLike) -> Array:
    values = _real("q", q)
    wrong = ~((values >= 0) & np.isfinite(values))
    if wrong.any():
        raise ValueError(f"q = {values[wrong].flat[0]!r}: finite wavenumbers ≥ 0 are needed")
    return values


def _real(name: str, values: ArrayLike) -> Array:
    array = np.asarray(values)
    if array.dtype in REAL_TYPES:
        return array
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {values!r}: real numbers are needed")
    return array.astype(np.float64)


def _broadcast_shape(**arrays: Array) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(a.shape for a in arrays.values()))
    except ValueError as error:
        shapes = ", ".join(f"{name} {a.shape}" for name, a in arrays.items())
        raise ValueError(f"shapes {shapes} cannot be broadcast together") from error


def _polar(qx: ArrayLike, qy: ArrayLike) -> tuple[Array, Array, Array, np.dtype[Any]]:
    """|q| and its direction in double precision, and the complex type of the result."""
    x, y = _real("qx", qx), _real("qy", qy)
    kind = np.result_type(x.dtype, y.dtype, np.complex64)
    _broadcast_shape(qx=x, qy=y)
    for name, values in (("qx", x), ("qy", y)):
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name} = {values[~np.isfinite(values)].flat[0]!r}: finite numbers are needed")
    x, y = x.astype(np.float64), y.astype(np.float64)
    q = np.hypot(x, y)
    safe = np.where(q == 0, 1.0, q)
    return q, x / safe, y / safe, kind


def _half_wavenumber(grid: Grid, dtype: DTypeLike) -> Array:
    rows = grid.shape[0] // 2 + 1
    return np.hypot(np.abs(grid.qy[:rows, None]), grid.qx[None, :]).astype(dtype)


def _nyquist(grid: Grid) -> tuple[Array, Array]:
    """Numbers of the Nyquist columns and rows, at most one each."""
    return np.flatnonzero(2 * grid.kx == grid.shape[1]), np.flatnonzero(2 * grid.ky == grid.shape[0])


def _compliance_bound(h: float, poisson: float, kind: int) -> float:
    """Largest relative difference of the surface compliance from the half-space's for q height ≥ h."""
    h = max(h, 1e-12)
    e2h, c2h = np.exp(-2 * h), -np.expm1(-2 * h)
    if kind == _FRICTIONLESS:
        return float(e2h * (2 + 4 * h) / (c2h * (1 + e2h)))
    k, m1 = 3 - 4 * poisson, 2 - 2 * poisson
    # h + h² times its exponential is largest at h = 1.6.
    reach = max(h, 1.6)
    return float((2 * k * e2h + 4 * m1**2 * e2h + 4 * (reach + reach**2) * np.exp(-2 * reach)) / (k * c2h**2))


def _stress_bound(h: float, poisson: float, kind: int) -> float:
    """Largest difference of a stress from the half-space's at any depth for q height ≥ h."""
    h = max(h, 1e-12)
    nu = poisson
    m, m1, k = 1 - 2 * nu, 2 - 2 * nu, 3 - 4 * nu
    e2h, c2h = np.exp(-2 * h), -np.expm1(-2 * h)
    if kind == _FRICTIONLESS:
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


# Scalar functions of h = q height, t = q (height − depth), d = q depth. Hyperbolic products are in units of
# e^(2h − d)/4: "ch", "sh", "cd", "sd" below.


# Contraction to fused multiply-adds keeps every rule for special values.
_compiled = njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})
# Into the loops that call them, which then compile to vectors.
_inlined = njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"}, forceinline=True)


@_compiled
def _decay(x: float) -> tuple[float, float]:
    """e^(−x) and 1 − e^(−x), both to full relative precision, from one exponential."""
    if x < 0.5:
        rest = -np.expm1(-x)
        return 1.0 - rest, rest
    decayed = np.exp(-x)
    return decayed, 1.0 - decayed


# 1/(2k+1)! and 1/(2k)! for k = 9 ... 1: series of sinh and cosh to full precision for arguments up to 1.
_SINH_SERIES = tuple(1.0 / math.factorial(2 * k + 1) for k in range(9, 0, -1))
_COSH_SERIES = tuple(1.0 / math.factorial(2 * k) for k in range(9, 0, -1))
_SINHC_SERIES = tuple(1.0 / math.factorial(2 * k + 1) for k in range(1, 13))


@_inlined
def _sinh_rest(square: float) -> float:
    """(sinh x / x − 1)/x² as a function of x², x ≤ 1."""
    total = 0.0
    for coefficient in _SINH_SERIES:
        total = total * square + coefficient
    return total


@_inlined
def _cosh_rest(square: float) -> float:
    """(cosh x − 1)/x² as a function of x², x ≤ 1; less `_sinh_rest` it is (x cosh x − sinh x)/x³."""
    total = 0.0
    for coefficient in _COSH_SERIES:
        total = total * square + coefficient
    return total


@_inlined
def _double_sinh_rest(square: float) -> float:
    """(sinh 2x / (2x) − 1)/x² as a function of x², x ≤ 1."""
    sinh, cosh = _sinh_rest(square), _cosh_rest(square)
    return sinh + cosh + square * sinh * cosh


@_inlined
def _sinhc_difference(square_a: float, square_b: float) -> float:
    """(sinh a / a − sinh b / b)/(a² − b²) as a function of the squares, b ≤ a ≤ 2."""
    power, power_b, total = 0.0, 1.0, 0.0
    for coefficient in _SINHC_SERIES:
        power = square_a * power + power_b
        power_b *= square_b
        total += power * coefficient
    return total


@_compiled
def half_space_kernels(d: float, poisson: float) -> tuple[float, float, float, float, float]:
    """Kernels Z, L, T, V, W of the half-space at d = q depth."""
    a = np.exp(-d)
    m = 1.0 - 2.0 * poisson
    return (1.0 + d) * a, (1.0 - d) * a, d * a, (m - d) * a, (1.0 + m + d) * a


@_compiled
def frictionless_kernels(
    h: float, t: float, d: float, poisson: float
) -> tuple[float, float, float, float, float]:
    """Kernels Z, L, T, V, W of a layer on a rigid frictionless support."""
    if h < 1.0:
        return _thin_frictionless_kernels(h, t, d, poisson)
    m = 1.0 - 2.0 * poisson
    e2t, c2t = _decay(2.0 * t)
    e2h, c2h = _decay(2.0 * h)
    _, c2d = _decay(2.0 * d)
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


@_inlined
def _thin_frictionless_kernels(
    h: float, t: float, d: float, poisson: float
) -> tuple[float, float, float, float, float]:
    """`frictionless_kernels` for h < 1, where the exponentials cancel."""
    s = h + t
    hh, tt, dd, quarter = h * h, t * t, d * d, 0.25 * s * s
    sinh_h, cosh_h = h + h * hh * _sinh_rest(hh), 1.0 + hh * _cosh_rest(hh)
    sinh_t, cosh_t = t + t * tt * _sinh_rest(tt), 1.0 + tt * _cosh_rest(tt)
    above_d = dd * _cosh_rest(dd)
    half_s = 0.5 * s * (1.0 + quarter * _sinh_rest(quarter))
    scale = 1.0 / (sinh_h * cosh_h + h)
    normal = scale * (sinh_h * cosh_t + d * cosh_h * cosh_t + t * (1.0 + above_d))
    shear = scale * 2.0 * h * t * s * d * _sinhc_difference(4.0 * quarter, dd)
    # sinh s − s + sinh d − d − s (cosh d − 1) − d (cosh s − 1)
    excess = s * quarter * _double_sinh_rest(quarter) + d * dd * _sinh_rest(dd)
    longitudinal = scale * (0.5 * (excess - s * above_d) - d * half_s * half_s)
    along = (1.0 - poisson) * longitudinal - poisson * normal
    downward = shear + scale * 2.0 * (1.0 - poisson) * sinh_h * sinh_t
    return normal, longitudinal, shear, along, downward


@_compiled
def bonded_kernels(h: float, t: float, d: float, poisson: float) -> tuple[float, float, float, float, float]:
    """Kernels Z, L, T, V, W of a layer on a rigid support it sticks to."""
    if h < 1.0:
        return _thin_bonded_kernels(h, t, d, poisson)
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = m1 + m
    e2t, c2t = _decay(2.0 * t)
    e2h, c2h = _decay(2.0 * h)
    _, c2d = _decay(2.0 * d)
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
        bend = 2.0 * np.exp(-t) * t * tt * (_cosh_rest(tt) - _sinh_rest(tt))
        downward = scale * (
            m * (2.0 * m1 * chsh + (h + d) * shsh) + h * t * chsh - bend * (m1 * (1.0 + e2h) + h * c2h)
        )
    return normal, longitudinal, shear, along, downward


@_inlined
def _thin_bonded_kernels(
    h: float, t: float, d: float, poisson: float
) -> tuple[float, float, float, float, float]:
    """`bonded_kernels` for h < 1, where the exponentials cancel."""
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = m1 + m
    hh, tt, dd = h * h, t * t, d * d
    rest_h, rest_t, rest_d = _sinh_rest(hh), _sinh_rest(tt), _sinh_rest(dd)
    above_h, above_t, above_d = _cosh_rest(hh), _cosh_rest(tt), _cosh_rest(dd)
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
    half *= 1.0 + half * half * _sinh_rest(half * half)
    squares = 2.0 * poisson + half * half + 0.5 * dd * above_d - m * dd * rest_d
    shear = scale * d * (m1 * squares + m * sinh_h * sinh_t - h * t * sinhc_d)
    half_sum, half_t = 0.25 * (h + d) * (h + d), 0.25 * tt
    # (cosh h − cosh d)/t
    drop = 0.5 * (h + d) * (1.0 + half_sum * _sinh_rest(half_sum)) * (1.0 + half_t * _sinh_rest(half_t))
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


# Modes that are looked at together. Thin ones take a loop without branches and with an array for each kernel,
# which compiles to vectors.
_BLOCK = 256


@_compiled
def _fill_kernels(kind: int, q: Any, depth: Any, height: float, poisson: float, out: Any) -> None:
    """Kernels of all modes; one depth may serve all."""
    supported = kind != _HALF_SPACE and depth.size == 1
    for first in range(0, q.size, _BLOCK):
        last = min(first + _BLOCK, q.size)
        part = q[first:last]
        if supported and part.min() > 0.0 and float(part.max()) * height < 1.0:
            _fill_thin(
                kind,
                part,
                depth[0],
                height,
                poisson,
                out[0, first:last],
                out[1, first:last],
                out[2, first:last],
                out[3, first:last],
                out[4, first:last],
            )
        else:
            _fill_any(kind, q, depth, height, poisson, out, first, last)


@_compiled
def _fill_thin(
    kind: int,
    q: Any,
    depth: float,
    height: float,
    poisson: float,
    normal: Any,
    longitudinal: Any,
    shear: Any,
    along: Any,
    downward: Any,
) -> None:
    if kind == _BONDED:
        for n in range(q.size):
            k = float(q[n])
            values = _thin_bonded_kernels(k * height, k * (height - depth), k * depth, poisson)
            normal[n], longitudinal[n], shear[n], along[n], downward[n] = values
    else:
        for n in range(q.size):
            k = float(q[n])
            values = _thin_frictionless_kernels(k * height, k * (height - depth), k * depth, poisson)
            normal[n], longitudinal[n], shear[n], along[n], downward[n] = values


@_compiled
def _fill_any(
    kind: int, q: Any, depth: Any, height: float, poisson: float, out: Any, first: int, last: int
) -> None:
    many = depth.size > 1
    for n in range(first, last):
        wavenumber = float(q[n])
        below = depth[n if many else 0]
        d = wavenumber * below
        t = wavenumber * (height - below)
        if wavenumber == 0.0:
            values = (1.0, 0.0, 0.0, 0.0, 0.0)
        elif d > 700.0:
            # Below 1e-300: nothing is left, and subnormal numbers are slow.
            values = (0.0, 0.0, 0.0, 0.0, 0.0)
        elif kind == _HALF_SPACE or t > 40.0:
            # Above t = 40 a layer differs from the half-space by less than 1e-30.
            values = half_space_kernels(d, poisson)
        elif kind == _BONDED:
            values = bonded_kernels(wavenumber * height, t, d, poisson)
        else:
            values = frictionless_kernels(wavenumber * height, t, d, poisson)
        out[0, n], out[1, n], out[2, n], out[3, n], out[4, n] = values


@_compiled
def _fill_compliance(
    kind: int, q: Any, height: float, poisson: float, unit: float, uniform: float, out: Any
) -> None:
    """Surface compliance of all modes; `unit` is 2/E*, `uniform` the value at q = 0."""
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    k = 3.0 - 4.0 * poisson
    for n in range(q.size):
        wavenumber = float(q[n])
        h = wavenumber * height
        if wavenumber == 0.0:
            out[n] = uniform
            continue
        if kind == _HALF_SPACE or h > 40.0:
            out[n] = unit / wavenumber
            continue
        e2h, c2h = _decay(2.0 * h)
        if kind == _FRICTIONLESS:
            slope = c2h / (2.0 * h)
            out[n] = unit * height * 2.0 * slope * slope / (slope * (1.0 + e2h) + 2.0 * e2h)
        elif h >= 1.0:
            bending = c2h * (1.0 + e2h)
            if kind == _BONDED:
                ratio = (k * bending - 4.0 * h * e2h) / (k * c2h * c2h + 4.0 * e2h * (h * h + m1 * m1))
            else:
                ratio = (bending + 4.0 * h * e2h) / (c2h * c2h - 4.0 * h * h * e2h)
            out[n] = unit / wavenumber * ratio
        else:
            beyond = h * h * _double_sinh_rest(h * h)
            if kind == _BONDED:
                divisor = h * h + m1 * m1 + k * np.sinh(h) ** 2
                out[n] = unit * height * (2.0 * m + (1.0 + 2.0 * m) * beyond) / divisor
            else:
                rest = _sinh_rest(h * h)
                bending = h * h * h * rest * (2.0 + h * h * rest)
                out[n] = unit / wavenumber * (2.0 + beyond) / bending


@_compiled
def _fill_face_compliance(q: Any, height: float, half_space: bool, poisson: float, out: Any) -> None:
    """Elements ll, tt, zz, lz of the compliance of a free layer, each at the same and at the other face.

    In units of (1 + ν)/E.
    """
    m = 1.0 - 2.0 * poisson
    m1 = 1.0 + m
    for n in range(q.size):
        wavenumber = q[n]
        h = wavenumber * height
        if wavenumber == 0.0:
            out[:, n] = 0.0
            continue
        if half_space:
            out[:, n] = 0.0
            out[0, n] = out[4, n] = m1 / wavenumber
            out[2, n] = 2.0 / wavenumber
            out[6, n] = -m / wavenumber
            continue
        if h >= 1.0:
            # Hyperbolic products in units of e^(2h)/4.
            e2h, c2h = _decay(2.0 * h)
            eh = np.exp(-h)
            determinant = c2h * c2h - 4.0 * (h * eh) ** 2
            tension = c2h * (1.0 + e2h) - 4.0 * h * e2h
            bending = c2h * (1.0 + e2h) + 4.0 * h * e2h
            far_tension = 2.0 * eh * (h * (1.0 + e2h) - c2h)
            far_bending = 2.0 * eh * (h * (1.0 + e2h) + c2h)
            mixed = m * c2h * c2h + 4.0 * (h * eh) ** 2
            far_mixed = 2.0 * h * eh * c2h
            coth, cosech = (1.0 + e2h) / c2h, 2.0 * eh / c2h
        else:
            # All but the last two divided by h².
            square = h * h
            rest, above = _sinh_rest(square), _cosh_rest(square)
            rest_2h = _double_sinh_rest(square)
            sinhc, cosh = 1.0 + square * rest, 1.0 + square * above
            determinant = square * rest * (1.0 + sinhc)
            tension = h * rest_2h
            bending = (2.0 + square * rest_2h) / h
            far_tension = h * (above - rest)
            far_bending = (sinhc + cosh) / h
            mixed = m * sinhc * sinhc + 1.0
            far_mixed = sinhc
            coth, cosech = cosh / (h * sinhc), 1.0 / (h * sinhc)
        unit = 1.0 / wavenumber
        out[0, n] = unit * m1 * tension / determinant
        out[1, n] = -unit * m1 * far_tension / determinant
        out[2, n] = unit * 2.0 * coth
        out[3, n] = unit * 2.0 * cosech
        out[4, n] = unit * m1 * bending / determinant
        out[5, n] = unit * m1 * far_bending / determinant
        out[6, n] = -unit * mixed / determinant
        out[7, n] = -unit * m1 * far_mixed / determinant
