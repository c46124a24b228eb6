# Measurement of speed and accuracy, from which plans are made: reduced in rule all; in full by `make tradeoff`.
rule tradeoff:
    input:
        machine_code=MACHINE_CODE,
        code=code("tradeoff"),
    output:
        runs=f"{RESULTS}/tradeoff/{{extent}}/runs.nc",
        measured=f"{RESULTS}/tradeoff/{{extent}}/measured.json",
        presets=f"{RESULTS}/tradeoff/{{extent}}/presets.csv",
        errors=f"{RESULTS}/tradeoff/{{extent}}/errors.csv",
        table=f"{RESULTS}/tradeoff/{{extent}}/table.md",
        page=report(
            f"{RESULTS}/tradeoff/{{extent}}/table.html",
            caption="../report/tradeoff.rst",
            category="Speed and accuracy",
            labels={"speed and accuracy": "table"},
        ),
    log:
        f"{RESULTS}/log/tradeoff/{{extent}}.log",
    wildcard_constraints:
        extent=any_of(config["tradeoff"]),
    priority: PRIORITIES["tradeoff"]
    threads: 1
    resources:
        mem_mb=memory("tradeoff"),
        disk_mb=disk("tradeoff"),
        runtime=minutes("tradeoff"),
    params:
        settings=lambda wildcards: config["tradeoff"][wildcards.extent],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/tradeoff.py"


rule tradeoff_figures:
    input:
        runs=rules.tradeoff.output.runs,
        style=STYLE,
        code=code("tradeoff_figures"),
    output:
        report(
            expand(
                f"{RESULTS}/tradeoff/{{{{extent}}}}/{{figure}}.png", figure=["front", "budget", "growth"]
            ),
            caption="../report/tradeoff.rst",
            category="Speed and accuracy",
            labels={"speed and accuracy": "picture"},
        ),
        expand(f"{RESULTS}/tradeoff/{{{{extent}}}}/{{figure}}.pdf", figure=["front", "budget", "growth"]),
    log:
        f"{RESULTS}/log/tradeoff_figures/{{extent}}.log",
    wildcard_constraints:
        extent=any_of(config["tradeoff"]),
    threads: 1
    resources:
        mem_mb=memory("tradeoff_figures"),
        disk_mb=disk("tradeoff_figures"),
        runtime=minutes("tradeoff_figures"),
    script:
        "../scripts/tradeoff_figures.py"
