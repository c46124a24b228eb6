"""Errors of the volume above yield that `asperity run` states, near the onset of yield and far above it.

    python benchmarks/volume.py    # writes docs/volume.csv and prints it, in ten minutes

Random surfaces are pressed with 2, 4, 8 and 32 pixels on their shortest wavelength under the same load, a
third of them under a hardness. The yield stress is a share of the largest stress on 32 pixels. A stated error
covers the true one if the volume is within it of that on 32 pixels.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd
import random_cases
from answers import FINEST, NODES, Case, hardness_of
from continuum import height_of, random_surface

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


def compared(case: Case) -> list[random_cases.Row]:
    """A row for each number of pixels and each yield stress."""
    surface, share, plastic = case
    heights = {nodes: height_of(surface, nodes) for nodes in (*NODES, FINEST)}
    elastic = asp.solve_contact(heights[8], LAYER, area_fraction=surface["area_fraction"])
    hardness = hardness_of(elastic, share)
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


def cases(generator: np.random.Generator, count: int) -> Iterator[Case]:
    """Random surfaces, with the share of the pressures below the hardness, and whether it limits them."""
    for number in range(count):
        surface = random_surface(generator) | {"wavelengths": 8, "cells": 2}
        surface["area_fraction"] = min(surface["area_fraction"], generator.uniform(0.05, 0.6))
        yield surface, generator.uniform(0.02, 0.999), number % 3 == 2


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors by hardness, pixels and yield stress."""
    columns = ["cases", "true_median", "stated_median", "covered"]
    return random_cases.covered(rows, ["plastic", "nodes", "yield_over_largest"], columns)


if __name__ == "__main__":
    random_cases.run(__doc__, "docs/volume.csv", cases, compared, table, count=30, seed=6)
