import math
import os

from asperity.accuracy.resources import COMPILER_MEMORY, WORKFLOW_MEMORY, need


def nodes(*names):
    """Nodes of the grids of surfaces; of a measured map of unknown size, no more than its file has bytes."""
    surfaces = [{**SURFACES, **MEASURED}[name] for name in names]
    return sum(s["points"] ** 2 if "points" in s else os.path.getsize(s["file"]) for s in surfaces)


def loads(wildcards):
    """Loads at which a contact is solved."""
    settings = contact_settings(wildcards)
    return len({*settings["path_area_fractions"], settings["area_fraction"]})


def figure_need(name):
    """Of a figure: it holds a field of each surface, five of each contact, and little of other stages."""
    figure = FIGURES[name]
    if figure.cost == "figure of elements":
        return need(figure.cost, math.prod(config["validation"]["elements"]["elements"]))
    surfaces = [surface for study in figure.studies for surface in config["studies"][study]]
    fields = ("surface" in figure.stages) + 5 * ("contact" in figure.stages)
    return need(figure.cost, nodes(*surfaces) * fields)


# What the job of each rule needs. Other rules have next to nothing to do.
NEEDS = {
    "compiled": lambda wildcards: need("compiled"),
    "surface": lambda wildcards: need(
        "map" if wildcards.surface in MEASURED else "surface", nodes(wildcards.surface)
    ),
    "contact": lambda wildcards: need("contact", nodes(wildcards.surface), loads(wildcards)),
    "stress": lambda wildcards: need("stress", nodes(wildcards.surface), len(config["stress"]["poisson"])),
    "statistics": lambda wildcards: need(
        "statistics", nodes(wildcards.surface), len(seeds_of(wildcards.surface))
    ),
    "verification": lambda wildcards: need(
        "verification", nodes(wildcards.surface), len(seeds_of(wildcards.surface))
    ),
    "figure": lambda wildcards: figure_need(wildcards.figure),
    "validation": lambda wildcards: need("validation"),
    "calculix": lambda wildcards: need("calculix"),
    "validation_table": lambda wildcards: need("validation table"),
    "claims": lambda wildcards: need("claims"),
    "tradeoff": lambda wildcards: need("tradeoff", max(config["tradeoff"][wildcards.extent]["sizes"]) ** 2),
    "tradeoff_figures": lambda wildcards: need("tradeoff figures"),
}


def memory(rule):
    """The resource mem_mb of a rule: of its job, and on a cluster also of the workflow that runs it there."""

    def megabytes(wildcards):
        beside = 0 if workflow.local_exec else WORKFLOW_MEMORY + COMPILER_MEMORY
        return math.ceil(NEEDS[rule](wildcards).memory + beside)

    return megabytes


def disk(rule):
    """The resource disk_mb of a rule: what it writes."""
    return lambda wildcards: math.ceil(NEEDS[rule](wildcards).disk)


def minutes(rule):
    """The resource runtime of a rule: four times what its job took here, and ten minutes to start."""
    return lambda wildcards: math.ceil(10 + 4 * NEEDS[rule](wildcards).seconds / 60)
