"""Rule statistics: all numbers of the peaks, profiles and decays of one surface, over its seeds."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.pipeline.statistics import SeedResults, reading_statistics, surface_statistics
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

surface, files, params = snakemake.wildcards.surface, snakemake.input, snakemake.params
with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine, *snakemake.input.wisdom),
    ProgressBar(f"statistics {surface}"),
):
    results = map(SeedResults.read, files.surface, files.contact, files.stress)
    statistics = surface_statistics(results, **params.statistics, patch_nodes=params.patch_nodes)
    settings = dataset.settings_of(dataset.read(files.stress[0])) | {
        "statistics": params.statistics,
        "seed": statistics["seed"].values.tolist(),
    }
    title = f"Statistics of rough surface {surface}"
    dataset.write(statistics, snakemake.output[0], title, settings)
    seeds = len(files.stress)
    for number, (lateral, path) in enumerate(zip(params.laterals, snakemake.output[1:], strict=True)):
        stresses = files.others[number * seeds : (number + 1) * seeds]
        results = map(SeedResults.read, files.surface, files.contact, stresses)
        layer = settings["layer"] | {"lateral": lateral}
        found = reading_statistics(results, params.patch_nodes)
        dataset.write(found, path, f"{title}, laterally {lateral}", settings | {"layer": layer})
