rule statistics:
    input:
        surfaces=expand(f"{RESULTS}/surface/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
        contacts=expand(f"{RESULTS}/contact/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
        stresses=expand(f"{RESULTS}/stress/{{{{surface}}}}/seed{{seed}}.nc", seed=config["seeds"]),
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
