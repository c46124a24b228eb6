"""Rule stress: the stress inside the solid, its peaks and its decay."""

from asperity.results import dataset
from asperity.study.runtime.job import job
from asperity.study.stages.stress import QUANTITIES, compute_stresses

params = snakemake.params
name, seed = snakemake.wildcards.surface, snakemake.wildcards.seed
with job(snakemake) as progress:
    contact = dataset.read(snakemake.input.contact)
    settings = dataset.settings_of(contact) | {"stress": params.stress}
    quantities = [*QUANTITIES, *params.quantities]
    found = compute_stresses(contact, settings["layer"], params.stress, params.laterals, quantities, progress)
    for (lateral, stress), path in zip(found.items(), snakemake.output, strict=True):
        dataset.write(
            stress,
            path,
            title=f"Stress under rough surface {name}, seed {seed}",
            settings=settings | {"layer": settings["layer"] | {"lateral": lateral}},
        )
