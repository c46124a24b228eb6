# Resources of every rule, from the cost model of the library: they depend on the configuration only.
import math
import os
from dataclasses import replace

from asperity.study.cost.model import COMPILER_MEMORY, WORKFLOW_MEMORY, job_cost
from asperity.study.config.defaults import default
from asperity.study.config.defaults import imposed_load
from asperity.study.config.presets import PRESETS

ACCURACY = replace(
    PRESETS["paper"],
    contact_tolerance=config["contact"]["tolerance"],
    precision=config["contact"]["precision"],
    depth_tolerance=config["stress"]["tolerance"],
    depth_spacing=config["stress"]["depth_spacing"],
)


def nodes(*names):
    """Nodes of the grids of surfaces; for a measured map of unknown size, the bytes of its file, which are more."""
    surfaces = [{**SURFACES, **MEASURED}[name] for name in names]
    return sum(s["points"] ** 2 if "points" in s else os.path.getsize(s["file"]) for s in surfaces)


def surface_cost(wildcards):
    """Cost of a random or measured surface."""
    job = "measured surface" if wildcards.surface in MEASURED else "surface"
    return job_cost(job, nodes(wildcards.surface))


def contact_cost(wildcards):
    """Cost of a contact, with the number of its loads."""
    settings = contact_settings(wildcards)
    load, value = imposed_load(settings)
    area = value if load == "area_fraction" else default("contact.area_fraction")
    loads = len({*settings.get("path_area_fractions", ()), area})
    return job_cost("contact", nodes(wildcards.surface), loads, ACCURACY, area)


def stress_cost(wildcards):
    """Cost of the stress, with the number of its Poisson's ratios and conditions of the mean (q = 0) mode."""
    analyses = len(stress_settings(wildcards)["poisson"]) * (1 + len(laterals_of(wildcards)))
    return job_cost("stress", nodes(wildcards.surface), analyses, ACCURACY)


def figure_cost(wildcards):
    """Cost of a figure, which holds one field of every surface and five of every contact that it shows."""
    figure = FIGURES[wildcards.figure]
    if figure.cost == "figure of elements":
        return job_cost(figure.cost, math.prod(config["validation"]["elements"]["meshes"][-1]))
    names = [name for study in figure.studies for name in STUDIES[study]]
    fields = ("surface" in figure.stages) + 5 * ("contact" in figure.stages)
    return job_cost(figure.cost, nodes(*names) * fields)


def seeds_cost(job):
    """Cost of a job that reads the results of all seeds of a surface."""
    return lambda wildcards: job_cost(job, nodes(wildcards.surface), len(seeds_of(wildcards.surface)))


def tradeoff_cost(wildcards):
    """Cost of the measurement of speed and accuracy, with its largest grid."""
    return job_cost("tradeoff", max(config["tradeoff"][wildcards.extent]["sizes"]) ** 2)


# Rule -> cost of its job. Rules that are not listed take next to no time and memory.
COSTS = {
    "surface": surface_cost,
    "contact": contact_cost,
    "stress": stress_cost,
    "statistics": seeds_cost("statistics"),
    "figure": figure_cost,
    "validation": lambda wildcards: job_cost("validation"),
    "claims": lambda wildcards: job_cost("claims"),
    "tradeoff": tradeoff_cost,
    "tradeoff_figures": lambda wildcards: job_cost("tradeoff figures"),
    "report_page": lambda wildcards: job_cost("report page"),
}


def needs(rule):
    """Resources of a rule: memory, disk space, and on a cluster the time.

    On a cluster the workflow and the compiler run beside the job. The time is four times that on the machine of the
    measurement, and ten minutes to start.
    """

    def beside():  # asked for a job: the executor is known only after the rules
        return 0 if workflow.local_exec else WORKFLOW_MEMORY + COMPILER_MEMORY

    def rounded_up(amount):
        return lambda wildcards: math.ceil(amount(COSTS[rule](wildcards)))

    return {
        "mem_mb": rounded_up(lambda cost: (cost.memory + beside()) / 1e6),
        "disk_mb": rounded_up(lambda cost: cost.disk / 1e6),
        "runtime": rounded_up(lambda cost: 10 + 4 * cost.seconds / 60),
    }
