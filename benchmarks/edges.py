"""Stress of maps cut from larger surfaces, by what continues a map at its edges.

    python benchmarks/edges.py    # writes paper/supplement/edges.csv and prints it, in five minutes

Each periodic surface of 512² nodes is pressed as a whole and cut into 16 maps of 128². A map is levelled,
continued and pressed alone under the load that it carries in the whole; its maximum von Mises stress and the
percentiles of its peaks below the contacts are compared with those of the same part of the whole. A strip is
half of the shortest wave wide.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd
import random_cases

import asperity as asp
from asperity.core.types import Array
from asperity.stress.peaks.selection import in_cell
from asperity.surface.treatment import levelling

NODES, CUTS = 512, 4
MAP = NODES // CUTS
LAYER = asp.Solid(young=1.0, poisson=0.3)
KINDS = {
    "H = 0.8": (0.8, 2, 8, 0.0),
    "H = 0.8, four long waves": (0.8, 4, 8, 0.0),
    "H = 0.8, short waves of 4 nodes": (0.8, 2, 4, 0.0),
    "H = 0.3": (0.3, 2, 8, 0.0),
    "skewed": (0.8, 2, 8, 0.8),
}
"""Name → Hurst exponent, edge of a map over the longest wave, shortest wave in nodes, and gamma of
`asperity.surface.johnson`."""

LEVELS = (50, 90, 99)

Case = tuple[str, int]


def odd_continued(height: Array, width: float) -> Array:
    """A period of four maps: images odd about the value on the edge, blended into even ones over a width.

    The images continue value and slope at the edge, and are mirror images further away.
    """
    for axis in (0, 1):
        height = np.moveaxis(height, axis, 0)
        nodes = len(height)
        even, distance = height[::-1], np.arange(nodes) + 0.5
        images = even.copy()
        for near, edge in ((distance, height[-1]), (distance[::-1], height[0])):
            weight = np.cos(np.pi / 2 * np.minimum(near / width, 1)) ** 2
            images += weight[:, None] * 2 * (edge - even)
        height = np.moveaxis(np.concatenate([height, images]), 0, axis)
    return height


class Peaks(NamedTuple):
    """Von Mises peaks of a map below its contacts: value, and distance to the nearest edge in nodes."""

    value: Array
    distance: Array


def peaks_of(contact: asp.Contact, row: int = 0, column: int = 0) -> Peaks:
    """The peaks of a map in a contact; those on a mirror line as often as they count."""
    stress = asp.analyse_stress(contact, quantities=("von_mises",), tolerance=1e-4)
    found, _ = in_cell(asp.stress.select_peaks(stress, "von_mises", selection="under_contact"))
    spacing = contact.grid.spacing[0]
    places = np.array([found["peak_y"].values, found["peak_x"].values]) / spacing
    places -= MAP * np.array([[row], [column]])
    inside = ((places > -0.5) & (places < MAP - 0.5)).all(axis=0)
    distance = np.minimum(places + 0.5, MAP - 0.5 - places).min(axis=0)
    return Peaks(found["peak_value"].values[inside], distance[inside])


def compared(case: Case) -> list[random_cases.Row]:
    """A row for each map and continuation of a surface; percentiles are those of all its maps."""
    kind, seed = case
    hurst, long, short, skew = KINDS[kind]
    waves = 1 / (CUTS * long), short / NODES
    height = asp.self_affine((NODES, NODES), hurst, *waves, rms_height=1e-3, seed=seed)
    height = asp.surface.johnson(height, skew, 1.5) if skew else np.asarray(height)
    whole = asp.solve_contact(height, LAYER, contact_area_fraction=0.1)
    edge, found = MAP / NODES, dict[str, list[tuple[Peaks, float, float]]]()
    mirrored = asp.Grid((MAP, MAP), edge, mirrored=True)
    y, x = np.mgrid[:MAP, :MAP].reshape(2, -1) / MAP - 0.5
    plane = np.stack([np.ones(MAP**2), y, x], 1)
    for row, column in np.ndindex(CUTS, CUTS):
        part = tuple(slice(MAP * at, MAP * at + MAP) for at in (row, column))
        own, load = height[part].ravel(), float(whole.pressure[part].mean())
        level = (own - plane @ np.linalg.lstsq(plane, own, rcond=None)[0]).reshape(MAP, MAP)
        found.setdefault("whole", []).append((peaks_of(whole, row, column), 0.0, 0.0))
        for name, heights, grid, boundary in (
            ("mirrored", level, mirrored, "periodic"),
            ("mirrored, without slope at the edges", levelling.level_edges(level)[0], mirrored, "periodic"),
            ("odd, over a shortest wave", odd_continued(level, short), 2 * edge, "periodic"),
            ("odd, over half of the map", odd_continued(level, MAP / 2), 2 * edge, "periodic"),
            ("free boundary", level, edge, "free"),
        ):
            begin = time.perf_counter()
            contact = asp.solve_contact(heights, LAYER, grid, mean_pressure=load, boundary=boundary)
            area = contact.contact_area_fraction / np.count_nonzero(whole.pressure[part]) * MAP**2 - 1
            found.setdefault(name, []).append((peaks_of(contact), area, time.perf_counter() - begin))
    for name, width in (("mirrored, without a strip", short / 2), ("mirrored, without a wide strip", short)):
        found[name] = [
            (Peaks(*(each[peaks.distance >= width] for each in peaks)), *others)
            for peaks, *others in found["mirrored"]
        ]
    rows = []
    exact = found.pop("whole")
    every = np.concatenate([peaks.value for peaks, *_ in exact])
    for name, maps in {"whole": exact, **found}.items():
        values, distances = (
            np.concatenate(each) for each in zip(*(peaks for peaks, *_ in maps), strict=True)
        )
        high = values >= np.quantile(values, 0.95)
        shared = {
            f"{level}th percentile": np.percentile(values, level) / np.percentile(every, level) - 1
            for level in LEVELS
        } | {"high_near": (distances[high] < short / 2).mean()}
        for (peaks, area, seconds), (truth, *_) in zip(maps, exact, strict=True):
            own = {"kind": kind, "continuation": name, "seconds": seconds, "area": area}
            own["maximum"] = peaks.value.max(initial=0.0) / truth.value.max() - 1
            own["maximum_near"] = float(peaks.distance[peaks.value.argmax()] < short / 2)
            rows.append(own | shared)
    return rows


def cases(generator: np.random.Generator, count: int) -> Iterator[Case]:
    """So many surfaces of each kind."""
    for kind in KINDS:
        yield from ((kind, int(generator.integers(2**31))) for _ in range(count))


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Relative errors in per cent, and shares of maps and peaks, by kind and continuation."""
    groups = pd.concat([rows.assign(kind="all"), rows]).groupby(["kind", "continuation"], sort=False)
    found = {"maps": groups.size()}
    for name in ("area", *(f"{level}th percentile" for level in LEVELS), "maximum"):
        found[f"{name}, mean"] = 100 * groups[name].mean()
        found[f"{name}, rms"] = 100 * groups[name].agg(lambda each: np.sqrt((each**2).mean()))
    found["maximum 10 % too high"] = 100 * groups["maximum"].agg(lambda each: (each > 0.1).mean())
    found["maximum 10 % too low"] = 100 * groups["maximum"].agg(lambda each: (each < -0.1).mean())
    found["highest 5 % near edges"] = 100 * groups["high_near"].mean()
    found["maximum near edges"] = 100 * groups["maximum_near"].mean()
    return pd.DataFrame(found | {"seconds": groups["seconds"].median()}).round(2)


if __name__ == "__main__":
    random_cases.run(__doc__, "paper/supplement/edges.csv", cases, compared, table, count=2, seed=4)
