"""Rule statistics: distributions over all peaks and all seeds of a surface, with their uncertainty."""

from asperity import dataset
from asperity.progress import Progress, record
from asperity.study.statistics import summarise

with record(snakemake.log[0]), Progress(f"statistics {snakemake.wildcards.surface}"):
    stages = {
        "surfaces": [dataset.read(path) for path in snakemake.input.surfaces],
        "contacts": [dataset.read(path).drop_dims(["y", "x"]) for path in snakemake.input.contacts],
        "bodies": [dataset.read(path) for path in snakemake.input.bodies],
    }
    settings = dataset.settings_of(stages["bodies"][0]) | {"statistics": snakemake.params.statistics}
    settings["seed"] = [dataset.settings_of(body)["seed"] for body in stages["bodies"]]
    dataset.write(
        summarise(**stages, **snakemake.params.statistics),
        snakemake.output[0],
        title=f"Statistics of rough surface {snakemake.wildcards.surface}",
        settings=settings,
    )
