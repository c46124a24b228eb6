"""Largest stress of 400 cells of a surface, predicted from 4 of them.

    python benchmarks/largest.py    # writes docs/largest.csv and prints it, in two minutes

Each group of 4 of the 400 cells predicts the largest pressure and von Mises stress of all, once for
an elastic contact and once under a hardness. A prediction is met if the true value is in its 95 % interval.
"""

import argparse

import numpy as np
import pandas as pd
from tqdm import tqdm

import asperity as asp
from asperity.stress.statistics.largest import largest_on

CELLS, FEW, POINTS, AREA = 400, 4, 64, 0.1
LAYER = asp.Layer(young=1.0, poisson=0.3)
HARDNESS = {"elastic": None, "hardness": 6.0}
"""Hardness over the mean pressure."""


def height(seed: int) -> np.ndarray:
    """A cell of two of the longest waves along each edge, eight nodes on the shortest."""
    return asp.self_affine((POINTS, POINTS), 0.8, 1 / 2, 1 / 8, rms_height=1e-3, seed=seed)


def peaks_of(seed: int, load: float, hardness: float | None) -> dict[str, np.ndarray]:
    """Peaks of pressure and von Mises stress of a cell, over the mean pressure."""
    limit = None if hardness is None else hardness * load
    contact = asp.solve(height(seed), LAYER, mean_pressure=load, hardness=limit)
    stress = asp.analyse_stress(contact, quantities=("pressure", "von_mises"), tolerance=1e-4)
    return {name: asp.peaks(stress, name)["peak_value"].values / load for name in ("pressure", "von_mises")}


def table(seed: int) -> pd.DataFrame:
    """Predictions of all groups, beside the largest value of all cells."""
    load = asp.solve(height(seed), LAYER, area_fraction=AREA).mean_pressure
    rows = []
    for kind, hardness in HARDNESS.items():
        cells = [peaks_of(seed + number, load, hardness) for number in tqdm(range(CELLS), desc=kind)]
        for name in cells[0]:
            sizes = [cell[name] for cell in cells]
            true = max(size.max() for size in sizes)
            first = range(0, CELLS, FEW)
            found = [largest_on(sizes[number : number + FEW], FEW, CELLS) for number in first]
            if hardness is not None and name == "pressure":
                continue  # the largest pressure is the hardness
            rows.append(
                {
                    "contact": kind,
                    "quantity": name,
                    "largest_of_400": true,
                    "largest_of_4": np.median([max(s.max() for s in sizes[n : n + FEW]) for n in first]),
                    "predicted": np.median([each.value for each in found]),
                    "low": np.median([each.low for each in found]),
                    "high": np.median([each.high for each in found]),
                    "met_percent": 100 * np.mean([each.low <= true <= each.high for each in found]),
                }
            )
    return pd.DataFrame(rows).round(3)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=2000)
    parser.add_argument("--out", default="docs/largest.csv")
    options = parser.parse_args()
    found = table(options.seed)
    found.to_csv(options.out, index=False)
    print(found.to_string(index=False))
