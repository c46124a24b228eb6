"""Rule statistics: distributions over all peaks and all seeds of a surface, with their uncertainty."""

from asperity.pipeline.statistics import summarise
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with log_to(snakemake.log[0]), ProgressBar(f"statistics {snakemake.wildcards.surface}"):
    stages = {
        "surfaces": [dataset.read(path) for path in snakemake.input.surfaces],
        "contacts": [dataset.read(path).drop_dims(["y", "x"]) for path in snakemake.input.contacts],
        "stresses": [dataset.read(path) for path in snakemake.input.stresses],
    }
    settings = dataset.settings_of(stages["stresses"][0]) | {"statistics": snakemake.params.statistics}
    settings["seed"] = [dataset.settings_of(stress)["seed"] for stress in stages["stresses"]]
    dataset.write(
        summarise(**stages, **snakemake.params.statistics),
        snakemake.output[0],
        title=f"Statistics of rough surface {snakemake.wildcards.surface}",
        settings=settings,
    )
