"""Rule validation: comparisons with closed forms, finite elements and high precision, and their table."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.progress_and_log import job
from asperity.study.validation.table import comparison, for_reader, frame, title

chosen, output = snakemake.params.validation, snakemake.output
with job(snakemake) as progress:
    found = {}
    for (name, settings), path in zip(chosen.items(), output.results, strict=True):
        found[name] = comparison(name)(**settings)
        dataset.write(found[name], path, title(name), settings={"validation": {name: settings}})
        progress(len(found), len(chosen))
    table = frame(found)
    shown = for_reader(table)
    write_text(output.table, f"{markup.markdown(shown)}\n")
    write_table(table, "validation", output.numbers)
    tables = {"Comparisons": markup.html_table(shown)}
    write_text(
        output.page, markup.rendered("asperity.core", "base.html.j2", title="Validation", tables=tables)
    )
