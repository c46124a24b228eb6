"""Stress inside the solid, plane by plane, on grids no finer than the depth needs.

At depth d a mode of the contact pressure with wavenumber q has decayed to (1 + q d) e^(−q d) of its
surface value, so a deep plane is smooth and a coarse grid holds it. `linear_planes` streams planes on the
coarsest grid whose dropped modes are proven to matter less than `tolerance`; `stress_planes` gives chosen
fields of them by name.

Conventions: `depth` is measured downward from the surface, tension is positive, stresses are in units of
E* = E/(1 − ν²). Components are named ``xx, yy, zz, yz, xz, xy``, and ``von_mises`` is the equivalent stress.

Poisson's ratio
---------------
In a half-space the stress is A + ν B with fields A and B that do not depend on ν (only the uniform mode
adds a term ν/(1 − ν)), and so does the contact pressure in units of E*. At most eight inverse
transforms a plane then serve every Poisson's ratio. A layer of finite height has the ν of its contact.

Bound
-----
A mode of pressure amplitude |p̂| has, at depth d, no component and no equivalent stress larger than
√3 (1 + q d) e^(−q d) |p̂| (twice that in a layer). The sum over the modes that a grid drops bounds the
error at every node, and the grid is the coarsest whose bound is below `tolerance` times the root mean
square of σ_zz in that plane, itself at most the largest |σ_zz| there. Planes are computed in single
precision where `tolerance` is well above its rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.spectral import Fourier, Grid, Work, good_size, resample
from asperity.types import Array

FIELDS = (*COMPONENTS, "von_mises")

_FEWEST_NODES = 16

# Tolerances from which single precision will do: its transforms round to a few 1e-7 of the root mean square.
_SINGLE = 3e-5


class Contact(Protocol):
    """What the stress in the solid needs from a contact."""

    @property
    def pressure(self) -> Array:
        """Contact pressure [y, x], compression positive."""

    @property
    def grid(self) -> Grid:
        """Its grid."""

    @property
    def layer(self) -> Layer:
        """The solid."""


@dataclass(frozen=True)
class StressPlane:
    """Fields of one plane.

    Parameters
    ----------
    depth : float
    grid : Grid
        Of the same cell as the contact, no finer.
    fields : dict
        Name → array (ratios, ny, nx) in units of E*, one entry for each Poisson's ratio.
    bound : float
        Proven largest error of any field at any node, in units of E*: the dropped modes.
    """

    depth: float
    grid: Grid
    fields: dict[str, Array]
    bound: float


def depth_grid(grid: Grid, height: float | None = None, spacing: float = 0.5, growth: float = 0.125) -> Array:
    """Depths from the surface to the bottom: fine where peaks live, widening below.

    A contact spot of radius a has its peak at 0.4–0.55 a and changes over lengths of about a: a feature
    met at depth d is at least about 2 d wide, because the modes shorter than that have decayed. Planes are
    therefore `spacing` grid spacings apart at first, and `growth` × depth apart below.

    Parameters
    ----------
    grid : Grid
        Of the contact pressure.
    height : float, optional
        Depth of the last plane; without it the longer edge of the cell.
    spacing : float
        Distance between the planes nearest to the surface, in spacings of the grid.
    growth : float
        Largest distance between planes, relative to their depth.

    Returns
    -------
    depths : (planes,) array
        Rising from 0 to the height.
    """
    for name, value in (("spacing", spacing), ("growth", growth)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a positive finite number is needed")
    bottom = max(grid.length) if height is None else float(height)
    if not (np.isfinite(bottom) and bottom > 0):
        raise ValueError(f"height = {height!r}: a positive finite length is needed")
    finest = spacing * min(grid.spacing)
    depths = [0.0]
    while depths[-1] < bottom:
        depths.append(depths[-1] + max(finest, growth * depths[-1]))
    depths[-1] = bottom
    if len(depths) > 2 and bottom - depths[-2] < 0.5 * (depths[-2] - depths[-3]):
        del depths[-2]
    return np.array(depths)


class Truncation:
    """The coarsest grid that holds the stress at a depth, and the bound that proves it.

    Parameters
    ----------
    pressure : (ny, nx // 2 + 1) complex array
        Coefficients of the contact pressure.
    grid : Grid
        Their grid.
    layer : Layer
    tolerance : float
        Largest error relative to the root mean square of σ_zz in the plane; 0 keeps the grid.
    """

    def __init__(self, pressure: Array, grid: Grid, layer: Layer, tolerance: float) -> None:
        if not (np.isfinite(tolerance) and 0 <= tolerance < 1):
            raise ValueError(f"tolerance = {tolerance!r}: a number from 0 to below 1 is needed")
        self.grids = _ladder(grid)
        self.tolerance = tolerance
        self._layer = layer
        self._envelope = np.sqrt(3.0) * (1.0 if layer.height is None else 2.0)
        width = 2 * np.pi / max(grid.length)
        ring = (grid.wavenumber() / width).astype(np.int64)
        rings = int(ring.max()) + 1
        self._wavenumber = width * np.arange(rings)
        amplitude = np.abs(pressure) * grid.multiplicity
        self._power = np.bincount(ring.ravel(), (amplitude * np.abs(pressure)).ravel(), rings)
        self._mean_square = float(np.abs(pressure[0, 0]) ** 2)
        self._power[0] = 0.0
        last = _coarsest(grid, self.grids)
        flat = (last * rings + ring).ravel()
        amount = np.bincount(flat, amplitude.ravel(), len(self.grids) * rings).reshape(-1, rings)
        self._dropped = np.cumsum(amount, axis=0) - amount

    def scale(self, depth: float) -> float:
        """Root mean square of σ_zz at `depth`, from the spectrum (each ring at its outer edge)."""
        outer = self._wavenumber + self._wavenumber[1] if self._wavenumber.size > 1 else self._wavenumber + 1
        normal = np.asarray(self._layer.kernels(outer, depth).normal)
        return float(np.sqrt(self._mean_square + np.sum(self._power * normal**2)))

    def bounds(self, depth: float) -> Array:
        """Largest error of any stress at `depth` on each of the grids."""
        decay = self._wavenumber * depth
        return self._envelope * (self._dropped @ ((1 + decay) * np.exp(-decay)))

    def choose(self, depth: float) -> tuple[Grid, float]:
        """The coarsest sufficient grid, and its bound."""
        if self.tolerance == 0:
            return self.grids[0], 0.0
        bounds = self.bounds(depth)
        sufficient = np.flatnonzero(bounds <= self.tolerance * self.scale(depth))
        return self.grids[sufficient[-1]], float(bounds[sufficient[-1]])


def _ladder(grid: Grid) -> list[Grid]:
    """Grids of the same cell, finest first, each about a sixth coarser than the one before."""
    grids = [grid]
    halving = 1.0
    while True:
        for eighths in (7, 6, 5, 4):
            fraction = halving * eighths / 8
            shape = tuple(
                min(n, max(good_size(int(np.ceil(n * fraction))), _FEWEST_NODES)) for n in grid.shape
            )
            if shape != grids[-1].shape:
                grids.append(Grid((shape[0], shape[1]), grid.length))
        halving /= 2
        if min(grid.shape) * halving < _FEWEST_NODES:
            return grids


def _coarsest(grid: Grid, grids: Sequence[Grid]) -> Array:
    """Number of the last (coarsest) of the grids that keeps each stored mode."""
    last = np.zeros(grid.half_shape, np.int64)
    for number, coarse in enumerate(grids[1:], start=1):
        rows = 2 * np.abs(grid.ky) < coarse.shape[0]
        columns = 2 * grid.kx < coarse.shape[1]
        last[np.ix_(rows, columns)] = number
    return last


@dataclass(frozen=True)
class LinearPlane:
    """One plane of the stress in linear parts, from which every field and Poisson's ratio follows.

    Parameters
    ----------
    depth, grid, bound
        As in `StressPlane`.
    constant : dict
        Component → field A[y, x], in units of E*.
    slope : dict
        Component → field B[y, x]; the stress is A + ν B. Empty if ν is fixed. With all components there,
        B_yy is left out: it follows from A_xx + A_yy + A_zz = B_xx + B_yy.
    mean_pressure : float
        In units of E*.
    lateral : mapping of float to float
        Poisson's ratio → uniform part of σ_xx and σ_yy, in units of E*.
    done : float
        Share of the work of the whole stream that is done with this plane.
    """

    depth: float
    grid: Grid
    bound: float
    constant: dict[str, Array]
    slope: dict[str, Array]
    mean_pressure: float
    lateral: dict[float, float]
    done: float = 1.0

    @property
    def dtype(self) -> np.dtype[Any]:
        """Precision of the fields."""
        return next(iter(self.constant.values())).dtype

    def field(self, name: str, poisson: float, out: Array | None = None) -> Array:
        """The field `name` for one Poisson's ratio, (ny, nx)."""
        if out is None:
            out = np.empty(next(iter(self.constant.values())).shape, self.dtype)
        a, b = self.constant, self.slope
        uniform = self.lateral[poisson]
        ratio = poisson if b else 0.0
        if name == "von_mises":
            xx, yy, zz, yz, xz, xy = (a[c].reshape(-1) for c in COMPONENTS)
            slope_xx, slope_xy = ((b or a)[c].reshape(-1) for c in ("xx", "xy"))
            mean = self.mean_pressure
            _von_mises(xx, yy, zz, yz, xz, xy, slope_xx, slope_xy, ratio, uniform, mean, out.reshape(-1))
        elif name == "yy" and b and "yy" not in b:
            slope = a["xx"] + a["yy"] + a["zz"] + self.mean_pressure - b["xx"]
            _combine(a["yy"].reshape(-1), slope.reshape(-1), ratio, uniform, out.reshape(-1))
        elif name in ("xx", "yy"):
            _combine(a[name].reshape(-1), (b or a)[name].reshape(-1), ratio, uniform, out.reshape(-1))
        elif name == "xy":
            _combine(a[name].reshape(-1), (b or a)[name].reshape(-1), ratio, 0.0, out.reshape(-1))
        else:
            out[...] = a[name]
        return out

    def look(self, name: str, poisson: float, gather: Callable[[Array], Array]) -> Array:
        """The field where `gather` takes values of the linear parts from."""
        needed = COMPONENTS if name == "yy" and len(self.constant) == 6 else _needed((name,))
        constant, slope = (
            {part: gather(array) for part, array in parts.items() if part in needed}
            for parts in (self.constant, self.slope)
        )
        return replace(self, constant=constant, slope=slope).field(name, poisson)


def linear_planes(
    contact: Contact,
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    components: Sequence[str] = ("von_mises",),
    tolerance: float = 1e-6,
    threads: int = 1,
    work: Work | None = None,
) -> Iterator[LinearPlane]:
    """Stream the stress in linear parts, one plane at a time; arguments as in `stress_planes`."""
    depths = _checked_depths(depths, contact.layer)
    ratios = _checked_ratios(poisson, contact.layer)
    needed = _needed(components)
    if threads < 1:
        raise ValueError(f"threads = {threads!r}: at least 1 is needed")
    return _linear_planes(contact, depths, ratios, needed, tolerance, threads, work or Work())


def _linear_planes(
    contact: Contact,
    depths: Array,
    ratios: list[float],
    needed: tuple[str, ...],
    tolerance: float,
    threads: int,
    work: Work,
) -> Iterator[LinearPlane]:
    layer, grid = contact.layer, contact.grid
    modulus = layer.effective_modulus
    pressure = Fourier(grid, threads=threads, work=work).forward(contact.pressure / modulus)
    mean = float(pressure[0, 0].real)
    truncation = Truncation(pressure, grid, layer, tolerance)
    lateral = {nu: mean * float(replace(layer, poisson=nu).uniform_stress()[0]) for nu in ratios}
    split = len(ratios) > 1
    tasks = [(name, 1.0, 0.0 if split else ratios[0]) for name in needed]
    sloping = ("xx", "xy") if needed == COMPONENTS else ("xx", "yy", "xy")
    tasks += [(name, 0.0, 1.0) for name in needed if split and name in sloping]
    plan = [truncation.choose(depth) for depth in depths]
    done = np.cumsum([chosen.size for chosen, _ in plan], dtype=float)
    done /= done[-1]
    dtype = "float32" if tolerance >= _SINGLE else "float64"
    coarse, coefficients = grid, pressure
    with ThreadPoolExecutor(threads) as pool:
        for depth, (chosen, bound), share in zip(depths, plan, done, strict=True):
            if chosen.shape != coarse.shape:
                coarse, coefficients = chosen, resample(pressure, grid, chosen)
            transform = _PlaneTransform(coefficients, Fourier(coarse, dtype), layer, depth)
            fields = list(pool.map(transform, *zip(*tasks, strict=True)))
            work.nodes += len(tasks) * coarse.size
            constant = dict(zip(needed, fields, strict=False))
            slope = dict(zip((name for name, *_ in tasks[len(needed) :]), fields[len(needed) :], strict=True))
            del fields, transform
            yield LinearPlane(float(depth), coarse, bound, constant, slope, mean, lateral, float(share))
            del constant, slope


class _PlaneTransform:
    """Fields a A + b B of one plane from the coefficients of the pressure."""

    def __init__(self, pressure: Array, fourier: Fourier, layer: Layer, depth: float) -> None:
        self._pressure, self._fourier = pressure, fourier
        # The rows of −ky have the kernels of those of ky.
        kernels = layer.grid_kernels(fourier.grid, depth, fourier.real)
        self._kernels = kernels.normal, kernels.longitudinal, kernels.shear

    def __call__(self, name: str, a: float, b: float) -> Array:
        grid = self._fourier.grid
        coefficients = np.empty(grid.half_shape, self._fourier.complex)
        normal, longitudinal, shear = self._kernels
        _mode_stress(
            COMPONENTS.index(name),
            a,
            b,
            self._pressure,
            normal,
            longitudinal,
            shear,
            grid.qx,
            grid.qy,
            grid.odd_qx,
            grid.odd_qy,
            coefficients,
        )
        return self._fourier.inverse(coefficients, overwrite=True)


def stress_planes(
    contact: Contact,
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    components: Sequence[str] = ("von_mises",),
    tolerance: float = 1e-6,
    threads: int = 1,
    progress: Callable[[float, float], None] | None = None,
    work: Work | None = None,
) -> Iterator[StressPlane]:
    """Stream fields of the solid, one plane at a time.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
        Any non-negative pressure will do.
    depths : (planes,) array
        Rising depths, ≥ 0; of a layer no more than its height.
    poisson : float or sequence, optional
        Poisson's ratios, on the half-space any number at once; by default that of the contact. In a layer
        of finite height only that of the contact, on which its pressure depends.
    components : names
        Any of ``xx, yy, zz, yz, xz, xy, von_mises``. Only what they need is computed.
    tolerance : float
        Largest error of any field at any node where a plane is computed on a coarser grid, relative to the
        root mean square of σ_zz in that plane. 0 computes every plane on the grid of the contact.
    threads : int
        The result does not depend on it.
    progress : callable, optional
        Called as progress(done, total) after each plane, in planes weighted with their nodes.
    work : Work, optional
        Where the transforms are counted.

    Yields
    ------
    StressPlane

    Raises
    ------
    ValueError
        If an argument is out of range.
    """
    ratios = _checked_ratios(poisson, contact.layer)
    planes = linear_planes(contact, depths, ratios, components, tolerance, threads, work)
    return _stress_planes(planes, ratios, tuple(components), progress)


def _stress_planes(
    planes: Iterator[LinearPlane],
    ratios: list[float],
    names: tuple[str, ...],
    progress: Callable[[float, float], None] | None,
) -> Iterator[StressPlane]:
    for plane in planes:
        fields = {}
        for name in names:
            fields[name] = np.empty((len(ratios), *plane.grid.shape), plane.dtype)
            for out, nu in zip(fields[name], ratios, strict=True):
                plane.field(name, nu, out)
        yield StressPlane(plane.depth, plane.grid, fields, plane.bound)
        if progress is not None:
            progress(plane.done, 1.0)


def _checked_depths(depths: ArrayLike, layer: Layer) -> Array:
    array = np.atleast_1d(np.asarray(depths, dtype=float))
    if (
        array.ndim != 1
        or not array.size
        or not np.all(np.isfinite(array))
        or np.any(array < 0)
        or np.any(np.diff(array) <= 0)
    ):
        raise ValueError(f"depths = {depths!r}: rising finite depths from 0 are needed")
    if layer.height is not None and array[-1] > layer.height * (1 + 1e-12):
        raise ValueError(
            f"depths = {array[-1]!r}: at most the height of the layer, {layer.height}, is needed"
        )
    return array if layer.height is None else np.minimum(array, layer.height)


def _checked_ratios(poisson: float | Sequence[float] | None, layer: Layer) -> list[float]:
    ratios = [layer.poisson] if poisson is None else [float(nu) for nu in np.atleast_1d(np.asarray(poisson))]
    if not ratios or any(not (-1 < nu <= 0.5) for nu in ratios):
        raise ValueError(f"poisson = {poisson!r}: numbers above -1 and up to 0.5 are needed")
    if layer.height is not None and ratios != [layer.poisson]:
        raise ValueError(
            f"poisson = {poisson!r}: in a layer of finite height only that of its contact, {layer.poisson}, "
            "on which the pressure depends"
        )
    return ratios


def _needed(components: Sequence[str]) -> tuple[str, ...]:
    if isinstance(components, str) or not components or any(name not in FIELDS for name in components):
        raise ValueError(f"components = {components!r}: names from {', '.join(FIELDS)} are needed")
    if "von_mises" in components:
        return COMPONENTS
    return tuple(name for name in COMPONENTS if name in components)


@njit(cache=True, error_model="numpy", nogil=True)
def _mode_stress(
    component: int,
    a: float,
    b: float,
    pressure: Any,
    normal: Any,
    longitudinal: Any,
    shear: Any,
    qx: Any,
    qy: Any,
    odd_qx: Any,
    odd_qy: Any,
    out: Any,
) -> None:
    """Coefficients of a A + b B of one component (number in COMPONENTS) from those of the pressure."""
    rows, columns = out.shape
    for j in range(rows):
        mirrored = min(j, rows - j)
        for i in range(columns):
            square = qx[i] * qx[i] + qy[j] * qy[j]
            if square == 0.0:
                out[j, i] = -a * pressure[j, i] if component == 2 else 0.0
                continue
            z = normal[mirrored, i]
            along = longitudinal[mirrored, i]
            if component == 2:
                out[j, i] = -a * z * pressure[j, i]
            elif component == 0:
                factor = (a * qx[i] * qx[i] * along + b * qy[j] * qy[j] * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            elif component == 1:
                factor = (a * qy[j] * qy[j] * along + b * qx[i] * qx[i] * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            elif component == 5:
                factor = odd_qx[i] * odd_qy[j] * (a * along - b * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            else:
                odd = odd_qy[j] if component == 3 else odd_qx[i]
                factor = a * odd * shear[mirrored, i] / np.sqrt(square)
                p = pressure[j, i]
                out[j, i] = complex(factor * p.imag, -factor * p.real)


@njit(cache=True, error_model="numpy", nogil=True)
def _combine(a: Any, b: Any, ratio: float, uniform: float, out: Any) -> None:
    """Sum of a, ratio times b, and a uniform part."""
    for n in range(a.size):
        out[n] = a[n] + ratio * b[n] + uniform


@njit(cache=True, error_model="numpy", nogil=True)
def _von_mises(
    xx: Any,
    yy: Any,
    zz: Any,
    yz: Any,
    xz: Any,
    xy: Any,
    slope_xx: Any,
    slope_xy: Any,
    ratio: float,
    uniform: float,
    mean_pressure: float,
    out: Any,
) -> None:
    """Equivalent stress of von Mises."""
    for n in range(xx.size):
        x, y, z = xx[n], yy[n], zz[n]
        slope_yy = x + y + z + mean_pressure - slope_xx[n]
        x += ratio * slope_xx[n] + uniform
        y += ratio * slope_yy + uniform
        t = xy[n] + ratio * slope_xy[n]
        normal = (x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)
        out[n] = np.sqrt(0.5 * normal + 3.0 * (t * t + yz[n] * yz[n] + xz[n] * xz[n]))
