"""The engines of the Fourier transforms beside each other: time, planning, memory, accuracy, bits.

    python benchmarks/engines.py [--points 256 512 1024 2048 4096] [--scene 1024] [--folder results/engines]

Three variants take turns: ducc0, pyFFTW with estimated plans, and pyFFTW with plans that are measured here
and kept in the folder. A fourth, for comparison, is FFTW's own measured plan for the whole array, aligned and
without normalisation. A time is the shortest of some repetitions, in processor time on one thread; the gain
of two threads is by the clock, and means something on an idle machine only. The tables are in Markdown.
"""

import argparse
import hashlib
import subprocess
import sys
import time
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import numpy as np
import pyfftw
from scipy import fft

from asperity.config.study import PAPER, read_study
from asperity.engines import fft_engine
from asperity.engines.choice import engine_of
from asperity.engines.wisdom import measure_wisdom, read_wisdom
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import make_surface
from asperity.pipeline.wisdom import lengths, measure_plans
from asperity.spectral import Fourier, Grid
from asperity.system import peak_memory, reset_peak_memory

PRECISIONS = ("float64", "float32")
VARIANTS = ("ducc0", "pyfftw estimated", "pyfftw measured")
THREADS = (1, 2, 3, 4)
REPETITIONS = 7
SURFACE = "hurst_08"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, nargs="+", default=[256, 512, 1024, 2048, 4096])
    parser.add_argument("--scene", type=int, default=1024, help="nodes on an edge of the contact")
    parser.add_argument("--folder", type=Path, default=Path("results/engines"))
    parser.add_argument("--run", nargs=2, metavar=("PART", "VARIANT"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    wisdom = options.folder / "wisdom.json"
    if options.run:
        part, variant = options.run
        print(*{"scene": scene, "bits": bits}[part](options.scene, choice(variant, wisdom)))
        return
    options.folder.mkdir(parents=True, exist_ok=True)
    planning(sorted({*options.points, options.scene, 2 * options.scene}), wisdom)
    transforms(options.points, wisdom)
    accuracy(options.scene, wisdom)
    reproducibility(options, wisdom)
    fftw_itself(options.scene // 2)
    scenes(options)


def choice(variant, wisdom):
    """Arguments of `fft_engine` for a variant."""
    return (variant.split()[0], *([wisdom] if variant.endswith("measured") else []))


def table(title, *rows):
    """Print a table whose first row is the heading."""
    first, *others = (f"| {' | '.join(map(str, row))} |" for row in rows)
    print("\n".join([f"{title}\n", first, "|" + "---|" * len(rows[0]), *others]), end="\n\n", flush=True)


def spent(call, clock=time.process_time):
    start = clock()
    call()
    return clock() - start


def planning(points, wisdom):
    """Time to measure the plans of a calculation, and to make those of its finest grid."""
    rows = [("grid", "grids planned", "measured in (s)", "from the file in (ms)", "estimated in (ms)")]
    for edge in points:
        seconds = spent(lambda edge=edge: wisdom.write_text(measure_plans([edge])))
        loaded = spent(lambda: read_wisdom(wisdom))
        made = [first_use(variant, wisdom, edge) for variant in VARIANTS[1:]]
        rows.append(
            (
                f"{edge}²",
                len(lengths(edge)),
                f"{seconds:.1f}",
                f"{1e3 * (loaded + made[1]):.1f}",
                f"{1e3 * made[0]:.1f}",
            )
        )
    wisdom.write_text(measure_plans(points))
    table("Plans of pyFFTW", *rows)


def first_use(variant, wisdom, edge):
    """Time that the first pair of transforms takes longer than the second, with an engine made for it."""
    engine = type(engine_of("pyfftw"))(read_wisdom(wisdom) if variant.endswith("measured") else None)
    fourier, values = Fourier(Grid((edge, edge)), engine=engine), np.zeros((edge, edge))
    first, *again = [
        spent(lambda: fourier.inverse(fourier.forward(values), overwrite=True)) for _ in range(4)
    ]
    return max(first - min(again), 0.0)


def transforms(points, wisdom):
    """Times of forward and inverse transforms into kept memory."""
    engines = [engine_of(*choice(variant, wisdom)) for variant in VARIANTS]
    rows = [("grid", "precision", *VARIANTS, "FFTW, whole array")]
    gains = [("grid", "precision", *VARIANTS)]
    for edge in points:
        for precision in PRECISIONS:
            grid = Grid((edge, edge))
            pairs = [Pair(Fourier(grid, precision, n, engine=e)) for n in (1, 2) for e in engines]
            turns = [*pairs, WholeArray(edge, precision)]
            for _ in range(max(REPETITIONS, 2**22 // edge**2)):
                for each in turns:
                    each.repeat()
            row = [" + ".join(f"{1e3 * least:.3g}" for least in each.least) for each in turns]
            rows.append((f"{edge}²", precision, *row[:3], row[-1]))
            clock = [one.clock / two.clock for one, two in zip(pairs[:3], pairs[3:], strict=True)]
            gains.append((f"{edge}²", precision, *(f"{gain:.2f}" for gain in clock)))
    table("Forward + inverse transform (ms)", *rows)
    table("Time on one thread over that on two", *gains)


class Pair:
    """A forward and an inverse transform, with the shortest processor times and time by the clock so far."""

    def __init__(self, fourier):
        grid = fourier.grid
        self.values = np.random.default_rng(1).normal(size=grid.shape).astype(fourier.real)
        self.modes, self.out = np.empty(grid.half_shape, fourier.complex), np.empty_like(self.values)
        self.fourier, self.least, self.clock = fourier, [np.inf, np.inf], np.inf

    def forward(self):
        self.fourier.forward(self.values, self.modes)

    def inverse(self):
        self.fourier.inverse(self.modes, self.out, overwrite=True)

    def repeat(self):
        start = time.perf_counter()
        found = spent(self.forward), spent(self.inverse)
        self.clock = min(self.clock, time.perf_counter() - start)
        self.least = [min(each) for each in zip(self.least, found, strict=True)]


class WholeArray(Pair):
    """The same by two-dimensional plans of FFTW."""

    def __init__(self, edge, precision):
        values = pyfftw.zeros_aligned((edge, edge), precision)
        modes = pyfftw.zeros_aligned((edge, edge // 2 + 1), np.result_type(precision, np.complex64))
        flags = ("FFTW_MEASURE", "FFTW_DESTROY_INPUT")
        self.forward = pyfftw.FFTW(values, modes, axes=(0, 1), flags=flags).execute
        backward = {"axes": (0, 1), "direction": "FFTW_BACKWARD", "flags": flags}
        self.inverse = pyfftw.FFTW(modes, values, **backward).execute
        values[:], modes[:] = 0, 0
        self.least, self.clock = [np.inf, np.inf], np.inf


def accuracy(edge, wisdom):
    """Rms errors of a forward transform of white noise, and of the field that comes back."""
    rows = [("precision", "transform", *VARIANTS)]
    for precision in PRECISIONS:
        values = np.random.default_rng(1).normal(size=(edge, edge)).astype(precision)
        exact = fft.rfft2(values.astype(np.longdouble), norm="forward")
        errors = []
        for variant in VARIANTS:
            fourier = Fourier(Grid(values.shape), precision, engine=engine_of(*choice(variant, wisdom)))
            modes = fourier.forward(values)
            back = fourier.inverse(modes)
            errors.append(
                (
                    float(np.linalg.norm(modes - exact) / np.linalg.norm(exact)),
                    float(np.linalg.norm(back - values) / np.linalg.norm(values)),
                )
            )
        for name, column in zip(("forward", "there and back"), zip(*errors, strict=True), strict=True):
            rows.append((precision, name, *(f"{error:.2g}" for error in column)))
    table(f"Rms error on {edge}² nodes, against extended precision", *rows)


def bits(edge, chosen):
    """Fingerprints of a transform and its inverse, one for each number of threads.

    On twice the nodes on an edge: small arrays are transformed by one thread.
    """
    values = np.random.default_rng(1).normal(size=(2 * edge, 2 * edge))
    with fft_engine(*chosen):
        for threads in THREADS:
            fourier = Fourier(Grid(values.shape), threads=threads)
            modes = fourier.forward(values)
            yield hashlib.sha256(modes.tobytes() + fourier.inverse(modes).tobytes()).hexdigest()[:12]


def reproducibility(options, wisdom):
    """Number of different results with 1 to 4 threads, in three runs, and with plans measured three times."""
    rows = [("", *VARIANTS, "pyfftw measured anew")]
    found = [[part("bits", variant, options) for _ in range(3)] for variant in VARIANTS]
    anew = []
    for number in range(3):
        other = options.folder / f"anew{number}"
        other.mkdir(exist_ok=True)
        (other / wisdom.name).write_text(measure_wisdom([2 * options.scene]))
        anew.append(part("bits", VARIANTS[-1], options, other))
    found.append(anew)
    rows.append(("threads 1 to 4", *(max(len({*each}) for each in runs) for runs in found)))
    rows.append(("three runs", *(len({each[0] for each in runs}) for runs in found)))
    table(f"Number of different results on {2 * options.scene}² nodes, in double precision", *rows)


def fftw_itself(edge):
    """Number of different results of FFTW itself: with its own threads, and for arrays at other addresses."""
    values = np.random.default_rng(1).normal(size=(edge, edge))
    modes = pyfftw.empty_aligned((edge, edge // 2 + 1), "complex128")
    memory = pyfftw.empty_aligned(values.nbytes + 64, "uint8")

    def result(flag, threads, start):
        pyfftw.forget_wisdom()
        source = memory[start : start + values.nbytes].view("float64").reshape(values.shape)
        plan = pyfftw.FFTW(source, modes, axes=(0, 1), flags=(flag,), threads=threads)
        source[:] = values
        plan.execute()
        return hashlib.sha256(modes.tobytes()).hexdigest()

    rows = [("plans", "1 to 4 threads, a plan for each", "array at a multiple of 16 bytes, or 8 beside it")]
    for name, flag in (("estimated", "FFTW_ESTIMATE"), ("measured", "FFTW_MEASURE")):
        of_threads = {result(flag, threads, 0) for threads in THREADS}
        rows.append((name, len(of_threads), len({result(flag, 1, start) for start in (0, 8)})))
    table(f"Number of different results of FFTW's own plans on {edge}² nodes", *rows)


def scene(edge, chosen):
    """Processor times of a contact and its stress in the study, and the peak of the memory in MB."""
    config = read_study([PAPER])
    found = config["surfaces"][SURFACE]
    contact = {**config["contact"], "path_area_fractions": []}
    with fft_engine(*chosen):
        for size in (64, edge):  # the first loads the machine code
            short = min(found["wavelength_short"] * found["points"] / size, found["wavelength_long"])
            surface = make_surface({**found, "points": size, "wavelength_short": short}, seed=1)
            reset_peak_memory()
            start = time.process_time()
            pressed = solve_contact(surface, config["layer"], contact)
            middle = time.process_time()
            compute_stress(pressed, config["layer"], config["stress"])
    return middle - start, time.process_time() - middle, peak_memory()


def scenes(options):
    """Costs of contact and stress, each in a process of its own."""
    found = {variant: np.full(3, np.inf) for variant in VARIANTS}
    for _ in range(3):
        for variant, least in found.items():
            least[:] = np.minimum(least, [float(text) for text in part("scene", variant, options)])
    first = found[VARIANTS[0]]
    rows = [("variant", "contact (s)", "stress (s)", "both, relative", "peak memory (MB)")]
    for variant, (solving, analysing, memory) in found.items():
        share = (solving + analysing) / first[:2].sum()
        rows.append((variant, f"{solving:.2f}", f"{analysing:.2f}", f"{share:.3f}", f"{memory:.0f}"))
    table(f"Contact and stress of surface {SURFACE} on {options.scene}² nodes, plans made before", *rows)


def part(name, variant, options, folder=None):
    """What a part of this benchmark prints, run with one variant in a process of its own."""
    command = [sys.executable, __file__, "--scene", str(options.scene), "--run", name, variant]
    folder = str(folder or options.folder)
    found = subprocess.run([*command, "--folder", folder], capture_output=True, text=True, check=True)
    return found.stdout.split()


if __name__ == "__main__":
    main()
