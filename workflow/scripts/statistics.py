"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, over its seeds."""

from asperity.results import dataset
from asperity.study.runtime.job import job
from asperity.study.stages.statistics import SeedResults, statistics_of_seeds, surface_statistics

files, params = snakemake.input, snakemake.params
title = f"Statistics of rough surface {snakemake.wildcards.surface}"
with job(snakemake):
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    statistics = surface_statistics(results, **params.statistics)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {
        "statistics": params.statistics,
        "seed": statistics["seed"].values.tolist(),
    }
    dataset.write(statistics, snakemake.output[0], title, settings)
    seeds = len(files.stress)
    for number, (lateral, path) in enumerate(zip(params.laterals, snakemake.output[1:], strict=True)):
        stresses = files.others[number * seeds : (number + 1) * seeds]
        results = map(SeedResults.read, files.surface, files.contact, stresses)
        layer = settings["layer"] | {"lateral": lateral}
        found = statistics_of_seeds(results)
        dataset.write(found, path, f"{title}, laterally {lateral}", settings | {"layer": layer})
