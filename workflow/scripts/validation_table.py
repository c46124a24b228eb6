"""Rule validation_table: what is compared with what, by how much they differ, and the bound."""

from pathlib import Path

from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.validation import comparisons as validation

with log_to(snakemake.log[0]):
    results = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    Path(snakemake.output[0]).write_text(validation.markdown(validation.table(results)), encoding="utf-8")
