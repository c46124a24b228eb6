from asperity.paper.claims.sources import resolutions

CONTINUUM_SEEDS = config["seeds"][:2]
STUDIED = {name for names in config["studies"].values() for name in names}
CONTINUUM = {name for by_role in resolutions(SURFACES).values() for name in by_role.values()}


def seeds_of(surface):
    """Seeds of a surface: all of the configuration, or the first two if only the continuum study needs it."""
    return CONTINUUM_SEEDS if surface in CONTINUUM - STUDIED else config["seeds"]


def results_of_seeds(stage):
    """Results of a stage for all seeds of a surface."""
    return lambda wildcards: [
        f"{RESULTS}/{stage}/{wildcards.surface}/seed{seed}.nc" for seed in seeds_of(wildcards.surface)
    ]


rule statistics:
    input:
        surface=results_of_seeds("surface"),
        contact=results_of_seeds("contact"),
        stress=results_of_seeds("stress"),
        code=code("statistics"),
    output:
        f"{RESULTS}/statistics/{{surface}}.nc",
    log:
        f"{RESULTS}/log/statistics/{{surface}}.log",
    benchmark:
        f"{RESULTS}/benchmark/statistics/{{surface}}.tsv"
    threads: 1
    resources:
        mem_mb=memory("statistics"),
        disk_mb=disk("statistics"),
        runtime=minutes("statistics"),
    params:
        statistics=config["statistics"],
    script:
        "../scripts/statistics.py"
