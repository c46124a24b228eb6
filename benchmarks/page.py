"""Measures speed and memory in about 20 minutes, and writes the pages of performance.

    python benchmarks/page.py [--parts rivals stress] [--page] [--new]

Each part runs in a process of its own and writes its tables into results/benchmarks when it has ended: a run
that was ended goes on with the parts that are missing, ``--new`` starts again, and a part that fails loses no
other. The tables are then copied to paper/supplement/performance, from which both pages are written; with
``--page`` the pages alone are written.
"""

import os
import platform
import shlex
import shutil
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import psutil
from contact import FRACTION, SINGLE
from matplotlib.ticker import LogLocator
from measuring import in_words, parser_of

from asperity.core.markup import markdown
from asperity.engineering.drawing import plain_logarithms
from asperity.study.small_studies import rendered
from asperity.views.style import panels, save, style

ROOT = Path(__file__).parents[1]
RUN = ROOT / "results/benchmarks"
FOLDER = ROOT / "paper/supplement/performance"
PAGES = {"performance": FOLDER.with_suffix(".md"), "summary": ROOT / "docs/performance.md"}
"""Template → the page that it makes."""

LINES = {"asperity": "C1o-", "ASPHER": "C0s--", "ASPHER, candidate nodes": "C2^:"}
"""Program → colour, marker and line of its times against the area."""

COLUMNS = ["command", "wall", "seconds", "memory_GB", "promised", "ratio", "low", "high"]
"""Of the tables of commands."""

NEEDED = ("rivals", "grids", "stress", "options")
"""Tables without which there is no page."""


class Part(NamedTuple):
    """A part of the measurement: its command, the minutes that it takes, and whether it runs by default."""

    command: str
    minutes: float
    by_default: bool = True


PARTS = {
    "rivals": Part("contact.py rivals", 8),
    "grids": Part("contact.py grids", 2),
    "stress": Part("stress.py --points 1024 2048 4096", 2),
    "options": Part("options.py --grid 1024", 2),
    **{name: Part(f"commands.py {name}", 1) for name in ("run", "info", "sample", "sweep", "page")},
    "seal": Part("commands.py seal", 2),
    "study": Part("commands.py study", 7, by_default=False),
    "tests": Part("commands.py tests", 5, by_default=False),
}


def measure(name: str, part: Part) -> dict[str, object] | None:
    """Run a part, and return when and under which load it ran; None if it failed."""
    script, *given = shlex.split(part.command)
    out = RUN if script == "commands.py" else RUN / f"{name}.csv"
    command = ["python", f"benchmarks/{script}", *given, "--out", str(out.relative_to(ROOT))]
    print(f"$ {shlex.join(command)}", flush=True)
    load, start = os.getloadavg()[0], time.perf_counter()
    try:
        run = subprocess.run([sys.executable, *command[1:]], cwd=ROOT, timeout=240 * part.minutes)
    except subprocess.TimeoutExpired:
        return None
    if run.returncode:
        return None
    return {
        "part": name,
        "command": shlex.join(command),
        "date": time.strftime("%Y-%m-%d"),
        "minutes": f"{(time.perf_counter() - start) / 60:.1f}",
        "load_before": f"{load:.1f}",
        "load_after": f"{os.getloadavg()[0]:.1f}",
    }


def measured(names: list[str]) -> list[str]:
    """Measure parts of which this run has no table, and copy all tables; returns the parts that failed."""
    failed = []
    for name in names:
        if (RUN / f"{name}.csv").exists():
            continue
        if (row := measure(name, PARTS[name])) is None:
            failed.append(name)
            continue
        shutil.copy(RUN / f"{name}.csv", FOLDER)
        kept = read("commands")
        table = pd.concat([kept[kept["part"].isin([*PARTS])], pd.DataFrame([row])])
        table = table.drop_duplicates("part", keep="last")
        table.to_csv(FOLDER / "commands.csv", index=False, lineterminator="\n")
    memory = psutil.virtual_memory().total / 2**30
    programs = [f"{name} {version(name)}" for name in ("asperity", "numpy", "numba", "ducc0")]
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, {memory:.0f} GiB"
    text = f"{machine}; Python {platform.python_version()}, {', '.join(programs)}\n"
    (FOLDER / "machine.txt").write_text(text, encoding="utf-8")
    return failed


def read(name: str) -> pd.DataFrame:
    """A table of measurements."""
    return pd.read_csv(FOLDER / f"{name}.csv")


def rivals(boundary: str) -> pd.DataFrame:
    """Ratios of other programs at a true error of 1e-6."""
    table = read("rivals")
    table = table[(table["boundary"] == boundary) & (table["fraction"] == FRACTION)]
    return _compared(table[(table["target"] == 1e-6)])


def over_area() -> pd.DataFrame:
    """Rows of the comparison over the area, at a true error of 1e-5."""
    table = read("rivals")
    return table[(table["target"] == 1e-5) & (table["program"] != SINGLE)]


def _compared(table: pd.DataFrame) -> pd.DataFrame:
    """Rows of other programs as the pages show them."""
    return pd.DataFrame(
        {
            "nodes": table["points"].map("{}²".format),
            "H": table["hurst"],
            "boundary": table["boundary"],
            "area, %": 100 * table["area"],
            "program": table["program"],
            "its error": table["error"],
            "its time, s": table["seconds"],
            "error of asperity": table["own_error"],
            "time of asperity, s": table["own_seconds"],
            "ratio (95 %)": in_words(table),
            "turns": table["pairs"],
        }
    )


def advantage(boundary: str) -> str:
    """Range of the time of the next fastest program over that of asperity."""
    table = over_area()
    ratios = table[table["boundary"] == boundary].groupby("area")["ratio"].min()
    return f"{ratios.min():.2g} to {ratios.max():.2g}"


def draw_areas(table: pd.DataFrame, path: Path) -> None:
    """Times against the area, a panel for each boundary and a line for each program and grid."""
    with style():
        figure, axes = panels()
        for boundary, axis in zip(("periodic", "free"), axes, strict=True):
            for points, some in table[table["boundary"] == boundary].groupby("points"):
                own = some.drop_duplicates("area").assign(program="asperity", seconds=some["own_seconds"])
                for program, line in pd.concat([own, some]).groupby("program"):
                    given = {"label": f"{program}, {points}²"} | ({} if points == 1024 else {"mfc": "white"})
                    line = line.sort_values("area")
                    axis.plot(100 * line["area"], line["seconds"], LINES[str(program)], **given)
            axis.set(title=f"{boundary} boundary", xlabel="contact area, %", ylabel="time on one thread, s")
            plain_logarithms(axis.xaxis)
            plain_logarithms(axis.yaxis)
            axis.xaxis.set_major_locator(LogLocator())
        lines = {line.get_label(): line for axis in axes for line in axis.get_lines()}
        figure.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=3)
        save(figure, path)


def shown(table: pd.DataFrame, **columns: str) -> str:
    """Some columns of a table of measurements, under other names, in Markdown; ``words`` are of ratios."""
    if "points" in table:
        table = table.assign(points=table["points"].map("{}²".format))
    if "ratio" in table:
        table = table.assign(words=in_words(table).where(table["ratio"].notna(), ""))
    return markdown(table[[*columns]].rename(columns=columns))


def commands() -> pd.DataFrame:
    """Rows of all commands that were measured."""
    names = [name for name, part in PARTS.items() if part.command.startswith("commands.py")]
    tables = [
        read(name).assign(part=name).rename(columns={"study": "command"})
        for name in names
        if (FOLDER / f"{name}.csv").exists()
    ]
    return pd.concat([pd.DataFrame(columns=COLUMNS), *tables])


def write_pages() -> None:
    """Write the pages from the tables."""
    if missing := [name for name in NEEDED if not (FOLDER / f"{name}.csv").exists()]:
        sys.exit(f"no pages: {', '.join(missing)} were never measured")
    draw_areas(over_area(), ROOT / "docs/performance_area.png")
    table = read("rivals")
    values = {
        "read": read,
        "shown": shown,
        "commands": commands(),
        "rivals": lambda boundary: markdown(rivals(boundary).drop(columns=["boundary", "area, %"])),
        "areas": markdown(_compared(over_area()).drop(columns="H")),
        "single": markdown(_compared(table[table["program"] == SINGLE]).drop(columns=["H", "boundary"])),
        "advantage": advantage,
        "programs": ", ".join(
            sorted({f"{each.program.split(',')[0]} {each.version}" for each in table.itertuples()})
        ),
        "machine": (FOLDER / "machine.txt").read_text("utf-8").strip(),
    }
    for template, path in PAGES.items():
        path.write_text(rendered(Path(__file__).with_name(f"{template}.md.j2"), **values), encoding="utf-8")


def main() -> None:
    """Measure, and write the pages; ends with an error if a part failed."""
    parser = parser_of(__doc__)
    default = [name for name, part in PARTS.items() if part.by_default]
    parser.add_argument(
        "--parts", nargs="+", choices=PARTS, default=default, help=f"default: {' '.join(default)}"
    )
    parser.add_argument("--new", action="store_true", help="measure again what an earlier run has measured")
    parser.add_argument("--page", action="store_true", help="write the pages from the tables that there are")
    given = parser.parse_args()
    if given.new:
        for name in given.parts:
            (RUN / f"{name}.csv").unlink(missing_ok=True)
    failed = [] if given.page else measured(given.parts)
    write_pages()
    if failed:
        sys.exit(f"failed, with earlier numbers on the pages: {', '.join(failed)}; the same command resumes")


if __name__ == "__main__":
    main()
