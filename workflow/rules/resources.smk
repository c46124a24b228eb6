import math
import os

from asperity.accuracy.resources import COMPILER_MEMORY, WORKFLOW_MEMORY, need
from asperity.runtime.snakemake_internals import runs_locally


def nodes(*names):
    """Nodes of the grids of surfaces; of a measured map of unknown size, no more than its file has bytes."""
    surfaces = [{**SURFACES, **MEASURED}[name] for name in names]
    return sum(s["points"] ** 2 if "points" in s else os.path.getsize(s["file"]) for s in surfaces)


def loads(wildcards):
    """Loads at which a contact is solved."""
    settings = contact_settings(wildcards)
    return len({*settings["path_area_fractions"], settings["area_fraction"]})


def figure_need(figure):
    """Of a figure: it holds a field of each surface, five of each contact, and little of other stages."""
    studies, stages = FIGURES[figure]
    if figure in ("fig03", "fig04"):
        return need("map of elements", math.prod(config["validation"]["elements"]["elements"]))
    if figure == "extremes":
        return need("figure of extremes")
    if studies == "validation":
        return need("figure")
    studies = [studies] if isinstance(studies, str) else studies
    names = [name for study in studies for name in config["studies"][study]]
    return need("figure", nodes(*names) * (("surface" in stages) + 5 * ("contact" in stages)))


# What the job of each rule needs. Other rules have next to nothing to do.
NEEDS = {
    "machine_code": lambda wildcards: need("machine code"),
    "surface": lambda wildcards: need(
        "map" if wildcards.surface in MEASURED else "surface", nodes(wildcards.surface)
    ),
    "contact": lambda wildcards: need("contact", nodes(wildcards.surface), loads(wildcards)),
    "stress": lambda wildcards: need("stress", nodes(wildcards.surface), len(config["stress"]["poisson"])),
    "summary": lambda wildcards: need("summary", nodes(wildcards.surface)),
    "statistics": lambda wildcards: need("statistics", nodes(wildcards.surface), len(config["seeds"])),
    "verification": lambda wildcards: need("verification", nodes(wildcards.surface), len(config["seeds"])),
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
        beside = 0 if runs_locally(workflow) else WORKFLOW_MEMORY + COMPILER_MEMORY
        return math.ceil(NEEDS[rule](wildcards).memory + beside)

    return megabytes


def disk(rule):
    """The resource disk_mb of a rule: what it writes."""
    return lambda wildcards: math.ceil(NEEDS[rule](wildcards).disk)


def minutes(rule):
    """The resource runtime of a rule: four times what its job took here, and ten minutes to start."""
    return lambda wildcards: math.ceil(10 + 4 * NEEDS[rule](wildcards).seconds / 60)
