"""Time and memory of whole commands: a person waits for these.

    python benchmarks/commands.py run info seal sample sweep page --out results/benchmarks
    python benchmarks/commands.py study tests --out results/benchmarks    # 10 minutes more

Each writes a table of its name: wall time, processor time, largest memory of a process, and the wall
time that ``--check`` promises. A sample of three maps and a sweep are measured in turns with single runs. The
page is measured by tests/browser/test_times.py.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from measuring import alternately, paired, parser_of, write

import asperity as asp

sys.path.append(str(Path(__file__).parents[1] / "tests/data"))
import foreign_files

ROOT = Path(__file__).parents[1]
PAIRS, THICKNESSES, PLACES = 2, 8, 3
LOADS = [1, 2, 3, 5, 7, 10, 15, 20]
"""Mean pressures of the load curve of the seal, in MPa."""

STEEL = {"young": "210 GPa", "poisson": 0.3}
Row = dict[str, Any]


def spent(*command: object, folder: Path = ROOT) -> Row:
    """Wall and processor time, and largest memory of a process, of a command and its children."""
    with tempfile.TemporaryFile("w+") as output:
        load, begun = os.getloadavg()[0], time.perf_counter()
        process = subprocess.Popen([*map(str, command)], cwd=folder, stdout=output, stderr=output)
        _, status, used = os.wait4(process.pid, 0)
        if status:
            output.seek(0)
            sys.exit(output.read()[-4000:])
    row = {"wall": time.perf_counter() - begun, "seconds": used.ru_utime + used.ru_stime}
    return row | {"memory_GB": used.ru_maxrss * 1024 / 1e9, "load_average": load}


def asperity(*arguments: object, folder: Path) -> Row:
    """The same of a command of asperity."""
    return spent(sys.executable, "-m", "asperity", *arguments, folder=folder)


def promised(*arguments: object, folder: Path) -> float:
    """Wall time in s that ``--check`` states."""
    command = [sys.executable, "-m", "asperity", *map(str, arguments), "--check"]
    text = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    found = re.search(r"about ([\d.]+) (s|min)", text)
    assert found is not None, text
    return float(found[1]) * {"s": 1, "min": 60}[found[2]]


def write_map(path: Path, shape: tuple[int, int], seed: int = 1) -> str:
    """Write a part of a rough surface, with 2 µm between its points, as X3P; returns the name of the file."""
    edge = 2 * max(shape)
    height = asp.self_affine((edge, edge), 0.8, 1 / 8, 8 / edge, rms_height=4e-7, seed=seed)
    nanometres = np.rint(1e9 * height[: shape[0], : shape[1]]).astype(int)
    foreign_files.write_x3p(path, nanometres, type="I", increment="1e-9", pixel="2e-6")
    return path.name


def write_case(folder: Path, name: str, file: str, **groups: Any) -> str:
    """Write a case file of a map; returns its name."""
    case = {"map": {"file": file, "despike": 8}, "body": STEEL, "load": {"mean_pressure": "20 MPa"}} | groups
    (folder / name).write_text(yaml.safe_dump(case), encoding="utf-8")
    return name


def run(folder: Path) -> list[Row]:
    """``asperity run`` on a map of 512² points, with all files and pictures."""
    case = write_case(folder, "run.yaml", write_map(folder / "run.x3p", (512, 512)))
    promise = promised("run", case, folder=folder)
    rows = [asperity("run", case, folder=folder) for _ in range(3)]
    return [{"command": "asperity run, 512²", **least(rows), "promised": promise}]


def info(folder: Path) -> list[Row]:
    """``asperity info`` on a map of 1024² points."""
    file = write_map(folder / "info.x3p", (1024, 1024))
    rows = [asperity("info", file, folder=folder) for _ in range(3)]
    return [{"command": "asperity info, 1024²", **least(rows)}]


def seal(folder: Path) -> list[Row]:
    """Leakage under eight loads and the load that seals."""
    file = write_map(folder / "seal.x3p", (768, 1024))
    questions = {
        "counter_body": {"young": "1 GPa", "poisson": 0.4},
        "load_curve": {"loads": [f"{load} MPa" for load in LOADS[:-1]]},
        "leak": {"direction": "x", "viscosity": 0.03, "pressure_difference": "5 bar", "seal": True},
    }
    case = write_case(folder, "seal.yaml", file, **questions)
    promise = promised("run", case, folder=folder)
    row = asperity("run", case, folder=folder)
    return [
        {"command": "leakage under 8 loads and the load that seals, 768 × 1024", **row, "promised": promise}
    ]


def sample(folder: Path) -> list[Row]:
    """Three maps pooled, in turns with three runs one after the other."""
    files = [write_map(folder / f"place_{seed}.x3p", (512, 512), seed) for seed in range(1, PLACES + 1)]
    write_case(folder, "places.yaml", files[0])
    case = yaml.safe_load((folder / "places.yaml").read_text())
    del case["map"]["file"]
    (folder / "places.yaml").write_text(yaml.safe_dump(case))
    pooled = ("run", *files, "--case", "places.yaml", "--pooled")
    return in_turns(
        f"{PLACES} maps pooled, 512²",
        partial(asperity, *pooled, folder=folder),
        lambda: [asperity("run", file, "--case", "places.yaml", folder=folder) for file in files],
        promised(*pooled, folder=folder),
    )


def sweep(folder: Path) -> list[Row]:
    """A sweep of eight thicknesses of a coating, in turns with a single run."""
    layers = [{"thickness": "8 um", "young": "400 GPa", "poisson": 0.25}]
    given = {"body": STEEL | {"yield_stress": "2 GPa", "layers": layers}}
    file = write_map(folder / "sweep.x3p", (512, 512))
    one = write_case(folder, "one.yaml", file, **given)
    path = {"body.layers.0.thickness": {"from": "2 um", "to": "16 um", "steps": THICKNESSES}}
    several = write_case(folder, "sweep.yaml", file, **given, sweep={"values": path})
    return in_turns(
        f"sweep of {THICKNESSES} thicknesses of a coating, 512²",
        partial(asperity, "run", several, folder=folder),
        lambda: [asperity("run", one, folder=folder)],
        promised("run", several, folder=folder),
    )


def in_turns(
    name: str, whole: Callable[[], Row], single: Callable[[], list[Row]], promise: float
) -> list[Row]:
    """Rows of a whole command and of single ones, whose wall times are compared in turns."""
    wholes: list[Row] = []
    singles: list[Row] = []
    calls = (lambda: singles.append(least([total(single())])), lambda: wholes.append(whole()))
    times = alternately(calls, PAIRS, 600.0, time.perf_counter)
    return [
        {"command": name, **least(wholes), "promised": promise, **paired(*times.T)},
        {"command": f"single runs beside it: {name}", **least(singles)},
    ]


def total(rows: list[Row]) -> Row:
    """Sums of times, and the largest memory, of commands one after the other."""
    sums = {name: sum(row[name] for row in rows) for name in ("wall", "seconds")}
    return sums | {name: max(row[name] for row in rows) for name in ("memory_GB", "load_average")}


def least(rows: list[Row]) -> Row:
    """The row with the least wall time."""
    return min(rows, key=lambda row: row["wall"])


def page(folder: Path) -> list[Row]:
    """Steps on the page in a browser, least of two."""
    command = [sys.executable, "-m", "pytest", "-s", "-n", "0", "tests/browser/test_times.py"]
    found: dict[str, float] = {}
    for _ in range(PAIRS):
        given = os.environ | {"ASPERITY_NODES": "1024"}
        text = subprocess.run(command, cwd=ROOT, env=given, capture_output=True, text=True).stdout
        steps = re.findall(r"^(\S.*?) +([\d.]+) s$", text, re.MULTILINE)
        if not steps:
            sys.exit(text[-4000:])
        found |= {name: min(float(seconds), found.get(name, np.inf)) for name, seconds in steps}
    return [{"command": name, "wall": seconds} for name, seconds in found.items()]


def study(folder: Path) -> list[Row]:
    """``make study`` without its environment, ``make quick`` and a dry run, each into a new folder."""
    options = {
        "study of the paper": [],
        "quick study": ["--configfile", "config/quick.yaml"],
        "dry run": ["--dry-run", "--quiet"],
    }
    command = (sys.executable, "-m", "snakemake", "--cores", os.cpu_count(), "--nolock", "--config")
    return [
        {"command": name, **spent(*command, f"results={folder / name}", *given)}
        for name, given in options.items()
    ]


def tests(folder: Path) -> list[Row]:
    """All tests and lint, as ``make test``."""
    return [{"command": "make test", **spent("make", "test")}]


PARTS = {each.__name__: each for each in (run, info, seal, sample, sweep, page, study, tests)}


def main() -> None:
    """Measure parts, and write a table for each."""
    parser = parser_of(__doc__)
    parser.add_argument("parts", nargs="+", choices=PARTS)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        warm = write_case(Path(folder), "warm.yaml", write_map(Path(folder) / "warm.x3p", (64, 64)))
        asperity("run", warm, folder=Path(folder))  # compiles
        for name in options.parts:
            rows = PARTS[name](Path(folder))
            print(*rows, sep="\n", flush=True)
            write(rows, options.out / f"{name}.csv")


if __name__ == "__main__":
    main()
