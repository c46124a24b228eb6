# The study as one page, after everything else: `snakemake report_page`, or `make report`.


rule report_page:
    input:
        rules.all.input,
        template=(LIBRARY / "paper/page.html.j2").as_posix(),
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/log/report_page.log",
    resources:
        **needs("report_page"),
    params:
        code=code("report_page"),
        figures={name: asdict(figure) for name, figure in FIGURES.items()},
        study={name: config[name] for name in ("figures", "claims", "studies", "seeds")},
    script:
        "../scripts/report_page.py"
