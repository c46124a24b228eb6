"""Rule validation_table: the table of all comparisons with their errors and bounds."""

from pathlib import Path

from asperity.results import dataset, markup
from asperity.results.tables import write_table
from asperity.runtime.logs import log_to
from asperity.validation.table import for_reader, frame, markdown, table_rows

with log_to(snakemake.log[0]):
    datasets = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    rows = table_rows(datasets)
    Path(snakemake.output.table).write_text(markdown(rows), encoding="utf-8")
    write_table(frame(rows), "validation", snakemake.output.numbers)
    page = markup.page("Validation", {"": for_reader(rows)})
    Path(snakemake.output.page).write_text(page, encoding="utf-8")
