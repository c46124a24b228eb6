"""Rule ensemble_result: a number with its errors, its levels, and the figure beside plain Monte Carlo."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity import markup
from asperity.paper.ensemble import figure
from asperity.paper.ensemble.numbers import number
from asperity.paper.ensemble.planning import Plan
from asperity.paper.ensemble.result import level_frame, result, sentences
from asperity.paper.ensemble.samples import read_samples
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.views.style import save, style

claim, params, output = snakemake.wildcards.claim, snakemake.params, snakemake.output
with (
    log_to(snakemake.log[0], snakemake.output),
    ProgressBar(f"ensemble {claim}"),
    style(snakemake.input.style),
):
    plan = Plan.read(snakemake.input.plan)
    data = result(plan, read_samples(claim, params.surfaces, params.files))
    dataset.write(
        data,
        output.data,
        title=f"Ensemble of {claim}",
        settings={"claim": claim, "error": float(snakemake.wildcards.error), "surfaces": params.surfaces},
    )
    levels = level_frame(data)
    write_text(output.table, levels.to_csv(index=False, lineterminator="\n"))
    text = f"{sentences(claim, number(claim).quantity, data)}\n\n{markup.markdown(levels)}\n"
    write_text(output.text, text)
    save(figure.draw({claim: data}), output.picture)
