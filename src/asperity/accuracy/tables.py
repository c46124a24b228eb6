"""Tables of the measured errors, and numbers as text."""

from __future__ import annotations

import math
from dataclasses import fields

from asperity.accuracy.measured import MeasuredTradeoff
from asperity.accuracy.outputs import OUTPUTS
from asperity.config.presets import PRESETS, AccuracySettings
from asperity.results.markup import Rows, markdown

PARAMETER_LABELS = {
    "points_per_wavelength": "`points` on `wavelength_short`",
    "contact_tolerance": "`contact.tolerance`",
    "precision": "`contact.precision`",
    "depth_tolerance": "`stress.tolerance`",
    "depth_spacing": "`stress.depth_spacing`",
    "half_space_tolerance": "`layer.half_space_tolerance`",
    "seeds": "number of `seeds`",
}
"""Parameter of accuracy → its key in a configuration."""


def describe_presets(measured: MeasuredTradeoff) -> str:
    """Markdown table of `preset_rows`."""
    return markdown(preset_rows(measured))


def preset_rows(measured: MeasuredTradeoff) -> Rows:
    """Table of the presets: their settings, processor time and measured errors."""
    names = [name for name in PRESETS if name in measured.presets]
    settings = [
        [PARAMETER_LABELS[field.name], *(_text(getattr(PRESETS[name], field.name)) for name in names)]
        for field in fields(AccuracySettings)
    ]
    times = [_text(measured.presets[name]["seconds"]) for name in names]
    errors = [
        [f"error of `{output}`", *(percent(measured.presets[name][output]) for name in names)]
        for output in OUTPUTS
    ]
    head = ["", *(f"`{name}`" for name in names)]
    return [head, *settings, ["processor time of one surface (s)", *times], *errors]


def error_rows(measured: MeasuredTradeoff) -> Rows:
    """Table of the largest error at every measured setting, one parameter at a time."""
    rows = [["area fraction", "parameter", "setting", *(f"`{name}`" for name in OUTPUTS)]]
    for area, by_parameter in measured.errors.items():
        for parameter, by_setting in by_parameter.items():
            for setting, errors in by_setting.items():
                rows.append([area, parameter, setting, *(percent(errors[name]) for name in OUTPUTS)])
        deviation = measured.deviation[area]
        rows.append([area, "seeds (deviation)", "1", *(percent(deviation[name]) for name in OUTPUTS)])
    return rows


def percent(value: float) -> str:
    """A relative error as a percentage with two digits; ``not measured`` if it is not finite."""
    if not math.isfinite(value):
        return "not measured"
    return "0" if value == 0 else f"{float(f'{100 * value:.2g}'):g} %"


def minutes(seconds: float) -> str:
    """A time as whole minutes, or as whole seconds below a minute and a half."""
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{math.ceil(seconds)} s"


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
