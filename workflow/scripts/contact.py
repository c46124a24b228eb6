"""Rule contact: the solid pressed against a rough surface, and its load-area curve."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.pipeline.contact import solve_contact
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine, *snakemake.input.wisdom),
    ProgressBar(f"contact {snakemake.wildcards.surface}") as progress,
):
    surface = dataset.read(snakemake.input.surface)
    layer, contact = snakemake.params.layer, snakemake.params.contact
    dataset.write(
        solve_contact(surface, layer, contact, progress=progress),
        snakemake.output[0],
        title=f"Contact with rough surface {snakemake.wildcards.surface}, seed {snakemake.wildcards.seed}",
        settings={**dataset.settings_of(surface), "layer": layer, "contact": contact},
    )
