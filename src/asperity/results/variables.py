"""Names, dimensions and descriptions of the variables of result files, and what the files of a stage hold.

The dimension of a variable stands here once; its unit follows from the system of units of the file
(`UNIT_SYSTEMS`), which the global attribute ``unit_system`` names. Results of the study have lengths in units
of the edge of the cell and stresses in units of the effective modulus E* = E/(1 − ν²); results for given
materials are in SI. A scaled stress is divided by E* and by the rms gradient of the deformed surface over the
true contact, the paper's E* ḡ_r. Texts and truth values have no unit.
"""

from __future__ import annotations

from typing import NamedTuple


class Variable(NamedTuple):
    """Dimension of a variable, and its description: the CF attributes ``long_name`` and ``comment``."""

    dimension: str
    long_name: str
    comment: str = ""


class Stage(NamedTuple):
    """A variable that only the files of a stage have, and what these files hold."""

    variable: str
    summary: str


STAGES = {
    "surface": Stage(
        "spectrum",
        "Heights of one rough surface on a periodic cell, their moments and their radially averaged power "
        "spectral density. The height is that of the rigid indenter's lower face, measured upward: the "
        "lowest points touch first.",
    ),
    "contact": Stage(
        "pressure",
        "Frictionless contact of an elastic solid with the rigid rough surface: contact pressure, "
        "displacement of the solid's surface and gap at one load; true contact area, load and gradient "
        "along the load path. Attributes: solid... is the solid that was computed and why, certificate_... "
        "how well the conditions of contact hold.",
    ),
    "stress": Stage(
        "peak_value",
        "Stress inside the solid under the contact, tension positive. Along peak: local maxima of the "
        "magnitude of each quantity in the whole solid, for each Poisson's ratio; asperity.peaks(dataset, "
        "quantity, poisson, selection) selects them by name. Along plane: mean and largest von Mises stress "
        "over depth, and covariance with the plane of the largest (Eq. 22). Along lag: covariance in that "
        "plane.",
    ),
    "statistics": Stage(
        "peak_density",
        "Distributions of the stress peaks of one surface over all its seeds, with confidence bands from a "
        "bootstrap over seeds (..._low, ..._high), NaN for a single seed. Along bin and depth_bin: densities "
        "and counts of peaks. Along percent: percentiles. Along plane and lag: depth profiles and "
        "covariances (Eq. 22), means over seeds. Along seed, in variables seed_...: numbers of each seed; "
        "along level: quantiles of its peaks.",
    ),
}


class UnitSystem(NamedTuple):
    """Units of a result file: the unit of each dimension, and what the names of the units mean."""

    units: dict[str, str]
    comment: str


_NUMBER = "1"
_LENGTH = "length"
_INVERSE_LENGTH = "1/length"
_SPECTRUM = "length^4"
_STRESS = "stress"
_STRESS_SQUARED = "stress^2"
_YOUNG = "stress over Young's modulus"
_FORCE = "force"
_SCALED = "scaled stress"
_INVERSE_SCALED = "1/scaled stress"
_SCALED_SQUARED = "scaled stress^2"
_HEIGHT = "height over rms height"
_INVERSE_HEIGHT = "1/height over rms height"
_SPACING = "length over grid spacing"
_TIME = "time"
_MEMORY = "memory"

_SAME_EVERYWHERE = {_NUMBER: "1", _TIME: "s", _MEMORY: "byte"}

STUDY_UNITS = "cell length and effective modulus"
"""Name of the system of units of the study."""

SI_UNITS = "SI"
"""Name of the system of units of results for given materials and loads."""

UNIT_SYSTEMS: dict[str, UnitSystem] = {
    STUDY_UNITS: UnitSystem(
        _SAME_EVERYWHERE
        | {
            _LENGTH: "cell_length",
            _INVERSE_LENGTH: "1/cell_length",
            _SPECTRUM: "cell_length^4",
            _STRESS: "effective_modulus",
            _STRESS_SQUARED: "effective_modulus^2",
            _YOUNG: "young_modulus",
            _FORCE: "effective_modulus*cell_length^2",
            _SCALED: "scaled_stress",
            _INVERSE_SCALED: "1/scaled_stress",
            _SCALED_SQUARED: "scaled_stress^2",
            _HEIGHT: "rms_height",
            _INVERSE_HEIGHT: "1/rms_height",
            _SPACING: "grid_spacing",
        },
        "Units: cell_length is the longer edge of the periodic cell, effective_modulus is E/(1 - nu^2), "
        "scaled_stress is effective_modulus times the rms gradient of the deformed surface over the true "
        "contact.",
    ),
    SI_UNITS: UnitSystem(
        _SAME_EVERYWHERE
        | {
            _LENGTH: "m",
            _INVERSE_LENGTH: "m-1",
            _SPECTRUM: "m4",
            _STRESS: "Pa",
            _STRESS_SQUARED: "Pa2",
            _FORCE: "N",
            **dict.fromkeys(
                (_YOUNG, _SCALED, _INVERSE_SCALED, _SCALED_SQUARED, _HEIGHT, _INVERSE_HEIGHT, _SPACING), "1"
            ),
        },
        "Units: SI.",
    ),
}
"""Systems of units of result files by name."""


ORIENTATION = "lower face"
"""Attribute ``orientation`` of every height: an indenter's lower face, not a map with its peaks upward."""


def units_of(name: str, system: str = STUDY_UNITS) -> str:
    """Text of the CF attribute ``units`` of a variable in a system of units."""
    return UNIT_SYSTEMS[system].units[VARIABLES[name].dimension]


def _banded(name: str, dimension: str, long_name: str) -> dict[str, Variable]:
    """An estimate and the ends of its confidence band."""
    return {
        name: Variable(dimension, long_name),
        f"{name}_low": Variable(dimension, f"lower end of the band of {name}"),
        f"{name}_high": Variable(dimension, f"upper end of the band of {name}"),
    }


def _both(name: str, dimension: str, long_name: str) -> dict[str, Variable]:
    """The same quantity by the spectral solver and by finite elements."""
    return {
        f"{name}_spectral": Variable(dimension, f"{long_name}, spectral solver"),
        f"{name}_elements": Variable(dimension, f"{long_name}, finite elements"),
    }


def _compared(name: str, dimension: str, long_name: str) -> dict[str, Variable]:
    """The same quantity of the solver and of a closed form."""
    cases = {"solved": "found by the solver", "exact": "closed form"}
    return {f"{case}_{name}": Variable(dimension, f"{long_name}, {words}") for case, words in cases.items()}


def _punch(name: str, dimension: str, long_name: str) -> dict[str, Variable]:
    """The same quantity for the conventions of the uniform mode under a punch."""
    cases = {
        "confined": "laterally confined cell",
        "free": "laterally free cell",
        "array": "single contacts added up",
        "closed_form": "single contact, closed form",
    }
    return {f"{name}_{case}": Variable(dimension, f"{long_name}, {words}") for case, words in cases.items()}


VARIABLES: dict[str, Variable] = {
    # coordinates and the grid
    "x": Variable(_LENGTH, "position along x"),
    "y": Variable(_LENGTH, "position along y"),
    "wavenumber": Variable(_INVERSE_LENGTH, "magnitude of the wavevector, 2π over the wavelength"),
    "load": Variable(_NUMBER, "number of the load on the load-area path"),
    # surface
    "height": Variable(_LENGTH, "height of the indenter's lower face, measured upward, mean zero"),
    "rms_height": Variable(_LENGTH, "root-mean-square height"),
    "rms_gradient": Variable(_NUMBER, "root-mean-square gradient of the whole surface"),
    "skewness": Variable(_NUMBER, "skewness of the heights; positive: blunt contacts"),
    "kurtosis": Variable(_NUMBER, "kurtosis of the heights, 3 for a Gaussian"),
    "spectrum": Variable(_SPECTRUM, "radially averaged power spectral density of the heights"),
    "spectrum_target": Variable(
        _SPECTRUM, "power spectral density from which the surface was generated, on the same rings"
    ),
    "spectrum_before": Variable(
        _SPECTRUM, "spectrum of the Gaussian sample before its heights were transformed"
    ),
    "skewness_error": Variable(_NUMBER, "standard error of the skewness of one Gaussian sample"),
    "kurtosis_error": Variable(_NUMBER, "standard error of the kurtosis of one Gaussian sample"),
    # contact
    "pressure": Variable(_STRESS, "contact pressure, compression positive"),
    "gap": Variable(_LENGTH, "gap between solid and indenter"),
    "displacement": Variable(_LENGTH, "downward displacement of the solid's surface"),
    "area_fraction": Variable(_NUMBER, "true contact area over nominal area"),
    "mean_pressure": Variable(_STRESS, "load over nominal area"),
    "approach": Variable(_LENGTH, "approach of the indenter from first touch of its mean plane"),
    "gradient_rms_contact": Variable(_NUMBER, "rms gradient of the deformed surface over the true contact"),
    "path_area_fraction": Variable(_NUMBER, "true contact area over nominal area, along the load path"),
    "path_mean_pressure": Variable(_STRESS, "load over nominal area, along the load path"),
    "path_gradient_rms_contact": Variable(
        _NUMBER, "rms gradient of the deformed surface over the true contact, along the load path"
    ),
    # stress
    "quantity": Variable(
        _NUMBER,
        "quantity whose peaks were sought",
        "pressure: contact pressure; von_mises: von Mises stress; xx, yy, zz, yz, xz, xy: stress components; "
        "largest_shear: half the difference of largest and smallest principal stress; hydrostatic: mean of "
        "the normal stresses; principal_1, principal_2, principal_3: principal stresses, largest first",
    ),
    "poisson": Variable(_NUMBER, "Poisson's ratio"),
    "lag": Variable(_LENGTH, "distance between two points of the plane"),
    "peak_quantity": Variable(_NUMBER, "quantity of the peak, one of the names in quantity"),
    "peak_poisson": Variable(
        _NUMBER,
        "Poisson's ratio of the peak, one of the values in poisson",
        "NaN: the same peak for every Poisson's ratio; asperity.peaks finds it under each of them",
    ),
    "peak_value": Variable(
        _STRESS,
        "stress at the peak, tension positive; contact pressure, compression positive",
        "a peak is a maximum of the magnitude; the sign is kept",
    ),
    "peak_depth": Variable(_LENGTH, "depth of the peak below the surface"),
    "peak_y": Variable(_LENGTH, "position of the peak along y"),
    "peak_x": Variable(_LENGTH, "position of the peak along x"),
    "peak_interior": Variable(_NUMBER, "true for a peak below the surface, false for one in it"),
    "peak_under_contact": Variable(
        _NUMBER, "true if the surface node nearest above the peak carries pressure"
    ),
    "plane_depth": Variable(_LENGTH, "depth of the plane"),
    "plane_points": Variable(_NUMBER, "number of nodes on the longer edge of the plane's grid"),
    "mean_von_mises": Variable(_STRESS, "mean von Mises stress of the plane"),
    "largest_von_mises": Variable(_STRESS, "largest von Mises stress of the plane, at a node"),
    "covariance_depth": Variable(
        _STRESS_SQUARED, "covariance of the von Mises stress with that of the reference plane (Eq. 22)"
    ),
    "covariance_plane": Variable(
        _STRESS_SQUARED, "covariance of the von Mises stress in the reference plane over distance (Eq. 22)"
    ),
    "reference_depth": Variable(
        _LENGTH, "depth of the reference plane, that of the largest von Mises stress"
    ),
    # statistics; scaled: divided by the effective modulus and the rms gradient of the true contact
    "selection": Variable(_NUMBER, "which peaks are counted"),
    "percent": Variable(_NUMBER, "percentage of the peaks that are smaller"),
    "bin_edge": Variable(_SCALED, "edges of the bins of peak stress"),
    "depth_edge": Variable(_LENGTH, "edges of the bins of peak depth"),
    "peak_counts": Variable(_NUMBER, "number of peaks in the bin, seed by seed"),
    "joint_counts": Variable(_NUMBER, "number of peaks in the bin of stress and depth, all seeds"),
    **_banded("peak_density", _INVERSE_SCALED, "probability density of the scaled peak stress"),
    **_banded("peak_percentile", _SCALED, "percentile of the magnitude of the scaled peak stress"),
    **_banded("scaled_covariance_depth", _SCALED_SQUARED, "scaled covariance along depth (Eq. 22)"),
    **_banded(
        "scaled_covariance_plane", _SCALED_SQUARED, "scaled covariance in the reference plane (Eq. 22)"
    ),
    **_banded("scaled_mean_von_mises", _SCALED, "scaled mean von Mises stress of the plane"),
    **_banded("scaled_largest_von_mises", _SCALED, "scaled largest von Mises stress of the plane"),
    "reference_depth_low": Variable(_LENGTH, "lower end of the band of reference_depth"),
    "reference_depth_high": Variable(_LENGTH, "upper end of the band of reference_depth"),
    "height_edge": Variable(_HEIGHT, "edges of the bins of height"),
    "height_counts": Variable(_NUMBER, "number of nodes in the bin of height"),
    "height_density": Variable(_INVERSE_HEIGHT, "probability density of the heights"),
    "median_depth": Variable(_LENGTH, "median depth of the peaks"),
    "median_depth_highest": Variable(_LENGTH, "median depth of the highest tenth of the peaks"),
    # statistics of each seed
    "seed": Variable(_NUMBER, "seed of the random surface"),
    "level": Variable(_NUMBER, "share of the peaks that are smaller"),
    "seed_nayak": Variable(_NUMBER, "Nayak's parameter of the surface, m0 m4 / m2^2"),
    "seed_boundary_length": Variable(_LENGTH, "length of the boundary of contact along the edges of nodes"),
    "seed_squared_gradient_contact": Variable(
        _NUMBER, "integral of the squared gradient of the rough surface over the contact"
    ),
    "seed_squared_gradient_boundary": Variable(
        _LENGTH, "integral of the squared gradient of the rough surface along the boundary of contact"
    ),
    "seed_pressure_length": Variable(_LENGTH, "distance at which the autocovariance of the pressure halves"),
    "seed_hydraulic_radius": Variable(_LENGTH, "twice the area of contact over the length of its boundary"),
    "seed_height_length": Variable(_LENGTH, "rms height over rms profile slope over the contact"),
    "seed_curvature_length": Variable(_LENGTH, "rms profile slope over rms curvature over the contact"),
    "seed_skewness": Variable(_NUMBER, "skewness of the heights"),
    "seed_kurtosis": Variable(_NUMBER, "kurtosis of the heights"),
    "seed_rms_gradient": Variable(_NUMBER, "root-mean-square gradient of the whole surface"),
    "seed_gradient_rms_contact": Variable(
        _NUMBER, "rms gradient of the deformed surface over the true contact"
    ),
    "seed_gradient_rms_outside": Variable(_NUMBER, "rms gradient of the surface outside the true contact"),
    "seed_mean_pressure": Variable(_STRESS, "load over nominal area"),
    "seed_area_fraction": Variable(_NUMBER, "true contact area over nominal area"),
    "seed_approach": Variable(_LENGTH, "approach of the indenter from first touch of its mean plane"),
    "seed_proportionality": Variable(
        _NUMBER, "area fraction times rms gradient of the true contact over the load, κ"
    ),
    "seed_load_exponent": Variable(_NUMBER, "exponent of the area fraction as a power of the scaled load"),
    "seed_proportionality_change": Variable(
        _NUMBER, "κ at the largest load of that fit over κ at the smallest"
    ),
    "seed_patches": Variable(_NUMBER, "number of connected patches of contact"),
    "seed_patch_radius": Variable(_LENGTH, "area-weighted mean radius of the patches of contact"),
    "seed_peak_count": Variable(_NUMBER, "number of peaks"),
    "seed_peak_mean": Variable(_SCALED, "mean magnitude of the peaks"),
    "seed_peak_deviation": Variable(_SCALED, "standard deviation of the magnitude of the peaks"),
    "seed_peak_quantile": Variable(_SCALED, "quantile of the magnitude of the peaks"),
    "seed_mean_depth": Variable(_LENGTH, "mean depth of the peaks"),
    "seed_mean_depth_highest": Variable(_LENGTH, "mean depth of the highest tenth of the peaks"),
    "seed_depth_patch_correlation": Variable(
        _NUMBER, "rank correlation between the depth of von Mises peaks and the radius of the patch above"
    ),
    "seed_largest_von_mises": Variable(_SCALED, "largest von Mises stress in the solid"),
    "seed_reference_depth": Variable(_LENGTH, "depth of the plane with the largest von Mises stress"),
    "seed_decay_length_depth": Variable(_LENGTH, "depth over which the covariance of Eq. 22 falls to half"),
    "seed_decay_length_plane": Variable(
        _LENGTH, "distance over which the covariance of Eq. 22 falls to half"
    ),
    # ensemble
    "lateral": Variable(_NUMBER, "condition of the uniform mode, laterally confined or free cell"),
    "seed_seconds": Variable(_TIME, "processor time of one seed, all stages"),
    "grid_nodes": Variable(_NUMBER, "nodes on the shortest wavelength; 0 for the surface alone, no contact"),
    "grid_used": Variable(_NUMBER, "1 if the level is used in the estimate, 0 if only in its bias"),
    "grid_seeds": Variable(_NUMBER, "number of seeds"),
    "grid_mean": Variable(_NUMBER, "mean over the seeds of the grid"),
    "grid_deviation": Variable(_NUMBER, "standard deviation over seeds"),
    "grid_difference": Variable(_NUMBER, "mean difference from the next coarser grid, over common seeds"),
    "grid_difference_error": Variable(_NUMBER, "standard error of the mean difference"),
    "grid_correlation": Variable(
        _NUMBER,
        "correlation with the next coarser level over common seeds",
        "With the surface alone: multiple correlation with rms gradient, skewness and kurtosis.",
    ),
    "grid_seconds": Variable(_TIME, "processor time of one seed on the grid, median"),
    "estimate": Variable(_NUMBER, "estimate of the mean on the finest grid"),
    "estimate_error": Variable(_NUMBER, "standard error of the estimate"),
    "estimate_low": Variable(_NUMBER, "lower end of the 95 % interval of the mean on the finest grid"),
    "estimate_high": Variable(_NUMBER, "upper end of the 95 % interval of the mean on the finest grid"),
    "estimate_bias": Variable(_NUMBER, "what vanishing grid spacing adds to the estimate"),
    "estimate_order": Variable(_NUMBER, "order of convergence of the grids by which the bias is judged"),
    "estimate_total_error": Variable(_NUMBER, "root of the squared standard error and the squared bias"),
    "estimate_seconds": Variable(_TIME, "processor time of all seeds of the estimate"),
    "plain_estimate": Variable(_NUMBER, "mean over the seeds of the finest grid alone"),
    "plain_error": Variable(_NUMBER, "its standard error"),
    "plain_seconds": Variable(_TIME, "processor time of the seeds of the finest grid"),
    "plain_seconds_same_error": Variable(
        _TIME, "processor time of plain Monte Carlo on the finest grid for the standard error of the estimate"
    ),
    "plain_seconds_same_error_fine": Variable(
        _TIME, "the same by the variance of the seeds of the finest grid alone"
    ),
    "gain": Variable(_NUMBER, "processor time of plain Monte Carlo for the same standard error, over this"),
    "gain_low": Variable(_NUMBER, "lower end of the 95 % interval of the gain"),
    "gain_high": Variable(_NUMBER, "upper end of the 95 % interval of the gain"),
    "gain_fine": Variable(_NUMBER, "gain by the variance of the seeds of the finest grid alone"),
    "gain_low_fine": Variable(_NUMBER, "lower end of its 95 % interval"),
    "gain_high_fine": Variable(_NUMBER, "upper end of its 95 % interval"),
    "course_seeds": Variable(_NUMBER, "seeds of the finest grid in a part of the samples"),
    "course_seconds": Variable(_TIME, "processor time of a part of the samples of all levels"),
    "course_error": Variable(_NUMBER, "standard error of the estimate from a part of the samples"),
    "plain_course_seeds": Variable(_NUMBER, "seeds of a part of the finest grid alone"),
    "plain_course_seconds": Variable(_TIME, "processor time of a part of the seeds of the finest grid alone"),
    "plain_course_error": Variable(
        _NUMBER, "standard error of the mean over a part of the finest grid alone"
    ),
    # statistics of each seed, for the readings of the claims
    "counted": Variable(
        _NUMBER,
        "von Mises peaks that are counted",
        "below_surface: those below the surface under a contact; with_surface: also those in it; "
        "highest_of_patch: the highest below each patch of contact; large_patches: that of each large patch",
    ),
    "seed_counted_count": Variable(_NUMBER, "number of the counted peaks"),
    "seed_counted_deviation": Variable(_SCALED, "standard deviation of the counted peaks"),
    "seed_counted_quantile": Variable(_SCALED, "quantile of the counted peaks"),
    "seed_counted_depth_highest": Variable(_LENGTH, "mean depth of the highest tenth of the counted peaks"),
    "seed_counted_correlation": Variable(
        _NUMBER, "rank correlation between the depth of counted peaks and the radius of the patch above"
    ),
    "decay": Variable(
        _NUMBER, "share of its value in the reference plane to which the covariance of Eq. 22 falls"
    ),
    "seed_decay_depth": Variable(_LENGTH, "depth over which the covariance of Eq. 22 falls to this share"),
    "seed_decay_plane": Variable(
        _LENGTH, "distance in the reference plane over which the covariance of Eq. 22 falls to this share"
    ),
    # validation
    "hertz_contact_radius": Variable(_LENGTH, "radius of contact of the closed form"),
    "hertz_area_fraction": Variable(_NUMBER, "area fraction of the closed form"),
    "imposed_mean_pressure_young": Variable(_YOUNG, "load over nominal area of the closed form, imposed"),
    "solved_area_fraction": Variable(_NUMBER, "area fraction found by the solver, nodes counted"),
    **_compared("contact_radius", _LENGTH, "radius of contact"),
    "curve_area_fraction": Variable(_NUMBER, "area fraction of the closed form, along the drawn curve"),
    "curve_mean_pressure_young": Variable(_YOUNG, "load over nominal area, along the drawn curve"),
    "curve_mean_pressure": Variable(_STRESS, "load over nominal area, along the drawn curve"),
    "slab_height": Variable(_LENGTH, "height of the slab"),
    "slab_approach": Variable(_LENGTH, "indentation of the slab"),
    "slab_area_fraction": Variable(_NUMBER, "area fraction on the slab, nodes counted"),
    "slab_contact_radius": Variable(_LENGTH, "radius of contact on the slab, fitted to the pressure"),
    "slab_mean_pressure": Variable(_STRESS, "load over nominal area of the slab"),
    "slab_stiffening": Variable(_NUMBER, "load over that of Hertz on a half-space at the same approach"),
    "grid_points": Variable(_NUMBER, "nodes of the grid on an edge"),
    "wave_pressure_error": Variable(_NUMBER, "relative L2 error of the pressure, against Westergaard"),
    "wave_approach_error": Variable(_NUMBER, "relative error of the approach, against Westergaard"),
    "wave_area_error": Variable(_NUMBER, "relative error of the area of contact, against Westergaard"),
    "slab_load_error": Variable(
        _NUMBER, "relative error of the load at given approach, against twice the finest grid"
    ),
    "distance": Variable(_LENGTH, "distance from the indenter's axis along the diagonal"),
    "depth": Variable(_LENGTH, "depth below the surface"),
    "load_spectral": Variable(_FORCE, "force on the indenter, spectral solver"),
    "load_elements": Variable(_FORCE, "force on the indenter, finite elements"),
    "contact_radius": Variable(_LENGTH, "radius of contact"),
    **_both("displacement_z", _LENGTH, "displacement along z, upward positive"),
    **_both("stress_zz", _STRESS, "stress zz"),
    **_both("stress_xx", _STRESS, "stress xx"),
    **_both("stress_xz", _STRESS, "stress xz"),
    **_both("pressure", _STRESS, "contact pressure along x"),
    "axis_node": Variable(_LENGTH, "nodes of the elements along x from the indenter's axis"),
    "axis_position": Variable(_LENGTH, "nodes of the spectral grid along x from the indenter's axis"),
    "node_y": Variable(_LENGTH, "nodes of the elements along y from the indenter's axis"),
    "node_z": Variable(_LENGTH, "nodes of the elements along z from the bottom"),
    "component": Variable(_NUMBER, "component of the displacement"),
    "surface_displacement_elements": Variable(
        _LENGTH, "displacement along z of the surface of a quarter cell"
    ),
    "wall_displacement_elements": Variable(
        _LENGTH, "displacement x, y, z of the mirror plane through the axis"
    ),
    "rim_displacement_elements": Variable(_LENGTH, "displacement x, y, z of the face of the cell"),
    "field": Variable(_NUMBER, "compared field"),
    "mesh_elements": Variable(_NUMBER, "elements along half an edge of the cell"),
    "difference_away": Variable(
        _NUMBER, "largest difference over the field's largest magnitude, away from the edge"
    ),
    "difference_edge": Variable(
        _NUMBER, "largest difference over the field's largest magnitude, near the edge"
    ),
    "difference_load": Variable(_NUMBER, "load of the elements over that of the spectral solver, less one"),
    "von_mises_spectral": Variable(_STRESS, "von Mises stress of the laterally confined periodic cell"),
    "von_mises_closed_form": Variable(_STRESS, "von Mises stress of a single contact, closed form"),
    **_punch("peak_von_mises", _STRESS, "largest von Mises stress"),
    **_punch("peak_depth", _LENGTH, "depth of the largest von Mises stress"),
    "largest_pressure": Variable(_STRESS, "largest pressure of the closed form"),
    "largest_pressure_spectral": Variable(_STRESS, "largest pressure, spectral solver"),
    "axis_ratio": Variable(_NUMBER, "semi-axes b/a of the ellipse of contact"),
    **_compared("largest_pressure", _STRESS, "largest pressure"),
    **_compared("area", _NUMBER, "area of contact over area of the map"),
    **_compared("von_mises", _STRESS, "largest von Mises stress on the axis"),
    **_compared("von_mises_depth", _LENGTH, "depth of the largest von Mises stress on the axis"),
    **_compared("largest_shear", _STRESS, "largest shear stress on the axis"),
    **_compared("largest_shear_depth", _LENGTH, "depth of the largest shear stress on the axis"),
    "radial_distance": Variable(_NUMBER, "distance from the indenter's axis over the radius of contact"),
    **_compared("tension", _NUMBER, "radial stress of the surface over the largest pressure"),
    "indenter": Variable(_NUMBER, "indenter"),
    "contact_ratio": Variable(_NUMBER, "radius of contact over height of the layer"),
    **_compared("load", _STRESS, "load over the area of the cell"),
    "small_load": Variable(_NUMBER, "load over the smallest one of complete contact"),
    "nearly_complete_load": Variable(_NUMBER, "load over the smallest one of complete contact"),
    **_compared("mean_gap", _LENGTH, "mean gap over the cell"),
    "error": Variable(_NUMBER, "error over the scale of the quantity"),
    "scaled_wavenumber": Variable(_NUMBER, "wavenumber times height of the layer"),
    "formula": Variable(_NUMBER, "how the quantity was computed"),
    "precision": Variable(_NUMBER, "floating-point precision"),
    # extremes
    "outcome": Variable(_NUMBER, "what became of the contact with the two levels"),
    "scaled_violation": Variable(_NUMBER, "violation of the conditions of contact over the tolerance"),
    "scaled_pressure_error": Variable(_NUMBER, "relative L2 error of the pressure over the tolerance"),
    "reason": Variable(_NUMBER, "why there is no solution, or none that was checked"),
    "level_axis": Variable(_NUMBER, "setting that the level is one of"),
    "level_value": Variable(_NUMBER, "value of the setting"),
    "level_default": Variable(_NUMBER, "1 if the level is that of the scene that others change"),
    "beyond_axis": Variable(_NUMBER, "setting that is out of its range"),
    "beyond_value": Variable(_NUMBER, "value out of range"),
    "beyond_outcome": Variable(_NUMBER, "what became of the contact with a value out of range"),
    "beyond_reason": Variable(_NUMBER, "why there is no solution"),
    # the trade between speed and accuracy
    "output": Variable(_NUMBER, "what an error is of"),
    "run_parameter": Variable(_NUMBER, "parameter of accuracy that is varied; empty for a reference"),
    "run_setting": Variable(_NUMBER, "setting of the varied parameter"),
    "run_seed": Variable(_NUMBER, "seed of the surface"),
    "run_hurst": Variable(_NUMBER, "Hurst exponent"),
    "run_wavelength_long": Variable(_LENGTH, "longest wavelength of the surface"),
    "run_wavelength_short": Variable(_LENGTH, "shortest wavelength of the surface"),
    "run_area_fraction": Variable(_NUMBER, "area fraction asked for"),
    "run_points": Variable(_NUMBER, "nodes on an edge of the grid"),
    "run_ratios": Variable(_NUMBER, "Poisson's ratios analysed"),
    "run_loads": Variable(_NUMBER, "loads solved"),
    "points_per_wavelength": Variable(_NUMBER, "grid spacings on the shortest wavelength"),
    "contact_tolerance": Variable(_NUMBER, "largest relative residual of the contact"),
    "depth_tolerance": Variable(_NUMBER, "error allowed where a deep plane is computed on a coarser grid"),
    "depth_spacing": Variable(_SPACING, "distance between the planes nearest to the surface"),
    "half_space_tolerance": Variable(
        _NUMBER, "largest difference at which a half-space stands for the layer"
    ),
    "surface_seconds": Variable(_TIME, "processor time to make the surface"),
    "contact_seconds": Variable(_TIME, "processor time of the contact"),
    "stress_seconds": Variable(_TIME, "processor time of the stress inside the solid"),
    "transform_seconds": Variable(_TIME, "processor time of a pair of transforms of the grid"),
    "contact_pairs": Variable(_NUMBER, "transforms of the contact, in pairs of the finest grid"),
    "full_planes": Variable(_NUMBER, "planes of stress, in planes of the finest grid"),
    "peak_memory": Variable(_MEMORY, "largest resident memory of the process"),
    "output_value": Variable(_NUMBER, "value of the output, in its unit"),
    "output_error": Variable(_NUMBER, "relative difference to the reference"),
    "proportionality": Variable(
        _NUMBER, "area fraction times rms gradient of the true contact over the load, κ"
    ),
    "pressure_p90": Variable(_SCALED, "90th percentile of the peaks of the contact pressure"),
    "pressure_p99": Variable(_SCALED, "99th percentile of the peaks of the contact pressure"),
    "von_mises_p90": Variable(_SCALED, "90th percentile of the peaks of the von Mises stress"),
    "von_mises_p99": Variable(_SCALED, "99th percentile of the peaks of the von Mises stress"),
    "pressure_distribution": Variable(_NUMBER, "distribution of the peaks of the contact pressure"),
    "von_mises_distribution": Variable(_NUMBER, "distribution of the peaks of the von Mises stress"),
    "decay_length_depth": Variable(_LENGTH, "depth over which the covariance of Eq. 22 falls to half"),
    "decay_length_plane": Variable(_LENGTH, "distance over which the covariance of Eq. 22 falls to half"),
}
