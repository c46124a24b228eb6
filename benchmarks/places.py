"""Coverage of the error from place to place that `asperity run` states for a single map.

    python benchmarks/places.py    # writes docs/places.csv and prints it, in five minutes

Maps are cut from random surfaces of one kind, each from another seed, and pressed alone. A stated interval
covers the number of the surface if it holds the mean over all maps of the kind. The constants of
`asperity.engineering.places` were chosen on other surfaces (`--seed 2 --maps 40 --long 3 6`).
"""

import argparse

import numpy as np
import pandas as pd
from tqdm import tqdm

import asperity as asp

PIXELS, PIXEL = 96, 1e-6
NUMBERS = "real contact", "volume above yield per area"
KINDS = {
    "Gaussian, H = 0.8": lambda height: height,
    "Gaussian, H = 0.5": lambda height: height,
    "Gaussian, H = 0.8, higher load": lambda height: height,
    "plateau": lambda height: np.minimum(height, 0.8 * height.std()),
    "skewed": lambda height: -((height / height.std() + 4) ** 0.5) * height.std(),
    "lay of 3 to 1": lambda height: height,
}
"""Name → change of Gaussian heights."""


def map_of(kind: str, long: float, seed: int) -> asp.HeightMap:
    """A map of 96² pixels from a larger surface, whose longest wave is its edge over `long`."""
    edge = 2 * PIXELS * PIXEL
    hurst = 0.5 if "0.5" in kind else 0.8
    height = asp.self_affine(
        (2 * PIXELS, 2 * PIXELS), hurst, PIXELS * PIXEL / long, 4 * PIXEL, 1e-7, seed, length=edge
    )
    if "lay" in kind:  # three times as long along y
        rows = np.arange(2 * PIXELS) / 3
        low, part = rows.astype(int), (rows % 1)[:, None]
        height = (1 - part) * height[low] + part * height[low + 1]
    height = KINDS[kind](np.clip(height, -3.9 * height.std(), None))
    return asp.HeightMap(height[:PIXELS, :PIXELS], (PIXELS * PIXEL, PIXELS * PIXEL), unit="m", name="place")


def of_kind(kind: str, long: float, maps: int, seed: int) -> list[dict[str, object]]:
    """Coverage of each number over the maps of a kind."""
    body = asp.Body(young=210e9, poisson=0.3, yield_stress=1e9)
    pressure = 400e6 if "load" in kind else 100e6
    found = {name: [] for name in NUMBERS}
    for number in tqdm(range(maps), desc=f"{kind}, {long:g}", leave=False, disable=None):
        answer = asp.run(map_of(kind, long, 1000 * seed + number), body, mean_pressure=pressure)
        for row in answer.rows:
            if row.name in NUMBERS:
                found[row.name].append((row.value, row.error_of_places))
    rows = []
    for name, values in found.items():
        value, error = np.array(values).T
        known = np.isfinite(error)
        covered = np.abs(value - value.mean()) <= error
        rows.append(
            {
                "kind": kind,
                "map_over_longest_wave": long,
                "number": name,
                "with_estimate": known.mean(),
                "true": np.quantile(np.abs(value / value.mean() - 1), 0.95),
                "stated": np.nanmedian(error / value) if known.any() else np.nan,
                "covered": covered[known].mean() if known.any() else np.nan,
            }
        )
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--maps", type=int, default=24)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--kinds", nargs="+", default=list(KINDS))
    parser.add_argument("--long", type=float, nargs="+", default=[6])
    parser.add_argument("--out", default="docs/places.csv")
    options = parser.parse_args()
    rows = []
    for kind in options.kinds:
        for long in options.long:
            rows += of_kind(kind, long, options.maps, options.seed)
    table = pd.DataFrame(rows)
    table.to_csv(options.out, index=False, float_format="%.3g")
    print(table.to_string(index=False))
