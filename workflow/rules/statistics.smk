rule statistics:
    input:
        surface=results_of_seeds("surface"),
        contact=results_of_seeds("contact"),
        stress=results_of_seeds("stress"),
        others=other_stresses_of_seeds,
        wisdom=fft_wisdom,
        code=code("statistics"),
    output:
        f"{RESULTS}/statistics/{{surface}}.nc",
        [f"{RESULTS}/readings/{name}/statistics/{{surface}}.nc" for name in OTHER_LATERALS],
    log:
        f"{RESULTS}/log/statistics/{{surface}}.log",
    threads: 1
    resources:
        mem_mb=memory("statistics"),
        disk_mb=disk("statistics"),
        runtime=minutes("statistics"),
    params:
        statistics=config["statistics"],
        patch_nodes=config["readings"]["patch_nodes"],
        laterals=OTHER_LATERALS,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/statistics.py"
