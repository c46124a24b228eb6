"""Rule calculix: the diagonal plane of the slab by CalculiX, beside the spectral solver."""

from asperity import dataset, validation
from asperity.progress import Progress, record

with record(snakemake.log[0]), Progress("validation calculix"):
    found = validation.compare_calculix(snakemake.params.folder)
    dataset.write(
        found,
        snakemake.output[0],
        title="Validation: the diagonal plane by the spectral solver and by CalculiX",
        settings={"validation": {"calculix": dict(found.attrs)}},
    )
