"""Rule validation: the solver against closed forms, finite elements and floating point."""

from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.validation import comparisons as validation
from asperity.validation import extremes
from asperity.validation import rounding as stability

COMPARISONS = {
    "load_area": validation.load_area,
    "slab_load_area": validation.slab_load_area,
    "grid_convergence": validation.grid_convergence,
    "elements": validation.compare_elements,
    "mesh_convergence": validation.mesh_convergence,
    "punch": validation.punch,
    "stability": stability.compute,
    "extremes": extremes.compute,
}

name = snakemake.wildcards.validation
with log_to(snakemake.log[0]), ProgressBar(f"validation {name}") as progress:
    settings = snakemake.params.settings
    dataset.write(
        COMPARISONS[name](**settings, progress=progress),
        snakemake.output[0],
        title=f"Validation: {COMPARISONS[name].__doc__.splitlines()[0]}",
        settings={"validation": {name: settings}},
    )
