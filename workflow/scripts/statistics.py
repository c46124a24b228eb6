"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, and the laws they obey."""

from asperity.core import markup
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.progress_and_log import job
from asperity.study.stages.statistics import (
    SeedResults,
    surface_statistics,
    verification_table,
    verify_seed,
    verify_statistics,
)

files, params, output = snakemake.input, snakemake.params, snakemake.output
name = snakemake.wildcards.surface
checks = {}


def checked_seeds():
    """Results of one seed after the other, whose fields are not kept."""
    for paths in zip(files.surface, files.contact, files.stress, strict=True):
        results = SeedResults.read(*paths)
        checks[f"seed {results.seed}"] = verify_seed(results.contact, results.stress)
        yield results


with job(snakemake):
    statistics = surface_statistics(checked_seeds(), **params.statistics)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {
        "statistics": params.statistics,
        "seed": statistics["seed"].values.tolist(),
    }
    dataset.write(statistics, output.statistics, f"Statistics of rough surface {name}", settings)
    checked = verification_table(name, {**checks, "all seeds": verify_statistics(statistics)})
    write_table(checked, "verification", output.checks)
    tables = {"Laws": markup.html_table(checked.drop(columns="surface"))}
    title = f"Verification of {name}"
    page = markup.rendered("asperity.core", "base.html.j2", title=title, tables=tables)
    write_text(output.page, page)
