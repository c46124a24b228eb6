"""Effect of film and run-in on the bearing of `docs/bearing.md`, as a table in Markdown.

    python benchmarks/film_and_run_in.py    # three minutes

The map is a patch of a ground ring (`tests/data/bearing.py`).
"""

import sys
from pathlib import Path

import pandas as pd

import asperity as asp
from asperity.core.markup import markdown

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
RUN_IN = {"loads": 1, "hardness": "6 GPa"}
CASES = {
    "dry": {},
    "λ = 0.5": {"film": {"lambda_ratio": 0.5}},
    "λ = 1": {"film": {"lambda_ratio": 1.0}},
    "λ = 2": {"film": {"lambda_ratio": 2.0}},
    "dry, run in": {"running_in": RUN_IN},
    "λ = 1, run in": {"film": {"lambda_ratio": 1.0}, "running_in": RUN_IN},
}
NUMBERS = (
    *("real contact", "largest pressure", "largest von Mises stress", "volume above yield per area"),
    *("largest Dang Van stress over limit", "shakedown factor, at least"),
)

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
        rows = {row.name: row for row in reversed(answer.rows)}
        columns[name] = [
            (row.with_error or row.value_and_place[0]).replace("\u00a0", " ")
            for row in (rows[number] for number in NUMBERS)
        ]
    print(markdown(pd.DataFrame({"": NUMBERS, **columns})))
