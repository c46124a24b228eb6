"""Rule ensemble_samples: numbers of a few seeds of one surface on one grid."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.pipeline.ensemble import sample
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

wildcards, params = snakemake.wildcards, snakemake.params
nodes, seeds = float(wildcards.nodes), list(range(int(wildcards.first), int(wildcards.last) + 1))
label = f"samples {wildcards.surface}, {wildcards.nodes} nodes, seeds {seeds[0]} to {seeds[-1]}"
with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine),
    ProgressBar(label) as progress,
):
    sections = {name: params[name] for name in ("surface", "layer", "contact", "stress", "readings")}
    stages = params.layer, params.contact, params.stress, params.readings
    dataset.write(
        sample(params.surface, nodes, seeds, *stages, progress),
        snakemake.output[0],
        title=f"Samples of rough surface {wildcards.surface}",
        settings={"name": wildcards.surface, "nodes": nodes, "seed": seeds} | sections,
    )
