"""Rule surface: a random or measured rough surface."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.engines import fft_engine
from asperity.pipeline.surface import make_surface, read_surface
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar

with (
    log_to(snakemake.log[0], snakemake.output),
    fft_engine(snakemake.params.fft_engine, *snakemake.input.wisdom),
    ProgressBar(f"surface {snakemake.wildcards.surface}"),
):
    seed, parameters = int(snakemake.wildcards.seed), snakemake.params.surface
    if "file" in parameters:
        entry = f"measured.{snakemake.wildcards.surface}"
        surface, made = read_surface(parameters, lambda name: f"{entry}.{name}"), "Measured"
        parameters = {**parameters, "wavelength_short": surface.attrs["wavelength_short"]}
    else:
        surface, made = make_surface(parameters, seed), "Rough"
    dataset.write(
        surface,
        snakemake.output[0],
        title=f"{made} surface {snakemake.wildcards.surface}, seed {seed}",
        settings={"name": snakemake.wildcards.surface, "seed": seed, "surface": parameters},
    )
