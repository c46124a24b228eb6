"""The elastic solid, a stack of layers on a half-space or a rigid base: compliances, stress and displacement.

Conventions
-----------
The solid fills ``0 ≤ z ≤ height`` with z upward; ``depth = height − z ≥ 0`` is measured downward from the
loaded top. Fields are sums of modes exp(+i (qx x + qy y)), as in `asperity.fourier.grid`. Tension is
positive.
The contact pressure p ≥ 0 is compressive, σ_zz = −p at the top, where the shear stress is zero. All results
are per unit pressure amplitude p̂(q). Stress components are in the order of `COMPONENTS`, displacements in
the order x, y, z (upward). The effective modulus is E* = E/(1 − ν²). Units are any consistent set.

Five real kernels of (q, depth) describe a pressure mode. With l along the wavevector and t across it,

    σ_zz = −p Z,   σ_ll = −p L,   σ_tt = −p ν (Z + L),   σ_lz = −i p T,
    u_l = i p (1 + ν)/(E q) V,    u_z = −p (1 + ν)/(E q) W,    u_t = σ_lt = σ_tz = 0.

In a half-space, with d = q depth, Z = (1 + d) e^(−d), L = (1 − d) e^(−d), T = d e^(−d). Layers follow by the
recursion of `asperity.elasticity.stack`. Five more describe the stress of a shear traction on the top, t_l
along and t_t across the wavevector:

    σ_zz = i t_l N,   σ_ll = i t_l M,   σ_tt = ν (σ_zz + σ_ll),
    σ_lz = t_l X,     σ_tz = t_t P,     σ_lt = i t_t Q.

In a half-space N = d e^(−d), M = (2 − d) e^(−d), X = (1 − d) e^(−d), P = Q = e^(−d).

Stacks of layers
----------------
A layer with a `base` is bonded to it: to an elastic half-space, or to another layer with its own base or
rigid bottom. All results hold at every depth, with the Poisson's ratio of the material there in σ_tt, and V
and W in units of its (1 + ν)/(E q). On an interface σ_zz, σ_lz and the displacements are continuous, σ_ll and
σ_tt jump: a depth equal to one of `Solid.interfaces` is the lower face of the layer above it,
`numpy.nextafter(depth, inf)` the upper face of the material below.

The mode q = 0
--------------
The mode q = 0 is a uniform pressure on a cell that repeats sideways. The paper does not say whether the cell
may spread; `Solid.lateral` chooses: ``"confined"`` (no lateral strain) or ``"free"`` (no mean lateral
stress). The mode is not the limit q → 0. A half-space, layered or not, and a layer with a free bottom have no
finite uniform displacement: their displacement and compliance at q = 0 are set to 0. If a stack may spread,
all its layers have one lateral strain: that of an elastic base, or, on a rigid base, the one without a net
lateral force. `Solid.kernels` gives 1 for Z and 0 for the others at q = 0.

The Nyquist rule
----------------
A function of (qx, qy) cannot know the grid: the caller sets values that are odd in a Nyquist wavevector to
zero, see `asperity.fourier.grid`.

Precision
---------
q, depth and the result may be float32 or float64; single modes are always computed in double precision. The
results are accurate to rounding for every q height and every Poisson's ratio above −1 up to and including
1/2. Lengths, wavenumbers and moduli from 1e-75 to 1e75 are accepted. A result that its type cannot hold is an
error.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple, Self

import numpy as np

from asperity.core.arguments import LARGEST, SMALLEST, choice, magnitude, number, real_array
from asperity.core.errors import shown
from asperity.core.markup import table
from asperity.core.types import FIELDS, Array, ArrayLike
from asperity.elasticity.kernels import BONDED, FREE, FRICTIONLESS, HALF_SPACE, green_elements
from asperity.elasticity.stack import Stack, fill_interpolated, fill_kernels

COMPONENTS = FIELDS[:6]
LATERALS = ("confined", "free")

_KINDS = {"bonded": BONDED, "frictionless": FRICTIONLESS, "free": FREE}

SMALLEST_IN_PASCAL = 1e3
"""Effective modulus from which a solid is in SI units; gels have 1 kPa."""

MANY = 8192
"""Number of wavenumbers from which kernels are interpolated between some of them, to rounding."""

WAVENUMBERS, DEPTHS = np.geomspace(1, 8, 25)[:, None], np.linspace(0, 1, 41)
"""Wavenumbers over the smallest one, and depths over the height, at which the solids are compared."""


class Kernels(NamedTuple):
    """The five real kernels of a pressure mode, arrays of one shape.

    Attributes
    ----------
    normal, longitudinal, shear : array
        Z, L and T: stresses per unit pressure, dimensionless.
    displacement_longitudinal, displacement_normal : array
        V and W: displacements per unit pressure, in units of (1 + ν)/(E q).
    """

    normal: Array
    longitudinal: Array
    shear: Array
    displacement_longitudinal: Array
    displacement_normal: Array


class ShearKernels(NamedTuple):
    """The five real kernels of a mode of shear traction, arrays of one shape: stresses per traction.

    Attributes
    ----------
    normal, longitudinal, shear : array
        N, M and X: of the traction along the wavevector.
    transverse, in_plane : array
        P and Q: of the traction across the wavevector.
    """

    normal: Array
    longitudinal: Array
    shear: Array
    transverse: Array
    in_plane: Array


class Layer(NamedTuple):
    """One layer of a stack: thickness, Young's modulus and Poisson's ratio."""

    thickness: float
    young: float
    poisson: float


@dataclass(frozen=True)
class Solid:
    """An isotropic linear elastic half-space, or a layer on a rigid or an elastic base, which may be layered.

    Parameters
    ----------
    young : float
        Young's modulus E, from 1e-75 to 1e75.
    poisson : float
        Poisson's ratio, −1 < ν ≤ 1/2.
    height : float, optional
        Height of the layer, from 1e-75 to 1e75; without it the solid is the half-space.
    bottom : "bonded" | "frictionless" | "free"
        Condition at the bottom: no displacement; no normal displacement and no shear stress; no traction. Has
        no effect on the half-space.
    lateral : "confined" | "free"
        Condition for the mode q = 0: no lateral strain; no mean lateral stress.
    base : Solid, optional
        Elastic half-space, or layer with its own base or bottom, to which the layer is bonded; it takes
        `lateral` from this layer. See `stack` for many layers.

    Raises
    ------
    TypeError, ValueError
        If an argument is not a number or is out of range, the layer is not bonded to its base, or the base
        has a free bottom.

    Examples
    --------
    >>> steel = asp.Solid(young=210e9, poisson=0.3)  # a half-space, in Pa
    >>> print(f"{steel.effective_modulus / 1e9:.1f} GPa")
    230.8 GPa
    >>> rubber = asp.Solid(young=2e6, poisson=0.5, height=1e-3, bottom="bonded")  # 1 mm on a rigid base
    >>> wavenumber = np.array([10.0, 1e3, 1e5])  # rad/m
    >>> np.round(rubber.surface_compliance(wavenumber) * rubber.effective_modulus * wavenumber / 2, 3)
    array([0.   , 0.241, 1.   ])
    >>> coated = asp.Solid(400e9, 0.25, height=2e-6, base=steel)  # 2 µm of a hard coating
    >>> coated.stress(1e6, 0.0, [2e-6, np.nextafter(2e-6, 1)])[:, 0].real.round(3)  # σ_xx jumps
    array([0.391, 0.13 ])
    """

    young: float
    poisson: float
    height: float | None = None
    bottom: str = "bonded"
    lateral: str = "confined"
    base: Solid | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "young", magnitude("young", self.young))
        accepted = "a number > -1 and ≤ 0.5"
        poisson = number("poisson", self.poisson, accepted, lambda ratio: -1 < ratio <= 0.5)
        object.__setattr__(self, "poisson", poisson)
        if self.height is not None:
            height = magnitude("height", self.height, " or None for the half-space")
            object.__setattr__(self, "height", height)
        choice("bottom", self.bottom, tuple(_KINDS))
        choice("lateral", self.lateral, LATERALS)
        if self.base is None:
            return
        if not isinstance(self.base, Solid):
            raise TypeError(f"base = {shown(self.base)}: a Solid is needed")
        if self.height is None:
            raise ValueError("height = None: the height of the layer is needed on a base")
        if self.bottom != "bonded":
            raise ValueError(f"bottom = {self.bottom!r}: bonded is needed on an elastic base")
        base = self.base if self.base.height else replace(self.base, bottom="bonded")
        if base.parts[-1].bottom == "free":
            raise ValueError(f"base = {self.base!r}: one whose bottom is not free is needed")
        object.__setattr__(self, "base", replace(base, lateral=self.lateral))

    @classmethod
    def stack(
        cls,
        layers: Iterable[tuple[float, float, float]],
        base: Solid | None = None,
        bottom: str = "bonded",
        lateral: str = "confined",
    ) -> Self:
        """Layers bonded to each other, on an elastic or a rigid base.

        Parameters
        ----------
        layers : sequence of (thickness, young, poisson)
            Top first.
        base : Solid, optional
            By default a rigid base.
        bottom : "bonded" | "frictionless"
            Condition on the rigid base.
        lateral : "confined" | "free"

        Examples
        --------
        >>> steel = asp.Solid(young=210e9, poisson=0.3)
        >>> coated = asp.Solid.stack([(2e-6, 180e9, 0.22), (0.3e-6, 279e9, 0.21)], base=steel)  # on chromium
        >>> coated.interfaces
        (2e-06, 2.3e-06)
        """
        solid: Any = base
        for layer in reversed(list(layers)):
            if not (isinstance(layer, tuple | list) and len(layer) == 3):
                raise ValueError(f"layers: {shown(layer)} is no (thickness, young, poisson)")
            thickness, young, poisson = layer
            solid = cls(young, poisson, thickness, "bonded" if solid else bottom, lateral, solid)
        if solid is base:
            raise ValueError("layers: one (thickness, young, poisson) or more are needed")
        return solid

    def __repr__(self) -> str:
        below = f"bottom={self.bottom!r}" if self.base is None else f"base={self.base!r}"
        given = "" if self.height is None else f", height={self.height:.6g}, {below}"
        lateral = "" if self.lateral == "confined" else f", lateral={self.lateral!r}"
        return f"Solid(young={self.young:.6g}, poisson={self.poisson:.6g}{given}{lateral})"

    def _repr_html_(self) -> str:
        rows = [
            ("Young's modulus", f"{self.young:.6g}"),
            ("Poisson's ratio", f"{self.poisson:.6g}"),
            ("E* = E/(1 − ν²)", f"{self.effective_modulus:.6g}"),
            ("height", "half-space" if self.height is None else f"{self.height:.6g}, {self.bottom} bottom"),
            *([] if self.base is None else [("base", repr(self.base))]),
            ("mean (q = 0) mode", f"laterally {self.lateral}"),
        ]
        return table("Solid", rows)

    @property
    def effective_modulus(self) -> float:
        """Effective modulus E* = E/(1 − ν²)."""
        return self.young / ((1 - self.poisson) * (1 + self.poisson))

    @property
    def parts(self) -> tuple[Solid, ...]:
        """The solid itself, and what lies below each of its interfaces."""
        return (self, *(self.base.parts if self.base else ()))

    def part_at(self, depth: float) -> Solid:
        """The one of `parts` on top of which the material at a depth lies."""
        return self.parts[np.searchsorted(self.interfaces, depth)]

    @property
    def layers(self) -> tuple[Layer, ...]:
        """Thickness, Young's modulus and Poisson's ratio of each layer, top first; none in a half-space."""
        return tuple(
            Layer(part.height, part.young, part.poisson) for part in self.parts if part.height is not None
        )

    @property
    def interfaces(self) -> tuple[float, ...]:
        """Depths of the interfaces between layers, and between the last one and an elastic base."""
        return tuple(self._stack[1][: len(self.parts) - 1].tolist())

    @property
    def interface(self) -> float | None:
        """Depth of the first interface; None without a base."""
        return None if self.base is None else self.height

    @property
    def extent(self) -> float | None:
        """Depth of the bottom of the solid; None for a half-space, layered or not."""
        return None if self._stack[0] == HALF_SPACE else float(self._stack[1][-1])

    @property
    def description(self) -> str:
        """The kind of solid in words, as in the attribute ``solid`` of results."""
        bottom = "half-space" if self.extent is None else f"layer, {self.parts[-1].bottom} bottom"
        if self.base is None:
            return bottom
        return "coated half-space" if len(self.layers) == 1 else f"{len(self.layers)} layers, {bottom}"

    def _constants(self, depth: ArrayLike) -> tuple[Any, Any]:
        """Young's modulus and Poisson's ratio at depths; one number each without a base."""
        if self.base is None:
            return self.young, self.poisson
        place = np.searchsorted(self.interfaces, depth)
        return tuple(np.array([(part.young, part.poisson) for part in self.parts]).T[:, place])

    @cached_property
    def _stack(self) -> Stack:
        heights = np.array([layer.thickness for layer in self.layers])
        shear, poisson = np.array([(part.young / (1 + part.poisson), part.poisson) for part in self.parts]).T
        last = self.parts[-1]
        kind = HALF_SPACE if last.height is None else _KINDS[last.bottom]
        return kind, np.cumsum(heights), heights, poisson.copy(), shear.copy()

    def surface_compliance(self, q: ArrayLike) -> Array:
        """Downward surface displacement per unit pressure amplitude, G_zz(q).

        Parameters
        ----------
        q : array
            Wavenumbers |q|, 0 or from 1e-75 to 1e75; float32 or float64 (anything else becomes float64).

        Returns
        -------
        compliance : array
            In length per pressure, of the shape and type of q: 2/(E* q) for the half-space. On a coated
            half-space E* is the modulus of the base for long waves, and of the coating for short waves. At
            q = 0 it is the value of `uniform_compliance`.

        Raises
        ------
        TypeError, ValueError
            If a wavenumber is not a number or out of range, or a compliance is too large for the type of q.
        """
        q = _wavenumbers(q)
        out = np.full(q.shape, self.uniform_compliance(), q.dtype)
        with np.errstate(over="ignore"):
            if self.layers:
                unit = (1 + self.poisson) / self.young
                np.divide(unit * self._filled(False, q, 0.0, many=q.size)[4], q, out=out, where=q > 0)
            else:
                np.divide(2 / self.effective_modulus, q, out=out, where=q > 0)
        _require_finite("surface compliance", out)
        return out

    def _uniform(self) -> tuple[Array, Array]:
        """Lateral stress in each material, and compression of each, under a unit mean pressure at q = 0."""
        young, poisson = np.array([(part.young, part.poisson) for part in self.parts]).T
        stretch = np.zeros(young.size)  # Young's modulus × lateral strain
        if self.lateral == "free":
            heights = [part.height or np.inf for part in self.parts]
            share = young / (1 - poisson) / young.max() * heights
            share = np.isinf(share) * 1.0 if self.extent is None else share / share.sum()
            stretch = (young[:, None] / young * poisson) @ share
        compression = ((1 + poisson) * (1 - 2 * poisson) + 2 * poisson * stretch) / (1 - poisson) / young
        return (stretch - poisson) / (1 - poisson), compression

    def uniform_compliance(self) -> float:
        """Downward surface displacement per unit mean pressure, in length per pressure.

        It is Σ height/C11 of the layers for a laterally confined cell, with C11 the uniaxial-strain modulus
        E (1 − ν)/((1 + ν)(1 − 2ν)), and height/E of one layer for a free one. For the half-space, layered or
        not, and for a free bottom, where it is not defined, it is set to 0.
        """
        return -float(self.uniform_displacement(0.0))

    def tangential_compliance(self, q: ArrayLike) -> Array:
        """Displacement of the surface along and across a wave per shear traction in the same direction.

        They follow from Hooke's law and the stress in the surface, where a traction along the wave causes
        no normal stress σ_zz: in a half-space 2/(E* q), as for a pressure, and 2 (1 + ν)/(E q).

        Parameters
        ----------
        q : array
            Wavenumbers |q|, 0 or from 1e-75 to 1e75.

        Returns
        -------
        (2, ...) array
            Along, across; in length per stress. At q = 0 the displacement under a uniform traction, set to 0
            where `uniform_compliance` is.

        Raises
        ------
        TypeError, ValueError
            As for `shear_kernels`.
        """
        q = _wavenumbers(q)
        wave, kernels = np.where(q > 0, q, 1.0), self.shear_kernels(q, 0.0)
        shear = 2 * (1 + self.poisson) / self.young
        along = kernels.longitudinal / self.effective_modulus / wave
        uniform = 0.0
        if self.extent is not None:
            uniform = sum(2 * (1 + nu) / young * height for height, young, nu in self.layers)
        return np.where(q > 0, np.stack([along, shear * kernels.in_plane / wave]), uniform)

    def uniform_stress(self, depth: ArrayLike = 0.0) -> Array:
        """Stress of the mode q = 0 per unit mean pressure, (..., 6); constant in a material."""
        lateral = self._uniform()[0][np.searchsorted(self.interfaces, depth)]
        out = np.zeros((*np.shape(lateral), 6))
        out[..., 0] = out[..., 1] = lateral
        out[..., 2] = -1.0
        return out

    def uniform_displacement(self, depth: ArrayLike) -> Array:
        """Upward displacement of the mode q = 0 per unit mean pressure, of the shape of `depth`.

        At the top it is −`uniform_compliance`, at the bottom 0.
        """
        depth, (kind, bottoms, heights, *_) = self._depths(depth), self._stack
        if kind in (HALF_SPACE, FREE):
            return np.zeros(depth.shape)
        below = np.cumsum((self._uniform()[1] * heights)[::-1])[::-1]
        return -np.interp(depth, [0.0, *bottoms], [*below, 0.0])

    def kernels(self, q: ArrayLike, depth: ArrayLike) -> Kernels:
        """The five real kernels of a pressure mode, defined in the description of the module.

        Parameters
        ----------
        q : array
            Wavenumbers |q|, 0 or from 1e-75 to 1e75; float32 or float64 (anything else becomes float64).
        depth : array
            Depths from 0 to the height, on a base of any size, broadcast against q.

        Returns
        -------
        Kernels
            Arrays of the broadcast shape and the type of q.

        Raises
        ------
        TypeError, ValueError
            If a wavenumber or a depth is not a number or out of range, the shapes do not match, or the bottom
            is free.
        """
        if self._stack[0] == FREE:
            raise ValueError("bottom = 'free': bonded or frictionless is needed for stress and displacement")
        return Kernels(*self._filled(False, q, depth))

    def shear_kernels(self, q: ArrayLike, depth: ArrayLike) -> ShearKernels:
        """The five real kernels of a mode of shear traction, defined in the description of the module.

        Parameters and results as for `kernels`.

        Raises
        ------
        TypeError, ValueError
            If a wavenumber or the depth is not a number or out of range, or the bottom is frictionless or
            free: it bears no shear, so that no state of rest exists under a mean traction.
        """
        if self._stack[0] not in (HALF_SPACE, BONDED):
            raise ValueError(
                f"bottom = {self.parts[-1].bottom!r}: bonded is needed, because this one bears no shear"
            )
        return ShearKernels(*self._filled(True, q, depth))

    def _filled(self, of_shear: bool, q: ArrayLike, depth: ArrayLike, many: int = MANY) -> Array:
        """Five kernels of every wavenumber and depth, of a pressure or of a shear traction."""
        q, depth = _wavenumbers(q), self._depths(depth)
        shape = _broadcast_shape(q=q, depth=depth)
        depths = depth.reshape(-1) if depth.size == 1 else _flat(depth, shape)
        out = np.empty((5, *shape), q.dtype)
        fill = fill_interpolated if depth.size == 1 and self.layers and q.size > many else fill_kernels
        fill(of_shear, _flat(q, shape), depths, self._stack, out.reshape(5, -1))
        return out

    def stress(self, qx: ArrayLike, qy: ArrayLike, depth: ArrayLike) -> Array:
        """Stress of the pressure mode p̂(q) = 1.

        Parameters
        ----------
        qx, qy : array
            Components of the wavevector.
        depth : array
            Depths from 0 to the height, broadcast against qx and qy.

        Returns
        -------
        stress : (..., 6) complex array
            Stress per pressure, dimensionless; components as in `COMPONENTS`; complex64 if qx and qy are
            float32, otherwise complex128. At q = 0 the value of `uniform_stress`.

        Raises
        ------
        TypeError, ValueError
            As for `kernels`.
        """
        q, cosine, sine, kind = _polar(qx, qy)
        k = self.kernels(q, depth)
        across = self._constants(depth)[1] * (k.normal + k.longitudinal)
        out = np.zeros((*k.normal.shape, 6), kind)
        out[..., 0] = -(cosine**2) * k.longitudinal - sine**2 * across
        out[..., 1] = -(sine**2) * k.longitudinal - cosine**2 * across
        out[..., 2] = -k.normal
        out[..., 3] = -1j * sine * k.shear
        out[..., 4] = -1j * cosine * k.shear
        out[..., 5] = cosine * sine * (across - k.longitudinal)
        uniform = np.broadcast_to(q == 0, k.normal.shape)
        out[uniform] = np.broadcast_to(self.uniform_stress(depth), out.shape)[uniform]
        return out

    def displacement(self, qx: ArrayLike, qy: ArrayLike, depth: ArrayLike) -> Array:
        """Displacement of the pressure mode p̂(q) = 1; arguments and errors as for `stress`.

        Returns
        -------
        displacement : (..., 3) complex array
            Components x, y, z (upward), in length per pressure. At q = 0 `uniform_displacement` along z.
        """
        q, cosine, sine, kind = _polar(qx, qy)
        k = self.kernels(q, depth)
        shape = k.normal.shape
        q = np.broadcast_to(q, shape)
        uniform = q == 0
        young, poisson = self._constants(depth)
        unit = (1 + poisson) / young / np.where(uniform, 1.0, q)
        out = np.zeros((*shape, 3), kind)
        with np.errstate(over="ignore"):
            out[..., 0] = 1j * cosine * unit * k.displacement_longitudinal
            out[..., 1] = 1j * sine * unit * k.displacement_longitudinal
            normal = -unit * k.displacement_normal
            out[..., 2] = np.where(uniform, self.uniform_displacement(depth), normal)
        _require_finite("displacement", out)
        return out

    def green_tensor(self, qx: ArrayLike, qy: ArrayLike) -> Array:
        """Displacements of both faces of the layer per tractions on both faces, whatever its `bottom`.

        Eqs. 5 to 8 and A.1 to A.3 of the paper. As printed, A.3 does not hold for G11, G12, G22, G33, G36,
        G16 and G26, and A.2 not for its entries (5, 4), (6, 4) and (6, 5);
        ``paper/supplement/method.md`` has both forms.

        Parameters
        ----------
        qx, qy : array
            Components of the wavevector, in double precision.

        Returns
        -------
        tensor : (6, 6, ...) complex array
            In length per pressure, Hermitian and positive definite. Rows are the displacements x, y, z of the
            top and x, y, z of the bottom, columns the tractions t = σ·n in this order, with the *outward*
            normal n on both faces: a pressure p is t_z = −p on the top, t_z = p on the bottom. The z axis is
            upward. For the half-space the limit of a high layer, in which the faces do not influence each
            other (Eq. 10). At q = 0, where a layer moves as a rigid body, 0.

        Raises
        ------
        TypeError, ValueError
            If a wavevector is not a number or out of range, or an element is too large for double precision:
            the compliance of a low layer in bending grows as 1/(q⁴ height³).

        Notes
        -----
        The error of an element (i, j) is below 8e-15 of √(G_ii G_jj) for every height and ν
        (``studies/stability``). For q height below about 1e-4 the stretching is below the rounding error of
        the bending in G33 and G36, so that displacements cannot be inverted to tractions:
        `asperity.elasticity.layer_fields` does not use the tensor.

        Examples
        --------
        A pressure on the top of a high layer hardly moves its bottom; a low layer bends as a whole:

        >>> push = np.array([0, 0, -1, 0, 0, 0])
        >>> for height in (20.0, 0.1):
        ...     moved = np.tensordot(asp.Solid(1.0, 0.3, height).green_tensor(1.0, 0.0), push, ([1], [0]))
        ...     print(f"{moved[2].real:.4g} {moved[5].real:.4g}")
        -1.82 -1.576e-07
        -1.094e+04 -1.094e+04
        """
        if self.base is not None:
            raise ValueError(f"base = {self.base!r}: None is needed, the lower face is inside the solid")
        q, cosine, sine, _ = _polar(qx, qy)
        wavenumber = np.where(q == 0, 1.0, _wavenumbers(q))
        out, direction = np.zeros((6, 6, *q.shape), complex), np.array([cosine, sine])
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            elements = green_elements(wavenumber * (self.height or np.inf), self.poisson)
            elements *= np.where(q == 0, 0.0, (1 + self.poisson) / self.young / wavenumber)
            for displaced, loaded in product((0, 1), (0, 1)):  # top, bottom
                along, normal, across, mixed = elements[int(displaced != loaded)]
                block = out[3 * displaced :, 3 * loaded :]
                block[0, 0] = cosine**2 * along + sine**2 * across
                block[1, 1] = sine**2 * along + cosine**2 * across
                block[0, 1] = block[1, 0] = cosine * sine * (along - across)
                block[2, 2] = normal
                block[:2, 2] = 1j * (1 - 2 * displaced) * mixed * direction
                block[2, :2] = 1j * (2 * loaded - 1) * mixed * direction
        _require_finite("green_tensor", out)
        return out

    def _depths(self, depth: ArrayLike) -> Array:
        """Depths as float64, checked."""
        values = real_array("depth", depth)
        limit = self.extent or np.inf
        # A depth equal to the height may have been rounded up, in its own precision.
        slack = limit * (1 + 4 * np.finfo(values.dtype).eps)
        values = values.astype(np.float64)
        wrong = ~((values >= 0) & (values <= slack) & np.isfinite(values))
        if wrong.any():
            raise ValueError(f"depth = {values[wrong].flat[0]}: a finite depth from 0 to {limit} is needed")
        return np.minimum(values, limit)


@dataclass(frozen=True)
class SolidChoice:
    """The simplest solid that a tolerance allows, and the reason for it.

    Attributes
    ----------
    layer : Solid
        The layer asked about, or the half-space of the same material.
    difference : float
        Largest relative difference between the surface compliances of layer and half-space, or between any
        stress component of both at any depth, relative to the pressure amplitude of the mode, if that is
        larger; 0 for a half-space.
    reason : str
        One sentence for the record of a result.
    """

    layer: Solid
    difference: float
    reason: str


def simplest_solid(layer: Solid, q_min: float, tolerance: float) -> SolidChoice:
    """The half-space if it differs from the layer by at most the tolerance for all q ≥ q_min; else the layer.

    A half-space is cheaper to compute than a layer and serves every Poisson's ratio at once. The field of a
    pressure mode decays as e^(−q depth), so a layer that is tall against the longest wave differs little from
    the half-space. The difference comes from the bottom. For the stress it is about e^(−q height) times a
    polynomial of q height, for the surface compliance the square of this, and both fall with q once
    q height is above 2. Lower layers differ by more than any tolerance allows. The mean (q = 0) mode is left
    out: its stress is the same in both solids, and its displacement only shifts the approach.

    Parameters
    ----------
    layer : Solid
    q_min : float
        Smallest wavenumber of the pressure: 2π over the longer edge of the cell.
    tolerance : float
        Largest accepted difference.

    Returns
    -------
    SolidChoice
        A coating, and a layer with a free bottom, is always kept.

    Raises
    ------
    TypeError, ValueError
        If q_min is not from 1e-75 to 1e75, or the tolerance is not a finite number ≥ 0.
    """
    q_min = magnitude("q_min", q_min)
    tolerance = number("tolerance", tolerance, "a finite number ≥ 0", lambda size: size >= 0)
    if layer.height is None:
        return SolidChoice(layer, 0.0, "the half-space was asked for")
    if layer.base is not None:
        return SolidChoice(layer, np.inf, "a coating was asked for")
    if layer.bottom == "free":
        return SolidChoice(layer, np.inf, "a free layer has no support")
    half_space, q = replace(layer, height=None), q_min * WAVENUMBERS
    compliance = float(np.abs(layer.surface_compliance(q) / half_space.surface_compliance(q) - 1).max())
    ours, theirs = (solid.kernels(q, DEPTHS * layer.height) for solid in (layer, half_space))
    normal, along, shear = (np.abs(a - b) for a, b in zip(ours[:3], theirs[:3], strict=True))
    across = layer.poisson * (ours.normal + ours.longitudinal - theirs.normal - theirs.longitudinal)
    stress = float(np.max([normal, along, shear, np.abs(across)]))
    differ = (
        f"for q·height ≥ {q_min * layer.height:.4g} the surface compliance of the layer and of the half-space"
        f" differ by at most {compliance:.2g} of its value, the stress by at most {stress:.2g} of a mode's"
        " pressure"
    )
    difference = max(compliance, stress)
    if difference > tolerance:
        return SolidChoice(layer, difference, f"layer: {differ}, beyond the tolerance {tolerance:g}")
    reason = f"half-space: {differ}, within the tolerance {tolerance:g}"
    return SolidChoice(half_space, difference, reason)


def _wavenumbers(q: ArrayLike) -> Array:
    """Wavenumbers as an array, checked."""
    values = real_array("q", q)
    limits = np.finfo(values.dtype)
    smallest = max(SMALLEST, float(limits.smallest_subnormal))
    largest = min(LARGEST, float(limits.max))
    wrong = ~((values == 0) | ((values >= smallest) & (values <= largest)))
    if wrong.any():
        accepted = f"wavenumbers of 0 or from {SMALLEST:g} to {LARGEST:g} are needed"
        raise ValueError(f"q = {values[wrong].flat[0]}: {accepted}")
    return values


def _require_finite(name: str, values: Array) -> None:
    """Refuse a result that its type cannot hold."""
    if not np.isfinite(values).all():
        raise ValueError(f"{name}: too large for {values.dtype}; other units or a larger q are needed")


def _flat(array: Array, shape: tuple[int, ...]) -> Array:
    """An array broadcast to a shape, in one dimension; contiguous, so that one type is compiled."""
    return np.ascontiguousarray(array if array.shape == shape else np.broadcast_to(array, shape)).reshape(-1)


def _broadcast_shape(**arrays: Array) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(a.shape for a in arrays.values()))
    except ValueError as error:
        shapes = ", ".join(f"{name} {a.shape}" for name, a in arrays.items())
        raise ValueError(f"shapes {shapes} cannot be broadcast together") from error


def _polar(qx: ArrayLike, qy: ArrayLike) -> tuple[Array, Array, Array, np.dtype]:
    """|q| and its direction cosines in double precision, and the complex type of the result."""
    x, y = real_array("qx", qx), real_array("qy", qy)
    kind = np.result_type(x.dtype, y.dtype, np.complex64)
    _broadcast_shape(qx=x, qy=y)
    for name, values in (("qx", x), ("qy", y)):
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name} = {values[~np.isfinite(values)].flat[0]}: finite numbers are needed")
    x, y = x.astype(np.float64), y.astype(np.float64)
    q = np.hypot(x, y)
    safe = np.where(q == 0, 1.0, q)
    return q, x / safe, y / safe, kind
