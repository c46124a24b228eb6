"""What the paper says of stress under rough contact, sentence by sentence, each as a number and its region.

`CLAIMS` is the list; what stands before it takes a number from the evidence. Where the paper says
"independent", "overlap" or "negligible" without a number, `ALIKE` is ours.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asperity.elasticity.layer import Layer
from asperity.paper.claims.verdicts import Claim, Evidence, Fixed, Measure, MissingEvidenceError, Region
from asperity.pipeline.summary import LEVELS, Summary
from asperity.types import Array
from asperity.validation.finite_elements import largest_differences

ALIKE = 0.05
"""Ratios within this of one, and distributions within this Kolmogorov distance, count as the same."""

DATASETS = ("load_area", "slab_load_area", "grid_convergence", "elements", "mesh_convergence", "punch")
"""Datasets of `asperity.validation.comparisons` that claims are decided on."""

RESOLVED = 10
"""A circle of contact counts as resolved from this radius on, in grid spacings."""

LARGER, SMALLER = Region(1.0, np.inf), Region(0.0, 1.0)
SAME, ALL_ALIKE = Region(1 - ALIKE, 1 + ALIKE), Region(0.0, ALIKE)
PERCENT = Region(0.0, 0.01)


def number(summary: Summary, name: str) -> float:
    """A number of a summary; ``@contact``, ``@low`` and ``@high`` stand for Poisson's ratios of the study."""
    return summary[_named(summary, name)]


def _named(summary: Summary, name: str) -> str:
    short, _, which = name.partition("@")
    if not which:
        return name
    ratios = summary.settings["stress"]["poisson"]
    chosen = {"contact": summary.settings["layer"]["poisson"], "low": min(ratios), "high": max(ratios)}[which]
    return f"{short}@{chosen:g}"


def ratio(name: str, over: str, under: str, scaled: bool = True) -> Measure:
    """The number of one role over that of another; not `scaled`: of stresses in units of E*."""

    def measure(evidence: Evidence) -> Array:
        return evidence.each_seed(one_over_other, over, under)

    def one_over_other(one: Summary, other: Summary) -> float:
        value = number(one, name) / number(other, name)
        if not scaled:
            value *= one["contact.gradient_rms_contact"] / other["contact.gradient_rms_contact"]
        return value

    return measure


def of_poisson(name: str, over: str = "low", under: str = "high") -> Measure:
    """The number at one Poisson's ratio over that at another, on the surface of the compressibility study."""

    def measure(evidence: Evidence) -> Array:
        return evidence.each_seed(
            lambda s: number(s, f"{name}@{over}") / number(s, f"{name}@{under}"), "compressibility"
        )

    return measure


def single(name: str, role: str) -> Measure:
    """A number of one surface."""
    return lambda evidence: evidence.each_seed(lambda summary: number(summary, name), role)


def quotient(above: str, below: str, role: str) -> Measure:
    """One number of a surface over another."""
    return lambda evidence: evidence.each_seed(lambda s: number(s, above) / number(s, below), role)


def kolmogorov(name: str, one: str, other: str) -> Measure:
    """Largest difference of the shares of peaks below a value, between the surfaces of two roles."""
    return lambda evidence: evidence.each_seed(lambda a, b: _distance(a, name, b, name), one, other)


def kolmogorov_of_poisson(quantity: str) -> Measure:
    """The same between two Poisson's ratios."""
    low, high = f"{quantity}@low", f"{quantity}@high"
    return lambda evidence: evidence.each_seed(lambda s: _distance(s, low, s, high), "compressibility")


def _distance(one: Summary, name: str, other: Summary, other_name: str) -> float:
    curves = [one.quantiles[_named(one, name)], other.quantiles[_named(other, other_name)]]
    values = np.sort(np.concatenate(curves))
    shares = [np.interp(values, curve, LEVELS, left=0.0, right=1.0) for curve in curves]
    return float(np.abs(shares[0] - shares[1]).max())


def _elements(fields: Sequence[str], where: Sequence[str]) -> Measure:
    """Largest difference to the finite elements; uncertain by the change over the last two meshes."""

    def measure(evidence: Evidence) -> Fixed:
        found = [largest_differences(evidence.dataset("elements"))]
        meshes = evidence.dataset("mesh_convergence")
        found += [meshes.isel(mesh=-1), meshes.isel(mesh=-2)]
        value, fine, coarse = (
            max(float(one[f"difference_{part}"].sel(field=name)) for name in fields for part in where)
            for one in found
        )
        return Fixed(value, abs(fine - coarse))

    return measure


def _edge_over_away(evidence: Evidence) -> Fixed:
    found = largest_differences(evidence.dataset("elements"))
    return Fixed(float(found.difference_edge.max() / found.difference_away.max()))


def _hertz(evidence: Evidence) -> Fixed:
    found = evidence.dataset("load_area")
    resolved = found.hertz_contact_radius * found.attrs["grid_points"] >= RESOLVED
    error = np.abs(found.solved_contact_radius / found.hertz_contact_radius - 1)
    return Fixed(float(error.where(resolved).max()))


def _stiffness(evidence: Evidence) -> Fixed:
    """Load over area at the largest Poisson's ratio over that at the smallest, the smallest of all loads."""
    found = evidence.dataset("load_area").sortby("poisson")
    slope = found.imposed_mean_pressure_young / found.solved_area_fraction
    return Fixed(float((slope[-1] / slope[0]).min()))


def _slab_stiffening(evidence: Evidence) -> Fixed:
    return Fixed(float(evidence.dataset("slab_load_area").slab_stiffening.min()))


def _slab_load(evidence: Evidence) -> Fixed:
    """Load of the cubic slab over that of the half-space at the same, largest, area of contact.

    The load goes with the cube of the radius, whose error is that seen on the half-space.
    """
    found = evidence.dataset("slab_load_area")
    cubic = found.isel(slab=int(np.abs(found.slab_height.values - 1).argmin()), step=-1)
    area = np.pi * float(cubic.slab_contact_radius) ** 2
    half_space = float(np.interp(area, found.curve_area_fraction, found.curve_mean_pressure))
    value = float(cubic.slab_mean_pressure) / half_space
    return Fixed(value, 3 * value * _hertz(evidence).value)


def _coarse_grid(evidence: Evidence) -> Fixed:
    found = evidence.dataset("grid_convergence")
    if 32 not in found.grid_points:
        raise MissingEvidenceError("no grid of 32 × 32")
    return Fixed(float(found.slab_load_error.sel(grid_points=32)))


def _area_of_poisson(evidence: Evidence) -> Fixed:
    area = evidence.dataset("load_area").solved_area_fraction
    return Fixed(float((area.max("poisson") / area.min("poisson") - 1).max()))


def _punch(evidence: Evidence) -> Fixed:
    found = evidence.dataset("punch").sortby("poisson")
    peak, exact = found.peak_von_mises_array.values, found.peak_von_mises_closed_form.values
    return Fixed(float(peak[0] / peak[-1]), float(abs(peak[0] / peak[-1] - exact[0] / exact[-1])))


def _slab_compliance(evidence: Evidence) -> Fixed:
    """Change of E* × compliance of a bonded cubic slab with ν, over all waves that fit in the cell."""
    q = 2 * np.pi * np.sqrt(np.arange(1.0, 4096.0))
    ratios = (0.0, 0.25, 0.33, 0.5)
    layers = [Layer(1 - nu**2, nu, height=1.0, bottom="bonded") for nu in ratios]
    compliance = np.array([layer.surface_compliance(q) for layer in layers])
    return Fixed(float((compliance.max(axis=0) / compliance.min(axis=0) - 1).max()))


BODY_FIELDS = ("displacement_z", "stress_zz")
OTHER_FIELDS = ("stress_xx", "stress_xz")

_PEAK = "99th percentile of the von Mises peaks over E*ḡ"
_HIGH = "mean depth of the highest tenth of the von Mises peaks"

CLAIMS: tuple[Claim, ...] = (
    Claim(
        "hertz_area",
        "4.1",
        "The solver's load and area follow Hertz, periodic images added",
        "largest relative difference of the contact radius at given load, radii of ten nodes and more",
        PERCENT,
        _hertz,
    ),
    Claim(
        "stiffness_of_poisson",
        "4.1",
        "At one Young's modulus the contact is stiffer the larger ν",
        "load per area at the largest ν over that at the smallest",
        LARGER,
        _stiffness,
    ),
    Claim(
        "slab_stiffer_at_depth",
        "4.1",
        "A bonded slab is stiffer than the infinite solid",
        "load of the slab over that of the half-space at the same approach, the smallest over heights",
        LARGER,
        _slab_stiffening,
    ),
    Claim(
        "slab_stiffer_at_area",
        "4.1",
        "The load-area curve of a slab shows it to be stiffer",
        "load of the cubic slab over that of the half-space at the same, largest, area",
        Region(1 + ALIKE, np.inf),
        _slab_load,
    ),
    Claim(
        "elements_normal",
        "4.2",
        "Normal displacement and stress differ from finite elements by at most 1 %",
        "largest difference of u_z and σ_zz in the diagonal plane, over the field's largest magnitude",
        PERCENT,
        _elements(BODY_FIELDS, ("away", "edge")),
    ),
    Claim(
        "elements_lateral",
        "4.2",
        "Lateral and shear stress differ from finite elements by less than 1 %",
        "largest difference of σ_xx and σ_xz in the diagonal plane, over the field's largest magnitude",
        PERCENT,
        _elements(OTHER_FIELDS, ("away", "edge")),
    ),
    Claim(
        "elements_away",
        "4.2",
        "Away from the edge of contact the difference is below 1 %",
        "largest such difference of all four fields, farther than 0.05 L from the edge of contact",
        PERCENT,
        _elements((*BODY_FIELDS, *OTHER_FIELDS), ("away",)),
    ),
    Claim(
        "elements_at_edge",
        "4.2",
        "The differences sit near the edge of contact",
        "largest difference within 0.05 L of the edge over the largest farther away",
        LARGER,
        _edge_over_away,
    ),
    Claim(
        "coarse_grid",
        "4.2",
        "A grid of 32 × 32 suffices",
        "relative error of the load at given approach, 32² against a far finer grid",
        PERCENT,
        _coarse_grid,
    ),
    Claim(
        "finer_contacts",
        "5.2",
        "A smaller H gives finer contacts",
        "area-weighted mean radius of the patches of contact, small H over large H",
        SMALLER,
        ratio("contact.patch_radius", "small_hurst", "large_hurst"),
    ),
    Claim(
        "dispersed_contacts",
        "5.2",
        "A smaller H gives more dispersed contacts",
        "number of patches of contact, small H over large H",
        LARGER,
        ratio("contact.patches", "small_hurst", "large_hurst"),
    ),
    Claim(
        "linear_small_hurst",
        "5.2",
        "Area is proportional to P₀/E*ḡ, small H",
        "slope of ln a against ln P₀/E*ḡ from 1 % area to that of the study",
        SAME,
        single("contact.load_exponent", "small_hurst"),
    ),
    Claim(
        "linear_large_hurst",
        "5.2",
        "Area is proportional to P₀/E*ḡ, large H",
        "slope of ln a against ln P₀/E*ḡ from 1 % area to that of the study",
        SAME,
        single("contact.load_exponent", "large_hurst"),
    ),
    Claim(
        "same_area_load",
        "abstract, 5.2",
        "The load-area curves of both H lie on each other",
        "a E*ḡ/P₀ at the area of the study, small H over large H",
        SAME,
        ratio("contact.proportionality", "small_hurst", "large_hurst"),
    ),
    Claim(
        "same_traction_peaks",
        "5.2, 6",
        "The distributions of the traction peaks of both H overlap",
        "Kolmogorov distance of the peaks of pressure over E*ḡ",
        ALL_ALIKE,
        kolmogorov("pressure@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "same_traction_tail",
        "5.2, 6",
        "The highest traction peaks scale with ḡ too",
        "99th percentile of the peaks of pressure over E*ḡ, small H over large H",
        SAME,
        ratio("pressure.p99@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "von_mises_of_hurst",
        "abstract, 5.2",
        "The distribution of the von Mises peaks depends on H",
        "Kolmogorov distance of the von Mises peaks over E*ḡ",
        Region(ALIKE, 1.0),
        kolmogorov("von_mises@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "high_von_mises_small_hurst",
        "5.2",
        "A smaller H has the larger probability of high von Mises peaks",
        f"{_PEAK}, small H over large H",
        LARGER,
        ratio("von_mises.p99@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "largest_von_mises_small_hurst",
        "5.2",
        "A smaller H reaches locally larger von Mises stress",
        "largest von Mises stress in the solid over E*ḡ, small H over large H",
        LARGER,
        ratio("profile.largest@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "lateral_of_hurst",
        "5.2",
        "The distribution of the peaks of σ_xx does not depend on H",
        "Kolmogorov distance of the peaks of |σ_xx| over E*ḡ",
        ALL_ALIKE,
        kolmogorov("xx@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "shear_of_hurst",
        "5.2",
        "A smaller H has the larger peaks of shear stress",
        "99th percentile of the peaks of |σ_xz| over E*ḡ, small H over large H",
        LARGER,
        ratio("xz.p99@contact", "small_hurst", "large_hurst"),
    ),
    Claim(
        "broader_large_hurst",
        "5.2",
        "A larger H has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, large H over small H",
        LARGER,
        ratio("von_mises.deviation@contact", "large_hurst", "small_hurst"),
    ),
    Claim(
        "deeper_large_hurst",
        "5.2",
        "A larger H has its high peaks deeper",
        f"{_HIGH}, large H over small H",
        LARGER,
        ratio("von_mises.depth_high@contact", "large_hurst", "small_hurst"),
    ),
    Claim(
        "depth_of_patches",
        "5.2",
        "The size of a patch of contact controls the depth of the peaks under it",
        "rank correlation of the peaks' depth with the radius of the patch above, large H",
        Region(0.5, 1.0),
        single("von_mises.depth_patch_correlation@contact", "large_hurst"),
    ),
    Claim(
        "slower_along_depth",
        "5.2, 6",
        "A larger H has the slower decay along depth",
        "depth below the reference plane at which Eq. 22 falls to half, large H over small H",
        LARGER,
        ratio("decay.depth@contact", "large_hurst", "small_hurst"),
    ),
    Claim(
        "slower_in_plane",
        "5.2, 6",
        "A larger H has the slower decay in the plane",
        "distance in the reference plane at which Eq. 22 falls to half, large H over small H",
        LARGER,
        ratio("decay.plane@contact", "large_hurst", "small_hurst"),
    ),
    Claim(
        "tractions_of_poisson",
        "abstract, 5.3",
        "Area and load are not affected by compressibility",
        "largest relative change of the area with ν at given P₀/E*, paraboloid on a half-space",
        PERCENT,
        _area_of_poisson,
    ),
    Claim(
        "slab_tractions_of_poisson",
        "5.3",
        "On the slab of finite height compressibility does not affect them either",
        "largest relative change with ν of E* × surface compliance, bonded cubic slab, λ ≤ L",
        PERCENT,
        _slab_compliance,
    ),
    Claim(
        "punch_of_poisson",
        "5.3",
        "Under a Hertzian punch the von Mises stress is larger the smaller ν",
        "largest von Mises stress at the smallest ν over that at the largest",
        LARGER,
        _punch,
    ),
    Claim(
        "one_and_a_half",
        "5.3, 6",
        "The peaks of a fully compressible body are about 1.5 times those of an incompressible one",
        f"{_PEAK}, smallest ν over largest",
        Region(1.4, 1.6),
        of_poisson("von_mises.p99"),
    ),
    Claim(
        "one_and_a_half_largest",
        "5.3, 6",
        "The largest stress of all is about 1.5 times that of an incompressible stress",
        "largest von Mises stress in the solid, smallest ν over largest",
        Region(1.4, 1.6),
        of_poisson("profile.largest"),
    ),
    Claim(
        "broader_compressible",
        "5.3",
        "A smaller ν has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, smallest ν over largest",
        LARGER,
        of_poisson("von_mises.deviation"),
    ),
    Claim(
        "shallower_compressible",
        "5.3",
        "A smaller ν has its high peaks nearer to the surface",
        f"{_HIGH}, smallest ν over largest",
        SMALLER,
        of_poisson("von_mises.depth_high"),
    ),
    Claim(
        "lateral_compressible",
        "6",
        "The larger the compressibility the smaller the stress normal to the load",
        "99th percentile of the peaks of |σ_xx| over E*ḡ, smallest ν over largest",
        SMALLER,
        of_poisson("xx.p99"),
    ),
    Claim(
        "shear_of_poisson",
        "5.3",
        "The shear stress does not scale with ḡ alone when ν changes",
        "Kolmogorov distance of the peaks of |σ_xz| over E*ḡ, smallest against largest ν",
        Region(ALIKE, 1.0),
        kolmogorov_of_poisson("xz"),
    ),
    Claim(
        "decay_depth_of_poisson",
        "5.3, 6",
        "Compressibility does not affect the decay along depth",
        "depth below the reference plane at which Eq. 22 falls to half, smallest ν over largest",
        SAME,
        of_poisson("decay.depth"),
    ),
    Claim(
        "decay_plane_of_poisson",
        "5.3, 6",
        "Compressibility does not affect the decay in the plane",
        "distance in the reference plane at which Eq. 22 falls to half, smallest ν over largest",
        SAME,
        of_poisson("decay.plane"),
    ),
    Claim(
        "small_shear",
        "6",
        "The shear stress is rather small beside the normal stress",
        "99th percentile of the peaks of |σ_xz| over that of the pressure, large H",
        Region(0.0, 0.5),
        quotient("xz.p99@contact", "pressure.p99@contact", "large_hurst"),
    ),
    Claim(
        "skewness_sign",
        "5.4",
        "γ > 0 makes a positive skewness, γ < 0 a negative one",
        "skewness for γ > 0 over minus that for γ < 0",
        Region(0.0, np.inf),
        lambda evidence: (
            -evidence.each_seed(
                lambda a, b: a["surface.skewness"] / b["surface.skewness"], "skew_positive", "skew_negative"
            )
        ),
    ),
    Claim(
        "skewness_alone",
        "5.4",
        "Skewness is changed independently of kurtosis",
        "kurtosis of the positively skewed surface over that of the Gaussian one",
        SAME,
        ratio("surface.kurtosis", "skew_positive", "gaussian"),
    ),
    Claim(
        "skew_gradient",
        "5.4",
        "A positive skewness has the significantly lower rms gradient",
        "rms gradient over the true contact, positive over negative skewness",
        Region(0.0, 1 - ALIKE),
        ratio("contact.gradient_rms_contact", "skew_positive", "skew_negative"),
    ),
    Claim(
        "skew_normalised",
        "5.4",
        "Over ḡ, a positive skewness has the larger von Mises peaks",
        f"{_PEAK}, positive over negative skewness",
        LARGER,
        ratio("von_mises.p99@contact", "skew_positive", "skew_negative"),
    ),
    Claim(
        "skew_not_normalised",
        "5.4, 6",
        "Not divided by ḡ, a positive skewness has the smaller von Mises peaks",
        "99th percentile of the von Mises peaks over E*, positive over negative skewness",
        SMALLER,
        ratio("von_mises.p99@contact", "skew_positive", "skew_negative", scaled=False),
    ),
    Claim(
        "skew_not_normalised_gaussian",
        "5.4",
        "Not divided by ḡ, a positive skewness has smaller peaks than the Gaussian surface",
        "99th percentile of the von Mises peaks over E*, positive skewness over Gaussian",
        SMALLER,
        ratio("von_mises.p99@contact", "skew_positive", "gaussian", scaled=False),
    ),
    Claim(
        "cutoff_is_kurtosis",
        "5.4",
        "A smaller λ_s increases the kurtosis of the heights",
        "kurtosis at the smallest λ_s over that at the largest",
        Region(1 + ALIKE, np.inf),
        ratio("surface.kurtosis", "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_larger",
        "5.4, 6",
        "A smaller λ_s has the larger von Mises peaks, largest λ_s to smallest",
        f"{_PEAK}, smallest λ_s over largest",
        LARGER,
        ratio("von_mises.p99@contact", "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_larger_middle",
        "5.4, 6",
        "A smaller λ_s has the larger von Mises peaks, middle λ_s to smallest",
        f"{_PEAK}, smallest λ_s over middle",
        LARGER,
        ratio("von_mises.p99@contact", "short_cutoff", "middle_cutoff"),
    ),
    Claim(
        "cutoff_larger_not_normalised",
        "6",
        "Not divided by ḡ, a smaller λ_s has the larger von Mises peaks too",
        "99th percentile of the von Mises peaks over E*, smallest λ_s over largest",
        LARGER,
        ratio("von_mises.p99@contact", "short_cutoff", "long_cutoff", scaled=False),
    ),
    Claim(
        "cutoff_broader",
        "5.4, 6",
        "A smaller λ_s has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, smallest λ_s over largest",
        LARGER,
        ratio("von_mises.deviation@contact", "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_shallower",
        "5.4, 6",
        "A smaller λ_s has its high peaks nearer to the surface",
        f"{_HIGH}, smallest λ_s over largest",
        SMALLER,
        ratio("von_mises.depth_high@contact", "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "kurtosis_larger",
        "6, supplement",
        "A larger kurtosis, truly changed at one λ_s, has the larger von Mises peaks",
        "99th percentile of the von Mises peaks over E*, high over low kurtosis",
        LARGER,
        ratio("von_mises.p99@contact", "kurtosis_high", "kurtosis_low", scaled=False),
    ),
    Claim(
        "kurtosis_shallower",
        "6, supplement",
        "A larger kurtosis, truly changed at one λ_s, has its high peaks nearer to the surface",
        f"{_HIGH}, high over low kurtosis",
        SMALLER,
        ratio("von_mises.depth_high@contact", "kurtosis_high", "kurtosis_low"),
    ),
)

HEADLINES: dict[str, Measure] = {
    f"{text}, {size} H": single(name, f"{size}_hurst")
    for text, name in {
        "a E*ḡ/P₀": "contact.proportionality",
        _PEAK: "von_mises.p99@contact",
        "largest von Mises stress over E*ḡ": "profile.largest@contact",
        f"{_HIGH}, over L": "von_mises.depth_high@contact",
        "rms gradient over the true contact": "contact.gradient_rms_contact",
    }.items()
    for size in ("small", "large")
} | {f"{_PEAK}, smallest ν over largest": of_poisson("von_mises.p99")}
"""Numbers that the continuum study extrapolates besides those of the claims."""
