"""Rule tradeoff_figures: error against time, errors by source, cost against grid size."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.accuracy.reduction import reduce_runs
from asperity.paper.figures import tradeoff
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.views.style import save, style

with log_to(snakemake.log[0], snakemake.output), style(snakemake.input.style):
    runs = dataset.read(snakemake.input.runs)
    for name, figure in tradeoff.draw(runs, reduce_runs(runs)).items():
        save(figure, *(path for path in snakemake.output if name in path))
