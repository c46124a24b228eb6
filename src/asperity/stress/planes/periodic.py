"""Basis fields of the stress in planes under a periodic pressure, transformed from its modes.

On a mirrored map the coefficients are real: of cosines, and of sines along the axes on which a component is
odd (`asperity.stress.planes.fields.ODD`). Coefficients of sines begin with the first wave, as the engines
take them, so that their indices are one lower. An odd component has, for each such axis, a factor i q_x or i
q_y for exponentials, and −q_x or −q_y for cosines.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from asperity.core.compiled import compiled, fused, fused_inlined
from asperity.core.parallel import KeptArrays, run_tasks
from asperity.core.types import Array
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import COMPONENTS
from asperity.fourier.grid import EVEN, Fourier, Grid, Work
from asperity.stress.planes.fields import NODES_AT_ONCE, ODD, BasisField, Visit, bands_of, strips_of
from asperity.stress.planes.truncation import PlaneGrid, Truncation, coarser_grids

_XX, _YY, _ZZ, _YZ, _XZ, _XY = range(6)
_PLACES = {name: place for place, name in enumerate(COMPONENTS)}

COLUMNS_AT_ONCE = 32
"""Fewest columns of modes that are transformed along y together."""

FACTORS_AT_ONCE = 512
"""Modes whose factors are computed together, if a row has no more: loops over fewer ones take longer."""


class PeriodicPlanes:
    """Transforms of basis fields of the stress under a periodic pressure.

    Parameters
    ----------
    solid : LoadedSolid
    tolerance : float
        Of the planes on coarser grids, see `asperity.stress_planes`.
    envelope : callable
        Depth → the constant K of `asperity.stress.planes.truncation.envelope_of`.
    traction : (x, y)
        Shear traction over pressure.
    threads : int
    work : Work
    dtype : "float32" | "float64"
        Precision of the planes.

    Attributes
    ----------
    choose : callable
        Depth → the `PlaneGrid` of that plane.
    mean_pressure : float
    dtype : dtype
    """

    def __init__(
        self,
        solid: LoadedSolid,
        tolerance: float,
        envelope: Callable[[float], float],
        traction: tuple[float, float],
        threads: int,
        work: Work,
        dtype: str,
    ) -> None:
        self._layer, self._traction, self._threads, self._work = solid.layer, traction, threads, work
        self._background = solid.background
        fourier = Fourier(solid.grid, threads=threads, work=work)
        modes = sliding = fourier.forward(solid.pressure)
        if solid.sticking_pressure is not None and any(traction):
            sliding = fourier.forward(solid.sliding_pressure)
        grids = coarser_grids(solid.grid)
        self.choose = Truncation(modes, grids, solid.layer, tolerance, envelope, sliding=sliding).choose
        self.mean_pressure, self._mean_sliding = float(modes[0, 0].real), float(sliding[0, 0].real)
        self.dtype = np.dtype(dtype)
        self._pressure, self._kept = solid.pressure, KeptArrays()
        precision = Fourier(solid.grid, self.dtype).coefficient_type
        self._finest, self._modes = solid.grid, {"modes": modes.astype(precision, copy=False)}
        if sliding is not modes:
            self._modes["sliding"] = sliding.astype(precision, copy=False)
        self._use(solid.grid)

    def _use(self, grid: Grid) -> None:
        """Prepare the transforms on a grid."""
        self._fourier = Fourier(grid, self.dtype)
        self._along_x, self._along_y = (
            np.stack(pair).astype(self.dtype) for pair in ((grid.qx, grid.odd_qx), (grid.qy, grid.odd_qy))
        )

    def _modes_of(self, name: str, columns: slice) -> Array:
        """Modes of the pressure, or the sliding part of it, on the present grid in some columns."""
        modes, grid = self._modes[name], self._fourier.grid
        out = self._kept.array(name, (grid.shape[0], columns.stop - columns.start), modes.dtype)
        if grid == self._finest:
            np.copyto(out, modes[:, columns])
            return out
        out[:] = 0
        rows, kept = (
            (grid.shape[0] - 1) // 2,
            slice(columns.start, min(columns.stop, (grid.shape[1] + 1) // 2)),
        )
        count = kept.stop - kept.start
        out[: rows + 1, :count] = modes[: rows + 1, kept]
        out[out.shape[0] - rows :, :count] = modes[modes.shape[0] - rows :, kept]
        return out

    @staticmethod
    def row_length(grid: Grid) -> int:
        """Numbers in a row of the array that is filled: room for the coefficients of a row.

        An odd multiple of 16: rows that are a multiple of 4096 bytes apart share the same lines of the cache.
        """
        numbers = grid.mode_shape[1] if grid.mirrored else 2 * grid.mode_shape[1]
        return 16 * (-(-numbers // 16) | 1)

    def compute(
        self,
        depth: float,
        own: PlaneGrid,
        fields: Sequence[BasisField],
        values: Array,
        visit: Visit | None = None,
    ) -> None:
        """Compute the basis fields of one plane.

        Parameters
        ----------
        depth : float
        own : PlaneGrid
            Of this plane.
        fields : sequence of BasisField
        values : (fields, ny, `row_length`) array
            The first nx columns are filled.
        visit : callable, optional
            Called when some rows are filled.
        """
        grid = own.grid
        if grid != self._fourier.grid:
            self._use(grid)
        ny, nx = grid.shape
        spectra = values.view(self._fourier.coefficient_type)[:, :, : grid.mode_shape[1]]
        numbers = spectra.itemsize // values.itemsize  # of a coefficient
        along_x = list(range(len(fields)))
        first = {field.component: number for number, field in reversed(list(enumerate(fields)))}
        is_surface = is_xz_derived = False
        is_plain = self._background is None and not any(self._traction)
        if len(first) == len(COMPONENTS) and self._layer.height is None and is_plain:
            is_surface = depth == 0 and grid == self._finest
            is_xz_derived = not is_surface and fields[first["xx"]].slope >= 0
        own_fields = list(fields)
        mean = self.dtype.type(self.mean_pressure)
        combinations = np.array([_in_surface(field) for field in fields], self.dtype)
        if is_surface:
            along_x = [first["xx"], first["xy"]]
            own_fields = [BasisField(field.component, 1.0, 0.0) for field in fields]
        along_y = [n for n in along_x if not (is_xz_derived and n == first["xz"])]
        odd = [ODD.get(field.component, EVEN) for field in fields]

        if is_xz_derived:
            constant, slope = fields[first["xx"]][1:]
            factor = self._along_x[1, : own.columns] * self.dtype.type(
                fields[first["xz"]].constant * 0.5 * depth / (constant + slope)
            )
            places = tuple(first[name] for name in ("xx", "yy", "zz", "xz"))
        # The spectra of some columns stay in the processor's cache until they are transformed.
        together = max(COLUMNS_AT_ONCE, NODES_AT_ONCE // ny)

        def transform_columns(start: int) -> None:
            columns = slice(start, min(start + together, own.columns))
            found = self._coefficients(depth, [own_fields[n] for n in along_y], columns)
            self._back_along_y(found, spectra, columns, along_y, odd)

        def transform_rows(band: int) -> None:
            shared = np.empty((4, nx + 2), self.dtype)
            for start, stop in strips_of(bands[band], nx):
                if is_xz_derived:
                    trace = shared[0, : numbers * own.columns]
                    _fill_xz(places, factor, numbers == 1, start, stop, trace, values)
                for n in along_x:
                    first_zero = numbers * own.columns - (grid.mirrored and odd[n][1])
                    values[n, start:stop, first_zero : numbers * spectra.shape[2]] = 0
                self._back_along_x(spectra[:, start:stop], values[:, start:stop, :nx], along_x, odd)
                if is_surface:
                    known = np.array([first["xx"], first["xy"]])
                    memory = shared[:, :nx]
                    _fill_surface(self._pressure, mean, known, combinations, start, stop, memory, values)
                if visit is not None:
                    visit(band, start, stop)

        starts, bands = range(0, own.columns, together), bands_of(ny)
        run_tasks([partial(transform_columns, start) for start in starts], self._threads)
        run_tasks([partial(transform_rows, band) for band in range(len(bands))], self._threads)
        columns = len(along_y) * own.columns / grid.mode_shape[1]
        self._work.nodes += round(grid.size * (len(along_x) + columns) / 2)

    def _back_along_y(
        self,
        found: Array,
        spectra: Array,
        columns: slice,
        fields: Sequence[int],
        odd: Sequence[tuple[bool, bool]],
    ) -> None:
        """Transform some columns of coefficients of some fields along y to their places in `spectra`."""
        engine, done = self._fourier.engine, 0
        if self._fourier.grid.mirrored:
            for own, n in zip(found, fields, strict=True):
                odd_y, odd_x = odd[n]
                shift = int(odd_x)
                own = own[:, max(shift - columns.start, 0) :]  # without k = 0
                stop = columns.stop - shift
                if own.size:  # deep planes have k = 0 alone
                    engine.cosines(own, spectra[n, :, stop - own.shape[1] : stop], 0, odd_y, False)
            return
        for some in _runs(fields):
            count = some.stop - some.start
            engine.inverse_along_y(found[done : done + count], spectra[some, :, columns])
            done += count

    def _back_along_x(
        self, spectra: Array, values: Array, fields: Sequence[int], odd: Sequence[tuple[bool, bool]]
    ) -> None:
        """Transform rows of some fields along x."""
        engine = self._fourier.engine
        if self._fourier.grid.mirrored:
            for n in fields:
                engine.cosines(spectra[n], values[n], 1, odd[n][1], False)
            return
        for some in _runs(fields):
            engine.inverse_along_x(spectra[some], values[some])

    def _coefficients(self, depth: float, fields: Sequence[BasisField], columns: slice) -> Array:
        """Coefficients of basis fields in some columns, (fields, ny, columns)."""
        real, kept, grid, modes = self.dtype.type, self._kept, self._fourier.grid, self._modes["modes"]
        count = columns.stop - columns.start
        out = kept.array("coefficients", (len(fields), grid.shape[0], count), modes.dtype)
        wavevector = np.ascontiguousarray(self._along_x[0, columns]), self._along_y[0, : grid.half_shape[0]]
        kinds = np.array([_PLACES[field.component] for field in fields])
        factors = np.array([field[1:] for field in fields], self.dtype)
        kernels = np.empty((3, 1, 1), self.dtype)
        if is_layer := self._layer.height is not None:
            kernels = np.stack(self._layer.kernels(self._wavenumber(columns), depth)[:3])
        numbers = max(1, FACTORS_AT_ONCE // count) * count
        row = kept.array("row", (3, numbers), float)
        memory = row, row[2].view(np.int64), kept.array("shared", (10, numbers), self.dtype)
        source = modes.view(self.dtype), modes.itemsize // self.dtype.itemsize * columns.start
        settings = (kinds, factors), real(depth), wavevector, is_layer, kernels
        _fill_spectra(*settings, memory, source, out.view(self.dtype))
        if not grid.mirrored:
            # A coarser grid, or an odd component, has no Nyquist modes.
            (ny, nx), is_coarser = self._fourier.grid.shape, self._fourier.grid != self._finest
            for number, (component, _, _) in enumerate(fields):
                odd_y, odd_x = ODD.get(component, EVEN)
                if ny % 2 == 0 and (is_coarser or odd_y):
                    out[number, ny // 2] = 0
                if nx % 2 == 0 and columns.stop > nx // 2 and (is_coarser or odd_x):
                    out[number, :, nx // 2 - columns.start] = 0
        if any(self._traction):
            q = self._wavenumber(columns)
            shear_kernels = tuple(self._layer.shear_kernels(q, depth))
            over_q = 1 / np.where(q > 0, q, np.inf).astype(self.dtype)
            directions = np.ascontiguousarray(self._along_x[:, columns]), self._along_y, over_q
            sliding = tuple(map(real, self._traction)), directions, shear_kernels
            modes = self._modes_of("sliding" if "sliding" in self._modes else "modes", columns)
            for kind, (constant, slope), spectrum in zip(kinds, factors, out, strict=True):
                _add_sliding(kind, constant, slope, *sliding, modes, spectrum)
        if columns.start == 0:
            added = np.zeros(len(COMPONENTS)) if self._background is None else self._background(depth)
            for (component, constant, slope), spectrum in zip(fields, out, strict=True):
                if not (grid.mirrored and component in ODD):
                    own = self._mean(BasisField(component, constant, slope))
                    spectrum[0, 0] = own + constant * added[_PLACES[component]]
        return out

    def _wavenumber(self, columns: slice) -> Array:
        return self._fourier.grid.half_wavenumber(columns=columns).astype(self.dtype)

    def _mean(self, field: BasisField) -> float:
        along_x, along_y = (share * self._mean_sliding for share in self._traction)
        means = {"zz": -self.mean_pressure, "xz": along_x, "yz": along_y}
        return field.constant * means.get(field.component, 0.0)


def _runs(numbers: Sequence[int]) -> list[slice]:
    """Slices of consecutive numbers, which rise."""
    edges = [0, *(k for k in range(1, len(numbers)) if numbers[k] > numbers[k - 1] + 1), len(numbers)]
    return [slice(numbers[start], numbers[stop - 1] + 1) for start, stop in pairwise(edges)]


def _in_surface(field: BasisField) -> tuple[float, float, float, float]:
    """Factors of A_xx, A_yy, A_zz and A_xy in a basis field in the surface of a half-space.

    There σ_zz is minus the pressure, σ_yz and σ_xz are zero, and A_xx + A_yy = σ_zz, B_xx = 2 A_yy,
    B_yy = 2 A_xx and B_xy = −2 A_xy in all modes but the mean: A_xx and A_xy alone are transformed.
    """
    a, b = field.constant, field.slope
    return {
        "xx": (a, 2 * b, 0.0, 0.0),
        "yy": (2 * b, a, 0.0, 0.0),
        "zz": (0.0, 0.0, a, 0.0),
        "xy": (0.0, 0.0, 0.0, a - 2 * b),
    }.get(field.component, (0.0, 0.0, 0.0, 0.0))


@compiled
def _fill_surface(
    pressure: Any, mean: float, places: Any, factors: Any, start: int, stop: int, shared: Any, values: Any
) -> None:
    """Fill rows of the basis fields in the surface from A_xx and A_xy, whose places in `values` are given.

    `shared` is an array (4, nx) in the precision of the planes.
    """
    xx, yy, zz, xy = shared[0], shared[1], shared[2], shared[3]
    for j in range(start, stop):
        own_xx, own_xy, above = values[places[0], j], values[places[1], j], pressure[j]
        for i in range(xx.size):
            xx[i] = own_xx[i]
        for i in range(xx.size):
            xy[i] = own_xy[i]
        for i in range(xx.size):
            zz[i] = -above[i]
        for i in range(xx.size):
            yy[i] = zz[i] - xx[i] + mean
        for n in range(values.shape[0]):
            a, b, c, d = factors[n, 0], factors[n, 1], factors[n, 2], factors[n, 3]
            out = values[n, j, : xx.size]
            for i in range(xx.size):
                out[i] = a * xx[i] + b * yy[i]
            if c != 0 or d != 0:
                for i in range(xx.size):
                    out[i] += c * zz[i] + d * xy[i]


@compiled
def _fill_xz(
    numbers: Any, factor: Any, is_real: bool, start: int, stop: int, trace: Any, values: Any
) -> None:
    """Fill rows of A_xz after the transform along y: i q_x depth/2 times the trace of A, in a half-space.

    On a mirrored map, whose coefficients are real, the factor is −q_x depth/2.

    Parameters
    ----------
    numbers : (4,) tuple
        Places in `values` of xx, yy, zz and xz.
    factor : (columns,) array
        q_x depth/2.
    start, stop : int
    trace : array
        Any values, as many as in a row of coefficients.
    values : (fields, ny, at least as many) array
        Real and imaginary parts in turn, or real coefficients.
    """
    for j in range(start, stop):
        xx, yy = values[numbers[0], j], values[numbers[1], j]
        zz, xz = values[numbers[2], j], values[numbers[3], j]
        # The trace first: only loops that read and write few arrays are turned into operations on vectors.
        for i in range(trace.size):
            trace[i] = xx[i] + yy[i] + zz[i]
        if is_real:
            for i in range(1, factor.size):
                xz[i - 1] = -factor[i] * trace[i]
            continue
        for i in range(factor.size):
            xz[2 * i] = -factor[i] * trace[2 * i + 1]
            xz[2 * i + 1] = factor[i] * trace[2 * i]


@fused
def _fill_spectra(
    fields: Any,
    depth: float,
    wavevector: Any,
    is_layer: bool,
    kernels: Any,
    memory: Any,
    source: Any,
    out: Any,
) -> None:
    """Fill `out` with the coefficients of a A + b B of some components under the pressure.

    The factors of several rows are computed in one loop: a row of `out` is short.

    Parameters
    ----------
    fields : tuple
        Places of the components in `COMPONENTS`, (fields,), and a and b, (fields, 2).
    depth : float
    wavevector : tuple
        q_x of the columns, and q_y of the rows with q_y ≥ 0: all of a mirrored map.
    is_layer : bool
    kernels : (3, rows, columns) array
        Z, L and T of a layer; for the half-space they are computed here.
    memory : tuple
        Arrays with any values: (3, numbers) in double precision, the memory of its third row as integers, and
        (10, numbers) in that of the planes, where `numbers` is a multiple of the number of columns.
    source : tuple
        Coefficients of the pressure on this or a finer grid, real and imaginary parts in turn unless they are
        real, and the place of the first one in a row.
    out : (fields, ny, 2 columns or columns) array
        Modes that are zero because they are Nyquist modes are not made so here.
    """
    (kinds, factors), (shared, (qx, qy), (modes, left)) = fields, (memory[2], wavevector, source)
    (ny, length), (rows, columns), one = out.shape[1:], (qy.size, qx.size), qx.dtype.type(1)
    at_once, twice = shared.shape[1] // columns, shared[8:].reshape(-1)
    for first in range(0, rows, at_once):
        last = min(first + at_once, rows)
        _fill_kernels(depth, qx, qy[first:last], is_layer, kernels[:, first:last], memory)
        for n in range(kinds.size):
            kind, factor = kinds[n], shared[0, : (last - first) * columns]
            _fill_factors(kind, factors[n, 0], factors[n, 1], shared, factor)
            if length == columns:  # real coefficients
                # Two derivatives of an exponential change its sign; one of a cosine along x and one along y
                # do not.
                sign, shift = -one if kind == _XY else one, 1 if kind in (_YZ, _XY) else 0
                for j in range(max(first, shift), last):
                    own, line = factor[(j - first) * columns :], modes[j, left : left + columns]
                    for i in range(columns):
                        out[n, j - shift, i] = sign * own[i] * line[i]
                for j in range(rows - shift, rows):
                    for i in range(columns):
                        out[n, j, i] = 0
                continue
            for i in range(factor.size):
                twice[2 * i] = twice[2 * i + 1] = factor[i]
            is_turned = kind in (_XZ, _YZ)
            for j in range(first, last):
                own = twice[(j - first) * length : (j - first + 1) * length]
                _multiply(own, one, modes[j, left : left + length], is_turned, out[n, j])
                # The row of −qy has the same factors; factors odd in qy change their sign.
                if 0 < j < ny - j:
                    sign = -one if kind in (_YZ, _XY) else one
                    opposite = modes[modes.shape[0] - j, left : left + length]
                    _multiply(own, sign, opposite, is_turned, out[n, ny - j])


@fused
def _fill_kernels(depth: float, qx: Any, qy: Any, is_layer: bool, kernels: Any, memory: Any) -> None:
    """Fill rows of `shared` with Z, L, T, Z + L, q_x/q and q_y/q (its rows 2 to 7) of the modes of some rows.

    Arguments are as of `_fill_spectra`, of these rows.
    """
    row, exponent, shared = memory
    columns, size, zero, one = qx.size, qx.size * qy.size, qx.dtype.type(0), qx.dtype.type(1)
    scaled, over, z, along = shared[0, :size], shared[1, :size], shared[2, :size], shared[3, :size]
    shear, sum_z, c, s = shared[4, :size], shared[5, :size], shared[6, :size], shared[7, :size]
    for j in range(qy.size):
        x, y = c[j * columns : (j + 1) * columns], s[j * columns : (j + 1) * columns]
        for i in range(columns):
            x[i] = qx[i]
        for i in range(columns):
            y[i] = qy[j]
    for i in range(size):
        q = np.sqrt(c[i] * c[i] + s[i] * s[i])
        scaled[i] = depth * q
        over[i] = one / q if q > 0 else zero
    for i in range(size):
        c[i] *= over[i]
    for i in range(size):
        s[i] *= over[i]
    if is_layer:
        for j in range(qy.size):
            for i in range(columns):
                n = j * columns + i
                z[n], along[n], shear[n] = kernels[0, j, i], kernels[1, j, i], kernels[2, j, i]
    else:
        _fill_decay(scaled, row[0, :size], row[1, :size], row[2, :size], exponent[:size], z)
        for i in range(size):
            along[i] = (one - scaled[i]) * z[i]
        for i in range(size):
            shear[i] = scaled[i] * z[i]
        for i in range(size):
            z[i] = (one + scaled[i]) * z[i]
    for i in range(size):
        sum_z[i] = z[i] + along[i]


@fused
def _fill_factors(kind: int, a: float, b: float, shared: Any, factor: Any) -> None:
    """Fill `factor` with the factors of a component, but for the −i of σ_xz and σ_yz.

    `shared` is as of `_fill_kernels`.
    """
    size = factor.size
    z, along, shear = shared[2, :size], shared[3, :size], shared[4, :size]
    sum_z, c, s = shared[5, :size], shared[6, :size], shared[7, :size]
    if kind == _ZZ:
        for i in range(size):
            factor[i] = -a * z[i]
    elif kind == _YZ:
        for i in range(size):
            factor[i] = a * s[i] * shear[i]
    elif kind == _XZ:
        for i in range(size):
            factor[i] = a * c[i] * shear[i]
    elif kind == _XY:
        for i in range(size):
            factor[i] = c[i] * s[i] * (b * sum_z[i] - a * along[i])
    elif kind == _XX:
        for i in range(size):
            factor[i] = -(a * c[i] * c[i] * along[i] + b * s[i] * s[i] * sum_z[i])
    else:
        for i in range(size):
            factor[i] = -(a * s[i] * s[i] * along[i] + b * c[i] * c[i] * sum_z[i])


_LARGEST_ARGUMENT = 700.0
_LOG2_E = 1 / math.log(2.0)
_LN2_HIGH, _LN2_LOW = 0.693145751953125, 1.4286068203094173e-06
_TAYLOR = tuple(1.0 / math.factorial(k) for k in range(13, -1, -1))
_MANTISSA, _BIAS = 52, 1023
"""Bits of the mantissa of a number in double precision, and its exponent for 1."""


@fused
def _fill_decay(scaled: Any, argument: Any, power: Any, scale: Any, exponent: Any, out: Any) -> None:
    """Fill `out` with e^(−x): 2^n times a Taylor series on |x| ≤ ln 2 / 2, which is computed in vectors.

    `scale` and `exponent` are the same memory as numbers and as integers.
    """
    for i in range(argument.size):
        argument[i] = -scaled[i] if scaled[i] < _LARGEST_ARGUMENT else -_LARGEST_ARGUMENT
    for i in range(argument.size):
        exponent[i] = np.int64(argument[i] * _LOG2_E - 0.5)
    for i in range(argument.size):
        argument[i] = argument[i] - exponent[i] * _LN2_HIGH - exponent[i] * _LN2_LOW
    for i in range(argument.size):
        total = _TAYLOR[0]
        for coefficient in _TAYLOR[1:]:
            total = total * argument[i] + coefficient
        power[i] = total
    for i in range(argument.size):
        exponent[i] = (exponent[i] + _BIAS) << _MANTISSA
    for i in range(argument.size):
        out[i] = power[i] * scale[i]


@fused_inlined
def _multiply(factor: Any, sign: float, modes: Any, turned: bool, out: Any) -> None:
    """Fill `out` with factors, each twice in turn, times coefficients, times −i if turned."""
    if turned:
        for i in range(out.size // 2):
            out[2 * i] = sign * factor[2 * i] * modes[2 * i + 1]
            out[2 * i + 1] = -sign * factor[2 * i + 1] * modes[2 * i]
    else:
        for k in range(out.size):
            out[k] = sign * factor[k] * modes[k]


@compiled
def _add_sliding(
    component: int, a: float, b: float, traction: Any, directions: Any, kernels: Any, modes: Any, out: Any
) -> None:
    """Add to `out` the coefficients of a A + b B of one component under a shear traction.

    The traction is `traction` times the pressure; the equations are in ``paper/supplement/method.md``.
    `directions` are as of `_fill_spectra`, and 1/q of the rows with q_y ≥ 0; `kernels` N, M, X, P and Q of
    `Solid.shear_kernels`, `modes` and `out` complex.
    """
    (qx, odd_qx), (qy, odd_qy), over_q = directions
    friction_x, friction_y = traction
    for j in range(out.shape[0]):
        row = min(j, out.shape[0] - j)
        for i in range(out.shape[1]):
            n, m, turn = kernels[0][row, i], kernels[1][row, i], kernels[4][row, i]
            along, across, over = kernels[2][row, i], kernels[3][row, i], over_q[row, i]
            cc, ss = (qx[i] * over) ** 2, (qy[j] * over) ** 2
            odd_c, odd_s = odd_qx[i] * over, odd_qy[j] * over
            x, y = friction_x * odd_c, friction_y * odd_s
            if component == _XZ:
                both = friction_y * odd_c * odd_s * (along - across)
                out[j, i] += a * (friction_x * (cc * along + ss * across) + both) * modes[j, i]
                continue
            if component == _YZ:
                both = friction_x * odd_c * odd_s * (along - across)
                out[j, i] += a * (friction_y * (ss * along + cc * across) + both) * modes[j, i]
                continue
            if component == _ZZ:
                factor = a * (x + y) * n
            elif component == _XX:
                turned = (x + x) * ss - (y + y) * cc
                factor = a * ((x + y) * cc * m + turned * turn) + b * (x + y) * ss * (n + m)
            elif component == _YY:
                turned = (y + y) * cc - (x + x) * ss
                factor = a * ((x + y) * ss * m + turned * turn) + b * (x + y) * cc * (n + m)
            else:
                x, y = friction_y * odd_c, friction_x * odd_s
                both = y * cc + x * ss
                factor = a * (both * m + (cc - ss) * (x - y) * turn) - b * both * (n + m)
            out[j, i] += complex(-factor * modes[j, i].imag, factor * modes[j, i].real)
