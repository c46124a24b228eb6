"""Measures speed and memory, and writes docs/performance.md with its plots.

    python benchmarks/page.py [--grids 512 1024 2048] [--parts contact stress] [--page]

runs the benchmarks of all parts, or of those named, and writes the page from the tables that they keep in
docs/performance; with ``--page`` it writes the page alone.
"""

import argparse
import os
import platform
import shlex
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import psutil
from contact import FRACTION
from matplotlib.figure import Figure

from asperity.core.markup import markdown
from asperity.study.small_studies import rendered

mpl.use("Agg")

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs/performance"
GRIDS = [512, 1024, 2048, 4096, 8192]
FAST = "active_set float64"
TARGET = 1e-6
"""True error at which solvers are compared."""

# Colours that people with any colour vision tell apart (Okabe & Ito).
SOLVERS = {
    FAST: ("#0072B2", "o", "asperity"),
    "active_set float32": ("#56B4E9", "^", "asperity, single precision"),
    "gfmd float64": ("#009E73", "s", "GFMD (asperity)"),
    "aspher": ("#E69F00", "P", "ASPHER"),
    "aspher h2": ("#000000", "X", "ASPHER, candidate nodes"),
    "tamaas": ("#D55E00", "D", "tamaas"),
    "ContactMechanics": ("#CC79A7", "v", "ContactMechanics"),
}


def commands(grids: list[int]) -> dict[str, str]:
    """Part of the page → the command that measures it, on grids no larger than the largest one given."""
    some = " ".join(str(points) for points in (1024, 2048, 4096) if points <= max(grids)) or str(max(grids))
    out = f"--out {FOLDER.relative_to(ROOT)}"
    return {
        "contact": f"python benchmarks/contact.py --points {' '.join(map(str, grids))} {out}",
        "free": f"python benchmarks/contact.py --boundary free --points {min(1024, max(grids))} {out}",
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


def contact_runs(boundary: str = "periodic") -> pd.DataFrame:
    """Runs over one boundary."""
    table = read("contact")
    return table[(table["boundary"] == boundary) & (table["load"] == FRACTION)]


def time_at_error(runs: pd.DataFrame) -> tuple[float, bool]:
    """Time of a solver to the true error that is compared, and True if it is an upper bound.

    Between two runs the logarithms are interpolated; NaN if no run is accurate enough.
    """
    runs = runs.dropna(subset=["error"]).sort_values("error")
    if runs.empty or runs["error"].iloc[0] > TARGET:
        return np.nan, False
    if runs["error"].iloc[-1] <= TARGET:
        return float(runs["seconds"].iloc[-1]), True
    return float(np.exp(np.interp(np.log(TARGET), np.log(runs["error"]), np.log(runs["seconds"])))), False


def number(value: float, form: str = ".3g") -> str:
    """A number as text; none for NaN."""
    return "" if np.isnan(value) else format(value, form).replace("e-0", "e-")


def table_of(rows: list[dict[str, Any]]) -> str:
    """A table in Markdown."""
    return markdown(pd.DataFrame(rows))


def command_of(part: str) -> str:
    """The command that measured a part, with its date and load."""
    row = read("commands").set_index("part").loc[part]
    load = f"load {row['load_before']} before and {row['load_after']} after"
    return f"    {row['command']}\n\n{row['date']}, {row['minutes']} min, {load}."


def fast_runs(hurst: float) -> pd.DataFrame:
    """Runs of the default solver at its default tolerance, by grid."""
    table = contact_runs()
    chosen = (table["solver"] == FAST) & (table["tolerance"] == TARGET) & (table["hurst"] == hurst)
    return table[chosen].sort_values("points")


def largest_compared(table: pd.DataFrame) -> int:
    """Nodes on an edge of the largest grid on which most programs ran."""
    programs = table[table["error"].notna()].groupby("points")["solver"].nunique()
    return int(programs.index[programs > programs.max() / 2].max())


def programs(largest: int) -> str:
    """Rows of the other programs: version, iterations and time of the most accurate run on a grid."""
    table = contact_runs()
    others = table[~table["solver"].str.contains("float") & table["error"].notna()]
    last = others[(others["points"] == largest) & (others["hurst"] == 0.8)]
    return "\n".join(
        f"| {SOLVERS[solver][2]} | {run['program'].split()[1]} | {number(run['iterations'], '.0f')} "
        f"| {number(1e3 * run['seconds'] / run['iterations'])} |"
        for solver, runs in last.groupby("solver")
        for run in [runs.sort_values("error").iloc[0]]
    )


def equal(table: pd.DataFrame) -> str:
    """Times at equal true error, by grid."""
    rows = []
    for (hurst, points), some in table.groupby(["hurst", "points"]):
        own, _ = time_at_error(some[some["solver"] == FAST])
        if np.isnan(own) or some["solver"].nunique() < 3:
            continue
        row = {"nodes": f"{points}²", "H": f"{hurst}"}
        for solver in SOLVERS:
            if solver == "active_set float32" or not (table["solver"] == solver).any():
                continue
            taken, is_bound = time_at_error(some[some["solver"] == solver])
            ratio = "" if solver == FAST or np.isnan(taken) else f" ({number(taken / own)} ×)"
            row[f"{SOLVERS[solver][2]}, s"] = f"{'≤ ' * is_bound}{number(taken)}{ratio}"
        rows.append(row)
    return table_of(rows)


def growth() -> str:
    """Times, memory and transforms by grid."""
    runs = [
        {
            "nodes": f"{run['points']}²",
            "H": f"{hurst}",
            "threads": str(run["threads"]),
            "processor time, s": number(run["seconds"]),
            "wall time, s": number(run["wall"]),
            "over its transforms": number(run["seconds"] / run["transform_seconds"], ".2f"),
            "double + single pairs": f"{run['double_pairs']:.1f} + {run['single_pairs']:.1f}",
            "pair equivalents": number(run["equivalents"], ".1f"),
            "true error": number(run["error"], ".1e"),
            "largest violation": number(run["certificate"], ".1e"),
            "GB": number(run["memory_GB"]),
            "bytes a node": number(run["bytes_per_node"], ".0f"),
            "load": number(run["load_average"], ".1f"),
        }
        for hurst in sorted(contact_runs()["hurst"].unique())
        for _, run in fast_runs(hurst).iterrows()
    ]
    return table_of(runs)


def exponents() -> str:
    """Powers of the number of nodes with which the time grows."""
    found = []
    for hurst in sorted(contact_runs()["hurst"].unique()):
        ends = fast_runs(hurst).iloc[[0, -1]]
        slope = np.log(ends["seconds"]).diff().iloc[1] / (2 * np.log(ends["points"]).diff().iloc[1])
        found.append(f"{slope:.2f} for H = {hurst}")
    return ", ".join(found)


def draw() -> None:
    """Plot time against the grid, and true error against time on the largest grid of most programs."""
    table = contact_runs()
    hursts = sorted(table["hurst"].unique())
    largest = largest_compared(table)
    figure = Figure(figsize=(8.6, 6.4), layout="constrained")
    axes = figure.subplots(2, len(hursts), sharey="row", squeeze=False)
    for (above, below), hurst in zip(axes.T, hursts, strict=True):
        for solver, (colour, marker, label) in SOLVERS.items():
            some = table[(table["solver"] == solver) & (table["hurst"] == hurst)]
            fast = fast_runs(hurst)
            by_grid = [(points, time_at_error(runs)[0]) for points, runs in some.groupby("points")]
            points, seconds = (fast["points"], fast["seconds"]) if solver == FAST else np.array(by_grid).T
            style = {"color": colour, "marker": marker, "markersize": 4, "label": label}
            if solver != "active_set float32":
                above.loglog(points, seconds, **style)
            on_largest = some[some["points"] == largest].sort_values("seconds")
            below.loglog(on_largest["seconds"], on_largest["error"], **style)
        above.loglog(fast["points"], fast["transform_seconds"], "k--", lw=1, label="transforms of asperity")
        above.set_xscale("log", base=2)
        above.set(title=f"H = {hurst}", xlabel="nodes on an edge")
        below.axhline(TARGET, color="0.5", linewidth=0.8, linestyle="--")
        below.set(xlabel=f"processor time, s, {largest}² nodes")
    axes[0, 0].set(ylabel="processor time, s")
    axes[1, 0].set(ylabel="relative error of the pressure")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.savefig(FOLDER / "contact.png", dpi=150, metadata={"Software": None})


def threads() -> str:
    """Wall times on one thread and on two."""
    runs = [
        {
            "nodes": f"{run['points']:.0f}²",
            "H": f"{run['hurst']}",
            "one thread, wall s": number(run["one"]),
            "two, wall s": number(run["two"]),
            "ratio": number(run["one"] / run["two"]),
            "median ratio": number(run["median_ratio"]),
            "of the transforms": number(run["transforms"]),
            "load": number(run["load_average"], ".1f"),
        }
        for run in read("threads").to_dict("records")
    ]
    return table_of(runs)


def stress() -> str:
    """Cost of the analysis of the stress by grid."""
    runs = [
        {
            "nodes": f"{run['points']}²",
            "planes": str(run["planes"]),
            "plane equivalents": number(run["equivalents"], ".1f"),
            "threads": str(run["threads"]),
            "processor time, s": number(run["seconds"]),
            "wall time, s": number(run["wall"]),
            "over its transforms": number(run["seconds"] / run["transform_seconds"], ".2f"),
            "memory, GiB": number(run["memory_GiB"], ".2f"),
            "before, GiB": number(run["before_GiB"], ".2f"),
            "load": number(run["load_average"], ".1f"),
        }
        for run in read("stress").to_dict("records")
    ]
    return table_of(runs)


def study() -> str:
    """Cost of the study."""
    runs = [
        {
            "study": run["study"],
            "wall, s": number(run["wall"], ".1f"),
            "processor time, s": number(run["seconds"], ".0f"),
            "largest process, GB": number(run["memory_GB"], ".2f"),
            "cores": str(run["cores"]),
            "load before": number(run["load_average"], ".1f"),
            "date": run["date"],
        }
        for run in read("study").to_dict("records")
    ]
    return table_of(runs)


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grids", type=int, nargs="+", default=GRIDS, help="nodes on an edge")
    parser.add_argument("--parts", nargs="+", choices=commands(GRIDS), help="all by default")
    parser.add_argument("--page", action="store_true", help="write the page from the numbers that there are")
    given = parser.parse_args()
    every = commands(given.grids)
    for part in [] if given.page else given.parts or every:
        measure(part, every[part])
    draw()
    largest, options = largest_compared(contact_runs()), read("options")
    page = rendered(
        Path(__file__).with_name("page.md.j2"),
        command=command_of,
        equal=equal,
        periodic=contact_runs(),
        free=contact_runs("free"),
        programs=programs(largest),
        largest=largest,
        growth=growth(),
        exponents=exponents(),
        threads=threads(),
        stress=stress(),
        points=options["points"].iloc[0],
        options=markdown(options.drop(columns="points").assign(ratio=options["ratio"].map(number))),
        study=study(),
        machine=(FOLDER / "machine.txt").read_text("utf-8").strip(),
    )
    (ROOT / "docs/performance.md").write_text(page, encoding="utf-8")
    print("docs/performance.md written")


if __name__ == "__main__":
    main()
