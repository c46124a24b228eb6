"""Rule compiled: the compiled functions of the library, ready for the jobs that call them."""

from pathlib import Path

from asperity.compiled import compile_library, describe
from asperity.progress import Progress, record

with record(snakemake.log[0]), Progress("compiled") as progress:
    compile_library(progress=progress)
    Path(snakemake.output[0]).write_text(describe(), encoding="utf-8")
