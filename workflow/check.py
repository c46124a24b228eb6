"""Drift check: compares the numbers of the quick study with those kept in the repository (`make check`).

Runs the quick study up to its verdicts in a folder of its own, compares every number of every seed and every
verdict with the reference, and prints a table of those that have drifted. With --update it rewrites the
reference instead.
"""

import argparse
import json
import math
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import xarray as xr

from asperity.fourier import DEFAULT, ENGINES
from asperity.results import dataset
from asperity.settings.reader import load

CONFIG = "config/quick.yaml"
REFERENCE = Path("tests/reference/quick.json")

_OF_SURFACE = ("rms_gradient", "skewness", "kurtosis")
_OF_CONTACT = (
    *("contact_area_fraction", "mean_pressure", "gradient_rms_contact", "approach", "proportionality"),
    *("load_exponent", "proportionality_change", "patches", "patch_radius"),
)
OF_SEED = {
    **{f"surface.{name}": f"seed_{name}" for name in _OF_SURFACE},
    **{f"contact.{name}": f"seed_{name}" for name in _OF_CONTACT},
}
"""Name of a number in the reference → variable of stage statistics."""

OF_POISSON = {
    "profile.maximum": "seed_maximum_von_mises",
    "profile.reference_depth": "seed_reference_depth",
    "decay.depth": "seed_decay_length_depth",
    "decay.plane": "seed_decay_length_plane",
    "von_mises.depth_patch_correlation": "seed_depth_patch_correlation",
}
"""The same for variables along `poisson`."""

OF_PEAKS = {
    "count": "seed_peak_count",
    "mean": "seed_peak_mean",
    "deviation": "seed_peak_deviation",
    "depth": "seed_mean_depth",
    "depth_high": "seed_mean_depth_highest",
}
"""The same for variables along `quantity` and `poisson`."""

OF_UNIFORM_MODE = ("von_mises", "xx")
"""Quantities that another condition of the mean (q = 0) mode changes."""

PERCENTILES = {"p50": 0.5, "p90": 0.9, "p99": 0.99, "maximum": 1.0}
"""Name of a number in the reference → level of the quantiles of the peaks."""


class Tolerance(NamedTuple):
    """Largest relative change that is allowed to a kind of number, and the reason."""

    names: str
    relative: float
    reason: str


OF_STATEMENT = ("value", "grid error", "verdict")
"""Values of every statement of the paper that are compared, under every interpretation."""

Number = float | str
"""A number, or a verdict."""

TOLERANCES = (
    Tolerance(r"statement\.", 1e-2, "differences of distributions, and of numbers that are nearly the same"),
    Tolerance(r"surface\.", 1e-10, "sums over a given sample, equal except for rounding"),
    Tolerance(
        r"contact\.(contact_area_fraction|patch)|.*\.count|profile\.reference_depth",
        1e-3,
        "counts of nodes, with an allowance of one node in a thousand; neither change moves any",
    ),
    Tolerance(
        r".*",
        1e-3,
        "heights changed by 1e-13 move them by 2e-11, a tenth of the contact's tolerance by 2e-4",
    ),
)
"""The first pattern that matches applies. The changes named are the largest over all surfaces."""


class Drift(NamedTuple):
    """A number that differs from the reference; None where it is missing."""

    name: str
    was: Number | None
    now: Number | None
    tolerance: Tolerance


def tolerance_of(name: str) -> Tolerance:
    """Tolerance of a number, by its name without surface and seed."""
    short = name.rsplit("/", 1)[-1]
    return next(kind for kind in TOLERANCES if re.match(kind.names, short))


def drifts(reference: dict[str, Number], found: dict[str, Number]) -> list[Drift]:
    """Numbers that moved by more than their tolerance, are missing, or are new."""
    moved = []
    for name in sorted(reference.keys() | found.keys()):
        was, now = reference.get(name), found.get(name)
        tolerance = tolerance_of(name)
        if was is None or now is None or not _same(was, now, tolerance.relative):
            moved.append(Drift(name, was, now, tolerance))
    return moved


def _same(was: Number, now: Number, relative: float) -> bool:
    if isinstance(was, str) or isinstance(now, str):
        return was == now
    return (math.isnan(was) and math.isnan(now)) or abs(now - was) <= relative * abs(was)


def table(moved: list[Drift]) -> str:
    """Table of the drifts for a reader, largest first."""

    def size(drift: Drift) -> float:
        if not isinstance(drift.was, float) or not isinstance(drift.now, float) or drift.was == 0:
            return math.inf
        return abs(drift.now / drift.was - 1) / drift.tolerance.relative

    def text(value: Number | None) -> str:
        return "-" if value is None else f"{value:.8g}" if isinstance(value, float) else str(value)

    lines = [("name", "was", "is", "tolerance")]
    lines += [
        (drift.name, text(drift.was), text(drift.now), f"{drift.tolerance.relative:g}")
        for drift in sorted(moved, key=size, reverse=True)
    ]
    widths = [max(len(line[column]) for line in lines) for column in range(4)]
    rows = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in lines]
    reasons = sorted({f"{d.tolerance.relative:g}: {d.tolerance.reason}" for d in moved})
    return "\n".join([*rows, "", "Tolerances, relative:", *reasons])


def collect(folder: Path, surfaces: list[str]) -> dict[str, float]:
    """Numbers of all seeds of surfaces, from the statistics in a results folder: ``surface/seed1/name``."""
    numbers = {}
    for surface in surfaces:
        path = folder / "statistics" / f"{surface}.nc"
        if not path.exists():
            continue
        of_seeds = dataset.read(path)
        laterals = of_seeds["lateral"].values if "lateral" in of_seeds.dims else [""]
        for seed in of_seeds["seed"].values:
            for number, lateral in enumerate(laterals):
                one = of_seeds.sel(seed=seed, **({"lateral": lateral} if lateral else {}))
                if number == 0:
                    found, start = numbers_of_seed(one) | numbers_of_patches(one), f"{surface}/seed{seed}"
                else:
                    found = numbers_of_stress(one.sel(quantity=list(OF_UNIFORM_MODE))) | numbers_of_patches(
                        one
                    )
                    start = f"{surface}/seed{seed}/{lateral}"
                numbers |= {f"{start}/{name}": value for name, value in found.items()}
    return numbers


def collect_statements(path: Path) -> dict[str, Number]:
    """Numbers and verdicts of all statements: ``statement.name/options/value``."""
    numbers: dict[str, Number] = {}
    for row in pd.read_csv(path).to_dict("records") if path.exists() else ():
        options = " ".join(map(str, json.loads(row["interpretation"]).values()))
        start = f"{row['identifier']}/{options}".rstrip("/")
        numbers |= {f"{start}/statement.{name}": row[name] for name in OF_STATEMENT}
    return numbers


def numbers_of_seed(statistics: xr.Dataset) -> dict[str, float]:
    """Numbers of one seed by their names in the reference; those along `poisson` end in ``@ratio``."""
    numbers = {name: float(statistics[variable]) for name, variable in OF_SEED.items()}
    return numbers | numbers_of_stress(statistics)


def numbers_of_stress(statistics: xr.Dataset) -> dict[str, float]:
    """Numbers of the stress of one seed."""
    numbers = {}
    for ratio in statistics["poisson"].values:
        one = statistics.sel(poisson=ratio)
        numbers |= {f"{name}@{ratio:g}": float(one[variable]) for name, variable in OF_POISSON.items()}
        for quantity in statistics["quantity"].values:
            peaks = one.sel(quantity=quantity)
            values = {name: peaks[variable] for name, variable in OF_PEAKS.items()}
            values |= {
                name: peaks["seed_peak_quantile"].sel(level=level) for name, level in PERCENTILES.items()
            }
            numbers |= {f"{quantity}.{name}@{ratio:g}": float(value) for name, value in values.items()}
    return numbers


def numbers_of_patches(statistics: xr.Dataset) -> dict[str, float]:
    """Correlations of depth and patch of one seed under the interpretations of the claims."""
    found = statistics["seed_patch_correlation"]
    return {
        f"{patches}.depth_patch_correlation@{ratio:g}": float(found.sel(patches=patches, poisson=ratio))
        for patches in found["patches"].values
        for ratio in found["poisson"].values
    }


def run(folder: str, cores: int, surfaces: list[str], engine: str) -> None:
    """Run the quick study up to the statistics of some surfaces, or to the verdicts."""
    targets = [f"{folder}/statistics/{surface}.nc" for surface in surfaces] or [f"{folder}/claims.csv"]
    command = ["snakemake", "--cores", str(cores), "--configfile", CONFIG]
    settings = ["--config", f"results={folder}", f"fft_engine={engine}"]
    found = subprocess.run([*command, *settings, "--", *targets], capture_output=True, text=True)
    if found.returncode:
        sys.exit(found.stdout + found.stderr)


def main() -> None:
    """Compare with the reference, or rewrite it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", default="results/check", help="folder of the results (%(default)s)")
    parser.add_argument("--no-run", action="store_true", help="compare what is there")
    parser.add_argument("--update", action="store_true", help="rewrite the reference")
    parser.add_argument("--surfaces", nargs="+", help=f"only these surfaces of {CONFIG}")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument(
        "--fft-engine",
        choices=ENGINES,
        default=DEFAULT,
        help="engine of the Fourier transforms (%(default)s)",
    )
    chosen = parser.parse_args()
    if chosen.update and chosen.surfaces:
        parser.error("--update rewrites the whole reference; leave out --surfaces")
    surfaces = chosen.surfaces or list(load(CONFIG)["surfaces"])
    if not chosen.no_run:
        run(chosen.results, chosen.cores, chosen.surfaces or [], chosen.fft_engine)
    found: dict[str, Number] = {**collect(Path(chosen.results), surfaces)}
    if not chosen.surfaces:
        found |= collect_statements(Path(chosen.results, "interpretations.csv"))
    if not found:
        sys.exit(f"{chosen.results}: no statistics; run without --no-run")
    if chosen.update:
        REFERENCE.parent.mkdir(parents=True, exist_ok=True)
        REFERENCE.write_text(json.dumps(found, indent=0, sort_keys=True) + "\n", encoding="utf-8")
        print(f"{REFERENCE}: {len(found)} numbers")
        return
    reference = json.loads(REFERENCE.read_text(encoding="utf-8"))
    if chosen.surfaces:
        reference = {name: value for name, value in reference.items() if name.split("/")[0] in surfaces}
    moved = drifts(reference, found)
    if moved:
        sys.exit(f"{len(moved)} of {len(reference)} numbers drifted:\n{table(moved)}")
    print(f"{len(reference)} numbers as in {REFERENCE}")


if __name__ == "__main__":
    main()
