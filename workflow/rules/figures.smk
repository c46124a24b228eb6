rule figure:
    input:
        results=lambda wildcards: leaves(stage_results(wildcards.figure)),
        style="src/asperity/paper/figures/style.mplstyle",
        code=lambda wildcards: code("figure", f"asperity.paper.figures.{wildcards.figure.split('_')[0]}"),
    output:
        png=report(
            f"{RESULTS}/figures/{{figure}}.png",
            caption="../report/figure.rst",
            category=lambda wildcards: (
                "Figures of the paper" if wildcards.figure.removeprefix("fig").isdigit() else "Supplement"
            ),
            labels=lambda wildcards: {
                "figure": wildcards.figure.split("_")[0].removeprefix("fig").lstrip("0"),
                "study": " and ".join(
                    [studies] if isinstance(studies := FIGURES[wildcards.figure][0], str) else studies
                ),
            },
        ),
        pdf=f"{RESULTS}/figures/{{figure}}.pdf",
        caption=f"{RESULTS}/figures/{{figure}}.rst",
    log:
        f"{RESULTS}/log/figure/{{figure}}.log",
    benchmark:
        f"{RESULTS}/benchmark/figure/{{figure}}.tsv"
    wildcard_constraints:
        figure="|".join(FIGURES),
    threads: 1
    resources:
        mem_mb=memory("figure"),
        disk_mb=disk("figure"),
        runtime=minutes("figure"),
    params:
        stages=lambda wildcards: stage_results(wildcards.figure),
        caption=lambda wildcards, output: Path(output.caption),  # read when the report is made
    script:
        "../scripts/figure.py"


rule figures:
    input:
        expand(f"{RESULTS}/figures/{{figure}}.png", figure=FIGURES),
