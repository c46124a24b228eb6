"""Rule ensemble_plan: seeds of every grid in the next round, from the samples of the round before."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


import logging

from asperity.paper.ensemble.planning import Plan, next_plan
from asperity.paper.ensemble.samples import read_samples
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

claim, params = snakemake.wildcards.claim, snakemake.params
with log_to(snakemake.log[0], snakemake.output), ProgressBar(f"plan {claim}"):
    earlier = Plan.of_entries(params.earlier)
    samples = read_samples(claim, params.surfaces, params.files).first(earlier.seeds)
    error = float(snakemake.wildcards.error)
    plan = next_plan(earlier, samples, params.times, error, params.settings, params.wavelengths)
    for line in plan.text:
        logging.getLogger("asperity").info("%s: %s", claim, line)
    plan.write(snakemake.output[0])
