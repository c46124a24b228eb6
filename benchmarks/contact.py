"""Comparison of contact solvers: true error of the pressure against processor time and Fourier transforms.

One command writes a table, its numbers as CSV, and a figure:

    python benchmarks/contact.py --points 512 1024 2048 --out results/benchmarks

With ``--boundary free`` nothing surrounds the map, and pairs of transforms of the padded map count as three.
All runs use one thread and follow each other in one process. Times are processor times, which other work on
the machine disturbs less than wall times. Errors are relative L2 errors of the pressure, against a converged
reference: the active-set solver at an estimated error of 1e-10. Other programs are compared if they are
installed: `pip install 'asperity[peers]'`.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

import asperity as asp
from asperity.contact import solve
from asperity.elasticity.free_space import PaddedFourier
from asperity.elasticity.layer import Layer
from asperity.spectral import Fourier
from asperity.types import Array

Run = Callable[[float], tuple[Array, float]]
Tolerances = dict[str, tuple[float, ...]]

LAYER = Layer(1.0, 0.0)
REFERENCE_TOLERANCE = 1e-10

# Solvers with their precision, and the tolerances at which they run; other programs define theirs
# differently.
TOLERANCES: Tolerances = {
    "active_set float64": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
    "active_set float32": (1e-2, 1e-3, 1e-4),
    "gfmd float64": (1e-2, 1e-4, 1e-6),
    "gfmd float32": (1e-2, 1e-3),
    "tamaas": (1e-5, 1e-7, 1e-9),
    "ContactMechanics": (1e-3, 1e-5, 1e-7),
}


class Row(NamedTuple):
    """One run of a solver; `load` is the mean pressure over E* × rms gradient."""

    points: int
    hurst: float
    load: float
    solver: str
    tolerance: float
    error: float
    pairs: float
    seconds: float
    transform_seconds: float


@contextmanager
def transform_clock() -> Iterator[list[float]]:
    """Add up, in the only entry of the list, the processor time of all Fourier transforms."""
    total = [0.0]
    originals = [(kind, kind.forward, kind.inverse) for kind in (Fourier, PaddedFourier)]

    def timed(transform):
        def run(*arguments, **options):
            start = time.process_time()
            result = transform(*arguments, **options)
            total[0] += time.process_time() - start
            return result

        return run

    for kind, forward, inverse in originals:
        kind.forward, kind.inverse = timed(forward), timed(inverse)
    try:
        yield total
    finally:
        for kind, forward, inverse in originals:
            kind.forward, kind.inverse = forward, inverse


def solver_run(name: str, height: Array, load: float, boundary: str) -> Run | None:
    """Function that maps a tolerance to pressure and pairs of transforms; None if there is no such solver."""
    makers = {"tamaas": with_tamaas, "ContactMechanics": with_contact_mechanics}
    if name in makers:
        try:
            return makers[name](height, load, boundary)
        except ImportError:
            return None
    method, dtype = name.split()
    if method == "gfmd" and boundary == "free":
        return None

    def run(tolerance: float) -> tuple[Array, float]:
        contact = solve(
            height,
            LAYER,
            mean_pressure=load,
            boundary=boundary,
            method=method,
            dtype=dtype,
            rtol=tolerance,
        )
        return contact.pressure, contact.certificate.pairs

    return run


def with_tamaas(height: Array, load: float, boundary: str) -> Run:
    """Conjugate gradients of Polonsky & Keer in tamaas."""
    import tamaas

    tamaas.initialize(1)

    def run(tolerance: float) -> tuple[Array, float]:
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
        model.E, model.nu = 1.0, 0.0
        solver = tamaas.PolonskyKeerRey(model, -height, tolerance)
        if boundary == "free":
            tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
            solver.setIntegralOperator("dcfft")
        solver.max_iter = 20_000
        solver.dump_freq = 20_001
        solver.solve(load)
        return np.array(model.traction), np.nan

    return run


def with_contact_mechanics(height: Array, load: float, boundary: str) -> Run:
    """Conjugate gradients of Polonsky & Keer in ContactMechanics; tolerance: penetration over rms height."""
    from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace, make_system
    from SurfaceTopography import Topography

    def run(tolerance: float) -> tuple[Array, float]:
        free = boundary == "free"
        half_space = FreeFFTElasticHalfSpace if free else PeriodicFFTElasticHalfSpace
        substrate = half_space(height.shape, 1.0, (1.0, 1.0))
        topography = Topography(-height, physical_sizes=(1.0, 1.0), periodic=not free)
        system = make_system(substrate=substrate, surface=topography)
        result = system.minimize_proxy(
            external_force=load, pentol=tolerance * height.std(), thermotol=tolerance, maxiter=20_000
        )
        return np.asarray(result.jac) * height.size, np.nan

    return run


def measure(
    points: int, hurst: float, fraction: float, tolerances: Tolerances, boundary: str
) -> Iterator[Row]:
    """Run all solvers on one surface at one load, `fraction` × E* × rms gradient."""
    height = asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)
    load = fraction * asp.roughness_parameters(height).rms_gradient
    # Compile the library before the clock starts.
    for dtype in ("float64", "float32"):
        part = height[:64, :64].copy()
        solve(part, LAYER, mean_pressure=load, boundary=boundary, dtype=dtype, rtol=1e-2)
    truth = solve(height, LAYER, mean_pressure=load, boundary=boundary, rtol=REFERENCE_TOLERANCE).pressure
    for name, values in tolerances.items():
        run = solver_run(name, height, load, boundary)
        for tolerance in values if run is not None else ():
            with transform_clock() as transform_seconds:
                start = time.process_time()
                pressure, pairs = run(tolerance)
                seconds = time.process_time() - start
            error = float(np.linalg.norm(pressure - truth) / np.linalg.norm(truth))
            spent = transform_seconds[0] or np.nan
            yield Row(points, hurst, fraction, name, tolerance, error, pairs, seconds, spent)


def table(rows: list[Row]) -> str:
    """Markdown table of all runs."""
    lines = [
        "| points | H | load / (E* ḡ) | solver | tolerance | true error | pairs | seconds | / transforms |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        ratio = row.seconds / row.transform_seconds
        pairs = "" if np.isnan(row.pairs) else f"{row.pairs:.1f}"
        lines.append(
            f"| {row.points} | {row.hurst} | {row.load} | {row.solver} | {row.tolerance:.0e} "
            f"| {row.error:.1e} | {pairs} | {row.seconds:.2f} | {'' if np.isnan(ratio) else f'{ratio:.2f}'} |"
        )
    return "\n".join(lines)


def growth(rows: list[Row]) -> str:
    """Markdown table of the exponents of the number of nodes in time and pairs, smallest to largest grid."""
    lines = [
        "| H | load / (E* ḡ) | solver | tolerance | grids | time ~ nodes^ | pairs ~ nodes^ |",
        "|---" * 7 + "|",
    ]
    for key in dict.fromkeys((row.hurst, row.load, row.solver, row.tolerance) for row in rows):
        some = [row for row in rows if (row.hurst, row.load, row.solver, row.tolerance) == key]
        small, large = some[0], some[-1]
        if large.points <= small.points:
            continue
        nodes = 2 * np.log(large.points / small.points)
        powers = np.log([large.seconds / small.seconds, large.pairs / small.pairs]) / nodes
        hurst, load, solver, tolerance = key
        lines.append(
            f"| {hurst} | {load} | {solver} | {tolerance:.0e} | {small.points}² to {large.points}² "
            f"| {powers[0]:.2f} | {'' if np.isnan(powers[1]) else f'{powers[1]:.2f}'} |"
        )
    return "\n".join(lines) if len(lines) > 2 else ""


def plot(rows: list[Row], path: Path) -> None:
    """Plot the error on the largest grid against processor time and pairs, a row of panels for each load."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import LogLocator, NullFormatter

    largest = max(row.points for row in rows)
    rows = [row for row in rows if row.points == largest]
    loads, names = (sorted({row.load for row in rows}), list(dict.fromkeys(row.solver for row in rows)))
    figure, axes = plt.subplots(
        len(loads),
        2,
        figsize=(9, 1 + 3.2 * len(loads)),
        sharex="col",
        sharey=True,
        squeeze=False,
        layout="constrained",
    )
    for (left, right), load in zip(axes, loads, strict=True):
        for number, name in enumerate(names):
            for hurst, line in zip(sorted({row.hurst for row in rows}), ("-", "--"), strict=False):
                some = [row for row in rows if (row.solver, row.hurst, row.load) == (name, hurst, load)]
                error = [row.error for row in some]
                style = {
                    "color": f"C{number}",
                    "marker": "osD^v<"[number % 6],
                    "linestyle": line,
                    "label": f"{name}, $H$ = {hurst}",
                }
                left.loglog([row.seconds for row in some], error, **style)
                right.loglog([row.pairs for row in some], error, **style)
        left.set(ylabel="relative L2 error of the pressure")
        right.set_title(f"load {load} E* ḡ, {largest}² nodes", loc="right", fontsize="medium")
    for axis in (axes[-1, 0].xaxis, axes[-1, 1].xaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes[-1, 0].set(xlabel="processor time, s, one thread")
    axes[-1, 1].set(xlabel="pairs of transforms on the finest grid")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    figure.savefig(path, dpi=150)


def main() -> None:
    """Run the comparison; print and write its table, its numbers and its figure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, nargs="+", default=[256, 1024])
    parser.add_argument("--hurst", type=float, nargs="+", default=[0.2, 0.8])
    parser.add_argument("--load", type=float, nargs="+", default=[0.01, 0.05], help="mean pressure over E* ḡ")
    parser.add_argument("--boundary", default="periodic", choices=["periodic", "free"])
    parser.add_argument("--solver", nargs="+", default=list(TOLERANCES), choices=TOLERANCES)
    parser.add_argument(
        "--tolerance", type=float, nargs="+", help="of all solvers, instead of those listed in the script"
    )
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    options = parser.parse_args()
    tolerances = {name: tuple(options.tolerance or TOLERANCES[name]) for name in options.solver}
    rows: list[Row] = []
    for points in options.points:
        for hurst in options.hurst:
            for load in options.load:
                for row in measure(points, hurst, load, tolerances, options.boundary):
                    rows.append(row)
                    print(table([row]).splitlines()[-1], flush=True)
    exponents = growth(rows)
    print(exponents)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "contact.md").write_text(f"{table(rows)}\n\n{exponents}\n", encoding="utf-8")
    with (options.out / "contact.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Row._fields)
        writer.writerows(rows)
    plot(rows, options.out / "contact.png")


if __name__ == "__main__":
    main()
