"""Processor time and memory of `asperity run` on a map of 512² points in X3P, with all files and pictures.

    python benchmarks/own_map.py [--points 512]

The aim is at most 10 s and 1 GB, after a first run has compiled.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

DATA = Path(__file__).parents[1] / "tests" / "data"


def large_map(path: Path, points: int) -> None:
    """Write a ground surface of points² pixels of 1 µm as X3P, with a tilt, spikes and gaps."""
    sys.path.insert(0, str(DATA))
    import foreign_files
    import make_maps

    make_maps.SHAPE = (points, points)
    height, valid = make_maps.ground_steel()
    in_nanometres = {"type": "I", "increment": "1e-9", "pixel": "1e-6"}
    foreign_files.write_x3p(path, np.clip(height, -(2**15), 2**15 - 1), valid, **in_nanometres)


def measured(path: Path, out: Path) -> tuple[float, float]:
    """Processor time in s, and memory in MB, of the command."""
    given = ["--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "50 MPa", "--despike", "8"]
    command = [sys.executable, "-m", "asperity", "run", str(path), *given, "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        sys.exit("asperity run failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3


def main() -> None:
    """Print time and memory."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=512, help="points on an edge of the map")
    points = parser.parse_args().points
    with tempfile.TemporaryDirectory() as folder:
        large_map(Path(folder, "large.x3p"), points)
        measured(DATA / "steel.x3p", Path(folder, "first"))  # compiles
        seconds, megabytes = measured(Path(folder, "large.x3p"), Path(folder, "large"))
    print(f"{points} x {points} points: {seconds:.1f} s of processor time, {megabytes:.0f} MB")


if __name__ == "__main__":
    main()
