"""The page docs/performance.md, its numbers and its plots.

    python benchmarks/performance.py [--grids 512 1024 2048] [--parts contact roofline] [--page]

runs the benchmarks of all parts, or of those named, and writes the page from the tables that they leave in
docs/performance; with ``--page`` it only writes the page. Each part stands on the page with the command that
made its numbers, its date, and the load of the machine.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
from performance_page import FOLDER, PAGE, page
from performance_plots import draw

ROOT = Path(__file__).parents[1]
GRIDS = [512, 1024, 2048, 4096, 8192]
STRESS_GRIDS = [1024, 2048, 4096]
PARTS_GRIDS = [2048, 4096]
PATH_GRIDS = [1024, 2048]
THREADS_GRID = 4096
LARGE_GRID = 16384

PRINTED = ("large", "load_path", "stress")
"""Parts of which the page shows what they print."""


def commands(grids: list[int]) -> dict[str, str]:
    """Part of the page → the command that measures it, on grids no larger than the largest one given."""
    largest = max(grids)

    def some(points: list[int]) -> str:
        return " ".join(str(value) for value in points if value <= largest) or str(largest)

    threads = min(THREADS_GRID, largest)
    large = LARGE_GRID if largest >= GRIDS[-1] else 2 * largest
    out = f"--out {FOLDER.relative_to(ROOT)}"
    return {
        "roofline": f"python benchmarks/roofline.py {out}",
        "contact": f"python benchmarks/contact.py --points {' '.join(map(str, grids))} {out}",
        "contact_parts": f"python benchmarks/contact_parts.py --points {some(PARTS_GRIDS)} {out}",
        "threads": f"python benchmarks/two_threads.py --points {threads} {out}",
        "large": f"python benchmarks/large.py --points {large} {out}",
        "load_path": f"python benchmarks/load_path.py --points {some(PATH_GRIDS)}",
        "stress": f"python benchmarks/stress.py --grids {some(STRESS_GRIDS)}",
        "study": f"python benchmarks/study.py {out}",
    }


def run(part: str, command: str) -> None:
    """Run the command of a part; keep what it prints, and when and under which load it ran."""
    print(f"$ {command}", flush=True)
    load, start = os.getloadavg()[0], time.perf_counter()
    words = [sys.executable, *shlex.split(command)[1:]]
    process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    lines = []
    for line in process.stdout:  # type: ignore[union-attr]
        print(line, end="", flush=True)
        lines.append(line)
    if process.wait():
        sys.exit(f"{part}: the command ended with exit code {process.returncode}")
    if part in PRINTED:
        (FOLDER / f"{part}.txt").write_text("".join(lines), encoding="utf-8")
    row = {
        "part": part,
        "command": command,
        "date": time.strftime("%Y-%m-%d"),
        "minutes": f"{(time.perf_counter() - start) / 60:.1f}",
        "load_before": f"{load:.1f}",
        "load_after": f"{os.getloadavg()[0]:.1f}",
    }
    path = FOLDER / "commands.csv"
    table = pd.DataFrame([row])
    if path.exists():
        old = pd.read_csv(path)
        table = pd.concat([old[old["part"] != part], table])
    table.to_csv(path, index=False, lineterminator="\n")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grids", type=int, nargs="+", default=GRIDS, help="nodes on an edge")
    parser.add_argument("--parts", nargs="+", choices=commands(GRIDS), help="all by default")
    parser.add_argument("--page", action="store_true", help="write the page from the numbers that there are")
    options = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    if not options.page:
        every = commands(options.grids)
        for part in options.parts or every:
            run(part, every[part])
    draw(FOLDER)
    PAGE.write_text(page(FOLDER), encoding="utf-8")
    print(f"{PAGE.relative_to(ROOT)} written")


if __name__ == "__main__":
    main()
