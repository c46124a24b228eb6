"""Errors of the grid that `asperity run` states, against 32 pixels on the shortest wavelength.

    python benchmarks/answers.py    # writes docs/answers.csv and prints it, in a quarter of an hour

Random surfaces of steel are pressed with 2, 4, 8 and 32 pixels on their shortest wavelength under the same
load, half of them under a hardness, which bears 1 to 98 % of the load. A stated error covers the true one if
the value for vanishing pixels, or the value where there is none, is within it of that on 32 pixels.
"""

from __future__ import annotations

import argparse

import numpy as np
import pandas as pd
from continuum import height_of, random_surface
from tqdm import tqdm

import asperity as asp

NODES, FINEST = (2, 4, 8), 32
SMALL = (8, 2), (16, 1), (16, 2), (32, 1)
"""Ratio of the wavelengths, and cells of the longest one."""

EDGE, MODULUS, POISSON = 1e-4, 210e9, 0.3


def answers(surface: dict[str, float], share: float, plastic: bool) -> dict[int, asp.engineering.Answer]:
    """Pixels on the shortest wavelength → answer under the same load."""
    height = {nodes: EDGE * height_of(surface, nodes) for nodes in (*NODES, FINEST)}
    steel = asp.Solid(young=MODULUS, poisson=POISSON)
    elastic = asp.solve_contact(height[8], steel, EDGE, area_fraction=surface["area_fraction"])
    hardness = float(np.quantile(elastic.pressure[elastic.pressure > 0], share))
    hardness = max(hardness, 1.1 * elastic.mean_pressure)
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


def compared(surface: dict[str, float], share: float, plastic: bool) -> list[dict[str, object]]:
    """A row for each number that has a stated error, and each number of pixels."""
    found = {
        nodes: answer.frame().drop_duplicates("name").set_index("name")
        for nodes, answer in answers(surface, share, plastic).items()
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
                        "estimate": abs(row["estimate"] / best - 1),
                        "stated": abs(row["error"] / best),
                        "share": share,
                        "area": surface["area_fraction"],
                    }
                )
    return rows


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors in per cent, and how often the stated error covers the true one."""
    groups = rows.groupby(["plastic", "nodes", "number"], sort=False)
    return pd.DataFrame(
        {
            "surfaces": groups.size(),
            "on_grid_median": 100 * groups["on_grid"].median(),
            "estimate_median": 100 * groups["estimate"].median(),
            "estimate_p90": 100 * groups["estimate"].quantile(0.9),
            "stated_median": 100 * groups["stated"].median(),
            "covered": 100 * groups.apply(lambda some: (some["estimate"] <= some["stated"]).mean()),
        }
    ).round(2)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--surfaces", type=int, default=40)
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--out", default="docs/answers.csv")
    parser.add_argument("--rows", help="file for the errors of every surface")
    options = parser.parse_args()
    generator, rows = np.random.default_rng(options.seed), []
    for number in tqdm(range(options.surfaces)):
        surface = random_surface(generator)
        surface["wavelengths"], surface["cells"] = SMALL[number % len(SMALL)]
        surface["area_fraction"] = min(surface["area_fraction"], 0.6)
        rows += compared(surface, generator.uniform(0.02, 0.999), number % 8 < 4)
        if options.rows:
            pd.DataFrame(rows).to_csv(options.rows, index=False)
    summary = table(pd.DataFrame(rows))
    summary.to_csv(options.out)
    print(summary.to_string())
