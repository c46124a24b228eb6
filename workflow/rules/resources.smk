# Resources of every rule, from the cost model of the library: they depend on the configuration only.
import math
import os

from asperity.study.cost.model import COMPILER_MEMORY, WORKFLOW_MEMORY, job_cost
from asperity.settings.configuration import Contact
from asperity.settings.sections import imposed_load


def nodes(*names):
    """Nodes of the grids of surfaces; for a measured map of unknown size, the bytes of its file, which are more."""
    surfaces = [{**SURFACES, **MEASURED}[name] for name in names]
    return sum(s["points"] ** 2 if "points" in s else os.path.getsize(s["file"]) for s in surfaces)


def loads(wildcards):
    """Number of loads at which a contact is solved."""
    settings = contact_settings(wildcards)
    load, value = imposed_load(settings)
    area = value if load == "contact_area_fraction" else Contact().contact_area_fraction
    return len({*settings.get("path_contact_area_fractions", ()), area})


def fields(name):
    """Nodes of the fields that a figure holds: one of every surface and five of every contact that it shows."""
    figure = FIGURES[name]
    names = [name for study in figure.studies for name in STUDIES[study]]
    return nodes(*names) * (("surface" in figure.stages) + 5 * ("contact" in figure.stages))


# Rule -> nodes of its grid, and repetitions, as in `job_cost`.
SIZES = {
    "contact": lambda wildcards: (nodes(wildcards.surface), loads(wildcards)),
    "contact_again": lambda wildcards: (nodes(wildcards.surface), loads(wildcards)),
    "stress": lambda wildcards: (
        nodes(wildcards.surface),
        len(stress_settings(wildcards)["poisson"]) * (1 + len(laterals_of(wildcards))),
    ),
    "statistics": lambda wildcards: (nodes(wildcards.surface), len(seeds_of(wildcards.surface))),
    **{
        f"figures_{group}": lambda wildcards, names=names: (max(map(fields, names)), len(names))
        for group, names in DRAWN_TOGETHER.items()
    },
    "validation": lambda wildcards: (0, 1),
    "claims": lambda wildcards: (0, 1),
    "report_page": lambda wildcards: (0, 1),
}


def cost_of(rule, wildcards):
    """Cost of a job of a rule."""
    size, repetitions = SIZES[rule](wildcards)
    kind = "figure" if rule.startswith("figures_") else rule.removesuffix("_again")
    job = "load-area curve" if kind == "contact" and repetitions > 1 else kind
    return job_cost(job, size, repetitions, config["stress"]["depth_spacing"])


def needs(rule):
    """Resources of a rule: memory, disk space, and on a cluster the time; and its size, for the cost model.

    On a cluster the workflow and the compiler run beside the job. The time is four times that on the machine of the
    measurement, and ten minutes to start.
    """

    def beside():  # asked for a job: the executor is known only after the rules
        return 0 if workflow.local_exec else WORKFLOW_MEMORY + COMPILER_MEMORY

    def rounded_up(amount):
        return lambda wildcards: math.ceil(amount(cost_of(rule, wildcards)))

    return {
        "mem_mb": rounded_up(lambda cost: (cost.memory + beside()) / 1e6),
        "disk_mb": rounded_up(lambda cost: cost.disk / 1e6),
        "runtime": rounded_up(lambda cost: 10 + 4 * cost.seconds / 60),
        "grid_nodes": lambda wildcards: SIZES[rule](wildcards)[0],
        "repetitions": lambda wildcards: SIZES[rule](wildcards)[1],
    }
