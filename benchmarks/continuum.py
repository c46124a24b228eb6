"""Errors of `asperity.continuum_limit` on random surfaces, against 32 nodes on the shortest wavelength.

    python benchmarks/continuum.py    # writes continuum.csv and prints it, in a quarter of an hour

The Hurst exponent, the wavelengths and the contact area of every surface are random, and one in four is
skewed. It is pressed with 2, 4, 8 and 32 nodes on its shortest wavelength under the same load, and the
estimates on 2, 4 and 8 nodes are compared with that on 32. With two nodes, as on a map with roughness down
to its pixels, a grid with half of the nodes cannot represent the shortest waves. The shares
that the estimates use were chosen on 230 other surfaces of this kind.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd
import random_cases
import xarray as xr

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
        "contact_area_fraction": float(small if is_small else generator.uniform(0.2, 0.95)),
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


def estimated(surface: dict[str, float], nodes: int, **load: float) -> tuple[asp.Contact, xr.Dataset]:
    """Contact and its estimates."""
    contact = asp.solve_contact(height_of(surface, nodes), LAYER, **load)
    of_peaks = {"quantities": ("pressure", "von_mises"), "tolerance": 1e-4}
    stress = asp.analyse_stress(contact, poisson=RATIOS, **of_peaks, covariances=True)
    return contact, asp.continuum_limit(contact, stress)


def compared(surface: dict[str, float]) -> list[random_cases.Row]:
    """Errors of the values on the grid and of the estimates, a row for each output and number of nodes."""
    contact, estimates = estimated(surface, NODES[-1], contact_area_fraction=surface["contact_area_fraction"])
    load = contact.mean_pressure
    coarse = {nodes: estimated(surface, nodes, mean_pressure=load)[1] for nodes in NODES[:-1]}
    truth, rows = estimated(surface, FINEST, mean_pressure=load)[1], []
    for nodes, found in {**coarse, NODES[-1]: estimates}.items():
        known = {"nodes": nodes, "contact_area_fraction": surface["contact_area_fraction"]}
        if found.attrs.get("reason"):
            rows.append({**known, "output": "none", "on_grid": np.nan, "true": np.nan, "stated": np.nan})
            continue
        for name, values in found.items():
            for index in np.ndindex(values.shape[1:]):
                kinds = "on_grid", "estimate", "error"
                on_grid, estimate, error = (values.sel(kind=kind).values[index] for kind in kinds)
                best = truth[name].sel(kind="estimate").values[index]
                if not np.isfinite(best) or best == 0:
                    continue
                of = f" {values['quantity'].values[index[0]]}" if "quantity" in values.dims else ""
                errors = {"on_grid": abs(on_grid / best - 1), "true": abs(estimate / best - 1)}
                rows.append({**known, "output": f"{name}{of}", **errors, "stated": error})
    return rows


def cases(generator: np.random.Generator, count: int) -> Iterator[dict[str, float]]:
    """Random surfaces."""
    return (random_surface(generator) for _ in range(count))


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors by nodes, range of areas and output; output none counts surfaces without estimate."""
    ranges = pd.cut(rows["contact_area_fraction"], AREAS).astype(str)
    every = pd.concat([rows.assign(areas="all"), rows.assign(areas=ranges)])
    columns = ["on_grid_median", "on_grid_p90", "true_median", "true_p90", "stated_median", "covered"]
    return random_cases.covered(every, ["nodes", "areas", "output"], columns)


if __name__ == "__main__":
    random_cases.run(__doc__, "paper/supplement/continuum.csv", cases, compared, table, count=120, seed=3)
