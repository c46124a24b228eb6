"""Rule machine_code: compile the numba functions of the library for the jobs that call them."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.results.atomic import write_text
from asperity.runtime.compiling import PARTS, describe
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

part = snakemake.wildcards.part
with log_to(snakemake.log[0], snakemake.output), ProgressBar(f"machine code {part}"):
    PARTS[part]()
    write_text(snakemake.output[0], describe(part))
