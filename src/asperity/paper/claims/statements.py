"""Statements of the paper about stress under rough contacts, each as a number and the region that it wants.

`CLAIMS` is the table. Where the paper says "independent", "overlap" or "negligible" without a number, the
edge of the region is a choice of section ``readings`` of the configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from asperity.config.defaults import default
from asperity.paper.claims.deterministic import (
    area_of_poisson,
    coarse_grid,
    edge_over_away,
    element_difference,
    hertz_radius,
    punch_of_poisson,
    slab_compliance_of_poisson,
    slab_load_at_area,
    slab_load_at_depth,
    stiffness_of_poisson,
)
from asperity.paper.claims.evidence import Measure
from asperity.paper.claims.readings import (
    Reading,
    decay,
    deviation,
    following,
    highest_depth,
    kolmogorov,
    kolmogorov_of_poisson,
    percentile,
    quotient,
    ratio,
    ratio_of_poisson,
    single,
    skewness_of_opposite_sign,
)
from asperity.paper.claims.verdicts import Claim, Region, Threshold


def _threshold(choice: str, region: Callable[[float], Region]) -> Threshold:
    """Region whose edge is a choice of the readings; the study's own option is the first of its default."""
    return Threshold(choice, default(f"readings.{choice}")[0], region)


LARGER, SMALLER = Region(1.0, np.inf), Region(0.0, 1.0)
SAME = _threshold("alike", lambda share: Region(1 - share, 1 + share))
ALL_ALIKE = _threshold("overlap", lambda distance: Region(0.0, distance))
DIFFERENT = _threshold("overlap", lambda distance: Region(distance, 1.0))
CLEARLY_LARGER = _threshold("change", lambda share: Region(1 + share, np.inf))
CLEARLY_SMALLER = _threshold("change", lambda share: Region(0.0, 1 - share))
ONE_AND_A_HALF = _threshold("about", lambda share: Region(round(1.5 - share, 9), 1.5 + share))
CONTROLLED = _threshold("controls", lambda correlation: Region(correlation, 1.0))
SMALL = _threshold("small", lambda share: Region(0.0, share))
PERCENT = _threshold("percent", lambda share: Region(0.0, share))

SINGULAR = (
    "the difference is that of the mesh at the edge of contact, where the pressure ends with infinite slope: "
    "ours has not converged there, and the paper's mesh is another"
)
"""Why a difference of ours to finite elements cannot refute that of the paper."""

NORMAL_FIELDS = ("displacement_z", "stress_zz")
LATERAL_FIELDS = ("stress_xx", "stress_xz")

_PEAK = "99th percentile of the von Mises peaks over E*ḡ"
_HIGH = "mean depth of the highest tenth of the von Mises peaks"

CLAIMS: tuple[Claim, ...] = (
    Claim(
        "hertz_area",
        "4.1",
        "The solver's load and area follow Hertz, periodic images added",
        "largest relative difference of the contact radius at given load, radii of ten nodes and more",
        PERCENT,
        hertz_radius,
    ),
    Claim(
        "stiffness_of_poisson",
        "4.1",
        "At one Young's modulus the contact is stiffer the larger ν",
        "load per area at the largest ν over that at the smallest",
        LARGER,
        stiffness_of_poisson,
    ),
    Claim(
        "slab_stiffer_at_depth",
        "4.1",
        "A bonded slab is stiffer than the infinite solid",
        "load of the slab over that of the half-space at the same approach, the smallest over heights",
        LARGER,
        slab_load_at_depth,
    ),
    Claim(
        "slab_stiffer_at_area",
        "4.1",
        "The load-area curve of a slab shows it to be stiffer",
        "load of the cubic slab over that of the half-space at the same, largest, area",
        CLEARLY_LARGER,
        slab_load_at_area,
    ),
    Claim(
        "elements_normal",
        "4.2",
        "Normal displacement and stress differ from finite elements by at most 1 %",
        "largest difference of u_z and σ_zz in the diagonal plane, over the field's largest magnitude",
        PERCENT,
        element_difference(NORMAL_FIELDS, ("away", "edge")),
        untestable=SINGULAR,
    ),
    Claim(
        "elements_lateral",
        "4.2",
        "Lateral and shear stress differ from finite elements by less than 1 %",
        "largest difference of σ_xx and σ_xz in the diagonal plane, over the field's largest magnitude",
        PERCENT,
        element_difference(LATERAL_FIELDS, ("away", "edge")),
        untestable=SINGULAR,
    ),
    Claim(
        "elements_away",
        "4.2",
        "Away from the edge of contact the difference is below 1 %",
        "largest such difference of all four fields, farther than 0.05 L from the edge of contact",
        PERCENT,
        element_difference((*NORMAL_FIELDS, *LATERAL_FIELDS), ("away",)),
    ),
    Claim(
        "elements_at_edge",
        "4.2",
        "The differences sit near the edge of contact",
        "largest difference within 0.05 L of the edge over the largest farther away",
        LARGER,
        edge_over_away,
    ),
    Claim(
        "coarse_grid",
        "4.2",
        "A grid of 32 × 32 suffices",
        "relative error of the load at given approach, 32² against a far finer grid",
        PERCENT,
        coarse_grid,
    ),
    Claim(
        "finer_contacts",
        "5.2",
        "A smaller H gives finer contacts",
        "area-weighted mean radius of the patches of contact, small H over large H",
        SMALLER,
        ratio(Reading("seed_patch_radius"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "dispersed_contacts",
        "5.2",
        "A smaller H gives more dispersed contacts",
        "number of patches of contact, small H over large H",
        LARGER,
        ratio(Reading("seed_patches"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "linear_small_hurst",
        "5.2",
        "Area is proportional to P₀/E*ḡ, small H",
        "slope of ln a against ln P₀/E*ḡ from 1 % area to that of the study",
        SAME,
        single(Reading("seed_load_exponent"), "small_hurst"),
    ),
    Claim(
        "linear_large_hurst",
        "5.2",
        "Area is proportional to P₀/E*ḡ, large H",
        "slope of ln a against ln P₀/E*ḡ from 1 % area to that of the study",
        SAME,
        single(Reading("seed_load_exponent"), "large_hurst"),
    ),
    Claim(
        "same_area_load",
        "abstract, 5.2",
        "The load-area curves of both H lie on each other",
        "a E*ḡ/P₀ at the area of the study, small H over large H",
        SAME,
        ratio(Reading("seed_proportionality"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "same_traction_peaks",
        "5.2, 6",
        "The distributions of the traction peaks of both H overlap",
        "Kolmogorov distance of the peaks of pressure over E*ḡ",
        ALL_ALIKE,
        kolmogorov("pressure", "small_hurst", "large_hurst"),
    ),
    Claim(
        "same_traction_tail",
        "5.2, 6",
        "The highest traction peaks scale with ḡ too",
        "99th percentile of the peaks of pressure over E*ḡ, small H over large H",
        SAME,
        ratio(percentile("pressure"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "von_mises_of_hurst",
        "abstract, 5.2",
        "The distribution of the von Mises peaks depends on H",
        "Kolmogorov distance of the von Mises peaks over E*ḡ",
        DIFFERENT,
        kolmogorov("von_mises", "small_hurst", "large_hurst"),
    ),
    Claim(
        "high_von_mises_small_hurst",
        "5.2",
        "A smaller H has the larger probability of high von Mises peaks",
        f"{_PEAK}, small H over large H",
        LARGER,
        ratio(percentile("von_mises"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "largest_von_mises_small_hurst",
        "5.2",
        "A smaller H reaches locally larger von Mises stress",
        "largest von Mises stress in the solid over E*ḡ, small H over large H",
        LARGER,
        ratio(Reading("seed_largest_von_mises"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "lateral_of_hurst",
        "5.2",
        "The distribution of the peaks of σ_xx does not depend on H",
        "Kolmogorov distance of the peaks of |σ_xx| over E*ḡ",
        ALL_ALIKE,
        kolmogorov("xx", "small_hurst", "large_hurst"),
    ),
    Claim(
        "shear_of_hurst",
        "5.2",
        "A smaller H has the larger peaks of shear stress",
        "99th percentile of the peaks of |σ_xz| over E*ḡ, small H over large H",
        LARGER,
        ratio(percentile("xz"), "small_hurst", "large_hurst"),
    ),
    Claim(
        "broader_large_hurst",
        "5.2",
        "A larger H has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, large H over small H",
        LARGER,
        ratio(deviation("von_mises"), "large_hurst", "small_hurst"),
    ),
    Claim(
        "deeper_large_hurst",
        "5.2",
        "A larger H has its high peaks deeper",
        f"{_HIGH}, large H over small H",
        LARGER,
        ratio(highest_depth("von_mises"), "large_hurst", "small_hurst"),
    ),
    Claim(
        "depth_of_patches",
        "5.2",
        "The size of a patch of contact controls the depth of the peaks under it",
        "rank correlation of the peaks' depth with the radius of the patch above, large H",
        CONTROLLED,
        single(following(Reading("seed_depth_patch_correlation"), "patches"), "large_hurst"),
    ),
    Claim(
        "slower_along_depth",
        "5.2, 6",
        "A larger H has the slower decay along depth",
        "depth below the reference plane at which Eq. 22 falls to half, large H over small H",
        LARGER,
        ratio(decay("depth"), "large_hurst", "small_hurst"),
    ),
    Claim(
        "slower_in_plane",
        "5.2, 6",
        "A larger H has the slower decay in the plane",
        "distance in the reference plane at which Eq. 22 falls to half, large H over small H",
        LARGER,
        ratio(decay("plane"), "large_hurst", "small_hurst"),
    ),
    Claim(
        "tractions_of_poisson",
        "abstract, 5.3",
        "Area and load are not affected by compressibility",
        "largest relative change of the area with ν at given P₀/E*, paraboloid on a half-space",
        PERCENT,
        area_of_poisson,
    ),
    Claim(
        "slab_tractions_of_poisson",
        "5.3",
        "On the slab of finite height compressibility does not affect them either",
        "largest relative change with ν of E* × surface compliance, bonded cubic slab, λ ≤ L",
        PERCENT,
        slab_compliance_of_poisson,
    ),
    Claim(
        "punch_of_poisson",
        "5.3",
        "Under a Hertzian punch the von Mises stress is larger the smaller ν",
        "largest von Mises stress at the smallest ν over that at the largest",
        LARGER,
        punch_of_poisson,
    ),
    Claim(
        "one_and_a_half",
        "5.3, 6",
        "The peaks of a fully compressible body are about 1.5 times those of an incompressible one",
        f"{_PEAK}, smallest ν over largest",
        ONE_AND_A_HALF,
        ratio_of_poisson(percentile("von_mises")),
    ),
    Claim(
        "one_and_a_half_largest",
        "5.3, 6",
        "The largest stress of all is about 1.5 times that of an incompressible body",
        "largest von Mises stress in the solid, smallest ν over largest",
        ONE_AND_A_HALF,
        ratio_of_poisson(Reading("seed_largest_von_mises")),
    ),
    Claim(
        "broader_compressible",
        "5.3",
        "A smaller ν has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, smallest ν over largest",
        LARGER,
        ratio_of_poisson(deviation("von_mises")),
    ),
    Claim(
        "shallower_compressible",
        "5.3",
        "A smaller ν has its high peaks nearer to the surface",
        f"{_HIGH}, smallest ν over largest",
        SMALLER,
        ratio_of_poisson(highest_depth("von_mises")),
    ),
    Claim(
        "lateral_compressible",
        "6",
        "The larger the compressibility the smaller the stress normal to the load",
        "99th percentile of the peaks of |σ_xx| over E*ḡ, smallest ν over largest",
        SMALLER,
        ratio_of_poisson(percentile("xx")),
    ),
    Claim(
        "shear_of_poisson",
        "5.3",
        "The shear stress does not scale with ḡ alone when ν changes",
        "Kolmogorov distance of the peaks of |σ_xz| over E*ḡ, smallest against largest ν",
        DIFFERENT,
        kolmogorov_of_poisson("xz", "shear"),
    ),
    Claim(
        "decay_depth_of_poisson",
        "5.3, 6",
        "Compressibility does not affect the decay along depth",
        "depth below the reference plane at which Eq. 22 falls to half, smallest ν over largest",
        SAME,
        ratio_of_poisson(decay("depth")),
    ),
    Claim(
        "decay_plane_of_poisson",
        "5.3, 6",
        "Compressibility does not affect the decay in the plane",
        "distance in the reference plane at which Eq. 22 falls to half, smallest ν over largest",
        SAME,
        ratio_of_poisson(decay("plane")),
    ),
    Claim(
        "small_shear",
        "6",
        "The shear stress is rather small beside the normal stress",
        "99th percentile of the peaks of |σ_xz| over that of the pressure, large H",
        SMALL,
        quotient(following(percentile("xz"), "shear"), percentile("pressure"), "large_hurst"),
    ),
    Claim(
        "skewness_sign",
        "5.4",
        "γ > 0 makes a positive skewness, γ < 0 a negative one",
        "skewness for γ > 0 over minus that for γ < 0",
        Region(0.0, np.inf),
        skewness_of_opposite_sign(),
    ),
    Claim(
        "skewness_alone",
        "5.4",
        "Skewness is changed independently of kurtosis",
        "kurtosis of the positively skewed surface over that of the Gaussian one",
        SAME,
        ratio(Reading("seed_kurtosis"), "skew_positive", "gaussian"),
    ),
    Claim(
        "skew_gradient",
        "5.4",
        "A positive skewness has the significantly lower rms gradient",
        "rms gradient over the true contact, positive over negative skewness",
        CLEARLY_SMALLER,
        ratio(Reading("seed_gradient_rms_contact"), "skew_positive", "skew_negative"),
    ),
    Claim(
        "skew_normalised",
        "5.4",
        "Over ḡ, a positive skewness has the larger von Mises peaks",
        f"{_PEAK}, positive over negative skewness",
        LARGER,
        ratio(percentile("von_mises"), "skew_positive", "skew_negative"),
    ),
    Claim(
        "skew_not_normalised",
        "5.4, 6",
        "Not divided by ḡ, a positive skewness has the smaller von Mises peaks",
        "99th percentile of the von Mises peaks over E*, positive over negative skewness",
        SMALLER,
        ratio(percentile("von_mises", unscaled=True), "skew_positive", "skew_negative"),
    ),
    Claim(
        "skew_not_normalised_gaussian",
        "5.4",
        "Not divided by ḡ, a positive skewness has smaller peaks than the Gaussian surface",
        "99th percentile of the von Mises peaks over E*, positive skewness over Gaussian",
        SMALLER,
        ratio(percentile("von_mises", unscaled=True), "skew_positive", "gaussian"),
    ),
    Claim(
        "cutoff_is_kurtosis",
        "5.4",
        "A smaller λ_s increases the kurtosis of the heights",
        "kurtosis at the smallest λ_s over that at the largest",
        CLEARLY_LARGER,
        ratio(Reading("seed_kurtosis"), "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_larger",
        "5.4, 6",
        "A smaller λ_s has the larger von Mises peaks, largest λ_s to smallest",
        f"{_PEAK}, smallest λ_s over largest",
        LARGER,
        ratio(following(percentile("von_mises"), "scaling"), "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_larger_middle",
        "5.4, 6",
        "A smaller λ_s has the larger von Mises peaks, middle λ_s to smallest",
        f"{_PEAK}, smallest λ_s over middle",
        LARGER,
        ratio(following(percentile("von_mises"), "scaling"), "short_cutoff", "middle_cutoff"),
    ),
    Claim(
        "cutoff_broader",
        "5.4, 6",
        "A smaller λ_s has the broader distribution of von Mises peaks",
        "standard deviation of the von Mises peaks over E*ḡ, smallest λ_s over largest",
        LARGER,
        ratio(following(deviation("von_mises"), "scaling"), "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "cutoff_shallower",
        "5.4, 6",
        "A smaller λ_s has its high peaks nearer to the surface",
        f"{_HIGH}, smallest λ_s over largest",
        SMALLER,
        ratio(highest_depth("von_mises"), "short_cutoff", "long_cutoff"),
    ),
    Claim(
        "kurtosis_larger",
        "6, supplement",
        "A larger kurtosis, truly changed at one λ_s, has the larger von Mises peaks",
        f"{_PEAK}, high over low kurtosis",
        LARGER,
        ratio(following(percentile("von_mises"), "scaling"), "kurtosis_high", "kurtosis_low"),
    ),
    Claim(
        "kurtosis_shallower",
        "6, supplement",
        "A larger kurtosis, truly changed at one λ_s, has its high peaks nearer to the surface",
        f"{_HIGH}, high over low kurtosis",
        SMALLER,
        ratio(highest_depth("von_mises"), "kurtosis_high", "kurtosis_low"),
    ),
)

HEADLINES: Mapping[str, Measure] = {
    f"{text}, {size} H": single(reading, f"{size}_hurst")
    for text, reading in {
        "a E*ḡ/P₀": Reading("seed_proportionality"),
        _PEAK: percentile("von_mises"),
        "largest von Mises stress over E*ḡ": Reading("seed_largest_von_mises"),
        f"{_HIGH}, over L": highest_depth("von_mises"),
        "rms gradient over the true contact": Reading("seed_gradient_rms_contact"),
    }.items()
    for size in ("small", "large")
} | {f"{_PEAK}, smallest ν over largest": ratio_of_poisson(percentile("von_mises"))}
"""Numbers that the continuum study extrapolates besides those of the claims, by name."""
