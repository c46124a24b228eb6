"""Rule validation_table: the table of all comparisons with their errors and bounds."""

from pathlib import Path

from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.validation.table import markdown, table_rows

with log_to(snakemake.log[0]):
    datasets = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    Path(snakemake.output[0]).write_text(markdown(table_rows(datasets)), encoding="utf-8")
