from dataclasses import asdict


rule figure:
    input:
        results=lambda wildcards: leaves(figure_results(wildcards.figure)),
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
    benchmark:
        f"{RESULTS}/benchmark/figure/{{figure}}.tsv"
    wildcard_constraints:
        figure=any_of(FIGURES),
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("figure"),
    params:
        code=DRAWING,
        figure=lambda wildcards: asdict(FIGURES[wildcards.figure]),
        labels=surface_labels,
        results=lambda wildcards: figure_results(wildcards.figure),
        caption=lambda wildcards, output: Path(output.caption),  # read when the report is made
    script:
        "../scripts/figure.py"


rule figures:
    input:
        expand(rules.figure.output, figure=FIGURES),
