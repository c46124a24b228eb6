"""Rule validation_table: the table of all comparisons with their errors and bounds."""

from pathlib import Path

from asperity.results import dataset, markup
from asperity.runtime.logs import log_to
from asperity.validation.table import markdown, table_rows, text_rows

with log_to(snakemake.log[0], snakemake.output):
    datasets = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    rows = table_rows(datasets)
    Path(snakemake.output.table).write_text(markdown(rows), encoding="utf-8")
    page = markup.page("Validation", {"": text_rows(rows)})
    Path(snakemake.output.page).write_text(page, encoding="utf-8")
