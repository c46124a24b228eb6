"""Wall time of a contact on one thread and on two.

    python benchmarks/two_threads.py --points 4096

solves the same contact on one thread and on two alternately, in one process, so that other jobs on the
machine disturb both alike. It prints the shortest time of each, their ratio, and the median of the ratios of
consecutive runs. With ``--out`` the table is written to ``threads.csv`` of that folder.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import pandas as pd
from contact_run import SOLVER, TOLERANCE, compile_library, counted, load_on, rough, solver_of

PAIRS = 9


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=4096)
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--pairs", type=int, default=PAIRS, help="pairs of runs")
    parser.add_argument("--out", type=Path, help="folder of threads.csv")
    options = parser.parse_args()
    solvers = [solver_of(SOLVER, threads=threads) for threads in (1, 2)]
    compile_library(solvers[0], TOLERANCE)
    rows = []
    for hurst in options.hurst:
        height = rough(options.points, hurst)
        load = load_on(height)
        walls: tuple[list[float], list[float]] = [], []
        transforms: tuple[list[float], list[float]] = [], []
        for number in range(options.pairs + 1):
            for solver, wall, transform in zip(solvers, walls, transforms, strict=True):
                with counted() as spent:
                    start = time.perf_counter()
                    solver.solve(height, load, TOLERANCE)
                    taken = time.perf_counter() - start
                if number:  # the first pair finds no memory to use again
                    wall.append(taken)
                    transform.append(spent.wall)
        ratios = [one / two for one, two in zip(*walls, strict=True)]
        row = {
            "points": options.points,
            "hurst": hurst,
            "one": min(walls[0]),
            "two": min(walls[1]),
            "median_ratio": statistics.median(ratios),
            "transforms": min(transforms[0]) / min(transforms[1]),
            "load_average": os.getloadavg()[0],
            "date": time.strftime("%Y-%m-%d"),
        }
        rows.append(row)
        print(
            f"{options.points}² nodes, H = {hurst}: {row['one']:.2f} s on one thread, {row['two']:.2f} s on "
            f"two, ratio {row['one'] / row['two']:.2f}, median ratio {row['median_ratio']:.2f}, ratio of the "
            f"transforms {row['transforms']:.2f}, load {row['load_average']:.1f}",
            flush=True,
        )
    if options.out:
        pd.DataFrame(rows).to_csv(
            options.out / "threads.csv", index=False, float_format="%.4g", lineterminator="\n"
        )


if __name__ == "__main__":
    main()
