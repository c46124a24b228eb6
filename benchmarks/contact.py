"""Contact solvers at equal true error, beside other programs, and the time and memory of asperity by grid.

    python benchmarks/contact.py rivals --out results/benchmarks/rivals.csv
    python benchmarks/contact.py grids --out results/benchmarks/grids.csv

A contact is solved by each program at its loosest tolerance whose pressure has a true relative L2 error of at
most the target of the case, in one process and in turns with asperity at its own loosest such tolerance; the
ratio of the processor times on one thread has a 95 % interval. The modes in single precision are compared at
their own true errors. Truth is a solution at an estimated error of 1e-10. Each case has a process of its own.
"""

import json
import os
import sys
import time
from collections.abc import Iterator
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")  # waiting threads would count as processor time
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import peers
import psutil
from measuring import (
    alternately,
    in_own_process,
    paired,
    parser_of,
    peak_memory,
    reset_peak_memory,
    write,
)

import asperity as asp
from asperity.core.types import Array

LAYER = asp.Solid(1.0, 0.0)
FRACTION = 0.05
"""Mean pressure over E* times the rms gradient: it touches on 11 to 12 % of the map."""

LOADS = (5e-5, 5e-4, 5e-3, FRACTION, 0.4)
"""The same for contacts of 0.014 to 65 % of the area."""

TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7)
"""Of asperity, in turns with other programs."""

REFERENCE_TOLERANCE, DEFAULT_TOLERANCE = 1e-10, 1e-6
MOST_PAIRS, SECONDS_OF_PAIRS = 5, 10.0

GFMD, SINGLE = "GFMD (asperity)", "ASPHER, single precision"
RIVALS: dict[str, tuple[float, ...]] = {
    GFMD: (1e-5, 1e-6, 1e-7),
    "ASPHER": (1e-5, 1e-6, 1e-7, 1e-8),
    "ASPHER, candidate nodes": (1e-5, 1e-6, 1e-7, 1e-8),
    SINGLE: (4, 6, 8),
    "tamaas": (1e-5, 1e-6, 1e-7),
    "ContactMechanics": (1e-5, 1e-6, 1e-7),
}
"""Program → its tolerances; of the mode in single precision orders of its sums, each of which is compared."""


class Case(NamedTuple):
    """A contact on which programs are compared at a true error."""

    points: int
    hurst: float
    boundary: str
    fraction: float
    target: float
    rivals: tuple[str, ...]


CANDIDATES = ("ASPHER", "ASPHER, candidate nodes", SINGLE)
CASES = [
    Case(512, 0.2, "periodic", FRACTION, 1e-6, (GFMD, "ASPHER")),
    Case(512, 0.8, "periodic", FRACTION, 1e-6, (GFMD, "ASPHER", "tamaas", "ContactMechanics")),
    Case(1024, 0.2, "periodic", FRACTION, 1e-6, (GFMD, "ASPHER")),
    Case(1024, 0.8, "periodic", FRACTION, 1e-6, (GFMD, "ASPHER")),
    Case(512, 0.8, "free", FRACTION, 1e-6, ("ASPHER",)),
    *(Case(1024, 0.8, "periodic", load, 1e-5, ("ASPHER",)) for load in LOADS),
    *(Case(1024, 0.8, "free", load, 1e-5, CANDIDATES) for load in LOADS[:3]),
    *(Case(512, 0.8, "free", load, 1e-5, ("ASPHER",)) for load in LOADS[3:]),
]

GRIDS = [(512, 0.2), (512, 0.8), (1024, 0.2), (1024, 0.8), (2048, 0.2), (2048, 0.8), (4096, 0.8)]
LARGEST_REFERENCE = 2048
COMPILED_POINTS = 256
"""Edge of the contacts that compile the solver before the clock starts."""


def rough(points: int, hurst: float) -> Array:
    """Rough surface with the longest wave L/8 and eight nodes on the shortest."""
    return asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)


def load_on(height: Array, fraction: float) -> float:
    """Mean pressure of the comparison."""
    return fraction * asp.roughness_parameters(height).rms_gradient


def own(height: Array, load: float, tolerance: float, boundary: str, **settings: Any) -> asp.Contact:
    """The contact by asperity."""
    return asp.solve_contact(height, LAYER, mean_pressure=load, rtol=tolerance, boundary=boundary, **settings)


def solve(program: str, height: Array, load: float, setting: float, boundary: str) -> Array:
    """Pressure by another program."""
    if program == GFMD:
        return own(height, load, setting, boundary, method="gfmd").pressure
    return peers.SOLVERS[program](height, load, setting, boundary)


def relative_error(pressure: Array, truth: Array) -> float:
    """L2 norm of the difference over the norm of the truth."""
    return float(np.linalg.norm(pressure - truth) / np.linalg.norm(truth))


def compare(case: Case) -> Iterator[dict[str, Any]]:
    """Rows of all programs on one contact."""
    for hurst in (0.2, 0.8):  # compiles
        small = rough(COMPILED_POINTS, hurst)
        own(small, load_on(small, case.fraction), 1e-6, case.boundary)
    height = rough(case.points, case.hurst)
    load = load_on(height, case.fraction)
    truth = own(height, load, REFERENCE_TOLERANCE, case.boundary).pressure
    errors = {
        each: relative_error(own(height, load, each, case.boundary).pressure, truth) for each in TOLERANCES
    }
    for program in case.rivals:
        if program != GFMD and not peers.is_installed(program):
            continue
        for setting in RIVALS[program]:
            theirs = partial(solve, program, height, load, setting, case.boundary)
            error = relative_error(theirs(), truth)
            if program != SINGLE and error > case.target:
                continue
            target = max(error, errors[TOLERANCES[-1]]) if program == SINGLE else case.target
            tolerance = next(each for each, found in errors.items() if found <= target)
            ours = partial(own, height, load, tolerance, case.boundary)
            times = alternately((ours, theirs), MOST_PAIRS, SECONDS_OF_PAIRS, time.process_time)
            yield {
                **dict(zip(Case._fields[:-1], case[:-1], strict=True)),
                "area": np.count_nonzero(truth) / truth.size,
                "program": program,
                "version": asp.__version__ if program == GFMD else version(program.split(",")[0]),
                "setting": setting,
                "error": error,
                "seconds": float(np.median(times[:, 1])),
                "own_tolerance": tolerance,
                "own_error": errors[tolerance],
                "own_seconds": float(np.median(times[:, 0])),
                **paired(*times.T),
                "load_average": os.getloadavg()[0],
            }
            if program != SINGLE:
                break


def on_grid(points: int, hurst: float) -> Iterator[dict[str, Any]]:
    """Time, memory and error of asperity at its default tolerance, and its time on one thread and on two."""
    small = rough(COMPILED_POINTS, hurst)
    for threads in (1, 2):
        own(small, load_on(small, FRACTION), DEFAULT_TOLERANCE, "periodic", threads=threads)
    height = rough(points, hurst)
    given = height, load_on(height, FRACTION), DEFAULT_TOLERANCE, "periodic"
    before = psutil.Process().memory_info().rss
    reset_peak_memory()
    start = time.process_time()
    contact = own(*given)
    seconds, memory = time.process_time() - start, 1e6 * peak_memory()  # later runs reuse freed memory
    times = alternately(
        [partial(own, *given, threads=threads) for threads in (1, 2)], 7, SECONDS_OF_PAIRS, time.perf_counter
    )
    error = np.nan
    if points <= LARGEST_REFERENCE:
        error = relative_error(contact.pressure, own(*given[:2], REFERENCE_TOLERANCE, "periodic").pressure)
    yield {
        "points": points,
        "hurst": hurst,
        "seconds": min(seconds, times[:, 0].min()),
        "transforms": contact.certificate.pairs,
        "error": error,
        "memory_GB": memory / 1e9,
        "bytes_per_node": (memory - before) / height.size,
        "two_threads": times[:, 1].min(),
        **paired(times[:, 1], times[:, 0]),
        "load_average": os.getloadavg()[0],
    }


def main() -> None:
    """Measure a part, each case in a process of its own, and write its table."""
    parser = parser_of(__doc__)
    parser.add_argument("part", choices=["rivals", "grids"])
    parser.add_argument("--out", type=Path)
    parser.add_argument("--largest", type=int, default=4096, help="nodes on an edge of the largest grid")
    parser.add_argument("--case", type=int, help="print the rows of one case as JSON")
    options = parser.parse_args()
    measure, every = {"rivals": (lambda *case: compare(Case(*case)), CASES), "grids": (on_grid, GRIDS)}[
        options.part
    ]
    if options.case is not None:
        for row in measure(*every[options.case]):
            print(json.dumps(row), flush=True)
        return
    if options.part == "rivals" and not any(map(peers.is_installed, peers.SOLVERS)):
        sys.exit("no other program is installed: pip install '.[peers]'")
    rows = []
    for number, case in enumerate(every):
        if case[0] <= options.largest:
            for row in in_own_process(__file__, options.part, "--case", number):
                print({name: row[name] for name in row if name != "load_average"}, flush=True)
                rows.append(row)
    write(rows, options.out)


if __name__ == "__main__":
    main()
