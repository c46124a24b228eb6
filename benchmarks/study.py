"""Wall time, processor time and memory of the study, from nothing, and of a dry run.

    python benchmarks/study.py [paper] [quick] [dry-run] [--out results/benchmarks]

runs the study of the paper, the quick study, and a dry run of the paper's, on two cores, each into a new
folder that is deleted afterwards. Without arguments all three. Prints a table, and keeps its rows in
``study.csv``. Processor time is summed over all jobs and Snakemake; memory is the largest of any process.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pandas as pd
from measuring import parser_of

from asperity.study.cost.benchmark import job_costs

ROOT = Path(__file__).parents[1]
OPTIONS = {
    "paper": [],
    "quick": ["--configfile", "config/quick.yaml"],
    "dry-run": ["--dry-run", "--quiet"],
}
"""Study → options of Snakemake; those without dashes are settings, after ``--config``."""


def measure(name: str, cores: int) -> dict[str, object]:
    """Cost of one run of the study."""
    load, start = os.getloadavg()[0], time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+") as output:
        command = [sys.executable, "-m", "snakemake", "--cores", str(cores), "--nolock"]
        command += ["--config", f"results={folder}", *OPTIONS[name]]
        run = subprocess.Popen(command, cwd=ROOT, stdout=output, stderr=output)
        _, status, used = os.wait4(run.pid, 0)
        wall = time.perf_counter() - start
        if status:
            output.seek(0)
            sys.exit(output.read()[-4000:])
        jobs = job_costs(Path(folder))
    spent = used.ru_utime + used.ru_stime
    memory = jobs["memory_MB"].max() / 1e3 if len(jobs) else used.ru_maxrss / 1e6
    return {
        "study": name,
        "cores": cores,
        "wall": wall,
        "seconds": spent,
        "memory_GB": memory,
        "load_average": load,
        "date": time.strftime("%Y-%m-%d"),
    }


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("study", nargs="*", help=f"{', '.join(OPTIONS)}; all by default")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("results/benchmarks"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "study.csv"
    for name in options.study or OPTIONS:
        table = pd.DataFrame([measure(name, options.cores)])
        if path.exists():
            old = pd.read_csv(path)
            table = pd.concat([old[old["study"] != name], table])
        table.to_csv(path, index=False, float_format="%.4g", lineterminator="\n")
        print(table.tail(1).to_string(index=False), flush=True)


if __name__ == "__main__":
    main()
