rule stress:
    input:
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
        machine_code=MACHINE_CODE,
        wisdom=fft_wisdom,
        code=code("stress"),
    output:
        f"{RESULTS}/stress/{{surface}}/seed{{seed}}.nc",
        [f"{RESULTS}/readings/{name}/stress/{{surface}}/seed{{seed}}.nc" for name in OTHER_LATERALS],
    log:
        f"{RESULTS}/log/stress/{{surface}}/seed{{seed}}.log",
    priority: PRIORITIES["stress"]
    threads: 1
    resources:
        mem_mb=memory("stress"),
        disk_mb=disk("stress"),
        runtime=minutes("stress"),
    params:
        stress=config["stress"],
        laterals=OTHER_LATERALS,
        quantities=OTHER_COMPONENTS,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/stress.py"
