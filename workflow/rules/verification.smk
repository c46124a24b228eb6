rule verification:
    input:
        surface=results_of_seeds("surface"),
        contact=results_of_seeds("contact"),
        stress=results_of_seeds("stress"),
        statistics=f"{RESULTS}/statistics/{{surface}}.nc",
        machine_code=MACHINE_CODE,
        wisdom=fft_wisdom,
        code=code("verification"),
    output:
        table=f"{RESULTS}/verification/{{surface}}.csv",
        page=report(
            f"{RESULTS}/verification/{{surface}}.html",
            caption="../report/verification.rst",
            category="Verification",
            labels=lambda wildcards: {"surface": wildcards.surface},
        ),
    log:
        f"{RESULTS}/log/verification/{{surface}}.log",
    threads: 1
    resources:
        mem_mb=memory("verification"),
        disk_mb=disk("verification"),
        runtime=minutes("verification"),
    params:
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/verification.py"


rule verified:
    input:
        expand(rules.verification.output, surface=sorted(STUDIED)),
