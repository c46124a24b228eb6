"""Operations on the heights of a map: scan lines, spikes, missing points, trends, filters, windows."""

from collections.abc import Sequence
from hashlib import sha256
from typing import get_args

import numpy as np

from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, resample
from asperity.settings.map import Detrend

TAPER = 0.1
"""Fraction of an edge, at each of its ends, over which a windowed map falls to its mean plane."""

MEDIAN_POINTS = 5
"""Edge of the square of points in which the local median is taken."""

LONGEST_SPIKE = 5
"""Edge of the largest square of points that is a spike; a group that extends farther is a scratch, a step
or a particle, and is kept."""

SHARPEST_PEAK = 1.75
"""Fourth over second differences of the heights about the sharpest peak that is no spike. A spike of one
point has 3, and any step, too; a wave of n points has 4 sin²(π/n), 0.6 for eight. Peaks of skewed surfaces
with eight points on the shortest wave and a kurtosis of 5 to 11 have up to 1.7."""

OWN_SHARPNESS = 8.0
"""Ratio of `SHARPEST_PEAK` relative to its median over the map; peaks of such surfaces have up to 5."""

EDGE_WIDTH, LARGEST_WIDTH = 1.0, 0.1
"""Width over which the slope across an edge is removed from a mirrored map, over the rms slope divided by the
rms curvature across it, and its largest part of the map. It is about a third of the shortest wave
(`benchmarks/edges.py`)."""

_MAX_DESPIKE_ITERATIONS = 10

MOST_KNOWN = 4
"""Maps whose spikes are kept: description, doubts and treatment of a map ask for the same ones."""

_FOUND: dict[tuple[bytes, float], Array] = {}
"""Hash of the heights and threshold → spikes."""


def find_spikes(height: Array, threshold: float) -> Array:
    """Points of a map that differ from their surroundings and are too sharp for its waves.

    A spike differs from the local median by more than `threshold` robust standard deviations of the local
    roughness (1.4826 times the median of the absolute difference between height and local mean), and belongs
    to a connected group of such points that fits into a square of `LONGEST_SPIKE` points. The high peaks of a
    skewed surface also fulfil this, but they are as smooth as its other waves, and `SHARPEST_PEAK` separates
    them from spikes. Found spikes are replaced by the local median, and the search is repeated until it finds
    no more. Mean and median are taken of `MEDIAN_POINTS` squared points; the median as the median of the
    medians of their rows (P. M. Narendra, IEEE Trans. Pattern Anal. Mach. Intell. 3 (1981) 20, doi
    10.1109/TPAMI.1981.4767047). The difference from the mean is Gaussian for a Gaussian surface, so that its
    spread is a standard deviation; the difference from the median is not.

    Parameters
    ----------
    height : (ny, nx) array
        NaN where there are no data; these points are no spikes.
    threshold : float

    Returns
    -------
    spikes : (ny, nx) array of bool
    """
    key = sha256(np.ascontiguousarray(height).data).digest(), threshold
    if key not in _FOUND:
        while len(_FOUND) >= MOST_KNOWN:
            del _FOUND[next(iter(_FOUND))]
        _FOUND[key] = _find_spikes(height, threshold)
    return _FOUND[key].copy()


def _find_spikes(height: Array, threshold: float) -> Array:
    from scipy.ndimage import distance_transform_edt

    missing = ~np.isfinite(height)
    smooth = subtract_trend(height, "tilt", (1.0, 1.0))[0]
    if missing.any():  # until the end they have the heights of the nearest points
        nearest = distance_transform_edt(missing, return_distances=False, return_indices=True)
        smooth = smooth[tuple(nearest)]
    spikes = np.zeros(height.shape, dtype=bool)
    for _ in range(_MAX_DESPIKE_ITERATIONS):
        median = mean = smooth
        for axis in (0, 1):
            mean = np.asarray(sum(_neighbours(mean, axis))) / MEDIAN_POINTS
            a, b, c, d, e = _neighbours(median, axis)
            low = np.maximum(np.minimum(a, b), np.minimum(c, d))
            high = np.minimum(np.maximum(a, b), np.maximum(c, d))
            # The median of all five is the median of e and of the two middle values of the other four.
            median = np.maximum(np.minimum(low, high), np.minimum(e, np.maximum(low, high)))
        size = np.abs(smooth - mean)[~missing]
        sigma = 1.4826 * float(np.median(size)) if size.size else 0.0
        if sigma == 0 and size.size:  # more than half of the points equal their mean: coarse quantisation
            sigma = 1.2533 * float(np.mean(size))
        marked = (np.abs(smooth - median) > threshold * sigma) & ~missing
        found = _spikes_among(marked, smooth, ~missing) & ~spikes
        if not found.any():
            break
        spikes |= found
        smooth[found] = median[found]
    return spikes


def _neighbours(height: Array, axis: int) -> list[Array]:
    """The heights shifted by −2 to 2 points along an axis.

    Beyond an edge they are continued by point reflection at the edge, so that a slope has no bend there.
    The height of the edge is the median of itself and of two extrapolations, so that a spike in it does not
    enter the reflection.
    """
    half = MEDIAN_POINTS // 2
    n = height.shape[axis]
    rows = np.moveaxis(height, axis, 0)
    if n < MEDIAN_POINTS:
        padded = np.pad(rows, ((half, half), (0, 0)), mode="edge")
    else:
        ends = []
        for side in (rows, rows[::-1]):
            edge = np.median([side[0], 2 * side[1] - side[2], 2 * side[2] - side[4]], axis=0)
            ends.append(2 * edge - side[half:0:-1])
        padded = np.concatenate([ends[0], rows, ends[1][::-1]])
    return [np.moveaxis(padded[start : start + n], 0, axis) for start in range(MEDIAN_POINTS)]


def _spikes_among(marked: Array, height: Array, known: Array) -> Array:
    """The marked points of connected groups that are small, and sharper than the waves of the map allow.

    The sharpness of a group is the largest fourth difference of the heights at its points and their
    neighbours over the largest second difference there, along one axis or the other. Groups in the corners,
    where there is no fourth difference, are taken as sharp.
    """
    from scipy.ndimage import binary_dilation, find_objects, label

    groups, count = label(marked, np.ones((3, 3)))
    if not count:
        return marked
    second, fourth = np.zeros((2, 2, *height.shape))
    for axis in (0, 1):
        rows, bend, change = (np.moveaxis(field, axis, 0) for field in (height, second[axis], fourth[axis]))
        bend[1:-1] = rows[2:] - 2 * rows[1:-1] + rows[:-2]
        change[2:-2] = bend[3:-1] - 2 * bend[2:-2] + bend[1:-3]
    np.abs(second, out=second)
    np.abs(fourth, out=fourth)
    bends = np.median(second[:, known])
    own = float(np.median(fourth[:, known]) / bends) if bends > 0 else np.inf
    corner = np.ones(height.shape, dtype=bool)
    corner[2:-2], corner[:, 2:-2] = False, False
    sharp = np.zeros(count + 1, dtype=bool)
    for number, box in enumerate(find_objects(groups), 1):
        if any(side.stop - side.start > LONGEST_SPIKE for side in box):
            continue
        around = tuple(slice(max(side.start - 2, 0), side.stop + 2) for side in box)
        group = groups[around] == number
        near = binary_dilation(group, np.ones((5, 5), bool))
        bend, change = (field[:, *around].max((1, 2), where=near, initial=0) for field in (second, fourth))
        is_sharp = change > min(SHARPEST_PEAK, OWN_SHARPNESS * own) * bend
        sharp[number] = is_sharp.any() or corner[around][group].any()
    return sharp[groups]


def fill_harmonic(height: Array, missing: Array) -> Array:
    """The heights with a harmonic function at the missing points: each is the mean of its neighbours."""
    if not missing.any():
        return height
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    y, x = np.nonzero(np.pad(missing, 1))
    beside = (y, x + 1), (y, x - 1), (y + 1, x), (y - 1, x)
    number = np.full(np.add(missing.shape, 2), -1)
    number[y, x] = np.arange(y.size)
    known, inside = np.pad(height.astype(float), 1), np.pad(np.ones(missing.shape, bool), 1)
    known[y, x] = 0.0
    right, neighbours = (
        np.sum([values[place] for place in beside], axis=0, dtype=float) for values in (known, inside)
    )
    columns = np.stack([number[place] for place in beside])
    rows = np.broadcast_to(np.arange(y.size), columns.shape)
    pairs = rows[columns >= 0], columns[columns >= 0]
    coupling = coo_array((np.ones(pairs[0].size), pairs), shape=(y.size, y.size))
    filled = np.array(height, dtype=float)
    filled[missing] = spsolve((diags_array(neighbours) - coupling).tocsr(), right)
    return filled


def subtract_trend(
    height: Array, detrend: str, length: tuple[float, float], fitted: Array | None = None
) -> tuple[Array, tuple[float, float], float]:
    """The heights minus their least-squares polynomial; its mean gradient (y, x), and the height of its bow.

    The polynomial is a constant, a plane (``tilt``) or of degree two (``curvature``), and the bow is the
    range of the terms of degree two over the map. It is fitted to the points of the mask `fitted`, by default
    to all points that have data (are not NaN); points that were filled would bend it.
    """
    y, x = (
        np.array([np.ones_like(line), line, np.square(line) - np.mean(np.square(line))])
        for line in (np.linspace(-1.0, 1.0, n) for n in height.shape)
    )
    known = np.isfinite(height) if fitted is None else fitted
    values = np.where(known, height, 0.0)
    degree = get_args(Detrend).index(detrend)
    orders = [order for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)) if sum(order) <= degree]
    moments = np.einsum("iy,ky,yx,jx,mx->ikjm", y, y, known.astype(float), x, x, optimize=True)
    products = [[moments[i, k, j, m] for k, m in orders] for i, j in orders]
    sums = y @ values @ x.T
    # Of the solutions for points on few lines the smallest one.
    found = np.linalg.lstsq(products, [sums[order] for order in orders])[0]
    linear, curved = np.zeros((2, 3, 3))
    for order, coefficient in zip(orders, found, strict=True):
        (curved if sum(order) == 2 else linear)[order] = coefficient
    left, bow = height - y.T @ (linear + curved) @ x, 0.0
    if curved.any():
        bow = float(np.ptp(y.T @ curved @ x))
    # The terms of degree one run from -1 to 1 over the distance between the first and the last point.
    half = [edge * (1 - 1 / n) / 2 for edge, n in zip(length, height.shape, strict=True)]
    return left, (float(linear[1, 0] / half[0]), float(linear[0, 1] / half[1])), bow


def tukey_window(shape: tuple[int, ...]) -> Array:
    """Tukey window, which falls to zero at the points at both ends of an edge, over the fraction `TAPER`.

    F. J. Harris, Proc. IEEE 66 (1978) 51, doi 10.1109/PROC.1978.10837.
    """
    from scipy.signal.windows import tukey

    window_y, window_x = (tukey(n, 2 * TAPER) for n in shape)
    return window_y[:, None] * window_x[None, :]


def edge_step(height: Array) -> float:
    """Rms height step across the edges of a period, relative to the rms step between all neighbouring nodes.

    It is about one for a periodic map, and larger if opposite edges do not match.
    """
    across = np.concatenate([height[0] - height[-1], height[:, 0] - height[:, -1]])
    along_y, along_x = np.diff(height, axis=0), np.diff(height, axis=1)
    inside = (np.sum(along_y**2) + np.sum(along_x**2)) / max(along_y.size + along_x.size, 1)
    return float(np.sqrt(np.mean(across**2) / inside)) if inside > 0 else 0.0


def level_edges(height: Array, axes: Sequence[int] = (0, 1)) -> tuple[Array, tuple[float, float]]:
    """A map without slope across its edges, and the widths along y and x, in points, that this changes.

    Mirror images of a slope are a crease: asperities at the edges would be sharper than others. With the
    slope s towards the edge, s (w − d)²/(2 w) is added at distances d up to the width w.
    """
    widths = [0.0, 0.0]
    for axis in axes:
        nodes, steps = height.shape[axis], np.diff(height, axis=axis)
        slope, curvature = (float(np.linalg.norm(each)) for each in (steps, np.diff(steps, axis=axis)))
        widths[axis] = width = min(EDGE_WIDTH * slope / max(curvature, 1e-300), LARGEST_WIDTH * nodes)
        if width <= 0.5:  # no point is as near to the edge
            continue
        height, steps = np.moveaxis(height, axis, 0), np.moveaxis(steps, axis, 0)
        shape = np.maximum(width - (np.arange(nodes) + 0.5), 0)[:, None] ** 2 / (2 * width)
        first, last = 2 * steps[0] - steps[1], steps[-2] - 2 * steps[-1]
        height = np.moveaxis(height + shape * first + shape[::-1] * last, 0, axis)
    return height, (widths[0], widths[1])


def low_pass(height: Array, grid: Grid, target: Grid, shortest: float | None) -> Array:
    """A map on another grid, without waves shorter than `shortest`; mean zero.

    On mirrored grids the points are the centres of pixels, and no step at an edge is smoothed into the map.
    """
    coefficients = Fourier(grid).forward(height)
    if shortest is not None:
        coefficients[grid.wavenumber() > 2 * np.pi / shortest * (1 + 1e-9)] = 0.0
    coefficients[0, 0] = 0.0
    return Fourier(target).inverse(resample(coefficients, grid, target), overwrite=True)


def level_lines(height: Array, how: str) -> tuple[Array, Array]:
    """The heights without the offsets between their scan lines, which run along x, and these offsets.

    ``median`` subtracts the median of every line. ``matched`` uses the median of the differences between
    neighbouring lines as their offset, which keeps steps that cross less than half of a line, and a slope
    across the lines except for its median step.

    Parameters
    ----------
    height : (ny, nx) array
        NaN where there are no data.
    how : "median" or "matched"

    Returns
    -------
    levelled : (ny, nx) array
    offsets : (ny,) array
        With mean zero; 0 for a line without data.
    """
    lines = height if how == "median" else np.diff(height, axis=0, prepend=height[:1])
    known = np.isfinite(lines).any(axis=1)
    offsets = np.zeros(height.shape[0])
    offsets[known] = np.nanmedian(lines[known], axis=1)
    if how == "matched":
        offsets = np.cumsum(offsets)
    offsets -= np.mean(offsets)
    return height - offsets[:, None], offsets


def gaussian_filter(height: Array, grid: Grid, s_filter: float | None, l_filter: float | None) -> Array:
    """Heights after an areal Gaussian S-filter, L-filter, or both.

    An S-filter transmits ``2^-(λ_s/λ)²`` of a wave of length λ, one half at its nesting index λ_s;
    an L-filter transmits ``1 - 2^-(λ_l/λ)²`` (ISO 16610-61).
    """
    waves = grid.wavenumber() / (2 * np.pi)
    coefficients = Fourier(grid).forward(height)
    if s_filter is not None:
        coefficients *= np.exp2(-np.square(s_filter * waves))
    if l_filter is not None:
        coefficients *= -np.expm1(-np.log(2) * np.square(l_filter * waves))
    return Fourier(grid).inverse(coefficients, overwrite=True)
