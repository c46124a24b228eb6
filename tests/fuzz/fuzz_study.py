"""Random search for accepted configurations that a study does not finish.

    python tests/fuzz/fuzz_study.py --minutes 10 --seed 1

Changes up to three settings of a tiny study at random, often to the ends of their ranges. A configuration
that the check accepts is run to its end. Prints each failure with its configuration, and a table of what
became of the configurations; the exit status is 1 if there is a failure.
"""

import argparse
import os
import random
import shutil
import signal
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
studies: {mine: [one]}
layer: {poisson: 0.33}
contact: {path_area_fractions: [0.05, 0.1]}
stress: {poisson: [0.33]}
statistics: {resamples: 10}
"""
SECTIONS = """
validation.load_area: {points: 32, method: gfmd}
validation.slab_load_area: {points: 64, method: active_set, steps: 2}
validation.grid_convergence: {points: [16, 32]}
validation.elements: {meshes: [[4, 4], [6, 6]], points: 32}
validation.punch: {points: 64, samples: 11}
validation.stability: {per_decade: 1}
measured.map:
  {label: map, file: config/measured/fault.asc, periodic: mirrored, wavelength_short: 0.125, points: 64}
"""
"""Sections that are added to some studies."""

LARGEST = 128
"""Largest grid and longest list that is tried, for the sake of time."""

LABELS = ["a b", "$x$", "$H = 0.2$", r"$\frac{1}$", "$$", "µ ✓", "a_b^c", "%s {x}", "<b>&", "$x", "\\"]
MEASURED = ("periodic", "detrend", "undefined", "wavelength_short", "points", "despike", "height_factor")
KEYS = """
    accuracy figures claims surfaces.one.label surfaces.one.hurst surfaces.one.wavelength_long
    surfaces.one.wavelength_short surfaces.one.rms_height surfaces.one.points surfaces.one.moments
    surfaces.one.johnson layer.height layer.bottom layer.poisson layer.lateral layer.half_space_tolerance
    contact.method contact.area_fraction contact.path_area_fractions contact.tolerance contact.precision
    stress.poisson stress.tolerance stress.depth_spacing statistics.bins statistics.confidence
"""


def drawn(entry, generator):
    """A value that a setting's type and range allow, or hardly not."""
    kind = entry.get("type")
    if "enum" in entry:
        return generator.choice(entry["enum"])
    if entry.get("format") == "label":
        return generator.choice(LABELS)
    if kind == "boolean":
        return generator.random() < 0.5
    if kind in ("number", "integer"):
        return drawn_number(entry, generator)
    if kind == "array":
        least = entry.get("minItems", 1)
        values = [drawn(entry["items"], generator) for _ in range(generator.randint(least, max(least, 3)))]
        return sorted(values) if entry["items"].get("type") in ("number", "integer") else values
    return {
        name: drawn(below, generator)
        for name, below in entry["properties"].items()
        if name in entry.get("required", ()) or generator.random() < 0.3
    }


def drawn_number(entry, generator):
    """A number at an end of its range, or between them, evenly or over the orders of magnitude."""
    low = entry.get("minimum", entry.get("exclusiveMinimum", -1e3))
    high = entry.get("maximum", entry.get("exclusiveMaximum", 1e3))
    if entry["type"] == "integer":
        high = min(high, max(LARGEST, low))
        return generator.choice([low, high, generator.randint(low, high)])
    value = generator.choice(
        [low, high, generator.uniform(low, high), high * 10.0 ** generator.uniform(-9, 0)]
    )
    is_allowed = (
        entry.get("exclusiveMinimum", -1e4) < value < entry.get("exclusiveMaximum", 1e4) and value >= low
    )
    return float(value) if is_allowed else drawn_number(entry, generator)


def put(config, key, value):
    """Set a value under a dotted key."""
    *groups, name = key.split(".")
    for group in groups:
        config = config.setdefault(group, {})
    config[name] = value


def random_configuration(generator):
    """The tiny study with up to three settings at random, and at times with another section."""
    config, sections, keys = yaml.safe_load(BASE), yaml.safe_load(SECTIONS), KEYS.split()
    if generator.random() < 0.35:
        section = generator.choice(list(sections))
        put(config, section, sections[section])
        names = MEASURED if section == "measured.map" else sections[section]
        keys = [f"{section}.{name}" for name in names] + generator.sample(keys, 2)
        if section == "measured.map":
            config["studies"]["mine"].append("map")
    for key in generator.sample(keys, min(len(keys), generator.randint(1, 3))):
        schema_key = key.replace("surfaces.one", "surfaces.NAME").replace("measured.map", "measured.NAME")
        put(config, key, drawn(setting(schema_key), generator))
    ratio = config["layer"]["poisson"]
    if ratio not in config["stress"]["poisson"] and generator.random() < 0.8:
        config["stress"]["poisson"].append(ratio)
    return config


def outcome(folder, path):
    """How a study ends, and the last line that it prints."""
    for name in ("results", ".snakemake"):
        shutil.rmtree(folder / name, ignore_errors=True)
    log = folder / "study.log"
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(
            ("snakemake", "--cores", "2", "--configfile", path),
            cwd=folder,
            env=environment(folder),
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return "slow", ""
    lines = log.read_text(encoding="utf-8").splitlines()
    if process.returncode == 0:
        return "finished", lines[-1]
    return "failed", next(
        (line for line in lines if line.startswith(("study: results", "config:"))), lines[-1]
    )


def main():
    """Search for the time given, and print what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    generator = random.Random(chosen.seed)
    until = time.monotonic() + 60 * chosen.minutes
    counts = Counter()
    print(f"seed {chosen.seed}", flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = copy_project(Path(scratch) / "project")
        os.chdir(folder)
        path = Path("fuzzed.yaml")
        while time.monotonic() < until:
            config = random_configuration(generator)
            text = yaml.safe_dump(config, default_flow_style=None, sort_keys=False, width=1000)
            path.write_text(text, encoding="utf-8")
            try:
                read_study([path])
            except ConfigError:
                counts["refused"] += 1
                continue
            end, line = outcome(folder, str(path))
            counts[end] += 1
            if end != "finished":
                print(f"{end}: {line}\n  {text.replace(chr(10), chr(10) + '  ')}", flush=True)
    print("\n| configurations | number |\n|---|---|")
    print("\n".join(f"| {name} | {counts[name]} |" for name in ("refused", "finished", "slow", "failed")))
    sys.exit(bool(counts["failed"]))


if __name__ == "__main__":
    main()
