"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, and the laws they obey."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.study.stages.verification import Verification

files, params, output = snakemake.input, snakemake.params, snakemake.output
name = snakemake.wildcards.surface
with job(snakemake):
    verification = Verification(name)
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    statistics = surface_statistics(verification.checked(results), **params.statistics)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {
        "statistics": params.statistics,
        "seed": statistics["seed"].values.tolist(),
    }
    dataset.write(statistics, output.statistics, f"Statistics of rough surface {name}", settings)
    checks = verification.table(statistics)
    write_table(checks, "verification", output.checks)
    page = markup.page(f"Verification of {name}", {"": checks.drop(columns="surface")})
    write_text(output.page, page)
