"""Measures speed and memory, and writes the tables of the supplement and their summary, docs/performance.md.

    python benchmarks/page.py [--grids 512 1024 2048] [--parts contact stress] [--page]

runs the benchmarks of all parts, or of those named, and writes both pages from the tables that they keep in
paper/supplement/performance; with ``--page`` it writes the pages alone.
"""

import os
import platform
import shlex
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd
import psutil
from contact import FRACTION
from measuring import parser_of

from asperity.core.markup import markdown
from asperity.study.small_studies import rendered
from asperity.views.style import panels, save, style

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "paper/supplement/performance"
PAGES = {"performance": FOLDER.with_suffix(".md"), "summary": ROOT / "docs/performance.md"}
"""Template → the page that it makes."""
GRIDS = [512, 1024, 2048, 4096, 8192]
FAST = "active_set float64"
LOADS = "5e-5 5e-4 5e-3 0.05 0.4"
"""Mean pressures over E* ḡ at which contacts of 0.01 to some 55 % of the area are compared."""

TARGET = 1e-6
"""True error at which solvers are compared."""

SOLVERS = {
    FAST: "asperity",
    "gfmd float64": "GFMD (asperity)",
    "aspher": "ASPHER",
    "aspher h2": "ASPHER, candidate nodes",
    "tamaas": "tamaas",
    "ContactMechanics": "ContactMechanics",
}


AREA_TARGET = 1e-5
"""True error of the comparison over the area: ASPHER's candidate nodes reach no 1e-6 where little touches."""

AREA_MARKERS = {FAST: "o-", "aspher": "s--", "aspher h2": "^:"}
"""Solver → marker and line of its times against the area."""


def commands(grids: list[int]) -> dict[str, str]:
    """Part of the page → the command that measures it, on grids no larger than the largest one given."""
    some = " ".join(str(points) for points in (1024, 2048, 4096) if points <= max(grids)) or str(max(grids))
    out = f"--out {FOLDER.relative_to(ROOT)}"
    return {
        "contact": f"python benchmarks/contact.py --points {' '.join(map(str, grids))} {out}",
        "free": f"python benchmarks/contact.py --boundary free --points {min(1024, max(grids))} {out}",
        "areas": f"python benchmarks/contact.py --points {min(1024, max(grids))} --hurst 0.8 "
        f"--boundary periodic free --fraction {LOADS} --solver '{FAST}' aspher 'aspher h2' "
        f"--tolerance 1e-5 1e-6 1e-7 {out}/areas",
        "threads": f"python benchmarks/contact.py --threads --points {min(4096, max(grids))} {out}",
        "stress": f"python benchmarks/stress.py --points {some} --threads 1 2 {out}",
        "options": f"python benchmarks/options.py --grid {min(1024, max(grids))} {out}/options.csv",
        "study": f"python benchmarks/study.py {out}",
    }


def measure(part: str, command: str) -> None:
    """Run the command of a part, and keep when and under which load it ran."""
    print(f"$ {command}", flush=True)
    load, start = os.getloadavg()[0], time.perf_counter()
    subprocess.run([sys.executable, *shlex.split(command)[1:]], cwd=ROOT, check=True)
    row = {
        "part": part,
        "command": command,
        "date": time.strftime("%Y-%m-%d"),
        "minutes": f"{(time.perf_counter() - start) / 60:.1f}",
        "load_before": f"{load:.1f}",
        "load_after": f"{os.getloadavg()[0]:.1f}",
    }
    table = pd.concat([read("commands"), pd.DataFrame([row])]).drop_duplicates("part", keep="last")
    table.to_csv(FOLDER / "commands.csv", index=False, lineterminator="\n")
    memory = psutil.virtual_memory().total / 2**30
    programs = [f"{name} {version(name)}" for name in ("asperity", "numpy", "numba", "ducc0")]
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, {memory:.0f} GiB"
    (FOLDER / "machine.txt").write_text(
        f"{machine}; Python {platform.python_version()}, {', '.join(programs)}\n"
    )


def read(name: str) -> pd.DataFrame:
    """A table of measurements."""
    return pd.read_csv(FOLDER / f"{name}.csv")


def contacts(boundary: str) -> pd.DataFrame:
    """Runs of contacts with a boundary."""
    table = read("contact")
    return table[(table["boundary"] == boundary) & (table["load"] == FRACTION)]


def time_at_error(runs: pd.DataFrame, target: float = TARGET) -> tuple[float, bool]:
    """Time of a solver to the true error that is compared, and True if it is an upper bound.

    Between two runs the logarithms are interpolated; NaN if no run is accurate enough. The time of a run is
    that of a more accurate one that took less.
    """
    runs = runs.dropna(subset=["error"]).sort_values(["error", "seconds"])
    runs = runs.assign(seconds=runs["seconds"].cummin()).drop_duplicates("error", keep="last")
    if runs.empty or runs["error"].iloc[0] > target:
        return np.nan, False
    if runs["error"].iloc[-1] <= target:
        return float(runs["seconds"].iloc[-1]), True
    return float(np.exp(np.interp(np.log(target), np.log(runs["error"]), np.log(runs["seconds"])))), False


def equal(table: pd.DataFrame) -> pd.DataFrame:
    """Times of all programs at equal true error, by grid."""
    rows = []
    for (hurst, points), some in table.groupby(["hurst", "points"]):
        times = {solver: time_at_error(some[some["solver"] == solver]) for solver in SOLVERS}
        own, _ = times[FAST]
        if np.isnan(own) or some["solver"].nunique() < 3:
            continue
        row = {"nodes": f"{points}²", "H": hurst}
        for solver, (taken, is_bound) in times.items():
            if (table["solver"] == solver).any():
                ratio = "" if solver == FAST else f" ({taken / own:.3g} ×)"
                shown = f"{'≤ ' * is_bound}{taken:.3g}{ratio}"
                row[f"{SOLVERS[solver]}, s"] = "" if np.isnan(taken) else shown
        rows.append(row)
    return pd.DataFrame(rows)


def over_area() -> pd.DataFrame:
    """Times to a true error of 1e-5 by boundary and contact area in per cent, a column for each program."""
    rows = []
    for (boundary, _), some in read("areas/contact").groupby(["boundary", "load"]):
        row = {"boundary": boundary, "contact area, %": 100 * some["area"].dropna().iloc[0]}
        for solver in AREA_MARKERS:
            row[SOLVERS[solver]] = time_at_error(some[some["solver"] == solver], AREA_TARGET)[0]
        rows.append(row)
    return pd.DataFrame(rows)


def advantage(some: pd.DataFrame) -> str:
    """Range of the time of the next fastest program over that of asperity."""
    ratios = some[[SOLVERS[name] for name in AREA_MARKERS if name != FAST]].min(axis=1) / some[SOLVERS[FAST]]
    return f"{ratios.min():.2g} to {ratios.max():.2g}"


def draw_areas(table: pd.DataFrame, path: Path) -> None:
    """Times against the area, a panel for each boundary."""
    with style():
        figure, axes = panels()
        for boundary, axis in zip(("periodic", "free"), axes, strict=True):
            some = table[table["boundary"] == boundary]
            for solver, marker in AREA_MARKERS.items():
                if some[SOLVERS[solver]].notna().any():
                    axis.loglog(some["contact area, %"], some[SOLVERS[solver]], marker, label=SOLVERS[solver])
            axis.set(title=f"{boundary} boundary", xlabel="contact area, %", ylabel="time on one thread, s")
            axis.legend()
        save(figure, path)


def shown(table: pd.DataFrame, **columns: str) -> str:
    """Some columns of a table of measurements, under other names, in Markdown."""
    if "points" in table:
        table = table.assign(points=table["points"].map("{}²".format))
    return markdown(table[[*columns]].rename(columns=columns))


def main() -> None:
    """Measure, and write the pages."""
    parser = parser_of(__doc__)
    parser.add_argument("--grids", type=int, nargs="+", default=GRIDS, help="nodes on an edge")
    parser.add_argument("--parts", nargs="+", choices=commands(GRIDS), help="all by default")
    parser.add_argument("--page", action="store_true", help="write the pages from the numbers that there are")
    given = parser.parse_args()
    every = commands(given.grids)
    for part in [] if given.page else given.parts or every:
        measure(part, every[part])
    periodic = contacts("periodic")
    fast = periodic[(periodic["solver"] == FAST) & (periodic["tolerance"] == TARGET)]
    others = periodic[~periodic["solver"].str.contains("float")]["program"].unique()
    areas = over_area()
    draw_areas(areas, ROOT / "docs/performance_area.png")
    values = {
        "read": read,
        "shown": shown,
        "equal": lambda boundary: markdown(equal(contacts(boundary))),
        "areas": markdown(
            areas.rename(columns=lambda name: name + ", s" if name in SOLVERS.values() else name)
        ),
        "advantage": {boundary: advantage(some) for boundary, some in areas.groupby("boundary")},
        "fast": fast.sort_values(["hurst", "points"]),
        "programs": ", ".join(others),
        "machine": (FOLDER / "machine.txt").read_text("utf-8").strip(),
    }
    for template, path in PAGES.items():
        path.write_text(rendered(Path(__file__).with_name(f"{template}.md.j2"), **values), encoding="utf-8")


if __name__ == "__main__":
    main()
