"""Errors of `asperity.continuum_limit` on random surfaces, against 32 nodes on the shortest wavelength.

    python benchmarks/continuum.py    # writes docs/continuum.csv and prints it, in a quarter of an hour

The Hurst exponent, the wavelengths and the contact area of every surface are random, and one in four is
skewed. It is pressed with 2, 4, 8 and 32 nodes on its shortest wavelength under the same load, and the
estimates on 2, 4 and 8 nodes are compared with that on 32. With two nodes, as on a map with roughness down
to its pixels, a grid with half of the nodes cannot represent the shortest waves. The shares
that the estimates use were chosen on 230 other surfaces of this kind.
"""

import argparse
import time
from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr
from tqdm import tqdm

import asperity as asp

NODES = (2, 4, 8)
FINEST = 32
LAYER = asp.Solid(young=1.0, poisson=0.33)
RATIOS = (0.0, 0.33, 0.5)
AREAS = (0.0, 0.2, 0.5, 0.8, 0.95)
"""Ends of the ranges of contact area for which the coverage is listed, too."""


def random_surface(generator: np.random.Generator) -> dict[str, float]:
    """Settings of a random surface and its contact; a third of the areas is below 20 %."""
    ratio, cells = generator.choice([(8, 4), (16, 2), (16, 3), (20, 2), (24, 2), (32, 1), (50, 1)])
    skewed, is_small = generator.random() < 0.25, generator.random() < 1 / 3
    small = np.exp(generator.uniform(np.log(0.01), np.log(0.2)))
    return {
        "hurst": float(generator.uniform(0.1, 0.95)),
        "wavelengths": int(ratio),
        "cells": int(cells),
        "seed": int(generator.integers(2**31)),
        "area_fraction": float(small if is_small else generator.uniform(0.2, 0.95)),
        "gamma": float(generator.choice([-0.4, 0.4])) if skewed else 0.0,
        "delta": 1.5 if skewed else 0.0,
    }


def height_of(surface: dict[str, float], nodes: int) -> np.ndarray:
    """Heights with a number of nodes on the shortest wavelength."""
    long = 1 / surface["cells"]
    short = long / surface["wavelengths"]
    points = round(nodes / short)
    height = asp.self_affine(
        (points, points), surface["hurst"], long, short, rms_height=1e-3, seed=surface["seed"]
    )
    return asp.surface.johnson(height, surface["gamma"], surface["delta"]) if surface["delta"] else height


def estimated(surface: dict[str, float], nodes: int, **load: float) -> tuple[asp.Contact, xr.Dataset, float]:
    """Contact, its estimates, and the processor time of these over that of contact and stress."""
    begin = time.process_time()
    contact = asp.solve_contact(height_of(surface, nodes), LAYER, **load)
    stress = asp.analyse_stress(contact, poisson=RATIOS, quantities=("pressure", "von_mises"), tolerance=1e-4)
    middle = time.process_time()
    estimates = asp.continuum_limit(contact, stress)
    return contact, estimates, (time.process_time() - begin) / (middle - begin)


def compared(surface: dict[str, float]) -> Iterator[dict[str, object]]:
    """Errors of the values on the grid and of the estimates, a row for each output and number of nodes."""
    contact, estimates, cost = estimated(surface, NODES[-1], area_fraction=surface["area_fraction"])
    load = contact.mean_pressure
    coarse = {nodes: estimated(surface, nodes, mean_pressure=load)[1] for nodes in NODES[:-1]}
    truth = estimated(surface, FINEST, mean_pressure=load)[1]
    for nodes, found in {**coarse, NODES[-1]: estimates}.items():
        if reason := found.attrs.get("reason"):
            yield {**surface, "nodes": nodes, "output": "none", "reason": reason}
            continue
        for name, values in found.items():
            for index in np.ndindex(values.shape[1:]):
                kinds = "on_grid", "estimate", "error"
                on_grid, estimate, error = (values.sel(kind=kind).values[index] for kind in kinds)
                best = truth[name].sel(kind="estimate").values[index]
                if not np.isfinite(best) or best == 0:
                    continue
                of = f" {values['quantity'].values[index[0]]}" if "quantity" in values.dims else ""
                yield {
                    **surface,
                    "nodes": nodes,
                    "output": f"{name}{of}",
                    "on_grid": on_grid / best - 1,
                    "estimate": estimate / best - 1,
                    "stated": error,
                    "cost": cost if nodes == NODES[-1] else np.nan,
                }


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors in per cent, and how often the stated error covers the true one."""
    compared = rows[rows["output"] != "none"]
    ranges = pd.cut(compared["area_fraction"], AREAS).astype(str)
    every = pd.concat([compared.assign(areas="all"), compared.assign(areas=ranges)])
    groups = every.groupby(["nodes", "areas", "output"], sort=False)

    def size(name: str, level: float) -> pd.Series:
        return 100 * groups[name].apply(lambda error: error.abs().quantile(level))

    return pd.DataFrame(
        {
            "on_grid_median": size("on_grid", 0.5),
            "on_grid_p90": size("on_grid", 0.9),
            "estimate_median": size("estimate", 0.5),
            "estimate_p90": size("estimate", 0.9),
            "stated_median": size("stated", 0.5),
            "covered": 100 * groups.apply(lambda some: (some["estimate"].abs() <= some["stated"]).mean()),
        }
    ).round(2)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--surfaces", type=int, default=120)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--out", default="docs/continuum.csv")
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    rows = [row for _ in tqdm(range(options.surfaces)) for row in compared(random_surface(generator))]
    found = pd.DataFrame(rows)
    summary = table(found)
    summary.to_csv(options.out)
    print(summary.to_string())
    print(
        f"cost of contact, stress and estimates over that of contact and stress: {found['cost'].median():.2f}"
    )
    print(f"without estimate: {(found['output'] == 'none').sum()}")
