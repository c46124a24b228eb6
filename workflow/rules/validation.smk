VALIDATIONS = list(config["validation"])


rule validation:
    input:
        machine_code=MACHINE_CODE,
        code=code("validation"),
    output:
        f"{RESULTS}/validation/{{validation}}.nc",
    log:
        f"{RESULTS}/log/validation/{{validation}}.log",
    wildcard_constraints:
        validation=any_of(VALIDATIONS),
    priority: PRIORITIES["validation"]
    threads: 1
    resources:
        mem_mb=memory("validation"),
        disk_mb=disk("validation"),
        runtime=minutes("validation"),
    params:
        settings=lambda wildcards: config["validation"][wildcards.validation],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/validation.py"


# Comparison with a second finite-element program, which must be installed; rule all does not request it.
rule calculix:
    input:
        machine_code=MACHINE_CODE,
        code=code("calculix"),
    output:
        f"{RESULTS}/validation/calculix.nc",
    log:
        f"{RESULTS}/log/validation/calculix.log",
    threads: 1
    resources:
        mem_mb=memory("calculix"),
        disk_mb=disk("calculix"),
        runtime=minutes("calculix"),
    params:
        folder=lambda wildcards, output: output[0].removesuffix(".nc"),
    script:
        "../scripts/calculix.py"


rule validation_table:
    input:
        expand(f"{RESULTS}/validation/{{validation}}.nc", validation=VALIDATIONS),
        # Part of the table if it was made before.
        calculix=lambda wildcards: [path for path in rules.calculix.output if os.path.exists(path)],
        code=code("validation_table"),
    output:
        table=f"{RESULTS}/validation/table.md",
        numbers=f"{RESULTS}/validation/table.csv",
        page=report(
            f"{RESULTS}/validation/table.html",
            caption="../report/validation.rst",
            category="Validation",
            labels={"table": "comparisons, errors and bounds"},
        ),
    log:
        f"{RESULTS}/log/validation/table.log",
    threads: 1
    resources:
        mem_mb=memory("validation_table"),
        disk_mb=disk("validation_table"),
        runtime=minutes("validation_table"),
    params:
        results=lambda wildcards, input: {
            os.path.basename(path).removesuffix(".nc"): path for path in input if path.endswith(".nc")
        },
    script:
        "../scripts/validation_table.py"
