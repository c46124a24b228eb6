rule validation:
    output:
        results=[f"{RESULTS}/validation/{name}.nc" for name in config["validation"]],
        table=f"{RESULTS}/validation/table.md",
        numbers=f"{RESULTS}/validation/table.csv",
        page=report(
            f"{RESULTS}/validation/table.html",
            caption="../report/validation.rst",
            category="Validation",
            labels={"table": "comparisons, errors and bounds"},
        ),
    log:
        f"{RESULTS}/log/validation.log",
    benchmark:
        f"{RESULTS}/benchmark/validation.tsv"
    priority: 1
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("validation"),
    params:
        code=code_of("validation.py"),
        validation=config["validation"],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/validation.py"
