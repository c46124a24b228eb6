"""Time, memory, transforms and true error of contact solvers by grid.

    python benchmarks/contact.py --points 512 1024 2048 --out results/benchmarks

Each row of the table is one run in a process of its own, kept in ``contact.csv`` of the folder in place of an
earlier one. Times are processor times on one thread, the least of up to seven runs. True errors are relative
L2 errors of the pressure, against the active-set solver at an estimated error of 1e-10; on grids larger than
``--largest-reference`` they are not known. Pairs of transforms are counted as in `asperity.Certificate`.

With ``--threads`` the contact is solved on one thread and on two alternately, and ``threads.csv`` is written.
"""

import argparse
import json
import os
import tempfile
import time
from collections.abc import Iterator
from importlib.metadata import version
from itertools import product
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads would count as processor time

import numpy as np
import pandas as pd
import peers
import psutil
from measuring import in_own_process, parser_of, peak_memory, reset_peak_memory

import asperity as asp
from asperity.core.types import Array

LAYER = asp.Solid(1.0, 0.0)
FRACTION = 0.05
"""Mean pressure over E* times the rms gradient, unless given: 0.005 touches on 1 % of the map."""

REFERENCE_TOLERANCE = 1e-10
COMPILED_POINTS = 256
"""Edge of the contacts that compile the solver before the clock starts."""

REPEATS, SECONDS_TO_REPEAT = 7, 10.0
"""A run is repeated while all together take less than so many seconds."""

# Solver → tolerances at which it runs, the largest grid for all of them, and the largest for the last one.
RUNS: dict[str, tuple[tuple[float, ...], int, int]] = {
    "active_set float64": ((1e-3, 1e-4, 1e-5, 1e-6), 2048, 16384),
    "active_set float32": ((1e-3, 1e-4), 2048, 4096),
    "gfmd float64": ((1e-3, 1e-5, 1e-7), 1024, 2048),
    "aspher": ((1e-5, 1e-6, 1e-7, 1e-8), 2048, 2048),
    "aspher h2": ((1e-5, 1e-6, 1e-7, 1e-8), 2048, 2048),
    "tamaas": ((1e-5, 1e-6), 512, 1024),
    "ContactMechanics": ((1e-3, 1e-5, 1e-7), 512, 512),
}

KEY = ["points", "hurst", "load", "boundary", "threads", "solver", "tolerance"]
COLUMNS = [
    *(*KEY, "program", "area", "error", "iterations", "pairs", "seconds", "wall"),
    *("memory_GB", "bytes_per_node", "load_average", "date"),
]


def rough(points: int, hurst: float) -> Array:
    """Rough surface with the longest wave L/8 and eight nodes on the shortest."""
    return asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)


def load_on(height: Array, fraction: float) -> float:
    """Mean pressure of the comparison."""
    return fraction * asp.roughness_parameters(height).rms_gradient


def solve(
    solver: str, height: Array, load: float, tolerance: float, boundary: str
) -> tuple[Array, float, float]:
    """Pressure of a solver, its iterations, and its pairs of transforms, which other programs do not tell."""
    if solver in peers.SOLVERS:
        return *peers.SOLVERS[solver](height, load, tolerance, boundary), np.nan
    method, dtype = solver.split()
    settings = {"method": method, "dtype": dtype, "boundary": boundary}
    contact = asp.solve_contact(height, LAYER, mean_pressure=load, rtol=tolerance, **settings)
    return contact.pressure, contact.certificate.iterations, contact.certificate.pairs


def run_once(options: argparse.Namespace) -> None:
    """Solve for the heights in a file, write the pressure beside it, and print the cost as JSON."""
    height, (solver,), (tolerance,) = np.load(options.run), options.solver, options.tolerance
    (boundary,), (fraction,) = options.boundary, options.fraction
    load, spent, cost = load_on(height, fraction), 0.0, {"seconds": np.inf}
    is_peer = solver in peers.SOLVERS
    if not is_peer:
        for hurst in (0.2, 0.8):
            solve(solver, rough(COMPILED_POINTS, hurst), 5e-3, tolerance, boundary)
    for number in range(REPEATS):
        if number and spent * (number + 1) / number > SECONDS_TO_REPEAT:
            break
        before = psutil.Process().memory_info().rss
        reset_peak_memory()
        wall, processor = time.perf_counter(), time.process_time()
        pressure, iterations, pairs = solve(solver, height, load, tolerance, boundary)
        processor, wall = time.process_time() - processor, time.perf_counter() - wall
        spent += processor
        if not number:  # later runs reuse memory that this one has freed
            added = (1e6 * peak_memory() - before) / height.size
            memory = {"memory_GB": peak_memory() / 1e3, "bytes_per_node": added}
        if processor < cost["seconds"]:
            cost = {"seconds": processor, "wall": wall, "iterations": iterations, "pairs": pairs}
    np.save(options.run.with_name("pressure.npy"), pressure)
    program = f"{solver} {version(solver.split()[0])}" if is_peer else f"asperity {asp.__version__}"
    print(json.dumps(cost | memory | {"program": program, "load_average": os.getloadavg()[0]}))


def measure(
    points: int, hurst: float, boundary: str, fraction: float, options: argparse.Namespace
) -> Iterator[dict[str, Any]]:
    """Run the solvers on one contact, each at its tolerances, in processes of their own."""
    height, truth = rough(points, hurst), None
    load = load_on(height, fraction)
    if points <= options.largest_reference:
        truth, _, _ = solve("active_set float64", height, load, REFERENCE_TOLERANCE, boundary)
    with tempfile.TemporaryDirectory() as folder:
        heights = Path(folder) / "heights.npy"
        np.save(heights, height)
        for solver in options.solver:
            tolerances, largest_of_all, largest = RUNS[solver]
            is_absent = solver in peers.SOLVERS and not peers.is_installed(solver)
            other_boundary = {"gfmd float64": "periodic", "aspher h2": "free"}.get(solver, boundary)
            if points > largest or is_absent or other_boundary != boundary:
                continue
            few = tolerances if points <= largest_of_all else tolerances[-1:]
            for tolerance in options.tolerance or few:
                given = ("--boundary", boundary, "--fraction", fraction, "--tolerance", tolerance)
                cost = in_own_process(__file__, "--run", heights, "--solver", solver, *given)
                key = points, hurst, fraction, boundary, 1, solver, tolerance
                row = dict(zip(KEY, key, strict=True)) | cost
                if truth is not None:
                    row["area"] = np.count_nonzero(truth) / truth.size
                    row["error"] = relative_error(np.load(heights.with_name("pressure.npy")), truth)
                yield row | {"date": time.strftime("%Y-%m-%d")}


def relative_error(pressure: Array, truth: Array) -> float:
    """L2 norm of the difference over the norm of the truth."""
    return float(np.linalg.norm(pressure - truth) / np.linalg.norm(truth))


def keep(row: dict[str, Any], path: Path) -> None:
    """Write a row to the table in a file, in place of an earlier one of the same run."""
    table = pd.DataFrame([row]).reindex(columns=COLUMNS)
    if path.exists():
        old = pd.read_csv(path)
        table = pd.concat([old, table]).drop_duplicates(KEY, keep="last").sort_values(KEY[:-1], kind="stable")
    table.to_csv(path, index=False, float_format="%.5g", lineterminator="\n")


def compare_threads(points: int, hurst: float, pairs: int = 9) -> dict[str, Any]:
    """Wall times of a contact on one thread and on two, alternately in one process."""
    height = rough(points, hurst)
    load, walls = load_on(height, FRACTION), np.empty((2, pairs + 1))
    for number in range(pairs + 1):
        for threads in (1, 2):
            start = time.perf_counter()
            asp.solve_contact(height, LAYER, mean_pressure=load, rtol=1e-6, threads=threads)
            walls[threads - 1, number] = time.perf_counter() - start
    one, two = walls[:, 1:]  # the first compiles and finds no memory to reuse
    times = {"one": one.min(), "two": two.min(), "ratio": float(np.median(one / two))}
    return {"points": points, "hurst": hurst, **times, "date": time.strftime("%Y-%m-%d")}


def main() -> None:
    """Run the comparison and keep its numbers."""
    parser = parser_of(__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=[256, 1024], help="nodes on an edge")
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--boundary", nargs="+", default=["periodic"], choices=["periodic", "free"])
    parser.add_argument(
        "--fraction", type=float, nargs="+", default=[FRACTION], help="mean pressure over E* × rms gradient"
    )
    parser.add_argument("--solver", nargs="+", default=list(RUNS), choices=RUNS)
    parser.add_argument("--tolerance", type=float, nargs="+", help="instead of those listed in the script")
    parser.add_argument("--threads", action="store_true", help="compare one thread with two instead")
    parser.add_argument("--largest-reference", type=int, default=4096)
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.run:
        run_once(options)
        return
    options.out.mkdir(parents=True, exist_ok=True)
    if options.threads:
        rows = [compare_threads(points, hurst) for points in options.points for hurst in options.hurst]
        table = pd.DataFrame(rows)
        print(table.to_string(index=False))
        table.to_csv(options.out / "threads.csv", index=False, float_format="%.4g", lineterminator="\n")
        return
    for case in product(options.points, options.hurst, options.boundary, options.fraction):
        for row in measure(*case, options):
            keep(row, options.out / "contact.csv")
            shown = ("area", "seconds", "memory_GB", "pairs", "error")
            numbers = ", ".join(f"{name} {row[name]:.3g}" for name in shown if name in row)
            print(*case, f"{row['solver']}, {row['tolerance']:g}: {numbers}", flush=True)


if __name__ == "__main__":
    main()
