"""One run of one contact solver, in a process of its own, with its cost.

    python benchmarks/contact_run.py heights.npy --load 1e-3 --solver "active_set float64" --tolerance 1e-6

solves for the heights in a file and prints the cost as JSON; with ``--pressure FILE`` the pressure is written
too. `benchmarks/contact.py` starts one such process for each run, so that the peak of the memory is that of
the run alone. Other programs (`pip install 'asperity[peers]'`) solve the same problem with their own
definition of the tolerance.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import numpy as np
import psutil

import asperity as asp
from asperity.contact import Contact
from asperity.elasticity.free_space import PaddedFourier
from asperity.elasticity.layer import Layer
from asperity.spectral import Fourier, Grid
from asperity.system import peak_memory, reset_peak_memory
from asperity.types import Array

LAYER = Layer(1.0, 0.0)

# The run that other benchmarks look into: solver, tolerance, and mean pressure over E* ḡ.
SOLVER = "active_set float64"
TOLERANCE = 1e-6
FRACTION = 0.05

# Edge of the small contact that compiles the library before the clock starts; with half as many nodes the
# inner displacement would not be divided into a stencil and a coarser grid.
COMPILED_POINTS = 256

PAIRS_TIMED = 7

# A run is repeated so often, as long as all together take less than so many seconds; the shortest counts.
REPEATS = 3
SECONDS_TO_REPEAT = 10.0


class Transforms:
    """Work and time of all Fourier transforms while `counted` runs.

    Attributes
    ----------
    nodes : dict
        Precision → number of nodes transformed, those of coarser grids among them.
    by_grid : Counter
        Nodes of a grid and precision → number of nodes transformed.
    processor, wall : float
        Seconds in the transforms.
    """

    def __init__(self) -> None:
        self.nodes = {"float64": 0, "float32": 0}
        self.by_grid: Counter[tuple[int, str]] = Counter()
        self.processor = self.wall = 0.0


@contextmanager
def counted() -> Iterator[Transforms]:
    """Count and time the transforms of all grids."""
    total = Transforms()
    originals = [(kind, kind.forward, kind.inverse) for kind in (Fourier, PaddedFourier)]

    def watched(transform: Callable[..., Array]) -> Callable[..., Array]:
        def run(self: Fourier, *arguments: object, **options: object) -> Array:
            nodes, wall, processor = self.work.nodes, time.perf_counter(), time.process_time()
            result = transform(self, *arguments, **options)
            total.processor += time.process_time() - processor
            total.wall += time.perf_counter() - wall
            total.nodes[self.real.name] += self.work.nodes - nodes
            total.by_grid[self.grid.size, self.real.name] += self.work.nodes - nodes
            return result

        return run

    for kind, forward, inverse in originals:
        kind.forward, kind.inverse = watched(forward), watched(inverse)  # type: ignore[method-assign]
    try:
        yield total
    finally:
        for kind, forward, inverse in originals:
            kind.forward, kind.inverse = forward, inverse  # type: ignore[method-assign]


def pair_seconds(shape: tuple[int, int], threads: int = 1) -> dict[str, tuple[float, float]]:
    """Precision → shortest processor and wall time of a pair of transforms into memory that is kept.

    Pairs in double and single precision alternate, so that other work on the machine disturbs both.
    """
    transforms = {}
    for precision in ("float64", "float32"):
        fourier = Fourier(Grid(shape), precision, threads)
        field = np.random.default_rng(0).random(shape, precision)
        transforms[precision] = fourier, field, fourier.forward(field)
    best = dict.fromkeys(transforms, (np.inf, np.inf))
    for _ in range(PAIRS_TIMED):
        for precision, (fourier, field, coefficients) in transforms.items():
            processor, wall = time.process_time(), time.perf_counter()
            fourier.inverse(fourier.forward(field, coefficients), field, overwrite=True)
            taken = time.process_time() - processor, time.perf_counter() - wall
            best[precision] = tuple(map(min, zip(best[precision], taken, strict=True)))
    return best


class Asperity:
    """The solvers of this package."""

    def __init__(self, name: str, boundary: str, threads: int) -> None:
        method, dtype = name.split()
        self.settings = {"method": method, "dtype": dtype, "boundary": boundary, "threads": threads}
        self.program = f"asperity {asp.__version__}"

    def solve(self, height: Array, load: float, tolerance: float) -> Contact:
        return asp.solve(height, LAYER, mean_pressure=load, rtol=tolerance, **self.settings)

    def pressure(self, height: Array, load: float, tolerance: float) -> tuple[Array, float]:
        """Pressure and largest violation in its certificate."""
        contact = self.solve(height, load, tolerance)
        return contact.pressure, contact.certificate.worst


class Tamaas:
    """Conjugate gradients of Polonsky & Keer in tamaas."""

    def __init__(self, boundary: str, threads: int) -> None:
        import tamaas

        tamaas.initialize(threads)
        self._boundary, self._tamaas = boundary, tamaas
        self.program = f"tamaas {version('tamaas')}"

    def pressure(self, height: Array, load: float, tolerance: float) -> tuple[Array, float]:
        tamaas = self._tamaas
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
        model.E, model.nu = 1.0, 0.0
        solver = tamaas.PolonskyKeerRey(model, -height, tolerance)
        if self._boundary == "free":
            tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
            solver.setIntegralOperator("dcfft")
        solver.max_iter = 20_000
        solver.dump_freq = 20_001
        solver.solve(load)
        return np.array(model.traction), np.nan


class ContactMechanics:
    """Conjugate gradients of Polonsky & Keer in ContactMechanics; tolerance: penetration over rms height."""

    def __init__(self, boundary: str, threads: int) -> None:
        import ContactMechanics

        self._boundary, self._library = boundary, ContactMechanics
        self.program = f"ContactMechanics {version('ContactMechanics')}"

    def pressure(self, height: Array, load: float, tolerance: float) -> tuple[Array, float]:
        from SurfaceTopography import Topography

        library, free = self._library, self._boundary == "free"
        half_space = library.FreeFFTElasticHalfSpace if free else library.PeriodicFFTElasticHalfSpace
        substrate = half_space(height.shape, 1.0, (1.0, 1.0))
        topography = Topography(-height, physical_sizes=(1.0, 1.0), periodic=not free)
        system = library.make_system(substrate=substrate, surface=topography)
        result = system.minimize_proxy(
            external_force=load, pentol=tolerance * height.std(), thermotol=tolerance, maxiter=20_000
        )
        return np.asarray(result.jac) * height.size, np.nan


def solver_of(
    name: str, boundary: str = "periodic", threads: int = 1
) -> Asperity | Tamaas | ContactMechanics:
    """The solver of a name; ImportError if its program is not installed."""
    others = {"tamaas": Tamaas, "ContactMechanics": ContactMechanics}
    return others[name](boundary, threads) if name in others else Asperity(name, boundary, threads)


def rough(points: int, hurst: float) -> Array:
    """The rough surface of the comparisons: the longest wave L/8, the shortest eight nodes."""
    return asp.self_affine((points, points), hurst, 1 / 8, 8 / points, 1e-3, seed=1)


def load_on(height: Array, fraction: float = FRACTION) -> float:
    """Mean pressure of a fraction of E* ḡ, with ḡ the rms gradient of a surface."""
    return fraction * asp.roughness_parameters(height).rms_gradient


def compile_library(solver: Asperity, tolerance: float) -> None:
    """Solve small contacts of both kinds of surfaces, so that everything is compiled."""
    for hurst in (0.2, 0.8):
        solver.solve(rough(COMPILED_POINTS, hurst), 5e-3, tolerance)


def cost_of(
    solver: Asperity | Tamaas | ContactMechanics, height: Array, load: float, tolerance: float
) -> tuple[Array, dict[str, object]]:
    """Pressure, and the cost of the shortest of some runs by name."""
    if isinstance(solver, Asperity):
        compile_library(solver, tolerance)
    spent, best = 0.0, {"seconds": np.inf}
    for number in range(REPEATS):
        if number and spent * (number + 1) / number > SECONDS_TO_REPEAT:
            break
        before = psutil.Process().memory_info().rss
        reset_peak_memory()
        with counted() as transforms:
            wall, processor = time.perf_counter(), time.process_time()
            pressure, certificate = solver.pressure(height, load, tolerance)
            processor, wall = time.process_time() - processor, time.perf_counter() - wall
        spent += processor
        if not number:  # later runs find memory that this one has left
            memory = {
                "memory_GB": peak_memory() / 1e3,
                "bytes_per_node": (1e6 * peak_memory() - before) / height.size,
            }
        if processor < best["seconds"]:
            best = {"seconds": processor, "wall": wall, "transforms": transforms}
    transforms = best.pop("transforms")
    cost = best | memory
    cost |= {"program": solver.program, "certificate": certificate, "load_average": os.getloadavg()[0]}
    counts = sum(transforms.nodes.values()) > 0
    return pressure, cost | (transform_cost(transforms, height.shape, solver) if counts else {})


def transform_cost(
    transforms: Transforms, shape: tuple[int, int], solver: Asperity | Tamaas | ContactMechanics
) -> dict[str, object]:
    """Cost of the transforms by name, beside that of one pair of the grid in both precisions.

    `equivalents` are pairs of double precision of the finest grid: a transform of a coarser grid counts in
    proportion to its nodes, and one of single precision as the fraction of the time that it takes.
    """
    threads = solver.settings["threads"] if isinstance(solver, Asperity) else 1
    pairs_alone = pair_seconds(shape, threads)
    (double, double_wall), (single, _) = pairs_alone["float64"], pairs_alone["float32"]
    pairs = {name: nodes / (2 * shape[0] * shape[1]) for name, nodes in transforms.nodes.items()}
    return {
        "transform_seconds": transforms.processor,
        "transform_wall": transforms.wall,
        "pair_seconds": double,
        "pair_wall": double_wall,
        "single_fraction": single / double,
        "double_pairs": pairs["float64"],
        "single_pairs": pairs["float32"],
        "equivalents": pairs["float64"] + single / double * pairs["float32"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("heights", type=Path, help="an .npy file")
    parser.add_argument("--load", type=float, required=True, help="mean pressure over Young's modulus")
    parser.add_argument("--solver", default=SOLVER)
    parser.add_argument("--tolerance", type=float, default=TOLERANCE)
    parser.add_argument("--boundary", default="periodic", choices=["periodic", "free"])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pressure", type=Path, help="an .npy file to be written")
    options = parser.parse_args()
    solver = solver_of(options.solver, options.boundary, options.threads)
    pressure, cost = cost_of(solver, np.load(options.heights), options.load, options.tolerance)
    if options.pressure:
        np.save(options.pressure, pressure)
    print(json.dumps(cost))


if __name__ == "__main__":
    main()
