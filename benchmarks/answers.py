"""Errors of the grid that `asperity run` states, against 32 pixels on the shortest wavelength.

    python benchmarks/answers.py    # writes docs/answers.csv and prints it, in a quarter of an hour

Random surfaces of steel are pressed with 2, 4, 8 and 32 pixels on their shortest wavelength under the same
load, half of them under a hardness, which bears 1 to 98 % of the load. A stated error covers the true one if
the value for vanishing pixels, or the value where there is none, is within it of that on 32 pixels.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import random_cases
from continuum import height_of, random_surface

import asperity as asp

NODES, FINEST = (2, 4, 8), 32
SMALL = (8, 2), (16, 1), (16, 2), (32, 1)
"""Ratio of the wavelengths, and cells of the longest one."""

Case = tuple[dict[str, float], float, bool]
EDGE, MODULUS, POISSON = 1e-4, 210e9, 0.3


def hardness_of(elastic: asp.Contact, share: float) -> float:
    """Pressure below which a share of the contact nodes lies, and at least 1.1 times the mean pressure."""
    quantile = float(np.quantile(elastic.pressure[elastic.pressure > 0], share))
    return max(quantile, 1.1 * elastic.mean_pressure)


def answers(surface: dict[str, float], share: float, plastic: bool) -> dict[int, asp.engineering.Answer]:
    """Pixels on the shortest wavelength → answer under the same load."""
    height = {nodes: EDGE * height_of(surface, nodes) for nodes in (*NODES, FINEST)}
    steel = asp.Solid(young=MODULUS, poisson=POISSON)
    elastic = asp.solve_contact(height[8], steel, EDGE, area_fraction=surface["area_fraction"])
    hardness = hardness_of(elastic, share)
    body = asp.Body(
        young=MODULUS,
        poisson=POISSON,
        yield_stress=hardness / 3,
        hardness=hardness if plastic else None,
        fatigue_torsion=hardness / 8,
        fatigue_bending=hardness / 5,
    )
    return {
        nodes: asp.run(
            {
                "file": asp.HeightMap(each, (EDGE, EDGE), periodic=True, unit="m", orientation="lower face"),
                "detrend": "none",
            },
            body,
            mean_pressure=elastic.mean_pressure,
        )
        for nodes, each in height.items()
    }


def compared(case: Case) -> list[random_cases.Row]:
    """A row for each number that has a stated error, and each number of pixels."""
    plastic = case[2]
    found = {
        nodes: answer.frame().drop_duplicates("name").set_index("name")
        for nodes, answer in answers(*case).items()
    }
    truth, rows = found.pop(FINEST), []
    for nodes, frame in found.items():
        for name, row in frame[frame["error"].notna()].iterrows():
            if name in truth.index and truth["value"][name]:
                best = truth["estimate"].fillna(truth["value"])[name]
                rows.append(
                    {
                        "plastic": plastic,
                        "nodes": nodes,
                        "number": name,
                        "on_grid": abs(row["value"] / best - 1),
                        "true": abs(row["estimate"] / best - 1),
                        "stated": abs(row["error"] / best),
                    }
                )
    return rows


def cases(generator: np.random.Generator, count: int) -> Iterator[Case]:
    """Random surfaces, with the share of the pressures below the hardness, and whether it limits them."""
    for number in range(count):
        surface = random_surface(generator)
        surface["wavelengths"], surface["cells"] = SMALL[number % len(SMALL)]
        surface["area_fraction"] = min(surface["area_fraction"], 0.6)
        yield surface, generator.uniform(0.02, 0.999), number % 8 < 4


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors by hardness, pixels and number."""
    columns = ["cases", "on_grid_median", "true_median", "true_p90", "stated_median", "covered"]
    return random_cases.covered(rows, ["plastic", "nodes", "number"], columns)


if __name__ == "__main__":
    random_cases.run(__doc__, "docs/answers.csv", cases, compared, table, count=40, seed=9)
