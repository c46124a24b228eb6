"""Rule tradeoff_figures: error against time, errors by source, cost against grid size."""

from asperity.paper.figures import tradeoff
from asperity.results import dataset
from asperity.study.cost.measurement import reduce_runs
from asperity.study.runtime.job import job
from asperity.views.style import save, style

with job(snakemake), style():
    runs = dataset.read(snakemake.input.runs)
    for name, figure in tradeoff.draw(runs, reduce_runs(runs)).items():
        save(figure, *(path for path in snakemake.output if name in path))
