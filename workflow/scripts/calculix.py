"""Rule calculix: the diagonal plane of the slab by CalculiX, beside the spectral solver."""

from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.validation import comparisons as validation

with log_to(snakemake.log[0]), ProgressBar("validation calculix"):
    found = validation.compare_calculix(snakemake.params.folder)
    dataset.write(
        found,
        snakemake.output[0],
        title="Validation: the diagonal plane by the spectral solver and by CalculiX",
        settings={"validation": {"calculix": dict(found.attrs)}},
    )
