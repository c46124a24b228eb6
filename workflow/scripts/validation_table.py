"""Rule validation_table: the table of all comparisons."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.study.validation.table import for_reader, frame

with job(snakemake):
    table = frame({name: dataset.read(path) for name, path in snakemake.params.results.items()})
    shown = for_reader(table)
    write_text(snakemake.output.table, f"{markup.markdown(shown)}\n")
    write_table(table, "validation", snakemake.output.numbers)
    write_text(snakemake.output.page, markup.page("Validation", {"": shown}))
