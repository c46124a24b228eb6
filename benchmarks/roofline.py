"""Rates of the main kernels beside the memory bandwidth and the floating-point rate of this machine.

    python benchmarks/roofline.py --points 2048 --out results/benchmarks

prints a table and writes it as ``roofline.csv``, and the machine and the versions of the programs as
``machine.csv``. Everything runs on one thread; times are the shortest processor times of some repetitions.
The bandwidth is that of a + s b, as in STREAM (McCalpin 1995); the floating-point rate is that of a product
of matrices in the BLAS of NumPy. A kernel counts the operations that its result needs, comparisons among
them, and the bytes that it has to read and write at least once if nothing stays in the caches; a transform
of n nodes counts 2.5 n log2 n operations, and reads and writes its field and its coefficients twice, once
for the rows and once for the columns.
"""

from __future__ import annotations

import argparse
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import numpy as np
import pandas as pd
import psutil
from contact_run import LAYER, load_on, rough
from numba import njit
from timing import seconds

import asperity as asp
from asperity.contact import kernels
from asperity.contact.preconditioner import inverse_stencil
from asperity.contact.stencil import StencilField, whole_stencil
from asperity.spectral import Fourier, Grid

STREAM_NODES = 2**24
MATRIX = 1536
PROGRAMS = ("numpy", "numba", "ducc0", "pyfftw")


@njit(cache=True, fastmath=True)
def _triad(a, b, s, out):
    for i in range(out.size):
        out[i] = a[i] + s * b[i]


def ceilings() -> list[tuple[str, str, float, float, float]]:
    """Name, precision, operations, bytes and seconds of the two measures of the machine."""
    rows = []
    a, b, out = (np.ones(STREAM_NODES) for _ in range(3))
    taken = seconds(lambda: _triad(a, b, 0.5, out))
    # The lines of the result are read before they are written.
    rows.append(("memory", "float64", 2.0 * a.size, 4.0 * a.nbytes, taken))
    for precision in ("float64", "float32"):
        one, two = (np.ones((MATRIX, MATRIX), precision) for _ in range(2))
        product = np.empty_like(one)
        taken = seconds(lambda x=one, y=two, z=product: np.matmul(x, y, out=z))
        rows.append(("matrix product", precision, 2.0 * MATRIX**3, 3.0 * one.nbytes, taken))
    return rows


def transforms(points: int) -> list[tuple[str, str, float, float, float]]:
    """Forward and inverse transforms in both precisions."""
    rows = []
    for precision in ("float64", "float32"):
        fourier = Fourier(Grid((points, points)), precision)
        field = np.random.default_rng(1).random(fourier.grid.shape, precision)
        modes = fourier.forward(field)
        operations, moved = 2.5 * field.size * np.log2(field.size), 4.0 * field.nbytes
        forward = seconds(lambda f=fourier, v=field, m=modes: f.forward(v, m))
        # The modes are those of the field again before each inverse transform, which overwrites them.
        both = seconds(lambda f=fourier, v=field, m=modes: f.inverse(f.forward(v, m), v, overwrite=True))
        rows.append(("forward transform", precision, operations, moved, forward))
        rows.append(("inverse transform", precision, operations, moved, both - forward))
    return rows


def contact_kernels(contact: asp.Contact) -> list[tuple[str, str, float, float, float]]:
    """The scan of all nodes for gaps below a level, and the stencil on the contact nodes."""
    height, displacement = contact.height.reshape(-1), contact.displacement.reshape(-1)
    none, free = np.empty(0, np.uint32), np.empty(-(-height.size // kernels.CHUNK), np.uint32)
    scan = seconds(lambda: kernels.mark_free_nodes_below(height, displacement, none, 0, -np.inf, free))
    nodes = np.flatnonzero(contact.pressure > 0).astype(np.uint32)
    field = StencilField(contact.grid, True)
    field.restrict(nodes)
    weights = whole_stencil(inverse_stencil(contact.grid))
    values, out = contact.pressure.reshape(-1)[nodes].astype(np.float32), np.empty(nodes.size, np.float32)
    product = seconds(lambda: field.apply(weights, values, out))
    used = 2.0 * np.count_nonzero(weights) / weights.shape[0]
    # Value, index and output; the field stays in the caches strip by strip.
    moved = 4.0 + 4.0 + 4.0
    return [
        ("scan of all gaps", "float64", 2.0 * height.size, 16.0 * height.size, scan),
        ("stencil on contact nodes", "float32", used * nodes.size, moved * nodes.size, product),
    ]


def peak_search(contact: asp.Contact) -> tuple[str, str, float, float, float]:
    """Search for the peaks of one plane of von Mises stress, two comparisons a node."""
    depth = 4 * contact.grid.spacing[0]
    (plane,) = asp.stress_planes(contact, [depth], fields=("von_mises",), tolerance=0)
    field = np.ascontiguousarray(plane.fields["von_mises"][0])
    taken = seconds(lambda: asp.plane_peaks(field, plane.grid))
    return ("peak search in a plane", field.dtype.name, 2.0 * field.size, float(field.nbytes), taken)


def table(points: int) -> pd.DataFrame:
    """Operations, bytes, seconds, intensity and rates of ceilings and kernels."""
    height = rough(points, 0.8)
    contact = asp.solve(height, LAYER, mean_pressure=load_on(height))
    rows = [*ceilings(), *transforms(points), *contact_kernels(contact), peak_search(contact)]
    found = pd.DataFrame(rows, columns=["kernel", "precision", "operations", "bytes", "seconds"])
    found["intensity"] = found["operations"] / found["bytes"]
    found["GFlop/s"] = found["operations"] / found["seconds"] / 1e9
    found["GB/s"] = found["bytes"] / found["seconds"] / 1e9
    found["points"] = points
    return found


def machine() -> pd.DataFrame:
    """What the benchmarks run on."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    model = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    facts = {
        "processor": (model or [platform.processor()])[0],
        "cores": f"{psutil.cpu_count()}",
        "memory": f"{psutil.virtual_memory().total / 2**30:.0f} GiB",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "asperity": asp.__version__,
    }
    for name in PROGRAMS:
        try:
            facts[name] = version(name)
        except PackageNotFoundError:
            facts[name] = "not installed"
    return pd.DataFrame(list(facts.items()), columns=["name", "value"])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=2048)
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    machine().to_csv(options.out / "machine.csv", index=False, lineterminator="\n")
    found = table(options.points)
    found.to_csv(options.out / "roofline.csv", index=False, float_format="%.4g", lineterminator="\n")
    print(found.to_string(index=False))


if __name__ == "__main__":
    main()
