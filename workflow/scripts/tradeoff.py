"""Rule tradeoff: errors and costs of every parameter of accuracy, and the tables that plans are made from."""

from asperity.accuracy.measured import as_json
from asperity.accuracy.measurement import measure
from asperity.accuracy.reduction import reduce_runs
from asperity.accuracy.tables import error_rows, preset_rows
from asperity.results import dataset, markup
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with log_to(snakemake.log[0], snakemake.output), ProgressBar("tradeoff") as progress:
    settings = snakemake.params.settings
    runs = measure(**settings, progress=progress)
    dataset.write(
        runs,
        snakemake.output.runs,
        title="Speed and accuracy",
        settings={"tradeoff": settings},
    )
    measured = reduce_runs(runs)
    dataset.write_text(snakemake.output.measured, as_json(measured))
    tables = {"Presets": preset_rows(measured), "One parameter at a time": error_rows(measured)}
    text = "\n\n".join(map(markup.markdown, tables.values()))
    dataset.write_text(snakemake.output.table, f"{text}\n")
    dataset.write_text(snakemake.output.page, markup.page("Speed and accuracy", tables))
