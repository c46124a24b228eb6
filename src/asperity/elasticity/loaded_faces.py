"""Stress and displacement in a layer with tractions or displacements prescribed on both faces.

A mode exp(i (qx x + qy y)) is described by a real state, with l along the wavevector and t across it,

    u_l = i U_l/(2 μ q),  u_t = i U_t/(2 μ q),  u_z = U_z/(2 μ q),   σ_lz = i S_l,  σ_tz = i S_t,  σ_zz = S_z,

which obeys y' = A y with s = q z as the variable, by equilibrium and Hooke's law. Six amplitudes give the
states of every depth, and follow from the six conditions on the faces, a linear system for each mode.

* For q height < `THIN` the amplitudes are the state in the middle of the layer. As N² = 0 for N = A² − 1,

      exp(s A) = cosh s + A sinh s + N (s sinh s)/2 + N A (s cosh s − sinh s)/2.

  Its elements are accurate one by one, also for a thin layer, where they are powers of s. The system is then
  scaled by rows and columns. Where the same is prescribed on both faces, sum and difference replace the two
  conditions: they separate stretching from bending, which is softer by the square of q height.
* Otherwise they are the tractions of two half-spaces, the one below the top and the one above the bottom,
  whose fields decay away from their faces: nothing overflows, and the faces of a thick layer decouple.

The state stays finite at ν = 1/2, and so do all coefficients of A.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval

from asperity.core.arguments import choice, finite_array, number, real_array, require_finite
from asperity.core.errors import shown
from asperity.core.types import Array, ArrayLike
from asperity.elasticity.kernels import NOTHING_LEFT
from asperity.elasticity.solid import COMPONENTS, Solid
from asperity.fourier.grid import Fourier, Grid

DISPLACEMENTS = ("displacement_x", "displacement_y", "displacement_z")
PRESCRIBED = (*DISPLACEMENTS, "traction_x", "traction_y", "traction_z", "pressure")
"""Names of the tractions and displacements that can be prescribed on a face."""

THIN = 2.0
"""q height below which states are expanded about the middle of the layer; near it both ways are accurate."""

LOWEST = 1e-60
"""Least height of a layer over the longer edge of the cell: fourth powers of q height are no subnormals."""

BALANCE = 1e-9
"""Largest net force or moment, relative to the largest coefficient prescribed, that is taken for rounding."""

MODES_AT_ONCE = 4096
"""Number of modes that are computed at once, to bound the memory of their systems."""

SCALINGS = 6
"""Number of times that rows and columns of a system are divided by the roots of their largest elements."""

ZERO_DISPLACEMENTS = {"bonded": DISPLACEMENTS, "frictionless": DISPLACEMENTS[2:], "free": ()}
"""Displacements that are zero on each bottom of a `Solid`."""

_SERIES = [2 * k / math.factorial(2 * k + 1) for k in range(1, 11)]
"""Coefficients of (s cosh s − sinh s)/s³ in s², to double precision for |s| ≤ 1."""


@dataclass(frozen=True, repr=False)
class LayerPlane:
    """Stress and displacement in one plane of a layer.

    Parameters
    ----------
    depth : float
    grid : Grid
    fields : dict
        Name → array (ny, nx): stresses ``xx``, ``yy``, ``zz``, ``yz``, ``xz``, ``xy`` and ``von_mises``,
        tension positive, and ``displacement_x``, ``displacement_y`` and ``displacement_z`` (upward).

    Examples
    --------
    >>> layer = asp.Solid(1.0, 0.3, height=0.5, bottom="bonded")
    >>> fields = asp.elasticity.layer_fields(layer, asp.Grid((8, 8)), {"pressure": 1e-3})
    >>> (plane,) = fields.planes([0.25])
    >>> round(float(plane.fields["zz"].mean()), 6)
    -0.001
    """

    depth: float
    grid: Grid
    fields: dict[str, Array]

    def __repr__(self) -> str:
        ny, nx = self.grid.shape
        return f"<LayerPlane of {ny} × {nx} nodes at depth {self.depth:.4g}: {', '.join(self.fields)}>"


class LayerFields:
    """Solution of `layer_fields`, from which the fields at any depth follow.

    Parameters
    ----------
    layer : Solid
    grid : Grid
    displaced : (2, 3) array of truth values
        Top and bottom, x, y and z: True where the displacement is prescribed, False for σ_xz, σ_yz or σ_zz.
    modes : (2, 3, ny, nx // 2 + 1) complex array
        Coefficients of the prescribed tractions and displacements.

    Examples
    --------
    >>> grid, layer = asp.Grid((16, 16)), asp.Solid(1.0, 0.3, height=0.5, bottom="bonded")
    >>> wave = np.cos(2 * np.pi * np.arange(16) / 16) * np.ones((16, 1))
    >>> fields = asp.elasticity.layer_fields(layer, grid, {"pressure": wave})
    >>> (plane,) = fields.planes([0.0])
    >>> bool(np.allclose(plane.fields["zz"], -wave))
    True
    """

    def __init__(self, layer: Solid, grid: Grid, displaced: Array, modes: Array) -> None:
        self.layer, self.grid = layer, grid
        self._mean = _mean_state(layer, displaced, modes)
        # The response at a Nyquist q_y is the mean of the responses at q_y and −q_y, which is an additional
        # row. The real transform along x does the same for q_x.
        rows = np.append(np.arange(grid.shape[0]), np.flatnonzero(2 * grid.ky == grid.shape[0]))
        qy = np.where(np.arange(len(rows)) < grid.shape[0], grid.qy[rows], -grid.qy[rows])[:, None]
        qx = np.tile(grid.qx, (len(rows), 1))
        qx[0, 0] = 2 * np.pi / max(grid.length)  # any number: the mean state replaces this mode
        q = np.hypot(qx, qy)
        self._directions = np.array([q, qx / q, qy / q]).reshape(3, -1)
        self._parts = [slice(first, first + MODES_AT_ONCE) for first in range(0, q.size, MODES_AT_ONCE)]
        fixed, data = displaced.reshape(6, 1), modes[:, :, rows].reshape(6, -1)
        data[[0, 1, 3, 4]] *= -1j
        data *= np.where(fixed, q.ravel() * (layer.young / (1 + layer.poisson)), 1.0)
        solved = [
            _amplitudes(layer, displaced, data[:, part], *self._directions[:, part]) for part in self._parts
        ]
        self._amplitudes = np.concatenate(solved, axis=1)

    def planes(self, depths: ArrayLike) -> Iterator[LayerPlane]:
        """Stream the fields, one plane at a time.

        Parameters
        ----------
        depths : float or (planes,) array
            From 0 to the height of the layer.

        Yields
        ------
        LayerPlane

        Raises
        ------
        TypeError, ValueError
            If a depth is out of range, or a field too large for double precision.
        """
        limit = self.layer.height or np.inf
        accepted = f"a finite depth from 0 to {limit:g}"
        checked = [
            number("depth", depth, accepted, lambda place: 0 <= place <= limit * (1 + 1e-12))
            for depth in np.ravel(real_array("depths", depths)).tolist()
        ]
        return (self._plane(min(depth, limit)) for depth in checked)

    def _plane(self, depth: float) -> LayerPlane:
        layer, nu, (ny, nx) = self.layer, self.layer.poisson, self.grid.shape
        height, spectra = layer.height or np.inf, np.empty((9, self._directions.shape[1]), complex)
        with np.errstate(over="ignore", invalid="ignore"):
            for part in self._parts:
                q, cosine, sine = self._directions[:, part]
                states = _states(self._amplitudes[:, part], q * depth, q * (height - depth), nu)
                u_x, u_y, u_z, xz, yz, zz = _to_axes(states, cosine, sine)
                along = (nu * zz - states[0]) / (1 - nu)
                across, twist = nu * (along + zz), -states[1] / 2
                xx = cosine**2 * along + sine**2 * across - 2 * cosine * sine * twist
                yy = sine**2 * along + cosine**2 * across + 2 * cosine * sine * twist
                xy = cosine * sine * (along - across) + (cosine**2 - sine**2) * twist
                spectra[:6, part] = xx, yy, zz, 1j * yz, 1j * xz, xy
                spectra[6:, part] = np.array([1j * u_x, 1j * u_y, u_z]) * ((1 + nu) / layer.young / q)
            modes = spectra.reshape(9, -1, nx // 2 + 1)
            if ny % 2 == 0:
                modes[:, ny // 2] = (modes[:, ny // 2] + modes[:, ny]) / 2
            upper, lower, stress = self._mean
            modes[:, 0, 0] = *stress, *(upper + (lower - upper) * (depth / height))
            values = [Fourier(self.grid).inverse(each, overwrite=True) for each in modes[:, :ny]]
            xx, yy, zz, yz, xz, xy = values[:6]
            squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
            von_mises = np.sqrt(squares / 2 + 3 * (yz**2 + xz**2 + xy**2))
        fields = dict(zip((*COMPONENTS, *DISPLACEMENTS, "von_mises"), (*values, von_mises), strict=True))
        require_finite("layer_fields", fields)
        return LayerPlane(depth, self.grid, fields)


def layer_fields(
    layer: Solid,
    grid: Grid,
    top: Mapping[str, ArrayLike],
    bottom: Mapping[str, ArrayLike] | None = None,
) -> LayerFields:
    """Fields in a layer or half-space with a traction or a displacement prescribed on each face.

    Each component of a face has a traction or a displacement; one that is not named bears no traction. The
    tractions are t = σ·n with the outward normal n, so that a positive ``traction_z``, upward, pulls on the
    top and pushes on the bottom; a positive ``pressure`` pushes on either face.

    Parameters
    ----------
    layer : Solid
    grid : Grid
        Of the cell, which repeats sideways.
    top, bottom : mapping
        From ``traction_x``, ``traction_y``, ``traction_z`` or ``pressure``, in the unit of Young's modulus,
        ``displacement_x``, ``displacement_y`` or ``displacement_z`` to a number, a field (ny, nx), or the
        complex coefficients (ny, nx // 2 + 1) of a field as in `asperity.fourier.grid`. Without `bottom`
        the layer has its own condition: bonded, frictionless or free. A half-space has none.

    Returns
    -------
    LayerFields
        Its method ``planes(depths)`` streams `LayerPlane` objects, whose dictionary ``fields`` holds the
        stress, the von Mises stress and the displacement.

    Raises
    ------
    TypeError, ValueError
        If an argument is wrong, a component has both a traction and a displacement, or no state of rest
        exists: a net force on a layer that nothing holds along it, a net moment of the shear tractions on one
        whose sides are free, or at ν = 1/2 displacements that change the volume of a confined cell.

    Notes
    -----
    The mean (q = 0) mode follows `Solid.lateral`. Quantities that are then undetermined are set to 0: the
    mean displacement of a half-space and of the middle of a layer that nothing holds, and the mean pressure
    in a confined layer of ν = 1/2 of which both mean normal displacements are prescribed. Equal and opposite
    mean shear tractions on a free layer are a uniform shear if ``lateral`` is "confined": the neighbouring
    cells bear the moment. In other modes bending bears the moment of the tractions.

    The equations and the errors are in ``paper/supplement/method.md``.

    Examples
    --------
    A layer between two rough faces, whose pressures come from two contacts:

    >>> grid = asp.Grid((64, 64))
    >>> layer = asp.Solid(young=1.0, poisson=0.3, height=0.2)
    >>> faces = {}
    >>> for seed, face in enumerate(("top", "bottom")):
    ...     height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=seed)
    ...     faces[face] = {"pressure": asp.solve_contact(height, layer, mean_pressure=2e-3).pressure}
    >>> for plane in asp.elasticity.layer_fields(layer, grid, **faces).planes([0.0, 0.1, 0.2]):
    ...     print(f"{plane.depth:.1f} {plane.fields['zz'].mean():.4f} {plane.fields['zz'].min():.4f}")
    0.0 -0.0020 -0.0298
    0.1 -0.0020 -0.0069
    0.2 -0.0020 -0.0319
    """
    if not isinstance(layer, Solid) or not isinstance(grid, Grid):
        raise TypeError(f"layer = {shown(layer)}, grid = {shown(grid)}: a Solid and a Grid are needed")
    if grid.mirrored:
        raise ValueError(f"grid = {grid}: one that is not mirrored is needed, such as its whole_cell")
    if layer.base is not None:
        raise ValueError(f"layer = {layer!r}: one without a base is needed")
    if layer.height is None and bottom is not None:
        raise ValueError(f"bottom = {shown(bottom)}: None is needed for a half-space")
    if layer.height is not None and layer.height < LOWEST * max(grid.length):
        raise ValueError(f"height = {layer.height:g}: {LOWEST:g} of the cell or more is needed")
    below = dict.fromkeys(ZERO_DISPLACEMENTS[layer.bottom], 0.0) if bottom is None else bottom
    faces = [_prescribed(name, given, grid) for name, given in (("top", top), ("bottom", below))]
    displaced, modes = map(np.array, zip(*faces, strict=True))
    return LayerFields(layer, grid, displaced, modes)


def _prescribed(face: str, given: Any, grid: Grid) -> tuple[Array, Array]:
    """Flags of prescribed displacements on a face, (3,), and the coefficients, (3, ny, nx // 2 + 1).

    Tractions become the components of the stress σ_xz, σ_yz and σ_zz.
    """
    if not isinstance(given, Mapping):
        raise TypeError(f"{face} = {shown(given)}: a mapping from {', '.join(PRESCRIBED)} is needed")
    displaced, modes = np.zeros(3, bool), np.zeros((3, *grid.mode_shape), complex)
    keys: dict[int, str] = {}
    for key, value in given.items():
        choice(f"a key of {face}", key, PRESCRIBED)
        axis = 2 if key == "pressure" else "xyz".index(key[-1])
        if axis in keys:
            raise ValueError(f"{face}: {keys[axis]} and {key} are given; only one of them is accepted")
        keys[axis], displaced[axis] = key, key.startswith("displacement")
        modes[axis] = _coefficients(f"{face}[{key!r}]", value, grid)
        if key == "pressure" or (face == "bottom" and not displaced[axis]):
            modes[axis] *= -1
    return displaced, modes


def _coefficients(name: str, value: Any, grid: Grid) -> Array:
    """Coefficients, (ny, nx // 2 + 1), of a number, a field, or the coefficients of a field."""
    fourier = Fourier(grid)
    if np.ndim(value) == 0:
        uniform = np.zeros(grid.mode_shape, complex)
        uniform[0, 0] = number(name, value, "a finite number or a field", lambda _: True)
        return uniform
    if not np.iscomplexobj(value):
        return fourier.forward(grid.field(name, value))
    modes = np.asarray(value, complex)
    if modes.shape != grid.mode_shape:
        raise ValueError(f"{name} has the shape {modes.shape}: {grid.mode_shape} is needed for coefficients")
    finite_array(name, np.abs(modes))
    if np.abs(fourier.forward(fourier.inverse(modes)) - modes).max() > BALANCE * np.abs(modes).max():
        raise ValueError(f"{name}: the coefficients of a real field are needed, see asperity.fourier.grid")
    return modes


def _mean_state(layer: Solid, displaced: Array, modes: Array) -> tuple[Array, Array, Array]:
    """Mean displacements of top and bottom, (3,), and mean stress, (6,); an error without a state of rest."""
    faces = 1 if layer.height is None else 2
    shear = 2 * (1 + layer.poisson) / layer.young * (layer.height or 0.0)
    compliance = np.array([shear, shear, replace(layer, bottom="bonded").uniform_compliance()])
    given = modes[:faces, :, 0, 0].real
    largest = np.abs(modes[:faces]).max(axis=(2, 3))
    middle, stretch, stress, rounding = np.zeros((4, 3))
    for axis, name in enumerate("xyz"):
        fixed, unit = displaced[:faces, axis], compliance[axis] or 1.0
        half = 0.5 if compliance[axis] else 0.0
        # Displacement of the middle, and the stress times `unit`; the least ones if they are not unique.
        system = np.where(fixed[:, None], [[1, half], [1, -half]][:faces], [0, 1])
        scale = np.where(fixed, 1.0, unit)
        middle[axis], load = found = np.linalg.lstsq(system, scale * given[:, axis], rcond=None)[0]
        limit = BALANCE * (scale * largest[:, axis]).max()
        stretch[axis], stress[axis], rounding[axis] = 2 * half * load, load / unit, limit / unit
        if np.abs(system @ found - scale * given[:, axis]).max() > limit:
            both = f"{given[0, axis]:g} on top and {given[1, axis]:g} on the bottom"
            kind, why = ("displacement_z", "poisson = 0.5") if fixed[0] else (f"σ_{name}z", "no net force")
            raise ValueError(f"mean {kind} = {both}: equal ones are needed for {why}")
    may_tilt = layer.height is not None and layer.lateral == "free" and not displaced[:, 2].any()
    if may_tilt and (np.abs(stress) > rounding)[:2].any():
        shown_stress = f"mean σ_xz, σ_yz = {stress[0]:g}, {stress[1]:g}"
        raise ValueError(f"{shown_stress}: 0 is needed, as nothing bears their moment with lateral = 'free'")
    lateral = -stress[2] * layer.uniform_stress()[0]
    upper, lower = middle + stretch / 2, middle - stretch / 2
    return upper, lower, np.array([lateral, lateral, *stress[::-1], 0.0])


def _amplitudes(layer: Solid, displaced: Array, data: Array, q: Array, cosine: Array, sine: Array) -> Array:
    """Amplitudes of `_states`, (6, modes), for data of x, y, z of the top and of the bottom, (6, modes)."""
    h = q * (layer.height or np.inf)
    none, unit = np.zeros_like(h), np.broadcast_to(np.eye(6)[:, :, None], (6, 6, h.size))
    conditions = []
    for depth, below, fixed in zip((none, h), (h, none), displaced, strict=True):
        states = _to_axes(_states(unit, depth, below, layer.poisson), cosine, sine)
        conditions += [states[axis if fixed[axis] else 3 + axis] for axis in range(3)]
    system, right, thin = np.array(conditions), data.copy(), h < THIN
    for axis in np.flatnonzero(displaced[0] == displaced[1]):
        for values in (system, right):
            top, bottom = values[axis][..., thin], values[3 + axis][..., thin]
            values[axis][..., thin], values[3 + axis][..., thin] = top + bottom, top - bottom
    columns = np.ones((6, h.size))
    for _ in range(SCALINGS):
        size = np.sqrt(np.abs(system).max(axis=1))
        system /= size[:, None]
        right /= size
        size = np.sqrt(np.abs(system).max(axis=0))
        system /= size
        columns *= size
    right = np.ascontiguousarray(right.T).view(float).reshape(-1, 6, 2)
    solution = np.linalg.solve(np.ascontiguousarray(np.moveaxis(system, -1, 0)), right)
    return solution.view(complex)[..., 0].T / columns


def _to_axes(states: Array, cosine: Array, sine: Array) -> Array:
    """U and S along x, y and z, from U and S along and across the wavevector, and z."""
    out = states.copy()
    for first in (0, 3):
        along, across = states[first : first + 2]
        out[first], out[first + 1] = cosine * along - sine * across, sine * along + cosine * across
    return out


def _states(amplitudes: Array, depth: Array, below: Array, poisson: float) -> Array:
    """States U_l, U_t, U_z, S_l, S_t and S_z, (6, ..., modes), of amplitudes of the same shape.

    `depth` and `below` are the distances from the top and from the bottom times q, (modes,).
    """
    thin, out = depth + below < THIN, np.empty_like(amplitudes)
    # In a thin layer, exp(s A) times the states in its middle, at the distance s/q from there.
    middle, s = amplitudes[..., thin], (below - depth)[thin] / 2
    p, r = 1 / (1 - poisson), poisson / (1 - poisson)
    a = np.zeros((6, 6))
    a[0, [2, 3]], a[1, 4] = (-1, 2), 2
    a[2, [0, 5]], a[3, [0, 5]] = (r, p * (1 - 2 * poisson)), (p, -r)
    a[4, 1], a[5, 3] = 0.5, 1
    n = a @ a - np.eye(6)
    factors = np.cosh(s), np.sinh(s), s * np.sinh(s) / 2, s**3 * polyval(s * s, _SERIES) / 2
    parts = zip(factors, (np.eye(6), a, n, n @ a), strict=True)
    out[..., thin] = sum(factor * np.tensordot(matrix, middle, 1) for factor, matrix in parts)
    thick, mirror = amplitudes[..., ~thin], np.diag([1, 1, -1, -1, -1, 1])
    downward = _half_space_states(thick[:3], depth[~thin], poisson)
    upward = _half_space_states(thick[3:], below[~thin], poisson)
    out[..., ~thin] = downward + np.tensordot(mirror, upward, 1)
    return out


def _half_space_states(tractions: Array, depth: Array, poisson: float) -> Array:
    """States of a half-space under S_l, S_t and S_z at its top, at the depth depth/q."""
    d, m = np.minimum(depth, NOTHING_LEFT), 1 - 2 * poisson
    surface = np.array([[1 + m, 0, -m], [0, 2, 0], [-m, 0, 1 + m], *np.eye(3)])
    change = np.multiply.outer([1, 0, 1, 1, 0, 1], d * (tractions[2] - tractions[0]))
    return np.exp(-d) * (np.tensordot(surface, tractions, 1) + change)
