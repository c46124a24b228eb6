"""One contact on a large grid: the surface is made, solved and certified in one process.

    python benchmarks/large.py --points 16384

prints the time and the peak of the memory of each step and the certificate of the solution, with eight nodes
on the shortest wave, a mean pressure of 0.05 E* ḡ and an estimated error of 1e-6. With ``--out`` the
solution is a row in ``contact.csv`` of that folder, beside those of `benchmarks/contact.py`.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import psutil
from contact import KEY, kept
from contact_run import (
    FRACTION,
    SOLVER,
    TOLERANCE,
    compile_library,
    counted,
    load_on,
    rough,
    solver_of,
    transform_cost,
)

import asperity as asp
from asperity.system import peak_memory, reset_peak_memory


class Step:
    """Clock and peak of the memory of a step, printed at its end."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __enter__(self) -> Step:
        reset_peak_memory()
        self._memory_before = psutil.Process().memory_info().rss
        self._start = time.perf_counter(), time.process_time()
        return self

    def __exit__(self, *_: object) -> None:
        self.wall = time.perf_counter() - self._start[0]
        self.processor = time.process_time() - self._start[1]
        self.memory = peak_memory() / 1e3
        self.added_bytes = 1e9 * self.memory - self._memory_before
        print(
            f"{self.name:10}{self.wall:9.1f} s wall {self.processor:9.1f} s processor time "
            f"{self.memory:7.2f} GB ({self.memory * 1e9 / 2**30:.2f} GiB) at most",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=16384)
    parser.add_argument("--hurst", type=float, default=0.8)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder of contact.csv")
    options = parser.parse_args()
    points = options.points
    solver = solver_of(SOLVER, threads=options.threads)
    compile_library(solver, TOLERANCE)
    print(f"{points}² nodes, H = {options.hurst}, threads: {options.threads}; load {os.getloadavg()[0]:.1f}")
    with Step("surface"):
        height = rough(points, options.hurst)
    load = load_on(height)
    with Step("contact") as step, counted() as transforms:
        contact = solver.solve(height, load, TOLERANCE)
    print(f"transforms{transforms.wall:9.1f} s wall {transforms.processor:9.1f} s processor time")
    print(contact)
    for name, value in contact.certificate.violations.items():
        print(f"{name.replace('_', ' '):18}{value:.1e}")
    certificate = contact.certificate.worst
    del height, contact
    cost = transform_cost(transforms, (points, points), solver)
    print(
        f"{cost['double_pairs']:.1f} double and {cost['single_pairs']:.1f} single pairs: "
        f"{cost['equivalents']:.1f} double pairs of {cost['pair_seconds']:.2f} s each"
    )
    if options.out:
        key = (points, options.hurst, FRACTION, "periodic", options.threads, SOLVER, TOLERANCE)
        row = dict(zip(KEY, key, strict=True)) | cost
        row |= {"program": f"asperity {asp.__version__}", "seconds": step.processor, "wall": step.wall}
        row |= {"memory_GB": step.memory, "bytes_per_node": step.added_bytes / points**2}
        row |= {"certificate": certificate, "load_average": os.getloadavg()[0]}
        options.out.mkdir(parents=True, exist_ok=True)
        kept(row | {"date": time.strftime("%Y-%m-%d")}, options.out / "contact.csv")


if __name__ == "__main__":
    main()
