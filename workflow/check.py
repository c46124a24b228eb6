"""The numbers of the quick study against those kept in the repository: `make check`.

Runs the quick study as far as its summaries into its own folder, compares every number with the reference,
and ends with a table of what has drifted. With --update it rewrites the reference instead.
"""

import argparse
import json
import math
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

REFERENCE = Path("tests/reference/quick.json")


class Tolerance(NamedTuple):
    """How far a kind of number may move, relative to its size, and why so far."""

    names: str
    relative: float
    reason: str


TOLERANCES = (
    Tolerance(r"surface\.", 1e-10, "sums of a given sample, but for rounding"),
    Tolerance(
        r"contact\.(area_fraction|patch)|.*\.count|profile\.reference_depth",
        1e-3,
        "decided node by node, room for one node in a thousand; either changes nothing",
    ),
    Tolerance(
        r".*",
        1e-3,
        "heights changed by 1e-13 change 2e-11, a tenth of the contact's tolerance 2e-4",
    ),
)
"""The changes named are the largest seen over five to seven surfaces of the quick study."""


class Drift(NamedTuple):
    """A number that is not what it was."""

    name: str
    was: float | None
    now: float | None
    tolerance: Tolerance


def tolerance_of(name: str) -> Tolerance:
    """The first kind that a number's name, without surface and seed, belongs to."""
    short = name.rsplit("/", 1)[-1]
    return next(kind for kind in TOLERANCES if re.match(kind.names, short))


def drifts(reference: dict[str, float], found: dict[str, float]) -> list[Drift]:
    """All numbers that moved by more than their tolerance, went, or came."""
    moved = []
    for name in sorted(reference.keys() | found.keys()):
        was, now = reference.get(name), found.get(name)
        tolerance = tolerance_of(name)
        if was is None or now is None or not _same(was, now, tolerance.relative):
            moved.append(Drift(name, was, now, tolerance))
    return moved


def _same(was: float, now: float, relative: float) -> bool:
    return (math.isnan(was) and math.isnan(now)) or abs(now - was) <= relative * abs(was)


def table(moved: list[Drift]) -> str:
    """The drifts for a reader, largest first."""

    def size(drift: Drift) -> float:
        if drift.was is None or drift.now is None or drift.was == 0:
            return math.inf
        return abs(drift.now / drift.was - 1) / drift.tolerance.relative

    def text(value: float | None) -> str:
        return "-" if value is None else f"{value:.8g}"

    lines = [("name", "was", "is", "tolerance")]
    lines += [
        (drift.name, text(drift.was), text(drift.now), f"{drift.tolerance.relative:g}")
        for drift in sorted(moved, key=size, reverse=True)
    ]
    widths = [max(len(line[column]) for line in lines) for column in range(4)]
    rows = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in lines]
    reasons = sorted({f"{d.tolerance.relative:g}: {d.tolerance.reason}" for d in moved})
    return "\n".join([*rows, "", "Tolerances, relative:", *reasons])


def collect(folder: Path, surfaces: list[str] | None = None) -> dict[str, float]:
    """The numbers of all summaries below a folder of results, ``surface/seed1/name``."""
    numbers = {}
    for path in sorted(folder.glob("summary/*/seed*.json")):
        if surfaces is None or path.parent.name in surfaces:
            values = json.loads(path.read_text(encoding="utf-8"))["values"]
            numbers |= {f"{path.parent.name}/{path.stem}/{name}": value for name, value in values.items()}
    return numbers


def run(folder: str, cores: int, surfaces: list[str] | None) -> None:
    """The quick study as far as its summaries."""
    targets = [f"{folder}/summary/{s}/seed1.json" for s in surfaces] if surfaces else ["summaries"]
    command = ["snakemake", "--cores", str(cores), "--configfile", "config/quick.yaml"]
    found = subprocess.run(
        [*command, "--config", f"results={folder}", "--", *targets], capture_output=True, text=True
    )
    if found.returncode:
        sys.exit(found.stdout + found.stderr)


def main() -> None:
    """Compare, or update."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", default="results/check", help="folder of the results (%(default)s)")
    parser.add_argument("--no-run", action="store_true", help="compare what is there")
    parser.add_argument("--update", action="store_true", help="rewrite the reference")
    parser.add_argument("--surfaces", nargs="+", help="only these surfaces")
    parser.add_argument("--cores", type=int, default=2)
    chosen = parser.parse_args()
    if chosen.update and chosen.surfaces:
        parser.error("--update rewrites the whole reference; leave out --surfaces")
    if not chosen.no_run:
        run(chosen.results, chosen.cores, chosen.surfaces)
    found = collect(Path(chosen.results), chosen.surfaces)
    if not found:
        sys.exit(f"{chosen.results}: no summaries; run without --no-run")
    if chosen.update:
        REFERENCE.parent.mkdir(parents=True, exist_ok=True)
        REFERENCE.write_text(json.dumps(found, indent=0, sort_keys=True) + "\n", encoding="utf-8")
        print(f"{REFERENCE}: {len(found)} numbers")
        return
    reference = json.loads(REFERENCE.read_text(encoding="utf-8"))
    if chosen.surfaces:
        reference = {n: v for n, v in reference.items() if n.split("/")[0] in chosen.surfaces}
    moved = drifts(reference, found)
    if moved:
        sys.exit(f"{len(moved)} of {len(reference)} numbers drifted:\n{table(moved)}")
    print(f"{len(reference)} numbers as in {REFERENCE}")


if __name__ == "__main__":
    main()
