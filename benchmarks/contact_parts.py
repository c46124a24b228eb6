"""Where the time of a contact goes: transforms, stencils, and passes over all nodes or the contact nodes.

    python benchmarks/contact_parts.py --points 2048 --out docs/performance

solves the same contact several times on one thread. Meanwhile a second thread looks every half millisecond at
the function that is at work, and adds the time since its last look to the part of the solver to which the
function belongs. The contact is then solved with inner displacements by transforms of the whole grid, in
place of a stencil and a coarser grid. With ``--out`` the tables are written to ``parts.csv`` and
``stencils.csv`` of that folder.
"""

from __future__ import annotations

import argparse
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import one_thread  # noqa: F401

# isort: split

import pandas as pd
from contact_run import SOLVER, TOLERANCE, compile_library, cost_of, load_on, rough, solver_of

import asperity as asp
from asperity.contact import inner_response

SECONDS = 10.0
INTERVAL = 5e-4

PARTS = {
    "engines": "transforms",
    "contact/stencil": "stencils of the compliance and of the preconditioner",
    "contact/even_nodes": "far field: to and from every second node",
    "contact/inner_response": "far field: to and from every second node",
    "contact/preconditioner": "coarse grid of the preconditioner",
    "contact/inner_solve": "vectors of the conjugate gradients",
    "contact/response": "products and copies of coefficients",
    "spectral": "products and copies of coefficients",
    "contact/iterate": "fields and gaps of all nodes",
    "contact/solver": "result and certificate",
    "contact/certificate": "result and certificate",
    "contact": "all else",
}
"""Folder or module of the library → part of the solver; the first that fits counts."""

PACKAGE = str(Path(asp.__file__).parent)


def part_of(frame: FrameType | None) -> str:
    """The part of the solver to which the innermost function of a stack belongs that has one."""
    while frame is not None:
        file = frame.f_code.co_filename
        if file.startswith(PACKAGE):
            module = Path(file).relative_to(PACKAGE).with_suffix("").as_posix()
            for start, part in PARTS.items():
                if f"{module}/".startswith(f"{start}/"):
                    return part
        frame = frame.f_back
    return PARTS["contact"]


@contextmanager
def watched(seconds: Counter[str]) -> Iterator[None]:
    """Add up the wall time of the parts in which the calling thread is."""
    caller, ended = threading.get_ident(), threading.Event()

    def watch() -> None:
        before = time.perf_counter()
        while not ended.wait(INTERVAL):
            part = part_of(sys._current_frames()[caller])
            now = time.perf_counter()
            seconds[part] += now - before
            before = now

    watcher = threading.Thread(target=watch)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(INTERVAL / 10)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
        sys.setswitchinterval(interval)


def seconds_of_parts(points: int, hurst: float) -> pd.DataFrame:
    """Seconds of each part in one solution."""
    solver, height = solver_of(SOLVER), rough(points, hurst)
    load = load_on(height)
    solver.solve(height, load, TOLERANCE)
    seconds: Counter[str] = Counter()
    runs, start = 0, time.perf_counter()
    with watched(seconds):
        while time.perf_counter() - start < SECONDS:
            solver.solve(height, load, TOLERANCE)
            runs += 1
    names = list(dict.fromkeys(PARTS.values()))
    found = {"part": names, "seconds": [seconds[name] / runs for name in names]}
    return pd.DataFrame(found | {"points": points, "hurst": hurst})


def without_stencils(points: int, hurst: float) -> pd.DataFrame:
    """Cost of a solution with inner displacements by stencils, and without them."""
    solver, height = solver_of(SOLVER), rough(points, hurst)
    least, rows = inner_response.MIN_POINTS, []
    for uses_stencils in (True, False):
        inner_response.MIN_POINTS = least if uses_stencils else 2 * points
        _, cost = cost_of(solver, height, load_on(height), TOLERANCE)
        names = "seconds", "transform_seconds", "equivalents"
        rows.append(
            {"points": points, "hurst": hurst, "stencils": uses_stencils} | {n: cost[n] for n in names}
        )
    inner_response.MIN_POINTS = least
    return pd.DataFrame(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, nargs="+", default=[2048])
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--out", type=Path, help="folder of the tables")
    options = parser.parse_args()
    compile_library(solver_of(SOLVER), TOLERANCE)
    tables = [seconds_of_parts(points, hurst) for points in options.points for hurst in options.hurst]
    for table in tables:
        print(f"{table['points'][0]}² nodes, H = {table['hurst'][0]}, {table['seconds'].sum():.3f} s")
        print(table[["part", "seconds"]].round(4).to_string(index=False), flush=True)
    compared = pd.concat(
        without_stencils(points, hurst) for points in options.points for hurst in options.hurst
    )
    print(compared.round(4).to_string(index=False))
    if options.out:
        for name, table in (("parts", pd.concat(tables)), ("stencils", compared)):
            path = options.out / f"{name}.csv"
            table.to_csv(path, index=False, float_format="%.4g", lineterminator="\n")


if __name__ == "__main__":
    main()
