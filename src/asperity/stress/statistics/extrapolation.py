"""Extrapolation to zero grid spacing, from a contact and the same contact on half as many nodes.

The largest error of a contact on a grid is usually the discretisation error. Each of its parts is corrected
by theory and by results of many random surfaces (``paper/supplement/continuum.md``):

Area
    The whole pixel of a node in contact is counted, so that every contact spot is too wide by a fraction of
    the spacing along its boundary. The boundary, counted in edges between nodes inside and outside, times
    `BOUNDARY_SHARE` is subtracted. (Yastrebov, Anciaux and Molinari 2017,
    https://doi.org/10.1016/j.triboint.2017.04.023, derive a fraction of 0.118 for random cuts.)
Slopes and depths
    The rms gradient over the contact and the depths of peaks converge with the square of the spacing:
    Richardson's extrapolation of second order.
Percentiles of peaks
    A coarse grid misses the lowest peaks and hardly changes the high ones. The number of peaks is
    extrapolated, and the percentile of all of them is the peak of the same rank among those found.

The error that remains is a fraction of the change from half of the nodes to all. It does not vanish near
full contact. So that the stated error is not small by chance, sizes, depths and decay lengths use the
largest change of the numbers of their kind. `SHARE_OF_CHANGE` and the constants beside it hold the measured
fractions. With hundreds of peaks the error of their sizes is a multiple of the fraction of missed peaks
(`OF_MISSED`). Half of the nodes cannot represent waves shorter than four nodes; the corrections of a
surface with such waves have larger errors.

Extreme values of the fields are not corrected. Their errors grow with the change from half of the nodes to
all, and with the correction of the area, which says how well contact spots are resolved
(`OF_RESOLUTION`). On a surface with creases extreme stresses grow with every refinement and have no
estimate. Such a surface has roughness up to the limit of the grid in all directions (`BEYOND_BAND`), while
waves that are not shorter than two spacings leave the diagonals of the grid empty.

These fractions hold for isotropic Gaussian surfaces. The errors of others are larger: along a lay the errors
of neighbouring nodes are alike, and the grid does not resolve the edges of plateaus and sharp crests. Their
fractions of the change are larger, and two measures of the grid are added (`OF_DEPARTURE`), both in
proportion to the departure of the surface from an isotropic Gaussian one.

The constants were fitted to surfaces that are not kept; `benchmarks/continuum.py` and `benchmarks/answers.py`
test them on others.

A number whose error would be larger than `LARGEST_ERROR` has no estimate.

Under a hardness the errors are larger, and there is no estimate of depths and decay lengths.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, gradient, resample, with_mirror_images
from asperity.stress.peaks.selection import peak_numbers
from asperity.stress.statistics.covariance import decay_lengths

LEAST_NODES = 200
"""Nodes in contact, and nodes out of contact, below which there is no estimate."""

FLAT_CURVATURE = 1e-3
"""Median curvature at the contact nodes, over the root mean square of all, below which heights are flat or
stepped; it is 0.7 on a Gaussian surface."""

BOUNDARY_SHARE = 0.102
"""Overestimate of the area by the nodes in contact, over spacing times boundary."""

SECOND_ORDER = "gradient_rms_contact", "peak_count", "mean_depth", "mean_depth_highest"
"""Numbers whose error falls with the square of the spacing."""

PERCENTILES = {"p90": 0.9, "p99": 0.99, "maximum": 1.0}
"""Name of a number → level of the quantile of the peaks that it is."""

PERCENTILE_LEVELS = (*PERCENTILES.values(),)

DEPTHS = "mean_depth", "mean_depth_highest"
DECAYS = "decay_length_depth", "decay_length_plane"

SHARE_OF_CHANGE = {
    "p90": 0.55,
    "p99": 0.43,
    "maximum": 0.38,
    "maximum_von_mises": 0.38,
    "mean_depth": 0.22,
    "mean_depth_highest": 0.33,
    "decay_length_depth": 0.55,
    "decay_length_plane": 0.95,
}
"""Number → relative error that remains, over the largest change of the numbers of its kind from half of the
nodes to all; for depths the error of the sizes is added."""

OF_RESOLUTION = {
    **{"von_mises": 0.6, "maximum_shear": 0.7, "principal_3": 1.5, "hydrostatic": 1.5},
    "shear": 0.6,  # of an interface, where it is smoother than in the whole body
}
"""Field → b of the relative error a C + b c^1.5 of its extreme value: a is `OF_EXTREME`, C the largest change
of all sizes from half of the nodes to all, and c the `resolution`. Of the percentiles of the peaks b is
`OF_RESOLUTION_OF_PEAKS`, and of other fields 1.5. Quantile regressions of 95 % on 130 band-limited surfaces
of seven kinds, not the surfaces of `benchmarks/answers.py`."""

OF_EXTREME, OF_RESOLUTION_OF_PEAKS = 0.25, 0.5

OF_TENSION = 1.25, 0.6, 2.5
"""a, b, f of the relative error a c^b + f d s of the maximum tension, with departure d and s as in
`OF_DEPARTURE`: its peaks at the edges of the contacts change by a fifth at eight nodes on the shortest wave.
"""

OF_PRESSURE = {"p90": 0.32, "p99": 0.22, "maximum": 0.27}
"""`SHARE_OF_CHANGE` for the peaks of the pressure."""

COMMON = "pressure", "von_mises"
"""Quantities whose peaks enter the change of the sizes of every other quantity, too."""

LOST_DEPTH = 5
"""c in the factor 1 + c l of the error of the mean depth; l: fraction of the squared gradient lost on half of
the nodes."""

OF_AREA = 0.43, 0.043
"""a, b of the relative error of the area: a |A/A_half − 1| + b |A/A₀ − 1|. A is its estimate from all nodes,
A_half from half of them, and A₀ the area of the nodes in contact."""

OF_GRADIENT = 0.38, 0.5, 7.0, 0.012
"""a, b, c, d of the relative error of the gradient: (a + b A² + c l (1 − A)²) |g/g₀ − 1| + d |A/A₀ − 1|.
g and A are the estimates of gradient and area, g₀ and A₀ their values on the nodes; l as in `LOST_DEPTH`.
The departure of the surface (`OF_DEPARTURE`) does not raise the part with l."""

OF_LARGE_CORRECTION = 40.0, 0.15
"""a, x₀ of an addition a (x − x₀)² to this error where the correction x = |g/g₀ − 1| is above x₀, as on four
nodes of surfaces whose waves are nearly all of one length."""

OF_PROPORTIONALITY = 0.9
"""Relative error of κ_r over √(error of the area² + error of the gradient²)."""

OF_MISSED = {"pressure": 0.16, "von_mises": 0.16}
"""Quantity → c of the relative error of a quantile of its peaks, (c + `LOWER_PEAKS` (1 − level)) m, with the
fraction m of the peaks that the grid missed."""

OF_MISSED_COMPONENT = 0.3
"""`OF_MISSED` for other quantities, whose number of peaks rises more from grid to grid."""

LOWER_PEAKS = 1.5
"""See `OF_MISSED`."""

OF_PLASTIC_AREA, OF_PLASTIC_GRADIENT = 2.5, 1.0
"""Under a hardness: factor of the relative error of the area, and least relative error of the gradient over
|A/A₀ − 1|."""

OF_PLASTIC_SIZE = {
    "p90": 0.14,
    "p99": 0.12,
    **dict.fromkeys(("maximum", "extreme", "maximum_von_mises"), 0.13),
}
"""Under a hardness: c of the least relative error of stresses, c (|A/A₀ − 1|/(1 − A))^(1/4). The pressure
falls from the hardness to zero over less than a pixel, and the stress is largest below that edge. From 60
random surfaces (`benchmarks/answers.py`)."""

ANISOTROPY, KURTOSIS = (0.1, 0.3), (0.1, 0.5)
"""Anisotropy of the squared gradient (0 to 1), and |kurtosis of the curvature − 3|, at which the departure
from an isotropic Gaussian surface is 0 and 1; linear between. Nine in ten random isotropic Gaussian surfaces
are below 0.08 and 0.14."""

OF_DEPARTURE = {
    "contact_area_fraction": (0.7, 0.8, 0.0),
    "gradient_rms_contact": (2.7, 0.1, 0.2),
    **dict.fromkeys(("p90", "p99"), (0.0, 1.5, 0.5)),
    **dict.fromkeys(("maximum", "extreme", "maximum_von_mises"), (0.0, 0.5, 0.5)),
    **dict.fromkeys(DEPTHS, (0.5, 5.0, 2.3)),
    "decay_length_depth": (1.1, 0.0, 0.5),
    "decay_length_plane": (1.3, 0.0, 1.1),
}
"""Number → a, b, c: its relative error rises by departure × (a × error + b × s + c × u), with s of
`_straight_boundary` and u, ``unresolved``, of `_of_surface`. Quantile regression of 95 % on 120 surfaces of
eight kinds at 2, 4 and 8 nodes on the shortest wave: grooves, powers, cut heights, squares, crests, bumps,
deep valleys and bands of waves."""

OF_DEPARTURE_OF_PRESSURE = 0.5, 0.5, 0.55
"""`OF_DEPARTURE` for the peaks of the pressure."""

BEYOND_BAND = 0.04
"""``beyond_band`` of `_of_surface` above which extreme stresses have no estimate. On 480 surfaces it was at
most 0.02 on band-limited ones, also with two nodes on the shortest wave, 0.08 to 0.8 with creases and
grooves, and 0.02 to 0.1 where flat parts are cut out of a smooth surface."""

TAIL, LEAST_TAIL, DIRECTED, PEAKED, ON_AXES, GAUSSIAN = 0.75, 0.01, 0.8, 3.5, 0.999, 3.0
"""Creases in one direction, or along the axes, may leave the diagonals empty. They have more than
`LEAST_TAIL` of the squared curvature in modes above `TAIL` of the largest wavenumber along an edge. Either
these lie in one direction (1 for a single one) by more than `DIRECTED`, and the curvature along one axis has
a kurtosis above `PEAKED`; or they lie on the axes (1) by more than `ON_AXES`, and it is above that of a
Gaussian surface. Of 960 grids of band-limited surfaces none fulfils this."""

OF_BEYOND_BAND = {"gradient_rms_contact": 5.0, **dict.fromkeys((*PERCENTILES, "extreme"), 8.0)}
"""Number → factor of ``beyond_band`` in an addition to its relative error."""

OF_CREASED_AREA = 2.5
"""Factor of ``beyond_band`` times |A/A₀ − 1| in an addition to the relative error of the area (A and A₀ as in
`OF_AREA`): the area of creases in contact falls with every refinement. From 96 surfaces of 14 kinds, other
draws than those of `benchmarks/answers.py` and `benchmarks/unseen.py`."""

LARGEST_ERROR = 1.0
"""Relative error above which there is no estimate."""

CURVED_RUN = 2.0
"""Mean length in nodes of straight parts of the boundary up to which it is curved; 1.7 if it is isotropic."""

STRAIGHT = 1e-3
"""Largest difference of the pressure along a line, over the maximum pressure, along straight ridges."""

WIDTH = 0.75
"""Relative error of the standard deviation of the peaks over the fraction of missed ones."""

OUTPUTS = (
    *("contact_area_fraction", "gradient_rms_contact", "proportionality", *PERCENTILES),
    *("extreme", *DEPTHS, *DECAYS),
)
"""Numbers of `asperity.continuum_limit`."""

KINDS = ("on_grid", "on_half", "estimate", "error")


class OnGrid(NamedTuple):
    """Results on one grid.

    Parameters
    ----------
    pressure : (ny, nx) array
    load : float
        Mean pressure over the effective modulus.
    gradient : float
        Root-mean-square gradient over the contact.
    grid : Grid
    stress : dataset, optional
    is_plastic : bool
        True if the pressure reaches a hardness.
    height : (ny, nx) array, optional
        Without it the surface is taken as an isotropic Gaussian one.
    extremes : dict, optional
        Field of the stress → its extreme value, as of `asperity.stress.extremes`.
    """

    pressure: Array
    load: float
    gradient: float
    grid: Grid
    stress: xr.Dataset | None = None
    is_plastic: bool = False
    height: Array | None = None
    extremes: Mapping[str, float] | None = None


def reason_against(pressure: Array, height: Array, plastic_area: float = 0.0, mirrored: bool = False) -> str:
    """Reason why a periodic contact allows no estimate; empty if it does.

    Nodes of a mirrored map are counted four times.
    """
    if plastic_area > 0:
        return "the pressure reaches the hardness, and the errors of a study are known for elastic contacts"
    touching = pressure > 0
    copies = 4 if mirrored else 1
    nodes = copies * np.count_nonzero(touching)
    if nodes < LEAST_NODES:
        own = f"{nodes // copies} nodes, with mirror images " if mirrored else ""
        return f"{own}{nodes} nodes are in contact, and {LEAST_NODES} are needed"
    bend = second_differences(height, mirrored)
    if np.median(np.abs(bend[touching])) <= FLAT_CURVATURE * np.sqrt(np.mean(np.square(bend))):
        return "the heights in contact are flat or stepped, and no grid resolves their edges"
    if copies * touching.size - nodes < LEAST_NODES:
        return f"{copies * touching.size - nodes} nodes are out of contact, and {LEAST_NODES} are needed"
    return ""


def reason_against_stress(found: xr.Dataset, error: xr.Dataset) -> str:
    """Reason why peaks allow no estimate, from their numbers and errors; empty if they do."""
    if found["along_lines"] <= STRAIGHT:
        return "the ridges are straight, and the peaks along them are rounding errors"
    if found["beyond_band"] > BEYOND_BAND:
        return (
            "the roughness reaches the limit of the grid in all directions (creases, steps or noise), and "
            "extreme stresses grow with every refinement"
        )
    if not error["maximum_von_mises"].notnull().any():
        return "the grid does not resolve the edges of the heights in contact"
    return ""


def second_differences(height: Array, mirrored: bool = False) -> Array:
    """Curvature of periodic or mirrored heights times the squared spacing."""
    return _second_differences(height, 0, mirrored) + _second_differences(height, 1, mirrored)


def _second_differences(height: Array, axis: int, mirrored: bool) -> Array:
    """Curvature along one axis."""
    beyond = [(int(axis == other),) * 2 for other in (0, 1)]
    around, nodes = np.pad(height, beyond, "symmetric" if mirrored else "wrap"), height.shape[axis]
    return around.take(range(nodes), axis) - 2 * height + around.take(range(2, nodes + 2), axis)


def resolution(estimates: xr.Dataset) -> float:
    """Relative correction of the area over the fraction out of contact: small if spots are resolved."""
    found, best = (
        float(estimates["contact_area_fraction"].sel(kind=kind)) for kind in ("on_grid", "estimate")
    )
    return float(abs(found / best - 1) / max(1 - best, 0.01))


def extreme_error(estimates: xr.Dataset, field: str) -> float:
    """Relative error of the extreme value of a field; NaN where it has no estimate.

    Of a result without ``extreme`` it is the error of the highest von Mises peak.
    """
    if "extreme" in estimates:
        return float(estimates["extreme"].sel(field=field, kind="error"))
    return float(estimates["maximum"].sel(quantity="von_mises", kind="error").squeeze())


def extrapolate(fine: OnGrid, coarse: OnGrid, lost: float = 0.0, reason: str = "") -> xr.Dataset:
    """The dataset of `asperity.continuum_limit` from the results on two grids under the same load.

    Parameters
    ----------
    fine, coarse : OnGrid
        On all nodes, and on half as many along both edges.
    lost : float
        Fraction of the squared gradient of the surface in waves that the coarse grid does not hold.
    reason : str
        Reason why there is no estimate; empty if there is one.
    """
    other = numbers_on(coarse)
    if reason:
        found = numbers_on(fine)
        best = error = found * np.nan
    else:
        found, best, error = extrapolated_numbers(fine, other, lost)
    outputs = [name for name in OUTPUTS if name in found]
    joined = xr.concat([kind[outputs] for kind in (found, other, best, error)], "kind", coords="minimal")
    reasons = {"reason": reason}
    if fine.stress is not None and not reason:
        reasons["reason_of_stress"] = reason_against_stress(found, error)
    attributes = {name: text for name, text in reasons.items() if text}
    least = 0.0 if reason else float(error["least"])
    return joined.assign_coords(kind=list(KINDS)).assign_attrs(attributes, least_error=least)


def extrapolated_numbers(
    fine: OnGrid, other: xr.Dataset, lost: float, levels: Sequence[float] | Array = PERCENTILE_LEVELS
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Numbers on a grid, their estimates at zero spacing, and the relative errors of these.

    Parameters
    ----------
    fine : OnGrid
    other : dataset
        Numbers of the same contact on fewer nodes, as of `numbers_on`.
    lost : float
        Fraction of the squared gradient of the surface in waves that the other grid does not hold.
    levels : sequence of float
        Fractions of the peaks at which quantiles are taken, with the levels of `PERCENTILES`.
    """
    found = numbers_on(fine, levels)
    # Datasets are made of the arrays in the end: a dataset compares all its coordinates at each assignment.
    best: dict[Any, Any] = dict(found.data_vars)
    ratio = other["spacing"] / found["spacing"]
    for name in SECOND_ORDER:
        if name in best:
            best[name] = found[name] + (found[name] - other[name]) / (ratio**2 - 1)
    best["contact_area_fraction"], on_half = (
        one["contact_area_fraction"] - BOUNDARY_SHARE * one["boundary"] for one in (found, other)
    )
    best["proportionality"] = best["contact_area_fraction"] * best["gradient_rms_contact"] / fine.load
    if fine.stress is not None:
        best |= _quantiles(peak_numbers(fine.stress, levels, best["peak_count"])).data_vars
        if found["along_lines"] <= STRAIGHT or found["beyond_band"] > BEYOND_BAND:
            for name in {*PERCENTILES, "extreme", "peak_quantile", "maximum_von_mises", *DEPTHS} & {*best}:
                best[name] = best[name] * np.nan
    error: dict[Any, Any] = {}
    of_area, of_gradient = (
        abs(best[name] / found[name] - 1) for name in ("contact_area_fraction", "gradient_rms_contact")
    )
    change = abs(best["contact_area_fraction"] / on_half - 1)
    error["contact_area_fraction"] = OF_AREA[0] * change + OF_AREA[1] * of_area
    area = best["contact_area_fraction"]
    share = OF_GRADIENT[0] + OF_GRADIENT[1] * area**2
    error["gradient_rms_contact"] = share * of_gradient + OF_GRADIENT[3] * of_area
    factor, least = OF_LARGE_CORRECTION
    error["gradient_rms_contact"] += factor * np.maximum(of_gradient - least, 0) ** 2
    if fine.is_plastic:
        error["contact_area_fraction"] *= OF_PLASTIC_AREA
        error["gradient_rms_contact"] = np.maximum(
            error["gradient_rms_contact"], OF_PLASTIC_GRADIENT * of_area
        )
    if fine.stress is not None:
        out_of_contact = np.maximum(1 - area, 0.01)
        corrected = float(abs(found["contact_area_fraction"] / area - 1) / out_of_contact)
        error |= _errors_of_stress(found, other, lost, corrected)
    error |= _of_departure(error, found)
    beyond = float(found["beyond_band"])
    error["contact_area_fraction"] += OF_CREASED_AREA * (beyond if beyond < 1 else 0) * of_area
    error["gradient_rms_contact"] += OF_GRADIENT[2] * lost * (1 - area) ** 2 * of_gradient
    both = np.hypot(error["contact_area_fraction"], error["gradient_rms_contact"])
    error["proportionality"] = OF_PROPORTIONALITY * both
    if fine.stress is not None:
        missed = abs(best["peak_count"] / found["peak_count"].where(found["peak_count"] > 0) - 1)
        shares = [OF_MISSED.get(str(name), OF_MISSED_COMPONENT) for name in found["quantity"].values]
        highest = xr.DataArray(shares, coords={"quantity": found["quantity"]})
        error["peak_quantile"] = missed * (highest + LOWER_PEAKS * (1 - found["level"]))
        error["peak_deviation"] = WIDTH * missed
        if fine.is_plastic:
            for name, least in OF_PLASTIC_SIZE.items():
                if name not in error:
                    continue
                error[name] = np.maximum(error[name], least * (of_area / (1 - area)) ** 0.25)
                if name in PERCENTILES:  # pressures at the hardness are the same on every grid
                    error[name] = error[name].where(found[name] != other[name], 0.0)
            # The depth of the largest stress below an edge changes many times.
            for name in (*DEPTHS, *DECAYS):
                best[name], error[name] = best[name] * np.nan, error[name] * np.nan
    for name in {*best} & {*error}:
        error[name] = error[name].where(best[name].notnull() & (error[name] <= LARGEST_ERROR))
        best[name] = best[name].where(error[name].notnull())
    if fine.stress is not None:  # a grid that misses the depths misses the depth of the highest peaks, too
        for kind in (best, error):
            kind["mean_depth_highest"] = kind["mean_depth_highest"].where(best["mean_depth"].notnull())
    return found, xr.Dataset(best), xr.Dataset(error)


def _of_departure(error: dict[Any, Any], found: xr.Dataset) -> dict[Any, Any]:
    """Relative errors of a surface that may not be isotropic and Gaussian.

    ``least`` is the addition to the error of the maximum von Mises stress.
    """

    def added(shares: tuple[float, float, float], own: Any) -> Any:
        measures = own, found["straight_boundary"], found["unresolved"]
        products = (share * measure for share, measure in zip(shares, measures, strict=True))
        return found["departure"] * sum(products)

    raised = {"least": added(OF_DEPARTURE["maximum_von_mises"], 0.0)}
    for name in OF_DEPARTURE.keys() & {*error}:
        raised[name] = error[name] + added(OF_DEPARTURE[name], error[name])
        if name in OF_PRESSURE:
            of_pressure = error[name] + added(OF_DEPARTURE_OF_PRESSURE, error[name])
            raised[name] = xr.where(found["quantity"] == "pressure", of_pressure, raised[name])
        raised[name] = raised[name] + OF_BEYOND_BAND.get(name, 0.0) * found["beyond_band"]
    return raised


def _errors_of_stress(found: xr.Dataset, other: xr.Dataset, lost: float, resolution: float) -> dict[Any, Any]:
    """Relative errors of sizes, depths and decay lengths; NaN where the other grid has no such number."""
    changes = {name: abs(found[name] / other[name] - 1) for name in SHARE_OF_CHANGE}
    changes = {name: change.where(np.isfinite(change)) for name, change in changes.items()}

    def largest(names: Iterable[str]) -> xr.DataArray:
        return xr.concat([changes[name] for name in names], "number").max(["number", "poisson"])

    sizes = largest(PERCENTILES)
    common = sizes.where(sizes["quantity"].isin(COMMON)).max()
    sizes = sizes.where(~(sizes < common), common)
    depths = largest(DEPTHS) + sizes
    of_kind = dict.fromkeys(PERCENTILES, sizes) | dict.fromkeys(DEPTHS, depths)
    of_kind |= dict.fromkeys(DECAYS, largest(DECAYS)) | {"maximum_von_mises": common.fillna(sizes.max())}
    is_pressure, error = found["quantity"] == "pressure", {}
    for name, share in SHARE_OF_CHANGE.items():
        error[name] = (share * of_kind[name]).where(changes[name].notnull())
        if name in OF_PRESSURE:
            error[name] *= xr.where(is_pressure, OF_PRESSURE[name] / share, 1.0)
            error[name] += OF_RESOLUTION_OF_PEAKS * resolution**1.5
    error["mean_depth"] *= 1 + LOST_DEPTH * lost
    if "extreme" in found:
        names = found["field"].values.tolist()
        kinds = [name.partition(" ")[0] for name in names]  # in one material or interface a number follows
        is_tension, in_whole = np.isin(kinds, ("principal_1", "tension")), np.array(kinds) == names
        change = np.nan_to_num(abs(found["extreme"] / other["extreme"] - 1).values, posinf=np.inf)
        of_body = max(change[in_whole & ~is_tension].max(initial=0.0), float(common.fillna(0)))
        own = OF_EXTREME * np.where(in_whole, of_body, np.maximum(change, of_body))
        own += np.array([OF_RESOLUTION.get(kind, 1.5) for kind in kinds]) * resolution**1.5
        factor, power, of_straight = OF_TENSION
        along = float(found["departure"] * found["straight_boundary"])
        of_tension = np.maximum(factor * resolution**power + of_straight * along, ~in_whole * change)
        error["extreme"] = xr.zeros_like(found["extreme"])
        error["extreme"][:] = np.where(is_tension, of_tension, own)
    return error


def numbers_on(results: OnGrid, levels: Sequence[float] | Array = PERCENTILE_LEVELS) -> xr.Dataset:
    """Numbers of the contact, and of the peaks and the decay of its stress, on one grid."""
    touching = results.pressure > 0
    in_cell = with_mirror_images(touching, results.grid)
    edges = sum(np.count_nonzero(in_cell != np.roll(in_cell, 1, axis)) for axis in (0, 1))
    # Cuts of pixels along straight parts of the boundary err alike: n edges in m parts err as m that are n/m
    # long. Parts no longer than `CURVED_RUN` on average have none.
    squared = 0.0
    for axis in (0, 1):
        steps = in_cell.astype(np.int8) - np.roll(in_cell, 1, axis)
        across = np.count_nonzero(steps)
        longer = np.count_nonzero(steps & (steps == np.roll(steps, 1, 1 - axis)))
        if across:
            length = across / max(across - longer, across / in_cell.shape[1 - axis])
            squared += across * length * max(1 - CURVED_RUN / length, 0) ** 2
    straight = float(np.sqrt(squared) / max(np.count_nonzero(in_cell), 1))
    area = float(touching.mean())
    along_lines = min(np.ptp(results.pressure, axis).max() for axis in (0, 1))
    numbers = xr.Dataset(
        {
            "spacing": results.grid.spacing[0],
            "contact_area_fraction": area,
            "boundary": edges / in_cell.size,
            "along_lines": along_lines / max(results.pressure.max(), 1e-300),
            "straight_boundary": straight,
            "gradient_rms_contact": results.gradient,
            "proportionality": area * results.gradient / results.load,
            **_of_surface(results, touching),
        }
    )
    if results.stress is None:
        return numbers
    along_depth, in_plane = decay_lengths(results.stress)
    numbers["maximum_von_mises"] = results.stress["maximum_von_mises"].max("plane")
    numbers["decay_length_depth"] = "poisson", along_depth
    numbers["decay_length_plane"] = "poisson", in_plane
    if results.extremes is not None:
        sizes = np.abs([*results.extremes.values()])
        numbers["extreme"] = xr.DataArray(sizes, {"field": [*results.extremes]})
    of_peaks = peak_numbers(results.stress, levels)
    return numbers.merge(of_peaks).merge(_quantiles(of_peaks))


def _of_surface(results: OnGrid, touching: Array) -> dict[str, float]:
    """Departure from an isotropic Gaussian surface, 0 to 1, and waves that the grids do not resolve.

    ``unresolved`` is the root of u/(1 + u), with the fraction u of the squared gradient over the contact in
    waves that half of the nodes along both edges do not hold. ``beyond_band`` is the fraction of the squared
    curvature in modes shorter than two spacings, which a grid holds along its diagonals alone; 1 of
    creases in one direction or along the axes.
    """
    if results.height is None:
        return {"departure": 0.0, "unresolved": 0.0, "beyond_band": 0.0}
    grid, height = results.grid.of_heights, results.height / max(np.ptp(results.height), 1e-300)
    # On a mirrored map, as many modes as half of the nodes of the whole cell hold.
    halves = [max((n + 1) // 2, 2) if grid.mirrored else max(n // 2, 4) for n in grid.shape]
    fourier, half = Fourier(grid), Grid((halves[0], halves[1]), grid.length, grid.mirrored)
    modes = fourier.forward(height)
    power = np.abs(modes) ** 2 * grid.wavenumber() ** 4
    power /= max(grid.sum_over_modes(power), 1e-300)
    y, x = (
        np.array(step * q / np.pi) for step, q in zip(grid.spacing, (grid.qy[:, None], grid.qx), strict=True)
    )
    tail = power * (np.hypot(y, x) > TAIL)
    products = 1, y**2 - x**2, 2 * x * y, y**2 + x**2, np.abs(y**2 - x**2)
    parts = [grid.sum_over_modes(tail * part) for part in products]
    directed = np.hypot(parts[1], 0 if grid.mirrored else parts[2]) / max(parts[3], 1e-300)
    on_axes = parts[4] / max(parts[3], 1e-300)
    bends = [_second_differences(height, axis, bool(grid.mirrored)) for axis in (0, 1)]
    peaked = max(np.mean(each**4) / max(np.mean(each**2) ** 2, 1e-300) for each in bends)
    beyond_band = grid.sum_over_modes(power * (np.hypot(y, x) > 1 + 1e-9))
    has_creases = (directed > DIRECTED and peaked > PEAKED) or (on_axes > ON_AXES and peaked > GAUSSIAN)
    if parts[0] > LEAST_TAIL and has_creases:
        beyond_band = 1.0
    along_y, along_x = gradient(modes, fourier)
    both, squared = 2 * np.mean(along_y * along_x), along_y**2 + along_x**2
    if grid.mirrored:  # the images have the other sign
        both = 0.0
    anisotropy = np.hypot(np.mean(along_x**2 - along_y**2), both) / max(squared.mean(), 1e-300)
    bend = bends[0] + bends[1]
    kurtosis = np.mean(bend**4) / max(np.mean(bend**2) ** 2, 1e-300)
    departures = [
        (measure - first) / (last - first)
        for measure, (first, last) in ((anisotropy, ANISOTROPY), (abs(kurtosis - 3), KURTOSIS))
    ]
    lost_y, lost_x = gradient(modes - resample(resample(modes, grid, half), half, grid), fourier)
    lost = lost_y**2 + lost_x**2
    share = np.sum(lost[touching]) / max(np.sum(squared[touching]), 1e-300)
    return {
        "departure": float(np.clip(max(departures), 0, 1)),
        "unresolved": float(np.sqrt(share / (1 + share))),
        "beyond_band": beyond_band,
    }


def _quantiles(of_peaks: xr.Dataset) -> xr.Dataset:
    """Quantiles of the peaks at all levels, and at the levels of `PERCENTILES` by name."""
    quantile = of_peaks["peak_quantile"]
    named = {name: quantile.sel(level=level, drop=True) for name, level in PERCENTILES.items()}
    return xr.Dataset({"peak_quantile": quantile, **named})
