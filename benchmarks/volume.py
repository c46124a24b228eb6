"""Errors of the volume above yield that `asperity run` states, near the onset of yield and far above it.

    python benchmarks/volume.py    # writes docs/volume.csv and prints it, in ten minutes

Random surfaces are pressed with 2, 4, 8 and 32 pixels on their shortest wavelength under the same load, a
third of them under a hardness. The yield stress is a share of the largest stress on 32 pixels. A stated error
covers the true one if the volume is within it of that on 32 pixels.
"""

import argparse

import numpy as np
import pandas as pd
from answers import FINEST, NODES
from continuum import height_of, random_surface
from tqdm import tqdm

import asperity as asp
from asperity.engineering.continuum import continuum_on_grids, solved_on_half
from asperity.stress.exceedance import Exceedance

LAYER = asp.Solid(young=1.0, poisson=0.3)
SHARES = (0.4, 0.65, 0.8, 0.9, 0.95, 0.97)


def measured(contact: asp.Contact, limits: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
    """Volumes per area above limits, their stated errors, and the reason against these."""
    found = [Exceedance(limit, periodic=True) for limit in limits]

    def observe(plane) -> None:
        values = plane.field("von_mises", LAYER.poisson)
        for each in found:
            each.add(plane.depth, plane.grid, values)

    quantities = ("pressure", "von_mises")
    stress = asp.analyse_stress(contact, quantities=quantities, tolerance=1e-4, observe=observe)
    peaks = asp.stress.select_peaks(stress, "von_mises")["peak_value"].values
    for each in found:
        each.finish(max(peaks.max(), stress["largest_von_mises"].values.max()))
    estimates = continuum_on_grids(contact, solved_on_half(contact), stress, "lower")
    errors = [
        each.error(estimates, int((peaks > limit).sum())) for each, limit in zip(found, limits, strict=True)
    ]
    return np.array([each.volume for each in found]), np.array(errors), estimates.attrs.get("reason", "")


def compared(surface: dict[str, float], share: float, plastic: bool) -> list[dict[str, object]]:
    """A row for each number of pixels and each yield stress."""
    heights = {nodes: height_of(surface, nodes) for nodes in (*NODES, FINEST)}
    elastic = asp.solve_contact(heights[8], LAYER, area_fraction=surface["area_fraction"])
    hardness = max(
        float(np.quantile(elastic.pressure[elastic.pressure > 0], share)), 1.1 * elastic.mean_pressure
    )
    contacts = {
        nodes: asp.solve_contact(
            each, LAYER, mean_pressure=elastic.mean_pressure, hardness=hardness if plastic else None
        )
        for nodes, each in heights.items()
    }
    largest = asp.analyse_stress(contacts[FINEST], quantities=("von_mises",), tolerance=1e-4)
    limits = np.array(SHARES) * float(asp.stress.select_peaks(largest, "von_mises")["peak_value"].max())
    truth, rows = measured(contacts.pop(FINEST), limits)[0], []
    for nodes, contact in contacts.items():
        volumes, errors, reason = measured(contact, limits)
        for at, exact, volume, error in zip(SHARES, truth, volumes, errors, strict=True):
            if not reason:
                found = {"true": abs(volume / exact - 1), "stated": error / exact}
                rows.append({"plastic": plastic, "nodes": nodes, "yield_over_largest": at} | found)
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--surfaces", type=int, default=30)
    parser.add_argument("--seed", type=int, default=6)
    parser.add_argument("--out", default="docs/volume.csv")
    options = parser.parse_args()
    generator, rows = np.random.default_rng(options.seed), []
    for number in tqdm(range(options.surfaces)):
        surface = random_surface(generator) | {"wavelengths": 8, "cells": 2}
        surface["area_fraction"] = min(surface["area_fraction"], generator.uniform(0.05, 0.6))
        rows += compared(surface, generator.uniform(0.02, 0.999), number % 3 == 2)
        groups = pd.DataFrame(rows).groupby(["plastic", "nodes", "yield_over_largest"], sort=False)
        summary = pd.DataFrame(
            {
                "surfaces": groups.size(),
                "true_median": 100 * groups["true"].median(),
                "stated_median": 100 * groups["stated"].median(),
                "covered": 100 * groups.apply(lambda some: (some["true"] <= some["stated"]).mean()),
            }
        ).round(1)
        summary.to_csv(options.out)
    print(summary.to_string())
