"""Rule stress: the stress inside the solid, its peaks and its decay."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.pipeline.stress import QUANTITIES, compute_stresses
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

surface, seed = snakemake.wildcards.surface, snakemake.wildcards.seed
with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine, *snakemake.input.wisdom),
    ProgressBar(f"stress {surface}") as progress,
):
    contact = dataset.read(snakemake.input.contact)
    settings = dataset.settings_of(contact) | {"stress": snakemake.params.stress}
    found = compute_stresses(
        contact,
        settings["layer"],
        snakemake.params.stress,
        snakemake.params.laterals,
        [*QUANTITIES, *snakemake.params.quantities],
        progress,
    )
    for (lateral, stress), path in zip(found.items(), snakemake.output, strict=True):
        dataset.write(
            stress,
            path,
            title=f"Stress under rough surface {surface}, seed {seed}",
            settings=settings | {"layer": settings["layer"] | {"lateral": lateral}},
        )
