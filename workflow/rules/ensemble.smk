# Means over random surfaces to a given error (multilevel Monte Carlo). A pilot and rounds of planning ask for samples:
# files of a few seeds of one surface on one grid, which all numbers and all targets share.
import json

from asperity.pipeline.ensemble import SURFACE_ALONE, block_size, grid_points

ENSEMBLE = config["ensemble"]
SAMPLES = f"{RESULTS}/ensemble/samples"


def ensemble_surfaces(claim):
    """Role -> surface, of the surfaces that a number depends on."""
    from asperity.paper.ensemble.numbers import surfaces_of

    try:
        return surfaces_of(claim, ROLES)
    except ValueError as error:
        raise WorkflowError(f"ensemble: {error}") from None


def ensemble_wavelengths(claim):
    """Shortest wavelengths of the surfaces that a number depends on."""
    return [SURFACES[name]["wavelength_short"] for name in ensemble_surfaces(claim).values()]


def blocks(surface, nodes, seeds):
    """Files of the first seeds of a surface on one grid."""
    size = block_size(SURFACES[surface]["wavelength_short"], nodes)
    return [
        f"{SAMPLES}/{surface}/nodes{nodes:g}/seeds{first}-{first + size - 1}.nc"
        for first in range(1, int(seeds) + 1, size)
    ]


def ensemble_files(claim, nodes, seeds):
    """Nodes on the shortest wavelength -> surface -> files of samples."""
    surfaces = dict.fromkeys(ensemble_surfaces(claim).values())
    return {
        node: {surface: blocks(surface, node, number) for surface in surfaces}
        for node, number in zip(nodes, seeds)
        if number
    }


def earlier_plan(claim, error, round):
    """Plan before a round; that of round 0 is the pilot."""
    from asperity.paper.ensemble.planning import Plan, pilot

    if round == 0:
        return pilot(ENSEMBLE["nodes"], ENSEMBLE["pilot"], ensemble_wavelengths(claim))
    return Plan.read(checkpoints.ensemble_plan.get(claim=claim, error=error, round=round).output[0])


def planned_files(wildcards):
    """Samples that a round of planning reads."""
    plan = earlier_plan(wildcards.claim, wildcards.error, int(wildcards.round) - 1)
    return ensemble_files(wildcards.claim, plan.nodes, plan.seeds)


def last_plan(wildcards):
    """Plan of the last round."""
    round = 1
    while not (plan := earlier_plan(wildcards.claim, wildcards.error, round)).done:
        round += 1
    return plan


def final_files(wildcards):
    """Samples that the result is taken from: those of the last plan, and the finest grid of plain Monte Carlo."""
    plan = last_plan(wildcards)
    seeds = [*plan.seeds[:-1], max(plan.seeds[-1], ENSEMBLE["plain"])]
    return ensemble_files(wildcards.claim, plan.nodes, seeds)


def final_plan(wildcards):
    """File of the plan of the last round."""
    return (
        f"{RESULTS}/ensemble/{wildcards.claim}/error{wildcards.error}/plan{last_plan(wildcards).round}.json"
    )


rule ensemble_samples:
    input:
        machine_code=MACHINE_CODE,
        code=code("ensemble_samples"),
    output:
        f"{SAMPLES}/{{surface}}/nodes{{nodes}}/seeds{{first}}-{{last}}.nc",
    log:
        f"{RESULTS}/log/ensemble/samples/{{surface}}/nodes{{nodes}}/seeds{{first}}-{{last}}.log",
    benchmark:
        f"{RESULTS}/benchmark/ensemble_samples/{{surface}}/nodes{{nodes}}/seeds{{first}}-{{last}}.tsv"
    wildcard_constraints:
        nodes=r"\d+(\.\d+)?",
        first=r"\d+",
        last=r"\d+",
    threads: 1
    resources:
        mem_mb=memory("ensemble_samples"),
        disk_mb=disk("ensemble_samples"),
        runtime=minutes("ensemble_samples"),
    params:
        surface=surface_settings,
        layer=config["layer"],
        contact={**config["contact"], "path_area_fractions": []},
        stress=config["stress"],
    script:
        "../scripts/ensemble_samples.py"


checkpoint ensemble_plan:
    input:
        samples=lambda wildcards: leaves_of_lists(planned_files(wildcards)),
        code=code("ensemble_plan"),
    output:
        f"{RESULTS}/ensemble/{{claim}}/error{{error}}/plan{{round}}.json",
    log:
        f"{RESULTS}/log/ensemble/{{claim}}/error{{error}}/plan{{round}}.log",
    benchmark:
        f"{RESULTS}/benchmark/ensemble_plan/{{claim}}/error{{error}}/plan{{round}}.tsv"
    wildcard_constraints:
        claim=r"[a-z][a-z0-9_]*",
        error=r"[0-9.e-]+",
        round=r"[1-9]\d*",
    threads: 1
    resources:
        mem_mb=memory("ensemble_plan"),
        disk_mb=disk("ensemble_plan"),
        runtime=minutes("ensemble_plan"),
    params:
        files=planned_files,
        surfaces=lambda wildcards: ensemble_surfaces(wildcards.claim),
        wavelengths=lambda wildcards: ensemble_wavelengths(wildcards.claim),
        settings=ENSEMBLE,
        earlier=lambda wildcards: earlier_plan(
            wildcards.claim, wildcards.error, int(wildcards.round) - 1
        ).as_entries(),
    script:
        "../scripts/ensemble_plan.py"


rule ensemble_result:
    input:
        samples=lambda wildcards: leaves_of_lists(final_files(wildcards)),
        plan=final_plan,
        style="src/asperity/views/style.mplstyle",
        code=code("ensemble_result"),
    output:
        data=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/result.nc",
        table=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/table.csv",
        text=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/result.md",
        picture=report(
            f"{RESULTS}/ensemble/{{claim}}/error{{error}}/cost.png",
            caption="../report/ensemble.rst",
            category="Ensembles",
            labels={"number": "{claim}", "error": "{error}"},
        ),
    log:
        f"{RESULTS}/log/ensemble/{{claim}}/error{{error}}/result.log",
    benchmark:
        f"{RESULTS}/benchmark/ensemble_result/{{claim}}/error{{error}}.tsv"
    wildcard_constraints:
        claim=r"[a-z][a-z0-9_]*",
        error=r"[0-9.e-]+",
    threads: 1
    resources:
        mem_mb=memory("ensemble_result"),
        disk_mb=disk("ensemble_result"),
        runtime=minutes("ensemble_result"),
    params:
        files=final_files,
        surfaces=lambda wildcards: ensemble_surfaces(wildcards.claim),
    script:
        "../scripts/ensemble_result.py"


rule ensemble:
    input:
        data=expand(
            rules.ensemble_result.output.data, claim=ENSEMBLE["claims"], error=f"{ENSEMBLE['error']:g}"
        ),
        style="src/asperity/views/style.mplstyle",
        code=code("ensemble"),
    output:
        table=f"{RESULTS}/ensemble/table.csv",
        text=f"{RESULTS}/ensemble/table.md",
        picture=[
            report(
                f"{RESULTS}/ensemble/cost.png",
                caption="../report/ensemble.rst",
                category="Ensembles",
                labels={"number": "all", "error": f"{ENSEMBLE['error']:g}"},
            ),
            f"{RESULTS}/ensemble/cost.pdf",
        ],
    log:
        f"{RESULTS}/log/ensemble/table.log",
    benchmark:
        f"{RESULTS}/benchmark/ensemble.tsv"
    threads: 1
    resources:
        mem_mb=memory("ensemble"),
        disk_mb=disk("ensemble"),
        runtime=minutes("ensemble"),
    params:
        claims=ENSEMBLE["claims"],
    script:
        "../scripts/ensemble.py"
