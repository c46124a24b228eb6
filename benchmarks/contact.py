"""Comparison of contact solvers: time, memory, transforms and true error by grid.

    python benchmarks/contact.py --points 512 1024 2048 --out results/benchmarks

prints a table, a row for each run, and keeps the rows in ``contact.csv`` of the folder; a run that is there
already is replaced. Every run is a process of its own (`benchmarks/contact_run.py`), one after the other.
Errors are relative L2 errors of the pressure, against a converged reference: the active-set solver at an
estimated error of 1e-10. On larger grids than ``--largest-reference`` they are not known. With ``--boundary
free`` nothing surrounds the map, and a pair of transforms of the padded map counts as three.

Other programs are compared if they are installed (`pip install 'asperity[peers]'`), on grids up to `LARGEST`.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from contact_run import LAYER, load_on, rough

import asperity as asp
from asperity.types import Array

RUN = Path(__file__).with_name("contact_run.py")
REFERENCE_TOLERANCE = 1e-10

# Solvers with their precision, and the tolerances at which they run; other programs define theirs
# differently.
TOLERANCES: dict[str, tuple[float, ...]] = {
    "active_set float64": (1e-3, 1e-4, 1e-5, 1e-6),
    "active_set float32": (1e-3, 1e-4),
    "gfmd float64": (1e-3, 1e-5, 1e-7),
    "tamaas": (1e-5, 1e-6),
    "ContactMechanics": (1e-3, 1e-5, 1e-7),
}

# Nodes on an edge of the largest grid on which a solver runs at all its tolerances, and on which it runs at
# all. On larger grids than the first it runs at the last of its tolerances.
LARGEST = {
    "active_set float64": (2048, 16384),
    "active_set float32": (2048, 4096),
    "gfmd float64": (1024, 2048),
    "tamaas": (1024, 2048),
    "ContactMechanics": (1024, 1024),
}

KEY = ["points", "hurst", "load", "boundary", "threads", "solver", "tolerance"]
COLUMNS = [
    *KEY,
    *("program", "error", "certificate", "seconds", "wall", "memory_GB", "bytes_per_node"),
    *("transform_seconds", "transform_wall", "pair_seconds", "pair_wall", "single_fraction"),
    *("double_pairs", "single_pairs", "equivalents", "load_average", "date"),
]


def is_installed(solver: str) -> bool:
    """True if the program of a solver can be run here."""
    return solver not in ("tamaas", "ContactMechanics") or importlib.util.find_spec(solver) is not None


def tolerances_on(points: int, solver: str) -> tuple[float, ...]:
    """The tolerances at which a solver runs on a grid."""
    at_all_of_them, at_all = LARGEST[solver]
    values = TOLERANCES[solver]
    return values if points <= at_all_of_them else values[-1:] if points <= at_all else ()


def measure(points: int, hurst: float, fraction: float, options: argparse.Namespace) -> Iterator[dict]:
    """Run the solvers on one surface at one load, `fraction` × E* × rms gradient."""
    height = rough(points, hurst)
    load = load_on(height, fraction)
    truth = None
    if points <= options.largest_reference:
        settings = {"boundary": options.boundary, "rtol": REFERENCE_TOLERANCE}
        truth = asp.solve(height, LAYER, mean_pressure=load, **settings).pressure
    with tempfile.TemporaryDirectory() as folder:
        heights, pressure = Path(folder) / "heights.npy", Path(folder) / "pressure.npy"
        np.save(heights, height)
        del height
        for solver in options.solver:
            if not is_installed(solver) or (solver.startswith("gfmd") and options.boundary == "free"):
                continue
            tolerances = options.tolerance or tolerances_on(points, solver)
            for tolerance, threads in itertools.product(tolerances, options.threads):
                command = [sys.executable, str(RUN), str(heights), "--load", str(load), "--solver", solver]
                command += ["--tolerance", str(tolerance), "--boundary", options.boundary]
                command += ["--threads", str(threads)]
                if truth is not None:
                    command += ["--pressure", str(pressure)]
                run = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
                key = (points, hurst, fraction, options.boundary, threads, solver, tolerance)
                yield {
                    **dict(zip(KEY, key, strict=True)),
                    **json.loads(run.stdout.splitlines()[-1]),
                    "error": np.nan if truth is None else relative_error(np.load(pressure), truth),
                    "date": time.strftime("%Y-%m-%d"),
                }


def relative_error(pressure: Array, truth: Array) -> float:
    return float(np.linalg.norm(pressure - truth) / np.linalg.norm(truth))


def kept(row: dict, path: Path) -> None:
    """Write a row to the table in a file, in place of an earlier one of the same run."""
    new = pd.DataFrame([row]).reindex(columns=COLUMNS)
    if path.exists():
        old = pd.read_csv(path)
        same = np.logical_and.reduce([old[name] == row[name] for name in KEY])
        new = pd.concat([old[~same], new]) if not same.all() else new
    new = new.sort_values(KEY[:-1], kind="stable")
    new.to_csv(path, index=False, float_format="%.5g", lineterminator="\n")


def line(row: dict) -> str:
    """A row of the printed table."""
    shares = [row["seconds"] / row.get(name, np.nan) for name in ("transform_seconds", "pair_seconds")]
    cells = [
        f"{row['points']}",
        f"{row['hurst']}",
        f"{row['load']}",
        row["solver"] + (f", {row['threads']} threads" if row["threads"] > 1 else ""),
        f"{row['tolerance']:.0e}",
        f"{row['error']:.1e}",
        f"{row['seconds']:.2f}",
        f"{row['wall']:.2f}",
        f"{row['memory_GB']:.2f}",
        *(f"{row.get(name, np.nan):.1f}" for name in ("double_pairs", "single_pairs", "equivalents")),
        *(f"{share:.2f}" for share in shares),
    ]
    return f"| {' | '.join(cells)} |".replace(" nan ", "  ")


def main() -> None:
    """Run the comparison; print its table and keep its numbers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, nargs="+", default=[256, 1024])
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--load", type=float, nargs="+", default=[0.05], help="mean pressure over E* ḡ")
    parser.add_argument("--boundary", default="periodic", choices=["periodic", "free"])
    parser.add_argument("--solver", nargs="+", default=list(TOLERANCES), choices=TOLERANCES)
    parser.add_argument(
        "--tolerance", type=float, nargs="+", help="of all solvers, instead of those listed in the script"
    )
    parser.add_argument("--threads", type=int, nargs="+", default=[1])
    parser.add_argument(
        "--largest-reference", type=int, default=4096, help="largest grid with a converged reference"
    )
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| points | H | load / (E* ḡ) | solver | tolerance | true error | s | wall s | GB ", end="")
    print("| double pairs | single pairs | equivalents | / transforms | / one pair |")
    print("|---" * 14 + "|")
    for points in options.points:
        for hurst in options.hurst:
            for load in options.load:
                for row in measure(points, hurst, load, options):
                    kept(row, options.out / "contact.csv")
                    print(line(row), flush=True)


if __name__ == "__main__":
    main()
