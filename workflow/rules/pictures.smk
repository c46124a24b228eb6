from pathlib import Path

# What a figure shows: one study of the configuration or several, and the stages whose results it reads.
FIGURES = {
    "fig05": ("hurst", ["surface", "contact"]),
    "fig06": ("hurst", ["surface", "statistics"]),
    "fig07": ("hurst", ["contact"]),
    "fig08": ("hurst", ["contact", "statistics"]),
    "fig09": ("hurst", ["statistics"]),
    "fig10": ("hurst", ["statistics"]),
    "fig11": ("hurst", ["statistics"]),
    "fig13": ("compressibility", ["statistics"]),
    "fig14": ("compressibility", ["statistics"]),
    "fig15": ("compressibility", ["statistics"]),
    "fig16": (("skewness", "kurtosis"), ["surface", "statistics"]),
    "fig17": (("skewness", "kurtosis"), ["statistics"]),
    "fig18": ("kurtosis", ["statistics"]),
}

# Figures of the validation, and the datasets of rule validation that they read.
VALIDATION_FIGURES = {
    "fig01": ["elements"],
    "fig02": ["load_area", "slab_load_area", "grid_convergence"],
    "fig03": ["elements"],
    "fig04": ["elements"],
    "fig12": ["punch"],
    "stability": ["stability"],
    "extremes": ["extremes"],
}
FIGURES |= {figure: ("validation", ["validation"]) for figure in VALIDATION_FIGURES}

# The supplement: figures of the paper drawn of other studies, as figure_study.
FIGURES |= {
    f"{figure}_{study}": (study, FIGURES[figure][1])
    for study, figures in {
        "moments": ("fig06", "fig09", "fig10", "fig11"),
        "measured": ("fig05", "fig06", "fig07", "fig08", "fig09", "fig10", "fig11"),
    }.items()
    for figure in figures
    if config["studies"][study]
}


def stage_results(figure):
    """Results that a figure reads: stage -> (study ->) surface -> file, of the first seed where it is of one."""
    studies, stages = FIGURES[figure]
    if studies == "validation":
        return {studies: {name: f"{RESULTS}/validation/{name}.nc" for name in VALIDATION_FIGURES[figure]}}

    def files(stage, study):
        name = "{}.nc" if stage == "statistics" else f"{{}}/seed{config['seeds'][0]}.nc"
        return {surface: f"{RESULTS}/{stage}/{name.format(surface)}" for surface in config["studies"][study]}

    return {
        stage: (
            files(stage, studies)
            if isinstance(studies, str)
            else {study: files(stage, study) for study in studies}
        )
        for stage in stages
    }


def leaves(tree):
    """The files of a tree of files."""
    if isinstance(tree, str):
        return [tree]
    return [file for branch in tree.values() for file in leaves(branch)]
