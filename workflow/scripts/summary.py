"""Rule summary: the numbers of one surface and one seed."""

from asperity.pipeline.summary import summarise, write
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with log_to(snakemake.log[0]), ProgressBar(f"summary {snakemake.wildcards.surface}"):
    stages = {stage: dataset.read(snakemake.input[stage]) for stage in ("surface", "contact", "stress")}
    write(summarise(**stages), snakemake.output[0])
