"""Rule summary: the numbers of one surface and one seed."""

from asperity.pipeline.summary import summarise, write
from asperity.results import dataset
from asperity.runtime.progress import Progress, record

with record(snakemake.log[0]), Progress(f"summary {snakemake.wildcards.surface}"):
    stages = {stage: dataset.read(snakemake.input[stage]) for stage in ("surface", "contact", "stress")}
    write(summarise(**stages), snakemake.output[0])
