"""Rule contact: a random or measured surface, the solid pressed against it, and its load-area curve."""

from asperity.results import dataset
from asperity.study.progress_and_log import job
from asperity.study.stages.contact import press_surface
from asperity.study.stages.surface import make_surface, read_surface

params, output = snakemake.params, snakemake.output
name, seed = snakemake.wildcards.surface, int(snakemake.wildcards.seed)
with job(snakemake) as progress:
    parameters = params.surface
    if snakemake.input.get("surface"):
        surface, made = dataset.read(snakemake.input.surface), "Rough"
        parameters = dataset.settings_of(surface)["surface"]
    elif "file" in parameters:
        surface, made = read_surface(parameters), "Measured"
        parameters = {**parameters, "wavelength_short": surface.attrs["wavelength_short"]}
    else:
        surface, made = make_surface(parameters, seed), "Rough"
    settings = {"name": name, "seed": seed, "surface": parameters}
    if output.get("surface"):
        dataset.write(surface, output.surface, f"{made} surface {name}, seed {seed}", settings)
    dataset.write(
        press_surface(surface, params.layer, params.contact, progress),
        output.contact,
        f"Contact with rough surface {name}, seed {seed}",
        settings | {"layer": params.layer, "contact": params.contact},
    )
