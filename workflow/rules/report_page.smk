# The study as one page, after everything else: `snakemake report_page`, or `make report`.
from dataclasses import asdict


rule report_page:
    input:
        rules.all.input,
        template=(LIBRARY / "asperity/paper/page.html.j2").as_posix(),
        code=code("report_page"),
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/log/report_page.log",
    threads: 1
    resources:
        mem_mb=memory("report_page"),
        disk_mb=disk("report_page"),
        runtime=minutes("report_page"),
    params:
        figures={name: asdict(figure) for name, figure in FIGURES.items()},
        study={name: config[name] for name in ("figures", "claims", "studies", "seeds")},
    script:
        "../scripts/report_page.py"
