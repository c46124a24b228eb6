"""Rule calculix: fields on the diagonal plane of the slab by the spectral solver and by CalculiX."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.validation.finite_elements import compare_calculix

with log_to(snakemake.log[0], snakemake.output), ProgressBar("validation calculix"):
    compared = compare_calculix(snakemake.params.folder)
    dataset.write(
        compared,
        snakemake.output[0],
        title="Validation: fields on the diagonal plane by the spectral solver and by CalculiX",
        settings={"validation": {"calculix": dict(compared.attrs)}},
    )
