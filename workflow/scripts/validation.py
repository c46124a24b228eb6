"""Rule validation: one comparison of the library with closed forms, finite elements or high precision."""

from asperity.results import dataset
from asperity.runtime.progress import Progress, record
from asperity.validation.comparisons import COMPARISONS, title

name, settings = snakemake.wildcards.validation, snakemake.params.settings
with record(snakemake.log[0]), Progress(f"validation {name}") as progress:
    dataset.write(
        COMPARISONS[name](**settings, progress=progress),
        snakemake.output[0],
        title=title(name),
        settings={"validation": {name: settings}},
    )
