rule surface:
    input:
        map=lambda wildcards: ([MEASURED[wildcards.surface]["file"]] if wildcards.surface in MEASURED else []),
        wisdom=fft_wisdom,
        code=code("surface"),
    output:
        f"{RESULTS}/surface/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/surface/{{surface}}/seed{{seed}}.log",
    priority: PRIORITIES["surface"]
    threads: 1
    resources:
        mem_mb=memory("surface"),
        disk_mb=disk("surface"),
        runtime=minutes("surface"),
    params:
        surface=surface_settings,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/surface.py"
