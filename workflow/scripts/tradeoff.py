"""Rule tradeoff: errors and costs of every parameter of accuracy, and the tables that plans are made from."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.cost.measured import as_json
from asperity.study.cost.measurement import measure, reduce_runs
from asperity.study.cost.tables import errors_for_reader, errors_frame, presets_for_reader, presets_frame
from asperity.study.runtime.job import job

with job(snakemake) as progress:
    settings = snakemake.params.settings
    runs = measure(**settings, progress=progress)
    dataset.write(
        runs,
        snakemake.output.runs,
        title="Speed and accuracy",
        settings={"tradeoff": settings},
    )
    measured = reduce_runs(runs)
    write_text(snakemake.output.measured, as_json(measured))
    presets, errors = presets_frame(measured), errors_frame(measured)
    write_table(presets, "presets", snakemake.output.presets)
    write_table(errors, "tradeoff", snakemake.output.errors)
    tables = {"Presets": presets_for_reader(presets), "One parameter at a time": errors_for_reader(errors)}
    text = "\n\n".join(map(markup.markdown, tables.values()))
    write_text(snakemake.output.table, f"{text}\n")
    write_text(snakemake.output.page, markup.page("Speed and accuracy", tables))
