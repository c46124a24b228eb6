# Surfaces, seeds and figures of the configuration, their settings, and the result files that belong to them.
from pathlib import Path
from asperity.paper.claims.sources import CHOICES
from asperity.paper.figures import figures_of, surfaces_with_load_area, surfaces_with_ratios
from asperity.settings.sections import contact_of, maps_of

STUDIES = config["studies"]
MAPS = maps_of(config)
STUDIED = {name for names in STUDIES.values() for name in names}
FIGURES = figures_of(config)
# Groups of figures that one job draws: figures of the same studies.
DRAWN_TOGETHER = {
    group: [name for name, figure in FIGURES.items() if "_".join(figure.studies or ["validation"]) == group]
    for group in dict.fromkeys("_".join(figure.studies or ["validation"]) for figure in FIGURES.values())
}
WITH_LOAD_AREA = surfaces_with_load_area(config)
WITH_RATIOS = surfaces_with_ratios(config)
FFT_ENGINE = config["fft_engine"]
# Additional needs of the interpretations of the claims: other conditions of the mean (q = 0) mode, and components.
OTHER_LATERALS = [
    name for name in CHOICES["lateral"] if config["claims"] and name != config["layer"]["lateral"]
]
OTHER_COMPONENTS = [name for name in CHOICES["shear"] if config["claims"] and name != "xz"]


def settings_of_surface(name):
    """Entry of a surface without its label and its load, which do not change the surface."""
    entry = {**SURFACES, **MEASURED}[name]
    return {key: value for key, value in entry.items() if key not in ("label", "contact")}


def made_as(surface):
    """The first surface with the same settings, whose job makes it: copies under other loads share its file."""
    own = settings_of_surface(surface)
    return next(name for name in (*SURFACES, *MEASURED) if settings_of_surface(name) == own)


MADE = {name: made_as(name) for name in (*SURFACES, *MEASURED)}


def seeds_of(surface):
    """Seeds of a surface. A measured map has no seeds: the first seed is used in file names."""
    return config["seeds"][:1] if surface in MEASURED else config["seeds"]


def maps_of_surface(surface):
    """Dotted key and settings of the measured map of a surface, or of its heights, if it has one."""
    keys = (f"measured.{surface}", f"surfaces.{surface}.heights.map")
    return [(key, MAPS[key]) for key in keys if key in MAPS]


def result_of_seed(stage, surface, seed):
    """Result of a stage for one seed of a surface."""
    return f"{RESULTS}/{stage}/{MADE[surface] if stage == 'surface' else surface}/seed{seed}.nc"


def results_of_seeds(stage):
    """Results of a stage for all seeds of a surface."""
    return lambda wildcards: [
        result_of_seed(stage, wildcards.surface, seed) for seed in seeds_of(wildcards.surface)
    ]


STAGE_RESULTS = (
    [
        result_of_seed(stage, surface, seed)
        for surface in sorted(STUDIED)
        for seed in seeds_of(surface)
        for stage in ("surface", "contact", "stress")
    ]
    + [f"{RESULTS}/statistics/{surface}.nc" for surface in sorted(STUDIED)]
    + [f"{RESULTS}/verification/{surface}.csv" for surface in sorted(STUDIED)]
)


def figure_results(figure):
    """Results that a figure is drawn from: stage -> (study ->) surface or dataset -> file.

    A figure shows the statistics of all seeds, and the surface and the contact of the first one.
    """

    def result(stage, name):
        if stage in ("surface", "contact"):
            return result_of_seed(stage, name, config["seeds"][0])
        return f"{RESULTS}/{stage}/{name}.nc"

    return FIGURES[figure].results(STUDIES, result)


def leaves(tree):
    """The files of a tree of files."""
    return [tree] if isinstance(tree, str) else [file for branch in tree.values() for file in leaves(branch)]


def surface_labels(figure):
    """Labels of the surfaces that a figure shows; results do not contain them, so that a new label reruns no computation."""
    shown = {name for study in FIGURES[figure].studies for name in STUDIES[study]}
    return {name: {**SURFACES, **MEASURED}[name]["label"] for name in sorted(shown)}


def figure_labels(name):
    """Number or name of a figure and its studies, as the report lists them: sorted as text."""
    figure = FIGURES[name]
    return {
        "figure": f"{figure.number:02d}" if figure.number else figure.name,
        "study": " and ".join(figure.studies) or "validation",
    }


def contact_settings(wildcards):
    """Section contact, without the load-area curve where no figure shows it."""
    contact = contact_of(config, wildcards.surface)
    return contact if wildcards.surface in WITH_LOAD_AREA else {**contact, "path_contact_area_fractions": []}


def stress_settings(wildcards):
    """Section stress, with the Poisson's ratio of the contact alone where no other is asked for."""
    if wildcards.surface in WITH_RATIOS:
        return config["stress"]
    return {**config["stress"], "poisson": [config["layer"]["poisson"]]}


def laterals_of(wildcards):
    """Other conditions of the mean (q = 0) mode under which the stress of a surface is analysed."""
    return OTHER_LATERALS if wildcards.surface in CLAIMED else []
