rule figure:
    input:
        results=lambda wildcards: leaves(figure_results(wildcards.figure)),
        style=STYLE,
        code=lambda wildcards: code("figure", f"asperity.paper.figures.{FIGURES[wildcards.figure].module}"),
    output:
        png=report(
            f"{RESULTS}/figures/{{figure}}.png",
            caption="../report/figure.rst",
            category=lambda wildcards: FIGURES[wildcards.figure].category,
            labels=figure_labels,
        ),
        pdf=f"{RESULTS}/figures/{{figure}}.pdf",
        caption=f"{RESULTS}/figures/{{figure}}.rst",
    log:
        f"{RESULTS}/log/figure/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(FIGURES),
    threads: 1
    resources:
        mem_mb=memory("figure"),
        disk_mb=disk("figure"),
        runtime=minutes("figure"),
    params:
        module=lambda wildcards: FIGURES[wildcards.figure].module,
        own=lambda wildcards: FIGURES[wildcards.figure].own,
        labels=surface_labels,
        results=lambda wildcards: figure_results(wildcards.figure),
        caption=lambda wildcards, output: Path(output.caption),  # read when the report is made
    script:
        "../scripts/figure.py"


rule figures:
    input:
        expand(rules.figure.output, figure=FIGURES),
