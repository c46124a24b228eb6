"""Random search for accepted configurations that a study does not finish.

    python tests/fuzz/fuzz_study.py --minutes 10 --seed 1

Changes up to three settings of a tiny study at random, often to the ends of their ranges. A configuration
that the check accepts is run to its end. Prints each failure with its configuration, and a table of what
became of the configurations; the exit status is 1 if there is a failure.
"""

import argparse
import os
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import yaml

sys.path.insert(0, str(Path(__file__).parents[1] / "workflow"))
from project import copy_project, environment

from asperity.core.errors import ConfigError
from asperity.study.config.schema import setting
from asperity.study.config.study import read_study

SECONDS = 300
"""Time after which a study is stopped; it counts as slow, not as a failure."""

BASE = """
accuracy: draft
seeds: [1]
surfaces:
  one: {label: one, hurst: 0.8, wavelength_long: 0.5, wavelength_short: 0.125, rms_height: 1.0e-3, points: 64}
measured:
  map: {label: map, file: config/measured/fault.asc, periodic: mirrored, wavelength_short: 0.125, points: 64}
studies: {mine: [one, map]}
layer: {poisson: 0.33}
contact: {path_area_fractions: [0.05, 0.1]}
stress: {poisson: [0.33]}
statistics: {resamples: 10}
"""

LARGEST = 128
"""Largest grid and longest list that is tried, for the sake of time."""

LABELS = ["a b", "$x$", "$H = 0.2$", r"$\frac{1}$", "$$", "µ ✓", "a_b^c", "%s {x}", "<b>&", "$x", "\\"]
KEYS = """
    accuracy figures claims surfaces.one.label surfaces.one.hurst surfaces.one.wavelength_long
    surfaces.one.wavelength_short surfaces.one.rms_height surfaces.one.points surfaces.one.moments
    surfaces.one.johnson measured.map.periodic measured.map.detrend measured.map.undefined
    measured.map.wavelength_short measured.map.points measured.map.despike measured.map.height_factor
    layer.height layer.bottom layer.poisson layer.lateral layer.half_space_tolerance contact.method
    contact.area_fraction contact.path_area_fractions contact.tolerance contact.precision
    stress.poisson stress.tolerance stress.depth_spacing statistics.bins statistics.confidence
"""


def drawn(entry, generator):
    """A value of a setting's type, at an end of its range, or within it; the check may refuse it."""
    kind = entry.get("type")
    if "enum" in entry:
        return generator.choice(entry["enum"])
    if entry.get("format") == "label":
        return generator.choice(LABELS)
    if kind == "boolean":
        return generator.random() < 0.5
    if kind in ("number", "integer"):
        low = entry.get("minimum", entry.get("exclusiveMinimum", -1e3))
        high = entry.get("maximum", entry.get("exclusiveMaximum", 1e3))
        if kind == "integer":
            return generator.choice([low, generator.randint(low, min(high, max(LARGEST, low)))])
        small = high * 10.0 ** generator.uniform(-9, 0)
        return float(generator.choice([low, high, generator.uniform(low, high), small]))
    if kind == "array":
        values = [drawn(entry["items"], generator) for _ in range(generator.randint(1, 3))]
        return sorted(values) if entry["items"].get("type") in ("number", "integer") else values
    return {name: drawn(below, generator) for name, below in entry["properties"].items()}


def random_configuration(generator):
    """The tiny study with up to three settings at random."""
    config = yaml.safe_load(BASE)
    for key in generator.sample(KEYS.split(), generator.randint(1, 3)):
        *groups, name = key.split(".")
        group = config
        for each in groups:
            group = group[each]
        named = key.replace("surfaces.one", "surfaces.NAME").replace("measured.map", "measured.NAME")
        group[name] = drawn(setting(named), generator)
    if config["layer"]["poisson"] not in config["stress"]["poisson"]:
        config["stress"]["poisson"].append(config["layer"]["poisson"])
    return config


def outcome(folder, path):
    """How a study ends, and the last line that it prints."""
    command = [
        "timeout",
        "--signal=KILL",
        str(SECONDS),
        "snakemake",
        "--cores",
        "2",
        "--forceall",
        "--nolock",
    ]
    found = subprocess.run(
        [*command, "--configfile", path],
        cwd=folder,
        env=environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    end = {0: "finished", 137: "slow", -9: "slow"}.get(found.returncode, "failed")
    lines = found.stdout.splitlines()
    return end, next((line for line in lines if line.startswith(("study: ", "config:"))), lines[-1])


def main():
    """Search for the time given, and print what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    generator, counts = random.Random(chosen.seed), Counter()
    until = time.monotonic() + 60 * chosen.minutes
    print(f"seed {chosen.seed}", flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = copy_project(Path(scratch) / "project")
        os.chdir(folder)
        path = Path("fuzzed.yaml")
        while time.monotonic() < until:
            text = yaml.safe_dump(random_configuration(generator), sort_keys=False, width=1000)
            path.write_text(text, encoding="utf-8")
            try:
                read_study([path])
            except ConfigError:
                counts["refused"] += 1
                continue
            end, line = outcome(folder, str(path))
            counts[end] += 1
            if end != "finished":
                print(f"{end}: {line}\n{text}", flush=True)
    print(dict(counts))
    sys.exit(bool(counts["failed"]))


if __name__ == "__main__":
    main()
