"""Rule ensemble_gains: gains of all numbers that the samples of the configuration's numbers know."""

from pathlib import Path

from asperity.paper.ensemble.gains import gain_frame, known_numbers
from asperity.results import markup
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

params, output = snakemake.params, snakemake.output
with log_to(snakemake.log[0]), ProgressBar("gains of the ensemble"):
    known = known_numbers(params.roles, params.files, params.laterals)
    table = gain_frame(known, params.files, params.error, params.fewest)
    table.to_csv(output.table, index=False)
    text = markup.markdown(table.drop(columns="quantity", errors="ignore"))
    Path(output.text).write_text(f"{text}\n", encoding="utf-8")
