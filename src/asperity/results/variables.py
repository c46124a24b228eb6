"""Names, units and descriptions of the variables of the result files, and what the files of a stage hold.

The units written here are those of the study: lengths in units of the edge of the cell, stresses in units of
the effective modulus E* = E/(1 − ν²). A file in SI units holds lengths in m, stresses in Pa and forces in N;
`units_in` translates. The global attribute ``unit_system`` of a file says which of `UNIT_SYSTEMS` it uses. A
scaled stress is divided by E* and by the rms gradient of the deformed surface over the true contact, the
paper's E* ḡ_r. Numbers without a dimension have the unit 1; texts and truth values have none.
"""

from __future__ import annotations

import re
from typing import NamedTuple


class Variable(NamedTuple):
    """Unit and description of a variable: the CF attributes ``units``, ``long_name`` and ``comment``."""

    units: str
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


UNITS = (
    "Units: cell_length is the longer edge of the periodic cell, effective_modulus is E/(1 - nu^2), "
    "scaled_stress is effective_modulus times the rms gradient of the deformed surface over the true contact."
)
"""What the names of the units mean, for the files."""

STUDY_UNITS = "cell length and effective modulus"
SI_UNITS = "SI"

UNIT_SYSTEMS = {
    STUDY_UNITS: UNITS,
    SI_UNITS: "Units: m, Pa and N; scaled_stress is the effective modulus E/(1 - nu^2) times the rms "
    "gradient of the deformed surface over the true contact.",
}
"""Values of the attribute ``unit_system`` of a file, and what the names of its units mean."""

_SI = {"cell_length": "m", "effective_modulus": "Pa", "young_modulus": "Pa", "rms_height": "m"}

_LENGTH = "cell_length"
_STRESS = "effective_modulus"
_STRESS_SQUARED = "effective_modulus^2"
_SCALED = "scaled_stress"
_YOUNG = "young_modulus"
_FORCE = "effective_modulus*cell_length^2"


def units_in(system: str, units: str) -> str:
    """Units of a variable in one of `UNIT_SYSTEMS`, from its units in the study."""
    if system == STUDY_UNITS:
        return units
    if units == _FORCE:
        return "N"
    return re.sub("|".join(_SI), lambda found: _SI[found[0]], units)


def _banded(name: str, units: str, long_name: str) -> dict[str, Variable]:
    """An estimate and the ends of its confidence band."""
    return {
        name: Variable(units, long_name),
        f"{name}_low": Variable(units, f"lower end of the band of {name}"),
        f"{name}_high": Variable(units, f"upper end of the band of {name}"),
    }


def _both(name: str, units: str, long_name: str) -> dict[str, Variable]:
    """The same quantity by the spectral solver and by finite elements."""
    return {
        f"{name}_spectral": Variable(units, f"{long_name}, spectral solver"),
        f"{name}_elements": Variable(units, f"{long_name}, finite elements"),
    }


def _punch(name: str, units: str, long_name: str) -> dict[str, Variable]:
    """The same quantity for the conventions of the uniform mode under a punch."""
    cases = {
        "confined": "laterally confined cell",
        "free": "laterally free cell",
        "array": "single contacts added up",
        "closed_form": "single contact, closed form",
    }
    return {f"{name}_{case}": Variable(units, f"{long_name}, {words}") for case, words in cases.items()}


VARIABLES: dict[str, Variable] = {
    # coordinates and the grid
    "x": Variable(_LENGTH, "position along x"),
    "y": Variable(_LENGTH, "position along y"),
    "wavenumber": Variable("1/cell_length", "magnitude of the wavevector, 2π over the wavelength"),
    "load": Variable("1", "number of the load on the load-area path"),
    # surface
    "height": Variable(_LENGTH, "height of the indenter's lower face, measured upward, mean zero"),
    "rms_height": Variable(_LENGTH, "root-mean-square height"),
    "rms_gradient": Variable("1", "root-mean-square gradient of the whole surface"),
    "skewness": Variable("1", "skewness of the heights; positive: blunt contacts"),
    "kurtosis": Variable("1", "kurtosis of the heights, 3 for a Gaussian"),
    "spectrum": Variable("cell_length^4", "radially averaged power spectral density of the heights"),
    "spectrum_target": Variable(
        "cell_length^4", "power spectral density from which the surface was generated, on the same rings"
    ),
    "spectrum_before": Variable(
        "cell_length^4", "spectrum of the Gaussian sample before its heights were transformed"
    ),
    "skewness_error": Variable("1", "standard error of the skewness of one Gaussian sample"),
    "kurtosis_error": Variable("1", "standard error of the kurtosis of one Gaussian sample"),
    # contact
    "pressure": Variable(_STRESS, "contact pressure, compression positive"),
    "gap": Variable(_LENGTH, "gap between solid and indenter"),
    "displacement": Variable(_LENGTH, "downward displacement of the solid's surface"),
    "area_fraction": Variable("1", "true contact area over nominal area"),
    "mean_pressure": Variable(_STRESS, "load over nominal area"),
    "approach": Variable(_LENGTH, "approach of the indenter from first touch of its mean plane"),
    "gradient_rms_contact": Variable("1", "rms gradient of the deformed surface over the true contact"),
    "path_area_fraction": Variable("1", "true contact area over nominal area, along the load path"),
    "path_mean_pressure": Variable(_STRESS, "load over nominal area, along the load path"),
    "path_gradient_rms_contact": Variable(
        "1", "rms gradient of the deformed surface over the true contact, along the load path"
    ),
    # stress
    "quantity": Variable(
        "1",
        "quantity whose peaks were sought",
        "pressure: contact pressure; von_mises: von Mises stress; xx, yy, zz, yz, xz, xy: stress components; "
        "largest_shear: half the difference of largest and smallest principal stress; hydrostatic: mean of "
        "the normal stresses; principal_1, principal_2, principal_3: principal stresses, largest first",
    ),
    "poisson": Variable("1", "Poisson's ratio"),
    "lag": Variable(_LENGTH, "distance between two points of the plane"),
    "peak_quantity": Variable("1", "quantity of the peak, one of the names in quantity"),
    "peak_poisson": Variable(
        "1",
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
    "peak_interior": Variable("1", "true for a peak below the surface, false for one in it"),
    "peak_under_contact": Variable("1", "true if the surface node nearest above the peak carries pressure"),
    "plane_depth": Variable(_LENGTH, "depth of the plane"),
    "plane_points": Variable("1", "number of nodes on the longer edge of the plane's grid"),
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
    "selection": Variable("1", "which peaks are counted"),
    "percent": Variable("1", "percentage of the peaks that are smaller"),
    "bin_edge": Variable(_SCALED, "edges of the bins of peak stress"),
    "depth_edge": Variable(_LENGTH, "edges of the bins of peak depth"),
    "peak_counts": Variable("1", "number of peaks in the bin, seed by seed"),
    "joint_counts": Variable("1", "number of peaks in the bin of stress and depth, all seeds"),
    **_banded("peak_density", "1/scaled_stress", "probability density of the scaled peak stress"),
    **_banded("peak_percentile", _SCALED, "percentile of the magnitude of the scaled peak stress"),
    **_banded("scaled_covariance_depth", "scaled_stress^2", "scaled covariance along depth (Eq. 22)"),
    **_banded(
        "scaled_covariance_plane", "scaled_stress^2", "scaled covariance in the reference plane (Eq. 22)"
    ),
    **_banded("scaled_mean_von_mises", _SCALED, "scaled mean von Mises stress of the plane"),
    **_banded("scaled_largest_von_mises", _SCALED, "scaled largest von Mises stress of the plane"),
    "reference_depth_low": Variable(_LENGTH, "lower end of the band of reference_depth"),
    "reference_depth_high": Variable(_LENGTH, "upper end of the band of reference_depth"),
    "height_edge": Variable("rms_height", "edges of the bins of height"),
    "height_counts": Variable("1", "number of nodes in the bin of height"),
    "height_density": Variable("1/rms_height", "probability density of the heights"),
    "median_depth": Variable(_LENGTH, "median depth of the peaks"),
    "median_depth_highest": Variable(_LENGTH, "median depth of the highest tenth of the peaks"),
    # statistics of each seed
    "seed": Variable("1", "seed of the random surface"),
    "level": Variable("1", "share of the peaks that are smaller"),
    "seed_skewness": Variable("1", "skewness of the heights"),
    "seed_kurtosis": Variable("1", "kurtosis of the heights"),
    "seed_rms_gradient": Variable("1", "root-mean-square gradient of the whole surface"),
    "seed_gradient_rms_contact": Variable("1", "rms gradient of the deformed surface over the true contact"),
    "seed_gradient_rms_outside": Variable("1", "rms gradient of the surface outside the true contact"),
    "seed_mean_pressure": Variable(_STRESS, "load over nominal area"),
    "seed_area_fraction": Variable("1", "true contact area over nominal area"),
    "seed_approach": Variable(_LENGTH, "approach of the indenter from first touch of its mean plane"),
    "seed_proportionality": Variable(
        "1", "area fraction times rms gradient of the true contact over the load, κ"
    ),
    "seed_load_exponent": Variable("1", "exponent of the area fraction as a power of the scaled load"),
    "seed_proportionality_change": Variable("1", "κ at the largest load of that fit over κ at the smallest"),
    "seed_patches": Variable("1", "number of connected patches of contact"),
    "seed_patch_radius": Variable(_LENGTH, "area-weighted mean radius of the patches of contact"),
    "seed_peak_count": Variable("1", "number of peaks"),
    "seed_peak_mean": Variable(_SCALED, "mean magnitude of the peaks"),
    "seed_peak_deviation": Variable(_SCALED, "standard deviation of the magnitude of the peaks"),
    "seed_peak_quantile": Variable(_SCALED, "quantile of the magnitude of the peaks"),
    "seed_mean_depth": Variable(_LENGTH, "mean depth of the peaks"),
    "seed_mean_depth_highest": Variable(_LENGTH, "mean depth of the highest tenth of the peaks"),
    "seed_depth_patch_correlation": Variable(
        "1", "rank correlation between the depth of von Mises peaks and the radius of the patch above"
    ),
    "seed_largest_von_mises": Variable(_SCALED, "largest von Mises stress in the solid"),
    "seed_reference_depth": Variable(_LENGTH, "depth of the plane with the largest von Mises stress"),
    "seed_decay_length_depth": Variable(_LENGTH, "depth over which the covariance of Eq. 22 falls to half"),
    "seed_decay_length_plane": Variable(
        _LENGTH, "distance over which the covariance of Eq. 22 falls to half"
    ),
    # validation
    "hertz_contact_radius": Variable(_LENGTH, "radius of contact of the closed form"),
    "hertz_area_fraction": Variable("1", "area fraction of the closed form"),
    "imposed_mean_pressure_young": Variable(_YOUNG, "load over nominal area of the closed form, imposed"),
    "solved_area_fraction": Variable("1", "area fraction found by the solver, nodes counted"),
    "solved_contact_radius": Variable(
        _LENGTH, "radius of contact found by the solver, fitted to the pressure"
    ),
    "curve_area_fraction": Variable("1", "area fraction of the closed form, along the drawn curve"),
    "curve_mean_pressure_young": Variable(_YOUNG, "load over nominal area, along the drawn curve"),
    "curve_mean_pressure": Variable(_STRESS, "load over nominal area, along the drawn curve"),
    "slab_height": Variable(_LENGTH, "height of the slab"),
    "slab_approach": Variable(_LENGTH, "indentation of the slab"),
    "slab_area_fraction": Variable("1", "area fraction on the slab, nodes counted"),
    "slab_contact_radius": Variable(_LENGTH, "radius of contact on the slab, fitted to the pressure"),
    "slab_mean_pressure": Variable(_STRESS, "load over nominal area of the slab"),
    "slab_stiffening": Variable("1", "load over that of Hertz on a half-space at the same approach"),
    "grid_points": Variable("1", "nodes of the grid on an edge"),
    "wave_pressure_error": Variable("1", "relative L2 error of the pressure, against Westergaard"),
    "wave_approach_error": Variable("1", "relative error of the approach, against Westergaard"),
    "wave_area_error": Variable("1", "relative error of the area of contact, against Westergaard"),
    "slab_load_error": Variable(
        "1", "relative error of the load at given approach, against twice the finest grid"
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
    "component": Variable("1", "component of the displacement"),
    "surface_displacement_elements": Variable(
        _LENGTH, "displacement along z of the surface of a quarter cell"
    ),
    "wall_displacement_elements": Variable(
        _LENGTH, "displacement x, y, z of the mirror plane through the axis"
    ),
    "rim_displacement_elements": Variable(_LENGTH, "displacement x, y, z of the face of the cell"),
    "field": Variable("1", "compared field"),
    "mesh_elements": Variable("1", "elements along half an edge of the cell"),
    "difference_away": Variable(
        "1", "largest difference over the field's largest magnitude, away from the edge"
    ),
    "difference_edge": Variable("1", "largest difference over the field's largest magnitude, near the edge"),
    "difference_load": Variable("1", "load of the elements over that of the spectral solver, less one"),
    "von_mises_spectral": Variable(_STRESS, "von Mises stress of the laterally confined periodic cell"),
    "von_mises_closed_form": Variable(_STRESS, "von Mises stress of a single contact, closed form"),
    **_punch("peak_von_mises", _STRESS, "largest von Mises stress"),
    **_punch("peak_depth", _LENGTH, "depth of the largest von Mises stress"),
    "largest_pressure": Variable(_STRESS, "largest pressure of the closed form"),
    "largest_pressure_spectral": Variable(_STRESS, "largest pressure, spectral solver"),
    "error": Variable("1", "error over the scale of the quantity"),
    "scaled_wavenumber": Variable("1", "wavenumber times height of the layer"),
    "formula": Variable("1", "how the quantity was computed"),
    "precision": Variable("1", "floating-point precision"),
    # extremes
    "outcome": Variable("1", "what became of the contact with the two levels"),
    "scaled_violation": Variable("1", "violation of the conditions of contact over the tolerance"),
    "scaled_pressure_error": Variable("1", "relative L2 error of the pressure over the tolerance"),
    "reason": Variable("1", "why there is no solution, or none that was checked"),
    "level_axis": Variable("1", "setting that the level is one of"),
    "level_value": Variable("1", "value of the setting"),
    "level_default": Variable("1", "1 if the level is that of the scene that others change"),
    "beyond_axis": Variable("1", "setting that is out of its range"),
    "beyond_value": Variable("1", "value out of range"),
    "beyond_outcome": Variable("1", "what became of the contact with a value out of range"),
    "beyond_reason": Variable("1", "why there is no solution"),
    # the trade between speed and accuracy
    "output": Variable("1", "what an error is of"),
    "run_parameter": Variable("1", "parameter of accuracy that is varied; empty for a reference"),
    "run_setting": Variable("1", "setting of the varied parameter"),
    "run_seed": Variable("1", "seed of the surface"),
    "run_hurst": Variable("1", "Hurst exponent"),
    "run_wavelength_long": Variable(_LENGTH, "longest wavelength of the surface"),
    "run_wavelength_short": Variable(_LENGTH, "shortest wavelength of the surface"),
    "run_area_fraction": Variable("1", "area fraction asked for"),
    "run_points": Variable("1", "nodes on an edge of the grid"),
    "run_ratios": Variable("1", "Poisson's ratios analysed"),
    "run_loads": Variable("1", "loads solved"),
    "points_per_wavelength": Variable("1", "grid spacings on the shortest wavelength"),
    "contact_tolerance": Variable("1", "largest relative residual of the contact"),
    "depth_tolerance": Variable("1", "error allowed where a deep plane is computed on a coarser grid"),
    "depth_spacing": Variable("grid_spacing", "distance between the planes nearest to the surface"),
    "half_space_tolerance": Variable("1", "largest difference at which a half-space stands for the layer"),
    "surface_seconds": Variable("s", "processor time to make the surface"),
    "contact_seconds": Variable("s", "processor time of the contact"),
    "stress_seconds": Variable("s", "processor time of the stress inside the solid"),
    "transform_seconds": Variable("s", "processor time of a pair of transforms of the grid"),
    "contact_pairs": Variable("1", "transforms of the contact, in pairs of the finest grid"),
    "full_planes": Variable("1", "planes of stress, in planes of the finest grid"),
    "peak_memory": Variable("byte", "largest resident memory of the process"),
    "output_value": Variable("1", "value of the output, in its unit"),
    "output_error": Variable("1", "relative difference to the reference"),
    "proportionality": Variable("1", "area fraction times rms gradient of the true contact over the load, κ"),
    "pressure_p90": Variable(_SCALED, "90th percentile of the peaks of the contact pressure"),
    "pressure_p99": Variable(_SCALED, "99th percentile of the peaks of the contact pressure"),
    "von_mises_p90": Variable(_SCALED, "90th percentile of the peaks of the von Mises stress"),
    "von_mises_p99": Variable(_SCALED, "99th percentile of the peaks of the von Mises stress"),
    "pressure_distribution": Variable("1", "distribution of the peaks of the contact pressure"),
    "von_mises_distribution": Variable("1", "distribution of the peaks of the von Mises stress"),
    "decay_length_depth": Variable(_LENGTH, "depth over which the covariance of Eq. 22 falls to half"),
    "decay_length_plane": Variable(_LENGTH, "distance over which the covariance of Eq. 22 falls to half"),
}
