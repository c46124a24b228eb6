"""What the study cost: processor minutes and largest memory of every rule, from its benchmark files.

python workflow/cost.py [results]
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results") / "benchmark"
jobs: dict[str, list[tuple[float, float]]] = defaultdict(list)
for path in sorted(folder.rglob("*.tsv")):
    with open(path, encoding="utf-8") as file:
        (row,) = csv.DictReader(file, delimiter="\t")
    rule, *surface = path.relative_to(folder).with_suffix("").parts
    name = f"{rule} {surface[0]}" if len(surface) > 1 else rule
    jobs[name].append((float(row["cpu_time"]) / 60, float(row["max_rss"]) / 1024))
if not jobs:
    sys.exit(f"{folder}: no benchmark files; run the study first")

print("| rule | jobs | processor minutes | largest memory (GiB) |\n|---|---|---|---|")
for name, costs in sorted(jobs.items()):
    minutes, memory = zip(*costs, strict=True)
    print(f"| {name} | {len(costs)} | {sum(minutes):.1f} | {max(memory):.1f} |")
every = [cost for costs in jobs.values() for cost in costs]
minutes, memory = zip(*every, strict=True)
print(f"| all | {len(every)} | {sum(minutes):.1f} | {max(memory):.1f} |")
