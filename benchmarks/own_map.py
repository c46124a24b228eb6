"""From a measured map to an answer: the same steel in every file format, and the time for a map of 512².

``python benchmarks/own_map.py`` prints two tables. The first runs ``asperity run`` and the same in Python on
the files of ``tests/data``, which hold one surface. The second is the processor time and the memory of
``asperity run`` on a map of 512 × 512 points in X3P, compiled, with all files and pictures written: 10 s and
1 GB are allowed.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import asperity as asp

DATA = Path(__file__).parents[1] / "tests" / "data"
FILES = sorted(path.name for path in DATA.glob("steel*"))
NEEDED = {"steel.npy": {"unit": "um", "physical_size": ("80 um", "96 um"), "orientation": "peaks up"}}
"""Options for properties that a file does not state."""

NUMBERS = {
    "real contact": "1",
    "largest pressure": "Pa",
    "largest von Mises stress": "Pa",
    "approach since first touch": "m",
}
"""Rows of ``answer.csv`` that are compared."""

MOST_SECONDS, MOST_MEGABYTES = 10.0, 1000.0


def answer_in_python(name: str) -> dict[str, float]:
    """The numbers from `asperity.run`."""
    treated = {"file": DATA / name, "despike": 8, **NEEDED.get(name, {})}
    answer = asp.run(treated, asp.Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    frame = answer.frame().set_index("name")["value"]
    return {number: float(frame[number]) for number in NUMBERS}


def command(path: Path, out: Path, **needed: object) -> list[str]:
    """The command that gives the same answer."""
    given = ["--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "50 MPa", "--despike", "8"]
    for key, value in needed.items():
        given += ["--set", f"map.{key}={list(value) if isinstance(value, tuple) else value}"]
    return [sys.executable, "-m", "asperity", "run", str(path), *given, "--out", str(out)]


def answer_of_command(name: str, folder: Path) -> dict[str, float]:
    """The numbers from ``answer.csv`` of ``asperity run``."""
    out = folder / name
    subprocess.run(command(DATA / name, out, **NEEDED.get(name, {})), check=True, stdout=subprocess.DEVNULL)
    with open(out / "answer.csv", encoding="utf-8", newline="") as file:
        rows = {row["name"]: row["value"] for row in csv.DictReader(file)}
    return {number: float(rows[number]) for number in NUMBERS}


def print_families(folder: Path) -> None:
    """Print the answers of all files, by both interfaces."""
    print(f"{'file':<14}{'interface':<10}" + "".join(f"{name:>28}" for name in NUMBERS))
    for name in FILES:
        for interface, numbers in (
            ("command", answer_of_command(name, folder)),
            ("Python", answer_in_python(name)),
        ):
            print(f"{name:<14}{interface:<10}" + "".join(f"{value:>28.9g}" for value in numbers.values()))


def large_map(path: Path, points: int) -> None:
    """Write a ground surface of points² pixels of 1 µm as X3P, with a tilt, spikes and gaps."""
    sys.path.insert(0, str(DATA))
    import foreign_files
    import make_maps

    make_maps.SHAPE = (points, points)
    height, valid = make_maps.ground_steel()
    in_nanometres = {"type": "I", "increment": "1e-9", "pixel": "1e-6"}
    foreign_files.write_x3p(path, np.clip(height, -(2**15), 2**15 - 1), valid, **in_nanometres)


def print_time(folder: Path, points: int) -> None:
    """Print processor time and memory of the command, after a first run has compiled."""
    path = folder / "large.x3p"
    large_map(path, points)
    subprocess.run(command(DATA / FILES[0], folder / "first"), check=True, stdout=subprocess.DEVNULL)
    process = subprocess.Popen(command(path, folder / "large"), stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    seconds, megabytes = used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3
    print(
        f"\n{points} x {points} points: {seconds:.1f} s of processor time (at most {MOST_SECONDS:g}), "
        f"{megabytes:.0f} MB (at most {MOST_MEGABYTES:g})"
    )
    if status or seconds > MOST_SECONDS or megabytes > MOST_MEGABYTES:
        sys.exit("not reached")


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=512, help="points on an edge of the large map")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print_families(Path(folder))
        print_time(Path(folder), options.points)


if __name__ == "__main__":
    main()
