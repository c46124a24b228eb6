"""Rule stress: the stress inside the solid, its peaks and its decay."""

from asperity.pipeline.stress import compute_stress
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with (
    log_to(snakemake.log[0], snakemake.output),
    ProgressBar(f"stress {snakemake.wildcards.surface}") as progress,
):
    contact = dataset.read(snakemake.input.contact)
    settings = dataset.settings_of(contact) | {"stress": snakemake.params.stress}
    dataset.write(
        compute_stress(contact, settings["layer"], snakemake.params.stress, progress=progress),
        snakemake.output[0],
        title=f"Stress under rough surface {snakemake.wildcards.surface}, seed {snakemake.wildcards.seed}",
        settings=settings,
    )
