"""Rule contact: the solid pressed against a rough surface, and its load-area curve."""

from asperity import dataset
from asperity.progress import Progress, record
from asperity.study.contact import press

with record(snakemake.log[0]), Progress(f"contact {snakemake.wildcards.surface}") as progress:
    surface = dataset.read(snakemake.input.surface)
    layer, contact = snakemake.params.layer, snakemake.params.contact
    dataset.write(
        press(surface, layer, contact, progress=progress),
        snakemake.output[0],
        title=f"Contact with rough surface {snakemake.wildcards.surface}, seed {snakemake.wildcards.seed}",
        settings={**dataset.settings_of(surface), "layer": layer, "contact": contact},
    )
