"""Cost of the stress in the whole solid by grid, and its accuracy.

    python benchmarks/stress.py --points 1024 2048 4096 --out results/benchmarks/stress.csv
    python benchmarks/stress.py --accuracy

The first writes the time of the whole analysis on each grid, on one thread and on two in turns, in a process
of its own. A plane equivalent is the work of eight real transforms of the contact's grid, one for each linear
part of the stress; all transforms are counted by their nodes, also for the covariances. The second prints
error and bound of coarse planes by depth.
"""

import json
import os
import time
from functools import partial
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads would count as processor time

import numpy as np
from contact import rough
from measuring import alternately, in_own_process, paired, parser_of, peak_memory, write

import asperity as asp
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Work, resample

RATIOS = [0.0, 0.1, 0.25, 0.33, 0.5]
LAYER = asp.Solid(young=1.0, poisson=0.33)
HURST = 0.8
TOLERANCE = 1e-4
MOST_PAIRS, SECONDS_OF_PAIRS = 3, 20.0


def under(pressure: Array) -> asp.LoadedSolid:
    """A half-space under a pressure on a unit cell."""
    return asp.LoadedSolid(pressure, asp.Grid(pressure.shape), LAYER)


def press(points: int) -> asp.LoadedSolid:
    """Contact at ten per cent area with eight nodes on the shortest wave, and the longest wave L/8."""
    return under(
        asp.solve_contact(rough(points, HURST), LAYER, contact_area_fraction=0.1, rtol=1e-5).pressure
    )


def measure(points: int) -> None:
    """Print the cost of the whole analysis on a grid as JSON."""
    contact, settings = press(points), {"poisson": RATIOS, "tolerance": TOLERANCE, "covariances": True}
    y, x = asp.Grid((64, 64)).coordinates()
    small = np.maximum(np.sin(40 * y)[:, None] * np.sin(40 * x)[None, :] - 0.5, 0)
    for threads in (1, 2):
        asp.analyse_stress(under(small), **settings, threads=threads)  # compiles
    works: list[Work] = []

    def analyse(threads: int) -> None:
        works.append(Work())
        asp.analyse_stress(contact, **settings, threads=threads, work=works[-1])

    calls = [partial(analyse, threads) for threads in (1, 2)]
    times = alternately(calls, MOST_PAIRS, SECONDS_OF_PAIRS, time.perf_counter)
    row = {
        "points": points,
        "equivalents": works[0].nodes / contact.grid.size / 8,
        "seconds": times[:, 0].min(),
        "two_threads": times[:, 1].min(),
        **paired(times[:, 1], times[:, 0]),
        "memory_GiB": 1e6 * peak_memory() / 2**30,
        "load_average": os.getloadavg()[0],
    }
    print(json.dumps(row))


def against_depth(contact: asp.LoadedSolid) -> None:
    """Print error and bound of coarse planes against full ones at a series of depths."""
    nodes = contact.grid.shape[0]
    depths = np.array([0.0, *np.geomspace(1.0, 0.9 * nodes, 12)]) / nodes
    coarse, full = (
        asp.stress_planes(contact, depths, fields=("zz",), tolerance=tolerance)
        for tolerance in (TOLERANCE, 0)
    )
    print(f"{'depth / spacing':>16}{'grid':>8}{'error':>12}{'bound':>12}")
    for near, far in zip(coarse, full, strict=True):
        modes = Fourier(near.grid).forward(near.fields["zz"][0])
        lifted = Fourier(far.grid).inverse(resample(modes, near.grid, far.grid))
        error = 0.0 if near.grid == far.grid else np.abs(lifted - far.fields["zz"][0]).max()
        scale = np.sqrt(np.mean(far.fields["zz"][0] ** 2))
        print(
            f"{far.depth * nodes:16.1f}{near.grid.shape[0]:8d}{error / scale:12.1e}{near.bound / scale:12.1e}"
        )


def main() -> None:
    """Measure the cost, or print the table of the accuracy."""
    parser = parser_of(__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=[1024], help="nodes on an edge")
    parser.add_argument("--accuracy", action="store_true", help="print the table of the accuracy instead")
    parser.add_argument("--out", type=Path, help="without it the rows are printed as JSON")
    options = parser.parse_args()
    if options.accuracy:
        against_depth(press(2048))
    elif options.out is None:
        for points in options.points:
            measure(points)
    else:
        each = (in_own_process(__file__, "--points", points) for points in options.points)
        write([row for rows in each for row in rows], options.out)


if __name__ == "__main__":
    main()
