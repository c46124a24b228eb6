# Resources of every rule, from the cost model of the library: they depend on the configuration only.
import math
import os
from dataclasses import replace

from asperity.accuracy.resources import COMPILER_MEMORY, WORKFLOW_MEMORY, job_cost, sample_seconds
from asperity.config.defaults import default
from asperity.config.loads import imposed_load
from asperity.config.presets import PRESETS
from asperity.runtime.snakemake_internals import runs_locally

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
    """Cost of the stress, with the number of its Poisson's ratios and conditions of the uniform mode."""
    analyses = len(config["stress"]["poisson"]) * (1 + len(OTHER_LATERALS))
    return job_cost("stress", nodes(wildcards.surface), analyses, ACCURACY)


def figure_cost(wildcards):
    """Cost of a figure, which holds one field of every surface and five of every contact that it shows."""
    figure = FIGURES[wildcards.figure]
    if figure.cost == "figure of elements":
        return job_cost(figure.cost, math.prod(config["validation"]["elements"]["elements"]))
    names = [name for study in figure.studies for name in STUDIES[study]]
    fields = ("surface" in figure.stages) + 5 * ("contact" in figure.stages)
    return job_cost(figure.cost, nodes(*names) * fields)


def seeds_cost(job):
    """Cost of a job that reads the results of all seeds of a surface."""
    return lambda wildcards: job_cost(job, nodes(wildcards.surface), len(seeds_of(wildcards.surface)))


def tradeoff_cost(wildcards):
    """Cost of the measurement of speed and accuracy, with its largest grid."""
    return job_cost("tradeoff", max(config["tradeoff"][wildcards.extent]["sizes"]) ** 2)


def samples_cost(wildcards):
    """Cost of the samples of one file: all stages in memory, one seed after the other."""
    number, edge = int(wildcards.last) - int(wildcards.first) + 1, float(wildcards.nodes)
    points = grid_points(SURFACES[wildcards.surface]["wavelength_short"], edge)
    seconds = number * seed_seconds(wildcards.surface, edge)
    return job_cost("ensemble samples", points**2)._replace(calculation_seconds=seconds)


def seed_seconds(surface, edge):
    """Processor time of one seed of a surface by the cost model; `edge` is the nodes on its shortest wavelength."""
    points = grid_points(SURFACES[surface]["wavelength_short"], edge)
    laterals = {config["layer"]["lateral"], *config["readings"]["lateral"]}
    analyses = 0 if edge == SURFACE_ALONE else len(config["stress"]["poisson"]) * len(laterals)
    load, value = imposed_load(config["contact"])
    area = value if load == "area_fraction" else default("contact.area_fraction")
    return sample_seconds(points**2, analyses, ACCURACY, area)


# Rule -> cost of its job. Rules that are not listed take next to no time and memory.
COSTS = {
    "machine_code": lambda wildcards: job_cost("machine code"),
    "fft_wisdom": lambda wildcards: job_cost("wisdom", int(wildcards.points)),
    "surface": surface_cost,
    "contact": contact_cost,
    "stress": stress_cost,
    "statistics": seeds_cost("statistics"),
    "verification": seeds_cost("verification"),
    "figure": figure_cost,
    "validation": lambda wildcards: job_cost("validation"),
    "calculix": lambda wildcards: job_cost("calculix"),
    "validation_table": lambda wildcards: job_cost("validation table"),
    "claims": lambda wildcards: job_cost("claims"),
    "ensemble_samples": samples_cost,
    "ensemble_plan": lambda wildcards: job_cost("ensemble plan"),
    "ensemble_result": lambda wildcards: job_cost("ensemble result"),
    "ensemble": lambda wildcards: job_cost("ensemble result"),
    "ensemble_gains": lambda wildcards: job_cost("ensemble result"),
    "tradeoff": tradeoff_cost,
    "tradeoff_figures": lambda wildcards: job_cost("tradeoff figures"),
    "report_page": lambda wildcards: job_cost("report page"),
}


def memory(rule):
    """Resource mem_mb of a rule; on a cluster with the workflow and the compiler, which run beside the job."""

    def megabytes(wildcards):
        beside = 0 if runs_locally(workflow) else WORKFLOW_MEMORY + COMPILER_MEMORY
        return math.ceil((COSTS[rule](wildcards).memory + beside) / 1e6)

    return megabytes


def disk(rule):
    """Resource disk_mb of a rule: the files it writes."""
    return lambda wildcards: math.ceil(COSTS[rule](wildcards).disk / 1e6)


def minutes(rule):
    """Resource runtime of a rule: four times its time on the machine of the measurement, and ten minutes to start."""
    return lambda wildcards: math.ceil(10 + 4 * COSTS[rule](wildcards).seconds / 60)
