"""Cost of the stress in the whole solid by grid, and its accuracy.

    python benchmarks/stress.py --points 1024 2048 4096 --threads 1 2 --out results/benchmarks
    python benchmarks/stress.py --accuracy
    python benchmarks/stress.py --layers --points 512

The first writes ``stress.csv``: the whole analysis on each grid and number of threads, in a process of its
own, with the load of the machine. A plane equivalent is the work of eight real transforms of the contact's
grid, one for each linear part of the stress; all transforms are counted by their nodes, also for the
covariances. The second prints error and bound of coarse planes by depth. The third
presses one coating and a stack of four layers in turns, and prints the time of contact and stress of both.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads would count as processor time

import numpy as np
import pandas as pd
from contact import rough
from measuring import in_own_process, parser_of, peak_memory

import asperity as asp
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Work, resample

RATIOS = [0.0, 0.1, 0.25, 0.33, 0.5]
LAYER = asp.Solid(young=1.0, poisson=0.33)
HURST = 0.8
TOLERANCE = 1e-4
REPEATS = 3


def under(pressure: Array) -> asp.LoadedSolid:
    """A half-space under a pressure on a unit cell."""
    return asp.LoadedSolid(pressure, asp.Grid(pressure.shape), LAYER)


def press(points: int) -> asp.LoadedSolid:
    """Contact at ten per cent area with eight nodes on the shortest wave, and the longest wave L/8."""
    return under(
        asp.solve_contact(rough(points, HURST), LAYER, contact_area_fraction=0.1, rtol=1e-5).pressure
    )


def measure_once(path: Path, threads: int) -> None:
    """Print the cost of the whole analysis under a pressure in a file, the least of some runs, as JSON."""
    contact, settings = under(np.load(path)), {"poisson": RATIOS, "tolerance": TOLERANCE, "threads": threads}
    y, x = asp.Grid((64, 64)).coordinates()
    small = np.maximum(np.sin(40 * y)[:, None] * np.sin(40 * x)[None, :] - 0.5, 0)
    asp.analyse_stress(under(small), **settings)  # compiles
    before, times, walls = peak_memory(), [], []
    for _ in range(REPEATS):
        work, start, begun = Work(), time.process_time(), time.perf_counter()
        data = asp.analyse_stress(contact, **settings, work=work, covariances=True)
        times.append(time.process_time() - start)
        walls.append(time.perf_counter() - begun)
    cost = {"planes": data.sizes["plane"], "equivalents": work.nodes / contact.grid.size / 8}
    cost |= {"seconds": min(times), "wall": min(walls), "load_average": os.getloadavg()[0]}
    cost |= {"memory_GiB": 1e6 * peak_memory() / 2**30, "before_GiB": 1e6 * before / 2**30}
    print(json.dumps(cost))


def measure(grids: list[int], threads: list[int], out: Path) -> None:
    """Measure the whole analysis by grid and threads, each in a process of its own, and keep the table."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for points in grids:
            path = Path(folder) / "pressure.npy"
            np.save(path, press(points).pressure)
            for count in threads:
                cost = in_own_process(__file__, "--run", path, "--threads", count)
                row = {"points": points, "threads": count, **cost}
                rows.append(row | {"date": time.strftime("%Y-%m-%d")})
                print(rows[-1], flush=True)
    out.mkdir(parents=True, exist_ok=True)
    table = pd.DataFrame(rows)
    table.to_csv(out / "stress.csv", index=False, float_format="%.3g", lineterminator="\n")


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


def against_coating(points: int) -> None:
    """Print the least times of contact and stress of a coating and of four layers, measured alternately."""
    base, moduli = asp.Solid(1.0, 0.3), (2.0, 0.5, 3.0, 1.5)
    solids = [asp.Solid.stack([(0.04, 2.0, 0.25)], base)]
    solids += [asp.Solid.stack([(0.01, young, 0.25) for young in moduli], base)]
    height, times = rough(points, HURST), np.full((REPEATS, 2, 2), np.inf)
    asp.analyse_stress(asp.solve_contact(rough(64, HURST), solids[1], contact_area_fraction=0.1))  # compiles
    for repeat, solid in np.ndindex(REPEATS, 2):
        begun = time.process_time()
        contact = asp.solve_contact(height, solids[solid], mean_pressure=0.01)
        solved = time.process_time()
        asp.analyse_stress(contact.in_body("lower"), tolerance=TOLERANCE)
        times[repeat, solid] = solved - begun, time.process_time() - solved
    for stage, both in zip(("contact", "stress"), times.min(0).T, strict=True):
        print(f"{stage}: {both[0]:.2f} s, four layers {both[1]:.2f} s, {both[1] / both[0]:.2f} times")
    total = times.sum(-1).min(0)
    print(f"both: {total[1] / total[0]:.2f} times")


def main() -> None:
    """Measure the cost, or print the tables of the accuracy."""
    parser = parser_of(__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=[1024], help="nodes on an edge")
    parser.add_argument("--threads", type=int, nargs="+", default=[1])
    parser.add_argument("--accuracy", action="store_true", help="print the tables of the accuracy instead")
    parser.add_argument("--layers", action="store_true", help="compare a stack with a coating instead")
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.run:
        measure_once(options.run, options.threads[0])
    elif options.layers:
        against_coating(options.points[0])
    elif not options.accuracy:
        measure(options.points, options.threads, options.out)
    else:
        against_depth(press(2048))


if __name__ == "__main__":
    main()
