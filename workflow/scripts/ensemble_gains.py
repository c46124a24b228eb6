"""Rule ensemble_gains: gains of all numbers that the samples of the configuration's numbers know."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity import markup
from asperity.paper.ensemble.gains import gain_frame, known_numbers
from asperity.results.atomic import write_text
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

params, output = snakemake.params, snakemake.output
with log_to(snakemake.log[0], output), ProgressBar("gains of the ensemble"):
    known = known_numbers(params.roles, params.files, params.laterals)
    table = gain_frame(known, params.files, params.error, params.fewest)
    write_text(output.table, table.to_csv(index=False, lineterminator="\n"))
    text = markup.markdown(table.drop(columns="quantity", errors="ignore"))
    write_text(output.text, f"{text}\n")
