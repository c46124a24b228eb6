from functools import cache

CONTINUUM_SEEDS = config["seeds"][:2]
SUMMARY = f"{RESULTS}/summary/{{}}/seed{{}}.json"


# Imported where they are asked for: the libraries of numbers take seconds to import, and on a cluster every job
# reads these rules anew.
@cache
def claim_members():
    """Role → summaries of its surface, one for each seed."""
    from asperity.paper.claims.verdicts import roles

    return {
        role: [SUMMARY.format(name, seed) for seed in config["seeds"]]
        for role, name in roles(config["studies"], SURFACES).items()
    }


@cache
def finer_members():
    """The same for each resolution of the continuum study."""
    from asperity.paper.claims.verdicts import resolutions

    return {
        nodes: {
            role: [SUMMARY.format(name, seed) for seed in CONTINUUM_SEEDS] for role, name in names.items()
        }
        for nodes, names in resolutions(SURFACES).items()
    }


def claim_datasets(wildcards):
    """Datasets of the validation that claims are decided on."""
    from asperity.paper.claims.statements import DATASETS

    return [f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config.get("validation", {})]
