"""Tables of the measured errors, and numbers as text.

`python -m asperity.study.cost.tables` prints the presets of accuracy with their measured times and errors.
"""

from __future__ import annotations

import math
from dataclasses import asdict

import pandas as pd

from asperity.core.markup import markdown
from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import OUTPUTS, MeasuredTradeoff, load

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


def presets_frame(measured: MeasuredTradeoff) -> pd.DataFrame:
    """The table ``presets`` of `asperity.results.tables.TABLES`: settings, processor time and errors."""
    names = [name for name in PRESETS if name in measured.presets]
    return pd.DataFrame(
        {
            "preset": name,
            **asdict(PRESETS[name]),
            "seconds": measured.presets[name]["seconds"],
            **{f"error_{output}": measured.presets[name][output] for output in OUTPUTS},
        }
        for name in names
    )


def errors_frame(measured: MeasuredTradeoff) -> pd.DataFrame:
    """The table ``tradeoff`` of `asperity.results.tables.TABLES`: one parameter at a time."""
    rows = []
    for area, by_parameter in measured.errors.items():
        for parameter, by_setting in by_parameter.items():
            for setting, errors in by_setting.items():
                rows += [(float(area), parameter, setting, name, errors[name]) for name in OUTPUTS]
        deviation = measured.deviation[area]
        rows += [(float(area), "seeds", "1", name, deviation[name]) for name in OUTPUTS]
    return pd.DataFrame(rows, columns=["area_fraction", "parameter", "setting", "output", "error"])


def describe_presets(measured: MeasuredTradeoff) -> str:
    """Markdown table of `presets_for_reader`."""
    return markdown(presets_for_reader(presets_frame(measured)))


def presets_for_reader(frame: pd.DataFrame) -> pd.DataFrame:
    """`presets_frame` as text, a column for each preset."""
    labels = PARAMETER_LABELS | {"seconds": "processor time of one surface (s)"}
    rows = []
    for name in frame.columns.drop("preset"):
        output = str(name).removeprefix("error_")
        cells = [_text(value) if name in labels else percent(value) for value in frame[name]]
        rows.append([labels.get(str(name), f"error of `{output}`"), *cells])
    return pd.DataFrame(rows, columns=["", *(f"`{preset}`" for preset in frame["preset"])])


def errors_for_reader(frame: pd.DataFrame) -> pd.DataFrame:
    """`errors_frame` as text, a column for each output."""
    rows = []
    for (area, parameter, setting), group in frame.groupby(
        ["area_fraction", "parameter", "setting"], sort=False
    ):
        shown = "seeds (deviation)" if parameter == "seeds" else parameter
        rows.append([f"{area:g}", shown, setting, *map(percent, group["error"])])
    return pd.DataFrame(
        rows, columns=["area fraction", "parameter", "setting", *(f"`{name}`" for name in OUTPUTS)]
    )


def percent(value: float) -> str:
    """A relative error as a percentage with two digits; ``not measured`` if it is not finite."""
    if not math.isfinite(value):
        return "not measured"
    return "0" if value == 0 else f"{float(f'{100 * value:.2g}'):g} %"


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


if __name__ == "__main__":
    print(describe_presets(load()))
