"""The engines of the Fourier transforms beside each other: time, planning, memory, accuracy, bits.

    python benchmarks/engines.py [--points 256 512 1024 2048 4096] [--scene 1024] [--folder results/engines]

Three variants take turns: ducc0, pyFFTW with estimated plans, and pyFFTW with plans that are measured here and
kept in the folder. A time is the shortest of some repetitions, in processor time on one thread; with two threads,
on the clock. The tables are in Markdown.
"""

import argparse
import hashlib
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from scipy import fft

from asperity.config.study import PAPER, read_study
from asperity.engines import fft_engine
from asperity.engines.choice import engine_of
from asperity.engines.wisdom import read_wisdom
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
    planning(sorted({*options.points, options.scene}), wisdom)
    transforms(options.points, wisdom)
    accuracy(options.scene, wisdom)
    reproducibility(options, wisdom)
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
    """Time to measure the plans of a calculation, and to make those of one grid from the file or by estimate."""
    rows = [("grid", "lengths", "measured in (s)", "from the file in (ms)", "estimated in (ms)")]
    for edge in points:
        texts = []
        seconds = spent(lambda edge=edge, texts=texts: texts.append(measure_plans([edge])))
        wisdom.write_text(texts[0])
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
    rows = [("grid", "precision", *VARIANTS, "two threads")]
    for edge in points:
        grid = Grid((edge, edge))
        for precision in PRECISIONS:
            pairs = [(Fourier(grid, precision, n, engine=e)) for n in (1, 2) for e in engines]
            values = np.random.default_rng(1).normal(size=grid.shape).astype(precision)
            modes, out = np.empty(grid.half_shape, pairs[0].complex), np.empty_like(values)
            seconds = np.full((len(pairs), 2), np.inf)
            for _ in range(max(REPETITIONS, 2**22 // grid.size)):
                for number, fourier in enumerate(pairs):
                    clock = time.process_time if fourier.threads == 1 else time.perf_counter
                    there = spent(lambda f=fourier: f.forward(values, modes), clock)
                    back = spent(lambda f=fourier: f.inverse(modes, out, overwrite=True), clock)
                    seconds[number] = np.minimum(seconds[number], (there, back))
            shown = [f"{1e3 * there:.3g} + {1e3 * back:.3g}" for there, back in seconds[:3]]
            gains = [f"{gain:.2f}" for gain in seconds[:3].sum(axis=1) / seconds[3:].sum(axis=1)]
            rows.append((f"{edge}²", precision, *shown, ", ".join(gains)))
    table("Forward + inverse transform (ms), and gain of two threads (of each variant)", *rows)


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
    """Fingerprints of a transform and its inverse, one for each number of threads."""
    values = np.random.default_rng(1).normal(size=(edge, edge))
    with fft_engine(*chosen):
        for threads in THREADS:
            fourier = Fourier(Grid(values.shape), threads=threads)
            modes = fourier.forward(values)
            yield hashlib.sha256(modes.tobytes() + fourier.inverse(modes).tobytes()).hexdigest()[:12]


def reproducibility(options, wisdom):
    """Number of different results in three processes, with 1 to 4 threads; and with plans measured three times."""
    rows = [("", *VARIANTS, "pyfftw measured anew")]
    found = [[part("bits", variant, options) for _ in range(3)] for variant in VARIANTS]
    anew = []
    for number in range(3):
        other = options.folder / f"anew{number}"
        other.mkdir(exist_ok=True)
        (other / wisdom.name).write_text(measure_plans([options.scene]))
        anew.append(part("bits", VARIANTS[-1], options, other))
    found.append(anew)
    rows.append(("threads 1 to 4", *(max(len({*each}) for each in runs) for runs in found)))
    rows.append(("three runs", *(len({each[0] for each in runs}) for runs in found)))
    table(f"Number of different results on {options.scene}² nodes, in double precision", *rows)


def scene(edge, chosen):
    """Processor times of a contact and its stress in the study, and the peak of the memory in MB."""
    config = read_study([PAPER])
    short = config["surfaces"][SURFACE]["wavelength_short"] * config["surfaces"][SURFACE]["points"] / edge
    parameters = {**config["surfaces"][SURFACE], "points": edge, "wavelength_short": short}
    contact = {**config["contact"], "path_area_fractions": []}
    with fft_engine(*chosen):
        for warm in (True, False):  # the first, small one loads the machine code
            size = 64 if warm else edge
            surface = make_surface(
                {**parameters, "points": size, **({"wavelength_short": 0.1} if warm else {})}, 1
            )
            reset_peak_memory()
            pressed, stress = [], []
            solving = spent(lambda s=surface, p=pressed: p.append(solve_contact(s, config["layer"], contact)))
            analysing = spent(
                lambda p=pressed, s=stress: s.append(compute_stress(p[0], config["layer"], config["stress"]))
            )
    return solving, analysing, peak_memory()


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
