"""Rule validation_table: the table of all comparisons with their errors and bounds."""

from asperity.results import dataset, markup
from asperity.runtime.logs import log_to
from asperity.validation.table import markdown, table_rows, text_rows

with log_to(snakemake.log[0], snakemake.output):
    datasets = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    rows = table_rows(datasets)
    dataset.write_text(snakemake.output.table, markdown(rows))
    page = markup.page("Validation", {"": text_rows(rows)})
    dataset.write_text(snakemake.output.page, page)
