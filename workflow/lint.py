"""Run `snakemake --lint` without its advice to give each rule an environment of its own.

All rules share one environment, which the Makefile makes from requirements.lock.
"""

import subprocess
import sys

IGNORED = "    * Specify a conda environment or container for each rule.:"

run = subprocess.run(["snakemake", "--lint"], capture_output=True, text=True)
report = run.stdout + run.stderr
advice = [line for line in report.splitlines() if line.startswith("    * ")]
if any(line != IGNORED for line in advice) or (run.returncode and not advice):
    sys.exit(report)
