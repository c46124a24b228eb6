"""Rule validation: one comparison with a closed form, finite elements or high precision."""

from asperity.results import dataset
from asperity.study.runtime.job import job
from asperity.study.validation.table import COMPARISONS, title

name, settings = snakemake.wildcards.validation, snakemake.params.settings
with job(snakemake):
    dataset.write(
        COMPARISONS[name](**settings),
        snakemake.output[0],
        title=title(name),
        settings={"validation": {name: settings}},
    )
