"""The text of docs/performance.md, from the tables in docs/performance."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
from performance_plots import FAST, PRECISION, STEEPEST, STYLES, TARGET, at_error, fast_runs, periodic

from asperity.markup import markdown

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs/performance"
PAGE = ROOT / "docs/performance.md"

# What the library aims at; the page tells which aims are met.
MOST_EQUIVALENTS = 10.0
MOST_OVER_TRANSFORMS = 1.4
LEAST_OVER_TAMAAS = 400.0
LEAST_OF_TWO_THREADS = 1.7
MOST_OF_AREA_CONTROL = 1.3
MOST_OF_PATH = 5.0
MOST_GIB = {8192: 3.0, 16384: 20.0}
MOST_OF_STRESS = 2.0
MOST_PLANES = 15.0
MOST_STRESS_GIB = {2048: 1.0, 4096: 3.0}
COMPARED_GRID = 2048
STUDY_AIMS = {
    "paper": (180.0, 330.0),
    "quick": (45.0, np.nan),
    "dry-run": (2.0, np.nan),
    "ensemble": (900.0, np.nan),
}

HEAD = """# Performance

Time and memory of the contact solver, of the stress in the body and of the study, beside other programs and
beside the limit that the Fourier transforms and the machine set. `make bench` runs the commands below and
writes this page; `make bench GRIDS="512 1024 2048"` leaves out the large grids, and
`make bench PARTS="contact roofline"` measures these parts anew. The numbers are in `docs/performance`.
"""

TIMES = """\
Times are processor times on one thread unless a table says *wall*. A run is repeated up to three times, as
long as that takes less than 10 s, and the shortest counts. Other jobs on the machine share its memory
bandwidth and caches and lengthen processor times too: the load, the mean number of running processes in the
minute before, stands in the tables. Ratios within a row are of the same run.
"""

PROBLEM = """\
The contact is that of a self-affine surface with eight nodes on the shortest wave, λ_l = L/8, seed 1, on a
half-space, under a mean pressure of 0.05 E\\* ḡ, with ḡ the rms gradient. *True errors* are relative L2
errors of the pressure, against a solution at an estimated error of 1e-10. *Pair equivalents* are pairs of
transforms in double precision on the finest grid: every transform on every grid is counted, those of the
certificate too; one on a coarser grid counts in proportion to its nodes, one in single precision as the
fraction of the time of a double one that a pair in single precision takes, measured in the same process.
"""


def page(folder: Path) -> str:
    """The page."""
    parts = [HEAD, machine(folder), TIMES, aims(folder)]
    sections = (contact, where_time_goes, growth, threads, load_path, body, study, roofline)
    return "\n".join([*parts, *(section(folder) for section in sections)]).rstrip() + "\n"


def read(folder: Path, name: str) -> pd.DataFrame | None:
    path = folder / f"{name}.csv"
    return pd.read_csv(path) if path.exists() else None


def command(folder: Path, part: str) -> str:
    """The command that measured a part, with its date and load."""
    table = read(folder, "commands")
    if table is None or part not in set(table["part"]):
        return f"Not measured as a whole yet: `make bench PARTS={part}`.\n"
    row = table[table["part"] == part].iloc[0]
    return (
        f"    {row['command']}\n\n{row['date']}, {row['minutes']} min, load {row['load_before']} before and "
        f"{row['load_after']} after.\n"
    )


def table_of(rows: list[dict[str, str]]) -> str:
    return markdown(pd.DataFrame(rows)).rstrip() + "\n"


def number(value: float, form: str = ".2f") -> str:
    return "" if value is None or np.isnan(value) else format(value, form)


def power(value: float) -> str:
    """A small number with two digits."""
    return number(value, ".1e").replace("e-0", "e-")


def three(value: float) -> str:
    """A number with three digits."""
    if np.isnan(value):
        return ""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def machine(folder: Path) -> str:
    table = read(folder, "machine")
    if table is None:
        return ""
    facts = dict(zip(table["name"], table["value"], strict=True))
    hardware = (
        f"{facts.pop('processor')}, {facts.pop('cores')} cores, {facts.pop('memory')}, {facts.pop('system')}"
    )
    programs = [f"{name} {value}" for name, value in facts.items() if value != "not installed"]
    runs = read(folder, "contact")
    if runs is not None:
        programs += [name for name in runs["program"].unique() if not name.startswith("asperity")]
    return f"Machine: {hardware}. Programs: {', '.join(programs)}.\n"


def runs_of(folder: Path) -> pd.DataFrame | None:
    table = read(folder, "contact")
    return None if table is None else periodic(table)


# Aims


def aims(folder: Path) -> str:
    """Measured values beside the aims."""
    table, rows = runs_of(folder), []
    if table is None:
        return ""

    def add(
        what: str, found: float, bound: str, aim: float, form: str = ".2f", unit: str = "", mark: str = ""
    ) -> None:
        if np.isnan(found):
            rows.append({"": what, "measured": "not measured", "aim": f"{bound} {aim:g}{unit}", "met": ""})
            return
        met = found <= aim if bound == "≤" else found >= aim
        cells = {"measured": f"{mark}{found:{form}}{unit}", "aim": f"{bound} {aim:g}{unit}"}
        rows.append({"": what, **cells, "met": "yes" if met else "**no**"})

    for hurst in sorted(table["hurst"].unique()):
        fast = fast_runs(table, hurst).set_index("points")
        where = f"{COMPARED_GRID}², H = {hurst}"
        if COMPARED_GRID in fast.index:
            run = fast.loc[COMPARED_GRID]
            add(f"pair equivalents to a true error of {power(run['error'])}, {where}",
                run["equivalents"], "≤", MOST_EQUIVALENTS, ".1f")  # fmt: skip
            over = run["seconds"] / run["transform_seconds"]
            add(f"time over that of its transforms, {where}", over, "≤", MOST_OVER_TRANSFORMS)
            some = table[(table["points"] == COMPARED_GRID) & (table["hurst"] == hurst)]
            peer, at_most = at_error(some[some["solver"] == "tamaas"])
            own, _ = at_error(some[some["solver"] == FAST])
            add(f"times faster than tamaas at a true error of 1e-6, {where}",
                peer / own, "≥", LEAST_OVER_TAMAAS, ".0f", mark="≤ " * at_most)  # fmt: skip
        if len(fast) > 1:
            largest = fast.index[-1]
            found = exponent(fast.reset_index(), "seconds")
            add(f"exponent of the nodes in the time, {fast.index[0]}² to {largest}², H = {hurst}",
                found, "≤", STEEPEST, ".3f")  # fmt: skip
    both = table[(table["solver"] == FAST) & (table["tolerance"] == TARGET)]
    for points, aim in MOST_GIB.items():
        memory = both.loc[both["points"] == points, "memory_GB"].max() * 1e9 / 2**30
        add(f"peak memory at {points}²", memory, "≤", aim, ".1f", " GiB")
    for hurst, (points, ratio) in two_threads(folder).items():
        add(
            f"wall time on one thread over that on two, {points}², H = {hurst}",
            ratio,
            "≥",
            LEAST_OF_TWO_THREADS,
        )
    for points, hurst, area, area_time, path, path_time in load_paths(folder):
        of = f"{points}², H = {hurst}"
        add(f"area control over the solution at its load, transforms, {of}", area, "≤", MOST_OF_AREA_CONTROL)
        add(f"the same in time, {of}", area_time, "≤", MOST_OF_AREA_CONTROL)
        add(f"path of 14 areas over one solution, transforms, {of}", path, "≤", MOST_OF_PATH, ".1f")
        add(f"the same in time, {of}", path_time, "≤", MOST_OF_PATH, ".1f")
    for points, equivalents, ratio, memory in stress_runs(folder):
        if points == COMPARED_GRID:
            add(f"stress: time over that of its transforms, {points}²", ratio, "≤", MOST_OF_STRESS)
            add(f"stress: plane equivalents, {points}²", equivalents, "≤", MOST_PLANES, ".1f")
        if points in MOST_STRESS_GIB:
            add(f"stress: peak memory at {points}²", memory, "≤", MOST_STRESS_GIB[points], ".2f", " GiB")
    found = read(folder, "study")
    for name, (wall, seconds) in STUDY_AIMS.items():
        row = None if found is None or name not in set(found["study"]) else found.set_index("study").loc[name]
        add(f"study, {name}: wall time", np.nan if row is None else row["wall"], "≤", wall, ".1f", " s")
        if not np.isnan(seconds):
            spent = np.nan if row is None else row["seconds"]
            add(f"study, {name}: processor time", spent, "≤", seconds, ".0f", " s")
    return f"## Aims\n\n{table_of(rows)}\n"


def load_paths(folder: Path) -> list[tuple[str, str, float, float, float, float]]:
    """Grid, Hurst exponent, and ratios of area control and of the path, of transforms and of time."""
    found = re.findall(
        r"^(\d+)² nodes, H = ([\d.]+);.*?^Mean ratio ([\d.]+), of time ([\d.]+)$"
        r".*?^Path [^\n]*: ([\d.]+) times [^\n]* and ([\d.]+) times its time$",
        printed(folder, "load_path", fenced=False),
        re.MULTILINE | re.DOTALL,
    )
    return [(points, hurst, *map(float, ratios)) for points, hurst, *ratios in found]


def stress_runs(folder: Path) -> list[tuple[int, float, float, float]]:
    """Grid, plane equivalents, time over that of the transforms, and peak memory of each run."""
    row = r"^ *(\d+)² +\d+ +([\d.]+) +[\d.]+ s +[\d.]+ s +([\d.]+) +([\d.]+) GiB"
    found = re.findall(row, printed(folder, "stress", fenced=False), re.MULTILINE)
    return [(int(points), *map(float, numbers)) for points, *numbers in found]


def two_threads(folder: Path) -> dict[float, tuple[int, float]]:
    """Hurst exponent → grid, and the shortest wall time on one thread over that on two."""
    table = read(folder, "threads")
    if table is None:
        return {}
    return {run["hurst"]: (run["points"], run["one"] / run["two"]) for _, run in table.iterrows()}


# Contact


def contact(folder: Path) -> str:
    """Time, memory, transforms and errors by grid, and the comparison at equal true error."""
    table = runs_of(folder)
    if table is None:
        return f"## Contact\n\n{command(folder, 'contact')}"
    times, memory = [], []
    for hurst in sorted(table["hurst"].unique()):
        for _, run in fast_runs(table, hurst).iterrows():
            where = {"nodes": f"{run['points']:.0f}²", "H": f"{hurst}"}
            times.append(
                {
                    **where,
                    "s": three(run["seconds"]),
                    "over its transforms": number(run["seconds"] / run["transform_seconds"]),
                    "double + single pairs": f"{run['double_pairs']:.1f} + {run['single_pairs']:.1f}",
                    "single / double": number(run["single_fraction"]),
                    "pair equivalents": number(run["equivalents"], ".1f"),
                    "time / one pair": number(run["seconds"] / run["pair_seconds"], ".1f"),
                    "true error": power(run["error"]),
                    "load": number(run["load_average"], ".1f"),
                }
            )
            memory.append(
                {
                    **where,
                    "GB": three(run["memory_GB"]),
                    "bytes a node": number(run["bytes_per_node"], ".0f"),
                    "wall, s": three(run["wall"]),
                    "largest violation": power(run["certificate"]),
                }
            )
    return f"""## Contact by grid

{command(folder, "contact")}
{PROBLEM}
asperity at its default tolerance, 1e-6:

{table_of(times)}
![Processor time against the grid](performance/time.png)

*Processor time to a true error of 1e-6; asperity at its default tolerance.*

Memory is the peak of the process, with Python, its libraries and the heights; bytes are those that the first
run adds to what was there before. The largest violation of the conditions of contact is that of the
certificate.

{table_of(memory)}
![Memory against the grid](performance/memory.png)

## Contact at equal true error

Programs define their tolerances differently. Each runs at several, and the time to a true error of 1e-6 is
interpolated between them (≤: its least accurate run is more accurate than that). GFMD is the
damped dynamics of the paper, `method="gfmd"`.

{equal_errors(table)}
![True error against processor time](performance/errors.png)

All runs:

{all_runs(table)}"""


def equal_errors(table: pd.DataFrame) -> str:
    rows = []
    for (hurst, points), some in table.groupby(["hurst", "points"]):
        own, _ = at_error(some[some["solver"] == FAST])
        if np.isnan(own):
            continue
        row = {"nodes": f"{points}²", "H": f"{hurst}"}
        for solver, (_, _, label) in STYLES.items():
            if solver == "active_set float32":
                continue
            taken, bound = at_error(some[some["solver"] == solver])
            shown = "" if np.isnan(taken) else f"{'≤ ' * bound}{three(taken)}"
            ratio = "" if solver == FAST or np.isnan(taken) else f" ({three(taken / own)} ×)"
            row[f"{label}, s"] = f"{shown}{ratio}"
        rows.append(row)
    return table_of(rows)


def all_runs(table: pd.DataFrame) -> str:
    order = {solver: number for number, solver in enumerate(STYLES)}
    table = table.assign(order=table["solver"].map(order))
    table = table.sort_values(["points", "hurst", "order", "error"], ascending=[True, True, True, False])
    rows = [
        {
            "nodes": f"{run['points']}²",
            "H": f"{run['hurst']}",
            "solver": STYLES[run["solver"]][-1],
            "tolerance": f"{run['tolerance']:.0e}".replace("e-0", "e-"),
            "true error": power(run["error"]),
            "s": three(run["seconds"]),
            "GB": three(run["memory_GB"]),
            "equivalents": number(run["equivalents"], ".1f"),
            "load": number(run["load_average"], ".1f"),
            "date": str(run["date"]),
        }
        for _, run in table.iterrows()
    ]
    return table_of(rows)


# Parts of the solver, growth and threads


def where_time_goes(folder: Path) -> str:
    table, compared = read(folder, "parts"), read(folder, "stencils")
    if table is None or compared is None:
        return f"\n## Where the time of a contact goes\n\n{command(folder, 'contact_parts')}"
    rows = {name: {"part": name} for name in table["part"].unique()}
    for (points, hurst), run in table.groupby(["points", "hurst"]):
        for name, seconds in zip(run["part"], run["seconds"], strict=True):
            share = seconds / run["seconds"].sum()
            rows[name][f"{points}², H = {hurst}"] = f"{1e3 * seconds:.0f} ms, {100 * share:.0f} %"
    economies = [
        {
            "nodes": f"{run['points']}²",
            "H": f"{run['hurst']}",
            "inner displacements": "stencil and coarser grid" if run["stencils"] else "whole grid",
            "s": three(run["seconds"]),
            "over its transforms": number(run["seconds"] / run["transform_seconds"]),
            "pair equivalents": number(run["equivalents"], ".1f"),
        }
        for _, run in compared.iterrows()
    ]
    return f"""
## Where the time of a contact goes

{command(folder, "contact_parts")}
Wall times of one solution on one thread, from samples of the function that is at work:

{table_of(list(rows.values()))}
Stencils and a coarser grid stand in for transforms of the whole grid in the inner solves. Without them a
solution takes longer, and more transforms, so that what is not a transform is a smaller part of it
(processor times, the shortest of some runs):

{table_of(economies)}"""


def exponent(runs: pd.DataFrame, column: str) -> float:
    """Exponent of the number of nodes from the smallest to the largest grid."""
    first, last = runs.iloc[0], runs.iloc[-1]
    return float(np.log(last[column] / first[column]) / (2 * np.log(last["points"] / first["points"])))


def growth(folder: Path) -> str:
    table = runs_of(folder)
    if table is None:
        return ""
    rows = []
    for hurst in sorted(table["hurst"].unique()):
        fast = fast_runs(table, hurst)
        if len(fast) < 2:
            continue
        columns = {
            "time": "seconds",
            "its transforms": "transform_seconds",
            "one pair": "pair_seconds",
            "equivalents": "equivalents",
        }
        found = {name: number(exponent(fast, column)) for name, column in columns.items()}
        grids = f"{fast['points'].iloc[0]}² to {fast['points'].iloc[-1]}²"
        rows.append({"H": f"{hurst}", "grids": grids, **found})
    return f"""
## Growth, and the largest grid

Exponents of the number of nodes, from the smallest to the largest grid. The shortest wavelength is eight
nodes on every grid, so that λ_l/λ_s grows with it.

{table_of(rows)}
![Time for each node against the grid](performance/growth.png)

The largest grid is one command, which makes the surface within the same memory. There the true error is not
known; the certificate is computed from the pressure alone.

{command(folder, "large")}
{printed(folder, "large", fenced=True)}"""


def threads(folder: Path) -> str:
    table = read(folder, "threads")
    rows = []
    if table is not None:
        for _, run in table.iterrows():
            rows.append(
                {
                    "nodes": f"{run['points']}²",
                    "H": f"{run['hurst']}",
                    "one thread, wall s": three(run["one"]),
                    "two, wall s": three(run["two"]),
                    "ratio": number(run["one"] / run["two"]),
                    "median ratio": number(run["median_ratio"]),
                    "of the transforms": number(run["transforms"]),
                    "load": f"{run['load_average']:.1f}",
                }
            )
    shown = table_of(rows) if rows else ""
    return f"""
## Two threads

{command(folder, "threads")}
The contact is solved on one thread and on two alternately, several times in one process. The shortest times
count; the median ratio is that of consecutive runs. How well the transforms scale depends on the bandwidth of
memory that other virtual machines on the same host leave.

{shown}"""


# What other benchmarks print


def printed(folder: Path, part: str, fenced: bool) -> str:
    path = folder / f"{part}.txt"
    if not path.exists():
        return ""
    text = path.read_text("utf-8").strip()
    return f"```text\n{text}\n```\n" if fenced else f"{text}\n"


def load_path(folder: Path) -> str:
    return f"""
## Area control and load path

{command(folder, "load_path")}
{printed(folder, "load_path", fenced=False)}"""


def body(folder: Path) -> str:
    return f"""
## Stress in the body

{command(folder, "stress")}
{printed(folder, "stress", fenced=True)}"""


def study(folder: Path) -> str:
    table, shown = read(folder, "study"), ""
    if table is not None:
        rows = [
            {
                "study": run["study"],
                "wall, s": f"{run['wall']:.1f}",
                "processor time, s": f"{run['seconds']:.1f}",
                "largest process, GB": number(run["memory_GB"]),
                "cores": f"{run['cores']}",
                "load before": number(run["load_average"], ".1f"),
                "date": str(run["date"]),
            }
            for _, run in table.iterrows()
        ]
        shown = table_of(rows)
    return f"""
## The study

{command(folder, "study")}
From nothing, in a new folder. `python workflow/cost.py` prints the processor time and memory of each rule of
a finished study; [Beyond one machine](scaling.md) has those of each job.

{shown}"""


def roofline(folder: Path) -> str:
    table, shown = read(folder, "roofline"), ""
    if table is not None:
        rows = [
            {
                "kernel": run["kernel"],
                "precision": PRECISION[run["precision"]],
                "ms": three(1e3 * run["seconds"]),
                "operations / byte": number(run["intensity"]),
                "GFlop/s": three(run["GFlop/s"]),
                "GB/s": three(run["GB/s"]),
            }
            for _, run in table.iterrows()
        ]
        shown = f"""{table_of(rows)}
![Roofline](performance/roofline.png)
"""
    return f"""
## Roofline

{command(folder, "roofline")}
The ceilings are measured: the bandwidth of memory by a + s b, and the rate of floating-point operations by a
product of matrices. Operations and bytes are those that a kernel needs, not those that it spends: a
transform of n nodes counts 2.5 n log₂ n operations and moves field and coefficients twice, for rows and
columns; a comparison counts as an operation. Filled symbols are double precision.

{shown}"""
