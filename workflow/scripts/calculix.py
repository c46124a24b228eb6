"""Rule calculix: the diagonal plane of the slab by CalculiX, beside the spectral solver."""

from asperity.results import dataset
from asperity.runtime.progress import Progress, record
from asperity.validation import comparisons as validation

with record(snakemake.log[0]), Progress("validation calculix"):
    found = validation.compare_calculix(snakemake.params.folder)
    dataset.write(
        found,
        snakemake.output[0],
        title="Validation: the diagonal plane by the spectral solver and by CalculiX",
        settings={"validation": {"calculix": dict(found.attrs)}},
    )
