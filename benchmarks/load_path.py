"""Cost of an imposed area, and of a load path, in solutions at the same loads.

    python benchmarks/load_path.py --points 1024 2048

prints three tables for rough surfaces with eight nodes on the shortest wave:

- area control: the solution at an imposed area, and the one at the load found,
- load path: the areas of the paper's study along one path, and each load alone,
- start: the solution from a pressure of known error, which shows what a start can save.

Cost is counted in double-precision pairs of transforms of the finest grid. A pair of a coarser grid counts in
proportion to its nodes, and one in single precision as the fraction of the time that it takes, which is
measured first. Times are processor times of one thread. Errors are those of the pressure relative to its
norm, against a solution at an estimated error of 1e-10 at the same load.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import one_thread  # noqa: F401

# isort: split

import numpy as np
import yaml
from contact_run import counted, pair_seconds, rough

import asperity as asp
from asperity.contact import Contact
from asperity.elasticity.layer import Layer
from asperity.types import Array

CONFIG = Path(__file__).parents[1] / "config" / "config.yaml"
LAYER = Layer(1.0, 0.33, height=1.0)
REFERENCE_TOLERANCE = 1e-10
STARTS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)


class Cost(NamedTuple):
    """Transforms, in pairs of the finest grid, and processor time of a calculation."""

    double: float
    single: float
    coarse: float
    equivalents: float
    seconds: float

    def __str__(self) -> str:
        parts = f"{self.double:.1f} + {self.single:.1f} single + {self.coarse:.1f}"
        return f"{parts} = {self.equivalents:.1f} | {self.seconds:.2f}"


def measured(run: Callable[[], Contact], size: int, fraction: float) -> tuple[Contact, Cost]:
    """Result and cost of a calculation on `size` nodes."""
    start = time.process_time()
    with counted() as transforms:
        contact = run()
    seconds = time.process_time() - start
    weight = {"float64": 1.0, "float32": fraction}
    pairs = {key: nodes / (2 * size) for key, nodes in transforms.by_grid.items()}
    finest = {precision: pairs.get((size, precision), 0.0) for precision in weight}
    coarse = sum(number * weight[key[1]] for key, number in pairs.items() if key[0] != size)
    total = coarse + sum(number * weight[precision] for precision, number in finest.items())
    return contact, Cost(finest["float64"], finest["float32"], coarse, total, seconds)


def error(contact: Contact, height: Array) -> float:
    """Error of a pressure, against the reference at its load."""
    found = asp.solve(height, LAYER, mean_pressure=contact.mean_pressure, rtol=REFERENCE_TOLERANCE).pressure
    return float(np.linalg.norm(contact.pressure - found) / np.linalg.norm(found))


def area_control(height: Array, areas: list[float], fraction: float) -> list[tuple[float, Cost]]:
    """Print the cost of each area; return load and cost of the solution at that load."""
    print("| area | area control: pairs | s | error | missed by | at the load: pairs | s | ratio | of time |")
    print("|---" * 9 + "|")
    ratios, alone = [], []
    for area in areas:
        by_area, cost = measured(partial(asp.solve, height, LAYER, area_fraction=area), height.size, fraction)
        load = by_area.mean_pressure
        _, at_load = measured(partial(asp.solve, height, LAYER, mean_pressure=load), height.size, fraction)
        ratios.append((cost.equivalents / at_load.equivalents, cost.seconds / at_load.seconds))
        alone.append((load, at_load))
        print(
            f"| {area:g} | {cost} | {error(by_area, height):.1e} | {by_area.control_error:.1e} "
            f"| {at_load} | {ratios[-1][0]:.2f} | {ratios[-1][1]:.2f} |",
            flush=True,
        )
    print(f"Mean ratio {np.mean(ratios, axis=0)[0]:.2f}, of time {np.mean(ratios, axis=0)[1]:.2f}")
    return alone


def load_path(height: Array, areas: list[float], alone: list[tuple[float, Cost]], fraction: float) -> None:
    """Print the cost of the path over these areas, and of the mean of the solutions at its loads alone."""
    print("| area | along the path: pairs | s | error | missed by |")
    print("|---" * 5 + "|")
    path, total, seconds = asp.solve_path(height, LAYER, area_fractions=areas), 0.0, 0.0
    for area in areas:
        contact, cost = measured(partial(next, path), height.size, fraction)
        total, seconds = total + cost.equivalents, seconds + cost.seconds
        shown = f"{error(contact, height):.1e} | {contact.control_error:.1e}"
        print(f"| {area:g} | {cost} | {shown} |", flush=True)
    pairs = np.mean([cost.equivalents for _, cost in alone])
    one = np.mean([cost.seconds for _, cost in alone])
    print(
        f"Path {total:.0f} pairs, {seconds:.1f} s: {total / pairs:.1f} times one solution of {pairs:.1f} "
        f"pairs and {seconds / one:.1f} times its time"
    )


def starts(height: Array, load: float, alone: Cost, fraction: float) -> None:
    """Print the cost of a load from solutions at nearly that load."""
    print("| error of the start | pairs | s | over the solution without a start |")
    print("|---" * 4 + "|")
    truth = asp.solve(height, LAYER, mean_pressure=load, rtol=REFERENCE_TOLERANCE).pressure
    for distance in STARTS:
        beside = asp.solve(height, LAYER, mean_pressure=(1 - distance) * load, rtol=1e-9).pressure
        beside *= load / beside.mean()
        _, cost = measured(
            partial(asp.solve, height, LAYER, mean_pressure=load, initial=beside), height.size, fraction
        )
        apart = np.linalg.norm(beside - truth) / np.linalg.norm(truth)
        print(f"| {apart:.0e} | {cost} | {cost.equivalents / alone.equivalents:.2f} |", flush=True)


def main() -> None:
    """Run the measurements."""
    areas = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))["contact"]["path_area_fractions"]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, nargs="+", default=[1024])
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--areas", type=float, nargs="+", default=areas)
    options = parser.parse_args()
    for points in options.points:
        pair = pair_seconds((points, points))
        fraction = pair["float32"][0] / pair["float64"][0]
        for hurst in options.hurst:
            height = rough(points, hurst)
            # Compile the library before the clock starts.
            list(asp.solve_path(height[:64, :64].copy(), LAYER, area_fractions=[0.05, 0.06, 0.07], rtol=1e-2))
            print(f"\n{points}² nodes, H = {hurst}; a pair in single precision counts {fraction:.2f}\n")
            alone = area_control(height, options.areas, fraction)
            print()
            load_path(height, options.areas, alone, fraction)
            print()
            starts(height, *alone[-1], fraction)


if __name__ == "__main__":
    main()
