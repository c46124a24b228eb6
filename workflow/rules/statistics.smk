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
