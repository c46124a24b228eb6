"""Rule surface: a random surface, or a measured one."""

from asperity.results import dataset
from asperity.study.runtime.job import job
from asperity.study.stages.surface import make_surface, read_surface

name, seed = snakemake.wildcards.surface, int(snakemake.wildcards.seed)
with job(snakemake):
    parameters = snakemake.params.surface
    if "file" in parameters:
        surface, made = read_surface(parameters), "Measured"
        parameters = {**parameters, "wavelength_short": surface.attrs["wavelength_short"]}
    else:
        surface, made = make_surface(parameters, seed), "Rough"
    dataset.write(
        surface,
        snakemake.output[0],
        title=f"{made} surface {name}, seed {seed}",
        settings={"name": name, "seed": seed, "surface": parameters},
    )
