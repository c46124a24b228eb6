"""Rule summary: the numbers of one surface and one seed."""

from asperity import dataset
from asperity.progress import Progress, record
from asperity.summary import summarise, write

with record(snakemake.log[0]), Progress(f"summary {snakemake.wildcards.surface}"):
    stages = {stage: dataset.read(snakemake.input[stage]) for stage in ("surface", "contact", "body")}
    write(summarise(**stages), snakemake.output[0])
