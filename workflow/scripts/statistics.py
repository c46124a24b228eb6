"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, over its seeds."""

from asperity.pipeline.statistics import SeedResults, surface_statistics
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

surface, files, section = snakemake.wildcards.surface, snakemake.input, snakemake.params.statistics
with log_to(snakemake.log[0], snakemake.output), ProgressBar(f"statistics {surface}"):
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    statistics = surface_statistics(results, **section)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {"statistics": section}
    dataset.write(
        statistics,
        snakemake.output[0],
        title=f"Statistics of rough surface {surface}",
        settings=settings | {"seed": statistics["seed"].values.tolist()},
    )
