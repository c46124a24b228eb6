"""Rule validation_table: the table of all comparisons with their errors and bounds."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.runtime.logs import log_to
from asperity.validation.table import for_reader, frame, markdown, table_rows

with log_to(snakemake.log[0], snakemake.output):
    datasets = {name: dataset.read(path) for name, path in snakemake.params.results.items()}
    rows = table_rows(datasets)
    write_text(snakemake.output.table, markdown(rows))
    write_table(frame(rows), "validation", snakemake.output.numbers)
    page = markup.page("Validation", {"": for_reader(rows)})
    write_text(snakemake.output.page, page)
