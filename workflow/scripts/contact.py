"""Rule contact: the solid pressed against a rough surface, and its load-area curve."""

from asperity.results import dataset
from asperity.study.runtime.job import job
from asperity.study.stages.contact import solve_contact

with job(snakemake) as progress:
    surface = dataset.read(snakemake.input.surface)
    layer, contact = snakemake.params.layer, snakemake.params.contact
    dataset.write(
        solve_contact(surface, layer, contact, progress),
        snakemake.output[0],
        title=f"Contact with rough surface {snakemake.wildcards.surface}, seed {snakemake.wildcards.seed}",
        settings={**dataset.settings_of(surface), "layer": layer, "contact": contact},
    )
