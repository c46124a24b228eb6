"""Rule body: the stress inside the solid, its peaks and its decay."""

from asperity import dataset
from asperity.progress import Progress, record
from asperity.study.body import analyse_body

with record(snakemake.log[0]), Progress(f"body {snakemake.wildcards.surface}") as progress:
    contact = dataset.read(snakemake.input.contact)
    settings = dataset.settings_of(contact) | {"body": snakemake.params.body}
    dataset.write(
        analyse_body(contact, settings["layer"], snakemake.params.body, progress=progress),
        snakemake.output[0],
        title=f"Stress under rough surface {snakemake.wildcards.surface}, seed {snakemake.wildcards.seed}",
        settings=settings,
    )
