"""Cost and accuracy of the stress in the whole solid: tables and a picture.

    python benchmarks/stress.py [--points 2048] [--hurst 0.8] [--threads 2] [--picture stress.png]
    python benchmarks/stress.py --grids 1024 2048 4096

With ``--grids`` it prints one table only: the whole analysis on each grid, in a process of its own on one
thread. The contact is solved first. A plane equivalent is the work of eight real transforms of the contact's
grid, one for each linear part of the stress; all transforms are counted by their nodes, those of the
covariances too. If tamaas is installed, its `boussinesq_gradient` and `hooke` compute the same planes for
comparison.
"""

import argparse
import json
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import one_thread  # noqa: F401

# isort: split

import ducc0
import numpy as np
from scipy.spatial import cKDTree

import asperity as asp
from asperity.elasticity.layer import COMPONENTS
from asperity.spectral import Fourier, Work, resample
from asperity.stress.planes import linear_planes
from asperity.system import peak_memory

QUANTITIES = ("pressure", "von_mises", "xx", "zz", "xz")
RATIOS = [0.0, 0.1, 0.25, 0.33, 0.5]


LAYER = asp.Layer(young=1.0, poisson=0.33)


def under(pressure, layer=LAYER):
    """A solid under a pressure on a unit cell."""
    return asp.PressedSolid(pressure, asp.Grid(pressure.shape), layer)


def press(points, hurst, short=8):
    """Contact of the study: λ_s = `short` spacings, λ_l = L/8, contact area a tenth."""
    height = asp.self_affine((points, points), hurst, 1 / 8, short / points, 1e-3, seed=1)
    return under(asp.solve(height, LAYER, area_fraction=0.1, rtol=1e-5).pressure)


def timed(call):
    """Result, wall time and processor time of a call."""
    wall, processor = time.perf_counter(), time.process_time()
    result = call()
    return result, time.perf_counter() - wall, time.process_time() - processor


class TransformClock:
    """Processor time of all Fourier transforms while it runs, in every thread."""

    NAMES = ("c2c", "r2c", "c2r")

    def __init__(self):
        self.seconds = []
        self._own = {name: getattr(ducc0.fft, name) for name in self.NAMES}

    def __enter__(self):
        for name, transform in self._own.items():
            setattr(ducc0.fft, name, self._timed(transform))
        return self

    def __exit__(self, *_):
        for name, transform in self._own.items():
            setattr(ducc0.fft, name, transform)

    def _timed(self, transform):
        def call(*arguments, **named):
            start = time.thread_time()
            result = transform(*arguments, **named)
            self.seconds.append(time.thread_time() - start)
            return result

        return call


def measure(path, tolerance, repeats):
    """The whole analysis under a pressure in a file: least processor time, its transforms, peak memory."""
    contact = under(np.load(path))
    settings = {"poisson": RATIOS, "quantities": QUANTITIES, "tolerance": tolerance}
    asp.analyse_stress(press_small(), **settings)
    before = 1e6 * peak_memory() / 2**30
    best = None
    for _ in range(repeats):
        work = Work()
        with TransformClock() as clock:
            data, _, processor = timed(lambda work=work: asp.analyse_stress(contact, **settings, work=work))
        if best is None or processor < best["processor"]:
            best = {"processor": processor, "transforms": sum(clock.seconds)}
    return best | {
        "planes": data.sizes["plane"],
        "equivalents": work.transforms(contact.grid) / 8,
        "memory": 1e6 * peak_memory() / 2**30,
        "before": before,
    }


def by_grid(grids, hurst, tolerance, repeats):
    """Table of the whole analysis by grid, each in a process of its own."""
    print(f"Whole slab, H = {hurst}, five ν, tolerance {tolerance}, one thread, least of {repeats} runs")
    columns = ("grid", "planes", "equivalents", "time", "transforms", "ratio", "memory", "before")
    print("  " + "".join(f"{name:>13}" for name in columns))
    with TemporaryDirectory() as folder:
        for points in grids:
            path = Path(folder) / f"{points}.npy"
            np.save(path, press(points, hurst).pressure)
            command = [sys.executable, __file__, "--measure", str(path), "--repeats", str(repeats)]
            command += ["--tolerance", str(tolerance)]
            found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            path.unlink()
            cells = (
                f"{points}²",
                found["planes"],
                f"{found['equivalents']:.1f}",
                f"{found['processor']:.2f} s",
                f"{found['transforms']:.2f} s",
                f"{found['processor'] / found['transforms']:.2f}",
                f"{found['memory']:.2f} GiB",
                f"{found['before']:.2f} GiB",
            )
            print("  " + "".join(f"{cell:>13}" for cell in cells), flush=True)
    print("  equivalents: all transforms, in planes of eight transforms of the grid; time: processor time;")
    print(
        "  ratio: time over that of all transforms in the same run; memory: peak of the process, with Python,"
    )
    print("  its libraries and the pressure; before: the same before the analysis began")


def in_full(contact, ratios, threads):
    """Processor and wall time of one plane of the analysis on the full grid, from three planes."""
    depths = np.array([0.0, 0.5, 1.0]) / contact.grid.shape[0]
    _, wall, processor = timed(
        lambda: asp.analyse_stress(contact, depths, ratios, QUANTITIES, tolerance=0, threads=threads)
    )
    return processor / depths.size, wall / depths.size


def whole_slab(contact, threads, tolerance):
    """Table of the cost of the whole analysis, against the same planes on the full grid."""
    asp.analyse_stress(
        press_small(), poisson=RATIOS, quantities=QUANTITIES, tolerance=tolerance, threads=threads
    )
    work = Work()
    data, wall, processor = timed(
        lambda: asp.analyse_stress(
            contact, poisson=RATIOS, quantities=QUANTITIES, tolerance=tolerance, threads=threads, work=work
        )
    )
    memory = 1e6 * peak_memory() / 2**30
    even = np.arange(contact.grid.shape[0] + 1) / contact.grid.shape[0]
    _, even_wall, even_processor = timed(
        lambda: asp.analyse_stress(contact, even, RATIOS, QUANTITIES, tolerance=tolerance, threads=threads)
    )
    every, every_wall = in_full(contact, RATIOS, threads)
    single, _ = in_full(contact, RATIOS[:1], threads)
    points, planes = contact.grid.shape[0], data.sizes["plane"]
    found = {name: asp.peaks(data, name, 0.33, "under_contact").sizes["peak"] for name in QUANTITIES[1:]}
    rows = [
        (
            "planes; the finest and the coarsest grid",
            f"{planes}; {points}², {data['plane_points'].values[-1]}²",
        ),
        ("plane equivalents of all transforms", f"{work.transforms(contact.grid) / 8:.1f}"),
        ("wall time, processor time", f"{wall:.1f} s, {processor:.1f} s"),
        ("the same analysis of one full plane", f"{every_wall:.2f} s, {every:.2f} s"),
        ("ratio: these planes in full", f"{planes * every / processor:.1f} (processor time)"),
        ("ratio: these planes in full, ν by ν", f"{len(RATIOS) * planes * single / processor:.1f}"),
        ("planes one spacing apart: wall, processor time", f"{even_wall:.1f} s, {even_processor:.1f} s"),
        ("ratio: the same in full", f"{even.size * every / even_processor:.0f}"),
        ("ratio: the same in full, ν by ν", f"{len(RATIOS) * even.size * single / even_processor:.0f}"),
        ("ratio: the same in full to the planes above", f"{even.size * every / processor:.0f}"),
        ("peak memory of this process", f"{memory:.2f} GiB"),
        ("peaks under contact, ν = 0.33", ", ".join(f"{name} {count}" for name, count in found.items())),
    ]
    for name, value in rows:
        print(f"  {name:50}{value}")
    return data


def press_small():
    """A small contact, to compile everything with before the clock starts."""
    y, x = asp.Grid((64, 64)).coordinates()
    return under(np.maximum(np.sin(40 * y)[:, None] * np.sin(40 * x)[None, :] - 0.5, 0))


def against_depth(contact, tolerance):
    """Error of coarse planes against full ones, its bound, and the cost, at a series of depths."""
    depths = np.array([0.0, *np.geomspace(1.0, 0.9 * contact.grid.shape[0], 12)]) / contact.grid.shape[0]
    rows = []
    coarse = linear_planes(contact, depths, tolerance=tolerance)
    full = linear_planes(contact, depths, tolerance=0)
    for near, far in zip(coarse, full, strict=True):
        modes = Fourier(near.grid).forward(near.constant["zz"])
        lifted = resample(modes, near.grid, far.grid)
        error = np.abs(Fourier(far.grid).inverse(lifted) - far.constant["zz"]).max()
        if near.grid == far.grid:
            error = 0.0
        scale = np.sqrt(np.mean(far.constant["zz"] ** 2))
        rows.append((far.depth, near.grid.shape[0], error / scale, near.bound / scale))
    print(f"  {'depth / spacing':>16}{'grid':>8}{'error':>12}{'bound':>12}{'cost':>12}")
    for depth, points, error, bound in rows:
        cost = (points / contact.grid.shape[0]) ** 2
        print(f"  {depth * contact.grid.shape[0]:16.1f}{points:8d}{error:12.1e}{bound:12.1e}{cost:12.1e}")
    return np.array(rows)


def against_tamaas(contact, depths, threads):
    """Stress tensor from two-plane volume models of tamaas: difference and processor time."""
    try:
        import tamaas
    except ImportError:
        print("  tamaas is not installed")
        return
    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(threads)
    grid, layer = contact.grid, contact.layer
    # Its shear stresses keep the Nyquist modes of even grids; the comparison leaves those modes out.
    modes = Fourier(grid).forward(contact.pressure)
    modes[2 * np.abs(grid.ky) == grid.shape[0]] = 0
    modes[:, 2 * grid.kx == grid.shape[1]] = 0
    smooth = under(Fourier(grid).inverse(modes), layer)
    theirs_time = ours_time = worst = 0.0
    for depth in depths:
        model = tamaas.ModelFactory.createModel(
            tamaas.model_type.volume_2d, [depth, *grid.length], [2, *grid.shape]
        )
        tamaas.ModelFactory.registerVolumeOperators(model)
        model.E, model.nu = layer.young, layer.poisson
        model.traction[...] = 0
        model.traction[..., 2] = smooth.pressure
        gradient, stress = (np.zeros([2, *grid.shape, 6]) for _ in range(2))

        def both(model=model, gradient=gradient, stress=stress):
            model.operators["boussinesq_gradient"](model.traction, gradient)
            model.operators["hooke"](gradient, stress)

        both()
        _, _, spent = timed(both)
        theirs_time += spent

        def ours(depth=depth):
            return list(asp.stress_planes(smooth, [0.0, depth], None, COMPONENTS, 0, threads))

        planes, _, spent = timed(ours)
        ours_time += spent
        root = np.sqrt(2.0)
        # Its first axis is our y, its z points downward, its shear components carry √2.
        factors = {
            "yy": (0, 1),
            "xx": (1, 1),
            "zz": (2, 1),
            "xy": (3, root),
            "yz": (4, -root),
            "xz": (5, -root),
        }
        for number, plane in enumerate(planes):
            for name, (place, factor) in factors.items():
                peer = stress[number, ..., place] / factor
                worst = max(worst, np.abs(peer - plane.fields[name][0]).max() / smooth.pressure.max())
    print(f"  largest difference of the tensor over the largest pressure   {worst:.1e}")
    print(f"  processor time of two full planes, theirs over ours          {theirs_time / ours_time:.1f}")


def convergence(hurst, wavelengths=32):
    """Von Mises peaks of one surface at λ_s/8, /16, /32: percentiles, and the rate peak by peak."""
    found = []
    for nodes in (8, 16, 32):
        contact = press(wavelengths * nodes, hurst, nodes)
        depths = asp.depth_grid(contact.grid, 0.25)
        peaks = asp.find_peaks(asp.stress_planes(contact, depths, 0.33, tolerance=1e-4), "von_mises")
        kept = peaks.interior & peaks.under_contact(contact.pressure, contact.grid)
        place = np.stack([peaks.y, peaks.x], axis=1)[kept] % 1.0
        found.append((place, peaks.value[kept]))
        shares = np.percentile(peaks.value[kept], [50, 90, 99])
        print(f"  λ_s/{nodes:<4}{np.sum(kept):8d}" + "".join(f"{value:12.5g}" for value in shares))
    changes = []
    for (coarse, values), (fine, others) in pairwise(found):
        distance, partner = cKDTree(fine, boxsize=1.0).query(coarse)
        same = distance < 0.25 / wavelengths
        changes.append(np.median(np.abs(values[same] / others[partner[same]] - 1)))
    print(f"  median change of a peak {changes[0]:.2e}, then {changes[1]:.2e}", end="")
    print(f": rate {np.log2(changes[0] / changes[1]):.2f}")


def spacing_study(contact):
    """Percentiles of the von Mises peaks at three distances between planes."""
    for spacing in (1.0, 0.5, 0.25):
        depths = asp.depth_grid(contact.grid, 0.05, spacing, 0.25 * spacing)
        peaks = asp.find_peaks(asp.stress_planes(contact, depths, 0.33, tolerance=1e-4), "von_mises")
        kept = peaks.interior & peaks.under_contact(contact.pressure, contact.grid)
        for label, values in (("refined", peaks.value), ("at nodes", peaks.node_value)):
            shares = np.percentile(values[kept], [50, 90, 99])
            print(f"  {spacing:<6}{label:10}{np.sum(kept):8d}" + "".join(f"{v:12.5g}" for v in shares))


def draw(rows, path, points):
    """Grid, error and cost of the planes against their depth."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    depth = np.maximum(rows[:, 0] * points, 0.5)
    figure = Figure(figsize=(7.5, 2.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    left.loglog(depth, rows[:, 1], "o-", color="#0072B2", markersize=4)
    left.set(ylabel="nodes on an edge")
    coarse = rows[:, 1] < points
    middle.loglog(depth[coarse], rows[coarse, 3], "s--", color="#D55E00", markersize=4, label="bound")
    middle.loglog(depth[coarse], rows[coarse, 2], "o-", color="#0072B2", markersize=4, label="error")
    middle.set(ylabel=r"largest error / rms $\sigma_{zz}$", ylim=(1e-12, 1e-2))
    middle.legend(frameon=False)
    right.loglog(depth, (rows[:, 1] / points) ** 2, "o-", color="#0072B2", markersize=4)
    right.set(ylabel="cost / full plane")
    for axis in (left, middle, right):
        axis.set(xlabel="depth / grid spacing")
    figure.savefig(path, dpi=200)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=2048)
    parser.add_argument("--hurst", type=float, default=0.8)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--pressure", help="an .npy file with the pressure instead of a solve")
    parser.add_argument("--picture", default="stress.png")
    parser.add_argument("--quick", action="store_true", help="leave out the convergence studies")
    parser.add_argument("--grids", type=int, nargs="+", help="print the table by grid only")
    parser.add_argument("--repeats", type=int, default=3, help="runs of which the table has the fastest")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.measure:
        print(json.dumps(measure(chosen.measure, chosen.tolerance, chosen.repeats)))
        return
    if chosen.grids:
        by_grid(chosen.grids, chosen.hurst, chosen.tolerance, chosen.repeats)
        return
    contact = under(np.load(chosen.pressure)) if chosen.pressure else press(chosen.points, chosen.hurst)
    points = contact.grid.shape[0]
    print(f"Whole slab at {points}², H = {chosen.hurst}, five ν, tolerance {chosen.tolerance}")
    print(f"  quantities: {', '.join(QUANTITIES)}")
    whole_slab(contact, chosen.threads, chosen.tolerance)
    print("Planes against depth")
    draw(against_depth(contact, chosen.tolerance), chosen.picture, points)
    print("tamaas, tensor of the surface and one depth on the full grid")
    against_tamaas(contact, [4.0 / points, 64.0 / points], chosen.threads)
    if chosen.quick:
        return
    for hurst in (0.2, 0.8):
        print(f"H = {hurst}: distance of planes, number and percentiles 50, 90, 99 of the von Mises peaks")
        spacing_study(press(512, hurst))
        print(f"H = {hurst}: convergence with the grid, number and percentiles 50, 90, 99")
        convergence(hurst)


if __name__ == "__main__":
    main()
