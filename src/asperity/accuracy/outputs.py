"""Names of the outputs whose errors are measured.

Every output belongs to one surface at one load and is taken from its summary (`asperity.pipeline.summary`).
"""

from __future__ import annotations

NUMBERS = {
    "proportionality": "contact.proportionality",
    "gradient_rms_contact": "contact.gradient_rms_contact",
    "pressure_p90": "pressure.p90@{}",
    "pressure_p99": "pressure.p99@{}",
    "von_mises_p90": "von_mises.p90@{}",
    "von_mises_p99": "von_mises.p99@{}",
    "largest_von_mises": "profile.largest@{}",
    "peak_depth": "von_mises.depth@{}",
    "decay_length_depth": "decay.depth@{}",
    "decay_length_plane": "decay.plane@{}",
}
"""Outputs that are single numbers → their key in a summary, with a place for Poisson's ratio. Their errors
are relative differences."""

DISTRIBUTIONS = {"pressure_distribution": "pressure@{}", "von_mises_distribution": "von_mises@{}"}
"""Outputs that are distributions of peaks → the key of their quantiles. Their error is the mean distance
between equal quantiles, divided by the mean peak."""

OUTPUTS = ("area_fraction", *NUMBERS, *DISTRIBUTIONS)
"""All outputs. The area fraction is compared at the mean pressure of the reference."""
