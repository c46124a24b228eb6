"""Rule stress: the stress inside the solid, its peaks and its decay."""

from asperity.results import dataset
from asperity.stress.analysis import SOUGHT
from asperity.study.progress_and_log import job
from asperity.study.stages.stress import stress_of_seed

params = snakemake.params
name, seed = snakemake.wildcards.surface, snakemake.wildcards.seed
with job(snakemake) as progress:
    contact = dataset.read(snakemake.input.contact)
    settings = dataset.settings_of(contact) | {"stress": params.stress}
    quantities = [*SOUGHT, *params.quantities]
    dataset.write(
        stress_of_seed(contact, settings["layer"], params.stress, params.laterals, quantities, progress),
        snakemake.output[0],
        title=f"Stress under rough surface {name}, seed {seed}",
        settings=settings,
    )
