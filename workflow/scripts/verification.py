"""Rule verification: the laws that the results of one surface obey."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.study.stages.statistics import SeedResults
from asperity.study.stages.verification import verify

surface, files = snakemake.wildcards.surface, snakemake.input
with job(snakemake) as progress:
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    checks = verify(surface, results, dataset.read(files.statistics), progress)
    write_table(checks, "verification", snakemake.output.table)
    page = markup.page(f"Verification of {surface}", {"": checks.drop(columns="surface")})
    write_text(snakemake.output.page, page)
