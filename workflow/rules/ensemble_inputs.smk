# Samples, plans and surfaces of the numbers that ensembles estimate.
from asperity.pipeline.blocks import SURFACE_ALONE, block_size, grid_points

ENSEMBLE = config["ensemble"]
NUMBER_NAME = r"[a-z][a-z0-9_]*(,[a-z_]+=[a-z0-9_.]+)*"
SAMPLES = f"{RESULTS}/ensemble/samples"


def ensemble_surfaces(claim):
    """Role -> surface, of the surfaces that a number depends on."""
    from asperity.paper.ensemble.numbers import surfaces_of

    try:
        return surfaces_of(claim, ROLES_OF_DELTA, config["readings"])
    except ValueError as error:
        raise WorkflowError(f"ensemble: {error}") from None


def ensemble_wavelengths(claim):
    """Shortest wavelengths of the surfaces that a number depends on."""
    return [SURFACES[name]["wavelength_short"] for name in ensemble_surfaces(claim).values()]


def ensemble_times(claim):
    """Nodes on the shortest wavelength -> processor time of one seed of all surfaces, by the cost model."""
    surfaces = dict.fromkeys(ensemble_surfaces(claim).values())
    return {
        float(node): sum(seed_seconds(surface, node) for surface in surfaces)
        for node in (SURFACE_ALONE, *ENSEMBLE["nodes"])
    }


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


def last_plan(claim, error):
    """Plan of the last round."""
    round = 1
    while not (plan := earlier_plan(claim, error, round)).done:
        round += 1
    return plan


def files_of_result(claim, error):
    """Samples that a result is taken from: those of the last plan, and the finest grid of plain Monte Carlo."""
    plan = last_plan(claim, error)
    seeds = [*plan.seeds[:-1], max(plan.seeds[-1], ENSEMBLE["plain"])]
    return ensemble_files(claim, plan.nodes, seeds)


def final_files(wildcards):
    """Samples that the result of a rule is taken from."""
    return files_of_result(wildcards.claim, wildcards.error)


def final_plan(wildcards):
    """File of the plan of the last round."""
    last = last_plan(wildcards.claim, wildcards.error).round
    return f"{RESULTS}/ensemble/{wildcards.claim}/error{wildcards.error}/plan{last}.json"


def sampled_files():
    """All samples of the numbers of the configuration: nodes -> surface -> files."""
    found = {}
    for claim in ENSEMBLE["claims"]:
        for node, surfaces in files_of_result(claim, f"{ENSEMBLE['error']:g}").items():
            for surface, files in surfaces.items():
                longest = found.setdefault(node, {})
                longest[surface] = max(longest.get(surface, []), files, key=len)
    return found
