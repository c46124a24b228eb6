VALIDATIONS = list(config["validation"])


rule validation:
    output:
        f"{RESULTS}/validation/{{validation}}.nc",
    log:
        f"{RESULTS}/log/validation/{{validation}}.log",
    benchmark:
        f"{RESULTS}/benchmark/validation/{{validation}}.tsv"
    wildcard_constraints:
        validation=any_of(VALIDATIONS),
    priority: 1
    resources:
        **needs("validation"),
    params:
        code=code("validation"),
        settings=lambda wildcards: config["validation"][wildcards.validation],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/validation.py"


rule validation_table:
    input:
        results=expand(rules.validation.output, validation=VALIDATIONS),
        checks=(LIBRARY / "study/validation/checks.yaml").as_posix(),
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
    benchmark:
        f"{RESULTS}/benchmark/validation/table.tsv"
    resources:
        **needs("validation_table"),
    params:
        code=code("validation_table"),
        results=lambda wildcards, input: {Path(path).stem: path for path in input.results},
    script:
        "../scripts/validation_table.py"
