"""Rule machine_code: compile the numba functions of the library for the jobs that call them."""

from pathlib import Path

from asperity.runtime.compiling import PARTS, describe
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

part = snakemake.wildcards.part
with log_to(snakemake.log[0], snakemake.output), ProgressBar(f"machine code {part}"):
    PARTS[part]()
    Path(snakemake.output[0]).write_text(describe(part), encoding="utf-8")
