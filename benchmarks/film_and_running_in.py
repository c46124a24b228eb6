"""Effect of a film on the bearing of docs/bearing.md: writes its table.

    python benchmarks/film_and_running_in.py    # two minutes

The map is a part of a ground ring (`tests/data/bearing.py`).
"""

import sys
from dataclasses import replace
from pathlib import Path

import pandas as pd

import asperity as asp
from asperity.core.markup import markdown
from asperity.engineering.records import DISCRETISATION, PLANES, Record
from asperity.paper.__main__ import replace as replace_table

sys.path.append(str(Path(__file__).parents[1] / "tests/data"))
import bearing

STEEL = {
    "young": "207 GPa",
    "poisson": 0.3,
    "yield_stress": "2 GPa",
    "fatigue_torsion": "500 MPa",
    "fatigue_bending": "800 MPa",
}
LOAD = {"force": "166.7 N", "radius_x": "3.776 mm", "radius_y": "123.8 mm"}
CASES = {
    "dry": {},
    "Λ = 0.5": {"film": {"lambda_ratio": 0.5}},
    "Λ = 1": {"film": {"lambda_ratio": 1.0}},
    "Λ = 2": {"film": {"lambda_ratio": 2.0}},
}
NUMBERS = (
    *("contact area fraction", "maximum von Mises stress", "volume above yield per area"),
    "maximum Dang Van stress over limit",
)


def by_pixels(record: Record) -> str:
    """A number with its error by the pixels alone."""
    errors = {cause: error for cause, error in record.errors.items() if cause in (DISCRETISATION, PLANES)}
    return replace(record, errors=errors).best_text().replace("\u00a0", " ")


if __name__ == "__main__":
    heights, has_data = bearing.patch("ring", 0, (120, 120))
    heights = heights.astype(float)
    heights[~has_data] = float("nan")
    ring = asp.HeightMap(heights * 1e-9, (60e-6, 60e-6), unit="m", name="ring")
    columns = {}
    for name, questions in CASES.items():
        answer = asp.run(
            {"file": ring, "despike": 8},
            STEEL,
            {**STEEL},
            load=LOAD,
            sliding={"friction": 0.08, "direction": "y"},
            **questions,
        )
        columns[name] = [by_pixels(answer[number]) for number in NUMBERS]
    page = Path(__file__).parents[1] / "docs/bearing.md"
    replace_table(page, markdown(pd.DataFrame({"": NUMBERS, **columns})) + "\n")
