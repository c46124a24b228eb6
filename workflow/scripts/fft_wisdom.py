"""Rule fft_wisdom: measured plans of FFTW for grids of one number of nodes."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.pipeline.wisdom import measure_plans
from asperity.results.atomic import write_text
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

points = int(snakemake.wildcards.points)
with log_to(snakemake.log[0], snakemake.output), ProgressBar(f"fft_wisdom {points}") as progress:
    write_text(snakemake.output[0], measure_plans([points], progress))
