"""Rule calculix: fields on the diagonal plane of the slab by the spectral solver and by CalculiX."""

from asperity.results import dataset
from asperity.runtime.progress import Progress, record
from asperity.validation.finite_elements import compare_calculix

with record(snakemake.log[0]), Progress("validation calculix"):
    compared = compare_calculix(snakemake.params.folder)
    dataset.write(
        compared,
        snakemake.output[0],
        title="Validation: fields on the diagonal plane by the spectral solver and by CalculiX",
        settings={"validation": {"calculix": dict(compared.attrs)}},
    )
