# The study as one page, after everything else: `snakemake report_page`, or `make report`.


rule report_page:
    input:
        rules.all.input,
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/log/report_page.log",
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("report_page"),
    params:
        code=code_of("report_page.py"),
        figures={name: asdict(figure) for name, figure in FIGURES.items()},
        study={name: config[name] for name in ("figures", "claims", "studies", "seeds")},
    script:
        "../scripts/report_page.py"
