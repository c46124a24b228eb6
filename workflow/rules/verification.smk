rule verification:
    input:
        surface=expand(f"{RESULTS}/surface/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
        contact=expand(f"{RESULTS}/contact/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
        stress=expand(f"{RESULTS}/stress/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
        statistics=f"{RESULTS}/statistics/{{surface}}.nc",
        machine_code=MACHINE_CODE,
        code=code("verification"),
    output:
        report(
            f"{RESULTS}/verification/{{surface}}.csv",
            caption="../report/verification.rst",
            category="Verification",
            labels=lambda wildcards: {"surface": wildcards.surface},
        ),
    log:
        f"{RESULTS}/log/verification/{{surface}}.log",
    benchmark:
        f"{RESULTS}/benchmark/verification/{{surface}}.tsv"
    threads: 1
    resources:
        mem_mb=memory("verification"),
        disk_mb=disk("verification"),
        runtime=minutes("verification"),
    params:
        seeds=config["seeds"],
    script:
        "../scripts/verification.py"


rule verified:
    input:
        expand(
            f"{RESULTS}/verification/{{surface}}.csv",
            surface=sorted({name for names in config["studies"].values() for name in names}),
        ),
