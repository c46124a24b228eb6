"""``asperity ensemble``: the mean of a number over random surfaces to a given error, by jobs of the study."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from asperity.cli.arguments import converted
from asperity.config.schema import setting
from asperity.config.study import PAPER, read_study
from asperity.errors import shown
from asperity.packages import require

SNAKEFILE = "Snakefile"


def run(options: argparse.Namespace) -> None:
    """Plan the seeds from a pilot, print the plan and its cost, compute them, and print the result."""
    require(("matplotlib", "snakemake"))
    given = {} if options.results is None else {"results": options.results}
    config = read_study(options.config or [PAPER], given)
    error = config["ensemble"]["error"] if options.error is None else error_of(options.error)
    from asperity.paper.ensemble.numbers import full_name

    name = full_name(options.claim, options.reading)
    _check(name, config)
    folder = f"{config['results']}/ensemble/{name}/error{error:g}"
    plan = f"{folder}/plan1.json"
    _snakemake(options, plan)
    from asperity.paper.ensemble.planning import Plan

    print("\n".join(Plan.read(plan).text), flush=True)
    if not options.plan:
        _snakemake(options, f"{folder}/result.nc")
        print(Path(f"{folder}/result.md").read_text(encoding="utf-8"), end="")
        print(f"\nresults   {folder}/result.nc {folder}/table.csv\npicture   {folder}/cost.png")


def error_of(text: str) -> float:
    """Error from text such as ``0.5%`` or ``0.005``.

    Raises
    ------
    ValueError
        If it is not a number > 0 and ≤ 1 then.
    """
    percent = text.strip().endswith("%")
    try:
        value = float(text.strip().removesuffix("%")) / (100 if percent else 1)
        return converted(setting("ensemble.error"), f"{value:.6g}")
    except (ValueError, argparse.ArgumentTypeError):
        raise ValueError(f"--error {shown(text)}: a share such as 0.5% or 0.005 is needed") from None


def _check(claim: str, config: dict[str, Any]) -> None:
    """Raise an error before anything is computed: for an unknown number, a missing surface or workflow."""
    from asperity.paper.claims.sources import deltas, roles, with_deltas
    from asperity.paper.ensemble.numbers import surfaces_of

    by_role, surfaces = roles(config["studies"], config["surfaces"]), config["surfaces"]
    of_delta = deltas(by_role, surfaces, config["readings"].get("delta", ()))
    surfaces_of(claim, with_deltas(by_role, of_delta), config["readings"])
    if not Path(SNAKEFILE).is_file():
        raise FileNotFoundError(
            f"{SNAKEFILE}: no such file; the command runs in the folder of the study: asperity study init DIR"
        )


def _snakemake(options: argparse.Namespace, target: str) -> None:
    """Make a file of the study; ends the process with the status of Snakemake if that fails."""
    more: Sequence[str] = options.snakemake
    command = [sys.executable, "-m", "snakemake"]
    if not any(word.split("=")[0] in ("--cores", "-c", "--profile", "--jobs", "-j") for word in more):
        command += ["--cores", str(os.cpu_count() or 1)]
    if options.config:
        command += ["--configfile", *options.config]
    if options.results is not None:
        command += ["--config", f"results={options.results}"]
    if status := subprocess.run([*command, *more, "--", target]).returncode:
        sys.exit(status)
