"""Errors of `asperity.continuum_limit` on surfaces that are not isotropic and Gaussian.

    python benchmarks/kinds.py    # writes docs/kinds.csv and prints it, in three minutes on two cores

Surfaces with a lay of 2:1 to 20:1, straight ridges, plateaus, skewed heights of both signs, and two scales
are pressed with 2, 4 and 8 nodes on their shortest wavelength, and with 24 under the same load. The factors
of `OF_DEPARTURE` were chosen on kinds that are not among these.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd
import random_cases
import xarray as xr

import asperity as asp
from asperity.core.types import Array

KINDS = "lay", "straight ridges", "plateau", "skewed", "two scales"
NODES, FINEST, WAVES = (2, 4, 8), 24, (24, 32)
LAYER = asp.Solid(young=1.0, poisson=0.33)
NUMBERS = {
    "area at given load": ("area_fraction", None),
    "rms gradient of the contact": ("gradient_rms_contact", None),
    "κ_r": ("proportionality", None),
    "90th percentile, pressure": ("p90", "pressure"),
    "99th percentile, pressure": ("p99", "pressure"),
    "largest pressure peak": ("largest", "pressure"),
    "90th percentile, von Mises": ("p90", "von_mises"),
    "99th percentile, von Mises": ("p99", "von_mises"),
    "largest von Mises peak": ("largest", "von_mises"),
    "mean depth of the peaks": ("mean_depth", "von_mises"),
    "depth of the highest tenth": ("mean_depth_highest", "von_mises"),
}


def field(points: int, longest: int, shortest: int, settings: dict, seed: int) -> Array:
    """Gaussian field with a rms of about one: waves from `longest` to `shortest` of the cell, with a lay."""
    k = np.fft.fftfreq(2 * shortest + 2, 1 / (2 * shortest + 2))
    ky, kx = np.meshgrid(k, k, indexing="ij")
    angle = settings["angle"]
    across, along = kx * np.cos(angle) + ky * np.sin(angle), ky * np.cos(angle) - kx * np.sin(angle)
    straight = settings["kind"] == "straight ridges"
    wave = np.hypot(across, settings["ratio"] * along)
    held = (wave >= longest) & (wave <= shortest) & ~(straight & (ky != 0))
    power = np.where(held, np.maximum(wave, 1) ** -(2 * settings["hurst"] + (1 if straight else 2)), 0)
    modes = np.fft.fft2(np.random.default_rng(seed).normal(size=k.size * np.ones(2, int)))
    modes *= np.sqrt(power / power.sum()) / k.size  # rms of one
    full = np.zeros((points, points), complex)
    # Two nodes hold a wave at the limit only in one phase, and it is left out there.
    kept = (np.abs(ky) < points / 2) & (np.abs(kx) < points / 2)
    full[ky[kept].astype(int), kx[kept].astype(int)] = modes[kept]
    return np.fft.ifft2(full).real * points**2


def random_surface(kind: str, generator: np.random.Generator) -> dict:
    """Settings of a surface and its contact; two in five areas are below 20 %."""
    small = generator.random() < 0.4
    area = np.exp(generator.uniform(*np.log((0.02, 0.2)))) if small else generator.uniform(0.2, 0.9)
    is_lay = kind == "lay"
    return {
        "kind": kind,
        "waves": int(generator.choice(WAVES)),
        "longest": int(generator.choice((1, 2, 3))),
        "hurst": generator.uniform(0.1, 0.95),
        "ratio": 2 * 10 ** generator.random() if is_lay else 1.0,
        "angle": generator.choice((0, np.pi / 2, np.pi * generator.random())) if is_lay else 0.0,
        "shares": generator.random(2),
        "sign": generator.choice((-1, 1)),
        "seed": int(generator.integers(2**31)),
        "area_fraction": float(area),
    }


def height_of(settings: dict, nodes: int) -> Array:
    """Heights with a number of nodes on the shortest wave."""
    short, long, seed = settings["waves"], settings["longest"], settings["seed"]
    points, (one, two) = nodes * short, settings["shares"]
    height = field(points, long, short, settings, seed)
    if settings["kind"] == "plateau":  # the lowest parts, which touch first, come from a finer process
        fine = (0.03 + 0.15 * one) * field(points, max(long, 4), short, settings, seed + 1) + 1.6 * two - 0.8
        height = (height + fine + np.sqrt((height - fine) ** 2 + 0.01)) / 2
    elif settings["kind"] == "skewed":
        height = asp.surface.johnson(height, settings["sign"] * (0.2 + one), 0.8 + 1.2 * two)
    elif settings["kind"] == "two scales":
        fine = field(points, round(0.6 * short), short, settings, seed + 1)
        height = field(points, 1, 3, settings, seed) + (0.02 + 0.3 * one) * fine
    return 1e-3 * height


def estimated(settings: dict, nodes: int, **load: float) -> tuple[asp.Contact, xr.Dataset]:
    """Contact and its estimates."""
    contact = asp.solve_contact(height_of(settings, nodes), LAYER, **load)
    of_peaks = {"quantities": ("pressure", "von_mises"), "tolerance": 1e-4}
    stress = asp.analyse_stress(contact, **of_peaks, covariances=True)
    return contact, asp.continuum_limit(contact, stress)


def compared(settings: dict) -> list[dict]:
    """Errors of the estimates, a row for each number and number of nodes."""
    contact, finest = estimated(settings, NODES[-1], area_fraction=settings["area_fraction"])
    load, rows = contact.mean_pressure, []
    truth = estimated(settings, FINEST, mean_pressure=load)[1]
    for nodes in NODES:
        found = finest if nodes == NODES[-1] else estimated(settings, nodes, mean_pressure=load)[1]
        for number, (name, quantity) in NUMBERS.items():
            own, true = (
                (one[name] if quantity is None else one[name].sel(quantity=quantity)).squeeze()
                for one in (found, truth)
            )
            best, on_finest = (float(true.sel(kind=kind)) for kind in ("estimate", "on_grid"))
            if not np.isfinite(best):
                best = on_finest
            estimate, stated = (float(own.sel(kind=kind)) for kind in ("estimate", "error"))
            if best > 0:
                of = {"kind": settings["kind"], "nodes": nodes, "number": number}
                rows.append({**of, "true": abs(estimate / best - 1), "stated": stated})
    return rows


def cases(generator: np.random.Generator, count: int) -> Iterator[dict]:
    """Random surfaces, so many of each kind."""
    return (random_surface(kind, generator) for _ in range(count) for kind in KINDS)


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Errors by nodes, kind and number."""
    every = pd.concat([rows.assign(kind="all"), rows])
    columns = ["estimated", "true_median", "stated_median", "covered"]
    found = random_cases.covered(every, ["nodes", "kind", "number"], columns)
    return found.sort_index(level=0, sort_remaining=False)


if __name__ == "__main__":
    random_cases.run(__doc__, "docs/kinds.csv", cases, compared, table, count=12, seed=5)
