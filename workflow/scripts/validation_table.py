"""Rule validation_table: the table of all comparisons."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.study.validation.table import for_reader, frame, markdown, table_rows

with job(snakemake):
    rows = table_rows({name: dataset.read(path) for name, path in snakemake.params.results.items()})
    write_text(snakemake.output.table, markdown(rows))
    write_table(frame(rows), "validation", snakemake.output.numbers)
    write_text(snakemake.output.page, markup.page("Validation", {"": for_reader(rows)}))
