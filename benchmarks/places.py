"""Coverage of the error between measurement positions that `asperity run` states for a single map.

    python benchmarks/places.py    # writes paper/supplement/places.csv and prints it, in five minutes

Maps are cut from random surfaces of one kind, each from another seed, and pressed alone. A stated interval
covers the number of the surface if it holds the mean over all maps of the kind. The constants of
`asperity.engineering.places` were chosen on other surfaces.
"""

import numpy as np
import pandas as pd
import random_cases

import asperity as asp
from asperity.engineering.records import POSITIONS

PIXELS, PIXEL, SEED = 96, 1e-6, 7
NUMBERS = "contact area fraction", "volume above yield per area"
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


def compared(case: tuple[str, float, int, int]) -> list[random_cases.Row]:
    """A row for each number of each map of a kind."""
    kind, long, maps, seed = case
    body = asp.Body(young=210e9, poisson=0.3, yield_stress=1e9)
    pressure, rows = 400e6 if "load" in kind else 100e6, []
    for number in range(maps):
        answer = asp.run(map_of(kind, long, 1000 * seed + number), body, mean_pressure=pressure)
        numbers = [answer[name] for name in NUMBERS]
        rows += [(each.quantity, each.value, each.errors.get(POSITIONS, np.nan)) for each in numbers]
    found = pd.DataFrame(rows, columns=["number", "value", "error"]).assign(
        kind=kind, map_over_longest_wave=long
    )
    mean = found.groupby("number")["value"].transform("mean")
    errors = {"true": abs(found["value"] / mean - 1), "stated": found["error"] / found["value"]}
    return found.assign(**errors, covered=abs(found["value"] - mean) <= found["error"]).to_dict("records")


def cases(_: np.random.Generator, count: int) -> list[tuple[str, float, int, int]]:
    """All kinds of surfaces, six longest waves wide, with the seed of their maps."""
    return [(kind, 6.0, count, SEED) for kind in KINDS]


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors by kind and number."""
    keys = ["kind", "map_over_longest_wave", "number"]
    return random_cases.covered(rows, keys, ["estimated", "true_p95", "stated_median", "covered"])


if __name__ == "__main__":
    random_cases.run(__doc__, "paper/supplement/places.csv", cases, compared, table, count=24, seed=SEED)
