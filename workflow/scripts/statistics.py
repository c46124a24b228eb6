"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, and the laws they obey."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.study.stages.statistics import SeedResults, statistics_of_seeds, surface_statistics
from asperity.study.stages.verification import Verification

files, params, output = snakemake.input, snakemake.params, snakemake.output
name = snakemake.wildcards.surface
title = f"Statistics of rough surface {name}"
with job(snakemake):
    verification = Verification(name)
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    statistics = surface_statistics(verification.checked(results), **params.statistics)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {
        "statistics": params.statistics,
        "seed": statistics["seed"].values.tolist(),
    }
    dataset.write(statistics, output.statistics, title, settings)
    seeds = len(files.stress)
    for number, (lateral, path) in enumerate(zip(params.laterals, output.others, strict=True)):
        stresses = files.others[number * seeds : (number + 1) * seeds]
        results = map(SeedResults.read, files.surface, files.contact, stresses)
        layer = settings["layer"] | {"lateral": lateral}
        found = statistics_of_seeds(results)
        dataset.write(found, path, f"{title}, laterally {lateral}", settings | {"layer": layer})
    checks = verification.table(statistics)
    write_table(checks, "verification", output.checks)
    page = markup.page(f"Verification of {name}", {"": checks.drop(columns="surface")})
    write_text(output.page, page)
