"""Rule validation: one comparison of the library with closed forms, finite elements or high precision."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.validation.comparisons import COMPARISONS, title

name, settings = snakemake.wildcards.validation, snakemake.params.settings
with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine),
    ProgressBar(f"validation {name}") as progress,
):
    dataset.write(
        COMPARISONS[name](**settings, progress=progress),
        snakemake.output[0],
        title=title(name),
        settings={"validation": {name: settings}},
    )
