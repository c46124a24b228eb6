"""Rule compiled: the compiled functions of the library, ready for the jobs that call them."""

from pathlib import Path

from asperity.runtime.compiling import PARTS, describe
from asperity.runtime.progress import Progress, record

part = snakemake.wildcards.part
with record(snakemake.log[0]), Progress(f"compiled {part}"):
    PARTS[part]()
    Path(snakemake.output[0]).write_text(describe(part), encoding="utf-8")
