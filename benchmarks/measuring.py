"""What benchmarks share: command lines, processes of their own, alternate runs and their ratios, memory."""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import t as student

from asperity.core.types import Array


def parser_of(text: str | None) -> argparse.ArgumentParser:
    """A parser of a command line, with the docstring of the script as its help."""
    return argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)


def in_own_process(script: str, *arguments: object, seconds: float = 600) -> Iterator[dict[str, Any]]:
    """The rows that a script prints as JSON, also those before it failed or took too long."""
    command = [sys.executable, script, *map(str, arguments)]
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=seconds)
        printed, ended = run.stdout, f"status {run.returncode}" if run.returncode else ""
    except subprocess.TimeoutExpired as error:
        printed, ended = (error.stdout or b"").decode(), f"not within {seconds:g} s"
    yield from (json.loads(line) for line in printed.splitlines() if line.startswith("{"))
    if ended:
        print(f"{Path(script).name} {' '.join(command[2:])}: {ended}", file=sys.stderr, flush=True)


def alternately(
    calls: Sequence[Callable[[], Any]], most: int, seconds: float, clock: Callable[[], float]
) -> Array:
    """Times of calls in turns, a row each turn: as many as `most`, or as the seconds allow, at least one."""
    rows: list[list[float]] = []
    begun = time.perf_counter()
    while len(rows) < most:
        if rows and (time.perf_counter() - begun) * (len(rows) + 1) / len(rows) > seconds:
            break
        rows.append([])
        for call in calls:
            start = clock()
            call()
            rows[-1].append(clock() - start)
    return np.array(rows)


def paired(one: Array, other: Array) -> dict[str, float]:
    """Mean ratio of paired times, `other` over `one`, with its 95 % interval (Student's t, logarithms)."""
    logarithms = np.log(np.asarray(other) / np.asarray(one))
    count = len(logarithms)
    half = student.ppf(0.975, count - 1) * logarithms.std(ddof=1) / np.sqrt(count) if count > 1 else np.nan
    ratio, low, high = np.exp(logarithms.mean() + np.array([0.0, -half, half]))
    return {"ratio": ratio, "low": low, "high": high, "pairs": count}


def in_words(table: pd.DataFrame) -> pd.Series:
    """Ratios with their intervals: ``1.44 (1.41 to 1.47)``."""
    each = table[["ratio", "low", "high"]].itertuples(index=False)
    return pd.Series(
        [f"{a:.3g}" + (f" ({b:.3g} to {c:.3g})" if np.isfinite(b) else "") for a, b, c in each], table.index
    )


def write(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Write rows as a table, whole or not at all."""
    if not rows:
        sys.exit(f"{path.name}: nothing was measured")
    path.parent.mkdir(parents=True, exist_ok=True)
    table = pd.DataFrame(rows)
    table.to_csv(path.with_suffix(".part"), index=False, float_format="%.4g", lineterminator="\n")
    os.replace(path.with_suffix(".part"), path)


def peak_memory() -> float:
    """Largest resident memory since `reset_peak_memory`, in MB."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * int(dict(line.split(":", 1) for line in lines)["VmHWM"].split()[0]) / 1e6


def reset_peak_memory() -> None:
    """Forget the peak so far."""
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
