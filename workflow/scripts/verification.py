"""Rule verification: the results of one surface against the laws that they must obey."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity import markup
from asperity.engines import fft_engine
from asperity.pipeline.statistics import SeedResults
from asperity.pipeline.verification import verify
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

surface, files = snakemake.wildcards.surface, snakemake.input
with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine, *snakemake.input.wisdom),
    ProgressBar(f"verification {surface}") as progress,
):
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    checks = verify(surface, results, dataset.read(files.statistics), progress)
    write_table(checks, "verification", snakemake.output.table)
    page = markup.page(f"Verification of {surface}", {"": checks.drop(columns="surface")})
    write_text(snakemake.output.page, page)
