"""Rule verification: the files of one surface held against the laws that they must obey."""

import csv

from asperity.pipeline.verification import require, verify_member, verify_statistics
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

STAGES = ("surface", "contact", "stress")

with log_to(snakemake.log[0]), ProgressBar(f"verification {snakemake.wildcards.surface}") as progress:
    found, stresses = [], []
    for number, seed in enumerate(snakemake.params.seeds):
        stages = [dataset.read(snakemake.input[stage][number]) for stage in STAGES]
        found += [(f"seed {seed}", check) for check in verify_member(*stages)]
        stresses.append(stages[-1])
        progress(number + 1, len(snakemake.params.seeds))
    statistics = dataset.read(snakemake.input.statistics)
    found += [("all seeds", check) for check in verify_statistics(statistics, stresses)]
    require([check for _, check in found], snakemake.wildcards.surface)
    with open(snakemake.output[0], "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["surface", "of", "check", "value", "bound"])
        table.writerows([snakemake.wildcards.surface, part, *check] for part, check in found)
