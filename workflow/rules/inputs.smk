# Surfaces, seeds and figures of the configuration, their settings, and the result files that belong to them.
from pathlib import Path
from asperity.paper.claims.sources import resolutions
from asperity.paper.figures import figures_of, surfaces_with_contact

STUDIES = config["studies"]
STUDIED = {name for names in STUDIES.values() for name in names}
RESOLUTIONS = resolutions(SURFACES) if config["claims"] else {}
CONTINUUM = {name for by_role in RESOLUTIONS.values() for name in by_role.values()}
CONTINUUM_SEEDS = config["seeds"][:2]
FIGURES = figures_of(config)
WITH_LOAD_AREA = surfaces_with_contact(config)
FFT_ENGINE = config["fft_engine"]
# What the interpretations of the claims need besides the study: other conditions of the mean (q = 0) mode, components.
OTHER_LATERALS = [name for name in config["interpretations"]["lateral"] if name != config["layer"]["lateral"]]
OTHER_COMPONENTS = [name for name in config["interpretations"]["shear"] if name != "xz"]
if not config["claims"]:
    OTHER_LATERALS, OTHER_COMPONENTS = [], []


def seeds_of(surface):
    """Seeds of a surface: all of the configuration; the first two if only the continuum study needs it.

    A measured map has no seeds: the first one stands for it.
    """
    if surface in MEASURED:
        return config["seeds"][:1]
    return CONTINUUM_SEEDS if surface in CONTINUUM - STUDIED else config["seeds"]


def results_of_seeds(stage):
    """Results of a stage for all seeds of a surface."""
    return lambda wildcards: [
        f"{RESULTS}/{stage}/{wildcards.surface}/seed{seed}.nc" for seed in seeds_of(wildcards.surface)
    ]


def other_stresses_of_seeds(wildcards):
    """Stresses of all seeds of a surface under the other conditions of the mean mode, one condition by one."""
    return [
        f"{RESULTS}/interpretations/{name}/stress/{wildcards.surface}/seed{seed}.nc"
        for name in OTHER_LATERALS
        for seed in seeds_of(wildcards.surface)
    ]


STAGE_RESULTS = (
    [
        f"{RESULTS}/{stage}/{surface}/seed{seed}.nc"
        for surface in sorted(STUDIED | CONTINUUM)
        for seed in seeds_of(surface)
        for stage in (
            "surface",
            "contact",
            "stress",
            *(f"interpretations/{name}/stress" for name in OTHER_LATERALS),
        )
    ]
    + [
        f"{RESULTS}/{stage}/{surface}.nc"
        for surface in sorted(STUDIED | CONTINUUM)
        for stage in ("statistics", *(f"interpretations/{name}/statistics" for name in OTHER_LATERALS))
    ]
    + [f"{RESULTS}/verification/{surface}.csv" for surface in sorted(STUDIED | CONTINUUM)]
)


def figure_results(figure):
    """Results that a figure is drawn from: stage -> (study ->) surface or dataset -> file.

    A figure shows the statistics of all seeds, and the surface and the contact of the first one.
    """

    def result(stage, name):
        if stage in ("surface", "contact"):
            name = f"{name}/seed{config['seeds'][0]}"
        return f"{RESULTS}/{stage}/{name}.nc"

    return FIGURES[figure].results(STUDIES, result)


def leaves(tree):
    """The files of a tree of files."""
    return [tree] if isinstance(tree, str) else [file for branch in tree.values() for file in leaves(branch)]


def surface_labels(wildcards):
    """Labels of the surfaces that a figure shows: not in their results, so that a new label computes nothing anew."""
    shown = {name for study in FIGURES[wildcards.figure].studies for name in STUDIES[study]}
    return {name: {**SURFACES, **MEASURED}[name]["label"] for name in sorted(shown)}


def figure_labels(wildcards):
    """Number or name of a figure and its studies, as the report lists them: sorted as text."""
    figure = FIGURES[wildcards.figure]
    return {
        "figure": f"{figure.number:02d}" if figure.number else figure.name,
        "study": " and ".join(figure.studies) or "validation",
    }


def surface_settings(wildcards):
    """Entry of a surface without its label, which changes nothing of the surface."""
    entry = {**SURFACES, **MEASURED}[wildcards.surface]
    return {key: value for key, value in entry.items() if key != "label"}


def contact_settings(wildcards):
    """Section contact, without the load-area curve where no figure shows it."""
    if wildcards.surface in WITH_LOAD_AREA:
        return config["contact"]
    return {**config["contact"], "path_area_fractions": []}
