"""Names of the outputs whose errors are measured.

Every output belongs to one surface at one load and is taken from the statistics of one seed
(`asperity.pipeline.statistics.seed_statistics`).
"""

from __future__ import annotations

from typing import Any

NUMBERS: dict[str, tuple[str, dict[str, Any]]] = {
    "proportionality": ("seed_proportionality", {}),
    "gradient_rms_contact": ("seed_gradient_rms_contact", {}),
    "pressure_p90": ("seed_peak_quantile", {"quantity": "pressure", "level": 0.9}),
    "pressure_p99": ("seed_peak_quantile", {"quantity": "pressure", "level": 0.99}),
    "von_mises_p90": ("seed_peak_quantile", {"quantity": "von_mises", "level": 0.9}),
    "von_mises_p99": ("seed_peak_quantile", {"quantity": "von_mises", "level": 0.99}),
    "largest_von_mises": ("seed_largest_von_mises", {}),
    "peak_depth": ("seed_mean_depth", {"quantity": "von_mises"}),
    "decay_length_depth": ("seed_decay_length_depth", {}),
    "decay_length_plane": ("seed_decay_length_plane", {}),
}
"""Outputs that are single numbers → variable of the statistics, and the coordinates at which it is taken.
Their errors are relative differences."""

DISTRIBUTIONS = {"pressure_distribution": "pressure", "von_mises_distribution": "von_mises"}
"""Outputs that are distributions of peaks → their quantity. Their error is the mean distance between equal
quantiles, divided by the mean peak."""

OUTPUTS = ("area_fraction", *NUMBERS, *DISTRIBUTIONS)
"""All outputs. The area fraction is compared at the mean pressure of the reference."""
