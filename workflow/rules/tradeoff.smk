# Measurement of speed and accuracy, from which plans are made: reduced in rule all; in full by `make tradeoff`.
rule tradeoff:
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
    benchmark:
        f"{RESULTS}/benchmark/tradeoff/{{extent}}.tsv"
    wildcard_constraints:
        extent=any_of(config["tradeoff"]),
    priority: 1
    resources:
        **needs("tradeoff"),
    params:
        code=COMPUTING,
        settings=lambda wildcards: config["tradeoff"][wildcards.extent],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/tradeoff.py"


rule tradeoff_figures:
    input:
        runs=rules.tradeoff.output.runs,
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
    benchmark:
        f"{RESULTS}/benchmark/tradeoff_figures/{{extent}}.tsv"
    wildcard_constraints:
        extent=any_of(config["tradeoff"]),
    resources:
        **needs("tradeoff_figures"),
    params:
        code=DRAWING,
    script:
        "../scripts/tradeoff_figures.py"
