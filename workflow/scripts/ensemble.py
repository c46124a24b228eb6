"""Rule ensemble: table and figure of all numbers of the configuration."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity import markup
from asperity.paper.ensemble import figure
from asperity.paper.ensemble.result import summary_frame
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.views.style import save, style

output = snakemake.output
with log_to(snakemake.log[0], output), ProgressBar("ensemble"), style(snakemake.input.style):
    results = dict(zip(snakemake.params.claims, map(dataset.read, snakemake.input.data), strict=True))
    table = summary_frame(results)
    write_text(output.table, table.to_csv(index=False, lineterminator="\n"))
    write_text(output.text, f"{markup.markdown(table)}\n")
    save(figure.draw(results), *output.picture)
